//! Scenarios: files in, crowds and trajectories out, and what other programs recorded.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::float_cmp,
    clippy::needless_range_loop,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

#[path = "../common/mod.rs"]
mod common;

mod bodies;
mod choice;
mod export;
mod menge;
mod parquet;
mod replay;
mod scenes;
mod schema;
