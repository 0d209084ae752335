//! Agents that are led from outside.

use super::exact::{atan2, dot2};
use super::shared::is_absent;
use crate::kernels::lead_agents::{Slices, WALKING_SPEED};
use crate::kernels::shared::absent::ABSENT;
use crate::kernels::shared::step::LED;

/// Twin of phase `appear` of `shaders/lead_agents.wgsl`.
pub fn lead_agents_appear(b: Slices<'_>) {
    for agent in led(&b) {
        let [x, y, vx, vy] = b.lead[agent];
        if is_absent([x, y]) {
            b.position[agent] = [ABSENT, ABSENT];
            b.velocity[agent] = [0.0, 0.0];
            continue;
        }
        if is_absent(b.position[agent]) {
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

/// Twin of phase `steer` of `shaders/lead_agents.wgsl`.
pub fn lead_agents_steer(b: Slices<'_>) {
    let inverse = b.step.inverse_time_step;
    for agent in led(&b) {
        let ([x, y, ..], here) = (b.lead[agent], b.position[agent]);
        if !is_absent(here) {
            b.preferred_velocity[agent] = [(x - here[0]) * inverse, (y - here[1]) * inverse];
        }
    }
}

/// Agents that are led.
fn led<'a>(b: &Slices<'a>) -> impl Iterator<Item = usize> + use<'a> {
    let manners = &b.avoidance[..b.step.agent_count as usize];
    manners.iter().enumerate().filter(|(_, manners)| manners[3] >= LED).map(|(agent, _)| agent)
}
