//! Periodic curves: a gait resampled to the clip's phases, and small filters over the cycle.

use super::super::{CLIP_FRAMES, Error};
use crate::gait::{Gait, Joint, Pose};
use glam::Vec3;

/// Checks a gait and samples it at the clip's phases (periodic Catmull-Rom between its frames).
///
/// # Errors
/// [`Error::Unusable`] for fewer than 4 frames, positions that are not finite, a bad rate or speed.
pub(super) fn resample(gait: &Gait) -> Result<Vec<Pose>, Error> {
    let unusable = |message: String| Error::Unusable { name: gait.name.clone(), message };
    let count = gait.poses.len();
    if count < 4 {
        return Err(unusable(format!("has {count} frames; a walk cycle needs 4 or more")));
    }
    if !(gait.frame_rate.is_finite() && gait.frame_rate > 0.0) {
        return Err(unusable(format!("frame rate is {} Hz; it must be positive", gait.frame_rate)));
    }
    if !(gait.speed.is_finite() && gait.speed >= 0.0) {
        return Err(unusable(format!("speed is {} m/s; it must be 0 or more", gait.speed)));
    }
    for (frame, pose) in gait.poses.iter().enumerate() {
        for joint in Joint::ALL {
            let p = pose[joint as usize];
            if !p.is_finite() || p.abs().max_element() > 1e3 {
                let name = joint.name();
                return Err(unusable(format!(
                    "frame {frame}: joint {name} is at {p}; expected metres about the origin"
                )));
            }
        }
    }
    let sample = |frame: usize| -> Pose {
        let at = frame as f32 / CLIP_FRAMES as f32 * count as f32;
        let t = at.fract();
        let first = frame * count / CLIP_FRAMES;
        let pose = |offset: usize| &gait.poses[(first + count + offset - 1) % count];
        let [a, b, c, d] = [pose(0), pose(1), pose(2), pose(3)];
        std::array::from_fn(|j| {
            let (m0, m1) = (0.5 * (c[j] - a[j]), 0.5 * (d[j] - b[j]));
            hermite(b[j], m0, c[j], m1, t)
        })
    };
    Ok((0..CLIP_FRAMES).map(sample).collect())
}

/// Cubic from `a` with slope `m0` at t = 0 to `b` with slope `m1` at t = 1.
pub(super) fn hermite<T>(a: T, m0: T, b: T, m1: T, t: f32) -> T
where
    T: std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let (t2, t3) = (t * t, t * t * t);
    a * (2.0 * t3 - 3.0 * t2 + 1.0) + m0 * (t3 - 2.0 * t2 + t) + b * (3.0 * t2 - 2.0 * t3) + m1 * (t3 - t2)
}

/// A value at any phase, from those of a cycle at equal steps (straight lines between).
pub(super) fn between<T>(values: &[T], phase: f32) -> T
where
    T: Copy + std::ops::Mul<f32, Output = T> + std::ops::Add<Output = T>,
{
    let count = values.len();
    let at = phase.rem_euclid(1.0) * count as f32;
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 <= at <= count, taken modulo count"
    )]
    let first = at as usize % count;
    values[first] * (1.0 - at.fract()) + values[(first + 1) % count] * at.fract()
}

/// Position of a joint at any phase, from the resampled cycle.
pub(super) fn at_phase(poses: &[Pose], joint: Joint, phase: f32) -> Vec3 {
    let places: Vec<Vec3> = poses.iter().map(|pose| pose[joint as usize]).collect();
    between(&places, phase)
}

/// A smooth periodic curve that is nowhere below `values`: a running maximum, then averages within its reach.
pub(super) fn smooth_above(values: &[f32]) -> Vec<f32> {
    const REACH: usize = 3;
    let count = values.len();
    let around = |i: usize, reach: usize| (0..=2 * reach).map(move |k| (i + count + k - reach) % count);
    let mut curve: Vec<f32> =
        (0..count).map(|i| around(i, REACH).map(|k| values[k]).fold(f32::MIN, f32::max)).collect();
    for _ in 0..REACH {
        curve = (0..count).map(|i| around(i, 1).map(|k| curve[k]).sum::<f32>() / 3.0).collect();
    }
    curve
}

/// Averages over a few frames to either side.
pub(super) fn smooth(values: &[f32]) -> Vec<f32> {
    const PASSES: usize = 4;
    let count = values.len();
    let mean =
        |curve: &[f32], i: usize| (curve[(i + count - 1) % count] + curve[i] + curve[(i + 1) % count]) / 3.0;
    (0..PASSES).fold(values.to_vec(), |curve, _| (0..count).map(|i| mean(&curve, i)).collect())
}
