//! Frees an agent that makes no progress: right of way in turns, and wall following.

use super::contact::segment_rate;
use super::exact::{dot2, greater, hash_u32, unit_f32};
use super::neighbours::Slots;
use super::orca::unit_or;
use super::segments::{NearSegments, Walls};
use super::shared::grid_cell;
use crate::kernels::layout::{Segment, SlotMotion, StepUniforms, Waiting};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::shared::step::RAISE;
use crate::kernels::unjam::{
    BESIDE, CLEAR, CORNERED, GAINED, NEAREST_RATE, ONE_OF_TWO, OPPOSED, PROGRESS, SLANTED, STANDING, Slices,
    THIN, TOUCHED, TURN,
};

/// The slot, direction and speed of an agent that wants to go somewhere by itself.
fn walker(b: &mut Slices<'_>, agent: usize) -> Option<(usize, [f32; 2], f32)> {
    let slot = b.agent_slot[agent];
    if slot == NOBODY {
        b.waiting[agent] = Waiting::default();
        return None;
    }
    if b.slot_motion[slot as usize].is_led() {
        return None;
    }
    let preferred = b.preferred_velocity[agent];
    let speed = dot2(preferred, preferred).sqrt();
    if speed < STANDING {
        b.waiting[agent] = Waiting::default();
        return None;
    }
    Some((slot as usize, [preferred[0] / speed, preferred[1] / speed], speed))
}

fn slots<'a>(b: &'a Slices<'_>) -> Slots<'a> {
    Slots {
        step: b.step,
        slot_position: b.slot_position,
        slot_motion: b.slot_motion,
        cell_start: b.cell_start,
        has_storeys: b.step.storey_height > 0.0,
    }
}

/// Twin of phase `turns` of `shaders/unjam.wgsl`.
pub fn unjam_turns(mut b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        let Some((slot, ahead, speed)) = walker(&mut b, agent) else { continue };
        let mut state = b.waiting[agent];
        if take_turns(&slots(&b), b.preferred_velocity, slot, ahead, speed, &mut state) {
            b.slot_motion[slot].priority += RAISE;
        }
        b.waiting[agent] = state;
    }
}

/// Twin of phase `walls` of `shaders/unjam.wgsl`.
pub fn unjam_walls(mut b: Slices<'_>) {
    let walls = Walls { step: b.step, obstacles: b.obstacles, obstacle_cells: b.obstacle_cells };
    for agent in 0..b.step.agent_count as usize {
        let Some((slot, ahead, speed)) = walker(&mut b, agent) else { continue };
        let mut state = b.waiting[agent];
        if let Some(direction) = follow_walls(&walls, &slots(&b), agent as u32, slot, ahead, &mut state) {
            b.preferred_velocity[agent] = [direction[0] * speed, direction[1] * speed];
        }
        b.waiting[agent] = state;
    }
}

/// Whether it has the right of way now.
fn take_turns(
    slots: &Slots<'_>,
    preferred: &[[f32; 2]],
    slot: usize,
    ahead: [f32; 2],
    speed: f32,
    state: &mut Waiting,
) -> bool {
    let step = slots.step;
    let progress = dot2(slots.slot_motion[slot].velocity, ahead);
    let pace = if progress < PROGRESS * speed { 1.0 } else { -2.0 };
    state.stuck = greater(state.stuck + pace * step.time_step, 0.0);
    if state.side != 0.0 {
        state.lost -= progress * step.time_step;
    }
    state.stuck > step.patience
        && dot2(turn(step), ahead) > 0.0
        && is_opposed(slots, preferred, slot, slots.slot_position[slot], ahead)
}

/// The direction in which it follows a wall, if it does.
fn follow_walls(
    walls: &Walls<'_>,
    slots: &Slots<'_>,
    agent: u32,
    slot: usize,
    ahead: [f32; 2],
    state: &mut Waiting,
) -> Option<[f32; 2]> {
    let step = walls.step;
    let position = slots.slot_position[slot];
    let SlotMotion { radius, elevation, .. } = slots.slot_motion[slot];
    let is_following = state.side != 0.0;
    if state.stuck <= step.patience && !is_following {
        return None;
    }
    let near = walls.near(position, CLEAR + radius, elevation);
    let (rate, wall, nearer_end) = way_ahead(walls, &near, position, ahead, THIN * radius);
    if !is_following
        && rate > 1.0 / (TOUCHED + (1.0 - THIN) * radius)
        && !is_someone_ahead(slots, slot, position, ahead)
    {
        let drawn = (hash_u32(agent ^ hash_u32(step.seed)) & 1) == 1;
        let by_end = if nearer_end.abs() < ONE_OF_TWO { drawn } else { nearer_end > 0.0 };
        let along = dot2(ahead, wall);
        let is_slanted = along.abs() >= SLANTED;
        let way = if along > 0.0 { 1.0 } else { -1.0 };
        let slide = [wall[0] * way, wall[1] * way];
        // along a slanted wall every agent slides anyway, up to a corner
        if !is_slanted || is_cornered(walls, &near, position, slide, radius) {
            let is_forward = if is_slanted { along > 0.0 } else { by_end };
            state.side = if is_forward { 1.0 } else { -1.0 };
            state.lost = 0.0;
        }
    } else if is_following && (near.count == 0 || (state.lost < -GAINED && rate < 1.0 / CLEAR)) {
        *state = Waiting::default();
    }
    (state.side != 0.0).then(|| beside_wall(walls, &near, position, state.side, radius))
}

