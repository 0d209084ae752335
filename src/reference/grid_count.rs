//! Counts the agents of each cell and notes each agent's cell.

use super::shared::grid_cell;
use crate::kernels::grid_count::Slices;

/// Twin of `shaders/grid_count.wgsl`.
pub fn grid_count(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        let [x, y] = grid_cell(
            b.position[agent],
            b.step.grid_origin,
            b.step.inverse_cell_size,
            b.step.grid_columns,
            b.step.grid_rows,
        );
        let cell = y as u32 * b.step.grid_columns + x as u32;
        b.agent_cell[agent] = cell;
        b.cell_counts[cell as usize] += 1;
    }
}
