//! What correctly rounded arithmetic gives.

use super::exact::{acos, atan2, exp2, hash_u32, sin_cos, unit_f32, wrap};
use crate::kernels::numerics::Slices;

/// Twin of `shaders/numerics.wgsl`.
pub fn numerics(b: Slices<'_>) {
    for (case, &[x, y, z, w]) in b.numerics_in.iter().enumerate() {
        let at = case * 4;
        b.numerics_out[at] = [x / y, x.abs().sqrt(), x * y + z, x * y + y * z + z * x];
        b.numerics_out[at + 1] = [(x as i32 + 1) as f32, x.floor(), x.min(y), z.max(w)];
        let [s, c] = sin_cos(x);
        b.numerics_out[at + 2] = [s, c, atan2(x, y), acos(w)];
        b.numerics_out[at + 3] = [exp2(w * 8.0), wrap(x), unit_f32(hash_u32(x.to_bits())), z.abs()];
    }
}
