//! Feet where the strides have them, and legs that reach them.

use super::body::{joint_forward, joint_translation, visible_agents};
use super::exact::{atan2, greater, lesser, sin_cos};
use super::quaternion::{
    add3, cross3, dot3, limit, quat_before_yaw, quat_conjugate, quat_from_rows, quat_lerp, quat_mul,
    quat_normalize, quat_pitch_roll, quat_rotate, scale3, sub3, turn_left, xyz,
};
use super::standing::{left_ahead, stance_of, walk_share};
use crate::kernels::feet::index::{LEFT_LEG, RIGHT_LEG};
use crate::kernels::feet::{
    FLATTER, FROM_ANKLES, HEEL, KNEES_AHEAD, LEAST_AHEAD, LEAST_BEND, LEAST_LIFT, LOWER, MOST_SUNK,
    NECK_TURNS, NOT_SEEN, PELVIS_STAYS, PUSHES_MORE, REACHES, STEEPEST, STRAIGHT, STRAIGHTER, Slices,
    TURNS_MORE, UPRIGHT,
};
use crate::kernels::layout::{Appearance, Stance};
use crate::kernels::shared::body::index::{HEAD, JOINTS, NECK, POSE_STRIDE, RIG_BALLS, RIG_STRIDE, SPINE};
use crate::kernels::shared::standing::STANCE_WIDTH;
use rayon::prelude::*;

/// A leg in model space: places in m, rotations from the joints.
#[derive(Clone, Copy)]
struct Leg {
    hip: [f32; 3],
    knee: [f32; 3],
    ankle: [f32; 3],
    thigh: [f32; 4],
    shin: [f32; 4],
    foot: [f32; 4],
}

/// A leg as `pose` left it.
fn leg_of(pose: &[[f32; 4]], rig: &[[f32; 4]], avatar: usize, first: usize) -> Leg {
    let hip = add3(xyz(pose[JOINTS]), quat_rotate(pose[0], joint_translation(rig, avatar, first)));
    let thigh = quat_mul(pose[0], pose[first]);
    let knee = add3(hip, quat_rotate(thigh, joint_translation(rig, avatar, first + 1)));
    let shin = quat_mul(thigh, pose[first + 1]);
    let ankle = add3(knee, quat_rotate(shin, joint_translation(rig, avatar, first + 2)));
    Leg { hip, knee, ankle, thigh, shin, foot: quat_mul(shin, pose[first + 2]) }
}

/// v turned downwards in the upright plane ahead.
fn turned_down([x, y, z]: [f32; 3], [ahead_x, ahead_z]: [f32; 2], [sine, cosine]: [f32; 2]) -> [f32; 3] {
    let along = x * ahead_x + z * ahead_z;
    let aside = x * ahead_z - z * ahead_x;
    let forth = along * cosine + y * sine;
    [ahead_x * forth + ahead_z * aside, y * cosine - along * sine, ahead_z * forth - ahead_x * aside]
}

/// q after which comes the same turn; sine and cosine are of half its angle.
fn quat_turned_down(
    [qx, qy, qz, qw]: [f32; 4],
    [ahead_x, ahead_z]: [f32; 2],
    [sine, w]: [f32; 2],
) -> [f32; 4] {
    let x = ahead_z * sine;
    let z = -(ahead_x * sine);
    [w * qx + x * qw - z * qy, w * qy - x * qz + z * qx, w * qz + x * qy + z * qw, w * qw - x * qx - z * qz]
}

