//! The simulation: one step, on the CPU or on Vulkan.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    reason = "counts and cells are far below 2^24; the grid's limits are checked when it is laid out"
)]

pub mod obstacles;
pub mod order;

#[allow(missing_docs)] #[derive(Debug, thiserror::Error)] pub enum Error {}
