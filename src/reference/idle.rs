//! What people who stand do of themselves: they breathe, sway and look about, each in an own way.

use super::body::{PARENTS, visible_agents};
use super::exact::{hash_u32, sin_cos, unit_f32};
use super::quaternion::{
    dot4, limit, quat_before_yaw, quat_conjugate, quat_lerp, quat_mul, quat_normalize, quat_pitch_roll,
    quat_rotate, xyz,
};
use super::standing::{eased, moods_of, own_draw, walk_share};
use crate::kernels::idle::index::UPPER;
use crate::kernels::idle::{
    ARMS_SPREAD, BREATH, BREATH_LEAST, BREATH_MORE, BREATH_SPAN, BREATH_UNIT, CARRIAGE, CHEST_FOLLOWS,
    CHEST_RISES, LOOK, LOOK_DOWN, LOOK_EVERY, LOOK_FAR, LOOK_LEAST, LOOK_NEAR, LOOK_RAMP, LOOK_SPAN,
    OWN_BEND, OWN_ELBOW, OWN_LEAN, OWN_NOD, OWN_SPREAD, OWN_SWING, OWN_TILT, OWN_TURN, QUICK_LEAST,
    QUICK_SHARE, QUICK_SPAN, SLOW_LEAST, SLOW_SPAN, STEPS, SWAY, SWAY_AHEAD, SWAY_ASIDE, Slices, TURN,
};
use crate::kernels::shared::body::index::{JOINTS, LEFT_FOOT, POSE_STRIDE, RIGHT_FOOT};
use rayon::prelude::*;

/// In [-1, 1): the agent's own for good.
fn own_angle(agent: u32, number: u32) -> f32 {
    2.0 * unit_f32(own_draw(agent, CARRIAGE, number)) - 1.0
}

fn wave(phase: u32) -> f32 {
    let [sine, _] = sin_cos((phase >> 8) as f32 * (TURN / STEPS));
    sine
}

/// 1 with the chest full, -1 with it empty, at a time, ms.
pub fn breath_of(agent: u32, emotion: usize, time: u32) -> f32 {
    let own = own_draw(agent, BREATH, 0);
    let rate = BREATH_LEAST + own % BREATH_SPAN + BREATH_MORE[emotion];
    wave(time.wrapping_mul(BREATH_UNIT * rate).wrapping_add(hash_u32(own)))
}

/// A slow wave and a quicker, lower one, in [-1, 1]: ahead (0) or aside (1), at a time, ms.
pub fn sway_of(agent: u32, axis: u32, time: u32) -> f32 {
    let slow = own_draw(agent, SWAY, 2 * axis);
    let quick = own_draw(agent, SWAY, 2 * axis + 1);
    let slowly = wave(time.wrapping_mul(SLOW_LEAST + slow % SLOW_SPAN).wrapping_add(hash_u32(slow)));
    let quickly = wave(time.wrapping_mul(QUICK_LEAST + quick % QUICK_SPAN).wrapping_add(hash_u32(quick)));
    slowly * (1.0 - QUICK_SHARE) + quickly * QUICK_SHARE
}

/// Where an agent looks beside where it faces at a time, ms: (to the left, down), rad.
pub fn look_of(agent: u32, emotion: usize, time: u32) -> [f32; 2] {
    let every = LOOK_EVERY[emotion];
    let time = time.wrapping_add(own_draw(agent, LOOK, 0) % every);
    let draw = own_draw(agent, LOOK, 1 + time / every);
    let lasts = LOOK_LEAST + draw % LOOK_SPAN;
    let since = (time % every) as i32 - ((draw >> 12) % (every - lasts)) as i32;
    let within = since.min(lasts as i32 - since) as f32;
    let share = eased(limit(within / LOOK_RAMP, 0.0, 1.0));
    let aside = hash_u32(draw);
    let yaw = LOOK_NEAR + (LOOK_FAR - LOOK_NEAR) * unit_f32(aside << 1);
    let down = 2.0 * unit_f32(hash_u32(aside)) - 1.0;
    let yaw = if aside >> 31 == 1 { yaw } else { -yaw };
    [yaw * share, LOOK_DOWN * down * share]
}

