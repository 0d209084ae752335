//! Twins of the other texts of `shaders/shared/`.

use crate::kernels::layout::StepUniforms;

/// Where somebody stands who is not there, on both axes, m; the same as `ground::ABSENT`.
pub const ABSENT: f32 = 1e9;

/// Whether that is the position of somebody who is not there.
pub fn is_absent(position: [f32; 2]) -> bool {
    position[0] >= 0.5 * ABSENT
}

/// The slot of somebody absent, and the agent of an empty slot.
pub const NOBODY: u32 = u32::MAX;

/// The priority of agents that are led from outside.
pub const LED: f32 = 2.0;

/// Column and row of the cell that a ground position belongs to; outside the bounds, the nearest border cell.
pub fn grid_cell(position: [f32; 2], step: &StepUniforms) -> [i32; 2] {
    let x = ((position[0] - step.grid_origin[0]) * step.inverse_cell_size).floor();
    let y = ((position[1] - step.grid_origin[1]) * step.inverse_cell_size).floor();
    let (columns, rows) = (step.grid_columns - 1, step.grid_rows - 1);
    [x.clamp(0.0, columns as f32) as i32, y.clamp(0.0, rows as f32) as i32]
}

/// Index of that cell.
pub fn cell_index(position: [f32; 2], step: &StepUniforms) -> usize {
    let [x, y] = grid_cell(position, step);
    (y as u32 * step.grid_columns + x as u32) as usize
}
