//! Inputs for `keep_snapshot` and `interpolate`: two snapshots of a crowd. Some agents walk, turn across the back, end a
//! stride, stand, are set to another place, come in, go, or have no place that is a number.

use super::case::{filled, nan, unit};
use crate::ground::ABSENT;
use crate::kernels::layout::{BetweenUniforms, Snapshot, Stance};
use crate::kernels::{Dispatch, Store};
use crate::sim::order::between_dispatches;

/// Elements behind the last agent that hold NaN.
const SPARE: usize = 3;
/// Farthest that the made-up people walk between the snapshots, m.
const REACH: f32 = 0.4;

/// A crowd with its earlier snapshot kept and its newest not yet. Seeds differ in the share: none of the way, some of it,
/// nearly all, all; and in the place of the newest snapshot.
pub fn between(agents: usize, seed: u32) -> Store {
    let newest = seed >> 1 & 1;
    let share = [0.0, 0.37, 0.999_999_94, 1.0][seed as usize % 4];
    let between = BetweenUniforms { agent_count: agents as u32, newest, share, reach: REACH };
    let mut store = Store { between, snapshots: vec![filled(0xdead_beef); agents * 2], ..Store::default() };
    for i in 0..agents {
        let random = |lane: u32| unit(seed ^ 0x0be7_0000, i, lane);
        let within = |lane: u32, size: f32| (2.0 * random(lane) - 1.0) * size;
        let mut stands = [within(0, 50.0), within(1, 50.0)];
        let mut stood = [stands[0] + within(2, 0.25), stands[1] + within(3, 0.25)];
        let (mut turned, mut heading) = (within(4, 3.1), within(5, 3.1));
        let (mut was, mut phase) = ((random(6) * 4e9) as u32, (random(7) * 4e9) as u32);
        match i % 14 {
            0 => stood = stands,
            1 => stood[0] = stands[0] + 2.0 * REACH,
            2 => stood = [ABSENT; 2],
            3 => stands = [ABSENT; 2],
            4 => (stood, stands) = ([ABSENT; 2], [ABSENT; 2]),
            5 => stands[1] = f32::NAN,
            6 => (turned, heading) = (3.0, -3.0),
            7 => (was, phase) = (u32::MAX - 255, 256),
            8 => (was, phase) = (0, u32::MAX),
            9 => heading = f32::INFINITY,
            10 => heading = turned,
            // beyond what a float can turn by, alone and together
            11 => (turned, heading) = (0.0, -20_000.0),
            12 => (turned, heading) = (20_000.0, 20_000.5),
            _ => {}
        }
        store.position.push(stands);
        store.heading.push(heading);
        store.stance.push(Stance {
            phase,
            walk_weight: random(8),
            left: [22, 23].map(random),
            right: [24, 25].map(random),
            turns: [26, 27].map(random),
            lean: [34, 35].map(random),
            heights: [36, 37].map(random),
            slopes: [38, 39].map(random),
            stride: random(20),
            foresight: random(40),
        });
        store.elevation.push(within(9, 4.0));
        store.gait_weights.push([10, 11, 12, 13].map(random));
        let at = (1 - newest) as usize * agents + i;
        store.snapshots[at] = Snapshot {
            position: stood,
            heading: turned,
            walk_weight: random(14),
            gait_weights: [16, 17, 18, 19].map(random),
            phase: was,
            elevation: within(15, 4.0),
            stride: random(21),
            left: [28, 29].map(random),
            right: [30, 31].map(random),
            turns: [32, 33].map(random),
            lean: [41, 42].map(random),
            heights: [43, 44].map(random),
            slopes: [45, 46].map(random),
            foresight: random(47),
        };
    }
    store.snapshots.extend([filled::<Snapshot>(0xdead_beef); SPARE]);
    store.position.extend([[f32::NAN; 2]; SPARE]);
    store.heading.extend([f32::NAN; SPARE]);
    store.stance.extend([nan::<Stance>(); SPARE]);
    store.elevation.extend([f32::NAN; SPARE]);
    store.gait_weights.extend([[f32::NAN; 4]; SPARE]);
    store
}

/// The dispatches: they keep the newest snapshot, then interpolate every agent between the two.
pub fn dispatches(store: &Store) -> Vec<Dispatch> {
    between_dispatches(store.between.agent_count, Some(store.between.newest))
}
