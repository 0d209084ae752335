//! How high each agent stands, and its feet.

use super::exact::{dot2, greater, lesser, sin_cos, unless_faint};
use super::footing::{foothold, going_of, is_lifted, left_over, since_strike};
use super::shared::is_absent;
use crate::kernels::elevate::{HIGHEST_STEP, SETTLES, Slices};
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::floors::EDGE;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::footing::{LEAST_STRIDE, STEP_RATE};
use rayon::prelude::*;

/// Twin of `shaders/elevate.wgsl`.
pub fn elevate(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let floors = &b.floors[..b.step.floor_count as usize * FLOOR_STRIDE];
    let (position, velocity, body, heading) = (b.position, b.velocity, b.body, b.heading);
    let time_step = b.step.time_step;
    let state = b.elevation[..agents].par_iter_mut().zip(&mut b.stance[..agents]).enumerate();
    state.with_min_len(1024).for_each(|(agent, (elevation, stance))| {
        let place = position[agent];
        if is_absent(place) {
            return;
        }
        let before = *elevation;
        let under = standing(floors, place, before).height;
        *elevation = under;

        let (own, faces) = (*stance, heading[agent]);
        let going = going_of(agent as u32, &own, faces, &body[agent]);
        let v = velocity[agent];
        let by_speed = dot2(v, v).sqrt() / greater(own.stride, LEAST_STRIDE);
        let strides = greater(by_speed, STEP_RATE) * time_step;
        let sunk = under - before;
        let foot = |side: f32, off: [f32; 2], turn: f32, height: f32, slope: f32| {
            let there = foothold(&going, side);
            let at = [0, 1].map(|axis| place[axis] + there[axis] + off[axis]);
            let was = Sole { height: height - sunk, slope };
            let left = way_left(since_strike(own.phase, side), strides, time_step);
            sole(floors, at, under, sin_cos(faces + turn), &was, left)
        };
        let ([left_turn, right_turn], [left_height, right_height]) = (own.turns, own.heights);
        let [left_slope, right_slope] = own.slopes;
        let left = foot(1.0, own.left, left_turn, left_height, left_slope);
        let right = foot(-1.0, own.right, right_turn, right_height, right_slope);
        stance.heights = [left.height, right.height];
        stance.slopes = [left.slope, right.slope];
    });
}

struct Sole {
    /// Above the floor under the body, m.
    height: f32,
    /// Upwards where the foot points to.
    slope: f32,
}

/// The sole of a foot at a place, m, that points to (sine, cosine); `was` is that of the step before, `left` the share of its way
/// ahead that is left after this step.
fn sole(floors: &[[f32; 4]], at: [f32; 2], under: f32, pointing: [f32; 2], was: &Sole, left: f32) -> Sole {
    let floor = standing(floors, at, under);
    let is_near = (floor.height - under).abs() <= HIGHEST_STEP;
    let height = if is_near { floor.height - under } else { 0.0 };
    let slope = if is_near { dot2(floor.gradient, pointing) } else { 0.0 };
    let share = if height > was.height { left * left } else { left.sqrt() };
    Sole {
        height: unless_faint(height + (was.height - height) * share),
        slope: unless_faint(slope + (was.slope - slope) * left),
    }
}

/// The share of its way that a foot has left after a step of so many strides.
fn way_left(since: u32, strides: f32, time_step: f32) -> f32 {
    if !is_lifted(since) {
        return greater(1.0 - SETTLES * time_step, 0.0);
    }
    left_over(since.wrapping_sub(((lesser(strides, 0.5) * 16_777_216.0) as u32) << 8), since)
}

/// Where an agent stands.
#[derive(Debug, Default)]
pub struct Standing {
    /// m.
    pub height: f32,
    /// Of the flow grid.
    pub sheet: f32,
    /// Of the height, m/m.
    pub gradient: [f32; 2],
}

/// Where an agent stands at a point, from the height `present` it stood at before, m. Twin of `shaders/shared/floors.wgsl`.
pub fn standing(floors: &[[f32; 4]], at: [f32; 2], present: f32) -> Standing {
    let (mut nearest, mut found) = (STEP, Standing::default());
    for floor in floors.chunks_exact(FLOOR_STRIDE) {
        let Some((&[a, b, c, sheet], edges)) = floor.split_first() else { continue };
        if edges.iter().all(|&[n, m, d, _]| dot2([n, m], at) + d >= -EDGE) {
            let here = dot2([a, b], at) + c;
            let off = (here - present).abs();
            if off < nearest {
                nearest = off;
                found = Standing { height: here, sheet, gradient: [a, b] };
            }
        }
    }
    found
}
