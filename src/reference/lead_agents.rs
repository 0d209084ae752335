//! Agents that are led from outside.

use super::exact::{atan2, dot2};
use super::shared::is_absent;
use crate::kernels::lead_agents::{Slices, WALKING_SPEED};
use crate::kernels::shared::absent::ABSENT;
use crate::kernels::shared::step::LED;

/// Twin of `shaders/lead_agents.wgsl`.
pub fn lead_agents(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        if b.manners[agent][3] < LED {
            continue;
        }
        let [x, y, vx, vy] = b.lead[agent];
        let here = b.position[agent];
        if b.level == 1 {
            if !is_absent(here) {
                let inverse = b.step.inverse_time_step;
                b.preferred_velocity[agent] = [(x - here[0]) * inverse, (y - here[1]) * inverse];
            }
            continue;
        }
        if is_absent([x, y]) {
            b.position[agent] = [ABSENT, ABSENT];
            b.velocity[agent] = [0.0, 0.0];
            continue;
        }
        if is_absent(here) {
            b.position[agent] = [x - vx * b.step.time_step, y - vy * b.step.time_step];
            b.velocity[agent] = [vx, vy];
            if dot2([vx, vy], [vx, vy]).sqrt() > WALKING_SPEED {
                b.stance[agent] = [atan2(vx, vy), 1.0];
            } else {
                b.stance[agent][1] = 0.0;
            }
        }
    }
}