/// Turns of the joints above the legs, model space.
fn turns_of(agent: u32, stands: f32, breath: f32, [aside, down]: [f32; 2]) -> [[f32; 4]; UPPER] {
    let yaw = stands * OWN_TURN * own_angle(agent, 0) + CHEST_FOLLOWS * aside;
    let lean = stands * OWN_LEAN * own_angle(agent, 1) - CHEST_RISES * breath;
    let chest = quat_before_yaw(yaw, quat_pitch_roll(lean, stands * OWN_BEND * own_angle(agent, 2)));
    let nod = stands * OWN_NOD * own_angle(agent, 3) + down;
    let head = quat_before_yaw(yaw + aside, quat_pitch_roll(nod, stands * OWN_TILT * own_angle(agent, 4)));
    let neck = quat_normalize(quat_lerp(chest, head, 0.5));
    let mut turns = [chest; UPPER];
    [turns[2], turns[3]] = [neck, head];
    for side in 0..2 {
        let own = 5 + 3 * side as u32;
        let outwards = stands * OWN_SPREAD * (0.5 + 0.5 * own_angle(agent, own)) + ARMS_SPREAD * breath;
        let roll = if side == 0 { outwards } else { -outwards };
        let ahead = stands * OWN_SWING * own_angle(agent, own + 1);
        let bend = stands * OWN_ELBOW * (0.5 + 0.5 * own_angle(agent, own + 2));
        let fore = quat_before_yaw(yaw, quat_pitch_roll(-(ahead + bend), roll));
        turns[4 + 3 * side] = quat_before_yaw(yaw, quat_pitch_roll(-ahead, roll));
        [turns[5 + 3 * side], turns[6 + 3 * side]] = [fore, fore];
    }
    turns
}

/// Twin of `shaders/idle.wgsl`.
pub fn idle(b: Slices<'_>) {
    let Slices { frame, visible, stance, appearance, gait_weights, local_rotations } = b;
    let slots = local_rotations.par_chunks_mut(POSE_STRIDE);
    visible_agents(visible).par_iter().zip(slots).for_each(|(number, pose)| {
        let (number, agent) = (*number, *number as usize);
        let stands = 1.0 - walk_share(gait_weights[agent], stance[agent].walk_weight);
        if !(stands > 0.0) {
            return;
        }
        let time = frame.gaze_time;
        let moods = moods_of(gait_weights[agent], appearance[agent].emotion());
        let breath = stands * dot4(moods, [0, 1, 2, 3].map(|emotion| breath_of(number, emotion, time)));
        let [l0, l1, l2, l3] = [0, 1, 2, 3].map(|emotion| look_of(number, emotion, time));
        let [m0, m1, m2, m3] = moods;
        let looks = if frame.gaze_mode == 0 { 1.0 } else { 0.0 };
        let look = [0, 1].map(|i| ((l0[i] * m0 + l1[i] * m1 + l2[i] * m2 + l3[i] * m3) * stands) * looks);
        let turns = turns_of(number, stands, breath, look);

        let [ahead, aside] = [0, 1].map(|axis| sway_of(number, axis, time));
        let sway = quat_pitch_roll(stands * SWAY_AHEAD * ahead, stands * SWAY_ASIDE * aside);
        let mut before = [pose[0]; JOINTS];
        let mut after = [quat_mul(sway, pose[0]); JOINTS];
        pose[0] = quat_normalize(after[0]);
        for joint in 1..JOINTS {
            let parent = PARENTS[joint];
            before[joint] = quat_mul(before[parent], pose[joint]);
            after[joint] = before[joint];
            if let Some(turn) = turns.get(joint) {
                after[joint] = quat_mul(*turn, before[joint]);
            }
            if joint != LEFT_FOOT && joint != RIGHT_FOOT {
                after[joint] = quat_mul(sway, after[joint]);
            }
            pose[joint] = quat_normalize(quat_mul(quat_conjugate(after[parent]), after[joint]));
        }
        let [x, y, z] = quat_rotate(sway, xyz(pose[JOINTS]));
        let [_, _, _, w] = pose[JOINTS];
        pose[JOINTS] = [x, y, z, w];
    });
}
