//! The pose of every visible agent: up to four gaits and standing, blended.

use super::body::{CLIP_STRIDE, visible_agents};
use super::exact::unit_f32;
use super::quaternion::{add4, dot4, lerp4, limit, negate4, quat_lerp, quat_normalize, scale4};
use crate::kernels::pose::Slices;
use crate::kernels::shared::body::index::{CLIP_FRAMES, POSE_STRIDE};
use rayon::prelude::*;

/// Twin of `shaders/pose.wgsl`.
pub fn pose(b: Slices<'_>) {
    let Slices {
        frame,
        visible,
        phase,
        stance,
        appearance,
        gaits,
        gait_weights,
        clip_frames,
        local_rotations,
    } = b;
    let slots = local_rotations.par_chunks_mut(POSE_STRIDE);
    visible_agents(visible).par_iter().zip(slots).for_each(|(agent, pose)| {
        let agent = *agent as usize;
        let [w0, w1, w2, w3] = gait_weights[agent];
        let sum = w0 + w1 + w2 + w3;
        let walk = if sum > 1e-6 { limit(stance[agent].walk_weight, 0.0, 1.0) } else { 0.0 };
        let unit = walk / if sum > 1e-6 { sum } else { 1.0 };
        let avatar = appearance[agent].avatar() as usize;
        let [c0, c1, c2, c3] = gaits[agent];
        let ids = [c0, c1, c2, c3, frame.standing_clips[avatar / 4][avatar % 4]];
        let shares = [w0 * unit, w1 * unit, w2 * unit, w3 * unit, 1.0 - walk];

        let frame_a = (phase[agent] >> 26) as usize;
        let frame_b = (frame_a + 1) & (CLIP_FRAMES - 1);
        let t = unit_f32(phase[agent] << 6);

        for (element, out) in pose.iter_mut().enumerate() {
            let is_root = element == POSE_STRIDE - 1;
            let mut blend = [0.0; 4];
            let mut is_first = true;
            for (id, share) in ids.into_iter().zip(shares) {
                if share > 0.0 {
                    let clip = id.min(frame.clip_count - 1) as usize * CLIP_STRIDE + element;
                    let from = clip_frames[clip + frame_a * POSE_STRIDE];
                    let to = clip_frames[clip + frame_b * POSE_STRIDE];
                    let mut sample = lerp4(from, to, t);
                    if !is_root {
                        let q = quat_normalize(quat_lerp(from, to, t));
                        sample = if dot4(blend, q) < 0.0 { negate4(q) } else { q };
                    }
                    let part = scale4(sample, share);
                    blend = if is_first { part } else { add4(blend, part) };
                    is_first = false;
                }
            }
            *out = if is_root { blend } else { quat_normalize(blend) };
        }
    });
}
