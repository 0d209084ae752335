//! The velocity an agent wants before avoidance.

use super::elevate::standing;
use super::exact::{dot2, hash_u32, lesser, unit_f32};
use super::shared::is_absent;
use super::way::Around;
use crate::kernels::layout::{Aim, StepUniforms};
use crate::kernels::prefer::{APPROACH, Slices};
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::stages::STOP;
use rayon::prelude::*;

/// Agents whose fields are read together.
const CHUNK: usize = 32;

/// Twin of `shaders/prefer.wgsl`.
pub fn prefer(b: Slices<'_>) {
    let floors = &b.floors[..b.step.floor_count as usize * FLOOR_STRIDE];
    let has_sheets = b.flow_grid.sheet_rows < b.flow_grid.rows;
    let preferred = b.preferred_velocity[..b.step.agent_count as usize].par_chunks_mut(CHUNK);
    preferred.enumerate().with_min_len(32).for_each(|(chunk, preferred)| {
        let first = chunk * CHUNK;
        let mut around = [None; CHUNK];
        for (agent, around) in (first..first + preferred.len()).zip(&mut around) {
            let field = b.aim[agent].field;
            if field >= 0.0 {
                let at = b.position[agent];
                let mut sheet = 0;
                if has_sheets {
                    sheet = standing(floors, at, b.elevation[agent])[1] as u32;
                }
                *around = Around::read(b.flow_grid, b.flow_way, (field as u32, sheet), at);
            }
        }
        for ((agent, preferred), around) in (first..).zip(preferred).zip(around) {
            let at = b.position[agent];
            *preferred = if is_absent(at) {
                [0.0, 0.0]
            } else {
                wanted(b.step, around, agent as u32, at, b.body[agent].preferred_speed, b.aim[agent])
            };
        }
    });
}

fn wanted(
    step: &StepUniforms,
    around: Option<Around>,
    agent: u32,
    at: [f32; 2],
    preferred_speed: f32,
    goal: Aim,
) -> [f32; 2] {
    let to = [goal.place[0] - at[0], goal.place[1] - at[1]];
    let distance = dot2(to, to).sqrt();
    let mut speed = preferred_speed;
    if goal.how == STOP {
        speed = lesser(speed, distance * step.inverse_time_step);
    }
    if goal.how > 0.0 {
        if distance < goal.how {
            return [0.0, 0.0];
        }
        speed = lesser(speed, distance * APPROACH);
    }
    // along its flow field if it has one, else straight
    let direction = around.map_or(to, |around| around.direction(to));
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
