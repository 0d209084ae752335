//! Perceived emotion: features, classifiers against the stored answers of others, studies, and the closed loop.
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

mod cli;
mod closed_loop;
mod compare;
mod egait;
mod features;
mod ratings;
mod svm;
mod walkers;
