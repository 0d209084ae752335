//! The formulas of the features (spec 1.5), in f64.

use super::{Cycle, FEATURE_COUNT, Point, count_f64};
use crate::gait::{JOINT_COUNT, Joint};

const UP: Point = [0.0, 1.0, 0.0];
/// Joints whose motion counts, in the order of the features.
const MOVING: [Joint; 5] =
    [Joint::RightHand, Joint::LeftHand, Joint::Head, Joint::RightFoot, Joint::LeftFoot];
/// Features of posture per frame.
const POSTURE: usize = 12;
/// Index of the stride length.
const STRIDE: usize = 12;
/// Index of the first speed.
const SPEED: usize = 13;
/// Index of the cycle time.
const CYCLE_TIME: usize = 28;
/// The authors' millimetres.
const MM: f64 = 1000.0;
/// The authors' time step, s.
const STEP_CODE_DT: f64 = 1.0 / 30.0;

type Pose = [Point; JOINT_COUNT];

fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn length(a: Point) -> f64 {
    dot(a, a).sqrt()
}

fn distance(a: Point, b: Point) -> f64 {
    length(sub(a, b))
}

fn cross(u: Point, v: Point) -> Point {
    [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
}

/// Angle between two vectors, degrees; 0 where one has no direction. By sine and cosine: an arc cosine alone loses half
/// the digits near 0 and 180.
fn angle(a: Point, b: Point) -> f64 {
    length(cross(a, b)).atan2(dot(a, b)).to_degrees()
}

/// Area of a triangle by the cross product of two sides: no cancellation.
fn area(a: Point, b: Point, c: Point) -> f64 {
    0.5 * length(cross(sub(b, a), sub(c, a)))
}

/// Area of a triangle by Heron's formula, as the authors' code has it.
fn heron(a: Point, b: Point, c: Point) -> f64 {
    let [x, y, z] = [distance(a, b), distance(a, c), distance(b, c)];
    let s = (x + y + z) / 2.0;
    // a flat triangle may come out just below 0
    (s * (s - x) * (s - y) * (s - z)).max(0.0).sqrt()
}

fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0_usize), |(sum, count), value| (sum + value, count + 1));
    if count > 0 { sum / count_f64(count) } else { 0.0 }
}

/// What the variants do differently in one frame.
struct Rules {
    volume: fn(&Pose) -> f64,
    back: Joint,
    area: fn(Point, Point, Point) -> f64,
}

/// The 12 features of a frame.
fn posture(pose: &Pose, rules: &Rules) -> [f64; POSTURE] {
    let p = |joint: Joint| pose[joint as usize];
    let (root, neck) = (p(Joint::Root), p(Joint::Neck));
    let (right, left) = (p(Joint::RightShoulder), p(Joint::LeftShoulder));
    [
        (rules.volume)(pose),
        angle(sub(right, neck), sub(left, neck)),
        angle(sub(neck, right), sub(left, right)),
        angle(sub(neck, left), sub(right, left)),
        angle(sub(p(rules.back), root), UP),
        angle(sub(p(Joint::Head), neck), sub(p(Joint::Spine), neck)),
        distance(p(Joint::RightHand), root),
        distance(p(Joint::LeftHand), root),
        distance(p(Joint::RightFoot), root),
        distance(p(Joint::LeftFoot), root),
        (rules.area)(p(Joint::LeftHand), neck, p(Joint::RightHand)),
        (rules.area)(p(Joint::LeftFoot), root, p(Joint::RightFoot)),
    ]
}

/// Volume of the box around all joints along the axes.
fn volume(pose: &Pose) -> f64 {
    (0..3)
        .map(|axis| {
            let values = || pose.iter().map(|point| point[axis]);
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        })
        .product()
}

/// The authors' box: a joint that sets a new minimum is not looked at for the maximum.
fn volume_with_missed_maxima(pose: &Pose) -> f64 {
    (0..3)
        .map(|axis| {
            let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
            for point in pose {
                if low > point[axis] {
                    low = point[axis];
                } else if high < point[axis] {
                    high = point[axis];
                }
            }
            // every joint a new minimum: no maximum was ever seen
            if high < low { 0.0 } else { high - low }
        })
        .product()
}

/// Means of the posture features over the frames.
fn mean_posture(poses: &[Pose], rules: &Rules) -> [f64; POSTURE] {
    let mut sums = [0.0; POSTURE];
    for pose in poses {
        for (sum, value) in sums.iter_mut().zip(posture(pose, rules)) {
            *sum += value;
        }
    }
    sums.map(|sum| sum / count_f64(poses.len()))
}

fn stride_length(poses: &[Pose]) -> f64 {
    let apart = |pose: &Pose| distance(pose[Joint::LeftFoot as usize], pose[Joint::RightFoot as usize]);
    poses.iter().map(apart).fold(0.0, f64::max)
}

/// Mean lengths of the first, second and third difference of a path.
fn differences(path: &[Point]) -> [f64; 3] {
    let mut path = path.to_vec();
    [(); 3].map(|()| {
        path = path.windows(2).map(|pair| sub(pair[1], pair[0])).collect();
        mean(path.iter().map(|step| length(*step)))
    })
}

/// The features of movement: `path` yields that of a joint; `step` is the time between its points, s.
fn movement(out: &mut [f64; FEATURE_COUNT], step: f64, path: impl Fn(Joint) -> [f64; 3]) {
    for (number, joint) in MOVING.into_iter().enumerate() {
        for (order, length) in path(joint).into_iter().enumerate() {
            out[SPEED + MOVING.len() * order + number] = (0..=order).fold(length, |rate, _| rate / step);
        }
    }
}

