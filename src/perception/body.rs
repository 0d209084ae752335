//! A walk cycle without what does not matter: curves over phase in the walker's own frame, in body lengths.
//!
//! Frames, rate and length of the cycle, where and which way the walker goes and how tall they are fall away, so
//! that gaits of different captures can be compared number by number. Ours; see also SV-GCN's relative features.

use super::linear::number;
use crate::gait::{Gait, JOINT_COUNT, Joint};
use std::f64::consts::TAU;

/// Frames of a normalised cycle.
pub(super) const FRAMES: usize = 64;

/// Poses a second where time counts and not phase, Hz.
pub(super) const RATE: f64 = 30.0;

/// Positions of the joints: x to the walker's left, y up, z ahead, body lengths.
pub(super) type BodyPose = [[f64; 3]; JOINT_COUNT];

/// A normalised walk cycle.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Body {
    /// Poses at equal steps of phase, root at the origin, facing +z.
    pub poses: Vec<BodyPose>,
    /// Foot to head along the bones, m: the unit of `poses`.
    pub length: f64,
    /// Seconds per cycle.
    pub cycle_time: f64,
    /// Speed over ground, body lengths per second.
    pub speed: f64,
}

impl Body {
    /// Normalises a gait to [`FRAMES`] poses. A gait without poses or size gives a body of zeros.
    pub(super) fn of(gait: &Gait) -> Self {
        Self::with_frames(gait, FRAMES)
    }

    /// [`Body::of`], with poses [`RATE`] to the second (but at least 8, at most four for each of the gait's).
    pub(super) fn at_rate(gait: &Gait) -> Self {
        let most = number(gait.poses.len().saturating_mul(4).max(8));
        #[allow(
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "clamped to counts of frames"
        )]
        let frames = (f64::from(gait.cycle_time()) * RATE).round().clamp(8.0, most) as usize;
        Self::with_frames(gait, frames)
    }

    fn with_frames(gait: &Gait, frames: usize) -> Self {
        let mut poses = resample(gait, frames);
        for pose in &mut poses {
            let root = pose[Joint::Root as usize];
            for point in pose {
                *point = minus(*point, root);
            }
        }
        // ahead is across hips and shoulders, on average over the cycle
        let mut across = [0.0; 3];
        for pose in &poses {
            for (left, right) in
                [(Joint::LeftHip, Joint::RightHip), (Joint::LeftShoulder, Joint::RightShoulder)]
            {
                let side = minus(pose[left as usize], pose[right as usize]);
                across.iter_mut().zip(side).for_each(|(a, s)| *a += s);
            }
        }
        let width = across[0].hypot(across[2]);
        let (cosine, sine) = if width > 0.0 { (across[0] / width, across[2] / width) } else { (1.0, 0.0) };
        let length = body_length(&poses);
        let unit = if length > 1e-9 { length } else { 1.0 };
        for [x, y, z] in poses.iter_mut().flatten() {
            (*x, *y, *z) = ((cosine * *x + sine * *z) / unit, *y / unit, (cosine * *z - sine * *x) / unit);
        }
        Self {
            poses,
            length,
            cycle_time: f64::from(gait.cycle_time()).max(1e-3),
            speed: f64::from(gait.speed) / unit,
        }
    }

    /// A joint's path.
    pub(super) fn path(&self, joint: Joint) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.poses.iter().map(move |pose| pose[joint as usize])
    }

    /// The vector from one joint to another, over the cycle.
    pub(super) fn bone(&self, from: Joint, to: Joint) -> impl Iterator<Item = [f64; 3]> + '_ {
        self.poses.iter().map(move |pose| minus(pose[to as usize], pose[from as usize]))
    }
}

/// Poses at equal steps of phase, interpolated along straight lines; the cycle closes.
fn resample(gait: &Gait, frames: usize) -> Vec<BodyPose> {
    let count = gait.poses.len();
    if count == 0 {
        return vec![[[0.0; 3]; JOINT_COUNT]; frames];
    }
    let blend = |i: usize| {
        let (frame, rest) = (i * count / frames, i * count % frames);
        let share = number(rest) / number(frames);
        let (before, after) = (&gait.poses[frame], &gait.poses[(frame + 1) % count]);
        std::array::from_fn(|joint| {
            let (a, b) = (before[joint].to_array(), after[joint].to_array());
            std::array::from_fn(|axis| f64::from(a[axis]) * (1.0 - share) + f64::from(b[axis]) * share)
        })
    };
    (0..frames).map(blend).collect()
}

/// Foot, knee, hip (mean of the sides) and root, spine, neck, head along the bones, mean over the cycle.
fn body_length(poses: &[BodyPose]) -> f64 {
    let bones = [
        (Joint::LeftFoot, Joint::LeftKnee, 0.5),
        (Joint::LeftKnee, Joint::LeftHip, 0.5),
        (Joint::RightFoot, Joint::RightKnee, 0.5),
        (Joint::RightKnee, Joint::RightHip, 0.5),
        (Joint::Root, Joint::Spine, 1.0),
        (Joint::Spine, Joint::Neck, 1.0),
        (Joint::Neck, Joint::Head, 1.0),
    ];
    let along = |pose: &BodyPose| -> f64 {
        bones.iter().map(|&(a, b, share)| share * length(minus(pose[a as usize], pose[b as usize]))).sum()
    };
    poses.iter().map(along).sum::<f64>() / number(poses.len())
}

