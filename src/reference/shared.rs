//! Twins of the other texts of `shaders/shared/`.

use crate::kernels::layout::StepUniforms;

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
