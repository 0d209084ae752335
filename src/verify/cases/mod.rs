//! Inputs for the kernels: plausible ones and the hard ones, from a seed.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "counts of cases are small"
)]

pub mod animation;
pub mod crossing;
pub mod gaits;
pub mod step;
