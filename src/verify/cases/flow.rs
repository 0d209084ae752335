//! Fields for the kernels of way-finding.

use super::case::unit;
use crate::kernels::layout::{FlowUniforms, StepUniforms};
use crate::kernels::{Dispatch, Store};
use crate::scenario::{Floor, Floors};
use crate::sim::flow::{Goal, Settings, lay_on};
use crate::sim::order;
use glam::Vec2;

/// Three fields over about `cells` cells with walls and blocks on them, one of which shuts a pocket off, and a crowd whose
/// density counts. Odd seeds have a maze, too. From a thousand cells on a ramp leads up to a floor above the ground. `cells` 0: no
/// field at all. What the kernels write before they read is NaN or nonsense.
pub fn fields(cells: usize, seed: u32) -> Store {
    let mut store = Store {
        step: StepUniforms { agent_count: cells as u32, ..StepUniforms::default() },
        ..Store::default()
    };
    crate::sim::flow::clear(&mut store);
    store.floors = vec![[0.0; 4]];
    store.elevation = vec![0.0; cells.max(1)];
    if cells == 0 {
        return store;
    }
    if cells == 1 {
        one_cell(&mut store);
        return store;
    }
    // the grid has two cells of margin on each side
    let rows = ((cells as f32).sqrt() as u32).max(1);
    let columns = (cells as u32).div_ceil(rows);
    let [width, depth] = [columns, rows].map(|n| (n as f32 - 4.0).max(0.25) * 0.5);
    let mut outlines = vec![vec![[0.0, 0.0], [0.0, depth], [width, depth], [width, 0.0]]];
    let u = |item: usize, lane| unit(seed, item, lane);
    if cells > 200 {
        for i in 0..cells / 150 {
            let (x, z) = (u(i, 0) * width * 0.9, u(i, 1) * depth * 0.9);
            let (w, d) = (0.3 + 2.0 * u(i, 2), 0.3 + 2.0 * u(i, 3));
            outlines.push(if i % 3 == 0 {
                vec![[x, z], [x + w, z + d]] // a wall of no thickness
            } else {
                vec![[x, z], [x + w, z], [x + w, z + d], [x, z + d]]
            });
        }
        if seed % 2 == 1 {
            outlines.extend(maze(width, depth, cells, seed));
        }
        let (x, z) = (width * 0.5, depth * 0.5);
        let corners = [[x, z], [x + 2.0, z], [x + 2.0, z + 2.0], [x, z + 2.0]];
        outlines.extend((0..4).map(|i| vec![corners[i], corners[(i + 1) % 4]]));
    }
    let goal = |name: &str, center: Vec2, region: Vec<Vec2>| Goal {
        name: name.to_owned(),
        center,
        radius: width.max(depth),
        region,
        elevation: None,
    };
    let storeys = if cells >= 1000 { ramp_and_floor(width, depth) } else { Floors::default() };
    if storeys.count() > 0 {
        store.step.floor_count = storeys.count() as u32;
        store.floors.clone_from(&storeys.elements);
        store.elevation = (0..cells).map(|i| if i % 3 == 0 { HIGH } else { 0.0 }).collect();
    }
    let middle = Vec2::new(width, depth) * 0.4;
    let region =
        [(0.0, 0.0), (0.3, 0.0), (0.3, 0.2), (0.0, 0.2)].map(|(x, z)| Vec2::new(x * width, z * depth));
    let above =
        Goal { elevation: Some(HIGH), ..goal("above", Vec2::new(width * 0.65, depth * 0.5), Vec::new()) };
    let mut goals =
        vec![goal("middle", middle, Vec::new()), goal("corner", region[2] * 0.5, region.to_vec())];
    goals.extend((storeys.count() > 0).then_some(above));
    let settings = Settings { cell: Some(0.5), density_weight: 0.7, clearance: 0.2, every: 1 };
    let mut lay =
        |outlines: &[Vec<[f32; 2]>], goals: &[Goal]| lay_on(&mut store, outlines, &storeys, goals, &settings);
    let laid = (1..=goals.len()).rev().find(|count| lay(&outlines, &goals[..*count]).is_ok());
    if laid.is_none() {
        // so small a place has no room for a goal: one cell, which is the goal, all round solid
        let _ = lay(&[], &goals[..1]);
    }
    for i in 0..cells {
        let absent = i % 9 == 4;
        let at = [u(i, 4) * (width + 6.0) - 3.0, u(i, 5) * (depth + 6.0) - 3.0]; // some are off the grid
        store.position.push(if absent { [crate::kernels::shared::absent::ABSENT; 2] } else { at });
    }
    store.flow_distance.fill(f32::NAN);
    store.flow_way.fill(u32::MAX);
    store.flow_tiles.fill(7);
    store.flow_lists.fill(7);
    store.flow_counts.fill(7);
    // behind the last cell, to see that it is none
    store.flow_cells.extend([7; 2]);
    store.flow_sums.extend([7; 2]);
    store.flow_counts.extend([7; 2]);
    store
}

