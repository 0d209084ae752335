//! Packs the agents in cell order, within a cell by id.

use crate::kernels::grid_scatter::Slices;

/// Twin of `shaders/grid_scatter.wgsl`.
pub fn grid_scatter(b: Slices<'_>) {
    if b.level == 0 {
        // in order of id, so the cells come out sorted already
        for agent in 0..b.step.agent_count {
            let cell = b.agent_cell[agent as usize] as usize;
            b.slot_agent[(b.cell_start[cell] + b.cell_cursor[cell]) as usize] = agent;
            b.cell_cursor[cell] += 1;
        }
        return;
    }
    for slot in 0..b.step.agent_count as usize {
        let agent = b.slot_agent[slot] as usize;
        let ([x, y], [vx, vy]) = (b.position[agent], b.velocity[agent]);
        b.slot_motion[slot] = [x, y, vx, vy];
        b.agent_slot[agent] = slot as u32;
    }
}
