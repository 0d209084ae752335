//! The simulation: its laws on the CPU, the same bits on Vulkan, and what is known of real crowds.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
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

#[cfg(feature = "vulkan")]
mod arithmetic;
mod crowd;
mod emotion;
#[cfg(feature = "vulkan")]
mod equivalence;
mod flow;
mod invariance;
mod islands;
mod jams;
mod journeys;
mod lanes;
mod lead;
mod outsiders;
mod people;
#[cfg(feature = "vulkan")]
mod renew;
mod rvo2;
mod rvo_2008;
#[cfg(feature = "vulkan")]
mod step;
mod validate;
