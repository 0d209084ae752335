//! A take seen as a walk: which way the body faces, where the feet strike, and travel where the file has none.
//!
//! A foot strikes shortly after it is furthest in front of the root (Zeni, Richards and Higginson 2008), at the
//! moment it comes to rest on the ground. Where that rule finds nothing, the authors' rule serves: a local minimum
//! of the foot's height.

use super::filter::{derivative, frames, low_pass, peaks};
use crate::gait::{Joint, Pose};
use glam::{Vec2, Vec3};

/// Movements of the feet faster than this are noise, Hz.
pub(super) const FOOT_CUTOFF_HZ: f32 = 6.0;
/// Turns of the body faster than this are the sway of one stride, Hz.
const FACING_CUTOFF_HZ: f32 = 0.8;
/// Two strikes of one foot are at least this far apart, s.
const SEPARATION_S: f32 = 0.3;
/// A strike's forward reach stands out by this share of the foot's whole range.
const PROMINENCE: f32 = 0.3;
/// A foot comes to rest at most this long after its furthest reach, s.
const SETTLE_S: f32 = 0.15;
/// A foot that moves slower than this share of the walking speed has come to rest.
const REST_SHARE: f32 = 0.25;
/// A planted foot must at some time of its stance be slower than this share of the walking speed.
const STANCE_SHARE: f32 = 0.5;
/// The stance is looked at for this long, s.
const STANCE_S: f32 = 0.4;
/// A foot has landed when it is this share of its range above its lowest.
const LANDED_SHARE: f32 = 0.1;
/// Feet whose reach varies by less than this do not walk, m.
const LEAST_REACH: f32 = 0.08;
/// Height over which the weight passes from one foot to the other, m.
const WEIGHT_SHIFT: f32 = 0.01;
/// Difference in speed over which one foot takes over from the other as the planted one, m/s.
const SPEED_SHIFT: f32 = 0.1;

/// A body that travels less than this share of what its planted feet slide is on the spot.
const ON_THE_SPOT_SHARE: f32 = 0.25;

/// The usual speed of a planted foot is the one that this share of the frames stays below (ours: CMU's and
/// Bandai-Namco's takes, put on the spot, then keep 96 and 98 % of their speed).
const USUAL_SHARE: f32 = 0.6;

pub(super) const FEET: [Joint; 2] = [Joint::LeftFoot, Joint::RightFoot];

/// Direction in which the body faces at each frame, unit, on the ground: across hips and shoulders, smoothed.
pub(super) fn facing(poses: &[Pose], rate: f32) -> Vec<Vec3> {
    let raw: Vec<Vec3> = poses.iter().map(facing_now).collect();
    let axis = |axis: usize| {
        let signal: Vec<f32> = raw.iter().map(|f| f[axis]).collect();
        low_pass(&signal, rate, FACING_CUTOFF_HZ)
    };
    let (x, z) = (axis(0), axis(2));
    x.into_iter().zip(z).map(|(x, z)| Vec3::new(x, 0.0, z).normalize_or(Vec3::Z)).collect()
}

/// Direction in which the body faces in one pose, unit, on the ground; zero if it lies on its side.
pub(super) fn facing_now(pose: &Pose) -> Vec3 {
    let across = pose[Joint::LeftHip as usize] - pose[Joint::RightHip as usize]
        + pose[Joint::LeftShoulder as usize]
        - pose[Joint::RightShoulder as usize];
    across.with_y(0.0).normalize_or_zero().cross(Vec3::Y)
}

/// Share of the weight on the left foot, 0 to 1: all on the lower foot, passing over within a centimetre.
fn weight_on_left(pose: &Pose) -> f32 {
    logistic((pose[Joint::RightFoot as usize].y - pose[Joint::LeftFoot as usize].y) / WEIGHT_SHIFT)
}

/// Where the planted foot drifts to, summed over time: `[frame]`, m, horizontal. Minus this is the walker's travel
/// if the ground moves under it. The planted foot is the one that moves backwards faster (or forwards slower):
/// the ankle of a planted foot is often the higher one, late in its stance, but a swinging foot always goes forward.
fn planted_drift(poses: &[Pose], rate: f32, facing: &[Vec3]) -> Vec<Vec3> {
    let forward = FEET.map(|foot| forward_speed(poses, rate, foot, facing));
    let left_planted = |i: usize| logistic((forward[1][i] - forward[0][i]) / SPEED_SHIFT);
    let mut drift = Vec3::ZERO;
    let mut drifts = vec![Vec3::ZERO; poses.len().min(1)];
    for (i, pair) in poses.windows(2).enumerate() {
        let step = |foot: Joint| (pair[1][foot as usize] - pair[0][foot as usize]).with_y(0.0);
        let left = f32::midpoint(left_planted(i), left_planted(i + 1));
        drift += step(Joint::LeftFoot) * left + step(Joint::RightFoot) * (1.0 - left);
        drifts.push(drift);
    }
    drifts
}

