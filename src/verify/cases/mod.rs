//! Inputs for the kernels: plausible ones and the hard ones, from a seed.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    reason = "counts of cases are small"
)]

pub mod animation;
pub mod between;
pub mod crossing;
pub mod feelings;
pub mod flow;
pub mod gaits;
pub mod hidden;
pub mod journeys;
pub mod step;

use crate::reference::exact::{hash_u32, unit_f32};

/// Random numbers of a case: number `lane` of item `index`, in [0, 1).
fn unit(seed: u32, index: usize, lane: u32) -> f32 {
    unit_f32(hash_u32(hash_u32(seed ^ (index as u32).wrapping_mul(0x9e37_79b9)).wrapping_add(lane)))
}
