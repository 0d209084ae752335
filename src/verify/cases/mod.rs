//! Inputs for the kernels, plausible ones and hard ones, each from a seed.

pub mod animation;