/// Smoothed speed of a joint along the facing, m/s, in the frame of the file.
fn forward_speed(poses: &[Pose], rate: f32, joint: Joint, facing: &[Vec3]) -> Vec<f32> {
    let [x, z] = [0, 2].map(|axis| {
        let signal: Vec<f32> = poses.iter().map(|pose| pose[joint as usize][axis]).collect();
        derivative(&low_pass(&signal, rate, FOOT_CUTOFF_HZ), rate)
    });
    facing.iter().enumerate().map(|(i, f)| x[i] * f.x + z[i] * f.z).collect()
}

fn logistic(x: f32) -> f32 {
    1.0 / (1.0 + libm::expf((-x).clamp(-30.0, 30.0)))
}

/// Whether the walker stays on the spot: the body travels less than a quarter of the way that its planted feet slide
/// backwards. True of treadmills and of data centred on the root; not of walking backwards, where the body
/// travels at least half as far as its feet.
pub(super) fn is_on_the_spot(poses: &[Pose], rate: f32) -> bool {
    let facing = facing(poses, rate);
    let drift = planted_drift(poses, rate, &facing);
    // In the body's own directions, forwards and to the left, so that sway cancels out and turns do not matter.
    let own = |path: &dyn Fn(usize) -> Vec3| -> Vec2 {
        let step = |i: usize| path(i) - path(i - 1);
        (1..poses.len())
            .map(|i| Vec2::new(step(i).dot(facing[i]), step(i).dot(Vec3::Y.cross(facing[i]))))
            .sum()
    };
    let slid = -own(&|i| drift[i]).x;
    let travelled = own(&|i| poses[i][Joint::Root as usize]).length();
    slid > 0.05 && travelled < ON_THE_SPOT_SHARE * slid
}

/// Gives a walker on the spot its travel: moves all joints so that the foot under weight stands still; where the
/// root's height is pinned as well, so that it also stays level.
pub(super) fn restore_travel(poses: &mut [Pose], rate: f32) {
    let root_height: Vec<f32> = poses.iter().map(|pose| pose[Joint::Root as usize].y).collect();
    let range = root_height.iter().copied().fold(f32::MIN, f32::max)
        - root_height.iter().copied().fold(f32::MAX, f32::min);
    let mut lift = vec![0.0; poses.len()];
    if range < 1e-3 {
        let sole: Vec<f32> = poses
            .iter()
            .map(|pose| {
                let left = weight_on_left(pose);
                -left * pose[Joint::LeftFoot as usize].y - (1.0 - left) * pose[Joint::RightFoot as usize].y
            })
            .collect();
        lift = low_pass(&sole, rate, FOOT_CUTOFF_HZ);
    }
    let facing = facing(poses, rate);
    let mut drift = planted_drift(poses, rate, &facing);
    never_slower_than_usual(&mut drift, &facing);
    for ((pose, drift), lift) in poses.iter_mut().zip(drift).zip(lift) {
        for point in pose {
            *point += Vec3::Y * lift - drift;
        }
    }
}

/// Fills the dips of the planted foot's speed up to its usual value. While the heel leaves the ground the ankle
/// rolls forward over the toes, so that for a part of each stance both ankles are slower than the ground; without
/// this the speed of CMU's takes, put on the spot, comes out 9 % low.
fn never_slower_than_usual(drift: &mut [Vec3], facing: &[Vec3]) {
    let steps: Vec<f32> = drift.windows(2).zip(facing).map(|(pair, f)| (pair[0] - pair[1]).dot(*f)).collect();
    let mut sorted = steps.clone();
    sorted.sort_by(f32::total_cmp);
    let usual = sorted.get(frames(USUAL_SHARE * sorted.len() as f32)).copied().unwrap_or(0.0);
    let mut filled = Vec3::ZERO;
    for ((drift, step), f) in drift.iter_mut().skip(1).zip(steps).zip(facing) {
        filled -= *f * (usual - step).max(0.0);
        *drift += filled;
    }
}

