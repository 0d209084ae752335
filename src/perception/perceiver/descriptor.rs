//! What [`super::PhasePerceiver`] sees of a gait.

use crate::gait::{Gait, Joint};
use crate::perception::body::{
    AHEAD, BACK, Body, DOWN, FRAMES, LEFTWARD, UP, amplitude, angle, in_plane, length, mean,
};
use crate::perception::features::{Variant, features};
use crate::perception::linear::number;
use Joint::{
    Head, LeftElbow, LeftFoot, LeftHand, LeftHip, LeftKnee, LeftShoulder, Neck, RightHip, RightShoulder,
    Root, Spine,
};

/// Numbers of a [`descriptor`]: positions 54, angles 57, speeds 45, tempo 3, paper 20.
pub const DESCRIPTOR_LENGTH: usize = 179;

/// Harmonics of a cycle of which amplitudes are kept.
const HARMONICS: usize = 2;
/// Angles of a side whose means describe posture.
const POSED: usize = 8;
/// Added to speeds before their logarithm, body lengths.
const STILL: f64 = 1e-3;
/// Joints of the middle; the root is the origin.
const MIDDLE: [Joint; 3] = [Spine, Neck, Head];
/// Joints of the left side; the right side is averaged into them.
const LEFT: [Joint; 6] = [LeftShoulder, LeftElbow, LeftHand, LeftHip, LeftKnee, LeftFoot];

/// The numbers of a gait; both sides of the body have the same say. In order:
///
/// - joint positions relative to the root, body lengths: amplitude of the first two harmonics on each axis;
/// - joint angles, radians: mean of those that are not mirrored into their negative, and the same amplitudes;
/// - joint speeds, as logarithms: relative to the root per cycle (mean, largest) and per second (mean), over
///   ground per second (mean, largest), in body lengths;
/// - logarithms of cycle time (s), speed (body lengths per s) and travel per cycle (body lengths);
/// - the paper's 29 features ([`Variant::Corrected`]).
///
/// What tells of the capture and not of the walk is left out: where a joint lies on average is where a rig puts it (from
/// neck to shoulder, nine CMU trials rise by 28 degrees more than the same trials in E-Gait), and body length in metres is
/// not in E-Gait.
///
/// Not finite where the gait has numbers that are not, or no poses.
pub fn descriptor(gait: &Gait) -> Vec<f64> {
    if gait.poses.is_empty() {
        return vec![f64::NAN; DESCRIPTOR_LENGTH];
    }
    let body = Body::of(gait);
    let mut numbers = Vec::with_capacity(DESCRIPTOR_LENGTH);
    positions(&body, &mut numbers);
    angles(&body, &mut numbers);
    speeds(&body, &mut numbers);
    let speed = body.speed.max(STILL);
    numbers.extend([body.cycle_time.ln(), speed.ln(), (speed * body.cycle_time).ln()]);
    paper(gait, &mut numbers);
    numbers
}

/// A curve's amplitudes.
fn amplitudes(curve: &[f64]) -> [f64; HARMONICS] {
    std::array::from_fn(|k| amplitude(curve, k + 1))
}

/// `(a + b) / 2` of each.
fn averaged<const N: usize>(a: [f64; N], b: [f64; N]) -> [f64; N] {
    std::array::from_fn(|i| f64::midpoint(a[i], b[i]))
}

fn positions(body: &Body, numbers: &mut Vec<f64>) {
    let curve =
        |joint: Joint, axis: usize| -> Vec<f64> { body.path(joint).map(|point| point[axis]).collect() };
    for joint in MIDDLE {
        for axis in 0..3 {
            numbers.extend(amplitudes(&curve(joint, axis)));
        }
    }
    for joint in LEFT {
        let other = joint.mirrored();
        for axis in 0..3 {
            let (left, right) = (curve(joint, axis), curve(other, axis));
            numbers.extend(averaged(amplitudes(&left), amplitudes(&right)));
        }
    }
}

/// Mean of an angle, in (-pi, pi].
fn mean_angle(curve: &[f64]) -> f64 {
    let mean = mean(curve);
    mean.sin().atan2(mean.cos())
}