/// The leg with its ankle and foot where a shorter or longer stride has them; hip and knee stay. In a stand the ankle is there,
/// to the left and ahead.
fn stepped(
    leg: Leg,
    rig: &[[f32; 4]],
    avatar: usize,
    first: usize,
    [stands_x, stands_z]: [f32; 2],
    stride: f32,
    turn: f32,
) -> Leg {
    let bind = avatar * RIG_STRIDE + (first + 2) * 4 + 1;
    let [x, y, z] = [0, 1, 2].map(|row| xyz(rig[bind + row]));
    let [xw, yw, zw] = [0, 1, 2].map(|row| {
        let [.., w] = rig[bind + row];
        w
    });
    let [ax, ay, az] = add3(add3(scale3(x, xw), scale3(y, yw)), scale3(z, zw)).map(|part| -part);
    let side = usize::from(first == RIGHT_LEG);
    let ball = sub3(xyz(rig[avatar * RIG_STRIDE + RIG_BALLS + side]), [ax, ay, az]);
    let [points_x, points_y, points_z] = quat_rotate(leg.foot, joint_forward(rig, avatar, first + 2));
    let flat = (points_x * points_x + points_z * points_z).sqrt();
    if !(flat > LEAST_AHEAD) {
        return leg;
    }
    let ahead = [points_x / flat, points_z / flat];
    let pitch = atan2(points_y, flat);
    let [bx, by, bz] = ball;
    let contact = if pitch > 0.0 { [-(bx * HEEL), by, -(bz * HEEL)] } else { ball };
    let arm = quat_rotate(leg.foot, [dot3(x, contact), dot3(y, contact), dot3(z, contact)]);
    let level = turned_down(arm, ahead, sin_cos(pitch));
    let short = greater(1.0 - stride, 0.0);
    let slower = 1.0 - stride * stride;
    let slow = greater(slower, 0.0);
    let steep = lesser(pitch, 0.0) / STEEPEST;
    let sooner = PUSHES_MORE * lesser(slower, 0.0) * greater(1.0 - steep * steep, 0.0);
    let down = lesser(pitch, 0.0) * (slow + sooner) + greater(pitch, 0.0) * lesser(FLATTER * slow, 1.0);
    let rolled = turned_down(arm, ahead, sin_cos(down));
    let [above_x, above_y, above_z] = sub3(add3(leg.ankle, arm), level);
    let lift = 1.0 - slow * (1.0 - LEAST_LIFT);
    let there = [
        above_x + (stands_x - above_x) * short,
        ay + greater(above_y - ay, 0.0) * lift,
        stands_z + (above_z - stands_z) * stride,
    ];
    Leg {
        ankle: add3(there, turn_left(sin_cos(turn), sub3(level, rolled))),
        foot: quat_turned_down(leg.foot, ahead, sin_cos(0.5 * down)),
        ..leg
    }
}

/// Where a foot is beside where the gait has it.
struct Off {
    /// In the frame of the body: to the left and ahead, m.
    way: [f32; 2],
    /// rad
    turn: f32,
    /// m
    height: f32,
    /// Upwards where the foot points to.
    slope: f32,
}

/// The leg with its foot so far off.
fn put(leg: Leg, off: &Off) -> Leg {
    let [aside, ahead] = off.way;
    let mut foot = quat_before_yaw(off.turn, leg.foot);
    if off.slope.abs() > NOT_SEEN {
        foot = quat_turned_down(foot, sin_cos(off.turn), sin_cos(-0.5 * atan2(off.slope, 1.0)));
    }
    Leg { ankle: add3(leg.ankle, [aside, off.height, ahead]), foot, ..leg }
}

/// A vector of the world, to the left and ahead of a body with that heading (sine, cosine).
fn to_body([x, z]: [f32; 2], [sine, cosine]: [f32; 2]) -> [f32; 2] {
    [cosine * x - sine * z, cosine * z + sine * x]
}

/// Whether anything differs from a straight walk on a level floor.
fn is_off(own: &Stance) -> bool {
    let is_seen = |[x, y]: [f32; 2]| greater(x.abs(), y.abs()) > NOT_SEEN;
    [own.left, own.right, own.turns, own.lean, own.heights, own.slopes].into_iter().any(is_seen)
        || own.foresight.abs() > NOT_SEEN
}

/// Turns the upper body over its pelvis: what was `before` in model space is `turned` now. The trunk keeps its place in space
/// but for the lean. Neck and head do not lean; without the formulas of the paper they turn ahead, to the left.
fn hold_up(
    pose: &mut [[f32; 4]],
    before: [f32; 4],
    turned: [f32; 4],
    leans: [f32; 4],
    foresight: f32,
    is_paper: bool,
) {
    let trunk = quat_mul(before, pose[SPINE]);
    let leaning = quat_mul(leans, trunk);
    pose[SPINE] = quat_normalize(quat_mul(quat_conjugate(turned), leaning));
    if is_paper {
        return;
    }
    let neck = quat_mul(trunk, pose[NECK]);
    let ahead = quat_before_yaw(NECK_TURNS * foresight, neck);
    let head = quat_before_yaw(foresight, quat_mul(neck, pose[HEAD]));
    pose[NECK] = quat_normalize(quat_mul(quat_conjugate(leaning), ahead));
    pose[HEAD] = quat_normalize(quat_mul(quat_conjugate(ahead), head));
}

