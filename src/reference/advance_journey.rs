//! Where each agent is on its journey.

use super::exact::{dot2, greater};
use super::prefer::{Aim, Wishes};
use super::shared::{is_absent, join_cells};
use super::stages::{in_region, nearest_place, own_place};
use crate::kernels::advance_journey::{AT_COUNTER, IN_LINE, PATIENCE, STANDING, Slices, TRYING};
use crate::kernels::layout::{Route, Stage};
use crate::kernels::shared::absent::ABSENT;
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::stages::{EXIT, GOAL, PASS, QUEUE, STOP, WAITING, WAYPOINT};
use rayon::prelude::*;

/// Agents whose flow fields are read together.
const CHUNK: usize = 32;

/// Twin of `shaders/advance_journey.wgsl`.
pub fn advance_journey(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let lines: &[u32] = b.queues;
    let stages = Stages { lines, now: b.step.step_index, time_step: b.step.time_step, stages: b.stages };
    let floors = &b.floors[..b.step.floor_count as usize * FLOOR_STRIDE];
    let wishes = Wishes {
        step: b.step,
        body: b.body,
        elevation: b.elevation,
        flow_grid: b.flow_grid,
        flow_way: b.flow_way,
        floors,
    };
    let state = b.position[..agents].par_chunks_mut(CHUNK).zip(b.route[..agents].par_chunks_mut(CHUNK));
    let state = state.zip(b.stage_progress[..agents].par_chunks_mut(CHUNK));
    let state = state.zip(b.preferred_velocity[..agents].par_chunks_mut(CHUNK));
    let signs =
        state.enumerate().with_min_len(32).flat_map_iter(|(chunk, (((at, way), progress), preferred))| {
            let first = CHUNK * chunk;
            let (mut goals, mut arounds, mut signs) = ([None; CHUNK], [None; CHUNK], Vec::new());
            for i in 0..at.len() {
                if is_absent(at[i])
                    || stages.leaves(wishes.elevation[first + i], &mut at[i], &mut way[i], &mut progress[i])
                {
                    continue;
                }
                let is_last = !way[i].loops() && way[i].next + 1 >= way[i].length();
                let (agent, height) = ((first + i) as u32, wishes.elevation[first + i]);
                let walker = Walker { agent, at: at[i], height, progress: progress[i], is_last };
                let goal = stages.goal(&walker, way[i], &mut signs);
                goals[i] = Some(goal);
                arounds[i] = wishes.around(first + i, at[i], goal);
            }
            for (i, preferred) in preferred.iter_mut().enumerate() {
                let wanted = |goal| wishes.velocity(first + i, at[i], goal, arounds[i]);
                *preferred = goals[i].map_or([0.0, 0.0], wanted);
            }
            signs
        });
    for (agent, line, sign) in signs.collect::<Vec<_>>() {
        match sign {
            Sign::Joins => b.queues[line] = b.queues[line].min(agent),
            Sign::Served => b.queues[line + 3] = b.queues[line + 3].max(1),
        }
    }
    join_cells(b.step, b.position, b.cells, b.next_in_cell);
}

/// What an agent in or at a line signals, with the first element of the line.
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
    stages: &'a [Stage],
}

/// An agent on its way to a stage, or in it.
struct Walker {
    agent: u32,
    at: [f32; 2],
    /// m
    height: f32,
    /// Its `stage_progress`.
    progress: u32,
    /// Whether the stage is the last one.
    is_last: bool,
}

