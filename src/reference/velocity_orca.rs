//! The velocity nearest to the preferred one that avoids neighbours, obstacles and the user: ORCA.

use super::exact::dot2;
use super::orca::{
    LINES, Line, NEIGHBOURS, SEGMENTS, Segment, agent_line, least_bad, obstacle_line, segment_distance2,
    within,
};
use super::shared::grid_cell;
use crate::kernels::layout::StepUniforms;
use crate::kernels::velocity_orca::Slices;
use rayon::prelude::*;

/// Twin of `shaders/velocity_orca.wgsl`.
pub fn velocity_orca(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let scene = Scene {
        step: b.step,
        slot_motion: b.slot_motion,
        slot_agent: b.slot_agent,
        cell_start: b.cell_start,
        obstacles: b.obstacles,
        obstacle_cells: b.obstacle_cells,
    };
    let preferred = b.preferred_velocity;
    b.new_velocity[..agents].par_iter_mut().with_min_len(256).enumerate().for_each(|(slot, velocity)| {
        *velocity = scene.new_velocity(slot, preferred[scene.slot_agent[slot] as usize]);
    });
}

/// An agent slower than this share of its maximum speed is in a jam.
const JAM_SPEED: f32 = 0.45;

/// What all agents read.
struct Scene<'a> {
    step: &'a StepUniforms,
    slot_motion: &'a [[f32; 4]],
    slot_agent: &'a [u32],
    cell_start: &'a [u32],
    obstacles: &'a [[f32; 4]],
    obstacle_cells: &'a [u32],
}

/// The nearest so far, sorted by (squared distance, id).
struct Nearest {
    slots: [u32; NEIGHBOURS],
    distance2: [f32; NEIGHBOURS],
    count: usize,
    /// Nobody farther than this can come in.
    limit: f32,
}

