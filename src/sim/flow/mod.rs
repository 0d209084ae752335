//! Way-finding: the flow grid over the walkable area, and one flow field for each goal of the agents.
//!
//! The kernel `flow` solves the fields on either backend. This module prepares its input.

mod goals;
pub mod raster;
pub mod sheets;

pub use goals::{MOST_FIELDS, Ways, equip};
pub use raster::Raster;
pub use sheets::Sheets;

use crate::kernels::Store;
use crate::kernels::layout::{FlowJoint, FlowSeed, FlowUniforms};
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::floors::index::FLOOR_STRIDE;
use crate::kernels::shared::tile::TILE;
use crate::kernels::shared::way::SEES;
use crate::reference::way::with_step;
use crate::scenario::{Floors, polygon};
use glam::Vec2;

/// Cell side where little ground is to be covered, and elsewhere, m.
const CELLS: [f32; 2] = [0.25, 0.5];
/// Most cells with the finer side.
const FINE: f32 = 250_000.0;
/// Most cells times fields; beyond it the automatic cell grows. (Fields then have 64 MiB each for distance and direction.)
const MOST: f32 = 16_000_000.0;
/// Least cell side, m.
const SMALLEST: f32 = 0.05;
/// Cost of a cell in which no agent can stand, in free cells. So the field leaves it by the nearest way.
const SOLID_COST: f32 = 30.0;
/// Exact distances are given around a goal as far as it can be seen: in m, and least and most in cells.
const SIGHT: (f32, f32, f32) = (4.0, 8.0, 24.0);
/// Density is counted over about this far each way, m.
const WINDOW: f32 = 1.0;

/// What agents ask the way to.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Goal {
    /// Name, for messages.
    pub name: String,
    /// Its middle, m.
    pub center: Vec2,
    /// An agent this near to the middle has arrived, m. Where a wall covers the middle, another place within it is sought.
    pub radius: f32,
    /// Its outline, if it is a region: all of it is the goal, and distances are those to the outline. Empty: the middle.
    pub region: Vec<Vec2>,
    /// Height of the floor that it lies on, m; none: on any floor there, or on the ground.
    pub elevation: Option<f32>,
}

/// How the flow grid is laid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Settings {
    /// Side of a cell, m; `None`: 0.25 m for up to a sixty-fourth of a square kilometre, 0.5 m beyond, more where memory demands it.
    pub cell: Option<f32>,
    /// Distance that a person's centre keeps from walls, m: a passage narrower than twice this is closed.
    pub clearance: f32,
    /// Cost of a metre is 1 + this (m²) times the density of people, agents/m²; 0: density does not matter.
    pub density_weight: f32,
    /// Steps between two counts of people, at least 1.
    pub every: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self { cell: None, clearance: 0.25, density_weight: 0.0, every: 30 }
    }
}

/// Lays the flow grid over `outlines` (oriented as [`Raster::new`] wants them) with one field for each goal, into the
/// store's buffers. Without goals the buffers hold one element each, which no kernel reads.
///
/// # Errors
/// [`super::Error::Goal`] when no agent can stand at a goal, [`super::Error::FlowGrid`] for too many cells.
pub fn lay(
    store: &mut Store,
    outlines: &[Vec<[f32; 2]>],
    goals: &[Goal],
    settings: &Settings,
) -> Result<Option<Sheets>, super::Error> {
    lay_on(store, outlines, &Floors::default(), goals, settings)
}

