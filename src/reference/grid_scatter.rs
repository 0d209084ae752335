//! Puts the agents in cell order, within a cell by id.

use super::shared::{cell_index, is_absent};
use crate::kernels::grid_scatter::Slices;
use crate::kernels::shared::absent::NOBODY;

/// Twin of phase `place` of `shaders/grid_scatter.wgsl`: in order of id, so the cells come out sorted already.
pub fn grid_scatter_place(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        if is_absent(b.position[agent]) {
            b.agent_slot[agent] = NOBODY;
            continue;
        }
        let cell = cell_index(b.position[agent], b.step);
        b.slot_agent[(b.cell_start[cell] + b.cell_counts[cell]) as usize] = agent as u32;
        b.cell_counts[cell] += 1;
    }
}

/// Twin of phase `sort` of `shaders/grid_scatter.wgsl`.
pub fn grid_scatter_sort(b: Slices<'_>) {
    let (agents, cells) = (b.step.agent_count as usize, b.step.cell_count as usize);
    b.cell_counts[..cells].fill(0);
    let present = b.cell_start[cells] as usize;
    b.slot_agent[present..agents].fill(NOBODY);
    for (slot, agent) in b.slot_agent[..present].iter().enumerate() {
        b.agent_slot[*agent as usize] = slot as u32;
    }
}
