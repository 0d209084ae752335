//! A crowd with feelings that change and some agents led from outside, for the kernels that not every step has.

use super::case::nan;
use crate::kernels::Store;
use crate::kernels::layout::{Appearance, Heard, Keyframe, MoodUniforms, Paces, Path, Stimulus, Temperament};
use crate::reference::exact::{hash_u32, unit_f32};

/// Events of the case: going on, exactly now, just over, not begun, calming.
const EVENTS: usize = 5;

/// [`super::step::crowd`] with feelings of every kind: at the ends of their range, of agents that show or catch nothing,
/// at the very place of an event. Seeds differ in how far feelings reach. Led agents follow paths of every length.
pub fn feelings(agents: usize, seed: u32) -> Store {
    let mut store = super::step::crowd(agents, seed);
    store.step.step_index = [100, 1, 0][seed as usize % 3];
    add_feelings(&mut store, agents, seed);
    store
}

/// Gives a crowd feelings. Led agents get paths.
pub(super) fn add_feelings(store: &mut Store, agents: usize, seed: u32) {
    let unit = |i: usize, lane: u32| {
        unit_f32(hash_u32(
            hash_u32(seed ^ 0x0fee_1000 ^ (i as u32).wrapping_mul(0x9e37_79b9)).wrapping_add(lane),
        ))
    };
    let now = store.step.step_index as f32;
    store.step.feels = 1;
    let radius = [0.0, 3.0, 8.0, 0.6][seed as usize % 4];
    store.mood = MoodUniforms { radius, contagion: 0.8, decay: 0.1, event_count: EVENTS as u32 };
    for i in 0..agents {
        let weights = |lane: u32| match i % 5 {
            0 => [[1.0, 0.0, 0.0, 0.0], [0.0, 1.0, 0.0, 0.0], [0.0, 0.0, 1.0, 0.0], [0.0, 0.0, 0.0, 1.0]]
                [i / 5 % 4],
            _ => {
                let [a, b, c, d] = [0, 1, 2, 3].map(|e| unit(i, lane + e));
                let sum = a + b + c + d + 0.01;
                [a / sum, b / sum, c / sum, 1.0 - (a + b + c) / sum]
            }
        };
        // one is felt more than it can be: shares stay shares
        let most = if i % 10 == 5 { 1.01 } else { 1.0 };
        store.feeling.push(weights(0).map(|weight| weight * most));
        let mut character = [4, 5, 6, 7].map(|lane| unit(i, lane));
        match i % 7 {
            0 => character[0] = 0.0,
            1 => character[1] = 0.0,
            2 => character = [1.0; 4],
            _ => {}
        }
        let [expressiveness, openness, amplification, bias] = character;
        let rest = weights(8);
        store.temperament.push(Temperament { rest, expressiveness, openness, amplification, bias });
        let ratio = if i % 9 == 4 { 0.0 } else { 1.5 };
        store.paces.push(Paces {
            preferred_speeds: [12, 13, 14, 15].map(|lane| 0.6 + unit(i, lane)),
            walk_ratios: [16, 17, 18, 19].map(|lane| 0.3 + 0.2 * unit(i, lane)),
            max_speed_factor: ratio,
            max_speed: 1.8,
            ..Paces::default()
        });
        store.appearance.push(Appearance::new(0, i as u32 % 6, true, 1.0, [0; 4]));
        store.gait_weights.push([0.25; 4]);
        store.gaits.push([0; 4]);
        if store.avoidance[i].is_led() {
            let (first, count) = (store.keyframes.len() as u32, [3, 0, 1, 4][i / 64 % 4]);
            let start = now * store.step.time_step - 2.0 * unit(i, 20);
            for k in 0..count {
                let at = |lane: u32| 8.0 * unit(i, lane + 2 * k);
                store.keyframes.push(Keyframe { time: start + k as f32, x: at(21), z: at(22), unused: 0.0 });
            }
            store.paths.push(Path { agent: i as u32, first_keyframe: first, keyframes: count, unused: 0 });
        }
    }
    store.step.path_count = store.paths.len() as u32;
    // A spare path stands behind the last one. It must lead no agent.
    if let Some(path) = store.paths.iter().copied().find(|path| path.keyframes > 1) {
        store.paths.extend([Path { agent: 0, ..path }; 2]);
    }
    let at = if agents > 0 && store.position[0][0] < 1e6 { store.position[0] } else { [1.0, 1.0] };
    let times = [[-10.0, 10.0], [0.0, 1.0], [-10.0, 0.0], [1.0, 20.0], [-100.0, 900.0]];
    for (i, [first, end]) in times.into_iter().enumerate() {
        let place = if i == 0 { at } else { [5.0 * unit(i, 40), 5.0 * unit(i, 41)] };
        store.stimuli.push(Stimulus {
            place,
            radius: 4.0 + i as f32,
            strength: 1.0 - 0.2 * i as f32,
            emotion: [1.0, 0.0, 2.0, 1.0, 3.0][i],
            first_step: now + first,
            end_step: now + end,
            unused: 0.0,
        });
    }
    // agents whose row has no turn keep what they heard before
    let before =
        |i| Heard { strength: unit(i, 50), happy: unit(i, 51), angry: unit(i, 52), sad: unit(i, 53) };
    store.heard = (0..agents).map(before).collect();
    store.heard.extend([nan::<Heard>(); 3]);
    for _ in 0..3 {
        store.feeling.push([f32::NAN; 4]);
        store.temperament.push(nan());
        store.paces.push(nan());
        store.appearance.push(Appearance::default());
        store.gait_weights.push([f32::NAN; 4]);
    }
}
