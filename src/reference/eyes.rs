//! Where eyes point, how far upper lids hang, and what the rest of the face does.

use super::body::visible_agents;
use super::exact::{atan2, hash_u32, lesser, sin_cos, unit_f32};
use super::quaternion::{dot3, dot4, limit, scale3, xyz};
use super::standing::{moods_of, own_draw};
use crate::kernels::eyes::{
    APART, ASIDE_LIMIT, BLINK, BLINK_SPAN, BLINK_WINDOW, BLINKS, BY_FIST, BY_INNER_BROW, BY_MOUTH_CORNER,
    BY_MOUTH_OPEN, BY_OUTER_BROW, BY_UPPER_LID, CLOSING, DOWN_LIMIT, DROP, FACE, FACE_RANGE, FACE_SPAN,
    FACE_WINDOW, FAR, FARTHEST, FOLLOW, GLANCE_PITCH, GLANCE_SPAN, GLANCE_WINDOW, GLANCE_YAW, GLANCES,
    GROUND_AHEAD, LEAST, LID_REACH, MOUTH, OPENING, OWN_BROW, OWN_FACE, OWN_FIST, OWN_MOUTH, OWN_STRENGTH,
    SACCADE, SHUT, Slices, UP_LIMIT,
};
use crate::kernels::layout::{Expression, FrameUniforms};
use crate::kernels::shared::attention::{ENGAGED, NATURAL, SAD};
use crate::kernels::shared::body::index::{
    HEAD, LEFT_EYE, LIDS, PALETTE_STRIDE, RIG_EYEBALL, RIG_STRIDE, RIGHT_EYE,
};

/// Twin of `shaders/eyes.wgsl`.
pub fn eyes(mut b: Slices<'_>) {
    let visible = b.visible;
    for (slot, agent) in visible_agents(visible).iter().enumerate() {
        eyes_of(&mut b, slot, *agent);
    }
}

/// An irregular moment: random bits of it and of the one before, and the time since it, ms.
struct Moment {
    draw: u32,
    before: u32,
    since: f32,
}

/// The last of an agent's irregular moments of a kind.
fn last_moment(frame: &FrameUniforms, seed: u32, window: u32, span: u32) -> Moment {
    let time = frame.gaze_time.wrapping_add(seed % window);
    let (number, within) = (time / window, time % window);
    let back = |count: u32| hash_u32(seed.wrapping_add(number).wrapping_sub(count));
    let (draw, before) = (back(0), back(1));
    if within >= draw % span {
        return Moment { draw, before, since: (within - draw % span) as f32 };
    }
    Moment { draw: before, before: back(2), since: (within + window - before % span) as f32 }
}

/// What an agent looks at in the user's face: how far to the user's right of the middle, and how far below the eyes, m.
fn part_of_face(draw: u32) -> [f32; 2] {
    match hash_u32(draw) % 5 {
        0 | 1 => [APART, 0.0],
        4 => [0.0, MOUTH],
        _ => [-APART, 0.0],
    }
}

/// Yaw and pitch from the middle.
fn glance(draw: u32) -> [f32; 2] {
    let bits = hash_u32(draw);
    let x = unit_f32(bits) * 2.0 - 1.0;
    let y = unit_f32(bits << 16) * 2.0 - 1.0;
    [GLANCE_YAW * (x * x * x), GLANCE_PITCH * (y * y * y)]
}

/// From what was looked at to what is, by the time since it changed, ms.
fn saccade(before: [f32; 2], now: [f32; 2], since: f32) -> [f32; 2] {
    let share = limit(since / SACCADE, 0.0, 1.0);
    [0, 1].map(|i| before[i] + (now[i] - before[i]) * share)
}

