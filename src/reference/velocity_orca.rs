//! The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA.

use super::crowding::{crowded, has_right_of_way};
use super::exact::dot2;
use super::neighbours::{Nearest, Slots};
use super::orca::{LINES, Line, RIGHT_OF_WAY, agent_line, least_bad, obstacle_line, share_of, within};
use super::segments::Walls;
use super::shared::{LED, NOBODY};
use crate::kernels::velocity_orca::Slices;
use rayon::prelude::*;

/// Twin of `shaders/velocity_orca.wgsl`.
pub fn velocity_orca(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let slots = Slots {
        step: b.step,
        slot_motion: b.slot_motion,
        slot_agent: b.slot_agent,
        cell_start: b.cell_start,
        has_storeys: b.level == 1,
    };
    let walls = Walls { step: b.step, obstacles: b.obstacles, obstacle_cells: b.obstacle_cells };
    let scene = Scene { slots, walls };
    b.new_velocity[..agents].par_iter_mut().with_min_len(256).enumerate().for_each(|(slot, velocity)| {
        let agent = b.slot_agent[slot];
        if agent == NOBODY {
            return;
        }
        let (own, preferred) = (b.manners[agent as usize], b.preferred_velocity[agent as usize]);
        *velocity = if own[3] >= LED { preferred } else { scene.new_velocity(slot, own, preferred) };
    });
}

/// An agent slower than this share of its maximum speed is in a jam.
const JAM_SPEED: f32 = 0.45;

/// What all agents read.
struct Scene<'a> {
    slots: Slots<'a>,
    walls: Walls<'a>,
}

impl Scene<'_> {
    fn new_velocity(&self, slot: usize, own: [f32; 4], preferred: [f32; 2]) -> [f32; 2] {
        let step = self.slots.step;
        let [x, y, vx, vy] = self.slots.slot_motion[slot * 2];
        let traits = self.slots.slot_motion[slot * 2 + 1];
        let max_speed = traits[1];
        let (position, velocity) = ([x, y], [vx, vy]);
        let mut lines: [Line; LINES] = [[0.0; 4]; LINES];
        let hard = self.obstacle_lines(&mut lines, position, velocity, traits);
        let nearest = self.slots.neighbours(slot, position, own[1], own[2] as u32);
        let mut preferred = preferred;
        if !has_right_of_way(&self.slots, slot, own[3]) {
            preferred = crowded(&self.slots, preferred, position, own[1], own[2] as u32, &nearest);
        }
        let is_slow = dot2(velocity, velocity) < JAM_SPEED * JAM_SPEED * max_speed * max_speed;
        let mut rate = own[0];
        for attempt in 0.. {
            let count = self.other_lines(&mut lines, hard, slot, own[1], &nearest, rate);
            let (satisfied, result) = within(&lines[..count], max_speed, preferred, false);
            if satisfied == count {
                return result;
            }
            // Too crowded to plan that far: plan less far. What is near then counts for more than what is far.
            let next = match attempt {
                0 => step.inverse_time_horizon_dense,
                1 if is_slow => step.inverse_time_horizon_jam,
                _ => 0.0,
            };
            if next <= 0.0 {
                return least_bad(&lines[..count], hard, satisfied, max_speed, result);
            }
            rate = next;
        }
        velocity
    }

    /// Lines of the user, who takes none of the avoidance, so the agent takes all, and of the neighbours, nearest first,
    /// behind the first `count`; returns how many lines there are then. Of two agents the one of lower priority takes
    /// more.
    fn other_lines(
        &self,
        lines: &mut [Line; LINES],
        mut count: usize,
        slot: usize,
        range: f32,
        nearest: &Nearest,
        rate: f32,
    ) -> usize {
        let step = self.slots.step;
        let [x, y, vx, vy] = self.slots.slot_motion[slot * 2];
        let [own_radius, _, own_priority, _] = self.slots.slot_motion[slot * 2 + 1];
        let mut avoid = |other: [f32; 4], other_radius: f32, share: f32, side: f32| {
            let has_way = share <= 0.0;
            lines[count] = agent_line(
                [vx, vy],
                [other[0] - x, other[1] - y],
                [vx - other[2], vy - other[3]],
                own_radius + other_radius + step.safety_margin,
                if has_way { rate.max(RIGHT_OF_WAY) } else { rate },
                step.inverse_time_step,
                if has_way { 1.0 } else { share },
                side,
            );
            count += 1;
        };
        let ([ux, uy], [uvx, uvy]) = (step.user_position, step.user_velocity);
        let to_user = [ux - x, uy - y];
        let is_near = dot2(to_user, to_user) < range * range;
        if step.user_radius > 0.0 && is_near {
            avoid([ux, uy, uvx, uvy], step.user_radius, 1.0, 1.0);
        }
        for other in &nearest.slots[..nearest.count] {
            let other = *other as usize;
            let side = if slot < other { 1.0 } else { -1.0 };
            let [radius, _, priority, _] = self.slots.slot_motion[other * 2 + 1];
            let share = share_of(step.responsibility, own_priority, priority);
            avoid(self.slots.slot_motion[other * 2], radius, share, side);
        }
        count
    }

    /// Lines of the nearest obstacle segments, by (squared distance, number).
    fn obstacle_lines(
        &self,
        lines: &mut [Line; LINES],
        position: [f32; 2],
        velocity: [f32; 2],
        [radius, max_speed, _, elevation]: [f32; 4],
    ) -> usize {
        let step = self.slots.step;
        let near = self.walls.near(position, step.time_horizon_obstacles * max_speed + radius, elevation);
        let mut made = 0;
        for number in &near.numbers[..near.count] {
            let segment = self.walls.segment(*number);
            let rate = step.inverse_time_horizon_obstacles;
            if let Some(line) = obstacle_line(&lines[..made], &segment, position, velocity, radius, rate) {
                lines[made] = line;
                made += 1;
            }
        }
        made
    }
}