impl Stages<'_> {
    /// Goes on to the next stage if the present one is done. Whether that was an exit.
    fn leaves(&self, height: f32, at: &mut [f32; 2], way: &mut Route, progress: &mut u32) -> bool {
        let length = way.length();
        let stage = way.first + way.next.min(length - 1);
        if way.next >= length || !self.is_done(stage, *at, height, progress) {
            return false;
        }
        way.next += 1;
        if way.next == length {
            way.arrivals = way.arrivals.wrapping_add(1);
            if way.loops() {
                way.next = 0;
            }
        }
        let stays = way.next == length && self.of(stage).kind == GOAL;
        *progress = if stays { self.now + 1 } else { 0 };
        let is_out = self.of(stage).kind == EXIT;
        if is_out {
            *at = [ABSENT, ABSENT];
        }
        is_out
    }

    /// What an agent walks to; it may signal something to its line.
    fn goal(&self, walker: &Walker, way: Route, signs: &mut Vec<(u32, usize, Sign)>) -> Aim {
        let (goal, sign) = self.aim(walker, self.of(way.first + way.next.min(way.length() - 1)));
        signs.extend(sign.map(|(line, sign)| (walker.agent, line, sign)));
        goal
    }

    fn of(&self, stage: u32) -> &Stage {
        &self.stages[stage as usize]
    }

    /// Whether the agent is done with a stage; begins its wait where it has one.
    fn is_done(&self, stage: u32, at: [f32; 2], height: f32, progress: &mut u32) -> bool {
        let own = self.of(stage);
        let is_here = is_level(own, height);
        if own.kind == WAYPOINT {
            let to = [own.place[0] - at[0], own.place[1] - at[1]];
            return is_here && dot2(to, to) < own.radius * own.radius;
        }
        if own.kind == QUEUE {
            let [_, number] = own.across;
            return *progress > 0 && *progress <= self.lines[number as usize * 8 + 1];
        }
        let inside = is_here && in_region(at, own);
        if own.kind != WAITING {
            return inside;
        }
        if *progress == 0 {
            if !inside {
                return false;
            }
            *progress = self.now + 1;
        }
        (self.now + 1).wrapping_sub(*progress) >= own.least_wait as u32 && self.now >= own.first_leave as u32
    }

    /// What an agent on its way to a stage, or in it, walks to.
    fn aim(&self, walker: &Walker, own: &Stage) -> (Aim, Option<(usize, Sign)>) {
        let aim = |place: [f32; 2], how: f32| Aim { place, how, field: own.field };
        if own.kind == WAYPOINT {
            return (aim(own.place, if walker.is_last { STOP } else { PASS }), None);
        }
        if own.kind == QUEUE {
            let (goal, sign) = self.line_up(walker, own);
            // an agent on another floor neither joins nor is served
            return (goal, sign.filter(|_| is_level(own, walker.height)));
        }
        if own.kind == EXIT {
            return (aim(nearest_place(walker.at, own), PASS), None);
        }
        let mut how = PASS;
        if walker.is_last || own.kind == WAITING {
            how = STANDING;
            if walker.progress > 0 && in_region(walker.at, own) {
                let inside = (self.now + 1 - walker.progress) as f32 * self.time_step;
                how += PATIENCE * greater(inside - TRYING, 0.0);
            }
        }
        (aim(own_place(walker.agent, own), how), None)
    }

    /// The place in a line that an agent walks to: its own, or if it has none the one behind the last.
    fn line_up(&self, walker: &Walker, line: &Stage) -> (Aim, Option<(usize, Sign)>) {
        let [places, number] = line.across;
        let (base, ticket) = (number as usize * 8, walker.progress);
        let first = self.lines[base + 1];
        let number = if ticket > 0 {
            (ticket - 1).wrapping_sub(first)
        } else {
            self.lines[base + 2].wrapping_sub(first).min(places as u32 - 1)
        };
        let place =
            [line.place[0] + number as f32 * line.along[0], line.place[1] + number as f32 * line.along[1]];
        let to = [place[0] - walker.at[0], place[1] - walker.at[1]];
        let aim = |how: f32| Aim { place, how, field: line.field };
        if ticket > 0 {
            let is_served = number == 0 && dot2(to, to) < AT_COUNTER * AT_COUNTER;
            return (aim(IN_LINE), is_served.then_some((base, Sign::Served)));
        }
        let joins = dot2(to, to) < line.radius * line.radius;
        (aim(0.5 * line.radius), joins.then_some((base, Sign::Joins)))
    }
}

/// Whether an agent at a height, m, is on the floor of a stage.
fn is_level(stage: &Stage, height: f32) -> bool {
    stage.has_elevation == 0.0 || (height - stage.elevation).abs() < STEP
}