/// `a - b`.
pub(super) fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Euclidean length.
pub(super) fn length(v: [f64; 3]) -> f64 {
    (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]).sqrt()
}

/// Angle between two vectors, 0 to pi radians; a right angle where one has no length.
pub(super) fn angle(a: [f64; 3], b: [f64; 3]) -> f64 {
    let product = length(a) * length(b);
    let cosine = (a[0] * b[0] + a[1] * b[1] + a[2] * b[2]) / product;
    if product > 0.0 { cosine.clamp(-1.0, 1.0).acos() } else { std::f64::consts::FRAC_PI_2 }
}

/// x, to the walker's left.
pub(super) const LEFTWARD: [f64; 3] = [1.0, 0.0, 0.0];
/// y.
pub(super) const UP: [f64; 3] = [0.0, 1.0, 0.0];
/// -y.
pub(super) const DOWN: [f64; 3] = [0.0, -1.0, 0.0];
/// z.
pub(super) const AHEAD: [f64; 3] = [0.0, 0.0, 1.0];
/// -z.
pub(super) const BACK: [f64; 3] = [0.0, 0.0, -1.0];

/// Angle of vectors in the plane of two axes, radians: 0 along `from`, positive towards `to`; without jumps.
pub(super) fn in_plane(vectors: impl Iterator<Item = [f64; 3]>, to: [f64; 3], from: [f64; 3]) -> Vec<f64> {
    let along = |v: [f64; 3], axis: [f64; 3]| v[0] * axis[0] + v[1] * axis[1] + v[2] * axis[2];
    unwrapped(vectors.map(|v| along(v, to).atan2(along(v, from))).collect())
}

/// An angle over a cycle without jumps of a whole turn.
pub(super) fn unwrapped(mut curve: Vec<f64>) -> Vec<f64> {
    for i in 1..curve.len() {
        let turns = ((curve[i] - curve[i - 1]) / TAU).round();
        curve[i] -= turns * TAU;
    }
    curve
}

/// Mean of a curve over the cycle; 0 of no curve.
pub(super) fn mean(curve: &[f64]) -> f64 {
    curve.iter().sum::<f64>() / number(curve.len().max(1))
}

/// Amplitude of harmonic `k` (1 is once a cycle): `sqrt(a^2 + b^2)` of `a cos(k phase) + b sin(k phase)`.
pub(super) fn amplitude(curve: &[f64], k: usize) -> f64 {
    let count = number(curve.len().max(1));
    let (mut cosines, mut sines) = (0.0, 0.0);
    for (i, value) in curve.iter().enumerate() {
        let (sine, cosine) = (TAU * number(k * i) / count).sin_cos();
        cosines += value * cosine;
        sines += value * sine;
    }
    2.0 * cosines.hypot(sines) / count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, WalkerStyle, walk};
    use glam::{Quat, Vec3};

    fn walker() -> Gait {
        walk(&WalkerStyle::preset(Emotion::Happy, Sex::Female), "happy").unwrap()
    }

    #[test]
    fn place_heading_and_size_fall_away() {
        let gait = walker();
        let mut other = gait.clone();
        let turn = Quat::from_rotation_y(0.4);
        for point in other.poses.iter_mut().flatten() {
            *point = turn * *point * 1.2 + Vec3::new(3.0, 1.0, -2.0);
        }
        other.speed *= 1.2;
        let (a, b) = (Body::of(&gait), Body::of(&other));
        for (p, q) in a.poses.iter().flatten().zip(b.poses.iter().flatten()) {
            assert!(length(minus(*p, *q)) < 1e-5);
        }
        assert!((b.length / a.length - 1.2).abs() < 1e-5);
        assert!((b.speed - a.speed).abs() < 1e-5);
    }

    #[test]
    fn the_walker_faces_ahead_with_the_left_at_plus_x() {
        let body = Body::of(&walker());
        let left: f64 = mean(&body.bone(Joint::RightHip, Joint::LeftHip).map(|v| v[0]).collect::<Vec<_>>());
        assert!(left > 0.05);
        assert_eq!(body.poses.len(), FRAMES);
    }

    #[test]
    fn amplitude_of_a_sinusoid_is_its_amplitude() {
        let curve: Vec<f64> =
            (0..FRAMES).map(|i| 5.0 + 0.7 * (TAU * 2.0 * number(i) / 64.0 + 1.0).sin()).collect();
        assert!((amplitude(&curve, 2) - 0.7).abs() < 1e-12);
        assert!(amplitude(&curve, 1).abs() < 1e-12);
        assert!((mean(&curve) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn unwrapped_angles_do_not_jump() {
        let curve =
            unwrapped((0..40_u8).map(|i| (f64::from(i) * 0.3).sin_cos()).map(|(s, c)| s.atan2(c)).collect());
        assert!(curve.windows(2).all(|pair| (pair[1] - pair[0] - 0.3).abs() < 1e-9));
    }

    #[test]
    fn a_gait_without_poses_or_size_is_a_body_of_zeros() {
        let mut gait = walker();
        gait.poses.iter_mut().flatten().for_each(|point| *point = Vec3::ONE);
        assert!(Body::of(&gait).poses.iter().flatten().flatten().all(|v| *v == 0.0));
        gait.poses.clear();
        assert_eq!(Body::of(&gait).poses.len(), FRAMES);
    }
}
