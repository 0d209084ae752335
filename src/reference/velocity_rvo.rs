//! A new velocity by reciprocal velocity obstacles: sampled, 2008.

use super::contact::{disc_rate, segment_rate};
use super::crowding::{crowded, has_right_of_way};
use super::exact::dot2;
use super::neighbours::{Manners, Nearest, Slots, manners_of};
use super::orca::{NEIGHBOURS, RIGHT_OF_WAY, share_of, unit_or};
use super::segments::{NearSegments, Walls};
use super::shared::{CROWDED, NOBODY, STOREYS, on_storey};
use crate::kernels::velocity_rvo::Slices;
use rayon::prelude::*;

/// Velocities of the pattern: a spiral of the golden angle, which covers a disc evenly.
const PATTERN: u32 = 128;
/// Cosine and sine of the golden angle.
const GOLDEN: [f32; 2] = [-0.737_368_9, 0.675_490_3];
/// Contacts sooner than a tenth of a second count as that, 1/s.
const SOONEST: f32 = 10.0;
/// Each m/s that two overlapping discs lack of coming apart costs as much as a collision so many times a second, 1/m: more
/// than a contact, or who overlaps with one would stay there for fear of touching the next.
const SEPARATE: f32 = 20.0;

/// Twin of `shaders/velocity_rvo.wgsl`.
pub fn velocity_rvo(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let slots = Slots {
        step: b.step,
        slot_motion: b.slot_motion,
        slot_manners: b.slot_manners,
        cell_start: b.cell_start,
        has_storeys: b.level & STOREYS != 0,
    };
    let walls = Walls { step: b.step, obstacles: b.obstacles, obstacle_cells: b.obstacle_cells };
    let scene = Scene { slots, walls, is_crowded: b.level & CROWDED != 0 };
    b.new_velocity[..agents].par_iter_mut().with_min_len(128).enumerate().for_each(|(slot, velocity)| {
        if b.slot_manners[slot][0] == NOBODY {
            return;
        }
        let own = manners_of(b.slot_manners[slot]);
        let preferred = b.preferred_velocity[own.agent];
        *velocity = if own.is_led { preferred } else { scene.choose(slot, own, preferred) };
    });
}

/// What all agents read.
struct Scene<'a> {
    slots: Slots<'a>,
    walls: Walls<'a>,
    is_crowded: bool,
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
    radius: f32,
    others: [Other; NEIGHBOURS + 1],
    count: usize,
    walls: NearSegments,
}

