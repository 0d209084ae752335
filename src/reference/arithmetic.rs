//! What correctly rounded arithmetic gives.

use crate::kernels::arithmetic::Slices;
use crate::kernels::probe;

/// Twin of `shaders/arithmetic.wgsl`.
pub fn arithmetic(b: Slices<'_>) {
    for (results, case) in b.arithmetic_out.chunks_exact_mut(3).zip(b.numerics_in) {
        results.copy_from_slice(&probe::expected(*case));
    }
}