/// Whether an agent ahead wants to go the other way.
fn is_opposed(slots: &Slots<'_>, preferred: &[[f32; 2]], slot: usize, at: [f32; 2], ahead: [f32; 2]) -> bool {
    let step = slots.step;
    let [cx, cy] = grid_cell(at, step);
    let (columns, rows) = (step.grid_columns as i32, step.grid_rows as i32);
    ((cy - 2).max(0)..=(cy + 2).min(rows - 1)).any(|y| {
        let cell = |x: i32| slots.cell_start[(y * columns + x) as usize] as usize;
        (cell((cx - 2).max(0))..cell((cx + 2).min(columns - 1) + 1)).any(|other| {
            let [x, y] = slots.slot_position[other];
            let to = [x - at[0], y - at[1]];
            let wanted = preferred[slots.slot_motion[other].agent as usize];
            let (speed2, against) = (dot2(wanted, wanted), -dot2(wanted, ahead));
            dot2(to, to) < OPPOSED * OPPOSED
                && dot2(to, ahead) > 0.0
                && speed2 > STANDING * STANDING
                && against > 0.0
                && 12.0 * against * against > speed2
                && slots.same_storey(other, slot)
        })
    })
}

/// The present direction of the right of way: agents that want to go to this side have it.
fn turn(step: &StepUniforms) -> [f32; 2] {
    let turn = step.step_index / ((TURN * step.inverse_time_step) as u32).max(1);
    let bits = hash_u32(turn ^ hash_u32(step.seed ^ 0x7475_726e));
    [unit_f32(bits) - 0.5, unit_f32(hash_u32(bits)) - 0.5]
}

/// Whether an agent is ahead within a metre and 60 degrees: then not the wall blocks the way.
fn is_someone_ahead(slots: &Slots<'_>, slot: usize, at: [f32; 2], ahead: [f32; 2]) -> bool {
    let step = slots.step;
    let [cx, cy] = grid_cell(at, step);
    let (columns, rows) = (step.grid_columns as i32, step.grid_rows as i32);
    ((cy - 2).max(0)..=(cy + 2).min(rows - 1)).any(|y| {
        let cell = |x: i32| slots.cell_start[(y * columns + x) as usize] as usize;
        (cell((cx - 2).max(0))..cell((cx + 2).min(columns - 1) + 1)).any(|other| {
            let [x, y] = slots.slot_position[other];
            let to = [x - at[0], y - at[1]];
            let (distance2, along) = (dot2(to, to), dot2(to, ahead));
            let is_ahead = along > 0.0 && 4.0 * along * along > distance2;
            other != slot && distance2 < 1.0 && is_ahead && slots.same_storey(other, slot)
        })
    })
}

/// 1 / distance at which the disc touches a wall when it goes straight on, 1/m, 0 for none; that wall's direction; how much
/// nearer its second end is than its first, m.
fn way_ahead(
    walls: &Walls<'_>,
    near: &NearSegments,
    at: [f32; 2],
    ahead: [f32; 2],
    radius: f32,
) -> (f32, [f32; 2], f32) {
    let mut found = (0.0, [0.0, 0.0], 0.0);
    for &number in &near.numbers[..near.count] {
        let Segment { a: [ax, ay], b: [bx, by], along, .. } = *walls.segment(number);
        let (to_a, to_b) = ([ax - at[0], ay - at[1]], [bx - at[0], by - at[1]]);
        let rate = segment_rate(to_a, to_b, along, ahead, radius, NEAREST_RATE);
        if rate > found.0 {
            let nearer_end = dot2(along, [at[0] - ax, at[1] - ay]) - dot2(along, [bx - at[0], by - at[1]]);
            found = (rate, along, nearer_end);
        }
    }
    found
}

/// Whether a wall is so near that one cannot go on in a direction.
fn is_cornered(
    walls: &Walls<'_>,
    near: &NearSegments,
    at: [f32; 2],
    direction: [f32; 2],
    radius: f32,
) -> bool {
    near.numbers[..near.count].iter().any(|&number| {
        let to = to_wall(walls, number, at);
        let (along, distance2, near) = (dot2(to, direction), dot2(to, to), radius + CORNERED);
        distance2 < near * near && along > 0.0 && 25.0 * along * along > distance2
    })
}

/// The way to the nearest point of a segment.
fn to_wall(walls: &Walls<'_>, number: u32, at: [f32; 2]) -> [f32; 2] {
    let Segment { a: [ax, ay], b: [bx, by], .. } = *walls.segment(number);
    let ab = [bx - ax, by - ay];
    let t = (dot2([at[0] - ax, at[1] - ay], ab) / dot2(ab, ab)).clamp(0.0, 1.0);
    [ax + ab[0] * t - at[0], ay + ab[1] * t - at[1]]
}

/// The direction along the nearest wall (along its segments for side 1, against for -1), or along the next one if that
/// leads into a corner; a little towards or away from it, to keep a gap.
fn beside_wall(walls: &Walls<'_>, near: &NearSegments, at: [f32; 2], side: f32, radius: f32) -> [f32; 2] {
    let mut direction = [0.0, 0.0];
    for (i, &number) in near.numbers[..near.count].iter().enumerate() {
        let to = to_wall(walls, number, at);
        let distance = dot2(to, to).sqrt();
        let inward = unit_or(to, [1.0, 0.0]);
        if i == 0 || (distance < radius + CORNERED && dot2(inward, direction) > 0.2) {
            let gap = (distance - radius - BESIDE).clamp(-0.5, 0.5);
            let wanted = [inward[1] * side + inward[0] * gap, -inward[0] * side + inward[1] * gap];
            direction = unit_or(wanted, inward);
        }
    }
    direction
}