/// Position of a joint over the ground in frame `i`, which may lie beyond the cycle.
fn over_ground(cycle: &Cycle, joint: Joint, i: usize) -> Point {
    let [x, y, z] = cycle.poses[i % cycle.poses.len()][joint as usize];
    [x, y, z + cycle.speed * cycle.step * count_f64(i)]
}

/// [`super::Variant::Paper`].
pub(super) fn paper(cycle: &Cycle) -> [f64; FEATURE_COUNT] {
    let mut out = [0.0; FEATURE_COUNT];
    out[..POSTURE].copy_from_slice(&mean_posture(&cycle.poses, &Rules { volume, back: Joint::Neck, area }));
    out[STRIDE] = stride_length(&cycle.poses);
    let count = cycle.poses.len();
    movement(&mut out, cycle.step, |joint| {
        differences(&(0..count).map(|i| over_ground(cycle, joint, i)).collect::<Vec<_>>())
    });
    out[CYCLE_TIME] = cycle.step * count_f64(count);
    out
}

/// [`super::Variant::Corrected`].
pub(super) fn corrected(cycle: &Cycle) -> [f64; FEATURE_COUNT] {
    let mut out = [0.0; FEATURE_COUNT];
    let [fx, fz] = heading(&cycle.poses);
    // lengths and angles do not care for the heading, only the box does
    let turned = |pose: &Pose| pose.map(|[x, y, z]| [x * fz - z * fx, y, x * fx + z * fz]);
    let poses: Vec<Pose> = cycle.poses.iter().map(turned).collect();
    out[..POSTURE].copy_from_slice(&mean_posture(&poses, &Rules { volume, back: Joint::Head, area }));
    out[STRIDE] = stride_length(&poses);
    let count = poses.len();
    // one frame after the cycle for each order, so that every order has a difference for every frame
    movement(&mut out, cycle.step, |joint| {
        let mut path: Vec<Point> = (0..count + 3).map(|i| over_ground(cycle, joint, i)).collect();
        [3, 2, 1].map(|_| {
            path = path.windows(2).map(|pair| sub(pair[1], pair[0])).collect();
            mean(path.iter().take(count).map(|step| length(*step)))
        })
    });
    out[CYCLE_TIME] = cycle.step * count_f64(count);
    out
}

/// Where the body faces on the mean, as (x, z) of length 1: across hips and shoulders to the left, turned by a right
/// angle. +z for a body without sides.
fn heading(poses: &[Pose]) -> [f64; 2] {
    let (mut x, mut z) = (0.0, 0.0);
    for pose in poses {
        for (left, right) in [(Joint::LeftHip, Joint::RightHip), (Joint::LeftShoulder, Joint::RightShoulder)]
        {
            let across = sub(pose[left as usize], pose[right as usize]);
            (x, z) = (x - across[2], z + across[0]);
        }
    }
    let size = x.hypot(z);
    if size > 1e-9 { [x / size, z / size] } else { [0.0, 1.0] }
}

/// [`super::Variant::StepCode`], in the authors' units.
pub(super) fn step_code(cycle: &Cycle) -> [f64; FEATURE_COUNT] {
    let mut out = [0.0; FEATURE_COUNT];
    let rules = Rules { volume: volume_with_missed_maxima, back: Joint::Head, area: heron };
    out[..POSTURE].copy_from_slice(&mean_posture(&cycle.poses, &rules));
    out[0] *= MM * MM * MM / 1000.0;
    for distance in &mut out[6..10] {
        *distance *= MM / 10.0;
    }
    for area in &mut out[10..12] {
        *area *= MM * MM / 100.0;
    }
    let count = cycle.poses.len();
    movement(&mut out, STEP_CODE_DT, |joint| {
        let path: Vec<Point> = (0..count).map(|i| over_ground(cycle, joint, i)).collect();
        differences(&path).map(|length| length * MM / 10.0)
    });
    out[STRIDE] = frames_between_strikes(&cycle.poses);
    out[CYCLE_TIME] = out[STRIDE] * STEP_CODE_DT;
    out
}

/// The authors' stride length: mean number of frames between strikes of one foot (one more where only one foot has
/// two strikes), all frames where no foot has.
fn frames_between_strikes(poses: &[Pose]) -> f64 {
    let steps = [Joint::RightFoot, Joint::LeftFoot].map(|foot| {
        let strikes = lowest_frames(poses, foot);
        strikes.windows(2).map(|pair| count_f64(pair[1] - pair[0])).collect::<Vec<f64>>()
    });
    match [steps[0].is_empty(), steps[1].is_empty()] {
        [true, true] => count_f64(poses.len()),
        [false, false] => mean(steps.into_iter().flatten()),
        _ => mean(steps.into_iter().flatten()) + 1.0,
    }
}

/// Frames where a foot is no higher than in the frames beside; of a plateau those that do not follow one taken.
fn lowest_frames(poses: &[Pose], foot: Joint) -> Vec<usize> {
    let mut strikes: Vec<usize> = Vec::new();
    for i in 1..poses.len().saturating_sub(1) {
        let [before, now, after] = [i - 1, i, i + 1].map(|i| poses[i][foot as usize][1]);
        let is_flat = now.total_cmp(&before).is_eq() && now.total_cmp(&after).is_eq();
        let is_taken = is_flat && strikes.last() == Some(&(i - 1));
        if before >= now && now <= after && !is_taken {
            strikes.push(i);
        }
    }
    strikes
}