fn angles(body: &Body, numbers: &mut Vec<f64>) {
    let pitch = |from, to| in_plane(body.bone(from, to), AHEAD, UP);
    let roll = |from, to| in_plane(body.bone(from, to), LEFTWARD, UP);
    let yaw = |right, left| in_plane(body.bone(right, left), BACK, LEFTWARD);
    let difference = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a - b).collect::<Vec<_>>();
    let (upper, head) = (pitch(Spine, Neck), pitch(Neck, Head));
    let nod = difference(&head, &upper);
    for curve in [pitch(Root, Neck), pitch(Root, Spine), upper, head, nod] {
        numbers.push(mean_angle(&curve));
        numbers.extend(amplitudes(&curve));
    }
    let (shoulders, hips) = (yaw(RightShoulder, LeftShoulder), yaw(RightHip, LeftHip));
    let twist = difference(&shoulders, &hips);
    let tilt = |right, left| {
        body.bone(right, left).map(|v: [f64; 3]| v[1].atan2(v[0].hypot(v[2]))).collect::<Vec<_>>()
    };
    let tilts = [tilt(RightShoulder, LeftShoulder), tilt(RightHip, LeftHip)];
    for curve in [roll(Root, Neck), roll(Neck, Head), shoulders, hips, twist].iter().chain(&tilts) {
        numbers.extend(amplitudes(curve));
    }
    let (left, right) = (side_angles(body, false), side_angles(body, true));
    for (i, (left, right)) in left.iter().zip(&right).enumerate() {
        if i < POSED {
            numbers.push(f64::midpoint(mean_angle(left), mean_angle(right)));
        }
        numbers.extend(averaged(amplitudes(left), amplitudes(right)));
    }
}

/// Angles of arm and leg of one side, and behind the first [`POSED`] those of the shoulder girdle, whose means are the
/// rig's; outwards is positive on both.
fn side_angles(body: &Body, is_right: bool) -> [Vec<f64>; 10] {
    let side = |joint: Joint| if is_right { joint.mirrored() } else { joint };
    let bone = |from, to| body.bone(side(from), side(to));
    let out = if is_right { [-1.0, 0.0, 0.0] } else { LEFTWARD };
    let bend = |a: [Joint; 2], b: [Joint; 2]| {
        bone(a[0], a[1]).zip(bone(b[0], b[1])).map(|(a, b)| angle(a, b)).collect::<Vec<_>>()
    };
    let girdle = || body.bone(Neck, side(LeftShoulder));
    [
        in_plane(bone(LeftShoulder, LeftElbow), AHEAD, DOWN),
        in_plane(bone(LeftShoulder, LeftElbow), out, DOWN),
        in_plane(bone(LeftElbow, LeftHand), AHEAD, DOWN),
        bend([LeftShoulder, LeftElbow], [LeftElbow, LeftHand]),
        in_plane(bone(LeftHip, LeftKnee), AHEAD, DOWN),
        in_plane(bone(LeftHip, LeftKnee), out, DOWN),
        in_plane(bone(LeftKnee, LeftFoot), AHEAD, DOWN),
        bend([LeftHip, LeftKnee], [LeftKnee, LeftFoot]),
        in_plane(girdle(), UP, out),
        in_plane(girdle(), AHEAD, out),
    ]
}

