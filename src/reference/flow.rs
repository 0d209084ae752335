//! Way-finding: distances to goals over the walkable cells, and the directions in which they fall.

use super::exact::{greater, lesser};
use super::way::{pack, step};
use crate::kernels::flow::{FAR, GROUP};
use crate::kernels::flow::{SWEEPS, Slices};
use crate::kernels::layout::{FlowJoint, FlowSeed, FlowUniforms};
use crate::kernels::shared::tile::TILE;
use crate::kernels::shared::tile::index::RING;
use crate::kernels::shared::way::{ALL_BITS, FROM_ABOVE, FROM_BELOW, FROM_LEFT, FROM_RIGHT, LEADS, SOLID};
use rayon::prelude::*;

/// Fewest tiles of a turn that are worth a second thread.
const MANY: usize = 12;

fn tile_total(grid: &FlowUniforms) -> u32 {
    grid.field_count * grid.tile_columns * grid.tile_rows
}

/// Twin of phase `reset` of `shaders/flow.wgsl`.
pub fn flow_reset(mut b: Slices<'_>) {
    let cells = (b.flow_grid.field_count * b.flow_grid.cell_count) as usize;
    b.flow_distance[..cells].fill(FAR);
    let total = tile_total(b.flow_grid);
    clear_lists(&mut b, total);
}

/// Twin of phase `sweep` of `shaders/flow.wgsl`.
pub fn flow_sweep(mut b: Slices<'_>) {
    turn(&mut b, SOLID);
}

/// Twin of phase `sweep_solid` of `shaders/flow.wgsl`.
pub fn flow_sweep_solid(mut b: Slices<'_>) {
    turn(&mut b, 0);
}

fn clear_lists(b: &mut Slices<'_>, total: u32) {
    b.flow_tiles[..total as usize].fill(0);
    b.flow_lists[..4 * total as usize].fill(0);
    (0..4).for_each(|list| clear_list(b, list));
}

fn clear_list(b: &mut Slices<'_>, list: u32) {
    let at = 4 * list as usize;
    b.flow_args[at..at + 4].copy_from_slice(&[1, 1, 1, 0]);
}

fn enlist(b: &mut Slices<'_>, total: u32, list: u32, tile: u32) {
    if b.flow_tiles[tile as usize] == 0 {
        b.flow_tiles[tile as usize] = 1;
        let args = &mut b.flow_args[4 * list as usize..];
        let place = args[3];
        args[3] += 1;
        args[0] = args[0].max(place / GROUP + 1);
        b.flow_lists[(list * total + place) as usize] = tile;
    }
}

/// Twin of phase `sow` of `shaders/flow.wgsl`.
pub fn flow_sow(mut b: Slices<'_>) {
    let total = tile_total(b.flow_grid);
    let seeds = b.flow_seeds;
    for seed in &seeds[..b.flow_grid.seed_count as usize] {
        set_distance(&mut b, total, [seed.field, seed.cell], seed.distance);
    }
}

/// Sets the distance of a cell of a field; puts the tiles that can fall because of it on lists 0 and 1.
fn set_distance(b: &mut Slices<'_>, total: u32, [field, cell]: [u32; 2], distance: f32) {
    let grid = b.flow_grid;
    b.flow_distance[(field * grid.cell_count + cell) as usize] = distance;
    let (column, row) = (cell % grid.columns, cell / grid.columns);
    let (tx, tz) = (column / TILE, row / TILE);
    let tile = (field * grid.tile_rows + tz) * grid.tile_columns + tx;
    let colour = (tx + tz) & 1;
    enlist(b, total, colour, tile);
    if column % TILE == 0 && column > 0 {
        enlist(b, total, 1 - colour, tile - 1);
    }
    if column % TILE == TILE - 1 && column + 1 < grid.columns {
        enlist(b, total, 1 - colour, tile + 1);
    }
    if row % TILE == 0 && row > 0 {
        enlist(b, total, 1 - colour, tile - grid.tile_columns);
    }
    if row % TILE == TILE - 1 && row + 1 < grid.rows {
        enlist(b, total, 1 - colour, tile + grid.tile_columns);
    }
}

