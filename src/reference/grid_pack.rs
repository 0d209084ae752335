//! Copies what neighbours read of each agent to its slot.

use crate::kernels::grid_pack::Slices;
use crate::kernels::layout::{SlotAvoidance, SlotMotion};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::contents::{STOREYS, UNLIKE, WALLS};
use crate::kernels::shared::step::LED_BIT;
use rayon::prelude::*;

/// Twin of `shaders/grid_pack.wgsl`.
pub fn grid_pack(b: Slices<'_>) {
    let slot_agent = &b.slot_agent[..b.step.agent_count as usize];
    let slots = b.slot_motion.par_iter_mut().zip(b.slot_avoidance).zip(slot_agent).with_min_len(1024);
    slots.for_each(|((motion, avoidance), agent)| {
        if *agent == NOBODY {
            *avoidance = SlotAvoidance { agent: NOBODY, ..SlotAvoidance::default() };
            return;
        }
        let agent = *agent as usize;
        let own = b.avoidance[if b.contents & UNLIKE == 0 { 0 } else { agent }];
        *avoidance = SlotAvoidance {
            agent: agent as u32,
            inverse_time_horizon: own.inverse_time_horizon,
            neighbour_distance: own.neighbour_distance,
            limits: own.neighbour_cap as u32 | if own.is_led() { LED_BIT } else { 0 },
        };
        let comfort = if own.is_led() { own.inverse_time_horizon } else { 0.0 };
        *motion = SlotMotion {
            position: b.position[agent],
            velocity: b.velocity[agent],
            radius: b.body[agent].radius + comfort,
            max_speed: b.body[agent].max_speed,
            priority: own.priority,
            elevation: if b.contents & (STOREYS | WALLS) == 0 { 0.0 } else { b.elevation[agent] },
        };
    });
}
