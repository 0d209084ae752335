//! The walkable area on the flow grid: which cells a person's centre can be in, and from which to which it can go.
//!
//! Each cell is looked at in 8 by 8 samples. A cell is *free* where some sample has the clearance from every wall (less
//! half the diagonal of a sample, so that a door just wide enough is never closed by where the samples happen to lie; a
//! door up to that much too narrow counts as open), *tight* where only the clearance is missing, *solid* otherwise. From
//! one free cell to the next there is a way where two samples side by side have the clearance, so walls of no thickness
//! separate, too. What a wall cuts off within a cell (the smaller part) is dropped.

use crate::kernels::layout::FlowUniforms;
use crate::kernels::shared::tile::TILE;
use crate::kernels::shared::way::{FROM_ABOVE, FROM_BELOW, FROM_LEFT, FROM_RIGHT, SOLID};
use glam::{DVec2, Vec2};

/// Samples along the side of a cell.
const SAMPLES: usize = 8;
/// Cells around the area, so that an agent pushed out finds back.
const MARGIN: f64 = 2.0;
/// Samples in the first and last column of a cell, bit by row * 8 + column.
const FIRST_COLUMN: u64 = 0x0101_0101_0101_0101;
const LAST_COLUMN: u64 = FIRST_COLUMN << 7;
/// Samples in the first row.
const FIRST_ROW: u64 = 0xff;

/// The walkable area as cells.
#[derive(Debug, Clone)]
pub struct Raster {
    /// Where the cells lie; what concerns fields is not filled in.
    pub grid: FlowUniforms,
    /// Bits of each cell, see `shaders/shared/way.wgsl`.
    pub bits: Vec<u32>,
    /// Samples of each cell in which a person's centre can be.
    samples: Vec<u64>,
}

impl Raster {
    /// Cells of `size` m over the corners of `outlines`: those that run clockwise on (x, z) are walkable inside, others
    /// solid inside, as the solver has them; two corners are a wall. `clearance` is the distance in m that a person's
    /// centre keeps from walls.
    pub fn new(outlines: &[Vec<[f32; 2]>], size: f32, clearance: f32) -> Self {
        let grid = Self::lay(outlines, size);
        let solid = solid_samples(&grid, outlines);
        let (samples, open) = clear_samples(&grid, outlines, &solid, f64::from(clearance));
        let bits = links(&grid, &samples, &open);
        Self { grid, bits, samples }
    }

    /// The same on cells that are laid already, of which some are kept and others solid; from one free cell to the next
    /// one walks only where `leads` says so.
    pub fn of_sheet(
        grid: &FlowUniforms,
        outlines: &[Vec<[f32; 2]>],
        clearance: f32,
        keeps: impl Fn(usize) -> bool,
        leads: impl Fn(usize, usize) -> bool,
    ) -> Self {
        let mut solid = solid_samples(grid, outlines);
        for (_, samples) in solid.iter_mut().enumerate().filter(|(cell, _)| !keeps(*cell)) {
            *samples = u64::MAX;
        }
        let (samples, open) = clear_samples(grid, outlines, &solid, f64::from(clearance));
        let mut bits = links(grid, &samples, &open);
        let columns = grid.columns as usize;
        for (cell, bits) in bits.iter_mut().enumerate().filter(|(_, bits)| **bits & SOLID == 0) {
            for (bit, other) in [
                (FROM_LEFT, cell.wrapping_sub(1)),
                (FROM_RIGHT, cell + 1),
                (FROM_BELOW, cell.wrapping_sub(columns)),
                (FROM_ABOVE, cell + columns),
            ] {
                if *bits & bit != 0 && !leads(cell, other) {
                    *bits &= !bit;
                }
            }
        }
        Self { grid: *grid, bits, samples }
    }

