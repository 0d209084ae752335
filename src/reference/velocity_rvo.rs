//! A new velocity by reciprocal velocity obstacles: sampled, 2008.

use super::contact::{disc_rates, segment_rate};
use super::crowding::{crowded, has_right_of_way};
use super::exact::{dot2, greater, lesser};
use super::neighbours::{Nearest, Seeker, Slots, seeker_of};
use super::orca::{share_of, unit_or};
use super::segments::{NearSegments, Walls};
use super::shared::on_storey;
use crate::kernels::layout::{Segment, SlotMotion};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::contents::{CROWDED, GROUPS, STOREYS, UNLIKE, USER};
use crate::kernels::shared::neighbours::SAFE;
use crate::kernels::shared::orca::index::NEIGHBOURS;
use crate::kernels::shared::orca::{RIGHT_OF_WAY, TOGETHER};
use crate::kernels::velocity_rvo::{FOURS, GOLDEN, GOLDEN_4, SEPARATE, SOONEST, Slices};
use rayon::prelude::*;

/// Twin of phase `velocity_rvo` of `shaders/velocity_rvo.wgsl`.
///
/// The shader leaves agents that have to search to a second phase, so that invocations side by side do alike. Here the first
/// does all, and the second nothing.
pub fn velocity_rvo(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let slots = Slots {
        step: b.step,
        slot_position: b.slot_position,
        slot_motion: b.slot_motion,
        cell_start: b.cell_start,
        has_storeys: b.contents & STOREYS != 0,
    };
    let walls = Walls { step: b.step, obstacles: b.obstacles, obstacle_cells: b.obstacle_cells };
    let neighbourhood = Neighbourhood { slots, walls, preferred: b.preferred_velocity, contents: b.contents };
    b.new_velocity[..agents].par_iter_mut().with_min_len(128).enumerate().for_each(|(slot, velocity)| {
        if b.slot_motion[slot].agent == NOBODY {
            return;
        }
        let own = seeker_of(&b.slot_motion[slot], b.avoidance, b.contents);
        let preferred = b.preferred_velocity[own.agent];
        *velocity = if own.is_led { preferred } else { neighbourhood.new_velocity(slot, own, preferred) };
    });
}

/// Twin of phase `again`: all is done.
pub fn velocity_rvo_again(_: Slices<'_>) {}

/// What all agents read.
struct Neighbourhood<'a> {
    slots: Slots<'a>,
    walls: Walls<'a>,
    /// `[agent]` m/s
    preferred: &'a [[f32; 2]],
    contents: u32,
}

/// The user or a neighbour.
#[derive(Clone, Copy, Default)]
struct Other {
    /// Where the disc is, m; if it overlaps, its direction.
    place: [f32; 2],
    /// What is taken from the own velocity over the share, m/s.
    offset: [f32; 2],
    /// 1 / share of the avoidance.
    factor: f32,
    /// Sum of the radii, m.
    radius: f32,
    /// Speed at which an overlap is to end, m/s; 0: there is none.
    apart: f32,
    /// 1 / horizon, 1/s.
    rate: f32,
}

/// What an agent looks at.
struct View {
    at: [f32; 2],
    present: [f32; 2],
    preferred: [f32; 2],
    radius: f32,
    max_speed: f32,
    /// Greatest change of velocity in a step, m/s.
    most: f32,
    others: [Other; NEIGHBOURS + 1],
    count: usize,
    walls: NearSegments,
}

