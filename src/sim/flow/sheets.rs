//! The sheets of the flow grid: that of the ground, and as many as floors lie above one another.
//!
//! Each sheet has the same cells over the same area. A cell of it has one surface: the ground, a floor, or none. Every
//! floor has a home sheet, on which all of it lies; the home of the ground is sheet 0. A sheet reaches some cells beyond
//! its own surfaces, as far as an agent can walk on. So neighbouring sheets overlap, and they are joined there.

use super::raster::Raster;
use crate::kernels::layout::FlowUniforms;
use crate::kernels::shared::climb::STEP;
use crate::kernels::shared::orca::TALL;
use crate::kernels::shared::tile::TILE;
use crate::kernels::shared::way::{FROM_ABOVE, FROM_BELOW, FROM_LEFT, FROM_RIGHT, SOLID};
use crate::scenario::{Floors, polygon};
use glam::Vec2;
use std::collections::BTreeMap;

/// Most sheets: those of a joint are bits of a word.
pub const MOST_SHEETS: usize = 32;
/// Cells by which a sheet reaches beyond its own surfaces.
const OVERLAP: usize = 3;
/// Cells around a sheet that lead back to it.
const BACK: usize = 2;
/// Length of the pieces in which edges are looked at, m.
const PIECE: f32 = 0.25;
/// Side of the cells by which floors are dealt to sheets, m.
const COARSE: f32 = 0.5;
/// Beyond an edge, m: farther than floors reach beyond theirs.
const BESIDE: f32 = 0.05;
/// A cell without a surface, the ground; others are the number of a floor plus 1.
const NONE: u32 = u32::MAX;
const GROUND: u32 = 0;

/// The walkable area on all sheets.
#[derive(Debug, Clone)]
pub struct Sheets {
    /// Cells of each sheet.
    pub rasters: Vec<Raster>,
    /// Home sheet of each floor.
    pub homes: Vec<u32>,
    /// Cells that are one place on several sheets: the cell on each of them, and the sheets as bits.
    pub joints: Vec<[u32; 2]>,
    /// Surface of each cell, by sheet; empty where there are no floors.
    surfaces: Vec<Vec<u32>>,
    floors: Floors,
}

impl Sheets {
    /// Lays the sheets over `outlines` and `floors`, whose home sheets are those of [`homes`], with cells of `size` m; see
    /// [`Raster::new`]. Densities are summed over `window` cells each way.
    pub fn new(
        outlines: &[Vec<[f32; 2]>],
        floors: &Floors,
        homes: Vec<u32>,
        [size, clearance]: [f32; 2],
        window: u32,
    ) -> Self {
        if floors.count() == 0 {
            let rasters = vec![Raster::new(outlines, size, clearance)];
            let floors = floors.clone();
            return Self { rasters, homes, joints: Vec::new(), surfaces: Vec::new(), floors };
        }
        let count = homes.iter().max().map_or(1, |home| home + 1);
        let mut grid = Raster::lay(outlines, size);
        if count > 1 {
            // densities are not summed from one sheet into the next, and no tile lies on two
            grid.rows = (grid.rows + window).next_multiple_of(TILE);
            grid.sheet_rows = grid.rows;
            grid.cell_count = grid.columns * grid.rows;
            grid.tile_rows = grid.rows / TILE;
        }
        let builder = Builder::new(floors, &homes, &grid);
        let surfaces: Vec<Vec<u32>> = (0..count).map(|sheet| builder.surfaces(sheet)).collect();
        let rasters = (0..).zip(&surfaces);
        let rasters = rasters.map(|(sheet, surfaces)| builder.raster(sheet, surfaces, outlines, clearance));
        let mut sheets =
            Self { rasters: rasters.collect(), homes, joints: Vec::new(), surfaces, floors: floors.clone() };
        sheets.joints = sheets.find_joints();
        sheets
    }

    /// The grid of one sheet.
    pub fn grid(&self) -> &FlowUniforms {
        &self.rasters[0].grid
    }

