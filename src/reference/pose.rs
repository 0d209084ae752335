//! The pose of every visible agent: up to four gaits, and standing by the emotions that they have, blended.

use super::body::{CLIP_STRIDE, visible_agents};
use super::exact::unit_f32;
use super::quaternion::{add4, dot4, lerp4, limit, negate4, quat_lerp, quat_normalize, scale4};
use super::standing::{eased, moods_of, own_draw, stance_of, walk_share};
use crate::kernels::pose::index::{FIRST_LEG, FIRST_UPPER, GAITS, HALF_CLIP, SAMPLES};
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

/// A clip at a phase: frames between which that lies, as rows of `clip_frames`, and how far on the way.
#[derive(Clone, Copy)]
struct Sample {
    rows: [usize; 2],
    way: f32,
    share: f32,
    is_gait: bool,
}

impl Sample {
    fn of(clip: u32, phase: u32, share: f32, is_gait: bool) -> Self {
        let frame = (phase >> 26) as usize;
        let first = clip as usize * CLIP_STRIDE;
        let row = |frame: usize| first + frame % CLIP_FRAMES * POSE_STRIDE;
        Self { rows: [row(frame), row(frame + 1)], way: unit_f32(phase << 6), share, is_gait }
    }

    /// Half a clip later.
    fn later(self) -> Self {
        let later = |row: usize| ((row / POSE_STRIDE) ^ HALF_CLIP) * POSE_STRIDE;
        Self { rows: self.rows.map(later), ..self }
    }

    fn rotation(self, clip_frames: &[[f32; 4]], joint: usize) -> [f32; 4] {
        let [from, to] = self.rows.map(|row| clip_frames[row + joint]);
        quat_normalize(quat_lerp(from, to, self.way))
    }

    fn root(self, clip_frames: &[[f32; 4]]) -> [f32; 4] {
        let [from, to] = self.rows.map(|row| clip_frames[row + JOINTS]);
        lerp4(from, to, self.way)
    }
}

/// The stride of an agent over the one of its gaits, as drawn.
fn stride_of(samples: &[Sample], clip_frames: &[[f32; 4]], walked: f32, scale: f32) -> f32 {
    let mut travel = 0.0;
    for Sample { rows: [row, _], share, .. } in samples.iter().filter(|s| s.is_gait && s.share > 0.0) {
        let [.., of_clip] = clip_frames[row + JOINTS];
        travel += of_clip * share;
    }
    if travel > LEAST_TRAVEL {
        let stride = limit(walked / (travel * scale), 0.0, LONGEST);
        return if (stride - 1.0).abs() < AS_USUAL { 1.0 } else { stride };
    }
    1.0
}

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
        let ids = [c0, c1, c2, c3, first, first + STANCES, first + 2 * STANCES, first + 3 * STANCES];
        let shares = [w0 * unit, w1 * unit, w2 * unit, w3 * unit, s0, s1, s2, s3];
        let samples: [Sample; SAMPLES] = std::array::from_fn(|i| {
            let phase = match i.checked_sub(GAITS) {
                Some(emotion) if shares[i] > 0.0 => weight_phase(*number, emotion, frame.gaze_time),
                Some(_) => 0,
                None => phase[agent],
            };
            Sample::of(ids[i].min(frame.clip_count - 1), phase, shares[i], i < GAITS)
        });
        let stride = stride_of(&samples, clip_frames, stance[agent].stride * walk, own.scale);
        let rest = limit(0.5 - 0.5 * stride, 0.0, 0.5);

        for (element, out) in pose.iter_mut().enumerate() {
            let is_root = element == JOINTS;
            let rests = rest > 0.0 && (FIRST_UPPER..FIRST_LEG).contains(&element);
            let mut blend = [0.0; 4];
            let mut is_first = true;
            for sample in samples.into_iter().filter(|sample| sample.share > 0.0) {
                let turned = if is_root {
                    sample.root(clip_frames)
                } else {
                    let mut q = sample.rotation(clip_frames, element);
                    if rests && sample.is_gait {
                        q = quat_normalize(quat_lerp(q, sample.later().rotation(clip_frames, element), rest));
                    }
                    if dot4(blend, q) < 0.0 { negate4(q) } else { q }
                };
                let part = scale4(turned, sample.share);
                blend = if is_first { part } else { add4(blend, part) };
                is_first = false;
            }
            let [x, y, z, _] = blend;
            *out = if is_root { [x, y, z, stride] } else { quat_normalize(blend) };
        }
    });
}
