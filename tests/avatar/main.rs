//! Avatars: bodies driven by gaits, and what the animation kernels make of them.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    missing_debug_implementations,
    unreachable_pub,
    reason = "tests: a failure is a panic that prints, counts are small, and equal means equal"
)]

#[path = "../common/mod.rs"]
mod common;

mod animation;
mod attention;
mod clips;
mod clothes;
mod expression;
mod eyes;
mod footing;
mod foreign;
mod loading;
mod manner;
#[cfg(feature = "vulkan")]
mod painted;
mod paper_gaze;
mod physique;
mod raster;
mod rigs;
mod standing;
mod strides;
mod stroll;
mod vrm;
mod walker;
