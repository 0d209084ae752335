//! The velocity an agent wants before avoidance; twin of `shaders/shared/prefer.wgsl`.

use super::elevate::standing;
use super::exact::{dot2, hash_u32, lesser, unit_f32};
use super::way::Around;
use crate::kernels::layout::{Body, FlowUniforms, StepUniforms};
use crate::kernels::shared::prefer::APPROACH;
use crate::kernels::shared::stages::STOP;

/// What an agent walks to.
#[derive(Debug, Clone, Copy)]
pub struct Aim {
    /// m
    pub place: [f32; 2],
    /// `PASS`, `STOP`, or above 0 the distance within which it stands, m.
    pub how: f32,
    /// Number of the flow field that leads there, or -1.
    pub field: f32,
}

/// What the wishes of a crowd depend on.
#[derive(Debug, Clone, Copy)]
pub struct Wishes<'a> {
    /// Parameters of the step.
    pub step: &'a StepUniforms,
    /// `[agent]`
    pub body: &'a [Body],
    /// `[agent]`, m
    pub elevation: &'a [f32],
    /// The flow grid.
    pub flow_grid: &'a FlowUniforms,
    /// `[field][cell]`
    pub flow_way: &'a [u32],
    /// `[floor][9]`
    pub floors: &'a [[f32; 4]],
}

impl Wishes<'_> {
    /// Reads an agent's flow field at a place; none if it has no field.
    pub fn around(&self, agent: usize, at: [f32; 2], goal: Aim) -> Option<Around> {
        if goal.field < 0.0 {
            return None;
        }
        let mut sheet = 0;
        if self.flow_grid.sheet_rows < self.flow_grid.rows {
            sheet = standing(self.floors, at, self.elevation[agent]).sheet as u32;
        }
        Around::read(self.flow_grid, self.flow_way, (goal.field as u32, sheet), at)
    }

    /// The velocity that an agent wants, m/s.
    pub fn velocity(&self, agent: usize, at: [f32; 2], goal: Aim, around: Option<Around>) -> [f32; 2] {
        let step = self.step;
        let to = [goal.place[0] - at[0], goal.place[1] - at[1]];
        let distance = dot2(to, to).sqrt();
        let mut speed = self.body[agent].preferred_speed;
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
        let bits = hash_u32(agent as u32 ^ hash_u32(step.step_index ^ step.seed));
        let noise = [unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5];
        [wanted[0] + noise[0] * step.perturbation, wanted[1] + noise[1] * step.perturbation]
    }
}