fn into_face(frame: &FrameUniforms, agent: u32, [x, y, z]: [f32; 3]) -> [f32; 3] {
    let ground = (x * x + z * z).sqrt();
    if ground < APART || dot3([x, y, z], [x, y, z]) > FACE_RANGE * FACE_RANGE {
        return [x, y, z];
    }
    let last = last_moment(frame, hash_u32(agent ^ FACE), FACE_WINDOW, FACE_SPAN);
    let [right, below] = saccade(part_of_face(last.before), part_of_face(last.draw), last.since);
    let aside = right / ground;
    [x + z * aside, y - below, z - x * aside]
}

fn ahead(frame: &FrameUniforms, agent: u32, heading: f32, drop: f32) -> [f32; 3] {
    let last = last_moment(frame, hash_u32(agent ^ GLANCES), GLANCE_WINDOW, GLANCE_SPAN);
    let [aside, down] = saccade(glance(last.before), glance(last.draw), last.since);
    let [sine, cosine] = sin_cos(heading + aside);
    let [fall, level] = sin_cos(drop + down);
    scale3([sine * level, -fall, cosine * level], FAR)
}

/// How far a blink has shut the eyes, 0 to 1.
fn blink(frame: &FrameUniforms, agent: u32) -> f32 {
    let Moment { since, .. } = last_moment(frame, hash_u32(agent ^ BLINKS), BLINK_WINDOW, BLINK_SPAN);
    limit(lesser(since / CLOSING, (BLINK - since) / OPENING), 0.0, 1.0)
}

/// The angle from ahead to a point that lies so far aside and ahead, as (sine, cosine), no farther than a limit.
fn toward(aside: f32, ahead: f32, most: [f32; 2]) -> [f32; 2] {
    if ahead > LEAST && aside.abs() * most[1] <= ahead * most[0] {
        let length = (aside * aside + ahead * ahead).sqrt();
        return [aside / length, ahead / length];
    }
    [if aside < 0.0 { -most[0] } else { most[0] }, most[1]]
}

fn turned(row: [f32; 4], about: [f32; 3], yaw: [f32; 2], pitch: [f32; 2]) -> [f32; 4] {
    let forward = row[0] * yaw[0] + row[2] * yaw[1];
    let x = row[0] * yaw[1] - row[2] * yaw[0];
    let y = row[1] * pitch[1] + forward * pitch[0];
    let z = forward * pitch[1] - row[1] * pitch[0];
    [x, y, z, row[3] + ((row[0] - x) * about[0] + (row[1] - y) * about[1] + (row[2] - z) * about[2])]
}

fn tipped(row: [f32; 4], about: [f32; 3], pitch: [f32; 2]) -> [f32; 4] {
    let y = row[1] * pitch[1] + row[2] * pitch[0];
    let z = row[2] * pitch[1] - row[1] * pitch[0];
    [row[0], y, z, row[3] + ((row[1] - y) * about[1] + (row[2] - z) * about[2])]
}

/// From -1 to 1.
fn own_part(agent: u32, number: u32) -> f32 {
    unit_f32(own_draw(agent, OWN_FACE, number)) * 2.0 - 1.0
}

fn bounded(number: f32) -> f32 {
    limit(number, -FARTHEST, FARTHEST)
}

/// The face of an agent; without emotions as it is at rest.
fn face_of(b: &Slices<'_>, agent: u32) -> Expression {
    let blink = blink(b.frame, agent);
    if b.frame.gaze_mode != NATURAL {
        return Expression { blink, ..Expression::default() };
    }
    let moods = moods_of(b.gait_weights[agent as usize], b.appearance[agent as usize].emotion());
    let own = b.frame.individuals;
    let strength = b.frame.expression * (1.0 + own * OWN_STRENGTH * own_part(agent, 0));
    Expression {
        inner_brow: bounded(dot4(moods, BY_INNER_BROW) * strength + own * OWN_BROW * own_part(agent, 1)),
        outer_brow: bounded(dot4(moods, BY_OUTER_BROW) * strength + own * OWN_BROW * own_part(agent, 2)),
        upper_lid: bounded(dot4(moods, BY_UPPER_LID) * strength),
        mouth_corner: bounded(dot4(moods, BY_MOUTH_CORNER) * strength + own * OWN_MOUTH * own_part(agent, 3)),
        mouth_open: bounded(dot4(moods, BY_MOUTH_OPEN) * strength),
        blink,
        fist: limit(dot4(moods, BY_FIST) * strength + own * OWN_FIST * own_part(agent, 4), 0.0, 1.0),
        unused: 0.0,
    }
}

