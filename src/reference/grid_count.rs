//! Counts the agents of each cell.

use super::shared::cell_index;
use crate::kernels::grid_count::Slices;

/// Twin of `shaders/grid_count.wgsl`.
pub fn grid_count(b: Slices<'_>) {
    for position in &b.position[..b.step.agent_count as usize] {
        b.cell_counts[cell_index(*position, b.step)] += 1;
    }
}
