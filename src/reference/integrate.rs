//! Moves, turns, advances the phase of the walk; empties the cells and counts the step.

use super::exact::{atan2, dot2, greater, is_finite2, lesser, unless_faint, wrap};
use super::footing::{
    foothold, going_of, left_over, ready_phase, since_strike, stays, stays_turned, takes_a_step,
};
use crate::kernels::KernelId;
use crate::kernels::integrate::{
    FIRST_STRIDE, FOLLOW, GRAVITY, HEADS_FOLLOW, LEANS, LEANS_FOLLOW, MOST_FORESIGHT, MOST_PUSH, STOP_RATE,
    STRIDE_RATE, Slices, TURNING_SPEED,
};
use crate::kernels::layout::{Body, Stance, StepUniforms};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::cells::index::CELL_WORDS;
use crate::kernels::shared::contents::BARE;
use crate::kernels::shared::footing::{LEAST_STRIDE, STEP_RATE};
use rayon::prelude::*;

/// Twin of `shaders/integrate.wgsl`.
pub fn integrate(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    b.cells[..CELL_WORDS * b.step.cell_count as usize].fill(0);
    b.step_count[0] = b.step.step_index + 1;
    let (step, new_velocity, agent_slot, body) = (b.step, b.new_velocity, b.agent_slot, b.body);
    let solved = |agent: usize| match agent_slot[agent] {
        NOBODY => None,
        slot => Some(new_velocity[slot as usize]),
    };
    if b.contents & BARE == 0 {
        let bodies = b.stance[..agents].par_iter_mut().zip(&mut b.heading[..agents]);
        let had = &b.velocity[..agents];
        bodies.enumerate().with_min_len(1024).for_each(|(agent, (stance, heading))| {
            if let Some(v) = solved(agent).filter(|v| is_finite2(*v)) {
                Carried { stance, heading }.moved(step, agent as u32, [had[agent], v], body[agent]);
            }
        });
    }
    let state = b.position[..agents].par_iter_mut().zip(&mut b.velocity[..agents]);
    let failed = state
        .enumerate()
        .with_min_len(1024)
        .filter_map(|(agent, (position, velocity))| {
            *velocity = [0.0, 0.0];
            let v = solved(agent)?;
            if !is_finite2(v) {
                return Some(agent as u32);
            }
            *velocity = v;
            go(step, position, v);
            None
        })
        .min();
    if let Some(agent) = failed {
        let word = &mut b.failure[KernelId::Integrate as usize];
        *word = agent.min(*word);
    }
}

/// Moves an agent.
fn go(step: &StepUniforms, position: &mut [f32; 2], v: [f32; 2]) {
    for (place, speed) in position.iter_mut().zip(v) {
        let mut p = *place + speed * step.time_step;
        if step.wrap > 0.0 {
            if p >= step.wrap {
                p -= step.wrap;
            }
            if p < 0.0 {
                p += step.wrap;
            }
        }
        *place = p;
    }
}

/// What a step changes of a body.
struct Carried<'a> {
    stance: &'a mut Stance,
    heading: &'a mut f32,
}

impl Carried<'_> {
    /// Of an agent whose velocity was one and is the other.
    fn moved(self, step: &StepUniforms, agent: u32, [had, v]: [[f32; 2]; 2], body: Body) {
        let push = [0, 1].map(|axis| (v[axis] - had[axis]) * step.inverse_time_step);

        let was = *self.stance;
        let stands = !(was.walk_weight > 0.0);
        let speed = dot2(v, v).sqrt();
        let walking = speed > step.walk_speed * body.preferred_speed;
        let steps = !walking && takes_a_step(&was);

        let [vx, vz] = v;
        let faced = *self.heading;
        let turn = if speed > TURNING_SPEED { wrap(atan2(vx, vz) - faced) } else { 0.0 };
        let most = step.turn_rate * step.time_step;
        let turned = (turn * lesser(FOLLOW * step.time_step, 1.0)).clamp(-most, most);
        let towards = |was: f32, aim: f32, rate: f32| {
            unless_faint(was + (aim - was) * lesser(rate * step.time_step, 1.0))
        };
        let blend = if walking || steps { step.blend_rate } else { -step.blend_rate } * step.time_step;
        let wanted = body.stride_at(speed);
        let longer = if walking { STRIDE_RATE } else { STOP_RATE } * step.time_step;
        let mut now = Stance {
            walk_weight: (was.walk_weight + blend).clamp(0.0, 1.0),
            lean: [0, 1].map(|axis| {
                let leans = push[axis].clamp(-MOST_PUSH, MOST_PUSH) * (LEANS / GRAVITY);
                towards(was.lean[axis], leans, LEANS_FOLLOW)
            }),
            stride: greater(was.stride + (wanted - was.stride).clamp(-longer, longer), FIRST_STRIDE * wanted),
            foresight: towards(was.foresight, turn.clamp(-MOST_FORESIGHT, MOST_FORESIGHT), HEADS_FOLLOW),
            ..was
        };

        let by_speed = lesser(speed * step.time_step / greater(now.stride, LEAST_STRIDE), 0.5);
        let on_the_spot = if steps { STEP_RATE * step.time_step } else { 0.0 };
        let strides = if walking { by_speed } else { on_the_spot };
        now.phase = if stands && !walking && !steps {
            ready_phase(agent, &was)
        } else {
            was.phase.wrapping_add(((strides * 16_777_216.0) as u32) << 8)
        };
        *self.heading = wrap(faced + turned);

        let (here, there) =
            (going_of(agent, &was, faced, &body), going_of(agent, &now, *self.heading, &body));
        let left_behind = |off: [f32; 2], off_turned: f32, side: f32| {
            let share = left_over(since_strike(was.phase, side), since_strike(now.phase, side));
            let (from, to) = (foothold(&here, side), foothold(&there, side));
            let way = [0, 1].map(|axis| v[axis] * step.time_step + to[axis] - from[axis]);
            (stays(off, way, share), stays_turned(off_turned, turned, share))
        };
        let [left_turn, right_turn] = was.turns;
        let (left, left_turn) = left_behind(was.left, left_turn, 1.0);
        let (right, right_turn) = left_behind(was.right, right_turn, -1.0);
        (now.left, now.right, now.turns) = (left, right, [left_turn, right_turn]);
        *self.stance = now;
    }
}
