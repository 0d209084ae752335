//! Inputs for single kernels that a crowd seldom comes to: walls within a centimetre, velocities that are no numbers,
//! places to come in at that are nearly free, throngs.

use super::case::{Case, unit};
use crate::kernels::layout::{Segment, SlotMotion, Source};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::{KernelId, Store};
use crate::reference::shared::join_cells;
use crate::sim::obstacles::{cell_lists, segments};
use crate::sim::order;
use crate::sim::setup::empty_cells;

/// What throngs are tried with: the grid, which sorts them, too.
const THRONGS: [KernelId; 4] =
    [KernelId::AdvanceJourney, KernelId::GridScan, KernelId::GridScatter, KernelId::Spawn];

/// What [`super::all`] holds of these.
pub(super) fn cases(size: usize, seed: u32) -> Vec<Case> {
    let mut cases = vec![
        only("walls", size, seed, walls(size, seed), &[KernelId::ClipToWalls, KernelId::Integrate]),
        only("nearly free places", size, seed, places(size, seed), &[KernelId::Spawn]),
    ];
    if size == 1_000 {
        cases.push(only("throngs", size, seed, throngs(seed), &THRONGS));
    }
    cases
}

/// The dispatches of these kernels alone.
fn only(what: &str, size: usize, seed: u32, store: Store, kernels: &[KernelId]) -> Case {
    let mut dispatches = order::step_dispatches(&store.step);
    dispatches.retain(|dispatch| kernels.contains(&dispatch.kernel()));
    Case { name: format!("{what}, size {size}, seed {seed}"), store, dispatches }
}

/// Puts all agents into the grid.
fn into_grid(store: &mut Store) {
    use KernelId::{GridScan, GridScatter};
    join_cells(&store.step, &store.position, &mut store.cells, &mut store.next_in_cell);
    for dispatch in order::step_dispatches(&store.step) {
        if matches!(dispatch.kernel(), GridScan | GridScatter) {
            crate::reference::run(dispatch.phase, store, dispatch.immediate);
        }
    }
}

/// A crowd about the walls, within three centimetres of them and farther, beyond their ends and in their corners, with
/// velocities towards them and along an axis, some far too large and some that are no numbers.
fn walls(agents: usize, seed: u32) -> Store {
    let mut store = super::step::crowd(agents, seed);
    let side = store.step.user_position[0] * 2.0;
    let mut solids = super::step::solids(side).to_vec();
    // a notch so narrow that nothing in it can slide along one side without meeting the other
    let notch = [[0.0, 0.0], [1.6, 0.0], [1.6, 2.0], [0.9, 2.0], [0.8, 0.3], [0.7, 2.0], [0.0, 2.0]];
    solids.push(notch.map(|[x, z]| [side * 0.3 + x, side * 0.5 + z]).to_vec());
    let all = segments(&solids);
    store.step.obstacle_count = all.len() as u32;
    store.obstacle_cells = cell_lists(&all, &store.step, 3.0);
    store.obstacles = all;
    let segments = store.step.obstacle_count as usize;
    for agent in 0..agents {
        let u = |lane: u32| unit(seed, agent, 70 + lane);
        let Segment { a: [ax, az], b: [bx, bz], along: [along_x, along_z], .. } =
            store.obstacles[agent % segments];
        let at = [0.0, 1.0, 1.3 * u(0) - 0.15][agent % 3];
        let away = [0.04 * u(1) - 0.01, 0.3 * u(1) - 0.03, 0.01][agent / 3 % 3];
        store.position[agent] = [ax + (bx - ax) * at + along_z * away, az + (bz - az) * at - along_x * away];
    }
    into_grid(&mut store);
    for slot in 0..store.slot_motion.len() {
        let u = |lane: u32| unit(seed, slot, 80 + lane);
        let fast = if slot % 11 == 3 { 400.0 } else { 3.0 };
        let (x, z) = ((2.0 * u(0) - 1.0) * fast, (2.0 * u(1) - 1.0) * fast);
        store.new_velocity[slot] = match slot % 9 {
            0 => [0.0, z],
            1 => [x, 0.0],
            2 if slot % 4 == 1 => [f32::NAN, z],
            2 if slot % 4 == 3 => [x, f32::INFINITY],
            _ => [x, z],
        };
        // nothing may happen in an empty slot, even where its fields are numbers
        let is_empty = slot >= agents || store.slot_motion[slot].agent == NOBODY;
        if is_empty && agents > 0 {
            store.slot_position[slot] = store.slot_position[0];
            let SlotMotion { agent, limits, .. } = store.slot_motion[slot];
            store.slot_motion[slot] = SlotMotion { agent, limits, ..store.slot_motion[0] };
        }
    }
    store
}

