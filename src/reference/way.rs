//! Twins of `shaders/shared/way.wgsl` and `shaders/shared/follow.wgsl`: the bits of the flow grid, and following a field.

use super::exact::dot2;
use crate::kernels::layout::FlowUniforms;
use crate::kernels::shared::way::WAY_SCALE;
use crate::kernels::shared::way::{
    ALL_BITS, FROM_ABOVE, FROM_BELOW, FROM_LEFT, FROM_RIGHT, LEADS, SEES, SOLID, STEP_BITS,
};

/// What crossing a cell costs, m: its size, times what a metre costs there.
pub const fn step(word: u32) -> f32 {
    f32::from_bits(word & STEP_BITS)
}

/// The word of a cell with another step, to the nearest of 16 bits.
pub const fn with_step(word: u32, step: f32) -> u32 {
    word & ALL_BITS | (step.to_bits() + 0x80) & STEP_BITS
}

/// A direction (both parts in [-1, 1]) as the upper 24 bits of a word.
pub fn pack(direction: [f32; 2]) -> u32 {
    let [x, z] = direction.map(|part| ((part * WAY_SCALE + 0.5).floor() as i32 + 2048) as u32);
    x << 8 | z << 20
}

/// The direction in a word of `flow_way`.
pub fn direction(word: u32) -> [f32; 2] {
    let part = |bits: u32| (bits as i32 - 2048) as f32 * (1.0 / WAY_SCALE);
    [part(word >> 8 & 0xfff), part(word >> 20)]
}

/// The direction (of any length) in which an agent at `at` walks to its goal, which is `to` away from it (see the shader).
/// On the ground.
pub fn flow_direction(grid: &FlowUniforms, ways: &[u32], field: u32, at: [f32; 2], to: [f32; 2]) -> [f32; 2] {
    Around::read(grid, ways, (field, 0), at).map_or(to, |around| around.direction(to))
}

/// The first row of a sheet.
pub fn first_row(grid: &FlowUniforms, sheet: u32) -> u32 {
    (sheet * grid.sheet_rows).min(grid.rows - grid.sheet_rows)
}

/// What a field says around a place. Reading is apart from using, so that a caller can read for many agents before it uses
/// the first: the fields do not fit into a processor's caches, and reads that nothing waits for overlap.
#[derive(Debug, Clone, Copy)]
pub struct Around {
    /// Words of the own cell, of its neighbours along x and along z, and of the one across the corner.
    words: [u32; 4],
    /// From the cell's middle, cells.
    off: [f32; 2],
}

impl Around {
    /// Reads a field at a place on a sheet; none if there is no such field.
    pub fn read(grid: &FlowUniforms, ways: &[u32], (field, sheet): (u32, u32), at: [f32; 2]) -> Option<Self> {
        if field >= grid.field_count {
            return None;
        }
        let scaled = [0, 1].map(|axis| (at[axis] - grid.origin[axis]) * grid.inverse_cell_size);
        let column = scaled[0].floor().clamp(0.0, (grid.columns - 1) as f32);
        let row = scaled[1].floor().clamp(0.0, (grid.sheet_rows - 1) as f32);
        let first = first_row(grid, sheet);
        let cell = field * grid.cell_count + (first + row as u32) * grid.columns + column as u32;
        let off = [scaled[0] - (column + 0.5), scaled[1] - (row + 0.5)].map(|part| part.clamp(-0.5, 0.5));
        // all are read, whether they can be entered or not, so that no read waits for another
        let last = grid.field_count * grid.cell_count - 1;
        let way = |cell: u32| ways[cell.min(last) as usize];
        let along_x = |cell: u32| cell.wrapping_add(if off[0] >= 0.0 { 1 } else { u32::MAX });
        let beyond =
            cell.wrapping_add(if off[1] >= 0.0 { grid.columns } else { grid.columns.wrapping_neg() });
        Some(Self { words: [way(cell), way(along_x(cell)), way(beyond), way(along_x(beyond))], off })
    }

    /// The direction in which an agent walks whose goal is `to` away.
    pub fn direction(&self, to: [f32; 2]) -> [f32; 2] {
        let [own, x_way, z_way, corner_way] = self.words;
        if own & (SEES | LEADS) != LEADS {
            return to;
        }
        if own & SOLID != 0 {
            return direction(own);
        }
        let (right, above) = (self.off[0] >= 0.0, self.off[1] >= 0.0);
        let (beside, beyond) =
            (if right { FROM_RIGHT } else { FROM_LEFT }, if above { FROM_ABOVE } else { FROM_BELOW });
        let (x_open, z_open) = (own & beside != 0, own & beyond != 0);
        let round_x = x_open && x_way & beyond != 0;
        let round_z = z_open && z_way & beside != 0;
        let (u, v) = (self.off[0].abs(), self.off[1].abs());
        let weight = |open: bool, weight: f32| if open { weight } else { 0.0 };
        let wx = weight(x_open, u * (1.0 - v));
        let wz = weight(z_open, (1.0 - u) * v);
        let wc = weight(round_x || round_z, u * v);
        let w = (1.0 - u) * (1.0 - v);
        let (own_d, x_d, z_d, c_d) =
            (direction(own), direction(x_way), direction(z_way), direction(corner_way));
        let blend = [0, 1].map(|axis| own_d[axis] * w + x_d[axis] * wx + z_d[axis] * wz + c_d[axis] * wc);
        let length = dot2(blend, blend).sqrt();
        if length < 0.05 {
            return own_d;
        }
        let scale = 1.0 / length;
        [blend[0] * scale, blend[1] * scale]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_packed_direction_keeps_to_a_twentieth_of_a_degree() {
        for step in 0..1000 {
            let (z, x) = (step as f32 * 0.0063).sin_cos();
            let [px, pz] = direction(pack([x, z]) | 0x7f);
            assert!((px - x).hypot(pz - z) < 4e-4, "{x} {z}: {px} {pz}");
        }
    }
}
