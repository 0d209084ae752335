//! Packs the agents in cell order, within a cell by id.

use super::shared::cell_index;
use crate::kernels::grid_scatter::Slices;
use rayon::prelude::*;

/// Twin of `shaders/grid_scatter.wgsl`.
pub fn grid_scatter(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    if b.level == 0 {
        // in order of id, so the cells come out sorted already
        for agent in 0..agents {
            let cell = cell_index(b.position[agent], b.step);
            b.slot_agent[(b.cell_start[cell] + b.cell_counts[cell]) as usize] = agent as u32;
            b.cell_counts[cell] += 1;
        }
        return;
    }
    if b.level == 1 {
        b.cell_counts[..b.step.cell_count as usize].fill(0);
        return;
    }
    let slot_agent = &b.slot_agent[..agents];
    let slots = b.slot_motion.par_chunks_exact_mut(2).zip(slot_agent).with_min_len(1024);
    slots.for_each(|(slot, &agent)| {
        let ([x, y], [vx, vy]) = (b.position[agent as usize], b.velocity[agent as usize]);
        slot[0] = [x, y, vx, vy];
        slot[1] = b.body[agent as usize];
    });
    for (slot, &agent) in slot_agent.iter().enumerate() {
        b.agent_slot[agent as usize] = slot as u32;
    }
}
