//! How far points and ways are from anything solid, for any number of obstacles.

use crate::scenario::polygon;
use glam::{IVec2, Vec2};

/// Least cell side, m.
const CELL: f32 = 8.0;
/// Most cells; beyond it cells grow.
const MAX_CELLS: f32 = 1_000_000.0;

/// Obstacles and bounds in a uniform grid of cells.
#[derive(Debug)]
pub struct Clearance {
    bounds: Vec<Vec2>,
    polygons: Vec<Vec<Vec2>>,
    edges: Vec<(Vec2, Vec2)>,
    origin: Vec2,
    cell: f32,
    size: IVec2,
    /// Start of each cell's list in `edge_list` and `polygon_list`; one longer than the cells.
    edge_start: Vec<u32>,
    edge_list: Vec<u32>,
    polygon_start: Vec<u32>,
    polygon_list: Vec<u32>,
}

impl Clearance {
    /// Indexes the bounds and the solid polygons.
    pub fn new(bounds: &[Vec2], polygons: &[Vec<Vec2>]) -> Self {
        let corners = || bounds.iter().chain(polygons.iter().flatten()).copied();
        let low = corners().fold(Vec2::splat(f32::INFINITY), Vec2::min);
        let high = corners().fold(Vec2::splat(f32::NEG_INFINITY), Vec2::max);
        let extent = (high - low).max(Vec2::ONE);
        let extent = if extent.is_finite() { extent } else { Vec2::ONE };
        let cell = CELL.max((extent.x / MAX_CELLS.sqrt()).max(extent.y / MAX_CELLS.sqrt()));
        let size = (extent / cell).floor().as_ivec2() + IVec2::ONE;
        let edges: Vec<(Vec2, Vec2)> =
            polygon::edges(bounds).chain(polygons.iter().flat_map(|p| polygon::edges(p))).collect();
        let mut index = Self {
            bounds: bounds.to_vec(),
            polygons: polygons.to_vec(),
            edges: Vec::new(),
            origin: if low.is_finite() { low } else { Vec2::ZERO },
            cell,
            size,
            edge_start: Vec::new(),
            edge_list: Vec::new(),
            polygon_start: Vec::new(),
            polygon_list: Vec::new(),
        };
        (index.edge_start, index.edge_list) = index.bin(edges.len(), |i, visit| {
            let (a, b) = edges[i];
            index.cells_along(a, b, 0.0, visit);
        });
        (index.polygon_start, index.polygon_list) = index.bin(polygons.len(), |i, visit| {
            let low = polygons[i].iter().copied().fold(Vec2::splat(f32::INFINITY), Vec2::min);
            let high = polygons[i].iter().copied().fold(Vec2::splat(f32::NEG_INFINITY), Vec2::max);
            index.cells_in(low, high, visit);
        });
        index.edges = edges;
        index
    }

    /// Counting sort of items into the cells they touch.
    fn bin(&self, count: usize, cells: impl Fn(usize, &mut dyn FnMut(usize))) -> (Vec<u32>, Vec<u32>) {
        let cell_count = usize::try_from(self.size.x * self.size.y).unwrap_or(0);
        let mut start = vec![0_u32; cell_count + 1];
        for item in 0..count {
            cells(item, &mut |cell| start[cell + 1] += 1);
        }
        for cell in 0..cell_count {
            start[cell + 1] += start[cell];
        }
        let mut next = start.clone();
        let mut list = vec![0_u32; start[cell_count] as usize];
        for item in 0..count {
            let id = u32::try_from(item).unwrap_or(u32::MAX);
            cells(item, &mut |cell| {
                list[next[cell] as usize] = id;
                next[cell] += 1;
            });
        }
        (start, list)
    }

    fn cell_of(&self, point: Vec2) -> IVec2 {
        ((point - self.origin) / self.cell).floor().as_ivec2().clamp(IVec2::ZERO, self.size - IVec2::ONE)
    }

    fn index_of(&self, cell: IVec2) -> usize {
        usize::try_from(cell.y * self.size.x + cell.x).unwrap_or(0)
    }

    fn cells_in(&self, low: Vec2, high: Vec2, visit: &mut dyn FnMut(usize)) {
        let (first, last) = (self.cell_of(low), self.cell_of(high));
        for z in first.y..=last.y {
            for x in first.x..=last.x {
                visit(self.index_of(IVec2::new(x, z)));
            }
        }
    }

