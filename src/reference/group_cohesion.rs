//! Keeps groups together.

use super::exact::{atan2, det2, dot2, greater, lesser};
use super::shared::is_absent;
use crate::kernels::group_cohesion::{
    APART, FORWARD, GATHER, GAZE, HASTE, LEFT_BEHIND, PERSONAL, RAMP, RELAXATION, STRAY, Slices,
};
use crate::kernels::layout::{Body, Route};
use crate::kernels::shared::absent::NOBODY;
use rayon::prelude::*;

/// Twin of `shaders/group_cohesion.wgsl`.
pub fn group_cohesion(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let Slices { position, body, route, companions, .. } = b;
    for (agent, (slot, others)) in (0..).zip(b.agent_slot.iter().zip(companions)).take(agents) {
        let first = others.iter().copied().fold(NOBODY, u32::min);
        if first != NOBODY && *slot < b.step.agent_count && !is_absent(position[agent as usize]) {
            let slot = *slot as usize;
            b.slot_motion[slot].join(first.min(agent));
            let agent = agent as usize;
            let behind = behind(agent, *others, b.preferred_velocity[agent], &position[..agents]);
            // no priority of people is above 1: what is above belongs to robots, and to the right of way that is given
            let priority = &mut b.slot_motion[slot].priority;
            *priority = greater(*priority, lesser(*priority + HASTE * lesser(behind, LEFT_BEHIND), 1.0));
        }
    }
    b.preferred_velocity[..agents].par_iter_mut().enumerate().with_min_len(1024).for_each(
        |(agent, preferred)| {
            if !is_absent(position[agent]) {
                *preferred = together(agent, companions[agent], *preferred, &position[..agents], body, route);
            }
        },
    );
}

/// How far the first of the group is ahead of an agent of preferred velocity `wanted` (m/s), m; 0 for the first.
fn behind(agent: usize, others: [u32; 4], wanted: [f32; 2], position: &[[f32; 2]]) -> f32 {
    let at = position[agent];
    let ahead = others
        .into_iter()
        .filter_map(|other| position.get(other as usize))
        .filter(|other| !is_absent(**other))
        .fold(0.0_f32, |most, other| greater(most, -dot2([at[0] - other[0], at[1] - other[1]], wanted)));
    if ahead > 0.0 { ahead / dot2(wanted, wanted).sqrt() } else { 0.0 }
}

fn together(
    agent: usize,
    others: [u32; 4],
    preferred: [f32; 2],
    position: &[[f32; 2]],
    body: &[Body],
    route: &[Route],
) -> [f32; 2] {
    let (at, own_way) = (position[agent], route[agent]);
    let mut pace = body[agent].preferred_speed;
    let (mut others_sum, mut away, mut count) = ([0.0_f32; 2], [0.0_f32; 2], 0.0_f32);
    for other in others {
        let other = other as usize;
        if other >= position.len() || is_absent(position[other]) {
            continue;
        }
        pace = lesser(pace, body[other].preferred_speed);
        let way = route[other];
        let off = [at[0] - position[other][0], at[1] - position[other][1]];
        let distance = dot2(off, off).sqrt();
        if distance < PERSONAL && distance > 0.0 {
            let scale = lesser((PERSONAL - distance) / RAMP, 1.0) / distance;
            away = [away[0] + off[0] * scale, away[1] + off[1] * scale];
        }
        let is_ahead = (way.arrivals, way.next) > (own_way.arrivals, own_way.next);
        if !is_ahead {
            others_sum = [others_sum[0] + position[other][0], others_sum[1] + position[other][1]];
            count += 1.0;
        }
    }
    let mut wanted = preferred;
    let own_speed = body[agent].preferred_speed;
    if own_speed > pace {
        let scale = pace / own_speed;
        wanted = [wanted[0] * scale, wanted[1] * scale];
    }
    let speed = dot2(wanted, wanted).sqrt();
    if !(speed > 0.0) {
        return wanted;
    }
    let direction = [wanted[0] / speed, wanted[1] / speed];
    let mut shift = [away[0] * (APART * RELAXATION), away[1] * (APART * RELAXATION)];
    if count > 0.0 {
        let to = [others_sum[0] / count - at[0], others_sum[1] / count - at[1]];
        let along = dot2(to, direction);
        let turn = atan2(greater(-along, 0.0), det2(direction, to).abs());
        let slower = GAZE * RELAXATION * turn;
        let slower = slower / (1.0 + slower);
        shift = [shift[0] - wanted[0] * slower, shift[1] - wanted[1] * slower];
        let share = count / (count + 1.0);
        let gather = [to[0] * share, to[1] * share];
        let distance = dot2(gather, gather).sqrt();
        let too_far = distance - 0.5 * count;
        if too_far > 0.0 {
            let scale = lesser(GATHER * RELAXATION * lesser(too_far / RAMP, 1.0), STRAY * speed) / distance;
            shift = [shift[0] + gather[0] * scale, shift[1] + gather[1] * scale];
        }
    }
    let sum = [wanted[0] + shift[0], wanted[1] + shift[1]];
    let forward = dot2(sum, direction);
    let least = FORWARD * speed;
    if forward < least {
        let missing = least - forward;
        return [sum[0] + direction[0] * missing, sum[1] + direction[1] * missing];
    }
    sum
}
