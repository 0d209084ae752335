//! Copies what neighbours read of each agent to its slot.

use crate::kernels::grid_pack::Slices;
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::contents::{STOREYS, UNLIKE, WALLS};
use crate::kernels::shared::step::{LED, LED_BIT};
use rayon::prelude::*;

/// Twin of `shaders/grid_pack.wgsl`.
pub fn grid_pack(b: Slices<'_>) {
    let slot_agent = &b.slot_agent[..b.step.agent_count as usize];
    let slots = b.slot_motion.par_chunks_exact_mut(2).zip(b.slot_avoidance).zip(slot_agent).with_min_len(1024);
    slots.for_each(|((motion, manners), agent)| {
        if *agent == NOBODY {
            *manners = [NOBODY, 0, 0, 0];
            return;
        }
        let agent = *agent as usize;
        let [rate, range, cap, priority] = b.avoidance[if b.contents & UNLIKE == 0 { 0 } else { agent }];
        let is_led = priority >= LED;
        let led_bit = if is_led { LED_BIT } else { 0 };
        *manners = [agent as u32, rate.to_bits(), range.to_bits(), cap as u32 | led_bit];
        let ([x, y], [vx, vy], [radius, max_speed, ..]) =
            (b.position[agent], b.velocity[agent], b.body[agent]);
        motion[0] = [x, y, vx, vy];
        let comfort = if is_led { rate } else { 0.0 };
        let height = if b.contents & (STOREYS | WALLS) == 0 { 0.0 } else { b.elevation[agent] };
        motion[1] = [radius + comfort, max_speed, priority, height];
    });
}
