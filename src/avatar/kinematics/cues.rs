//! What an emotion changes in a walk, beside what it changes in the walks of people.
//!
//! Targets: means over the 232 gaits of E-Gait by perceived emotion, the neutral mean of the same source subtracted, with
//! standard errors; lengths in legs. Both sides of the comparison are fitted with the same harmonics, and the speed is
//! estimated from the feet, since E-Gait has no travel.

use super::angles::{Angle, Side, Walk, mean, range};
use crate::emotion::Emotion;
use crate::gait::{Joint, Pose};
use glam::Vec3;

/// Emotions that are set against neutral.
pub(super) const EMOTIONS: [Emotion; 3] = [Emotion::Happy, Emotion::Angry, Emotion::Sad];

/// A figure of people, and its standard error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Band {
    pub(crate) mean: f32,
    pub(crate) standard_error: f32,
}

impl Band {
    /// Whether a value is within two standard errors.
    pub(crate) fn holds(self, value: f32) -> bool {
        (value - self.mean).abs() <= 2.0 * self.standard_error
    }
}

/// Something that tells emotions apart.
pub(super) struct Cue {
    /// Its name, with the unit.
    pub(super) name: &'static str,
    /// Its value for a walk.
    pub(super) of: fn(&Walk) -> f32,
    /// What people's walks differ by from neutral ones, in the order of [`EMOTIONS`].
    pub(super) people: [Band; EMOTIONS.len()],
}

const fn cue(name: &'static str, of: fn(&Walk) -> f32, people: [(f32, f32); EMOTIONS.len()]) -> Cue {
    let [happy, angry, sad] = people;
    Cue {
        name,
        of,
        people: [
            Band { mean: happy.0, standard_error: happy.1 },
            Band { mean: angry.0, standard_error: angry.1 },
            Band { mean: sad.0, standard_error: sad.1 },
        ],
    }
}

/// All of them.
#[rustfmt::skip]
pub(super) const CUES: [Cue; 14] = [
    cue("cycle_time_s", |walk| walk.cycle_time, [(-0.054, 0.023), (-0.190, 0.044), (0.242, 0.027)]),
    cue("speed_legs_per_s", speed, [(0.118, 0.031), (0.374, 0.059), (-0.198, 0.037)]),
    cue("hand_speed_legs_per_s", |walk| motion(walk, Joint::LeftHand, 1), [(0.412, 0.040), (0.392, 0.077), (-0.232, 0.048)]),
    cue("shoulder_range_deg", |walk| both(walk, Angle::Shoulder, range), [(11.25, 1.38), (5.89, 2.65), (-6.64, 1.64)]),
    cue("elbow_mean_deg", |walk| both(walk, Angle::Elbow, mean), [(2.67, 1.13), (2.75, 2.18), (-0.75, 1.35)]),
    cue("elbow_range_deg", |walk| both(walk, Angle::Elbow, range), [(8.17, 1.23), (4.30, 2.37), (-9.39, 1.47)]),
    cue("arms_out_deg", |walk| both(walk, Angle::ArmAbduction, mean), [(0.12, 0.42), (3.10, 0.81), (-0.11, 0.50)]),
    cue("trunk_forward_deg", |walk| both(walk, Angle::Trunk, mean), [(-0.67, 0.42), (0.74, 0.80), (2.30, 0.50)]),
    cue("head_forward_deg", |walk| both(walk, Angle::Head, mean), [(-7.83, 1.47), (-2.33, 2.83), (6.17, 1.75)]),
    cue("bob_legs", bob, [(0.0058, 0.0033), (0.0194, 0.0064), (0.0019, 0.0039)]),
    cue("step_width_legs", |walk| step_width(walk) / walk.leg(), [(-0.0002, 0.0052), (0.0294, 0.0101), (-0.0012, 0.0063)]),
    cue("shoulder_turn_deg", |walk| both(walk, Angle::ShoulderTurn, range) / 2.0, [(4.12, 0.60), (3.17, 1.15), (0.16, 0.71)]),
    cue("arm_asymmetry_deg", arm_asymmetry, [(2.46, 1.05), (6.16, 2.01), (-1.04, 1.25)]),
    cue("foot_acceleration_legs_per_s2", |walk| motion(walk, Joint::LeftFoot, 2), [(2.27, 0.57), (6.12, 1.09), (-2.71, 0.68)]),
];

/// A figure of a curve, mean of both sides.
fn both(walk: &Walk, angle: Angle, of: fn(&[f32]) -> f32) -> f32 {
    let values: Vec<f32> =
        Side::BOTH.iter().filter_map(|side| walk.curve(angle, *side)).map(|curve| of(&curve)).collect();
    mean(&values)
}

/// How differently the arms swing, degrees.
pub(super) fn arm_asymmetry(walk: &Walk) -> f32 {
    let [left, right] = Side::BOTH.map(|side| walk.curve(Angle::Shoulder, side).map_or(0.0, |c| range(&c)));
    (left - right).abs()
}

/// What the feet cover under the body in the share of the stride in which they do, legs a second.
fn speed(walk: &Walk) -> f32 {
    const STANCE: f32 = 0.9;
    let along = Side::BOTH.map(|side| {
        let ahead: Vec<f32> = walk.places(Joint::LeftFoot, side).iter().map(|p| p.z).collect();
        range(&ahead)
    });
    (along[0] + along[1]) * STANCE / (walk.cycle_time * walk.leg())
}

/// Range of the height of the root above the lower foot, legs.
fn bob(walk: &Walk) -> f32 {
    let feet = Side::BOTH.map(|side| side.of(Joint::LeftFoot) as usize);
    let height = |pose: &Pose| {
        pose[Joint::Root as usize].y - feet.map(|foot| pose[foot].y).into_iter().fold(f32::MAX, f32::min)
    };
    range(&walk.poses.iter().map(height).collect::<Vec<_>>()) / walk.leg()
}

/// How far apart the feet stand, m: each in the middle of its own stance.
pub(super) fn step_width(walk: &Walk) -> f32 {
    let [left, right] = Side::BOTH.map(|side| {
        let places = walk.places(Joint::LeftFoot, side);
        let stance = places.len() / 10..places.len() * 2 / 5;
        mean(&places[stance].iter().map(|p| p.x).collect::<Vec<_>>())
    });
    (left - right).abs()
}

/// Mean size of a derivative of a joint's place by time, mean of both sides, legs and seconds.
fn motion(walk: &Walk, joint: Joint, order: usize) -> f32 {
    #[allow(clippy::cast_precision_loss, reason = "a number of frames")]
    let rate = walk.poses.len() as f32 / walk.cycle_time;
    let sides = Side::BOTH.map(|side| {
        let mut path = walk.places(joint, side);
        (0..order).for_each(|_| path = slopes(&path, rate));
        mean(&path.iter().map(|v| v.length()).collect::<Vec<_>>())
    });
    mean(&sides) / walk.leg()
}

/// Central differences of a closed path.
fn slopes(path: &[Vec3], rate: f32) -> Vec<Vec3> {
    let count = path.len();
    (0..count).map(|k| (path[(k + 1) % count] - path[(k + count - 1) % count]) * (rate / 2.0)).collect()
}
