//! Joint angles of a stride from places of joints.

use crate::gait::{Joint, Pose};
use glam::Vec3;
use serde::Serialize;

/// A stride on the spot towards +z, from the left strike on, at equal phase steps.
#[derive(Debug, Clone)]
pub(crate) struct Walk {
    /// Places of the joints, m.
    pub(crate) poses: Vec<Pose>,
    /// Pitch of the feet against where they stand flat: left, right; degrees, toe up. Empty for gaits, whose feet are points.
    pub(crate) foot_pitch: Vec<[f32; 2]>,
    /// Seconds of the stride.
    pub(crate) cycle_time: f32,
    /// Metres of the stride.
    pub(crate) travel: f32,
}

/// One side of the body.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

/// What is measured of one side over its own stride.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub(crate) enum Angle {
    /// The thigh against the vertical.
    Thigh,
    /// Flexion of the knee.
    Knee,
    /// Dorsiflexion of the ankle.
    Ankle,
    /// Pitch of the foot.
    Foot,
    /// The upper arm against the vertical.
    Shoulder,
    /// Flexion of the elbow.
    Elbow,
    /// Turn of the pelvis about the vertical.
    PelvisTurn,
    /// How much higher the own hip is.
    PelvisList,
    /// The thigh inwards against the pelvis.
    HipAdduction,
    /// The upper arm outwards against the vertical.
    ArmAbduction,
    /// Turn of the line of the shoulders about the vertical.
    ShoulderTurn,
    /// Root to neck against the vertical.
    Trunk,
    /// Neck to head against the vertical.
    Head,
}

/// The joints of a side.
struct Joints {
    shoulder: Vec3,
    elbow: Vec3,
    hand: Vec3,
    hip: Vec3,
    knee: Vec3,
    foot: Vec3,
}

impl Side {
    pub(crate) const BOTH: [Self; 2] = [Self::Left, Self::Right];

    pub(crate) const fn other(self) -> Self {
        match self {
            Self::Left => Self::Right,
            Self::Right => Self::Left,
        }
    }

    /// The joint of this side that is called so on the left.
    pub(crate) fn of(self, left: Joint) -> Joint {
        match self {
            Self::Left => left,
            Self::Right => left.mirrored(),
        }
    }

    /// 1 where +x is outwards.
    const fn outward(self) -> f32 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }

    fn joints(self, pose: &Pose) -> Joints {
        let at = |left: Joint| pose[self.of(left) as usize];
        Joints {
            shoulder: at(Joint::LeftShoulder),
            elbow: at(Joint::LeftElbow),
            hand: at(Joint::LeftHand),
            hip: at(Joint::LeftHip),
            knee: at(Joint::LeftKnee),
            foot: at(Joint::LeftFoot),
        }
    }
}

/// How far forward something that hangs is, degrees from the vertical.
fn forward(hanging: Vec3) -> f32 {
    libm::atan2f(hanging.z, -hanging.y).to_degrees()
}

/// How far forward something upright leans, degrees from the vertical.
fn lean(upright: Vec3) -> f32 {
    libm::atan2f(upright.z, upright.y).to_degrees()
}

fn bend(upper: Vec3, lower: Vec3) -> f32 {
    upper.angle_between(lower).to_degrees()
}

impl Angle {
    /// Its value at one phase, degrees; `pitch` is that of the foot, where it is known.
    fn at(self, pose: &Pose, side: Side, pitch: Option<f32>) -> Option<f32> {
        let own = side.joints(pose);
        let other = side.other().joints(pose);
        let joint = |joint: Joint| pose[joint as usize];
        let out = side.outward();
        let (thigh, shank) = (own.knee - own.hip, own.foot - own.knee);
        let (upper, fore) = (own.elbow - own.shoulder, own.hand - own.elbow);
        // from the other side to this one: x is positive, however the side
        let across = |own: Vec3, other: Vec3| (own - other) * Vec3::new(out, 1.0, 1.0);
        let turn = |line: Vec3| libm::atan2f(-line.z, line.x).to_degrees();
        let hips = across(own.hip, other.hip);
        let list = libm::atan2f(hips.y, libm::hypotf(hips.x, hips.z)).to_degrees();
        let value = match self {
            Self::Thigh => forward(thigh),
            Self::Knee => bend(thigh, shank),
            Self::Ankle => pitch? - forward(shank),
            Self::Foot => pitch?,
            Self::Shoulder => forward(upper),
            Self::Elbow => bend(upper, fore),
            Self::PelvisTurn => turn(hips),
            Self::PelvisList => list,
            Self::HipAdduction => list - libm::atan2f(out * thigh.x, -thigh.y).to_degrees(),
            Self::ArmAbduction => libm::atan2f(out * upper.x, -upper.y).to_degrees(),
            Self::ShoulderTurn => turn(across(own.shoulder, other.shoulder)),
            Self::Trunk => lean(joint(Joint::Neck) - joint(Joint::Root)),
            Self::Head => lean(joint(Joint::Head) - joint(Joint::Neck)),
        };
        Some(value)
    }
}