/// The same over the ground and floors, which must be in the store already: the function writes their sheets to them.
///
/// # Errors
/// As [`lay`]; [`super::Error::Sheets`] when too many floors lie above one another.
pub fn lay_on(
    store: &mut Store,
    outlines: &[Vec<[f32; 2]>],
    floors: &Floors,
    goals: &[Goal],
    settings: &Settings,
) -> Result<Option<Sheets>, super::Error> {
    if goals.is_empty() {
        clear(store);
        return Ok(None);
    }
    let homes = sheets::homes(floors)?;
    let layers = 1 + homes.iter().copied().max().unwrap_or(0);
    let size = cell_size(outlines, goals.len() * layers as usize, settings.cell)?;
    let window = (WINDOW / size).round().clamp(1.0, 8.0) as u32;
    let sheets = Sheets::new(outlines, floors, homes, [size, settings.clearance], window);
    let mut seeds = Vec::new();
    for (field, goal) in goals.iter().enumerate() {
        sow_on(&sheets, goal, field as u32, &mut seeds)?;
    }
    let mut stacked = *sheets.grid();
    stacked.rows *= layers;
    stacked.cell_count *= layers;
    stacked.tile_rows = stacked.rows.div_ceil(TILE);
    let grid = &mut stacked;
    grid.field_count = goals.len() as u32;
    grid.seed_count = seeds.len() as u32;
    grid.joint_count = sheets.joints.len() as u32;
    grid.window = window;
    grid.density_weight = settings.density_weight;
    grid.every = if settings.density_weight > 0.0 { settings.every.max(1) } else { 0 };
    grid.solid_step = SOLID_COST * size;
    let fields = goals.len();
    let (cells, tiles) = (grid.cell_count as usize, (grid.tile_columns * grid.tile_rows) as usize);
    store.flow_grid = *grid;
    let words = |raster: &Raster| -> Vec<u32> {
        let step = |cell| if raster.is_free(cell) { size } else { SOLID_COST * size };
        (0..raster.bits.len()).map(|cell| with_step(raster.bits[cell], step(cell))).collect()
    };
    store.flow_cells = sheets.rasters.iter().flat_map(words).collect();
    store.flow_seeds = seeds;
    store.flow_joints = sheets.joints.iter().map(|&[cell, sheets]| FlowJoint { cell, sheets }).collect();
    if store.flow_joints.is_empty() {
        store.flow_joints.push(FlowJoint::default());
    }
    for (floor, home) in store.floors.chunks_exact_mut(FLOOR_STRIDE).zip(&sheets.homes) {
        let [_, _, _, sheet] = &mut floor[0];
        *sheet = *home as f32;
    }
    store.flow_distance = vec![0.0; fields * cells];
    store.flow_way = vec![0; fields * cells];
    store.flow_tiles = vec![0; fields * tiles];
    store.flow_lists = vec![0; 4 * fields * tiles];
    store.flow_args = vec![0; 16];
    let counted = if stacked.every > 0 { cells } else { 1 };
    store.flow_counts = vec![0; counted];
    store.flow_sums = vec![0; counted];
    store.flow_room = vec![0.0];
    if stacked.every > 0 {
        store.flow_room = sheets.rasters.iter().flat_map(|raster| room(raster, window as usize)).collect();
    }
    Ok(Some(sheets))
}

/// Sows a goal on the sheets on which it lies.
fn sow_on(sheets: &Sheets, goal: &Goal, field: u32, seeds: &mut Vec<FlowSeed>) -> Result<(), super::Error> {
    let before = seeds.len();
    for sheet in sheets.of_goal(goal.center, goal.elevation) {
        let first = seeds.len();
        sow(&sheets.rasters[sheet], goal, field, seeds);
        // the parts of a region that lie at another height are not it
        let is_there = |cell: u32| {
            goal.elevation
                .is_none_or(|elevation| (sheets.height(sheet, cell as usize) - elevation).abs() < STEP)
        };
        let mut sown = seeds.split_off(first);
        sown.retain(|seed| goal.region.is_empty() || is_there(seed.cell));
        let first_cell = (sheet * sheets.sheet_cells()) as u32;
        seeds.extend(sown.into_iter().map(|seed| FlowSeed { cell: first_cell + seed.cell, ..seed }));
    }
    if seeds.len() == before {
        let Goal { name, center, elevation, .. } = goal.clone();
        return Err(super::Error::Goal {
            name,
            x: center.x,
            z: center.y,
            elevation: elevation.unwrap_or(0.0),
        });
    }
    Ok(())
}

