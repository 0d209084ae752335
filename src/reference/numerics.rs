//! The functions of `exact`, over many arguments.

use super::exact::{acos, asin, atan2, exp2, hash_u32, sin_cos, unit_f32, wrap};
use crate::kernels::numerics::Slices;

/// Twin of `shaders/numerics.wgsl`.
pub fn numerics(b: Slices<'_>) {
    for (results, &[x, y, _, w]) in b.numerics_out.chunks_exact_mut(2).zip(b.numerics_in) {
        let [s, c] = sin_cos(x);
        results[0] = [s, c, atan2(x, y), acos(w)];
        results[1] = [exp2(w * 8.0), wrap(x), unit_f32(hash_u32(x.to_bits())), asin(w)];
    }
}
