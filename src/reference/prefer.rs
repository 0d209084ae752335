//! The velocity an agent wants before avoidance.

use super::exact::{dot2, hash_u32, unit_f32};
use super::shared::is_absent;
use crate::kernels::layout::StepUniforms;
use crate::kernels::prefer::Slices;
use rayon::prelude::*;

/// Twin of `shaders/prefer.wgsl`.
pub fn prefer(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let routes = b.route[..agents].par_iter_mut();
    routes.zip(&mut b.preferred_velocity[..agents]).enumerate().with_min_len(1024).for_each(
        |(agent, (route, preferred))| {
            if is_absent(b.position[agent]) {
                *preferred = [0.0, 0.0];
                return;
            }
            *preferred =
                wanted(b.step, agent as u32, b.position[agent], b.body[agent][2], b.waypoints, route);
        },
    );
}

fn wanted(
    step: &StepUniforms,
    agent: u32,
    at: [f32; 2],
    preferred_speed: f32,
    waypoints: &[[f32; 4]],
    way: &mut [u32; 4],
) -> [f32; 2] {
    let length = way[1] & 0x7fff_ffff;
    let loops = way[1] >> 31 == 1;
    let waypoint = |next: u32| waypoints[(way[0] + next.min(length - 1)) as usize];
    let mut target = waypoint(way[2]);
    let mut to = [target[0] - at[0], target[1] - at[1]];
    if way[2] < length && dot2(to, to) < target[2] * target[2] {
        let mut next = way[2] + 1;
        if next == length {
            way[3] += 1;
            if loops {
                next = 0;
            }
        }
        way[2] = next;
        target = waypoints[(way[0] + next.min(length - 1)) as usize];
        to = [target[0] - at[0], target[1] - at[1]];
    }
    let distance = dot2(to, to).sqrt();
    let mut speed = preferred_speed;
    if !loops && way[2] + 1 >= length {
        speed = speed.min(distance * step.inverse_time_step);
    }
    let mut wanted = [0.0, 0.0];
    if distance > 1e-6 {
        let scale = speed / distance;
        wanted = [to[0] * scale, to[1] * scale];
    }
    let bits = hash_u32(agent ^ hash_u32(step.step_index ^ step.seed));
    let noise = [unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5];
    [wanted[0] + noise[0] * step.perturbation, wanted[1] + noise[1] * step.perturbation]
}
