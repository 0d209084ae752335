//! Trunk, head and arms over a walking pelvis: a mean pose and one or two harmonics per angle.

use super::style::WalkerStyle;
use super::{Pelvis, Turn, cos, turned_x, turned_y, turned_z};
use crate::gait::{JOINT_COUNT, Joint};
use glam::DVec3;
use std::f64::consts::TAU;

/// The shoulders follow the pelvis by this share of a cycle.
const CHEST_LAG: f64 = 0.02;
/// The elbow bends and opens this share of a cycle after the upper arm.
const ELBOW_LAG: f64 = 0.01;
/// No arm swings by more than this share of the mean less than the other, or more: a still arm looks lame.
const UNEVEN: f64 = 0.45;
/// The arm that swings more bends more: by this share of how much more it swings.
const UNEVEN_ELBOWS: f64 = 0.5;
/// A forearm goes outwards by this share of what the upper arm does, and inwards by this share of the elbow's bend.
const FOREARM_OUT: f64 = 0.55;
const FOREARM_IN: f64 = 0.2;
/// No elbow is straighter than this.
const LEAST_BEND: f64 = 0.1;
/// The elbow's bend over its swing, by the swing `s` of -1 to 1: `0.3 + 0.5 s + 0.2 s^2`. Its second harmonic is a fifth of the
/// first, as in healthy adults (2.4 of 12 degrees): forearms are longer behind than in front.
const ELBOW_CURVE: [f64; 3] = [0.3, 0.5, 0.2];
/// A forearm that would swing higher than this swings less, by this share of the excess: arms swing like pendulums.
const HIGHEST_FOREARM: f64 = 1.1;
const HELD_DOWN: f64 = 0.85;
/// No upper arm swings far behind the shoulder, and none stays in front of it: beyond these it gives up [`HELD`] of the excess.
/// CMU's neutral and happy people swing 10 to 38 degrees back (5 to 95 %).
const FARTHEST_BACK: f64 = 0.75;
const LEAST_BACK: f64 = 0.34;
const HELD: f64 = 0.75;

/// Places spine, neck, head, shoulders, elbows and hands; the root must be there.
pub(super) fn place(style: &WalkerStyle, phase: f64, pelvis: &Pelvis, joints: &mut [DVec3; JOINT_COUNT]) {
    let body = &style.body;
    // The chest turns against the pelvis and stays more upright than it sideways.
    let chest_yaw = style.trunk_turn + style.shoulder_turn * cos(TAU * (phase - CHEST_LAG));
    let yaw = Turn::new(chest_yaw);
    let side_lean = Turn::new(-style.side_lean - 0.25 * pelvis.roll_angle);
    // Twice a stride, with each strike, the trunk tips forward a little and the head makes up for it.
    let dip = style.nod * cos(2.0 * TAU * (phase - 0.06));
    let low = style.lean - 0.2 * style.slump + 0.5 * dip;
    let high = style.lean + style.slump + 0.5 * dip;
    let head = high + style.neck_flexion + 0.5 * dip + style.nod * cos(2.0 * TAU * (phase - 0.12));
    let up = |pitch: f64| turned_z(turned_x(DVec3::Y, Turn::new(pitch)), side_lean);

    let spine = joints[Joint::Root as usize] + up(low) * body.spine();
    let neck = spine + up(high) * body.chest();
    joints[Joint::Spine as usize] = spine;
    joints[Joint::Neck as usize] = neck;
    joints[Joint::Head as usize] = neck + up(head) * body.neck();

    let girdle = Turn::new(pelvis.roll_angle * -0.35);
    for (side, shoulder) in [(1.0, Joint::LeftShoulder as usize), (-1.0, Joint::RightShoulder as usize)] {
        let offset = DVec3::new(
            side * 0.5 * body.shoulder_width(),
            style.shoulder_lift - body.shoulders_below_neck(),
            style.shoulder_forward,
        );
        joints[shoulder] = neck + turned_y(turned_z(turned_x(offset, Turn::new(0.5 * high)), girdle), yaw);
        let (upper_arm, forearm) = arm(style, side, phase);
        // The hanging arm turns with the chest only in part.
        let half_yaw = Turn::new(0.5 * chest_yaw);
        joints[shoulder + 1] = joints[shoulder] + turned_y(upper_arm, half_yaw) * body.upper_arm();
        joints[shoulder + 2] = joints[shoulder + 1] + turned_y(forearm, half_yaw) * body.forearm();
    }
}

/// Unit directions of upper arm and forearm on `side` (+1 left, -1 right) before the chest turns.
fn arm(style: &WalkerStyle, side: f64, phase: f64) -> (DVec3, DVec3) {
    // The left arm is back when the left foot strikes.
    let swing = |lag: f64| -side * cos(TAU * (phase - style.arm_lag - lag));
    let most = UNEVEN * style.arm_swing;
    let uneven = (style.arm_swing * style.asymmetry + style.swing_asymmetry).clamp(-most, most);
    let (middle, amplitude) =
        held(style.arm_forward + 0.5 * side * style.forward_asymmetry, style.arm_swing + side * uneven);
    let flexion = middle + amplitude * swing(0.0);
    let bent = (style.elbow_flexion + 0.5 * side * style.elbow_asymmetry).max(LEAST_BEND);
    let [mean, first, second] = ELBOW_CURVE;
    let s = swing(ELBOW_LAG);
    let share = if style.arm_swing > 0.0 { side * uneven / style.arm_swing } else { 0.0 };
    let elbow_swing = style.elbow_swing * (1.0 + UNEVEN_ELBOWS * share);
    let highest = middle + amplitude + bent + elbow_swing;
    let bends = (elbow_swing - HELD_DOWN * (highest - HIGHEST_FOREARM).max(0.0)).max(0.0);
    let elbow = bent + bends * (mean + s * (first + s * second));
    let apart = style.arm_abduction + 0.5 * side * style.abduction_asymmetry;
    let out = apart.max(0.0) - style.arm_cross * (0.5 + 0.5 * swing(0.0));
    let outward = Turn::new(out);
    let inward = Turn::new(FOREARM_OUT * out - FOREARM_IN * elbow);
    (limb(side, flexion, outward), limb(side, flexion + elbow, inward))
}

/// Middle and amplitude of an upper arm's swing that reaches neither too far back nor too little. One that reaches too far
/// loses half of it behind and swings that much farther in front.
fn held(middle: f64, amplitude: f64) -> (f64, f64) {
    let back = amplitude - middle;
    let excess = 0.5 * HELD * (back - FARTHEST_BACK).max(0.0);
    let lack = HELD * (LEAST_BACK - back).max(0.0);
    (middle + excess - lack, amplitude - excess)
}

/// A unit vector that hangs down, swung forward by `flexion` and out to `side`.
fn limb(side: f64, flexion: f64, outward: Turn) -> DVec3 {
    let flexion = Turn::new(flexion);
    DVec3::new(side * outward.sin, -outward.cos * flexion.cos, outward.cos * flexion.sin)
}