    /// Cells of `size` m over the corners of `outlines`.
    pub fn lay(outlines: &[Vec<[f32; 2]>], size: f32) -> FlowUniforms {
        let corners = || outlines.iter().flatten().map(|c| Vec2::from_array(*c).as_dvec2());
        let low = corners().fold(DVec2::INFINITY, DVec2::min);
        let high = corners().fold(DVec2::NEG_INFINITY, DVec2::max);
        let (low, high) = if low.x <= high.x { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
        let cell = f64::from(size);
        let origin = (low - DVec2::splat(MARGIN * cell)).as_vec2();
        let extent = (high - origin.as_dvec2()) / cell;
        let [columns, rows] = (extent + DVec2::splat(MARGIN)).ceil().to_array().map(|n| (n as u32).max(1));
        FlowUniforms {
            origin: origin.to_array(),
            cell_size: size,
            inverse_cell_size: 1.0 / size,
            columns,
            rows,
            cell_count: columns * rows,
            tile_columns: columns.div_ceil(TILE),
            tile_rows: rows.div_ceil(TILE),
            sheet_rows: rows,
            ..FlowUniforms::default()
        }
    }

    /// The cell of a ground position, if it is on the grid.
    pub fn cell(&self, at: Vec2) -> Option<usize> {
        let scaled = (at - Vec2::from_array(self.grid.origin)) / self.grid.cell_size;
        let within = scaled.x >= 0.0
            && scaled.y >= 0.0
            && scaled.x < self.grid.columns as f32
            && scaled.y < self.grid.rows as f32;
        within.then(|| scaled.y as usize * self.grid.columns as usize + scaled.x as usize)
    }

    /// The middle of a cell.
    pub fn middle(&self, cell: usize) -> Vec2 {
        let columns = self.grid.columns as usize;
        let at = Vec2::new((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5);
        Vec2::from_array(self.grid.origin) + at * self.grid.cell_size
    }

    /// Whether people can be in a cell.
    pub fn is_free(&self, cell: usize) -> bool {
        self.bits[cell] & SOLID == 0
    }

    /// Whether a person's centre can be at a point, to the size of a sample.
    pub fn has_room(&self, at: Vec2) -> bool {
        let scaled = (at - Vec2::from_array(self.grid.origin)) / self.grid.cell_size;
        let sample = |part: f32| ((part.fract() * SAMPLES as f32) as usize).min(SAMPLES - 1);
        self.cell(at).is_some_and(|cell| {
            self.is_free(cell)
                && self.samples[cell] >> (sample(scaled.y) * SAMPLES + sample(scaled.x)) & 1 == 1
        })
    }

    /// Whether a person can walk straight from one point to another, to the size of a sample.
    pub fn sees(&self, from: Vec2, to: Vec2) -> bool {
        let count = ((to - from).length() / (self.grid.cell_size / SAMPLES as f32)).ceil().max(1.0);
        (0..=count as u32).all(|i| self.has_room(from.lerp(to, i as f32 / count)))
    }
}

/// Samples inside something solid.
fn solid_samples(grid: &FlowUniforms, outlines: &[Vec<[f32; 2]>]) -> Vec<u64> {
    let is_bounds = |outline: &&Vec<[f32; 2]>| outline.len() > 2 && area(outline) < 0.0;
    let has_bounds = outlines.iter().any(|outline| is_bounds(&outline));
    let mut solid = vec![if has_bounds { u64::MAX } else { 0 }; grid.cell_count as usize];
    for outline in outlines.iter().filter(is_bounds) {
        fill(grid, outline, |samples, mask| *samples &= !mask, &mut solid);
    }
    for outline in outlines.iter().filter(|outline| outline.len() > 2 && !is_bounds(outline)) {
        fill(grid, outline, |samples, mask| *samples |= mask, &mut solid);
    }
    solid
}

fn area(outline: &[[f32; 2]]) -> f64 {
    let corner = |i: usize| Vec2::from_array(outline[i % outline.len()]).as_dvec2();
    (0..outline.len()).map(|i| (corner(i) - corner(0)).perp_dot(corner(i + 1) - corner(0))).sum()
}

/// Applies `set` to all samples inside a polygon (even-odd), row of samples by row.
fn fill(grid: &FlowUniforms, outline: &[[f32; 2]], set: impl Fn(&mut u64, u64), samples: &mut [u64]) {
    let step = f64::from(grid.cell_size) / SAMPLES as f64;
    let origin = Vec2::from_array(grid.origin).as_dvec2();
    let corner = |i: usize| (Vec2::from_array(outline[i % outline.len()]).as_dvec2() - origin) / step;
    let last = (grid.rows as usize * SAMPLES) as f64;
    // the first line of samples at or beyond a coordinate
    let line = |at: f64, most: f64| (at - 0.5).ceil().clamp(0.0, most) as usize;
    let bottom = (0..outline.len()).map(|i| corner(i).y).fold(f64::INFINITY, f64::min);
    let top = (0..outline.len()).map(|i| corner(i).y).fold(f64::NEG_INFINITY, f64::max);
    let (first_row, end_row) = (line(bottom, last), line(top, last));
    let mut crossings = vec![Vec::new(); end_row.saturating_sub(first_row)];
    for i in 0..outline.len() {
        let (a, b) = (corner(i), corner(i + 1));
        for row in line(a.y.min(b.y), last)..line(a.y.max(b.y), last) {
            let t = (row as f64 + 0.5 - a.y) / (b.y - a.y);
            crossings[row - first_row].push(a.x + t * (b.x - a.x));
        }
    }
    let widest = (grid.columns as usize * SAMPLES) as f64;
    for (offset, list) in crossings.iter_mut().enumerate() {
        list.sort_unstable_by(f64::total_cmp);
        let row = first_row + offset;
        let shift = row % SAMPLES * SAMPLES;
        let cells = &mut samples[row / SAMPLES * grid.columns as usize..];
        for pair in list.chunks_exact(2) {
            let (mut column, end) = (line(pair[0], widest), line(pair[1], widest));
            while column < end {
                let stop = end.min((column / SAMPLES + 1) * SAMPLES);
                let ones = (1_u64 << (stop - column)) - 1;
                set(&mut cells[column / SAMPLES], ones << (column % SAMPLES) << shift);
                column = stop;
            }
        }
    }
}

/// For each cell the samples with clearance (none if the cell is not free), and those that no wall touches.
fn clear_samples(
    grid: &FlowUniforms,
    outlines: &[Vec<[f32; 2]>],
    solid: &[u64],
    clearance: f64,
) -> (Vec<u64>, Vec<u64>) {
    let mut samples: Vec<u64> = solid.iter().map(|solid| !solid).collect();
    let mut open = samples.clone();
    let step = f64::from(grid.cell_size) / SAMPLES as f64;
    let slack = step * 0.708;
    let least = (clearance - slack).max(slack);
    let edges: Vec<(DVec2, DVec2)> = outlines
        .iter()
        .flat_map(|outline| {
            let corner = |i: usize| Vec2::from_array(outline[i % outline.len()]).as_dvec2();
            (0..outline.len()).map(move |i| (corner(i), corner(i + 1)))
        })
        .collect();
    let mut near = Vec::new();
    for (number, &(a, b)) in edges.iter().enumerate() {
        cells_near(grid, a, b, least, |cell| near.push((cell, number)));
    }
    near.sort_unstable();
    let origin = Vec2::from_array(grid.origin).as_dvec2();
    for walls in near.chunk_by(|a, b| a.0 == b.0) {
        let cell = walls[0].0;
        let corner = DVec2::new((cell % grid.columns as usize) as f64, (cell / grid.columns as usize) as f64);
        let corner = origin + corner * f64::from(grid.cell_size);
        let (mut clear, mut untouched) = (samples[cell], open[cell]);
        for sample in 0..SAMPLES * SAMPLES {
            if untouched >> sample & 1 == 0 {
                continue;
            }
            let offset = DVec2::new((sample % SAMPLES) as f64 + 0.5, (sample / SAMPLES) as f64 + 0.5);
            let at = corner + offset * step;
            let nearest =
                walls.iter().map(|(_, wall)| distance2(at, edges[*wall])).fold(f64::INFINITY, f64::min);
            if nearest < least * least {
                clear &= !(1 << sample);
            }
            if nearest < slack * slack {
                untouched &= !(1 << sample);
            }
        }
        samples[cell] = largest_part(clear);
        open[cell] =
            if samples[cell] == 0 { largest_part(untouched) } else { flood(samples[cell], untouched) };
    }
    (samples, open)
}

/// Calls `visit` for all cells of which some sample may be nearer than `reach` to a wall.
fn cells_near(grid: &FlowUniforms, a: DVec2, b: DVec2, reach: f64, mut visit: impl FnMut(usize)) {
    let origin = Vec2::from_array(grid.origin).as_dvec2();
    let size = f64::from(grid.cell_size);
    let (a, b, reach) = ((a - origin) / size, (b - origin) / size, reach / size);
    let clamp = |at: f64, most: u32| at.floor().clamp(0.0, f64::from(most - 1)) as usize;
    let (low, high) = if a.y <= b.y { (a, b) } else { (b, a) };
    for row in clamp(low.y - reach, grid.rows)..=clamp(high.y + reach, grid.rows) {
        // the part of the wall within reach of this row
        let at = |z: f64| {
            let t = if high.y > low.y { ((z - low.y) / (high.y - low.y)).clamp(0.0, 1.0) } else { z };
            low.x + t * (high.x - low.x)
        };
        let (from, to) = if high.y > low.y {
            (at(row as f64 - reach), at(row as f64 + 1.0 + reach))
        } else {
            (low.x, high.x)
        };
        let (from, to) = (from.min(to) - reach, from.max(to) + reach);
        for column in clamp(from, grid.columns)..=clamp(to, grid.columns) {
            visit(row * grid.columns as usize + column);
        }
    }
}

fn distance2(at: DVec2, (a, b): (DVec2, DVec2)) -> f64 {
    let along = b - a;
    let length2 = along.length_squared();
    let t = if length2 > 0.0 { ((at - a).dot(along) / length2).clamp(0.0, 1.0) } else { 0.0 };
    at.distance_squared(a + along * t)
}

/// The samples of `within` that `start` reaches, side by side.
fn flood(start: u64, within: u64) -> u64 {
    let mut reached = start & within;
    loop {
        let wider = reached
            | reached << SAMPLES
            | reached >> SAMPLES
            | (reached & !LAST_COLUMN) << 1
            | (reached & !FIRST_COLUMN) >> 1;
        let next = wider & within;
        if next == reached {
            return reached;
        }
        reached = next;
    }
}

/// The largest part of samples that hang together; of equals the first.
fn largest_part(samples: u64) -> u64 {
    let (mut left, mut best) = (samples, 0_u64);
    while left != 0 {
        let part = flood(left & left.wrapping_neg(), samples);
        if part.count_ones() > best.count_ones() {
            best = part;
        }
        left &= !part;
    }
    best
}

/// The bits of every cell.
fn links(grid: &FlowUniforms, samples: &[u64], open: &[u64]) -> Vec<u32> {
    let (columns, rows) = (grid.columns as usize, grid.rows as usize);
    let beside = |a: u64, b: u64| (a & LAST_COLUMN) >> 7 & b & FIRST_COLUMN != 0; // b lies at +x of a
    let above = |a: u64, b: u64| a >> (SAMPLES * (SAMPLES - 1)) & b & FIRST_ROW != 0; // b lies at +z of a
    let bits = |cell: usize| {
        let (x, z) = (cell % columns, cell / columns);
        let (is_free, is_tight) = (samples[cell] != 0, open[cell] != 0);
        let from = |other: usize, meets: &dyn Fn(&[u64]) -> bool| match (is_free, is_tight) {
            (true, _) => samples[other] != 0 && meets(samples),
            (false, true) => open[other] != 0 && meets(open),
            _ => true,
        };
        let mut bits = if is_free { 0 } else { SOLID };
        if x > 0 && from(cell - 1, &|masks| beside(masks[cell - 1], masks[cell])) {
            bits |= FROM_LEFT;
        }
        if x + 1 < columns && from(cell + 1, &|masks| beside(masks[cell], masks[cell + 1])) {
            bits |= FROM_RIGHT;
        }
        if z > 0 && from(cell - columns, &|masks| above(masks[cell - columns], masks[cell])) {
            bits |= FROM_BELOW;
        }
        if z + 1 < rows && from(cell + columns, &|masks| above(masks[cell], masks[cell + columns])) {
            bits |= FROM_ABOVE;
        }
        bits
    };
    (0..columns * rows).map(bits).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A 10 m room with a wall of no thickness across, and a door in it `width` wide, `shift` m along.
    fn room(width: f32, shift: f32) -> Vec<Vec<[f32; 2]>> {
        let (a, b) = (5.0 + shift - 0.5 * width, 5.0 + shift + 0.5 * width);
        let wall = 4.9 + shift * 0.3;
        vec![
            vec![[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0]],
            vec![[wall, 0.0], [wall, a]],
            vec![[wall, b], [wall, 10.0]],
        ]
    }

    /// Whether free cells lead from one point to another.
    fn leads(raster: &Raster, from: Vec2, to: Vec2) -> bool {
        let columns = raster.grid.columns as usize;
        let (start, goal) = (raster.cell(from).unwrap(), raster.cell(to).unwrap());
        assert!(raster.is_free(start) && raster.is_free(goal));
        let (mut seen, mut open) = (vec![false; raster.bits.len()], vec![start]);
        while let Some(cell) = open.pop() {
            if !std::mem::replace(&mut seen[cell], true) {
                for (bit, other) in [
                    (FROM_LEFT, cell.wrapping_sub(1)),
                    (FROM_RIGHT, cell + 1),
                    (FROM_BELOW, cell.wrapping_sub(columns)),
                    (FROM_ABOVE, cell + columns),
                ] {
                    if raster.bits[cell] & bit != 0 {
                        open.push(other);
                    }
                }
            }
        }
        seen[goal]
    }

    #[test]
    fn a_door_a_body_fits_through_is_open_wherever_it_lies_and_one_it_does_not_is_closed() {
        for size in [0.25, 0.5] {
            for i in 0..20 {
                let shift = i as f32 * 0.037;
                for (width, is_open) in [(0.51, true), (1.2, true), (0.5 - size * 0.36, false), (0.2, false)]
                {
                    let raster = Raster::new(&room(width, shift), size, 0.25);
                    let found = leads(&raster, Vec2::new(2.0, 2.0), Vec2::new(8.0, 8.0));
                    assert_eq!(found, is_open, "door {width} m, cells {size} m, shift {shift} m");
                }
            }
        }
    }

    #[test]
    fn the_free_cells_are_the_area_without_a_strip_along_the_walls() {
        let raster = Raster::new(&room(2.0, 0.0)[..1], 0.5, 0.25);
        let free = raster.bits.iter().filter(|bits| *bits & SOLID == 0).count();
        assert_eq!(free, 400, "the outermost cells reach far enough from the wall");
        assert!(raster.has_room(Vec2::new(0.3, 5.0)) && !raster.has_room(Vec2::new(0.15, 5.0)));
        let inside = vec![[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]];
        let raster = Raster::new(&[room(2.0, 0.0)[0].clone(), inside], 0.5, 0.25);
        let free = raster.bits.iter().filter(|bits| *bits & SOLID == 0).count();
        assert_eq!(free, 400 - 16);
        assert!(raster.sees(Vec2::new(1.0, 1.0), Vec2::new(9.0, 1.0)));
        assert!(!raster.sees(Vec2::new(1.0, 1.0), Vec2::new(9.0, 9.0)));
    }

    #[test]
    fn an_agent_inside_a_solid_has_a_way_out_on_every_side() {
        let inside = vec![[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]];
        let raster = Raster::new(&[room(2.0, 0.0)[0].clone(), inside], 0.5, 0.25);
        let cell = raster.cell(Vec2::new(5.1, 5.1)).unwrap();
        assert_eq!(raster.bits[cell], SOLID | FROM_LEFT | FROM_RIGHT | FROM_BELOW | FROM_ABOVE);
    }
}