/// Twin of phase `join` of `shaders/flow.wgsl`: cells that are one place on several sheets are as far as the
/// nearest of them.
pub fn flow_join(mut b: Slices<'_>) {
    let total = tile_total(b.flow_grid);
    let (grid, joints) = (b.flow_grid, b.flow_joints);
    let sheet_cells = grid.sheet_rows * grid.columns;
    for field in 0..grid.field_count {
        for &FlowJoint { cell, sheets } in &joints[..grid.joint_count as usize] {
            let first = field * grid.cell_count + cell;
            let on = || (0..32).filter(|sheet| sheets >> sheet & 1 != 0);
            let distance = |sheet: u32| (first + sheet * sheet_cells) as usize;
            let least = on().map(|sheet| b.flow_distance[distance(sheet)]).fold(FAR, f32::min);
            for sheet in on() {
                if b.flow_distance[distance(sheet)] > least {
                    set_distance(&mut b, total, [field, cell + sheet * sheet_cells], least);
                }
            }
        }
    }
}

/// Twin of phase `enlist_solid` of `shaders/flow.wgsl`.
pub fn flow_enlist_solid(mut b: Slices<'_>) {
    let grid = b.flow_grid;
    let total = tile_total(grid);
    for tile in 0..total {
        let place = Place::of(grid, tile);
        let is_solid = (place.z0..place.z0 + place.height).any(|z| {
            let row = (z * grid.columns + place.x0) as usize;
            b.flow_cells[row..row + place.width as usize].iter().any(|bits| bits & SOLID != 0)
        });
        if is_solid {
            enlist(&mut b, total, (place.x0 / TILE + place.z0 / TILE) & 1, tile);
        }
    }
}

/// What one turn makes of a tile.
struct Swept {
    tile: u32,
    distance: [f32; (TILE * TILE) as usize],
    /// Whether any cell fell.
    fell: bool,
    /// Whether another turn is needed.
    again: bool,
    /// Sides whose neighbouring tiles can fall now.
    wake: u32,
}

/// A turn of the list, without the cells that have a bit of `left_out`.
fn turn(b: &mut Slices<'_>, left_out: u32) {
    let (total, list) = (tile_total(b.flow_grid), b.list);
    clear_list(b, (list + 3) & 3);
    let count = b.flow_args[4 * list as usize + 3];
    let first = (list * total) as usize;
    let tiles = &b.flow_lists[first..first + count as usize];
    let (grid, cells, distance) = (b.flow_grid, b.flow_cells, &*b.flow_distance);
    let sweep = |tile: &u32| sweep_tile(grid, cells, distance, *tile, left_out);
    let swept: Vec<Swept> = if tiles.len() < MANY {
        tiles.iter().map(sweep).collect()
    } else {
        tiles.par_iter().with_min_len(4).map(sweep).collect()
    };
    for one in &swept {
        b.flow_tiles[one.tile as usize] = 0;
    }
    for one in &swept {
        let tile = one.tile;
        if one.fell {
            let place = Place::of(grid, tile);
            for z in 0..place.height {
                let to = (place.first + (place.z0 + z) * grid.columns + place.x0) as usize;
                let from = (z * TILE) as usize;
                let width = place.width as usize;
                b.flow_distance[to..to + width].copy_from_slice(&one.distance[from..from + width]);
            }
        }
        if one.again {
            enlist(b, total, (list + 2) & 3, tile);
        }
        let next = (list + 1) & 3;
        if one.wake & FROM_RIGHT != 0 {
            enlist(b, total, next, tile - 1);
        }
        if one.wake & FROM_LEFT != 0 {
            enlist(b, total, next, tile + 1);
        }
        if one.wake & FROM_ABOVE != 0 {
            enlist(b, total, next, tile - grid.tile_columns);
        }
        if one.wake & FROM_BELOW != 0 {
            enlist(b, total, next, tile + grid.tile_columns);
        }
    }
}

/// Where a tile lies.
#[derive(Clone, Copy)]
struct Place {
    /// First cell of the field.
    first: u32,
    x0: u32,
    z0: u32,
    width: u32,
    height: u32,
}