impl Walk {
    /// An angle over the side's own stride, from its strike on; none if the walk does not have it.
    pub(crate) fn curve(&self, angle: Angle, side: Side) -> Option<Vec<f32>> {
        let strike = self.strike(side);
        let count = self.poses.len();
        let at = |k: usize| (k + strike) % count;
        let pitch = |frame: usize| self.foot_pitch.get(frame).map(|pitches| pitches[side as usize]);
        (0..count).map(|k| angle.at(&self.poses[at(k)], side, pitch(at(k)))).collect()
    }

    /// The frame of the side's strike. The left strike is the first; the right foot strikes as long after it is foremost.
    fn strike(&self, side: Side) -> usize {
        let foremost = |side: Side| {
            let ahead = |frame: usize| {
                let pose = &self.poses[frame];
                pose[side.of(Joint::LeftFoot) as usize].z - pose[Joint::Root as usize].z
            };
            (0..self.poses.len()).max_by(|a, b| ahead(*a).total_cmp(&ahead(*b))).unwrap_or(0)
        };
        match side {
            Side::Left => 0,
            Side::Right => {
                let count = self.poses.len().max(1);
                (foremost(Side::Right) + count - foremost(Side::Left)) % count
            }
        }
    }

    /// A place of a joint relative to the root over the side's own stride, m.
    pub(crate) fn places(&self, joint: Joint, side: Side) -> Vec<Vec3> {
        let (strike, count) = (self.strike(side), self.poses.len());
        (0..count)
            .map(|k| &self.poses[(k + strike) % count])
            .map(|pose| pose[side.of(joint) as usize] - pose[Joint::Root as usize])
            .collect()
    }

    /// The height of a joint over the side's own stride, m.
    pub(crate) fn heights(&self, joint: Joint, side: Side) -> Vec<f32> {
        let (strike, count) = (self.strike(side), self.poses.len());
        (0..count).map(|k| self.poses[(k + strike) % count][side.of(joint) as usize].y).collect()
    }

    /// Mean length of the legs, m.
    pub(crate) fn leg(&self) -> f32 {
        let length = |pose: &Pose| {
            Side::BOTH
                .map(|side| side.joints(pose))
                .map(|own| own.hip.distance(own.knee) + own.knee.distance(own.foot))
                .iter()
                .sum::<f32>()
                / 2.0
        };
        mean(&self.poses.iter().map(length).collect::<Vec<_>>())
    }
}

#[allow(clippy::cast_precision_loss, reason = "a number of frames")]
pub(super) fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len().max(1) as f32
}

