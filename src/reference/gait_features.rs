//! The 29 expressive features of many gaits at once.

use super::exact::{atan2, dot2};
use super::quaternion::{cross3, dot3, sub3, xyz};
use crate::kernels::KernelId;
use crate::kernels::gait_features::index::{MOTION, MOVING, POSTURE, ROW};
use crate::kernels::gait_features::{DEGREES, POSITION_LIMIT, RATE_LIMIT, SPEED_LIMIT, Slices};
use crate::kernels::layout::GaitEntry;
use crate::kernels::shared::body::index::{
    HEAD, JOINTS, LEFT_FOOT, LEFT_HAND, LEFT_HIP, LEFT_SHOULDER, NECK, RIGHT_FOOT, RIGHT_HAND, RIGHT_HIP,
    RIGHT_SHOULDER, ROOT, SPINE,
};
use rayon::prelude::*;

type Vector = [f32; 3];

/// Twin of `shaders/gait_features.wgsl`.
pub fn gait_features(b: Slices<'_>) {
    let Slices { gait_frames, gait_table, feature_rows, failure } = b;
    let rows = feature_rows.par_chunks_mut(ROW);
    let failed = gait_table.par_iter().zip(rows).enumerate().filter_map(|(gait, (&info, out))| {
        out.fill([0.0; 4]);
        let Some(row) = features(gait_frames, info) else {
            return Some(gait as u32);
        };
        for (out, row) in out.iter_mut().zip(row.chunks_exact(4)) {
            *out = [row[0], row[1], row[2], row[3]];
        }
        None
    });
    if let Some(gait) = failed.min() {
        let word = &mut failure[KernelId::GaitFeatures as usize];
        *word = (*word).min(gait);
    }
}

fn length3(v: Vector) -> f32 {
    dot3(v, v).sqrt()
}

fn angle3(a: Vector, b: Vector) -> f32 {
    atan2(length3(cross3(a, b)), dot3(a, b)) * DEGREES
}

fn triangle(a: Vector, b: Vector, c: Vector) -> f32 {
    0.5 * length3(cross3(sub3(b, a), sub3(c, a)))
}

fn box_volume(frame: &[[f32; 4]], [hx, hz]: [f32; 2]) -> f32 {
    let mut low = [POSITION_LIMIT * 2.0; 3];
    let mut high = [POSITION_LIMIT * -2.0; 3];
    for p in frame {
        let turned = [p[0] * hz - p[2] * hx, p[1], p[0] * hx + p[2] * hz];
        for axis in 0..3 {
            low[axis] = if turned[axis] < low[axis] { turned[axis] } else { low[axis] };
            high[axis] = if turned[axis] > high[axis] { turned[axis] } else { high[axis] };
        }
    }
    let size = sub3(high, low);
    size[0] * size[1] * size[2]
}

fn is_usable(frame: &[[f32; 4]]) -> bool {
    frame.iter().all(|p| p[..3].iter().all(|c| c.abs() < POSITION_LIMIT))
}

/// The row of a gait; None if it cannot be used.
fn features(frames: &[[f32; 4]], info: GaitEntry) -> Option<[f32; ROW * 4]> {
    let GaitEntry { first_frame: first, frames: count, rate, speed } = info;
    let frame_total = (frames.len() / JOINTS) as u32;
    let usable = count > 0
        && first < frame_total
        && count <= frame_total - first
        && rate > 0.0
        && rate < RATE_LIMIT
        && speed.abs() < SPEED_LIMIT;
    if !usable {
        return None;
    }
    let frames = &frames[first as usize * JOINTS..(first + count) as usize * JOINTS];
    let mut facing = [0.0, 0.0];
    for frame in frames.chunks_exact(JOINTS) {
        if !is_usable(frame) {
            return None;
        }
        let joint = |joint: usize| xyz(frame[joint]);
        let hips = sub3(joint(LEFT_HIP), joint(RIGHT_HIP));
        let shoulders = sub3(joint(LEFT_SHOULDER), joint(RIGHT_SHOULDER));
        facing = [facing[0] - hips[2] - shoulders[2], facing[1] + hips[0] + shoulders[0]];
    }
    let size = dot2(facing, facing).sqrt();
    let heading = if size > 1e-6 { [facing[0] / size, facing[1] / size] } else { [0.0, 1.0] };

    let (posture, stride) = posture(frames, heading);
    let motion = motion(frames, speed / rate);
    let mut row = [0.0; ROW * 4];
    let count = count as f32;
    for i in 0..POSTURE {
        row[i] = posture[i] / count;
    }
    row[POSTURE] = stride;
    let mut per_time = 1.0;
    for i in 0..MOTION {
        if i % MOVING == 0 {
            per_time *= rate;
        }
        row[POSTURE + 1 + i] = motion[i] / count * per_time;
    }
    row[POSTURE + MOTION + 1] = count / rate;
    Some(row)
}

/// Sums of the features of posture over the frames, and the stride length.
fn posture(frames: &[[f32; 4]], heading: [f32; 2]) -> ([f32; POSTURE], f32) {
    let mut posture = [0.0; POSTURE];
    let mut stride = 0.0;
    for frame in frames.chunks_exact(JOINTS) {
        let joint = |joint: usize| xyz(frame[joint]);
        let (root, neck, head) = (joint(ROOT), joint(NECK), joint(HEAD));
        let (right, left) = (joint(RIGHT_SHOULDER), joint(LEFT_SHOULDER));
        let (right_hand, left_hand) = (joint(RIGHT_HAND), joint(LEFT_HAND));
        let (right_foot, left_foot) = (joint(RIGHT_FOOT), joint(LEFT_FOOT));
        posture[0] += box_volume(frame, heading);
        posture[1] += angle3(sub3(right, neck), sub3(left, neck));
        posture[2] += angle3(sub3(neck, right), sub3(left, right));
        posture[3] += angle3(sub3(neck, left), sub3(right, left));
        posture[4] += angle3(sub3(head, root), [0.0, 1.0, 0.0]);
        posture[5] += angle3(sub3(head, neck), sub3(joint(SPINE), neck));
        posture[6] += length3(sub3(right_hand, root));
        posture[7] += length3(sub3(left_hand, root));
        posture[8] += length3(sub3(right_foot, root));
        posture[9] += length3(sub3(left_foot, root));
        posture[10] += triangle(left_hand, neck, right_hand);
        posture[11] += triangle(left_foot, root, right_foot);
        let apart = length3(sub3(left_foot, right_foot));
        stride = if apart > stride { apart } else { stride };
    }
    (posture, stride)
}

/// Sums of the lengths of the first, second and third differences of the moving joints, all around the cycle.
fn motion(frames: &[[f32; 4]], travel: f32) -> [f32; MOTION] {
    let moving = [RIGHT_HAND, LEFT_HAND, HEAD, RIGHT_FOOT, LEFT_FOOT];
    let mut motion = [0.0; MOTION];
    let count = frames.len() / JOINTS;
    for i in 0..count {
        for (number, joint) in moving.into_iter().enumerate() {
            let [a, b, c, d] = [0, 1, 2, 3].map(|ahead| xyz(frames[(i + ahead) % count * JOINTS + joint]));
            let (first_a, first_b, first_c) = (sub3(b, a), sub3(c, b), sub3(d, c));
            let (second_a, second_b) = (sub3(first_b, first_a), sub3(first_c, first_b));
            motion[number] += length3([first_a[0], first_a[1], first_a[2] + travel]);
            motion[MOVING + number] += length3(second_a);
            motion[2 * MOVING + number] += length3(sub3(second_b, second_a));
        }
    }
    motion
}
