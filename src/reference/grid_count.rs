//! Counts the agents of each cell.

use super::shared::{cell_index, is_absent};
use crate::kernels::grid_count::Slices;

/// Twin of `shaders/grid_count.wgsl`.
pub fn grid_count(b: Slices<'_>) {
    let agents = b.position[..b.step.agent_count as usize].iter();
    for position in agents.filter(|position| !is_absent(**position)) {
        b.cell_counts[cell_index(*position, b.step)] += 1;
    }
}