/// Walls along the borders of cells: ways through them turn at every cell, and sweeps come to rest late.
fn maze(width: f32, depth: f32, cells: usize, seed: u32) -> impl Iterator<Item = Vec<[f32; 2]>> {
    let walls = (cells / 3).min(1500);
    (0..walls).map(move |i| {
        let on_border = |share: f32, extent: f32| (share * extent / 0.5).floor() * 0.5;
        let (x, z) = (on_border(unit(seed, i, 6), width), on_border(unit(seed, i, 7), depth));
        let length = if unit(seed, i, 8) < 0.3 { 1.0 } else { 0.5 };
        let end = if unit(seed, i, 9) < 0.5 { [x + length, z] } else { [x, z + length] };
        vec![[x, z], end]
    })
}

/// Height of the floor, m.
const HIGH: f32 = 2.5;

/// A ramp along x, and the floor that it leads up to.
fn ramp_and_floor(width: f32, depth: f32) -> Floors {
    let floor = |from: f32, to: f32, heights: &[f32]| Floor {
        polygon: [[from, 0.4], [to, 0.4], [to, 0.6], [from, 0.6]]
            .map(|[x, z]| [x * width, z * depth])
            .to_vec(),
        heights: heights.to_vec(),
        railings: vec![0],
    };
    Floors::new(&[floor(0.2, 0.5, &[0.0, HIGH, HIGH]), floor(0.5, 0.8, &[HIGH])], &[])
}

/// A grid of a single cell, the goal.
fn one_cell(store: &mut Store) {
    store.flow_grid = FlowUniforms {
        cell_size: 0.5,
        inverse_cell_size: 2.0,
        columns: 1,
        rows: 1,
        sheet_rows: 1,
        cell_count: 1,
        tile_columns: 1,
        tile_rows: 1,
        field_count: 1,
        seed_count: 1,
        window: 2,
        density_weight: 1.0,
        solid_step: 15.0,
        every: 1,
        ..FlowUniforms::default()
    };
    store.position = vec![[0.25, 0.25]];
    store.flow_room = vec![0.25];
}

/// The dispatches that count, price and solve.
pub fn dispatches(store: &Store) -> Vec<Dispatch> {
    let grid = &store.flow_grid;
    let mut dispatches = order::density_dispatches(&store.step, grid);
    dispatches.extend(order::flow_start(grid));
    // enough for any of these cases: the lists are empty long before
    let turns = (grid.tile_columns * grid.tile_rows).min(600) + 16;
    dispatches.extend(order::flow_turns(0, turns, false));
    for _ in 0..if grid.joint_count > 0 { 4 } else { 0 } {
        dispatches.push(order::flow_joint(grid));
        dispatches.extend(order::flow_turns(0, turns, false));
    }
    dispatches.push(order::flow_solid(grid));
    dispatches.extend(order::flow_turns(0, turns, true));
    dispatches.extend(order::flow_end(grid));
    dispatches
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kernels::flow::FAR;
    use crate::kernels::shared::way::SOLID;
    use crate::reference::way::step;

    #[test]
    fn the_cases_hold_free_cells_solid_ones_and_a_pocket_and_come_to_an_end() {
        let mut store = fields(5000, 3);
        let dispatches = dispatches(&store);
        for dispatch in &dispatches[..dispatches.len() - 1] {
            crate::reference::run(dispatch.phase, &mut store, dispatch.immediate);
        }
        assert!((0..4).all(|list| store.flow_args[list * 4 + 3] == 0), "tiles are left on the lists");
        let count = |is: &dyn Fn(u32, f32) -> bool| {
            let cells = store.flow_cells.iter().zip(&store.flow_distance);
            cells.filter(|(bits, distance)| is(**bits, **distance)).count()
        };
        assert!(count(&|bits, distance| bits & SOLID == 0 && distance < FAR) > 2000);
        assert!(count(&|bits, _| bits & SOLID != 0) > 200);
        assert!(count(&|bits, distance| bits & SOLID == 0 && distance >= FAR) > 3, "the pocket");
        let grid = &store.flow_grid;
        assert_eq!(
            (grid.rows, grid.field_count),
            (2 * grid.sheet_rows, 3),
            "a storey above the ground, and a goal on it"
        );
        assert!(grid.joint_count > 10, "{} joints", grid.joint_count);
        assert!(
            store.flow_cells.iter().any(|word| (0.6..14.0).contains(&step(*word))),
            "density has a price"
        );
    }
}
