//! What it costs to solve the flow field of a goal over a square, in the open and among blocks.
//!
//! `field_open` is an empty square with the goal in its middle, `field_blocks` the same with a house of 2 to 10 m
//! for every thousand cells. Cells have sides of 0.5 m. Timed by the clock: from the walkable cells to the solved field,
//! [`Simulation::solve_ways`].

use super::runs::{Row, repeat};
use crate::kernels::Store;
use crate::reference::exact::{hash_u32, unit_f32};
use crate::sim::flow::{Goal, Settings, lay};
use crate::sim::{Backend, Simulation, setup};
use glam::Vec2;

/// Side of a cell, m.
const CELL: f32 = 0.5;
/// Cells around the walkable area on all sides.
const MARGIN: usize = 2;
/// A house for every so many cells.
const CELLS_A_HOUSE: usize = 1_000;

/// Times the two fields over a square of about `cells` cells.
pub(super) fn field(
    cells: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    let across = cells.isqrt().saturating_sub(2 * MARGIN).max(1);
    #[allow(clippy::cast_precision_loss, reason = "thousands")]
    let side = across as f32 * CELL;
    let mut rows = Vec::new();
    let mut name = String::new();
    for (row, houses) in [("field_open", 0), ("field_blocks", cells / CELLS_A_HOUSE)] {
        let mut outlines = vec![vec![[0.0, 0.0], [0.0, side], [side, side], [side, 0.0]]];
        outlines.extend((0..).take(houses).map(|i| house(i, side)));
        let goal = Goal {
            name: "middle".to_owned(),
            center: Vec2::splat(0.5 * side),
            radius: 12.0,
            ..Goal::default()
        };
        let mut store = Store::default();
        setup::scratch(&mut store);
        lay(&mut store, &outlines, &[goal], &Settings { cell: Some(CELL), ..Settings::default() })?;
        let cells = store.flow_grid.cell_count as usize;
        let mut simulation = Simulation::from_store(store, backend, device)?;
        name = simulation.device();
        rows.push(Row::new(
            row,
            cells,
            repeat(|| {
                let begin = std::time::Instant::now();
                simulation.solve_ways()?;
                Ok(begin.elapsed().as_secs_f64() * 1e3)
            })?,
        ));
    }
    Ok((rows, name))
}

/// A house somewhere on the square.
fn house(number: u32, side: f32) -> Vec<[f32; 2]> {
    let draw = |lane: u32| unit_f32(hash_u32(hash_u32(number).wrapping_add(lane)));
    let [width, depth] = [0, 1].map(|lane| 2.0 + 8.0 * draw(lane));
    let [x, z] = [draw(2) * (side - width).max(0.0), draw(3) * (side - depth).max(0.0)];
    vec![[x, z], [x + width, z], [x + width, z + depth], [x, z + depth]]
}
