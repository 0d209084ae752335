//! Copies what neighbours read of each agent to its slot.

use super::shared::{LED, NOBODY};
use crate::kernels::grid_pack::Slices;
use rayon::prelude::*;

/// Twin of `shaders/grid_pack.wgsl`.
pub fn grid_pack(b: Slices<'_>) {
    let slot_agent = &b.slot_agent[..b.step.agent_count as usize];
    let slots = b.slot_motion.par_chunks_exact_mut(2).zip(slot_agent).with_min_len(1024);
    slots.filter(|(_, agent)| **agent != NOBODY).for_each(|(slot, agent)| {
        let agent = *agent as usize;
        let ([x, y], [vx, vy], [radius, max_speed, ..]) =
            (b.position[agent], b.velocity[agent], b.body[agent]);
        slot[0] = [x, y, vx, vy];
        let [comfort, _, _, priority] = b.manners[agent];
        let comfort = if priority >= LED { comfort } else { 0.0 };
        slot[1] = [radius + comfort, max_speed, priority, b.elevation[agent]];
    });
    for (slot, agent) in slot_agent.iter().enumerate().filter(|(_, agent)| **agent != NOBODY) {
        b.agent_slot[*agent as usize] = slot as u32;
    }
}