impl Scene<'_> {
    fn new_velocity(&self, slot: usize, preferred: [f32; 2]) -> [f32; 2] {
        let step = self.step;
        let [x, y, vx, vy] = self.slot_motion[slot * 2];
        let [radius, max_speed, ..] = self.slot_motion[slot * 2 + 1];
        let (position, velocity) = ([x, y], [vx, vy]);
        let mut lines: [Line; LINES] = [[0.0; 4]; LINES];
        let hard = self.obstacle_lines(&mut lines, position, velocity, radius, max_speed);
        let nearest = self.neighbours(slot, position);
        let is_slow = dot2(velocity, velocity) < JAM_SPEED * JAM_SPEED * max_speed * max_speed;
        let mut rate = step.inverse_time_horizon;
        for attempt in 0.. {
            let count = self.other_lines(&mut lines, hard, slot, &nearest, rate);
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
    /// behind the first `count`; returns how many lines there are then.
    fn other_lines(
        &self,
        lines: &mut [Line; LINES],
        mut count: usize,
        slot: usize,
        nearest: &Nearest,
        rate: f32,
    ) -> usize {
        let step = self.step;
        let [x, y, vx, vy] = self.slot_motion[slot * 2];
        let own_radius = self.slot_motion[slot * 2 + 1][0];
        let mut avoid = |other: [f32; 4], other_radius: f32, share: f32, side: f32| {
            lines[count] = agent_line(
                [vx, vy],
                [other[0] - x, other[1] - y],
                [vx - other[2], vy - other[3]],
                own_radius + other_radius + step.safety_margin,
                rate,
                step.inverse_time_step,
                share,
                side,
            );
            count += 1;
        };
        let ([ux, uy], [uvx, uvy]) = (step.user_position, step.user_velocity);
        let to_user = [ux - x, uy - y];
        let is_near = dot2(to_user, to_user) < step.neighbour_distance * step.neighbour_distance;
        if step.user_radius > 0.0 && is_near {
            avoid([ux, uy, uvx, uvy], step.user_radius, 1.0, 1.0);
        }
        for other in &nearest.slots[..nearest.count] {
            let other = *other as usize;
            let side = if slot < other { 1.0 } else { -1.0 };
            avoid(self.slot_motion[other * 2], self.slot_motion[other * 2 + 1][0], step.responsibility, side);
        }
        count
    }

    /// The nearest agents: the square of five by five cells first, then ring by ring, stopping when no farther ring
    /// can hold a nearer one.
    fn neighbours(&self, slot: usize, position: [f32; 2]) -> Nearest {
        let step = self.step;
        let cap = step.neighbour_cap as usize;
        let range2 = step.neighbour_distance * step.neighbour_distance;
        let mut nearest =
            Nearest { slots: [0; NEIGHBOURS], distance2: [0.0; NEIGHBOURS], count: 0, limit: range2 };
        if cap == 0 {
            return nearest;
        }
        let [cx, cy] = grid_cell(position, step);
        let (columns, rows) = (step.grid_columns as i32, step.grid_rows as i32);
        let mut ring = 2;
        loop {
            let (left, right) = ((cx - ring).max(0), (cx + ring).min(columns - 1));
            for row in (cy - ring).max(0)..=(cy + ring).min(rows - 1) {
                let cell = |column: i32| (row * columns + column) as usize;
                if ring == 2 || row == cy - ring || row == cy + ring {
                    self.scan(cell(left), cell(right), slot, position, cap, &mut nearest);
                    continue;
                }
                if cx - ring >= 0 {
                    self.scan(cell(left), cell(left), slot, position, cap, &mut nearest);
                }
                if cx + ring < columns {
                    self.scan(cell(right), cell(right), slot, position, cap, &mut nearest);
                }
            }
            let safe = self.safe_distance(position, cx, cy, ring);
            let full = nearest.count == cap && nearest.limit < safe * safe;
            if full || safe >= step.neighbour_distance {
                return nearest;
            }
            ring += 1;
        }
    }

    /// Offers everyone in a run of cells of one row.
    fn scan(&self, first: usize, last: usize, own: usize, at: [f32; 2], cap: usize, nearest: &mut Nearest) {
        let slots = self.cell_start[first] as usize..self.cell_start[last + 1] as usize;
        for (slot, motion) in
            slots.clone().zip(self.slot_motion[slots.start * 2..slots.end * 2].chunks_exact(2))
        {
            let to = [motion[0][0] - at[0], motion[0][1] - at[1]];
            let distance2 = dot2(to, to);
            if distance2 <= nearest.limit && slot != own {
                self.insert(nearest, cap, slot as u32, distance2);
            }
        }
    }

    /// Insertion by (squared distance, id): a total order, so the order of the cells does not matter.
    fn insert(&self, nearest: &mut Nearest, cap: usize, slot: u32, distance2: f32) {
        let id = self.slot_agent[slot as usize];
        let before = |i: usize, nearest: &Nearest| {
            let other = nearest.distance2[i];
            distance2 < other || (distance2 == other && id < self.slot_agent[nearest.slots[i] as usize])
        };
        let full = nearest.count == cap;
        // the neighbour distance itself is out of range
        if if full { !before(cap - 1, nearest) } else { distance2 >= nearest.limit } {
            return;
        }
        let mut hole = nearest.count.min(cap - 1);
        while hole > 0 && before(hole - 1, nearest) {
            nearest.slots[hole] = nearest.slots[hole - 1];
            nearest.distance2[hole] = nearest.distance2[hole - 1];
            hole -= 1;
        }
        (nearest.slots[hole], nearest.distance2[hole]) = (slot, distance2);
        nearest.count = (nearest.count + 1).min(cap);
        if nearest.count == cap {
            nearest.limit = nearest.distance2[cap - 1];
        }
    }

    /// Everyone outside the square of `2 ring + 1` cells is at least this far away. Cells at the border of the grid
    /// reach to infinity, since they hold the agents outside.
    fn safe_distance(&self, at: [f32; 2], cx: i32, cy: i32, ring: i32) -> f32 {
        let step = self.step;
        let mut safe = f32::MAX;
        for (axis, (cell, cells)) in [(cx, step.grid_columns), (cy, step.grid_rows)].into_iter().enumerate() {
            let from_origin = at[axis] - step.grid_origin[axis];
            if cell - ring > 0 {
                safe = safe.min(from_origin - (cell - ring) as f32 * step.cell_size);
            }
            if cell + ring < cells as i32 - 1 {
                safe = safe.min((cell + ring + 1) as f32 * step.cell_size - from_origin);
            }
        }
        safe.max(0.0) * SAFE
    }

    /// Lines of the nearest obstacle segments, by (squared distance, number).
    fn obstacle_lines(
        &self,
        lines: &mut [Line; LINES],
        position: [f32; 2],
        velocity: [f32; 2],
        radius: f32,
        max_speed: f32,
    ) -> usize {
        let step = self.step;
        if step.obstacle_count == 0 {
            return 0;
        }
        let range = step.time_horizon_obstacles * max_speed + radius;
        let [cx, cy] = grid_cell(position, step);
        let cell = (cy as u32 * step.grid_columns + cx as u32) as usize;
        let mut numbers = [0_u32; SEGMENTS];
        let mut distances = [0.0_f32; SEGMENTS];
        let mut count = 0;
        for entry in self.obstacle_cells[cell]..self.obstacle_cells[cell + 1] {
            let number = self.obstacle_cells[entry as usize];
            let distance2 = segment_distance2(&self.segment(number), position);
            if !(distance2 < range * range) {
                continue;
            }
            // numbers rise within a cell's list, so equal distances stay in order of number
            let mut hole = count;
            while hole > 0 && distance2 < distances[hole - 1] {
                if hole < SEGMENTS {
                    (numbers[hole], distances[hole]) = (numbers[hole - 1], distances[hole - 1]);
                }
                hole -= 1;
            }
            if hole < SEGMENTS {
                (numbers[hole], distances[hole]) = (number, distance2);
                count = (count + 1).min(SEGMENTS);
            }
        }
        let mut made = 0;
        for number in &numbers[..count] {
            let segment = self.segment(*number);
            let rate = step.inverse_time_horizon_obstacles;
            if let Some(line) = obstacle_line(&lines[..made], &segment, position, velocity, radius, rate) {
                lines[made] = line;
                made += 1;
            }
        }
        made
    }

    fn segment(&self, number: u32) -> Segment {
        let at = number as usize * 3;
        [self.obstacles[at], self.obstacles[at + 1], self.obstacles[at + 2]]
    }
}

/// A cell's border is computed with rounding; a neighbour that near to it is looked for in the next ring as well.
const SAFE: f32 = 0.999;
