//! The last resort of collision avoidance: no agent walks through a wall.

use super::exact::{det2, dot2, greater, is_finite2, lesser};
use super::segments::Walls;
use crate::kernels::clip_to_walls::{GAP, NUDGE, ROUNDS, Slices};
use crate::kernels::layout::Segment;
use crate::kernels::shared::absent::NOBODY;
use rayon::prelude::*;

/// Twin of `shaders/clip_to_walls.wgsl`.
pub fn clip_to_walls(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let walls = Walls { step: b.step, obstacles: b.obstacles, obstacle_cells: b.obstacle_cells };
    b.new_velocity[..agents].par_iter_mut().with_min_len(1024).enumerate().for_each(|(slot, velocity)| {
        let own = b.slot_motion[slot];
        if own.agent == NOBODY || own.is_led() || !is_finite2(*velocity) {
            return;
        }
        *velocity = held(&walls, b.slot_position[slot], own.elevation, *velocity);
    });
}

/// The part of a velocity that crosses no wall within a step.
fn held(walls: &Walls<'_>, at: [f32; 2], elevation: f32, wanted: [f32; 2]) -> [f32; 2] {
    let listed = walls.listed(at);
    let time_step = walls.step.time_step;
    let mut velocity = wanted;
    for round in 0..ROUNDS {
        let mut held = false;
        for &number in listed {
            let Segment { a, b, along, .. } = *walls.segment(number);
            if walls.is_in_the_way(number, elevation) && crosses(at, velocity, a, b, along, time_step) {
                held = true;
                let speed = dot2(along, velocity);
                velocity = [along[0] * speed + along[1] * NUDGE, along[1] * speed + -along[0] * NUDGE];
                if round + 1 == ROUNDS || crosses(at, velocity, a, b, along, time_step) {
                    velocity = [0.0, 0.0];
                }
            }
        }
        if !held {
            break;
        }
    }
    velocity
}

/// Whether one step would bring a point on the open side of a segment nearer than [`GAP`] to it, or across.
fn crosses(
    at: [f32; 2],
    velocity: [f32; 2],
    a: [f32; 2],
    b: [f32; 2],
    along: [f32; 2],
    time_step: f32,
) -> bool {
    let next = [at[0] + velocity[0] * time_step, at[1] + velocity[1] * time_step];
    let now = det2(along, [a[0] - at[0], a[1] - at[1]]);
    let then = det2(along, [a[0] - next[0], a[1] - next[1]]);
    if now < 0.0 || then >= now || then >= GAP {
        return false;
    }
    // where the move is at the gap's edge, and where it is on the line
    let s = dot2(along, [at[0] - a[0], at[1] - a[1]]);
    let moved = dot2(along, [next[0] - at[0], next[1] - at[1]]);
    let first = s + moved * ((now - lesser(now, GAP)) / (now - then));
    let last = s + moved * ((now - greater(then, 0.0)) / (now - then));
    greater(first, last) >= -GAP && lesser(first, last) <= dot2(along, [b[0] - a[0], b[1] - a[1]]) + GAP
}