/// How much too high a hip is for the leg to reach its ankle, m.
fn overreach([hip_x, hip_y, hip_z]: [f32; 3], [x, y, z]: [f32; 3], longest: f32) -> f32 {
    let (dx, dz) = (hip_x - x, hip_z - z);
    let square = greater(longest * longest - dx * dx - dz * dz, 0.25 * longest * longest);
    hip_y - y - square.sqrt()
}

/// The rotation that takes the direction of a to that of b.
fn quat_between(a: [f32; 3], b: [f32; 3]) -> [f32; 4] {
    let [x, y, z] = cross3(a, b);
    quat_normalize([x, y, z, (dot3(a, a) * dot3(b, b)).sqrt() + dot3(a, b)])
}

fn length(v: [f32; 3]) -> f32 {
    dot3(v, v).sqrt()
}

/// Local rotations of a leg that goes from a hip to where `after` has ankle and foot; `before` is the leg as it was.
fn bent(before: Leg, after: Leg, hip: [f32; 3], pelvis: [f32; 4], left: [f32; 3]) -> [[f32; 4]; 3] {
    let upper = sub3(before.knee, before.hip);
    let lower = sub3(before.ankle, before.knee);
    let (thigh, shin) = (length(upper), length(lower));
    let way = sub3(after.ankle, hip);
    let far = greater(length(way), LEAST_BEND * thigh);
    let straight = way.map(|part| part / far);
    let least = (thigh - shin).abs() + LEAST_BEND * (thigh + shin);
    let distance = limit(far, least, REACHES * (thigh + shin));
    let along = (thigh * thigh - shin * shin + distance * distance) / (2.0 * distance);
    let along = limit(along, -thigh, thigh);
    let hinge = add3(cross3(upper, lower).map(|part| part / (thigh * shin)), scale3(left, KNEES_AHEAD));
    let across = sub3(hinge, scale3(straight, dot3(hinge, straight)));
    let width = greater(length(across), 1e-6);
    let axis = across.map(|part| part / width);
    let out = greater(thigh * thigh - along * along, 0.0).sqrt();
    let knee = add3(scale3(straight, along), scale3(cross3(straight, axis), out));
    let thigh_turn = quat_mul(quat_between(upper, knee), before.thigh);
    let shin_turn = quat_mul(quat_between(lower, sub3(scale3(straight, distance), knee)), before.shin);
    [
        quat_normalize(quat_mul(quat_conjugate(pelvis), thigh_turn)),
        quat_normalize(quat_mul(quat_conjugate(thigh_turn), shin_turn)),
        quat_normalize(quat_mul(quat_conjugate(shin_turn), after.foot)),
    ]
}

/// One agent of a frame.
struct Person<'a> {
    rig: &'a [[f32; 4]],
    agent: u32,
    own: &'a Stance,
    /// Heading, rad.
    faces: f32,
    looks: &'a Appearance,
    /// How much it walks.
    walk: f32,
    is_paper: bool,
}

