//! Pictures of crowds, and that the validation layer has nothing to say of them.
#![cfg(feature = "vulkan")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::lossy_float_literal,
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

#[path = "../common/mod.rs"]
mod common;

mod bodies;
mod clothes;
mod direct;
mod faces;
mod far;
mod moments;
mod occlusion;
#[cfg(feature = "import")]
mod painted;
mod pictures;
#[cfg(feature = "import")]
mod place;
mod quality;
mod standing;
mod support;
