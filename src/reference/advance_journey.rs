//! Where each agent is on its journey.

use super::exact::dot2;
use super::shared::is_absent;
use super::stages::{in_region, nearest_place, own_place};
use crate::kernels::advance_journey::{AT_COUNTER, IN_LINE, PATIENCE, STANDING, Slices, TRYING};
use crate::kernels::shared::absent::ABSENT;
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::stages::index::STAGE_STRIDE;
use crate::kernels::shared::stages::{EXIT, GOAL, PASS, QUEUE, STOP, WAITING, WAYPOINT};
use rayon::prelude::*;

/// Twin of `shaders/advance_journey.wgsl`.
pub fn advance_journey(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let lines: &[u32] = b.queues;
    let stages = Stages { lines, now: b.step.step_index, time_step: b.step.time_step, stages: b.stages };
    let elevation = b.elevation;
    let state = b.position[..agents].par_iter_mut().zip(&mut b.route[..agents]);
    let state = state.zip(&mut b.stage_progress[..agents]).zip(&mut b.aim[..agents]);
    let state = state.enumerate().with_min_len(1024);
    let signs = state.filter_map(|(agent, (((position, way), errand), aim))| {
        if is_absent(*position) {
            return None;
        }
        let at = *position;
        let length = way[1] & 0x7fff_ffff;
        let loops = way[1] >> 31 == 1;
        let mut stage = way[0] + way[2].min(length - 1);
        let height = elevation[agent];
        if way[2] < length && stages.is_done(stage, (at, height), errand) {
            way[2] += 1;
            if way[2] == length {
                way[3] = way[3].wrapping_add(1);
                if loops {
                    way[2] = 0;
                }
            }
            let stays = way[2] == length && stages.part(stage, 0)[3] == GOAL;
            *errand = if stays { b.step.step_index + 1 } else { 0 };
            if stages.part(stage, 0)[3] == EXIT {
                *position = [ABSENT, ABSENT];
                return None;
            }
            stage = way[0] + way[2].min(length - 1);
        }
        let is_last = !loops && way[2] + 1 >= length;
        let is_level = stages.is_level(stage, height);
        let (goal, sign) = stages.aim((agent as u32, at, *errand), stage, (is_last, is_level));
        *aim = goal;
        sign.map(|(line, sign)| (agent as u32, line, sign))
    });
    for (agent, line, sign) in signs.collect::<Vec<_>>() {
        match sign {
            Sign::Joins => b.queues[line] = b.queues[line].min(agent),
            Sign::Served => b.queues[line + 3] = b.queues[line + 3].max(1),
        }
    }
}

/// What somebody in or at a line shows, beside the first element of the line.
enum Sign {
    /// Wants to be let in.
    Joins,
    /// Stands at the counter.
    Served,
}

/// All stages, at one step.
struct Stages<'a> {
    /// `[queue][8]`
    lines: &'a [u32],
    now: u32,
    time_step: f32,
    stages: &'a [[f32; 4]],
}

impl Stages<'_> {
    fn part(&self, stage: u32, part: usize) -> [f32; 4] {
        self.stages[stage as usize * STAGE_STRIDE + part]
    }

    /// Whether somebody at a height, m, is on the floor of a stage.
    fn is_level(&self, stage: u32, height: f32) -> bool {
        let [elevation, has_one, ..] = self.part(stage, 3);
        has_one == 0.0 || (height - elevation).abs() < STEP
    }

    /// Whether the agent is done with a stage; begins its wait where it has one.
    fn is_done(&self, stage: u32, (at, height): ([f32; 2], f32), errand: &mut u32) -> bool {
        let [x, z, radius, kind] = self.part(stage, 0);
        let is_level = self.is_level(stage, height);
        if kind == WAYPOINT {
            let to = [x - at[0], z - at[1]];
            return is_level && dot2(to, to) < radius * radius;
        }
        if kind == QUEUE {
            let line = self.part(stage, 1)[3] as usize * 8;
            return *errand > 0 && *errand <= self.lines[line + 1];
        }
        let inside = is_level && in_region(at, [x, z], self.part(stage, 1));
        if kind != WAITING {
            return inside;
        }
        if *errand == 0 {
            if !inside {
                return false;
            }
            *errand = self.now + 1;
        }
        let [_, wait, until, _] = self.part(stage, 2);
        (self.now + 1).wrapping_sub(*errand) >= wait as u32 && self.now >= until as u32
    }

    /// What an agent on its way to a stage, or in it, walks to.
    fn aim(
        &self,
        (agent, at, errand): (u32, [f32; 2], u32),
        stage: u32,
        (is_last, is_level): (bool, bool),
    ) -> ([f32; 4], Option<(usize, Sign)>) {
        let [x, z, radius, kind] = self.part(stage, 0);
        let [field, _, _, number] = self.part(stage, 2);
        if kind == WAYPOINT {
            return ([x, z, if is_last { STOP } else { PASS }, field], None);
        }
        let axes = self.part(stage, 1);
        if kind == QUEUE {
            let ([x, z, how], sign) = self.line_up(errand, [x, z, radius], axes, at);
            // who is on another floor neither joins nor is served
            return ([x, z, how, field], sign.filter(|_| is_level));
        }
        if kind == EXIT {
            let [x, z] = nearest_place(at, [x, z], axes);
            return ([x, z, PASS, field], None);
        }
        let mut how = PASS;
        if is_last || kind == WAITING {
            how = STANDING;
            if errand > 0 && in_region(at, [x, z], axes) {
                let inside = (self.now + 1 - errand) as f32 * self.time_step;
                how += PATIENCE * (inside - TRYING).max(0.0);
            }
        }
        let [x, z] = own_place(agent, number as u32, [x, z], axes);
        ([x, z, how, field], None)
    }

    /// The place in a line that an agent walks to, x, z, and how: its own, or if it has none the one behind the last.
    fn line_up(
        &self,
        ticket: u32,
        [x, z, radius]: [f32; 3],
        line: [f32; 4],
        at: [f32; 2],
    ) -> ([f32; 3], Option<(usize, Sign)>) {
        let base = line[3] as usize * 8;
        let first = self.lines[base + 1];
        let number = if ticket > 0 {
            (ticket - 1).wrapping_sub(first)
        } else {
            self.lines[base + 2].wrapping_sub(first).min(line[2] as u32 - 1)
        };
        let place = [x + number as f32 * line[0], z + number as f32 * line[1]];
        let to = [place[0] - at[0], place[1] - at[1]];
        if ticket > 0 {
            let is_served = number == 0 && dot2(to, to) < AT_COUNTER * AT_COUNTER;
            return ([place[0], place[1], IN_LINE], is_served.then_some((base, Sign::Served)));
        }
        let joins = dot2(to, to) < radius * radius;
        ([place[0], place[1], 0.5 * radius], joins.then_some((base, Sign::Joins)))
    }
}