    /// Cells of one sheet.
    pub fn sheet_cells(&self) -> usize {
        self.grid().cell_count as usize
    }

    /// The sheets on which a goal at a place lies. With an elevation this is one; without, all on which an agent can stand there.
    /// None: there is nothing at that height.
    pub fn of_goal(&self, at: Vec2, elevation: Option<f32>) -> Vec<usize> {
        let home = |floor: usize| self.homes[floor] as usize;
        match elevation {
            Some(elevation) => match self.floors.on(at, elevation) {
                Some(floor) => vec![home(floor)],
                None if elevation.abs() < STEP => vec![0],
                None => Vec::new(),
            },
            None => {
                let over = (0..self.floors.count()).filter(|floor| self.floors.covers(*floor, at)).map(home);
                let mut sheets: Vec<usize> = std::iter::once(0).chain(over).collect();
                sheets.sort_unstable();
                sheets.dedup();
                sheets
            }
        }
    }

    /// Height of the surface of a cell at its middle, m.
    pub fn height(&self, sheet: usize, cell: usize) -> f32 {
        let surface = self.surfaces.get(sheet).map_or(GROUND, |surfaces| surfaces[cell]);
        height(&self.floors, surface, self.rasters[sheet].middle(cell))
    }

    /// The free cell of all sheets in which an agent at this place stands, if there is one.
    pub fn cell(&self, at: Vec2, elevation: f32) -> Option<usize> {
        let sheet = self.floors.on(at, elevation).map_or(0, |floor| self.homes[floor] as usize);
        let raster = &self.rasters[sheet];
        raster.cell(at).filter(|cell| raster.is_free(*cell)).map(|cell| sheet * self.sheet_cells() + cell)
    }

    /// From which free cells of all sheets there is a way to some cells.
    pub fn reached_from(&self, seeds: impl Iterator<Item = usize>) -> Vec<bool> {
        let (cells, columns) = (self.sheet_cells(), self.grid().columns as usize);
        let joints: BTreeMap<u32, Vec<u32>> =
            self.joints.iter().fold(BTreeMap::new(), |mut all, [cell, mask]| {
                all.entry(*cell).or_insert_with(Vec::new).push(*mask);
                all
            });
        let mut reached = vec![false; cells * self.rasters.len()];
        let mut open: Vec<usize> = seeds.collect();
        while let Some(at) = open.pop() {
            let (sheet, cell) = (at / cells, at % cells);
            let bits = self.rasters[sheet].bits[cell];
            if bits & SOLID != 0 || std::mem::replace(&mut reached[at], true) {
                continue;
            }
            for (bit, beside) in [
                (FROM_LEFT, at.wrapping_sub(1)),
                (FROM_RIGHT, at + 1),
                (FROM_BELOW, at.wrapping_sub(columns)),
                (FROM_ABOVE, at + columns),
            ] {
                if bits & bit != 0 {
                    open.push(beside);
                }
            }
            let masks = u32::try_from(cell).ok().and_then(|cell| joints.get(&cell));
            for mask in masks.into_iter().flatten().filter(|mask| *mask >> sheet & 1 != 0) {
                open.extend(
                    (0..self.rasters.len()).filter(|other| mask >> other & 1 != 0).map(|o| o * cells + cell),
                );
            }
        }
        reached
    }

    /// Cells in which several sheets have the same surface, and people fit.
    fn find_joints(&self) -> Vec<[u32; 2]> {
        let count = self.rasters.len();
        let mut joints = Vec::new();
        for cell in 0..self.sheet_cells() {
            let surface = |sheet: usize| {
                Some(self.surfaces[sheet][cell]).filter(|s| *s != NONE && self.rasters[sheet].is_free(cell))
            };
            let mut done = 0_u32;
            for sheet in (0..count).filter(|sheet| surface(*sheet).is_some()) {
                let same = (sheet..count).filter(|other| surface(*other) == surface(sheet));
                let mask = same.fold(0_u32, |mask, other| mask | 1 << other);
                if done >> sheet & 1 == 0 && mask.count_ones() > 1 {
                    joints.push([cell as u32, mask]);
                }
                done |= mask;
            }
        }
        joints
    }
}

