//! Moves, turns, advances the phase of the walk; empties the cells and counts the step.

use super::exact::{atan2, dot2, greater, is_finite2, lesser, sin_cos, wrap};
use super::footing::{ground_of, left_over, stays, stays_turned, takes_a_step};
use super::shared::stride_at;
use super::standing::{left_ahead, stance_of};
use crate::kernels::KernelId;
use crate::kernels::integrate::{
    FIRST_STRIDE, FOLLOW, LEAST_STRIDE, STOP_RATE, STRIDE_RATE, Slices, TURNING_SPEED,
};
use crate::kernels::layout::{Body, Stance, StepUniforms};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::cells::index::CELL_WORDS;
use crate::kernels::shared::footing::{HALF, LEG, STEP_RATE};
use rayon::prelude::*;

/// Twin of `shaders/integrate.wgsl`.
pub fn integrate(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    b.cells[..CELL_WORDS * b.step.cell_count as usize].fill(0);
    b.step_count[0] = b.step.step_index + 1;
    let (step, new_velocity, agent_slot, body) = (b.step, b.new_velocity, b.agent_slot, b.body);
    let state = b.position[..agents].par_iter_mut().zip(&mut b.velocity[..agents]);
    let state = state.zip(&mut b.stance[..agents]).zip(&mut b.phase[..agents]).enumerate().with_min_len(1024);
    let failed = state
        .filter_map(|(agent, (((position, velocity), stance), phase))| {
            if agent_slot[agent] == NOBODY {
                *velocity = [0.0, 0.0];
                return None;
            }
            let v = new_velocity[agent_slot[agent] as usize];
            if !is_finite2(v) {
                *velocity = [0.0, 0.0];
                return Some(agent as u32);
            }
            moved(step, agent as u32, v, body[agent], position, stance, phase);
            *velocity = v;
            None
        })
        .min();
    if let Some(agent) = failed {
        let word = &mut b.failure[KernelId::Integrate as usize];
        *word = agent.min(*word);
    }
}

fn moved(
    step: &StepUniforms,
    agent: u32,
    v: [f32; 2],
    body: Body,
    position: &mut [f32; 2],
    stance: &mut Stance,
    phase: &mut u32,
) {
    for axis in 0..2 {
        let mut p = position[axis] + v[axis] * step.time_step;
        if step.wrap > 0.0 {
            if p >= step.wrap {
                p -= step.wrap;
            }
            if p < 0.0 {
                p += step.wrap;
            }
        }
        position[axis] = p;
    }
    let speed = dot2(v, v).sqrt();
    let mut heading = stance.heading;
    if speed > TURNING_SPEED {
        let most = step.turn_rate * step.time_step;
        let turn = wrap(atan2(v[0], v[1]) - heading);
        let follow = lesser(FOLLOW * step.time_step, 1.0);
        heading = wrap(heading + (turn * follow).clamp(-most, most));
    }
    let was = *stance;
    let walking = speed > step.walk_speed * body.preferred_speed;
    let steps = !walking && takes_a_step(&was, *phase);
    let blend = if walking || steps { step.blend_rate } else { -step.blend_rate } * step.time_step;
    let wanted = stride_at(speed, body.walk_ratio);
    let longer = if walking { STRIDE_RATE } else { STOP_RATE } * step.time_step;
    let stride = greater(was.stride + (wanted - was.stride).clamp(-longer, longer), FIRST_STRIDE * wanted);

    let by_speed = lesser(speed * step.time_step / greater(stride, LEAST_STRIDE), 0.5);
    let on_the_spot = if steps { STEP_RATE * step.time_step } else { 0.0 };
    let strides = if walking { by_speed } else { on_the_spot };
    let before = *phase;
    let after = before.wrapping_add(((strides * 16_777_216.0) as u32) << 8);
    *phase = after;

    let turned = wrap(heading - was.heading);
    let (from, to) = (sin_cos(was.heading), sin_cos(heading));
    let ahead = left_ahead(stance_of(agent)) * LEG;
    let usual = greater(stride_at(body.preferred_speed, body.walk_ratio), LEAST_STRIDE);
    let [lacked, lacks] = [was.stride, stride].map(|stride| greater(1.0 - stride / usual, 0.0));
    let foot = |off: [f32; 2], off_turned: f32, later: u32, side: f32| {
        let (before, after) = (before.wrapping_add(later), after.wrapping_add(later));
        let share = left_over(before, after, !(was.walk_weight > 0.0));
        let there = ground_of(after, stride, lacks, side, ahead, to);
        let here = ground_of(before, was.stride, lacked, side, ahead, from);
        let way = [0, 1].map(|axis| v[axis] * step.time_step + there[axis] - here[axis]);
        (stays(off, way, share), stays_turned(off_turned, turned, share))
    };
    let [left_turn, right_turn] = was.turns;
    let (left, left_turn) = foot(was.left, left_turn, 0, 1.0);
    let (right, right_turn) = foot(was.right, right_turn, HALF, -1.0);
    *stance = Stance {
        heading,
        walk_weight: (was.walk_weight + blend).clamp(0.0, 1.0),
        left,
        right,
        turns: [left_turn, right_turn],
        stride,
        unused: 0.0,
    };
}
