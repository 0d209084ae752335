//! The buffers of what a crowd need not have: feelings that change, and agents that are led from outside.

use super::avatar_set::AvatarSet;
use super::setup::set_led;
use crate::kernels::Store;
use crate::kernels::layout::{Body, Heard, Keyframe, MoodUniforms, Paces, Path, Stimulus, Temperament};
use crate::scenario::{Crowd, ExternalKind, Scenario};

/// Fills what changing feelings need; bodies and gaits must be there, and nothing may change them afterwards.
pub(super) fn set_feelings(store: &mut Store, scenario: &Scenario, crowd: &Crowd, cast: &AvatarSet) {
    let Some(dynamics) = &scenario.emotion_dynamics else { return };
    store.step.feels = 1;
    store.mood = MoodUniforms {
        radius: dynamics.radius,
        contagion: dynamics.contagion,
        decay: dynamics.decay,
        event_count: scenario.events.len() as u32,
    };
    for (index, agent) in crowd.agents.iter().chain(&crowd.external).enumerate() {
        let id = index as u32;
        let clips = store.gaits[index];
        let speeds = clips.map(|clip| cast.clip(clip).speed * agent.scale);
        let walk_ratios = clips.map(|clip| cast.clip(clip).walk_ratio() * agent.scale);
        let Body { max_speed, preferred_speed: preferred, .. } = store.body[index];
        // an agent that walks faster or slower than its gait's speed does so with every gait
        let blended: f32 = speeds.iter().zip(agent.gait_weights).map(|(speed, weight)| speed * weight).sum();
        let own = if blended > 0.0 { preferred / blended } else { 1.0 };
        let is_led = store.avoidance[index].is_led();
        let ratio = if is_led || preferred <= 0.0 { 0.0 } else { scenario.navigation.max_speed_factor };
        store.paces.push(Paces {
            preferred_speeds: speeds.map(|speed| speed * own),
            walk_ratios,
            max_speed_factor: ratio,
            max_speed: scenario.navigation.max_speed.max(max_speed),
            ..Paces::default()
        });
        // agents led from outside neither show nor catch a feeling
        let character = if is_led { [0.0; 4] } else { dynamics.character(scenario.seed, id) };
        let [expressiveness, openness, amplification, bias] = character;
        store.feeling.push(agent.emotion);
        let rest = agent.emotion;
        store.temperament.push(Temperament { rest, expressiveness, openness, amplification, bias });
    }
    store.heard = vec![Heard::default(); store.feeling.len()];
    for event in &scenario.events {
        let step = |seconds: f32| (seconds / scenario.navigation.time_step).round();
        store.stimuli.push(Stimulus {
            place: event.place,
            radius: event.radius,
            strength: event.strength,
            emotion: event.emotion.index() as f32,
            first_step: step(event.time),
            end_step: step(event.time + event.duration).max(step(event.time) + 1.0),
            unused: 0.0,
        });
    }
}

/// Has the outsiders of a scenario led, on their paths if they have some; they are the last agents.
pub(super) fn set_outsiders(store: &mut Store, scenario: &Scenario, crowd: &Crowd) {
    let first = crowd.agents.len() as u32;
    for (agent, outsider) in (first..).zip(&scenario.outsiders).take(crowd.external.len()) {
        set_led(store, agent);
        store.avoidance[agent as usize].inverse_time_horizon = outsider.comfort;
        if outsider.kind != ExternalKind::Person {
            store.appearance[agent as usize].set_bodiless(true);
        }
        if !outsider.path.is_empty() {
            let start = store.keyframes.len() as u32;
            store.keyframes.extend(outsider.path.iter().map(|&[time, x, z]| Keyframe {
                time,
                x,
                z,
                unused: 0.0,
            }));
            store.paths.push(Path {
                agent,
                first_keyframe: start,
                keyframes: outsider.path.len() as u32,
                unused: 0,
            });
        }
    }
    store.step.path_count = store.paths.len() as u32;
}