impl Neighbourhood<'_> {
    fn new_velocity(&self, slot: usize, own: Seeker, preferred: [f32; 2]) -> [f32; 2] {
        let step = self.slots.step;
        let at = self.slots.slot_position[slot];
        let SlotMotion { velocity: present, radius, max_speed, elevation, .. } = self.slots.slot_motion[slot];
        let nearest = self.slots.neighbours(slot, at, own.range, own.cap);
        let mut preferred = preferred;
        if self.contents & CROWDED != 0 && !has_right_of_way(&self.slots, slot) {
            preferred = crowded(&self.slots, self.preferred, slot, own, preferred, &nearest, self.contents);
        }
        let most = step.max_acceleration * step.time_step;
        let (others, count) = self.look_at_others(slot, own, most, &nearest);
        let walls = self.walls.near(at, step.time_horizon_obstacles * max_speed + radius, elevation);
        let view = View { at, present, preferred, radius, max_speed, most, others, count, walls };
        let wanted = view.slowed(&view.reachable(&Four::all(preferred)));
        if self.danger(&wanted, &view, &[0.0; 4], f32::MAX)[0] <= 0.0 {
            wanted.at(0)
        } else {
            self.choose(&view)
        }
    }

    /// The best velocity of a pattern over all that can be reached.
    fn choose(&self, view: &View) -> [f32; 2] {
        let View { present, preferred, most, .. } = *view;
        let mut aim = preferred;
        if view.walls.count > 0 {
            // along the nearest wall
            let [ax, ay] = self.walls.segment(view.walls.numbers[0]).along;
            let along = dot2([ax, ay], preferred);
            aim = [ax * along, ay * along];
        }
        let mut best = Best { velocity: present, cost: f32::MAX };
        // as wanted, along the wall, stopping, going on
        let first =
            Four { x: [preferred[0], aim[0], 0.0, present[0]], y: [preferred[1], aim[1], 0.0, present[1]] };
        self.better(&mut best, &view.reachable(&first), view);
        let mut turn = Four::all(unit_or(preferred, unit_or(present, [1.0, 0.0])));
        for i in 1..4 {
            let [x, y] = turned(turn.at(i - 1), GOLDEN);
            (turn.x[i], turn.y[i]) = (x, y);
        }
        for i in 0..FOURS {
            let first = (4 * i) as f32;
            let length = each(|k| most * ((first + (k as f32 + 0.5)) / (4 * FOURS) as f32).sqrt());
            let wanted = Four {
                x: each(|k| present[0] + turn.x[k] * length[k]),
                y: each(|k| present[1] + turn.y[k] * length[k]),
            };
            self.better(&mut best, &wanted, view);
            turn = turn.turned();
        }
        best.velocity
    }

    /// The best so far or one of four velocities: whichever costs least, the first of those that cost the same.
    fn better(&self, best: &mut Best, wanted: &Four, view: &View) {
        let candidates = view.slowed(wanted);
        let distance = each(|i| {
            let off = [view.preferred[0] - candidates.x[i], view.preferred[1] - candidates.y[i]];
            dot2(off, off).sqrt()
        });
        let danger = self.danger(&candidates, view, &distance, best.cost);
        for i in 0..4 {
            let cost = distance[i] + danger[i];
            if cost < best.cost {
                *best = Best { velocity: candidates.at(i), cost };
            }
        }
    }

    /// What velocities cost beside their `distance` from the preferred one, m/s; or parts of that, once all four cost
    /// `enough` together with their distance.
    fn danger(&self, v: &Four, view: &View, distance: &[f32; 4], enough: f32) -> [f32; 4] {
        let step = self.slots.step;
        let (mut worst, mut lack) = ([0.0_f32; 4], [0.0_f32; 4]);
        let cost = |worst: &[f32; 4], lack: &[f32; 4]| {
            each(|i| step.collision_weight * (worst[i] + SEPARATE * lack[i]))
        };
        for other in &view.others[..view.count] {
            let x = each(|i| v.x[i] * other.factor - other.offset[0]);
            let y = each(|i| v.y[i] * other.factor - other.offset[1]);
            if other.apart > 0.0 {
                lack = each(|i| {
                    lack[i] + greater(other.apart + (x[i] * other.place[0] + y[i] * other.place[1]), 0.0)
                });
            } else {
                let there = disc_rates(other.place, &x, &y, other.radius, SOONEST);
                worst = each(|i| greater(worst[i], there[i] - other.rate));
            }
            let cost = cost(&worst, &lack);
            if (0..4).all(|i| distance[i] + cost[i] >= enough) {
                return cost;
            }
        }
        for &number in &view.walls.numbers[..view.walls.count] {
            let Segment { a: [ax, ay], b: [bx, by], along, .. } = *self.walls.segment(number);
            let (to_a, to_b) = ([ax - view.at[0], ay - view.at[1]], [bx - view.at[0], by - view.at[1]]);
            let rate = |i| segment_rate(to_a, to_b, along, v.at(i), view.radius, SOONEST);
            worst = each(|i| greater(worst[i], rate(i) - step.inverse_time_horizon_obstacles));
        }
        cost(&worst, &lack)
    }

    /// The user and the neighbours that can matter, nearest first, and how many. The list leaves out a neighbour that cannot
    /// come nearer than its horizon allows, whichever velocity the agent chooses.
    fn look_at_others(
        &self,
        slot: usize,
        own: Seeker,
        most: f32,
        nearest: &Nearest,
    ) -> ([Other; NEIGHBOURS + 1], usize) {
        let step = self.slots.step;
        let me = self.slots.slot_motion[slot];
        let ([x, y], [vx, vy], max_speed) = (self.slots.slot_position[slot], me.velocity, me.max_speed);
        // an agent above its maximum speed slows down by more than `most`
        let excess = greater(dot2([vx, vy], [vx, vy]).sqrt() - max_speed, 0.0);
        let change = most + excess;
        let mut others = [Other::default(); NEIGHBOURS + 1];
        let mut count = 0;
        let mut look =
            |[their_x, their_y]: [f32; 2], theirs: &SlotMotion, share: f32, side: f32, is_mate: bool| {
                let has_way = share <= 0.0;
                let factor = 1.0 / if has_way { 1.0 } else { share };
                let rate = if has_way { greater(own.rate, RIGHT_OF_WAY) } else { own.rate };
                // members of a group walk near one another on purpose
                let rate = if is_mate { greater(rate, TOGETHER) } else { rate };
                let to = [their_x - x, their_y - y];
                let radius = me.radius + theirs.radius + step.safety_margin;
                let distance = dot2(to, to).sqrt();
                let [their_vx, their_vy] = theirs.velocity;
                let offset = [vx * (factor - 1.0) + their_vx, vy * (factor - 1.0) + their_vy];
                let (mut place, mut apart) = (to, 0.0);
                if distance < radius {
                    place = unit_or(to, [side, 0.0]);
                    apart = lesser((radius - distance) * step.inverse_time_step, max_speed);
                } else {
                    let closing = dot2(to, [vx - their_vx, vy - their_vy]) + change * factor * distance;
                    if !(closing > SAFE * rate * (distance - radius) * distance) {
                        return;
                    }
                }
                others[count] = Other { place, offset, factor, radius, apart, rate };
                count += 1;
            };
        let to_user = [step.user_position[0] - x, step.user_position[1] - y];
        let is_near = dot2(to_user, to_user) < own.range * own.range
            && on_storey(step, me.elevation, step.user_elevation);
        if self.contents & USER != 0 && is_near {
            let user = SlotMotion {
                velocity: step.user_velocity,
                radius: step.user_radius,
                ..SlotMotion::default()
            };
            look(step.user_position, &user, 1.0, -1.0, false);
        }
        for other in &nearest.slots[..nearest.count] {
            let other = *other as usize;
            let them = &self.slots.slot_motion[other];
            let is_mate = self.contents & GROUPS != 0 && self.slots.are_together(slot, other);
            // priorities do not count within a group
            let share = if self.contents & UNLIKE != 0 && !is_mate {
                share_of(step.responsibility, them.priority - me.priority)
            } else {
                step.responsibility
            };
            let side = if slot < other { -1.0 } else { 1.0 };
            look(self.slots.slot_position[other], them, share, side, is_mate);
        }
        (others, count)
    }
}

