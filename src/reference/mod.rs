//! The kernels on the CPU: plain scalar `f32`, in the order of the shaders, so that a device whose arithmetic is
//! exact gives the same bits.
//!
//! A twin takes the bindings of its shader by name (`kernels::NAME::Slices`) and does the work of all invocations.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    clippy::cast_sign_loss,
    clippy::cast_possible_wrap,
    clippy::needless_pass_by_value,
    clippy::float_cmp,
    clippy::neg_cmp_op_on_partial_ord,
    reason = "a twin converts and compares exactly as its shader does"
)]

pub mod body;
pub mod exact;
pub mod quaternion;
pub mod shared;

use crate::kernels::{KernelId, Store};

include!(concat!(env!("OUT_DIR"), "/reference.rs"));