impl Scene<'_> {
    fn choose(&self, slot: usize, own: Manners, preferred: [f32; 2]) -> [f32; 2] {
        let step = self.slots.step;
        let [x, y, vx, vy] = self.slots.slot_motion[slot * 2];
        let [radius, max_speed, _, elevation] = self.slots.slot_motion[slot * 2 + 1];
        let (at, present) = ([x, y], [vx, vy]);
        let nearest = self.slots.neighbours(slot, at, own.range, own.cap);
        let mut preferred = preferred;
        if self.is_crowded && !has_right_of_way(&self.slots, slot) {
            preferred = crowded(&self.slots, preferred, at, own.range, own.cap, &nearest);
        }
        let (others, count) = self.look_at_others(slot, own.rate, own.range, &nearest);
        let walls = self.walls.near(at, step.time_horizon_obstacles * max_speed + radius, elevation);
        let view = View { at, radius, others, count, walls };
        let most = step.max_acceleration * step.time_step;
        let mut turn = unit_or(preferred, unit_or(present, [1.0, 0.0]));
        let mut aim = preferred;
        if walls.count > 0 {
            // along the nearest wall
            let [_, [ax, ay, ..], _] = self.walls.segment(walls.numbers[0]);
            let along = dot2([ax, ay], preferred);
            aim = [ax * along, ay * along];
        }
        let mut best = f32::MAX;
        let mut result = present;
        for i in 0..PATTERN + 4 {
            let mut candidate = match i {
                0 => reachable(preferred, present, most),
                1 => reachable(aim, present, most),
                2 => reachable([0.0, 0.0], present, most),
                3 => present,
                _ => {
                    let length = most * (((i - 4) as f32 + 0.5) / PATTERN as f32).sqrt();
                    let candidate = [present[0] + turn[0] * length, present[1] + turn[1] * length];
                    turn = [
                        turn[0] * GOLDEN[0] - turn[1] * GOLDEN[1],
                        turn[0] * GOLDEN[1] + turn[1] * GOLDEN[0],
                    ];
                    candidate
                }
            };
            let speed2 = dot2(candidate, candidate);
            if speed2 > max_speed * max_speed {
                let scale = max_speed / speed2.sqrt();
                candidate = [candidate[0] * scale, candidate[1] * scale];
            }
            let off = [preferred[0] - candidate[0], preferred[1] - candidate[1]];
            let distance = dot2(off, off).sqrt();
            if distance < best {
                let cost = distance + self.danger(candidate, &view);
                if cost < best {
                    (best, result) = (cost, candidate);
                }
            }
        }
        result
    }

    /// What a velocity costs beside its distance from the preferred one.
    fn danger(&self, velocity: [f32; 2], view: &View) -> f32 {
        let step = self.slots.step;
        let (mut worst, mut lack) = (0.0_f32, 0.0_f32);
        for other in &view.others[..view.count] {
            let relative =
                [velocity[0] * other.factor - other.offset[0], velocity[1] * other.factor - other.offset[1]];
            if other.apart > 0.0 {
                lack += (other.apart + dot2(relative, other.place)).max(0.0);
            } else {
                let there = disc_rate(other.place, relative, other.radius, SOONEST);
                worst = worst.max(there - other.rate);
            }
        }
        for &number in &view.walls.numbers[..view.walls.count] {
            let [[ax, ay, bx, by], [along_x, along_y, ..], _] = self.walls.segment(number);
            let (to_a, to_b) = ([ax - view.at[0], ay - view.at[1]], [bx - view.at[0], by - view.at[1]]);
            let along = [along_x, along_y];
            let there = segment_rate(to_a, to_b, along, velocity, view.radius, SOONEST);
            worst = worst.max(there - step.inverse_time_horizon_obstacles);
        }
        step.collision_weight * (worst + SEPARATE * lack)
    }

    /// The user and the neighbours, nearest first, and how many count.
    fn look_at_others(
        &self,
        slot: usize,
        own_rate: f32,
        range: f32,
        nearest: &Nearest,
    ) -> ([Other; NEIGHBOURS + 1], usize) {
        let step = self.slots.step;
        let [x, y, vx, vy] = self.slots.slot_motion[slot * 2];
        let [own_radius, max_speed, own_priority, elevation] = self.slots.slot_motion[slot * 2 + 1];
        let mut others = [Other::default(); NEIGHBOURS + 1];
        let mut count = 0;
        let mut look = |theirs: [f32; 4], their_radius: f32, share: f32, side: f32| {
            let has_way = share <= 0.0;
            let factor = 1.0 / if has_way { 1.0 } else { share };
            let rate = if has_way { own_rate.max(RIGHT_OF_WAY) } else { own_rate };
            let to = [theirs[0] - x, theirs[1] - y];
            let radius = own_radius + their_radius + step.safety_margin;
            let distance = dot2(to, to).sqrt();
            let offset = [vx * (factor - 1.0) + theirs[2], vy * (factor - 1.0) + theirs[3]];
            let (mut place, mut apart) = (to, 0.0);
            if distance < radius {
                place = unit_or(to, [side, 0.0]);
                apart = ((radius - distance) * step.inverse_time_step).min(max_speed);
            }
            others[count] = Other { place, offset, factor, radius, apart, rate };
            count += 1;
        };
        let ([ux, uy], [uvx, uvy]) = (step.user_position, step.user_velocity);
        let to_user = [ux - x, uy - y];
        let is_near =
            dot2(to_user, to_user) < range * range && on_storey(step, elevation, step.user_elevation);
        if step.user_radius > 0.0 && is_near {
            look([ux, uy, uvx, uvy], step.user_radius, 1.0, -1.0);
        }
        for other in &nearest.slots[..nearest.count] {
            let other = *other as usize;
            let [radius, _, priority, _] = self.slots.slot_motion[other * 2 + 1];
            let share = share_of(step.responsibility, own_priority, priority);
            let side = if slot < other { -1.0 } else { 1.0 };
            look(self.slots.slot_motion[other * 2], radius, share, side);
        }
        (others, count)
    }
}

/// The velocity nearest to `wanted` within `most` m/s of the present one.
pub(super) fn reachable(wanted: [f32; 2], present: [f32; 2], most: f32) -> [f32; 2] {
    let change = [wanted[0] - present[0], wanted[1] - present[1]];
    let length = dot2(change, change).sqrt();
    if length > most {
        let scale = most / length;
        return [present[0] + change[0] * scale, present[1] + change[1] * scale];
    }
    wanted
}