/// The home sheet of each floor: 0 if it is nowhere more than a step above or below the ground, else the first on which
/// nothing lies above or below it, or so near beside it that the two could be taken for one another.
///
/// # Errors
/// [`crate::sim::Error::Sheets`] when too many floors lie above one another.
pub fn homes(floors: &Floors) -> Result<Vec<u32>, crate::sim::Error> {
    let mut sheets: Vec<BTreeMap<[i32; 2], Vec<usize>>> = Vec::new();
    let mut homes = Vec::with_capacity(floors.count());
    for floor in 0..floors.count() {
        let outline = floors.outline(floor);
        if outline.iter().all(|corner| floors.level(floor, *corner).abs() < STEP) {
            homes.push(0);
            continue;
        }
        let low = outline.iter().copied().fold(Vec2::MAX, Vec2::min) - 2.0 * COARSE;
        let high = outline.iter().copied().fold(Vec2::MIN, Vec2::max) + 2.0 * COARSE;
        let [[x0, z0], [x1, z1]] = [low, high].map(|at| (at / COARSE).floor().as_ivec2().to_array());
        let middle = |cell: [i32; 2]| (Vec2::new(cell[0] as f32, cell[1] as f32) + 0.5) * COARSE;
        let cells: Vec<[i32; 2]> = (z0..=z1)
            .flat_map(|z| (x0..=x1).map(move |x| [x, z]))
            .filter(|cell| floors.is_within(floor, middle(*cell), 1.5 * COARSE))
            .collect();
        let agrees = |other: &usize, cell: [i32; 2]| {
            (floors.level(floor, middle(cell)) - floors.level(*other, middle(cell))).abs() < STEP
        };
        let fits = |sheet: &BTreeMap<[i32; 2], Vec<usize>>| {
            cells.iter().all(|c| sheet.get(c).is_none_or(|others| others.iter().all(|o| agrees(o, *c))))
        };
        let found = sheets.iter().position(fits).unwrap_or(sheets.len());
        if found + 1 >= MOST_SHEETS {
            return Err(crate::sim::Error::Sheets { most: MOST_SHEETS - 1 });
        }
        if found == sheets.len() {
            sheets.push(BTreeMap::new());
        }
        for cell in cells {
            sheets[found].entry(cell).or_default().push(floor);
        }
        homes.push(found as u32 + 1);
    }
    Ok(homes)
}

/// Height of a surface, m.
fn height(floors: &Floors, surface: u32, at: Vec2) -> f32 {
    if surface == GROUND || surface == NONE { 0.0 } else { floors.level(surface as usize - 1, at) }
}

/// What all sheets are made from.
struct Builder<'a> {
    floors: &'a Floors,
    homes: &'a [u32],
    grid: FlowUniforms,
    /// Floors above or below the middles of cells.
    covering: BTreeMap<usize, Vec<usize>>,
    /// Pieces of edges that no agent can cross: from, to, floor.
    drops: Vec<(Vec2, Vec2, usize)>,
}

impl<'a> Builder<'a> {
    fn new(floors: &'a Floors, homes: &'a [u32], grid: &FlowUniforms) -> Self {
        let mut builder = Self { floors, homes, grid: *grid, covering: BTreeMap::new(), drops: Vec::new() };
        for floor in 0..floors.count() {
            let outline = floors.outline(floor);
            let low = outline.iter().copied().fold(Vec2::MAX, Vec2::min);
            let high = outline.iter().copied().fold(Vec2::MIN, Vec2::max);
            let ([x0, z0], [x1, z1]) = (builder.index(low), builder.index(high));
            for cell in (z0..=z1).flat_map(|z| (x0..=x1).map(move |x| (x, z))) {
                let cell = cell.1 * grid.columns as usize + cell.0;
                if floors.covers(floor, builder.middle(cell)) {
                    builder.covering.entry(cell).or_default().push(floor);
                }
            }
            for (a, b) in polygon::edges(&outline) {
                let outward = -(b - a).normalize_or_zero().perp();
                for (from, to) in pieces(a, b) {
                    let at = (from + to) * 0.5;
                    let level = floors.level(floor, at);
                    if level.abs() >= STEP && floors.on(at + outward * BESIDE, level).is_none() {
                        builder.drops.push((from, to, floor));
                    }
                }
            }
        }
        builder
    }