/// The best velocity so far, m/s, and what it costs.
struct Best {
    velocity: [f32; 2],
    cost: f32,
}

/// Four velocities or directions, looked at together: a compiler makes one instruction of the four.
struct Four {
    x: [f32; 4],
    y: [f32; 4],
}

/// The same of each of four.
fn each(value: impl FnMut(usize) -> f32) -> [f32; 4] {
    std::array::from_fn(value)
}

impl Four {
    fn all([x, y]: [f32; 2]) -> Self {
        Self { x: [x; 4], y: [y; 4] }
    }

    fn at(&self, i: usize) -> [f32; 2] {
        [self.x[i], self.y[i]]
    }

    /// Four golden angles on.
    fn turned(&self) -> Self {
        let [gx, gy] = GOLDEN_4;
        Self { x: each(|i| self.x[i] * gx - self.y[i] * gy), y: each(|i| self.x[i] * gy + self.y[i] * gx) }
    }
}

impl View {
    /// The velocities nearest to these within `most` m/s of the present one.
    fn reachable(&self, wanted: &Four) -> Four {
        let x = each(|i| wanted.x[i] - self.present[0]);
        let y = each(|i| wanted.y[i] - self.present[1]);
        let length = each(|i| (x[i] * x[i] + y[i] * y[i]).sqrt());
        let is_far = |i: usize| length[i] > self.most;
        let scale = each(|i| self.most / if is_far(i) { length[i] } else { 1.0 });
        Four {
            x: each(|i| if is_far(i) { self.present[0] + x[i] * scale[i] } else { wanted.x[i] }),
            y: each(|i| if is_far(i) { self.present[1] + y[i] * scale[i] } else { wanted.y[i] }),
        }
    }

    /// Not faster than the agent can walk.
    fn slowed(&self, v: &Four) -> Four {
        let speed2 = each(|i| v.x[i] * v.x[i] + v.y[i] * v.y[i]);
        let is_fast = |i: usize| speed2[i] > self.max_speed * self.max_speed;
        let scale = each(|i| self.max_speed / (if is_fast(i) { speed2[i] } else { 1.0 }).sqrt());
        Four {
            x: each(|i| if is_fast(i) { v.x[i] * scale[i] } else { v.x[i] }),
            y: each(|i| if is_fast(i) { v.y[i] * scale[i] } else { v.y[i] }),
        }
    }
}

fn turned(v: [f32; 2], by: [f32; 2]) -> [f32; 2] {
    [v[0] * by[0] - v[1] * by[1], v[0] * by[1] + v[1] * by[0]]
}
