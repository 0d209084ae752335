//! Agents that are led from outside.

use super::exact::{atan2, dot2};
use super::shared::is_absent;
use crate::kernels::layout::{Lead, Stance};
use crate::kernels::lead_agents::{Slices, WALKING_SPEED};
use crate::kernels::shared::absent::ABSENT;

/// Twin of phase `appear` of `shaders/lead_agents.wgsl`.
pub fn lead_agents_appear(b: Slices<'_>) {
    for agent in led(&b) {
        let Lead { place, velocity } = b.lead[agent];
        if is_absent(place) {
            b.position[agent] = [ABSENT, ABSENT];
            b.velocity[agent] = [0.0, 0.0];
            continue;
        }
        if is_absent(b.position[agent]) {
            let ([x, z], [vx, vz]) = (place, velocity);
            b.position[agent] = [x - vx * b.step.time_step, z - vz * b.step.time_step];
            b.velocity[agent] = velocity;
            let speed = dot2(velocity, velocity).sqrt();
            if speed > WALKING_SPEED {
                let stride = b.body[agent].stride_at(speed);
                let phase = b.stance[agent].phase;
                b.stance[agent] = Stance { phase, walk_weight: 1.0, stride, ..Stance::default() };
                b.heading[agent] = atan2(vx, vz);
            } else {
                b.stance[agent].walk_weight = 0.0;
            }
        }
    }
}

/// Twin of phase `steer` of `shaders/lead_agents.wgsl`.
pub fn lead_agents_steer(b: Slices<'_>) {
    let inverse = b.step.inverse_time_step;
    for agent in led(&b) {
        let ([x, z], here) = (b.lead[agent].place, b.position[agent]);
        if !is_absent(here) {
            b.preferred_velocity[agent] = [(x - here[0]) * inverse, (z - here[1]) * inverse];
        }
    }
}

/// Agents that are led.
fn led<'a>(b: &Slices<'a>) -> impl Iterator<Item = usize> + use<'a> {
    let avoidance = &b.avoidance[..b.step.agent_count as usize];
    avoidance.iter().enumerate().filter(|(_, own)| own.is_led()).map(|(agent, _)| agent)
}