impl Place {
    fn of(grid: &FlowUniforms, tile: u32) -> Self {
        let x0 = tile % grid.tile_columns * TILE;
        let z0 = tile / grid.tile_columns % grid.tile_rows * TILE;
        Self {
            first: tile / (grid.tile_columns * grid.tile_rows) * grid.cell_count,
            x0,
            z0,
            width: TILE.min(grid.columns - x0),
            height: TILE.min(grid.rows - z0),
        }
    }
}

/// Sweeps a tile on a copy of it and the cells around it; cells with a bit of `left_out` do not take part.
fn sweep_tile(grid: &FlowUniforms, cells: &[u32], distance: &[f32], tile: u32, left_out: u32) -> Swept {
    let place = Place::of(grid, tile);
    let (columns, first) = (grid.columns as usize, place.first as usize);
    let (x0, z0) = (place.x0 as usize, place.z0 as usize);
    let (width, height) = (place.width as usize, place.height as usize);
    let mut near = [FAR; RING * RING];
    let mut words = [0_u32; (TILE * TILE) as usize];
    // columns of the copy from and to: where the grid ends there is no ring
    let (from, to) = (usize::from(x0 == 0), width + 1 + usize::from(x0 + width < columns));
    for j in usize::from(z0 == 0)..height + 1 + usize::from(z0 + height < grid.rows as usize) {
        let row = first + (z0 + j - 1) * columns + x0;
        near[j * RING + from..j * RING + to].copy_from_slice(&distance[row + from - 1..row + to - 1]);
    }
    for z in 0..height {
        let (row, at) = ((z0 + z) * columns + x0, z * TILE as usize);
        for (word, cell) in words[at..at + width].iter_mut().zip(&cells[row..row + width]) {
            *word = if cell & left_out == 0 { *cell } else { 0 };
        }
    }
    let (fell, again) = sweeps(&mut near, &words, [width, height]);
    let wake = fell & wakes(grid, &near, &words, &place, left_out == 0);
    let mut swept = Swept { tile, distance: [0.0; (TILE * TILE) as usize], fell: fell != 0, again, wake };
    for z in 0..height {
        let (row, at) = ((z + 1) * RING + 1, z * TILE as usize);
        swept.distance[at..at + width].copy_from_slice(&near[row..row + width]);
    }
    swept
}

/// The sides (bits by which the neighbours there are entered) beyond which a cell could fall because of one of the tile.
fn wakes(
    grid: &FlowUniforms,
    near: &[f32; RING * RING],
    words: &[u32; (TILE * TILE) as usize],
    place: &Place,
    all: bool,
) -> u32 {
    let (width, height) = (place.width as usize, place.height as usize);
    let any = if all { u32::MAX } else { 0 };
    let could_fall = |x: usize, z: usize, outside: usize, bit: u32| {
        let at = (z + 1) * RING + x + 1;
        near[outside] > near[at] + 0.7 * grid.cell_size && words[z * TILE as usize + x] & (bit | any) != 0
    };
    let mut woken = 0;
    for z in 0..height {
        let row = (z + 1) * RING;
        if place.x0 > 0 && could_fall(0, z, row, FROM_LEFT) {
            woken |= FROM_RIGHT;
        }
        if place.x0 + place.width < grid.columns && could_fall(width - 1, z, row + width + 1, FROM_RIGHT) {
            woken |= FROM_LEFT;
        }
    }
    for x in 0..width {
        if place.z0 > 0 && could_fall(x, 0, x + 1, FROM_BELOW) {
            woken |= FROM_ABOVE;
        }
        if place.z0 + place.height < grid.rows
            && could_fall(x, height - 1, (height + 1) * RING + x + 1, FROM_ABOVE)
        {
            woken |= FROM_BELOW;
        }
    }
    woken
}

