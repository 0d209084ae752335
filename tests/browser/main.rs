//! The pages of studies, in a browser.
//!
//! Skipped with a line where there is no browser; `GAITWAY_REQUIRE_BROWSER=1` demands it. `scripts/setup --browser` brings it.
//! `GAITWAY_SHOTS=FOLDER` keeps every screenshot, and one of each test that fails.
#![cfg(target_os = "linux")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "tests: a failure is a panic that prints"
)]

#[path = "../common/mod.rs"]
mod common;

mod accessibility;
mod admin;
#[cfg(feature = "video")]
mod clips;
mod crashes;
mod credit;
mod driver;
mod films;
mod frames;
mod harness;
mod headset;
mod looks;
mod network;
mod page;
mod refusals;
mod tabs;
mod visit;
mod walks;
