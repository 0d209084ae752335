//! Gaits: motion files in, strides found, the procedural walker and the library.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    clippy::cast_possible_wrap,
    clippy::cast_sign_loss,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

#[path = "../common/mod.rs"]
mod common;

mod fit;
mod import;
mod library;