/// As many sources as there are people, of one agent and up to twenty places each, about as far from others and from the user as they
/// must be.
fn places(agents: usize, seed: u32) -> Store {
    let mut store = super::step::crowd(agents, seed);
    into_grid(&mut store);
    store.step.source_count = agents as u32;
    (store.sources, store.source_places) = (Vec::new(), Vec::new());
    for source in 0..agents {
        let u = |lane: u32| unit(seed, source, 90 + lane);
        let begin = store.source_places.len() as u32;
        let count = 1 + (u(0) * 20.0) as u32;
        for place in 0..count {
            let v = |lane: u32| unit(seed, source * 32 + place as usize, 95 + lane);
            let other = (v(0) * agents as f32) as usize;
            let (near, radius) = if place % 4 == 0 {
                (store.step.user_position, store.step.user_radius)
            } else {
                (store.position[other], store.body[other].radius)
            };
            let away = store.body[source].radius
                + radius
                + 0.1
                + [0.0, 0.02 * v(2) - 0.01, v(2) - 0.4][place as usize % 3];
            let (sine, cosine) = libm::sincosf(std::f32::consts::TAU * v(1));
            store.source_places.push([near[0] + away * sine, near[1] + away * cosine]);
        }
        store.sources.push(one_agent(begin, count, source as u32));
        store.entry[source] = store.step.step_index + (u(1) * 3.0) as u32;
    }
    store.source_places.push([f32::NAN; 2]);
    store.sources.push(Source::default());
    store
}

/// As many people at one point as are looked at for one place, and one more at another; a source beside each.
fn throngs(seed: u32) -> Store {
    const MOST: usize = 1024;
    let mut store = super::step::crowd(2 * MOST + 1, seed);
    let step = &mut store.step;
    (step.cell_size, step.inverse_cell_size) = (4.0, 0.25);
    (step.grid_origin, step.wrap, step.storey_height) = ([0.0; 2], 0.0, 0.0);
    (step.grid_columns, step.grid_rows, step.cell_count, step.source_count) = (10, 10, 100, 2);
    for agent in 0..=2 * MOST {
        store.position[agent] = if agent < MOST { [2.0, 2.0] } else { [34.0, 2.0] };
    }
    store.avoidance.iter_mut().for_each(|own| own.priority = 0.0); // no agent is led, and keeps more clear
    empty_cells(&mut store, 2 * MOST + 1);
    store.cell_depth = vec![0; 100];
    store.sources = vec![one_agent(0, 1, 0), one_agent(1, 1, MOST as u32)];
    store.source_places = vec![[2.0, 3.2], [34.0, 3.2]];
    store
}

/// A source of one agent.
fn one_agent(first_place: u32, places: u32, first_agent: u32) -> Source {
    Source { first_place, places, first_agent, agents: 1, widest: 0.42, ..Source::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_throng_lets_in_and_one_more_does_not() {
        let case = only("throngs", 1000, 1, throngs(1), &THRONGS);
        let mut store = case.store;
        for dispatch in case.dispatches {
            crate::reference::run(dispatch.phase, &mut store, dispatch.immediate);
        }
        assert_eq!([store.sources[0].entered, store.sources[1].entered], [1, 0]);
    }
}