fn speeds(body: &Body, numbers: &mut Vec<f64>) {
    let of = |joint: Joint| -> [f64; 5] {
        let path: Vec<[f64; 3]> = body.path(joint).collect();
        let (mut relative, mut ground) = (Vec::with_capacity(FRAMES), Vec::with_capacity(FRAMES));
        for i in 0..FRAMES {
            let (before, after) = (path[(i + FRAMES - 1) % FRAMES], path[(i + 1) % FRAMES]);
            // per cycle: two of FRAMES steps apart
            let mut velocity: [f64; 3] =
                std::array::from_fn(|axis| (after[axis] - before[axis]) * number(FRAMES) / 2.0);
            relative.push(length(velocity));
            velocity[2] += body.speed * body.cycle_time;
            ground.push(length(velocity) / body.cycle_time);
        }
        let largest = |curve: &[f64]| curve.iter().copied().fold(0.0, f64::max);
        [
            (mean(&relative) + STILL).ln(),
            (largest(&relative) + STILL).ln(),
            ((mean(&relative) + STILL) / body.cycle_time).ln(),
            (mean(&ground) + STILL).ln(),
            (largest(&ground) + STILL).ln(),
        ]
    };
    for joint in MIDDLE {
        numbers.extend(of(joint));
    }
    for joint in LEFT {
        numbers.extend(averaged(of(joint), of(joint.mirrored())));
    }
}

/// The paper's features, those of the two sides averaged.
fn paper(gait: &Gait, numbers: &mut Vec<f64>) {
    let f = features(gait, Variant::Corrected);
    let pair = |a: usize, b: usize| f64::midpoint(f[a], f[b]);
    numbers.extend([f[0], f[1], pair(2, 3), f[4], f[5], pair(6, 7), pair(8, 9), f[10], f[11], f[12]]);
    for first in [13, 18, 23] {
        numbers.extend([pair(first, first + 1), f[first + 2], pair(first + 3, first + 4)]);
    }
    numbers.push(f[28]);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker::{Sex, WalkerStyle, walk};
    use glam::Quat;

    fn walker() -> Gait {
        walk(&WalkerStyle::preset(Emotion::Angry, Sex::Male).vary(4, 2), "angry").unwrap()
    }

    fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
        assert_eq!((a.len(), b.len()), (DESCRIPTOR_LENGTH, DESCRIPTOR_LENGTH));
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    #[test]
    fn a_gait_and_its_mirror_image_are_described_alike() {
        let gait = walker();
        let mut mirrored = gait.clone();
        for (pose, original) in mirrored.poses.iter_mut().zip(&gait.poses) {
            for joint in Joint::ALL {
                let point = original[joint.mirrored() as usize];
                pose[joint as usize] = point.with_x(-point.x);
            }
        }
        let apart = largest_difference(&descriptor(&gait), &descriptor(&mirrored));
        assert!(apart < 1e-4, "{apart}");
    }

    #[test]
    fn heading_and_frame_rate_hardly_matter() {
        let gait = walker();
        let mut turned = gait.clone();
        let turn = Quat::from_rotation_y(0.05);
        turned.poses.iter_mut().flatten().for_each(|point| *point = turn * *point);
        // all but the paper's numbers, whose accelerations and jerks are in m/s2 and m/s3 over the ground
        let own = DESCRIPTOR_LENGTH - 20;
        let (a, b) = (descriptor(&gait), descriptor(&turned));
        assert!(a[..own].iter().zip(&b[..own]).all(|(a, b)| (a - b).abs() < 1e-4));
        let mut halved = gait.clone();
        halved.poses = gait.poses.iter().step_by(2).copied().collect();
        halved.frame_rate = number_f32(halved.poses.len()) / gait.cycle_time();
        let c = descriptor(&halved);
        for (i, (a, c)) in a[..own].iter().zip(&c[..own]).enumerate() {
            assert!((a - c).abs() < 0.05, "number {i}: {a} {c}");
        }
    }

    #[allow(clippy::cast_precision_loss, reason = "a count of frames")]
    fn number_f32(count: usize) -> f32 {
        count as f32
    }

    #[test]
    fn the_shape_of_the_descriptor_is_as_documented() {
        let d = descriptor(&walker());
        assert_eq!(d.len(), DESCRIPTOR_LENGTH);
        assert!(d.iter().all(|v| v.is_finite()));
        // cycle time, speed and travel agree with each other
        let tempo = &d[DESCRIPTOR_LENGTH - 23..][..3];
        assert!((tempo[0] + tempo[1] - tempo[2]).abs() < 1e-12);
        assert!((tempo[0].exp() - f64::from(walker().cycle_time())).abs() < 1e-6);
    }
}
