//! The window, on a display without a screen.
#![cfg(all(feature = "view", target_os = "linux"))]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

#[path = "../common/mod.rs"]
mod common;

mod window;