    /// Visits the cells that a segment, widened by `reach`, may touch: column by column of its longer axis.
    fn cells_along(&self, a: Vec2, b: Vec2, reach: f32, visit: &mut dyn FnMut(usize)) {
        let along = b - a;
        if along.length() <= self.cell {
            self.cells_in(a.min(b) - reach, a.max(b) + reach, visit);
            return;
        }
        let by_x = along.x.abs() >= along.y.abs();
        let swap = |v: Vec2| if by_x { v } else { Vec2::new(v.y, v.x) };
        let (a, b) = if swap(along).x >= 0.0 { (swap(a), swap(b)) } else { (swap(b), swap(a)) };
        let slope = (b.y - a.y) / (b.x - a.x);
        let (first, last) = (self.cell_of(swap(a - reach)), self.cell_of(swap(b + reach)));
        let (first, last) = if by_x { (first.x, last.x) } else { (first.y, last.y) };
        let origin = swap(self.origin).x;
        #[allow(clippy::cast_precision_loss, reason = "cell numbers are below 2^24")]
        for column in first..=last {
            let left = (origin + column as f32 * self.cell - reach).clamp(a.x, b.x);
            let right = (origin + (column + 1) as f32 * self.cell + reach).clamp(a.x, b.x);
            let (y0, y1) = (a.y + (left - a.x) * slope, a.y + (right - a.x) * slope);
            let low = self.cell_of(swap(Vec2::new(0.0, y0.min(y1) - reach)));
            let high = self.cell_of(swap(Vec2::new(0.0, y0.max(y1) + reach)));
            let (low, high) = if by_x { (low.y, high.y) } else { (low.x, high.x) };
            for row in low..=high {
                let cell = if by_x { IVec2::new(column, row) } else { IVec2::new(row, column) };
                visit(self.index_of(cell));
            }
        }
    }

    /// Whether the point is inside the bounds and outside every solid polygon.
    pub fn walkable(&self, point: Vec2) -> bool {
        if !polygon::contains(&self.bounds, point) {
            return false;
        }
        let cell = self.index_of(self.cell_of(point));
        let range = self.polygon_start[cell] as usize..self.polygon_start[cell + 1] as usize;
        self.polygon_list[range].iter().all(|&id| !polygon::contains(&self.polygons[id as usize], point))
    }

    /// Distance from a segment to the nearest obstacle or bounds edge, m, no more than `reach`.
    /// Says nothing about which side of the edges it lies on: see [`Clearance::walkable`].
    pub fn distance(&self, a: Vec2, b: Vec2, reach: f32) -> f32 {
        let mut nearest = reach;
        self.cells_along(a, b, reach, &mut |cell| {
            let range = self.edge_start[cell] as usize..self.edge_start[cell + 1] as usize;
            for &id in &self.edge_list[range] {
                let (c, d) = self.edges[id as usize];
                let (low, high) = (a.min(b) - nearest, a.max(b) + nearest);
                if c.max(d).cmpge(low).all() && c.min(d).cmple(high).all() {
                    nearest = nearest.min(polygon::segment_distance(a, b, c, d));
                }
            }
        });
        nearest
    }

    /// Whether a disc of `radius` can be at the point.
    pub fn admits(&self, point: Vec2, radius: f32) -> bool {
        self.walkable(point) && self.distance(point, point, radius) >= radius
    }

    /// Whether a disc of `radius` can walk the whole segment.
    pub fn passes(&self, a: Vec2, b: Vec2, radius: f32) -> bool {
        self.walkable(a) && self.distance(a, b, radius) >= radius
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::random::{Purpose, range};

    #[test]
    fn the_grid_answers_as_a_walk_over_every_edge_does() {
        let draw = |i: u32, k: u32| range(3, i, Purpose::Scenery, k, -200.0, 200.0);
        let bounds = polygon::oriented(polygon::rectangle(Vec2::ZERO, Vec2::splat(420.0), 0.0), false);
        let solids: Vec<Vec<Vec2>> = (0..60)
            .map(|i| polygon::rectangle(Vec2::new(draw(i, 0), draw(i, 1)), Vec2::new(30.0, 3.0), draw(i, 2)))
            .collect();
        let index = Clearance::new(&bounds, &solids);
        for i in 0..6000 {
            let a = Vec2::new(draw(i, 3), draw(i, 4));
            let b = if i % 3 == 0 { a } else { Vec2::new(draw(i, 5), draw(i, 6)) };
            let all = solids.iter().chain([&bounds]).flat_map(|p| polygon::edges(p));
            let slow = all.map(|(c, d)| polygon::segment_distance(a, b, c, d)).fold(7.0, f32::min);
            assert!((index.distance(a, b, 7.0) - slow).abs() < 1e-5, "query {i}");
            assert_eq!(index.walkable(a), !solids.iter().any(|p| polygon::contains(p, a)), "point {i}");
        }
        assert!(!index.walkable(Vec2::splat(250.0)), "outside the bounds");
    }

    #[test]
    fn nothing_is_walkable_without_bounds() {
        assert!(!Clearance::new(&[], &[]).walkable(Vec2::ZERO));
    }
}
