//! How feelings change in a step: contagion, events, the return to one's own state.

use super::exact::{dot2, exp2, greater, unless_faint};
use super::shared::is_absent;
use crate::kernels::emotion_update::LOG2_E;
use crate::kernels::emotion_update::{EVENT_RATE, Slices};
use crate::kernels::layout::{Heard, StepUniforms, Temperament};
use rayon::prelude::*;

/// Twin of `shaders/emotion_update.wgsl`.
pub fn emotion_update(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    let Slices { step, mood, position, temperament, stimuli, heard, feeling } = b;
    let people = feeling[..agents].par_iter_mut().zip(&mut heard[..agents]).enumerate();
    people.with_min_len(256).for_each(|(agent, (feeling, heard))| {
        let at = position[agent];
        if is_absent(at) {
            *heard = Heard::default();
            return;
        }
        let mut q = *feeling;
        let character = &temperament[agent];
        let others = *heard;
        if others.strength > 0.0 {
            let take = taken(step, mood.contagion * (character.openness * others.strength));
            let [happy, angry, sad, _] = q;
            q = completed([
                caught(happy, others.happy, take, character),
                caught(angry, others.angry, take, character),
                caught(sad, others.sad, take, character),
            ]);
        }
        let now = step.step_index as f32;
        for event in stimuli.iter().take(mood.event_count as usize) {
            if now >= event.first_step && now < event.end_step {
                let to = [at[0] - event.place[0], at[1] - event.place[1]];
                let level = event.strength * (1.0 - dot2(to, to).sqrt() / event.radius);
                q = roused(q, (event.emotion as usize).min(3), level, taken(step, EVENT_RATE));
            }
        }
        let back = taken(step, mood.decay);
        let ([happy, angry, sad, _], [rest_happy, rest_angry, rest_sad, _]) = (q, character.rest);
        *feeling = completed([
            happy + back * (rest_happy - happy),
            angry + back * (rest_angry - angry),
            sad + back * (rest_sad - sad),
        ]);
    });
}

fn taken(step: &StepUniforms, rate: f32) -> f32 {
    1.0 - exp2(-(LOG2_E * rate * step.time_step))
}

fn caught(q: f32, heard: f32, take: f32, character: &Temperament) -> f32 {
    let rising = 1.0 - (1.0 - heard) * (1.0 - q);
    let falling = heard * q;
    let amplified = character.bias * rising + (1.0 - character.bias) * falling;
    let goal = character.amplification * amplified + (1.0 - character.amplification) * heard;
    q + take * (goal - q)
}

fn completed([happy, angry, sad]: [f32; 3]) -> [f32; 4] {
    let sum = happy + angry + sad;
    let most = greater(sum, 1.0);
    [
        unless_faint(happy / most),
        unless_faint(angry / most),
        unless_faint(sad / most),
        greater(1.0 - sum, 0.0),
    ]
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
