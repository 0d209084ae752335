//! How every far body holds itself.

use super::exact::{greater, sin_cos};
use super::quaternion::{add4, limit, scale4};
use crate::kernels::layout::{ClipPosture, FarPose};
use crate::kernels::pose_far::{STEPS, Slices, TURN};
use crate::kernels::shared::body::NONE;

/// Twin of `shaders/pose_far.wgsl`.
pub fn pose_far(b: Slices<'_>) {
    for agent in 0..b.frame.agent_count as usize {
        let bucket = b.agent_bucket[agent];
        if bucket == NONE || bucket < b.frame.bucket_count {
            continue;
        }
        let walk = limit(b.stance[agent].walk_weight, 0.0, 1.0);
        let [heading_sine, heading_cosine] = sin_cos(b.heading[agent]);
        let [_, stride] = sin_cos((b.stance[agent].phase >> 8) as f32 * (TURN / STEPS));
        let [lean, nod, spread, arm_swing] = posture(&b, agent);
        b.far_poses[agent] = FarPose {
            heading_sine,
            heading_cosine,
            stride: stride * walk,
            elevation: b.elevation[agent],
            lean: lean * walk,
            nod: nod * walk,
            spread: spread * walk,
            arm_swing,
        };
    }
}

fn posture_of(b: &Slices<'_>, clip: u32) -> [f32; 4] {
    let ClipPosture { lean, nod, spread, swing } = b.clip_postures[clip.min(b.frame.clip_count - 1) as usize];
    [lean, nod, spread, swing]
}

/// The mean of the clips that the agent walks.
fn posture(b: &Slices<'_>, agent: usize) -> [f32; 4] {
    let [w0, w1, w2, w3] = b.gait_weights[agent];
    let [c0, c1, c2, c3] = b.gaits[agent];
    if w1 == 0.0 && w2 == 0.0 && w3 == 0.0 {
        return posture_of(b, c0);
    }
    let part = |clip, weight| scale4(posture_of(b, clip), weight);
    let sum = add4(add4(add4(part(c0, w0), part(c1, w1)), part(c2, w2)), part(c3, w3));
    let weight = greater(w0 + w1 + w2 + w3, 1e-6);
    sum.map(|angle| angle / weight)
}