fn eyes_of(b: &mut Slices<'_>, slot: usize, agent: u32) {
    let own = b.appearance[agent as usize];
    let avatar = own.avatar() as usize;
    let finest = b.mesh_table[avatar * b.frame.level_count as usize].first_vertex;
    let bucket = b.agent_bucket[agent as usize] as usize;
    if b.mesh_table[bucket].first_vertex != finest {
        return;
    }
    let face = face_of(b, agent);
    b.expressions[slot] = face;
    let eyeball = b.rig[avatar * RIG_STRIDE + RIG_EYEBALL];
    if eyeball[3] == 0.0 {
        return;
    }
    let left = xyz(eyeball);
    let right = [-left[0], left[1], left[2]];
    let palette = &b.palettes[slot * PALETTE_STRIDE..][..PALETTE_STRIDE];
    let head = [0, 1, 2].map(|axis| palette[HEAD * 3 + axis]);
    let is_natural = b.frame.gaze_mode == NATURAL;
    let feels = is_natural && own.gazes();
    let aim = aim(b, agent, head, left, feels);
    let [[x, ..], [y, ..], [z, ..]] = head;
    let square = x * x + y * y + z * z;
    let to = [0, 1, 2].map(|i| (head[0][i] * aim[0] + head[1][i] * aim[1] + head[2][i] * aim[2]) / square);

    let level = (to[0] * to[0] + to[2] * to[2]).sqrt();
    let [to_pitch, to_left, to_right] = if is_natural {
        [
            toward(-to[1], level, if to[1] > 0.0 { UP_LIMIT } else { DOWN_LIMIT }),
            toward(to[0] - left[0], to[2], ASIDE_LIMIT),
            toward(to[0] - right[0], to[2], ASIDE_LIMIT),
        ]
    } else {
        [[0.0, 1.0]; 3]
    };
    let open = FOLLOW * to_pitch[0] - LID_REACH * face.upper_lid;
    let lid = open + (SHUT - open) * face.blink;

    let tip = sin_cos(lid);
    let palette = &mut b.palettes[slot * PALETTE_STRIDE..][..PALETTE_STRIDE];
    for (axis, row) in head.into_iter().enumerate() {
        palette[LEFT_EYE * 3 + axis] = turned(row, left, to_left, to_pitch);
        palette[RIGHT_EYE * 3 + axis] = turned(row, right, to_right, to_pitch);
        palette[LIDS * 3 + axis] = tipped(row, left, tip);
    }
}

/// From between the eyes to what they look at, m; `left` is the centre of the left one in the mesh.
fn aim(b: &Slices<'_>, agent: u32, head: [[f32; 4]; 3], left: [f32; 3], feels: bool) -> [f32; 3] {
    let own = b.appearance[agent as usize];
    if feels && b.gaze_frame[agent as usize] & ENGAGED != 0 {
        let between = head.map(|row| row[1] * left[1] + row[2] * left[2] + row[3]);
        let to_eyes = [0, 1, 2].map(|axis| b.frame.user_eyes[axis] - between[axis]);
        return into_face(b.frame, agent, to_eyes);
    }
    let is_sad = feels && own.emotion() == SAD;
    let drop = if is_sad { atan2(left[1] * own.scale * own.stature(), GROUND_AHEAD) } else { DROP };
    ahead(b.frame, agent, b.heading[agent as usize], drop)
}
