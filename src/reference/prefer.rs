//! The velocity an agent wants before avoidance.

use super::exact::{dot2, hash_u32, unit_f32};
use super::shared::is_absent;
use super::stages::STOP;
use super::way::flow_direction;
use crate::kernels::layout::{FlowUniforms, StepUniforms};
use crate::kernels::prefer::Slices;
use rayon::prelude::*;

/// How fast people come to a place where they will stand: this share of the distance a second.
const APPROACH: f32 = 2.0;

/// Twin of `shaders/prefer.wgsl`.
pub fn prefer(b: Slices<'_>) {
    let preferred = b.preferred_velocity[..b.step.agent_count as usize].par_iter_mut();
    preferred.enumerate().with_min_len(1024).for_each(|(agent, preferred)| {
        let at = b.position[agent];
        *preferred = if is_absent(at) {
            [0.0, 0.0]
        } else {
            let speed = b.body[agent][2];
            wanted(b.step, (b.flow_grid, b.flow_way), agent as u32, at, speed, b.aim[agent])
        };
    });
}

fn wanted(
    step: &StepUniforms,
    fields: (&FlowUniforms, &[u32]),
    agent: u32,
    at: [f32; 2],
    preferred_speed: f32,
    goal: [f32; 4],
) -> [f32; 2] {
    let to = [goal[0] - at[0], goal[1] - at[1]];
    let distance = dot2(to, to).sqrt();
    let mut speed = preferred_speed;
    if goal[2] == STOP {
        speed = speed.min(distance * step.inverse_time_step);
    }
    if goal[2] > 0.0 {
        if distance < goal[2] {
            return [0.0, 0.0];
        }
        speed = speed.min(distance * APPROACH);
    }
    let direction = direction_to(fields, at, goal);
    let length = dot2(direction, direction).sqrt();
    let mut wanted = [0.0, 0.0];
    if length > 1e-6 {
        let scale = speed / length;
        wanted = [direction[0] * scale, direction[1] * scale];
    }
    let bits = hash_u32(agent ^ hash_u32(step.step_index ^ step.seed));
    let noise = [unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5];
    [wanted[0] + noise[0] * step.perturbation, wanted[1] + noise[1] * step.perturbation]
}

/// The direction from a point towards an aim, of any length: along its flow field if it has one, else straight.
fn direction_to(fields: (&FlowUniforms, &[u32]), at: [f32; 2], goal: [f32; 4]) -> [f32; 2] {
    let to = [goal[0] - at[0], goal[1] - at[1]];
    if goal[3] < 0.0 {
        return to;
    }
    flow_direction(fields.0, fields.1, goal[3] as u32, at, to)
}
