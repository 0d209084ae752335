//! Statistics: published implementations, full enumeration, null studies, and the paper's own tables.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    clippy::float_cmp,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

mod distributions;
mod friedman;
mod generator;
mod paper;
mod power;
mod raters;
mod refusals;
mod shares;
mod wilcoxon;
mod yardsticks;
