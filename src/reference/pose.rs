//! The pose of every visible agent: up to four gaits, and standing by the emotions that they have, blended.

use super::body::{CLIP_STRIDE, visible_agents};
use super::exact::unit_f32;
use super::quaternion::{add4, dot4, lerp4, limit, negate4, quat_lerp, quat_normalize, scale4};
use super::standing::{eased, moods_of, own_draw, stance_of, walk_share};
use crate::kernels::pose::index::{FIRST_LEG, FIRST_UPPER, SAMPLES};
use crate::kernels::pose::{
    AS_USUAL, LEAST_TRAVEL, LONGEST, REST, REST_SPREAD, SHIFT, SHIFT_EVERY, SHIFT_LASTS, SHIFT_SPAN,
    SHIFT_SPREAD, SIDE, Slices,
};
use crate::kernels::shared::body::index::{CLIP_FRAMES, JOINTS, POSE_STRIDE};
use crate::kernels::shared::standing::STANCES;
use rayon::prelude::*;

/// The phase at which an agent rests after its shift of that number.
fn rest_phase(agent: u32, number: u32) -> u32 {
    let draw = own_draw(agent, REST, number);
    (number << 31).wrapping_add(draw >> 2).wrapping_sub(REST_SPREAD)
}

/// The phase of the standing clip of an emotion at a time, ms: 0 has the weight on the left leg, a half on the right.
pub fn weight_phase(agent: u32, emotion: usize, time: u32) -> u32 {
    let every = SHIFT_EVERY[emotion];
    let own = own_draw(agent, SIDE, 0);
    let time = time.wrapping_add(own % every);
    let number = (time / every).wrapping_add(own >> 31);
    let draw = own_draw(agent, SHIFT, number);
    let since = ((time % every) as i32 - (draw % SHIFT_SPREAD[emotion]) as i32) as f32;
    let lasts = (SHIFT_LASTS[emotion] + (draw >> 16) % SHIFT_SPAN) as f32;
    let done = eased(limit(since / lasts, 0.0, 1.0));
    let before = rest_phase(agent, number.wrapping_sub(1));
    let way = rest_phase(agent, number).wrapping_sub(before);
    before.wrapping_add((((way >> 8) as f32 * done) as u32) << 8)
}

/// A clip at a phase: rows of `clip_frames` between which that lies, and how far on the way; the row of the clip's mean.
#[derive(Clone, Copy, Default)]
struct Sample {
    from: usize,
    to: usize,
    mean: usize,
    way: f32,
    share: f32,
}

impl Sample {
    fn of(clip: u32, phase: u32, share: f32) -> Self {
        let frame = (phase >> 26) as usize;
        let first = clip as usize * CLIP_STRIDE;
        Self {
            from: first + frame * POSE_STRIDE,
            to: first + (frame + 1) % CLIP_FRAMES * POSE_STRIDE,
            mean: first + CLIP_FRAMES * POSE_STRIDE,
            way: unit_f32(phase << 6),
            share,
        }
    }

    /// Not normalised; `rests` of it is the mean of the clip.
    fn rotation(&self, clip_frames: &[[f32; 4]], joint: usize, rests: f32) -> [f32; 4] {
        let q = quat_lerp(clip_frames[self.from + joint], clip_frames[self.to + joint], self.way);
        if rests > 0.0 { quat_lerp(q, clip_frames[self.mean + joint], rests) } else { q }
    }

    fn root(&self, clip_frames: &[[f32; 4]]) -> [f32; 4] {
        lerp4(clip_frames[self.from + JOINTS], clip_frames[self.to + JOINTS], self.way)
    }
}

/// The stride of an agent over the one of its gaits, as drawn.
fn stride_of(gaits: &[Sample], clip_frames: &[[f32; 4]], walked: f32, scale: f32) -> f32 {
    let mut travel = 0.0;
    for sample in gaits {
        let [.., of_clip] = clip_frames[sample.from + JOINTS];
        travel += of_clip * sample.share;
    }
    if travel > LEAST_TRAVEL {
        let stride = limit(walked / (travel * scale), 0.0, LONGEST);
        return if (stride - 1.0).abs() < AS_USUAL { 1.0 } else { stride };
    }
    1.0
}

/// Twin of `shaders/pose.wgsl`.
pub fn pose(b: Slices<'_>) {
    let Slices { frame, visible, stance, appearance, gaits, gait_weights, clip_frames, local_rotations } = b;
    let slots = local_rotations.par_chunks_mut(POSE_STRIDE);
    visible_agents(visible).par_iter().zip(slots).for_each(|(number, pose)| {
        let agent = *number as usize;
        let own = appearance[agent];
        let [w0, w1, w2, w3] = gait_weights[agent];
        let sum = w0 + w1 + w2 + w3;
        let walk = walk_share(gait_weights[agent], stance[agent].walk_weight);
        let unit = walk / if sum > 1e-6 { sum } else { 1.0 };
        let [s0, s1, s2, s3] = scale4(moods_of(gait_weights[agent], own.emotion()), 1.0 - walk);
        let avatar = own.avatar() as usize;
        let [c0, c1, c2, c3] = gaits[agent];
        let first = frame.standing_clips[avatar / 4][avatar % 4] + stance_of(*number);
        let clip = |id: u32| id.min(frame.clip_count - 1);
        let mut samples = [Sample::default(); SAMPLES];
        let mut count = 0;
        let walks = [(c0, w0 * unit), (c1, w1 * unit), (c2, w2 * unit), (c3, w3 * unit)];
        for (id, share) in walks.into_iter().filter(|(_, share)| *share > 0.0) {
            samples[count] = Sample::of(clip(id), stance[agent].phase, share);
            count += 1;
        }
        let gaits = count;
        if walk < 1.0 {
            for (emotion, share) in [s0, s1, s2, s3].into_iter().enumerate().filter(|(_, share)| *share > 0.0)
            {
                let at = weight_phase(*number, emotion, frame.gaze_time);
                samples[count] = Sample::of(clip(first + emotion as u32 * STANCES), at, share);
                count += 1;
            }
        }
        let samples = &samples[..count];
        let stride = stride_of(&samples[..gaits], clip_frames, stance[agent].stride * walk, own.scale);
        let rest = limit(1.0 - stride, 0.0, 1.0);

        for (element, out) in pose.iter_mut().enumerate() {
            let is_root = element == JOINTS;
            let rests = if (FIRST_UPPER..FIRST_LEG).contains(&element) { rest } else { 0.0 };
            let mut blend = [0.0; 4];
            for (number, sample) in samples.iter().enumerate() {
                let part = if is_root {
                    sample.root(clip_frames)
                } else {
                    let q = sample.rotation(clip_frames, element, if number < gaits { rests } else { 0.0 });
                    if dot4(blend, q) < 0.0 { negate4(q) } else { q }
                };
                let part = scale4(part, sample.share);
                blend = if number == 0 { part } else { add4(blend, part) };
            }
            let [x, y, z, _] = blend;
            *out = if is_root { [x, y, z, stride] } else { quat_normalize(blend) };
        }
    });
}
