//! How feelings change in a step: contagion, events, the return to one's own state.

use super::exact::{dot2, exp2};
use super::shared::{NOBODY, grid_cell};
use crate::kernels::feel::Slices;
use crate::kernels::layout::StepUniforms;
use rayon::prelude::*;
use std::f32::consts::LOG2_E;

const SHARE: f32 = 1_048_576.0;
const MOST_HEARD: u32 = 4095;
const MOST_TURNS: u32 = 32_768;
/// How fast an event is taken in, 1/s.
pub const EVENT_RATE: f32 = 2.0;

/// Twin of `shaders/feel.wgsl`.
pub fn feel(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let Slices { new_feeling, .. } = b;
    let shared = Shared {
        step: b.step,
        radius: b.mood.radius,
        slot_motion: b.slot_motion,
        slot_agent: b.slot_agent,
        cell_start: b.cell_start,
        feeling: b.feeling,
        temperament: b.temperament,
    };
    let (mood, stimuli, agent_slot) = (b.mood, b.stimuli, b.agent_slot);
    new_feeling[..agents].par_iter_mut().enumerate().with_min_len(256).for_each(|(agent, new)| {
        let mut q = shared.feeling[agent];
        let slot = agent_slot[agent];
        if slot == NOBODY {
            *new = q;
            return;
        }
        let [x, y, ..] = shared.slot_motion[slot as usize * 2];
        let at = [x, y];
        let character = shared.temperament[agent * 2 + 1];
        if mood.radius > 0.0 && character[1] > 0.0 {
            let sums = shared.hear(slot as usize, at);
            if sums[0] > 0 {
                let voices = total(sums[0]);
                let take = taken(shared.step, mood.contagion * (character[1] * (voices / SHARE)));
                let caught = |i: usize| caught(q[i], (total(sums[i + 1]) / voices).min(1.0), take, character);
                q = completed([caught(0), caught(1), caught(2)]);
            }
        }
        let now = shared.step.step_index as f32;
        for event in stimuli.chunks_exact(2).take(mood.event_count as usize) {
            let ([px, py, radius, strength], [emotion, first, end, _]) = (event[0], event[1]);
            if now >= first && now < end {
                let to = [at[0] - px, at[1] - py];
                let level = strength * (1.0 - dot2(to, to).sqrt() / radius);
                q = roused(q, (emotion as usize).min(3), level, taken(shared.step, EVENT_RATE));
            }
        }
        let back = taken(shared.step, mood.decay);
        let own = shared.temperament[agent * 2];
        let returned = |i: usize| q[i] + back * (own[i] - q[i]);
        *new = completed([returned(0), returned(1), returned(2)]);
    });
}

struct Shared<'a> {
    step: &'a StepUniforms,
    radius: f32,
    slot_motion: &'a [[f32; 4]],
    slot_agent: &'a [u32],
    cell_start: &'a [u32],
    feeling: &'a [[f32; 4]],
    temperament: &'a [[f32; 4]],
}

impl Shared<'_> {
    fn hear(&self, slot: usize, at: [f32; 2]) -> [u32; 4] {
        let (step, reach) = (self.step, self.radius);
        let elevation = self.slot_motion[slot * 2 + 1][3];
        let low = grid_cell([at[0] - reach, at[1] - reach], step);
        let high = grid_cell([at[0] + reach, at[1] + reach], step);
        let (mut sums, mut heard, mut turns) = ([0_u32; 4], 0, 0);
        for y in low[1]..=high[1] {
            let row = y * step.grid_columns as i32;
            let end = self.cell_start[(row + high[0] + 1) as usize] as usize;
            for other in self.cell_start[(row + low[0]) as usize] as usize..end {
                if turns >= MOST_TURNS {
                    break;
                }
                turns += 1;
                let motion = self.slot_motion[other * 2];
                let to = [motion[0] - at[0], motion[1] - at[1]];
                let distance2 = dot2(to, to);
                let apart = (self.slot_motion[other * 2 + 1][3] - elevation).abs();
                let same_storey = step.storey_height <= 0.0 || apart < step.storey_height;
                if other != slot && distance2 < reach * reach && same_storey && heard < MOST_HEARD {
                    heard += 1;
                    let speaker = self.slot_agent[other] as usize;
                    let voice = self.temperament[speaker * 2 + 1][0] * (1.0 - distance2.sqrt() / reach);
                    let q = self.feeling[speaker];
                    let added = [voice, voice * q[0], voice * q[1], voice * q[2]];
                    for (sum, share) in sums.iter_mut().zip(added) {
                        *sum = sum.wrapping_add((share * SHARE + 0.5) as u32);
                    }
                }
            }
        }
        sums
    }
}

fn total(sum: u32) -> f32 {
    (sum >> 8) as f32 * 256.0 + (sum & 255) as f32
}

fn taken(step: &StepUniforms, rate: f32) -> f32 {
    1.0 - exp2(-(LOG2_E * rate * step.time_step))
}

fn caught(q: f32, heard: f32, take: f32, character: [f32; 4]) -> f32 {
    let rising = 1.0 - (1.0 - heard) * (1.0 - q);
    let falling = heard * q;
    let amplified = character[3] * rising + (1.0 - character[3]) * falling;
    let goal = character[2] * amplified + (1.0 - character[2]) * heard;
    q + take * (goal - q)
}

fn completed([happy, angry, sad]: [f32; 3]) -> [f32; 4] {
    let sum = happy + angry + sad;
    let most = sum.max(1.0);
    [happy / most, angry / most, sad / most, (1.0 - sum).max(0.0)]
}

fn roused(q: [f32; 4], emotion: usize, level: f32, take: f32) -> [f32; 4] {
    let old = q[emotion];
    if !(level > old) {
        return q;
    }
    let raised = old + take * (level - old);
    let rest = (1.0 - raised) / (1.0 - old);
    let mut new = q.map(|weight| weight * rest);
    new[emotion] = raised;
    new
}