/// Sweeps until nothing falls; the sides whose cells fell, and whether it is not done yet.
fn sweeps(
    near: &mut [f32; RING * RING],
    words: &[u32; (TILE * TILE) as usize],
    [width, height]: [usize; 2],
) -> (u32, bool) {
    let mut fell = 0;
    // the first sweep goes with the front: from the side beside which it is nearer to the goal
    let (row, column) = ((height / 2 + 1) * RING, width / 2 + 1);
    let nearer_right = near[row + width + 1] < near[row];
    let nearer_above = near[(height + 1) * RING + column] < near[column];
    for sweep in 0..SWEEPS {
        let (from_right, from_above) = ((sweep & 1 != 0) != nearer_right, (sweep & 2 != 0) != nearer_above);
        let mut quiet = true;
        for j in 0..height {
            let z = if from_above { height - 1 - j } else { j };
            for i in 0..width {
                let x = if from_right { width - 1 - i } else { i };
                let (at, cell) = ((z + 1) * RING + x + 1, z * TILE as usize + x);
                let (word, old) = (words[cell], near[at]);
                // a neighbour it may not be entered from is replaced by the cell itself, which never makes it fall
                let neighbour = |bit: u32, index: usize| if word & bit != 0 { near[index] } else { old };
                let size = step(word);
                let a = lesser(neighbour(FROM_LEFT, at - 1), neighbour(FROM_RIGHT, at + 1));
                let b = lesser(neighbour(FROM_BELOW, at - RING), neighbour(FROM_ABOVE, at + RING));
                let apart = (a - b).abs();
                let mut fresh = lesser(a, b) + size;
                if apart < size {
                    fresh = 0.5 * (a + b + (2.0 * size * size - apart * apart).sqrt());
                }
                if fresh < old - 1e-4 * size {
                    near[at] = fresh;
                    quiet = false;
                    let side = |is: bool, bit: u32| if is { bit } else { 0 };
                    fell |= side(x == 0, FROM_RIGHT)
                        | side(x + 1 == width, FROM_LEFT)
                        | side(z == 0, FROM_ABOVE)
                        | side(z + 1 == height, FROM_BELOW);
                }
            }
        }
        if quiet {
            // a tile whose inner cells alone fell changes nothing for its neighbours, but is written all the same
            return (fell | if sweep > 0 { 1 << 31 } else { 0 }, false);
        }
    }
    (fell | 1 << 31, true)
}

fn slope(here: f32, low: f32, high: f32, both: bool) -> f32 {
    if both {
        return 0.5 * (low - high);
    }
    greater(here - high, 0.0) - greater(here - low, 0.0)
}

/// Twin of phase `point` of `shaders/flow.wgsl`.
pub fn flow_point(mut b: Slices<'_>) {
    let cells = b.flow_grid.cell_count as usize;
    let columns = b.flow_grid.columns as usize;
    let total = b.flow_grid.field_count as usize * cells;
    let (all_bits, distance) = (b.flow_cells, &*b.flow_distance);
    b.flow_way[..total].par_iter_mut().enumerate().with_min_len(4096).for_each(|(index, way)| {
        let bits = all_bits[index % cells] & ALL_BITS;
        let here = distance[index];
        let from = |bit: u32| bits & bit != 0;
        let neighbour = |bit: u32, at: usize| if from(bit) { distance[at] } else { here };
        let left = neighbour(FROM_LEFT, index.wrapping_sub(1));
        let right = neighbour(FROM_RIGHT, index + 1);
        let below = neighbour(FROM_BELOW, index.wrapping_sub(columns));
        let above = neighbour(FROM_ABOVE, index + columns);
        let is_free = bits & SOLID == 0;
        let fall = [
            slope(here, left, right, is_free && from(FROM_LEFT) && from(FROM_RIGHT)),
            slope(here, below, above, is_free && from(FROM_BELOW) && from(FROM_ABOVE)),
        ];
        let steep = (fall[0] * fall[0] + fall[1] * fall[1]).sqrt();
        let mut word = bits;
        if here < 0.5 * FAR && steep > 0.0 {
            let scale = 1.0 / steep;
            word |= LEADS | pack([fall[0] * scale, fall[1] * scale]);
        }
        *way = word;
    });
    let total = tile_total(b.flow_grid);
    clear_lists(&mut b, total);
}

/// Twin of phase `mark` of `shaders/flow.wgsl`.
pub fn flow_mark(b: Slices<'_>) {
    let grid = b.flow_grid;
    for &FlowSeed { field, cell, sees, .. } in &b.flow_seeds[..grid.seed_count as usize] {
        b.flow_way[(field * grid.cell_count + cell) as usize] |= sees;
    }
}