/// Tiles that the front of the field that has the farthest to go crosses in an open place: so many turns it takes at least.
pub fn tiles_to_cross(grid: &FlowUniforms, seeds: &[FlowSeed]) -> u32 {
    let [right, top] = [grid.tile_columns, grid.tile_rows].map(|tiles| tiles.saturating_sub(1));
    let corners = [[0, 0], [right, 0], [0, top], [right, top]];
    let mut to_corners = vec![[u32::MAX; 4]; grid.field_count as usize];
    for FlowSeed { field, cell, .. } in seeds {
        let [column, row] = [cell % grid.columns / TILE, cell / grid.columns / TILE];
        for (least, [x, z]) in to_corners[*field as usize].iter_mut().zip(corners) {
            *least = (*least).min(column.abs_diff(x) + row.abs_diff(z));
        }
    }
    to_corners.into_iter().flatten().filter(|tiles| *tiles < u32::MAX).max().unwrap_or(0)
}

/// No fields.
pub fn clear(store: &mut Store) {
    store.flow_grid = FlowUniforms::default();
    store.flow_cells = vec![0];
    store.flow_seeds = vec![FlowSeed::default()];
    store.flow_joints = vec![FlowJoint::default()];
    store.flow_distance = vec![0.0];
    store.flow_way = vec![0];
    store.flow_tiles = vec![0];
    store.flow_lists = vec![0; 4];
    store.flow_args = vec![0; 16];
    store.flow_counts = vec![0];
    store.flow_sums = vec![0];
    store.flow_room = vec![0.0];
}

/// Side of the cells, m.
fn cell_size(outlines: &[Vec<[f32; 2]>], fields: usize, asked: Option<f32>) -> Result<f32, super::Error> {
    let corners = || outlines.iter().flatten().map(|c| Vec2::from_array(*c));
    let extent = corners().fold(Vec2::NEG_INFINITY, Vec2::max) - corners().fold(Vec2::INFINITY, Vec2::min);
    let area = if extent.is_finite() { (extent + Vec2::splat(4.0)).element_product() } else { 1.0 };
    let smallest = (area * fields as f32 / MOST).sqrt();
    if let Some(size) = asked {
        let least = smallest.max(SMALLEST);
        return if size >= least { Ok(size) } else { Err(super::Error::FlowGrid { size, least, fields }) };
    }
    let [fine, usual] = CELLS;
    let size = if area / (fine * fine) <= FINE { fine } else { usual };
    Ok(size.max(smallest))
}

/// Cells of a sheet whose distance to a goal is known: those of its region or around its middle, as far as it can be seen.
fn sow(raster: &Raster, goal: &Goal, field: u32, seeds: &mut Vec<FlowSeed>) {
    let size = raster.grid.cell_size;
    let sight = (SIGHT.0 / size).clamp(SIGHT.1, SIGHT.2) * size;
    let before = seeds.len();
    let mut sow = |cell: usize, distance: f32, sees: bool| {
        seeds.push(FlowSeed { field, cell: cell as u32, distance, sees: if sees { SEES } else { 0 } });
    };
    if goal.region.len() > 2 {
        let low = goal.region.iter().copied().fold(Vec2::MAX, Vec2::min) - Vec2::splat(sight);
        let high = goal.region.iter().copied().fold(Vec2::MIN, Vec2::max) + Vec2::splat(sight);
        for cell in cells_in(raster, low, high) {
            let at = raster.middle(cell);
            if polygon::contains(&goal.region, at) {
                sow(cell, 0.0, raster.sees(at, goal.center));
                continue;
            }
            let nearest = polygon::edges(&goal.region)
                .map(|(a, b)| nearest(at, a, b))
                .min_by(|a, b| at.distance_squared(*a).total_cmp(&at.distance_squared(*b)));
            let Some(nearest) = nearest.filter(|nearest| nearest.distance(at) <= sight) else { continue };
            if raster.sees(at, nearest) {
                sow(cell, nearest.distance(at), raster.sees(at, goal.center));
            }
        }
    } else if let Some(center) = standing_place(raster, goal) {
        for cell in cells_in(raster, center - Vec2::splat(sight), center + Vec2::splat(sight)) {
            let at = raster.middle(cell);
            let distance = at.distance(center);
            if distance <= sight && raster.sees(at, center) {
                sow(cell, distance, center == goal.center);
            }
        }
        if let Some(cell) =
            raster.cell(center).filter(|cell| !seeds[before..].iter().any(|seed| seed.cell == *cell as u32))
        {
            seeds.push(FlowSeed { field, cell: cell as u32, distance: 0.0, sees: 0 });
        }
    }
}

