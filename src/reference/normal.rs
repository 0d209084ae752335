//! Twin of `shaders/shared/normal.wgsl`: normals in one word.

use crate::kernels::shared::normal::{LEAST_NORMAL, NORMAL_UNITS, NORMAL_ZERO};

/// A direction of any length, in a word.
pub fn packed_normal([x, y, z]: [f32; 3]) -> u32 {
    let sum = x.abs() + y.abs() + z.abs();
    let share = if sum > LEAST_NORMAL { 1.0 / sum } else { 0.0 };
    let (x, z) = (x * share, z * share);
    let sign = |of: f32| if of >= 0.0 { 1.0 } else { -1.0 };
    let flat = if y < 0.0 { [(1.0 - z.abs()) * sign(x), (1.0 - x.abs()) * sign(z)] } else { [x, z] };
    let [along_x, along_z] = flat.map(|share| (share * NORMAL_UNITS + (NORMAL_ZERO + 0.5)) as u32);
    along_x | along_z << 16
}