impl Person<'_> {
    /// Where left and right ankle are in a stand, to the left and ahead; `leg` is the length of a leg, m.
    fn stands(&self, upright: [f32; 4], leg: f32) -> [[f32; 2]; 2] {
        let (rig, avatar) = (self.rig, self.looks.avatar() as usize);
        let rest = joint_translation(rig, avatar, 0);
        let [left_hip, right_hip] = [LEFT_LEG, RIGHT_LEG]
            .map(|first| add3(rest, quat_rotate(upright, joint_translation(rig, avatar, first))));
        let [middle_x, _, middle_z] = scale3(add3(left_hip, right_hip), 0.5);
        let [left_x, ..] = left_hip;
        let aside = STANCE_WIDTH * (left_x - middle_x);
        let ahead = left_ahead(stance_of(self.agent)) * leg;
        [[middle_x + aside, middle_z + ahead], [middle_x - aside, middle_z - ahead]]
    }

    /// Where left and right foot are beside where the gait has them.
    fn offs(&self, heading: [f32; 2]) -> [Off; 2] {
        let (own, scale) = (self.own, self.looks.scale);
        let off = |way: [f32; 2], side: usize| Off {
            way: to_body(way.map(|part| part / scale), heading),
            turn: own.turns[side],
            height: own.heights[side] / scale,
            slope: own.slopes[side],
        };
        [off(own.left, 0), off(own.right, 1)]
    }

    /// Takes the strides, the feet and the lean of the body as they are.
    fn place(&self, pose: &mut [[f32; 4]]) {
        let (rig, own, walk) = (self.rig, self.own, self.walk);
        let avatar = self.looks.avatar() as usize;
        let [root_x, root_y, root_z, stride] = pose[JOINTS];
        let pelvis = pose[0];
        let legs = [LEFT_LEG, RIGHT_LEG].map(|first| leg_of(pose, rig, avatar, first));
        let [left, right] = legs;
        let short = walk * greater(1.0 - stride, 0.0);
        let rows = avatar * RIG_STRIDE;
        let [rest_x, rest_y, rest_z] = [1, 2, 3].map(|row| xyz(rig[rows + row]));
        let upright = quat_conjugate(quat_from_rows(rest_x, rest_y, rest_z));
        let leg = length(sub3(left.knee, left.hip)) + length(sub3(left.ankle, left.knee));
        let longest = STRAIGHT * leg;

        let heading = sin_cos(self.faces);
        let ([at_left, at_right], [left_off, right_off]) = (self.stands(upright, leg), self.offs(heading));
        let [left_turn, right_turn] = own.turns;
        let feet = [
            put(stepped(left, rig, avatar, LEFT_LEG, at_left, stride, left_turn), &left_off),
            put(stepped(right, rig, avatar, RIGHT_LEG, at_right, stride, right_turn), &right_off),
        ];

        let turn = PELVIS_STAYS * (0.5 * (left_turn + right_turn));
        let calms = short + TURNS_MORE * walk * lesser(1.0 - stride, 0.0);
        let turned = quat_before_yaw(turn, quat_normalize(quat_lerp(pelvis, upright, calms)));
        let [leans_aside, leans_ahead] = to_body(own.lean, heading);
        let [_, rest_height, _] = joint_translation(rig, avatar, 0);
        let height = rest_height * UPRIGHT;
        let swing = 1.0 - short;
        let arms =
            [LEFT_LEG, RIGHT_LEG].map(|first| quat_rotate(turned, joint_translation(rig, avatar, first)));
        let square = stride * stride;
        let bobs = square * (2.0 - stride);
        let rise = (height - root_y) * (walk * (1.0 - bobs))
            + longest * (STRAIGHTER * short * square + LOWER * lesser(1.0 - stride, 0.0));
        let sways = FROM_ANKLES * height;
        let floors = 0.5 * (left_off.height + right_off.height);
        let hips =
            [root_x + leans_aside * sways, root_y + rise + floors, root_z * swing + leans_ahead * sways];
        let [left_sinks, right_sinks] =
            [0, 1].map(|side| overreach(add3(hips, arms[side]), feet[side].ankle, longest));
        let most_sunk = MOST_SUNK * leg + (left_off.height - right_off.height).abs();
        let [x, y, z] = hips;
        let hips = [x, y - limit(greater(left_sinks, right_sinks), 0.0, most_sunk), z];

        let ([x, ..], [y, ..], [z, ..]) = (rest_x, rest_y, rest_z);
        let to_the_left = quat_rotate(turned, [x, y, z]);
        for (side, first) in [LEFT_LEG, RIGHT_LEG].into_iter().enumerate() {
            let local = bent(legs[side], feet[side], add3(hips, arms[side]), turned, to_the_left);
            pose[first..first + 3].copy_from_slice(&local);
        }
        let leans = quat_pitch_roll(leans_ahead, -leans_aside);
        hold_up(pose, pelvis, turned, leans, own.foresight, self.is_paper);
        pose[0] = turned;
        let [x, y, z] = hips;
        pose[JOINTS] = [x, y, z, stride];
    }
}

/// Twin of `shaders/feet.wgsl`.
pub fn feet(b: Slices<'_>) {
    let Slices { frame, visible, stance, appearance, gait_weights, rig, local_rotations, heading } = b;
    let slots = local_rotations.par_chunks_mut(POSE_STRIDE);
    visible_agents(visible).par_iter().zip(slots).for_each(|(number, pose)| {
        let agent = *number as usize;
        let own = &stance[agent];
        let walk = walk_share(gait_weights[agent], own.walk_weight);
        let [.., stride] = pose[JOINTS];
        if (walk > 0.0 && stride != 1.0) || is_off(own) {
            let is_paper = frame.gaze_mode != 0;
            let (faces, looks) = (heading[agent], &appearance[agent]);
            Person { rig, agent: *number, own, faces, looks, walk, is_paper }.place(pose);
        }
    });
}