    /// Column and row of the cell of a point, or of the nearest.
    fn index(&self, at: Vec2) -> [usize; 2] {
        let scaled = (at - Vec2::from_array(self.grid.origin)) / self.grid.cell_size;
        let most = Vec2::new((self.grid.columns - 1) as f32, (self.grid.rows - 1) as f32);
        scaled.floor().clamp(Vec2::ZERO, most).to_array().map(|part| part as usize)
    }

    fn middle(&self, cell: usize) -> Vec2 {
        let columns = self.grid.columns as usize;
        let at = Vec2::new((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5);
        Vec2::from_array(self.grid.origin) + at * self.grid.cell_size
    }

    /// The cell of a point and those around it.
    fn around(&self, at: Vec2) -> impl Iterator<Item = usize> {
        let [x, z] = self.index(at);
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        (z.saturating_sub(1)..=(z + 1).min(rows - 1))
            .flat_map(move |z| (x.saturating_sub(1)..=(x + 1).min(columns - 1)).map(move |x| z * columns + x))
    }

    /// The cells beside a cell.
    fn beside(&self, cell: usize) -> impl Iterator<Item = usize> {
        let (columns, rows) = (self.grid.columns as usize, self.grid.rows as usize);
        let (x, z) = (cell % columns, cell / columns);
        [
            (x > 0).then(|| cell - 1),
            (x + 1 < columns).then(|| cell + 1),
            (z > 0).then(|| cell - columns),
            (z + 1 < rows).then(|| cell + columns),
        ]
        .into_iter()
        .flatten()
    }

    /// The floor on which an agent stands in the middle of a cell, from the height it stood at before.
    fn stand(&self, cell: usize, present: f32) -> Option<usize> {
        let at = self.middle(cell);
        let off = |floor: &usize| (self.floors.level(*floor, at) - present).abs();
        let over = self.covering.get(&cell)?.iter().copied();
        over.filter(|floor| off(floor) < STEP).min_by(|a, b| off(a).total_cmp(&off(b)))
    }

    /// Whether people fit on the ground of a cell, below floors.
    fn has_headroom(&self, cell: usize) -> bool {
        let at = self.middle(cell);
        let low = |floor: &usize| (0.0..TALL).contains(&self.floors.level(*floor, at));
        !self.covering.get(&cell).is_some_and(|over| over.iter().any(low))
    }

    /// The surfaces of a sheet.
    fn surfaces(&self, sheet: u32) -> Vec<u32> {
        let cells = 0..self.grid.cell_count as usize;
        let mut surfaces: Vec<u32> = if sheet == 0 {
            cells
                .map(|cell| match self.stand(cell, 0.0) {
                    Some(floor) => floor as u32 + 1,
                    None if self.has_headroom(cell) => GROUND,
                    None => NONE,
                })
                .collect()
        } else {
            cells
                .map(|cell| {
                    let over = self.covering.get(&cell).into_iter().flatten();
                    over.copied()
                        .find(|floor| self.homes[*floor] == sheet)
                        .map_or(NONE, |floor| floor as u32 + 1)
                })
                .collect()
        };
        for _ in 0..OVERLAP {
            let empty = (0..surfaces.len()).filter(|cell| surfaces[*cell] == NONE);
            let fresh: Vec<(usize, u32)> =
                empty.filter_map(|cell| Some((cell, self.walked_on_to(cell, &surfaces)?))).collect();
            fresh.into_iter().for_each(|(cell, surface)| surfaces[cell] = surface);
        }
        surfaces
    }

    /// The surface of an empty cell onto which one walks from a cell beside it.
    fn walked_on_to(&self, cell: usize, surfaces: &[u32]) -> Option<u32> {
        self.beside(cell).filter(|from| surfaces[*from] != NONE).find_map(|from| {
            let border = (self.middle(cell) + self.middle(from)) * 0.5;
            let present = height(self.floors, surfaces[from], border);
            match self.stand(cell, present) {
                Some(floor) => Some(floor as u32 + 1),
                None => (present.abs() < STEP && self.has_headroom(cell)).then_some(GROUND),
            }
        })
    }

    fn raster(&self, sheet: u32, surfaces: &[u32], outlines: &[Vec<[f32; 2]>], clearance: f32) -> Raster {
        let mut walls = outlines.to_vec();
        walls.extend(self.walls(surfaces).map(|(a, b)| vec![a.to_array(), b.to_array()]));
        let solids: Vec<_> = self.floors.raised.iter().filter(|solid| solid.outline.len() > 2).collect();
        let is_filled = |cell: usize| {
            let at = self.middle(cell);
            let height = height(self.floors, surfaces[cell], at);
            solids
                .iter()
                .any(|s| height + TALL > s.low && height < s.high && polygon::contains(&s.outline, at))
        };
        let keeps = |cell: usize| surfaces[cell] != NONE && !is_filled(cell);
        let links = |cell: usize, other: usize| {
            let border = (self.middle(cell) + self.middle(other)) * 0.5;
            let [a, b] = [cell, other].map(|cell| height(self.floors, surfaces[cell], border));
            surfaces[cell] == surfaces[other] || (a - b).abs() < STEP
        };
        let mut raster = Raster::of_sheet(&self.grid, &walls, clearance, keeps, links);
        if sheet > 0 {
            self.forget_far(surfaces, &mut raster);
        }
        raster
    }

    /// Takes the ways back from cells far from all surfaces of a sheet: no agent is there.
    fn forget_far(&self, surfaces: &[u32], raster: &mut Raster) {
        let mut near: Vec<bool> = surfaces.iter().map(|surface| *surface != NONE).collect();
        for _ in 0..BACK {
            let far = (0..near.len()).filter(|cell| !near[*cell]);
            let fresh: Vec<usize> = far.filter(|cell| self.beside(*cell).any(|other| near[other])).collect();
            fresh.into_iter().for_each(|cell| near[cell] = true);
        }
        for (bits, _) in
            raster.bits.iter_mut().zip(&near).filter(|(bits, near)| !**near && **bits & SOLID != 0)
        {
            *bits = SOLID;
        }
    }

    /// Pieces of walls on a sheet: edges to fall from, and what stands at some heights only.
    fn walls(&self, surfaces: &[u32]) -> impl Iterator<Item = (Vec2, Vec2)> {
        let drops = self.drops.iter().filter(|(from, to, floor)| {
            self.around((*from + *to) * 0.5).any(|cell| surfaces[cell] == *floor as u32 + 1)
        });
        let raised = self.floors.raised.iter().flat_map(move |solid| {
            let edges = if solid.outline.len() == 2 { 1 } else { solid.outline.len() };
            let pieces = polygon::edges(&solid.outline).take(edges).flat_map(|(a, b)| pieces(a, b));
            let stands = |(from, to): &(Vec2, Vec2)| {
                let at = (*from + *to) * 0.5;
                self.around(at).filter(|cell| surfaces[*cell] != NONE).any(|cell| {
                    let height = height(self.floors, surfaces[cell], at);
                    height + TALL > solid.low && height < solid.high
                })
            };
            pieces.filter(stands).collect::<Vec<_>>()
        });
        drops.map(|(from, to, _)| (*from, *to)).chain(raised)
    }
}

/// An edge in pieces.
fn pieces(a: Vec2, b: Vec2) -> impl Iterator<Item = (Vec2, Vec2)> {
    let count = (a.distance(b) / PIECE).ceil().max(1.0) as u32;
    (0..count).map(move |i| (a.lerp(b, i as f32 / count as f32), a.lerp(b, (i + 1) as f32 / count as f32)))
}
