//! The upper body of the norm, for captures of the legs: where a joint was not captured, it stands where the neutral walker
//! has it, scaled to the legs.

use super::walker::{Sex, WalkerStyle, walk};
use super::{JOINT_COUNT, Joint, JointSet, Pose};
use crate::emotion::Emotion;
use glam::Vec3;
use std::sync::LazyLock;

/// One cycle of the neutral walker from the left strike on, mean of both sexes.
static NORM: LazyLock<Vec<Pose>> = LazyLock::new(|| {
    let poses = |sex| walk(&WalkerStyle::preset(Emotion::Neutral, sex), "norm").map(|gait| gait.poses);
    match (poses(Sex::Female), poses(Sex::Male)) {
        (Ok(female), Ok(male)) => female.iter().zip(&male).map(|(a, b)| between(a, b, 0.5)).collect(),
        // Presets always walk.
        _ => Vec::new(),
    }
});

fn between(a: &Pose, b: &Pose, share: f32) -> Pose {
    std::array::from_fn(|joint| a[joint].lerp(b[joint], share))
}

/// From the parent to each joint; zero for the root.
fn bones(pose: &Pose) -> Pose {
    std::array::from_fn(|joint| pose[joint] - pose[Joint::PARENT[joint]])
}

/// Length of thigh and shank, mean of both legs, median over the poses.
fn leg_length(poses: &[Pose]) -> f32 {
    let bones = [Joint::LeftKnee, Joint::LeftFoot, Joint::RightKnee, Joint::RightFoot];
    let length = |pose: &Pose| {
        bones
            .iter()
            .map(|&joint| pose[joint as usize].distance(pose[Joint::PARENT[joint as usize]]))
            .sum::<f32>()
            / 2.0
    };
    let mut lengths: Vec<f32> = poses.iter().map(length).collect();
    lengths.sort_by(f32::total_cmp);
    lengths.get(lengths.len() / 2).copied().unwrap_or(0.0)
}

/// Hangs the missing joints on those that are there, by these bones.
fn hang(pose: &mut Pose, missing: JointSet, bones: &Pose) {
    // Parents come first.
    for joint in missing.iter().map(|joint| joint as usize) {
        pose[joint] = pose[Joint::PARENT[joint]] + bones[joint];
    }
}

/// Puts the missing joints where the norm has them on average, upright over the pelvis, in any frame and unit: a stand-in
/// until the phase is known.
pub(super) fn stand_in(poses: &mut [Pose], missing: JointSet) {
    if missing.is_empty() || NORM.is_empty() {
        return;
    }
    let scale = leg_length(poses) / leg_length(&NORM);
    let mut mean = [Vec3::ZERO; JOINT_COUNT];
    for pose in NORM.iter() {
        for (sum, bone) in mean.iter_mut().zip(bones(pose)) {
            *sum += bone * (scale / NORM.len() as f32);
        }
    }
    let rise = |pose: &Pose| {
        pose[Joint::Root as usize] - (pose[Joint::LeftFoot as usize] + pose[Joint::RightFoot as usize]) / 2.0
    };
    let up = poses.iter().map(rise).sum::<Vec3>().normalize_or(Vec3::Y);
    for pose in poses {
        let across = pose[Joint::LeftHip as usize] - pose[Joint::RightHip as usize];
        let left = across.reject_from_normalized(up).normalize_or(up.any_orthonormal_vector());
        let forward = left.cross(up);
        hang(pose, missing, &mean.map(|bone| left * bone.x + up * bone.y + forward * bone.z));
    }
}

/// Puts the missing joints of a cycle, on the spot towards +z from the left strike on, where the norm has them at each
/// phase.
pub(super) fn complete(poses: &mut [Pose], missing: JointSet) {
    if missing.is_empty() || NORM.is_empty() {
        return;
    }
    let scale = leg_length(poses) / leg_length(&NORM);
    let count = poses.len();
    for (index, pose) in poses.iter_mut().enumerate() {
        let (whole, rest) = (index * NORM.len() / count, index * NORM.len() % count);
        let (here, next) = (&NORM[whole], &NORM[(whole + 1) % NORM.len()]);
        let norm = between(here, next, rest as f32 / count as f32);
        hang(pose, missing, &bones(&norm).map(|bone| bone * scale));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_norm_gets_its_own_upper_body_back_at_any_size() {
        let missing: JointSet = Joint::UPPER_BODY.into_iter().collect();
        for scale in [0.7, 1.0, 1.3] {
            let whole: Vec<Pose> = NORM.iter().map(|pose| pose.map(|point| point * scale)).collect();
            let mut legs = whole.clone();
            for pose in &mut legs {
                missing.iter().for_each(|joint| pose[joint as usize] = Vec3::ZERO);
            }
            let mut standing = legs.clone();
            complete(&mut legs, missing);
            stand_in(&mut standing, missing);
            for ((a, b), c) in
                whole.iter().flatten().zip(legs.iter().flatten()).zip(standing.iter().flatten())
            {
                assert!(a.distance(*b) < 1e-4 * scale, "{a} {b}");
                assert!(a.distance(*c) < 0.35 * scale, "{a} {c}");
            }
        }
    }
}