/// The middle of a goal if a person can be there, or the nearest place within its radius.
fn standing_place(raster: &Raster, goal: &Goal) -> Option<Vec2> {
    if raster.has_room(goal.center) {
        return Some(goal.center);
    }
    let reach = goal.radius.max(raster.grid.cell_size);
    let cells = cells_in(raster, goal.center - Vec2::splat(reach), goal.center + Vec2::splat(reach));
    let step = raster.grid.cell_size * 0.125;
    let samples = cells.into_iter().filter(|cell| raster.is_free(*cell)).flat_map(|cell| {
        let corner = raster.middle(cell) - Vec2::splat(3.5 * step);
        (0..64).map(move |i| corner + Vec2::new((i % 8) as f32, (i / 8) as f32) * step)
    });
    samples
        .filter(|at| raster.has_room(*at) && at.distance(goal.center) <= reach)
        .min_by(|a, b| a.distance_squared(goal.center).total_cmp(&b.distance_squared(goal.center)))
}

fn nearest(at: Vec2, a: Vec2, b: Vec2) -> Vec2 {
    let length2 = a.distance_squared(b);
    if length2 > 0.0 { a + (b - a) * ((at - a).dot(b - a) / length2).clamp(0.0, 1.0) } else { a }
}

/// Free cells whose middles lie in a rectangle, rising.
fn cells_in(raster: &Raster, low: Vec2, high: Vec2) -> Vec<usize> {
    let grid = &raster.grid;
    let index = |at: Vec2| {
        let scaled = (at - Vec2::from_array(grid.origin)) / grid.cell_size;
        let most = Vec2::new((grid.columns - 1) as f32, (grid.rows - 1) as f32);
        scaled.floor().clamp(Vec2::ZERO, most)
    };
    let (first, last) = (index(low), index(high));
    let columns = grid.columns as usize;
    (first.y as usize..=last.y as usize)
        .flat_map(|row| (first.x as usize..=last.x as usize).map(move |column| row * columns + column))
        .filter(|cell| raster.is_free(*cell))
        .collect()
}

/// Free ground in the window around each cell, m², at least that of one cell.
fn room(raster: &Raster, window: usize) -> Vec<f32> {
    let (columns, rows) = (raster.grid.columns as usize, raster.grid.rows as usize);
    let one = raster.grid.cell_size * raster.grid.cell_size;
    let along: Vec<u32> = (0..columns * rows)
        .map(|cell| {
            let (column, first) = (cell % columns, cell / columns * columns);
            let (low, high) = (column.saturating_sub(window), (column + window).min(columns - 1));
            (first + low..=first + high).map(|cell| u32::from(raster.is_free(cell))).sum()
        })
        .collect();
    (0..columns * rows)
        .map(|cell| {
            let (column, row) = (cell % columns, cell / columns);
            let (low, high) = (row.saturating_sub(window), (row + window).min(rows - 1));
            let free: u32 = (low..=high).map(|row| along[row * columns + column]).sum();
            free.max(1) as f32 * one
        })
        .collect()
}
