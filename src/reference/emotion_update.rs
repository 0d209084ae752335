//! How feelings change in a step: contagion, events, the return to one's own state.

use super::exact::{dot2, exp2};
use super::shared::is_absent;
use crate::kernels::emotion_update::LOG2_E;
use crate::kernels::emotion_update::{EVENT_RATE, Slices};
use crate::kernels::layout::StepUniforms;
use rayon::prelude::*;

/// Twin of `shaders/emotion_update.wgsl`.
pub fn emotion_update(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let Slices { step, mood, position, temperament, stimuli, heard, feeling } = b;
    let people = feeling[..agents].par_iter_mut().zip(&mut heard[..agents]).enumerate();
    people.with_min_len(256).for_each(|(agent, (feeling, heard))| {
        let at = position[agent];
        if is_absent(at) {
            *heard = [0.0; 4];
            return;
        }
        let mut q = *feeling;
        let character = temperament[agent * 2 + 1];
        let others = *heard;
        if others[0] > 0.0 {
            let take = taken(step, mood.contagion * (character[1] * others[0]));
            let caught = |i: usize| caught(q[i], others[i + 1], take, character);
            q = completed([caught(0), caught(1), caught(2)]);
        }
        let now = step.step_index as f32;
        for event in stimuli.chunks_exact(2).take(mood.event_count as usize) {
            let ([px, py, radius, strength], [emotion, first, end, _]) = (event[0], event[1]);
            if now >= first && now < end {
                let to = [at[0] - px, at[1] - py];
                let level = strength * (1.0 - dot2(to, to).sqrt() / radius);
                q = roused(q, (emotion as usize).min(3), level, taken(step, EVENT_RATE));
            }
        }
        let back = taken(step, mood.decay);
        let own = temperament[agent * 2];
        let returned = |i: usize| q[i] + back * (own[i] - q[i]);
        *feeling = completed([returned(0), returned(1), returned(2)]);
    });
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