/// Strikes of the left and of the right foot in fractional frames, and the rule that found each foot's.
#[derive(Debug, Clone, Default)]
pub(super) struct Strikes {
    /// Frames of the strikes, rising, left foot first.
    pub(super) of_foot: [Vec<f32>; 2],
    /// Whether the authors' rule (lowest foot) had to serve.
    pub(super) by_height: [bool; 2],
}

/// Finds the foot strikes of a walk with travel.
pub(super) fn strikes(poses: &[Pose], rate: f32, facing: &[Vec3]) -> Strikes {
    let root: [Vec<f32>; 2] = [0, 2].map(|axis| {
        let signal: Vec<f32> = poses.iter().map(|pose| pose[Joint::Root as usize][axis]).collect();
        derivative(&low_pass(&signal, rate, FACING_CUTOFF_HZ), rate)
    });
    let walking: Vec<f32> =
        facing.iter().enumerate().map(|(i, f)| Vec3::new(root[0][i], 0.0, root[1][i]).dot(*f)).collect();
    let mut strikes = Strikes::default();
    for (side, foot) in FEET.into_iter().enumerate() {
        strikes.of_foot[side] = by_reach(poses, rate, foot, facing, &walking);
        if strikes.of_foot[side].len() < 2 {
            strikes.of_foot[side] = by_height(poses, rate, foot);
            strikes.by_height[side] = true;
        }
    }
    strikes
}

/// Strikes by furthest reach in front of the root. `walking`: speed of the root along `facing`, m/s.
fn by_reach(poses: &[Pose], rate: f32, foot: Joint, facing: &[Vec3], walking: &[f32]) -> Vec<f32> {
    let reach: Vec<f32> = poses
        .iter()
        .zip(facing)
        .map(|(pose, f)| (pose[foot as usize] - pose[Joint::Root as usize]).dot(*f))
        .collect();
    let reach = low_pass(&reach, rate, FOOT_CUTOFF_HZ);
    let forward = forward_speed(poses, rate, foot, facing);

    let mut sorted = reach.clone();
    sorted.sort_by(f32::total_cmp);
    let quantile = |share: f32| sorted.get(frames(share * sorted.len() as f32)).copied().unwrap_or(0.0);
    let range = quantile(0.95) - quantile(0.05);
    if range < LEAST_REACH {
        return Vec::new();
    }
    let window = frames(STANCE_S * rate).max(1);
    peaks(&reach, SEPARATION_S * rate, PROMINENCE * range)
        .into_iter()
        .filter(|&peak| {
            let stance = &forward[peak..(peak + window).min(forward.len())];
            let slowest = stance.iter().map(|speed| speed.abs()).fold(f32::MAX, f32::min);
            slowest < STANCE_SHARE * walking[peak].abs() + 0.05
        })
        .map(|peak| settled(&forward, peak, REST_SHARE * walking[peak].abs(), frames(SETTLE_S * rate)))
        .collect()
}

/// The moment after `peak` when the forward speed falls to `rest`, between frames; `peak` if it never does.
fn settled(forward: &[f32], peak: usize, rest: f32, within: usize) -> f32 {
    let end = (peak + within).min(forward.len().saturating_sub(1));
    for i in peak..end {
        let (now, next) = (forward[i], forward[i + 1]);
        if now > rest && next <= rest {
            return i as f32 + (now - rest) / (now - next).max(1e-9);
        }
    }
    peak as f32
}

/// The authors' rule: local minima of the foot's height in the lower third of its range; the strike is when the
/// foot has come down to there.
fn by_height(poses: &[Pose], rate: f32, foot: Joint) -> Vec<f32> {
    let height: Vec<f32> = poses.iter().map(|pose| -pose[foot as usize].y).collect();
    let depth = low_pass(&height, rate, FOOT_CUTOFF_HZ);
    let (low, high) = depth.iter().fold((f32::MAX, f32::MIN), |(l, h), &d| (l.min(d), h.max(d)));
    let range = high - low;
    let minima = peaks(&depth, SEPARATION_S * rate, 0.1 * range);
    let landed = |minimum: usize| {
        // A planted foot is lowest anywhere in its stance: back to where it came down.
        let level = depth[minimum] - LANDED_SHARE * range;
        let before = depth[..minimum].iter().rposition(|&d| d < level)?;
        let (above, below) = (depth[before], depth[before + 1]);
        Some(before as f32 + (level - above) / (below - above).max(1e-9))
    };
    minima.into_iter().filter(|&i| depth[i] > high - range / 3.0).filter_map(landed).collect()
}