/// Largest less smallest.
pub(super) fn range(values: &[f32]) -> f32 {
    let (least, most) =
        values.iter().fold((f32::MAX, f32::MIN), |(least, most), &v| (least.min(v), most.max(v)));
    (most - least).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::gait::JOINT_COUNT;

    /// Upright, legs and arms hanging.
    fn standing() -> Pose {
        let mut pose = [Vec3::ZERO; JOINT_COUNT];
        let mut put = |joint: Joint, x: f32, y: f32| pose[joint as usize] = Vec3::new(x, y, 0.0);
        put(Joint::Root, 0.0, 1.0);
        put(Joint::Spine, 0.0, 1.1);
        put(Joint::Neck, 0.0, 1.5);
        put(Joint::Head, 0.0, 1.7);
        for side in Side::BOTH {
            let out = side.outward();
            for (joint, height) in
                [(Joint::LeftShoulder, 1.4), (Joint::LeftElbow, 1.1), (Joint::LeftHand, 0.8)]
            {
                put(side.of(joint), 0.2 * out, height);
            }
            for (joint, height) in [(Joint::LeftHip, 0.9), (Joint::LeftKnee, 0.5), (Joint::LeftFoot, 0.1)] {
                put(side.of(joint), 0.1 * out, height);
            }
        }
        pose
    }

    fn walk(poses: Vec<Pose>, foot_pitch: Vec<[f32; 2]>) -> Walk {
        Walk { poses, foot_pitch, cycle_time: 1.0, travel: 1.0 }
    }

    fn first(pose: Pose, angle: Angle, side: Side) -> f32 {
        let flat = vec![[0.0; 2]; 4];
        walk(vec![pose; 4], flat).curve(angle, side).unwrap()[0]
    }

    const ALL: [Angle; 13] = [
        Angle::Thigh,
        Angle::Knee,
        Angle::Ankle,
        Angle::Foot,
        Angle::Shoulder,
        Angle::Elbow,
        Angle::PelvisTurn,
        Angle::PelvisList,
        Angle::HipAdduction,
        Angle::ArmAbduction,
        Angle::ShoulderTurn,
        Angle::Trunk,
        Angle::Head,
    ];

    #[test]
    fn who_stands_straight_has_no_angle() {
        for angle in ALL {
            for side in Side::BOTH {
                assert!(first(standing(), angle, side).abs() < 0.05, "{angle:?} {side:?}");
            }
        }
    }

    #[test]
    fn signs_are_those_of_gait_laboratories() {
        let turned = |joints: &[Joint], about: Joint, axis: Vec3, degrees: f32| {
            let mut pose = standing();
            let pivot = pose[about as usize];
            let turn = glam::Quat::from_axis_angle(axis, degrees.to_radians());
            for joint in joints {
                pose[*joint as usize] = pivot + turn * (pose[*joint as usize] - pivot);
            }
            pose
        };
        let is = |pose: Pose, angle: Angle, side: Side, wanted: f32| {
            let found = first(pose, angle, side);
            assert!((found - wanted).abs() < 0.05, "{angle:?} {side:?}: {found}, not {wanted}");
        };
        // a turn about -x takes what hangs forward
        let leg = turned(&[Joint::LeftKnee, Joint::LeftFoot], Joint::LeftHip, Vec3::NEG_X, 30.0);
        is(leg, Angle::Thigh, Side::Left, 30.0);
        is(leg, Angle::Knee, Side::Left, 0.0);
        is(leg, Angle::Ankle, Side::Left, -30.0); // the sole stays level: the foot points
        is(leg, Angle::Thigh, Side::Right, 0.0);
        let shank = turned(&[Joint::RightFoot], Joint::RightKnee, Vec3::X, 50.0);
        is(shank, Angle::Knee, Side::Right, 50.0);
        is(shank, Angle::Ankle, Side::Right, 50.0);
        let arm = turned(&[Joint::RightElbow, Joint::RightHand], Joint::RightShoulder, Vec3::X, 20.0);
        is(arm, Angle::Shoulder, Side::Right, -20.0);
        let fore = turned(&[Joint::RightHand], Joint::RightElbow, Vec3::NEG_X, 90.0);
        is(fore, Angle::Elbow, Side::Right, 90.0);
        let hips = [Joint::LeftHip, Joint::RightHip];
        let pelvis = turned(&hips, Joint::Root, Vec3::Y, 10.0); // to the left
        is(pelvis, Angle::PelvisTurn, Side::Left, 10.0);
        is(pelvis, Angle::PelvisTurn, Side::Right, -10.0);
        let listed = turned(&hips, Joint::Root, Vec3::Z, 5.0); // the left hip rises
        is(listed, Angle::PelvisList, Side::Left, 5.0);
        is(listed, Angle::PelvisList, Side::Right, -5.0);
        let wide = turned(&[Joint::LeftKnee, Joint::LeftFoot], Joint::LeftHip, Vec3::Z, 15.0); // outwards
        is(wide, Angle::HipAdduction, Side::Left, -15.0);
        let out = turned(&[Joint::RightElbow, Joint::RightHand], Joint::RightShoulder, Vec3::NEG_Z, 12.0);
        is(out, Angle::ArmAbduction, Side::Right, 12.0);
        let bowed = turned(&[Joint::Neck, Joint::Head], Joint::Root, Vec3::X, 8.0);
        is(bowed, Angle::Trunk, Side::Left, 8.0);
        is(bowed, Angle::Head, Side::Right, 8.0);
        let up = walk(vec![standing(); 4], vec![[18.0, -7.0]; 4]);
        assert_eq!(up.curve(Angle::Foot, Side::Right).unwrap(), vec![-7.0; 4]);
        assert!((up.curve(Angle::Ankle, Side::Left).unwrap()[0] - 18.0).abs() < 0.05);
        assert!(walk(vec![standing(); 4], Vec::new()).curve(Angle::Ankle, Side::Left).is_none());
    }

    #[test]
    fn a_walk_that_is_the_same_on_both_sides_has_the_same_curves() {
        let gait = crate::gait::walker::walk(
            &crate::gait::walker::WalkerStyle::preset(crate::Emotion::Happy, crate::gait::walker::Sex::Male),
            "even",
        )
        .unwrap();
        // made even: each half the mirror image of the other
        let count = gait.poses.len() / 2 * 2;
        let mirrored = |pose: &Pose| -> Pose {
            std::array::from_fn(|joint| {
                pose[Joint::ALL[joint].mirrored() as usize] * Vec3::new(-1.0, 1.0, 1.0)
            })
        };
        let half = &gait.poses[..count / 2];
        let poses = half.iter().copied().chain(half.iter().map(mirrored)).collect();
        let even = walk(poses, Vec::new());
        for angle in ALL.into_iter().filter(|angle| !matches!(angle, Angle::Ankle | Angle::Foot)) {
            let [left, right] = Side::BOTH.map(|side| even.curve(angle, side).unwrap());
            let apart = left.iter().zip(&right).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
            assert!(apart < 1e-2, "{angle:?}: {apart}");
        }
    }
}
