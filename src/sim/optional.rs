//! The buffers of what a crowd need not have: feelings that change, and agents that are led from outside.

use super::avatar_set::AvatarSet;
use super::setup::set_led;
use crate::kernels::Store;
use crate::kernels::layout::MoodUniforms;
use crate::kernels::shared::step::LED;
use crate::scenario::{Crowd, OutsiderKind, Scenario};

/// In `look`: this agent has no body that is drawn.
const UNDRAWN: u32 = 1 << 17;

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
    for (index, agent) in crowd.agents.iter().chain(&crowd.outsiders).enumerate() {
        let id = index as u32;
        let clips = store.gaits[index];
        let speeds = clips.map(|clip| cast.clip(clip).speed * agent.scale);
        let travels = clips.map(|clip| cast.clip(clip).stride_travel * agent.scale);
        let [_, most, preferred, _] = store.body[index];
        // whoever walks faster or slower than the gait says does so with every gait
        let blended: f32 = speeds.iter().zip(agent.gait_weights).map(|(speed, weight)| speed * weight).sum();
        let own = if blended > 0.0 { preferred / blended } else { 1.0 };
        let is_led = store.avoidance[index][3] >= LED;
        let ratio = if is_led || preferred <= 0.0 { 0.0 } else { scenario.navigation.max_speed_factor };
        store.paces.extend([
            speeds.map(|speed| speed * own),
            travels,
            [ratio, scenario.navigation.max_speed.max(most), 0.0, 0.0],
        ]);
        let mut character = dynamics.character(scenario.seed, id);
        if is_led {
            character = [0.0; 4]; // they neither show nor catch a feeling
        }
        store.feeling.push(agent.emotion);
        store.temperament.extend([agent.emotion, character]);
    }
    store.heard = vec![[0.0; 4]; store.feeling.len()];
    for event in &scenario.events {
        let step = |seconds: f32| (seconds / scenario.navigation.time_step).round();
        let [x, z] = event.place;
        let end = step(event.time + event.duration).max(step(event.time) + 1.0);
        store.stimuli.push([x, z, event.radius, event.strength]);
        store.stimuli.push([event.emotion.index() as f32, step(event.time), end, 0.0]);
    }
}

/// Has the outsiders of a scenario led, on their paths if they have some; they are the last agents.
pub(super) fn set_outsiders(store: &mut Store, scenario: &Scenario, crowd: &Crowd) {
    let first = crowd.agents.len() as u32;
    for (agent, outsider) in (first..).zip(&scenario.outsiders).take(crowd.outsiders.len()) {
        set_led(store, agent);
        store.avoidance[agent as usize][0] = outsider.comfort;
        if outsider.kind != OutsiderKind::Person {
            store.appearance[agent as usize][0] |= UNDRAWN;
        }
        if !outsider.path.is_empty() {
            let start = store.keyframes.len() as u32;
            store.keyframes.extend(outsider.path.iter().map(|[time, x, z]| [*time, *x, *z, 0.0]));
            store.paths.push([agent, start, outsider.path.len() as u32, 0]);
        }
    }
    store.step.path_count = store.paths.len() as u32;
}
