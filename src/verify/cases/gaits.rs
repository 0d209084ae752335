//! Inputs for `gait_features`: cycles of one frame and of many, bodies without sides, joints at one place, and gaits that
//! must be refused.

use crate::kernels::gait_features::index::ROW;
use crate::kernels::layout::GaitEntry;
use crate::kernels::{Dispatch, KernelId, Phase, Store};
use crate::reference::exact::{hash_u32, unit_f32};

/// Frames of the longest gait.
const MOST_FRAMES: u32 = 70;
/// Elements behind the last gait that hold NaN.
const SPARE: usize = 3;

/// `gaits` made-up gaits: joints that swing about a standing body, each hard case once in sixteen.
pub fn gaits(gaits: usize, seed: u32) -> Store {
    let mut store = Store { failure: vec![u32::MAX; KernelId::ALL.len()], ..Store::default() };
    let mut first = 0;
    // A device may bind no more than 128 MiB (lavapipe does): many gaits are short ones.
    let most = MOST_FRAMES.min((500_000 / (gaits as u32).max(1)).max(4));
    for gait in 0..gaits as u32 {
        let random = |lane: u32| unit_f32(hash_u32(hash_u32(seed ^ gait.wrapping_mul(0x9e37_79b9)) ^ lane));
        let kind = (gait + seed) % 16;
        let count = match kind {
            0 => 1,
            1 => 2,
            _ => 3 + (random(0) * (most - 3) as f32) as u32,
        };
        for frame in 0..count {
            for joint in 0..16 {
                store.gait_frames.push(position(kind, joint, frame as f32 / count as f32, &random));
            }
        }
        // a range that leaves the buffer, no frames at all, a position, rate or speed that is no number
        let frames = match kind {
            2 if seed % 2 == 1 => u32::MAX,
            3 if seed % 2 == 1 => 0,
            _ => count,
        };
        let rate = if kind == 4 && seed % 2 == 1 { 0.0 } else { 20.0 + 60.0 * random(1) };
        let speed = if kind == 5 && seed % 2 == 1 { f32::NAN } else { 2.0 * random(2) };
        store.gait_table.push(GaitEntry { first_frame: first, frames, rate, speed });
        if kind == 6 && seed % 2 == 1 {
            let at = store.gait_frames.len() - 5;
            store.gait_frames[at] = [0.1, f32::NAN, 0.2, 0.0];
        }
        first += count;
    }
    if seed % 2 == 1 {
        // frames of no gait; on even seeds the last gait ends with the buffer
        store.gait_frames.extend([[f32::NAN; 4]; SPARE * 16]);
    }
    store.feature_rows = vec![[f32::NAN; 4]; (gaits + SPARE) * ROW];
    store
}

/// Where a joint is at a phase, m; w is never read.
fn position(kind: u32, joint: u32, phase: f32, random: &impl Fn(u32) -> f32) -> [f32; 4] {
    let lane = |axis: u32| 16 + joint * 8 + axis;
    let swing = if joint < 4 { 0.02 } else { 0.3 };
    let turn = |axis: u32| swing * libm::sinf(std::f32::consts::TAU * (phase + random(lane(axis))));
    // sides: -1, 0, 1 for the right, the middle and the left
    let side = match joint {
        4..=6 | 10..=12 => 1.0,
        0..=3 => 0.0,
        _ => -1.0,
    };
    match kind {
        7 => [0.5, 1.0, -0.5, f32::NAN], // everything at one place: no angles
        8 => [turn(0), 1.0 - 0.06 * joint as f32, turn(2), f32::NAN], // no sides: no heading
        9 => [0.0, 0.1 * joint as f32, 0.0, f32::NAN], // a straight line, at rest
        _ => {
            let height = 0.2 + 1.4 * random(lane(3));
            [side * (0.15 + 0.2 * random(lane(4))) + turn(0), height + turn(1), turn(2), f32::NAN]
        }
    }
}

/// The dispatch of `gait_features` for a store.
pub fn dispatches(store: &Store) -> Vec<Dispatch> {
    let gaits = store.gait_table.len() as u32;
    vec![Dispatch::of(Phase::GaitFeatures, gaits)]
}
