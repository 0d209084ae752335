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

pub mod between;
pub mod body;
pub mod careful;
pub mod contact;
pub mod crowding;
pub mod exact;
pub mod footing;
pub mod neighbours;
pub mod normal;
pub mod orca;
pub mod precedence;
pub mod prefer;
pub mod quaternion;
pub mod segments;
pub mod shared;
pub mod sight;
pub mod stages;
pub mod standing;
pub mod way;

use crate::kernels::{Phase, Store};

include!(concat!(env!("OUT_DIR"), "/reference.rs"));

/// Inputs for the arithmetic probe: `(a, b, c, d)` with a, b, c in [-10, 10) and d in [-1, 1), b not 0.
pub fn probe_cases(count: u32) -> Vec<[f32; 4]> {
    let unit = |case: u32, lane: u32| exact::unit_f32(exact::hash_u32(case * 4 + lane + 1)) * 2.0 - 1.0;
    let case = |i| {
        let b = unit(i, 1) * 10.0;
        [unit(i, 0) * 10.0, if b == 0.0 { 1.0 } else { b }, unit(i, 2) * 10.0, unit(i, 3)]
    };
    (0..count).map(case).collect()
}
