//! The outline of overlapping or adjacent polygons.
//!
//! Corners are rounded to a tenth of a millimetre. Edges are cut where they cross and where a corner lies within the
//! tolerance of them; of the pieces those are kept that have the area on one side only; they are put together to rings.
//!
//! `i_overlay`, which cuts the areas that are written (`src/export/area.rs`), is exact: it has no tolerance, so plans whose
//! rooms leave a gap of half a millimetre fall apart, and it rounds crossings otherwise. Corners would change, and with them
//! the hashes of crowds. It stands in where the pieces here do not close,
//! as happens where many edges cross at small angles.

use crate::scenario::file::MAX_COORDINATE;
use glam::{DVec2, I64Vec2, Vec2};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::i_float::int::point::IntPoint;
use std::collections::{BTreeMap, BTreeSet};

/// Corners and edges that come this near to each other count as meeting, m.
const TOLERANCE: f64 = 1e-3;
/// Units of the rounded corners in a metre.
const UNITS: f64 = 1e4;
/// Most pieces of edges.
const MOST_PIECES: usize = 4_000_000;

/// Polygons that cannot be united.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum UnionError {
    /// A corner is too far from the origin.
    #[error(
        "has a corner at ({}, {}) m; corners must be within {most} m of the origin", .corner[0], .corner[1]
    )]
    Far {
        /// The corner, m.
        corner: [f64; 2],
        /// Farthest coordinate, m.
        most: f64,
    },
    /// Too many edges cross.
    #[error("has more than {most} crossing edges")]
    Crossings {
        /// How many may.
        most: usize,
    },
}

/// A polygon: rings, outer and holes (even-odd).
pub(crate) type Face = Vec<Vec<DVec2>>;

/// The outlines of what lies inside a polygon that crosses or touches itself (even-odd): those counter-clockwise are
/// solid inside, those clockwise are holes in them. In the plane of the polygon, m.
///
/// # Errors
/// When there are too many edges.
pub(crate) fn pieces(polygon: &[Vec2]) -> Result<Vec<Vec<Vec2>>, UnionError> {
    let ring = polygon.iter().map(|corner| corner.as_dvec2()).collect();
    let rings = union(&[vec![ring]])?;
    Ok(rings.into_iter().map(|ring| ring.iter().map(|corner| corner.as_vec2()).collect()).collect())
}

/// Rings of the union, outer ones and holes, in no particular order.
///
/// # Errors
/// When there are too many edges, or a corner is farther from the origin than [`MAX_COORDINATE`].
pub(crate) fn union(faces: &[Face]) -> Result<Vec<Vec<DVec2>>, UnionError> {
    let most = f64::from(MAX_COORDINATE);
    let is_far = |at: &&DVec2| !(at.x.abs() <= most && at.y.abs() <= most);
    if let Some(DVec2 { x, y }) = faces.iter().flatten().flatten().find(is_far) {
        return Err(UnionError::Far { corner: [*x, *y], most });
    }
    let round = |at: &DVec2| (*at * UNITS).round().as_i64vec2();
    let mut edges = BTreeSet::new();
    for ring in faces.iter().flatten() {
        let corners: Vec<I64Vec2> = ring.iter().map(round).collect();
        for (a, b) in corners.iter().zip(corners.iter().cycle().skip(1)) {
            if a != b {
                edges.insert(ordered(*a, *b));
            }
        }
    }
    let edges: Vec<Edge> = edges.into_iter().collect();
    let pieces = cut(&weld(&edges))?;
    let index = FaceIndex::new(faces);
    let mut next: BTreeMap<[i64; 2], Vec<I64Vec2>> = BTreeMap::new();
    for &(a, b) in &pieces {
        let (a, b) = (I64Vec2::from_array(a), I64Vec2::from_array(b));
        let (low, high) = (a.as_dvec2() / UNITS, b.as_dvec2() / UNITS);
        let aside = (high - low).perp().normalize_or_zero() * (2.0 * TOLERANCE);
        let middle = (low + high) * 0.5;
        match (index.contains(middle + aside), index.contains(middle - aside)) {
            (true, false) => next.entry(a.to_array()).or_default().push(b), // the area lies to the left
            (false, true) => next.entry(b.to_array()).or_default().push(a),
            _ => {}
        }
    }
    let (own, is_whole) = rings(next);
    if is_whole {
        return Ok(own);
    }
    // Where edges cross at a small angle, the sides of a piece can be judged wrongly: a chain of pieces stays open.
    let ends = edges.iter().map(|(a, b)| [*a, *b].map(|at| I64Vec2::from_array(at).as_dvec2() / UNITS));
    let seams = TOLERANCE * ends.map(|[a, b]| a.distance(b)).sum::<f64>();
    let exact = exact(faces);
    Ok(if (area(&own) - area(&exact)).abs() > seams { exact } else { own })
}

/// Area inside rings, holes taken off, m².
fn area(rings: &[Vec<DVec2>]) -> f64 {
    let twice = |ring: &Vec<DVec2>| {
        let next = ring.iter().cycle().skip(1);
        ring.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum::<f64>()
    };
    0.5 * rings.iter().map(twice).sum::<f64>()
}

/// The rings of the largest connected part of an area that is left without these faces; none where nothing is left. The
/// area's rings are those of [`union`].
pub(crate) fn largest_without(rings: &[Vec<DVec2>], faces: &[Face]) -> Vec<Vec<DVec2>> {
    let mut all = Overlay::new(64);
    for (rings, side) in [(rings, ShapeType::Subject), (&exact(faces), ShapeType::Clip)] {
        for ring in rings {
            all.add_contour(&ring.iter().map(unit).collect::<Vec<_>>(), side);
        }
    }
    let shapes = all.overlay(OverlayRule::Difference, FillRule::NonZero);
    let parts = shapes.iter().map(|shape| shape.iter().map(|ring| metres(ring)).collect::<Vec<_>>());
    parts.max_by(|a, b| area(a).total_cmp(&area(b))).unwrap_or_default()
}

fn unit(at: &DVec2) -> IntPoint<i64> {
    let at = (*at * UNITS).round().as_i64vec2();
    IntPoint::new(at.x, at.y)
}

fn metres(ring: &[IntPoint<i64>]) -> Vec<DVec2> {
    ring.iter().map(|at| I64Vec2::new(at.x, at.y).as_dvec2() / UNITS).collect()
}

/// The union without a tolerance: outer rings counter-clockwise, holes clockwise.
fn exact(faces: &[Face]) -> Vec<Vec<DVec2>> {
    let mut all = Overlay::new(64);
    for face in faces {
        let mut own = Overlay::new(8);
        for ring in face {
            own.add_contour(&ring.iter().map(unit).collect::<Vec<_>>(), ShapeType::Subject);
        }
        for ring in own.overlay(OverlayRule::Subject, FillRule::EvenOdd).iter().flatten() {
            all.add_contour(ring, ShapeType::Subject);
        }
    }
    let shapes = all.overlay(OverlayRule::Subject, FillRule::NonZero);
    shapes.iter().flatten().map(|ring| metres(ring)).collect()
}

type Edge = ([i64; 2], [i64; 2]);

fn ordered(a: I64Vec2, b: I64Vec2) -> Edge {
    let (a, b) = (a.to_array(), b.to_array());
    if a < b { (a, b) } else { (b, a) }
}

/// Moves corners that nearly meet to the first of them.
fn weld(edges: &[Edge]) -> Vec<Edge> {
    #[allow(clippy::cast_possible_truncation, reason = "a small constant")]
    let reach = (TOLERANCE * UNITS) as i64;
    let mut cells: BTreeMap<[i64; 2], Vec<[i64; 2]>> = BTreeMap::new();
    let mut place = |corner: [i64; 2]| {
        let cell = corner.map(|part| part.div_euclid(reach));
        for x in cell[0] - 1..=cell[0] + 1 {
            for y in cell[1] - 1..=cell[1] + 1 {
                let near = cells.get(&[x, y]).into_iter().flatten();
                let is_near =
                    |c: &&[i64; 2]| (c[0] - corner[0]).pow(2) + (c[1] - corner[1]).pow(2) <= reach * reach;
                if let Some(found) = near.copied().collect::<Vec<_>>().iter().find(is_near) {
                    return *found;
                }
            }
        }
        cells.entry(cell).or_default().push(corner);
        corner
    };
    let mut welded = BTreeSet::new();
    for (a, b) in edges {
        let (a, b) = (I64Vec2::from_array(place(*a)), I64Vec2::from_array(place(*b)));
        if a != b {
            welded.insert(ordered(a, b));
        }
    }
    welded.into_iter().collect()
}

/// Cuts edges where they cross and where corners lie on them.
fn cut(edges: &[Edge]) -> Result<BTreeSet<Edge>, UnionError> {
    let grid = Buckets::new(edges.iter().map(|(a, b)| {
        let (a, b) = (I64Vec2::from_array(*a).as_dvec2(), I64Vec2::from_array(*b).as_dvec2());
        (a.min(b) / UNITS, a.max(b) / UNITS)
    }));
    let mut cuts: Vec<Vec<I64Vec2>> =
        edges.iter().map(|(a, b)| vec![I64Vec2::from_array(*a), I64Vec2::from_array(*b)]).collect();
    let mut total = 0;
    for list in grid.lists.values() {
        for (n, &i) in list.iter().enumerate() {
            for &j in &list[..n] {
                total += meet(edges, &mut cuts, i as usize, j as usize);
                if total > MOST_PIECES {
                    return Err(UnionError::Crossings { most: MOST_PIECES });
                }
            }
        }
    }
    let mut pieces = BTreeSet::new();
    for (&(a, b), list) in edges.iter().zip(&mut cuts) {
        let along = I64Vec2::from_array(b) - I64Vec2::from_array(a);
        list.sort_unstable_by_key(|at| {
            let from = *at - I64Vec2::from_array(a);
            (
                i128::from(from.x) * i128::from(along.x) + i128::from(from.y) * i128::from(along.y),
                at.to_array(),
            )
        });
        list.dedup();
        pieces.extend(list.windows(2).map(|pair| ordered(pair[0], pair[1])));
    }
    Ok(pieces)
}

/// Notes where two edges meet; how many cuts that makes.
fn meet(edges: &[Edge], cuts: &mut [Vec<I64Vec2>], i: usize, j: usize) -> usize {
    let ends = |k: usize| [I64Vec2::from_array(edges[k].0), I64Vec2::from_array(edges[k].1)];
    let (first, second) = (ends(i), ends(j));
    let mut made = 0;
    let mut on_an_edge = false;
    for (k, [a, b], others) in [(i, first, second), (j, second, first)] {
        for at in others {
            if at == a || at == b {
                on_an_edge = true;
            } else if is_on(at, a, b) {
                on_an_edge = true;
                if !cuts[k].contains(&at) {
                    cuts[k].push(at);
                    made += 1;
                }
            }
        }
    }
    if on_an_edge {
        return made;
    }
    let [a, b] = first.map(I64Vec2::as_dvec2);
    let [c, d] = second.map(I64Vec2::as_dvec2);
    let (u, v) = (b - a, d - c);
    let cross = u.perp_dot(v);
    if cross != 0.0 {
        let (s, t) = ((c - a).perp_dot(v) / cross, (c - a).perp_dot(u) / cross);
        if s > 0.0 && s < 1.0 && t > 0.0 && t < 1.0 {
            let at = (a + u * s).round().as_i64vec2();
            for k in [i, j] {
                if !cuts[k].contains(&at) {
                    cuts[k].push(at);
                    made += 1;
                }
            }
        }
    }
    made
}

/// Whether a corner lies on an edge, between its ends, to the tolerance.
fn is_on(at: I64Vec2, a: I64Vec2, b: I64Vec2) -> bool {
    let (along, from) = ((b - a).as_dvec2(), (at - a).as_dvec2());
    let length2 = along.length_squared();
    let t = from.dot(along) / length2;
    t > 0.0 && t < 1.0 && from.perp_dot(along).powi(2) <= (TOLERANCE * UNITS).powi(2) * length2
}

/// Directed edges with the area to their left, put together, and whether all of them close. Where several go on, the one
/// that turns left most.
fn rings(mut next: BTreeMap<[i64; 2], Vec<I64Vec2>>) -> (Vec<Vec<DVec2>>, bool) {
    let (mut all, mut is_whole) = (Vec::new(), true);
    while let Some((&start, _)) = next.iter().find(|(_, ends)| !ends.is_empty()) {
        let start = I64Vec2::from_array(start);
        let (mut ring, mut at, mut came) = (Vec::new(), start, DVec2::ZERO);
        while let Some(ends) = next.get_mut(&at.to_array()) {
            let turn = |to: &I64Vec2| {
                let go = (*to - at).as_dvec2();
                libm::atan2(came.perp_dot(go), came.dot(go))
            };
            let Some(best) = (0..ends.len()).max_by(|a, b| turn(&ends[*a]).total_cmp(&turn(&ends[*b])))
            else {
                break;
            };
            let to = ends.swap_remove(best);
            if ends.is_empty() {
                next.remove(&at.to_array());
            }
            ring.push(at);
            came = (to - at).as_dvec2();
            at = to;
            if at == start {
                break;
            }
        }
        is_whole &= at == start;
        if at == start && ring.len() > 2 {
            all.push(straightened(&ring));
        }
    }
    (all, is_whole)
}

/// Without corners in straight lines, m.
fn straightened(ring: &[I64Vec2]) -> Vec<DVec2> {
    let mut kept: Vec<I64Vec2> = Vec::with_capacity(ring.len());
    for (i, &at) in ring.iter().enumerate() {
        let before = kept.last().copied().unwrap_or(ring[ring.len() - 1]);
        let after = ring[(i + 1) % ring.len()];
        if !is_on(at, before, after) {
            kept.push(at);
        }
    }
    kept.iter().map(|at| at.as_dvec2() / UNITS).collect()
}

/// Things by the cells that their boxes touch.
struct Buckets {
    low: DVec2,
    cell: f64,
    lists: BTreeMap<[i64; 2], Vec<u32>>,
}

impl Buckets {
    fn new(boxes: impl Iterator<Item = (DVec2, DVec2)>) -> Self {
        let boxes: Vec<(DVec2, DVec2)> = boxes.collect();
        let low = boxes.iter().fold(DVec2::INFINITY, |low, b| low.min(b.0));
        let high = boxes.iter().fold(DVec2::NEG_INFINITY, |high, b| high.max(b.1));
        let side = (boxes.len() as f64).sqrt().clamp(1.0, 256.0);
        let cell = ((high - low).max_element() / side).max(0.01);
        let mut buckets = Self { low, cell, lists: BTreeMap::new() };
        for (number, (a, b)) in boxes.iter().enumerate() {
            let margin = DVec2::splat(2.0 * TOLERANCE);
            let (first, last) = (buckets.cell_of(*a - margin), buckets.cell_of(*b + margin));
            for x in first[0]..=last[0] {
                for y in first[1]..=last[1] {
                    buckets.lists.entry([x, y]).or_default().push(u32::try_from(number).unwrap_or(u32::MAX));
                }
            }
        }
        buckets
    }

    fn cell_of(&self, at: DVec2) -> [i64; 2] {
        ((at - self.low) / self.cell).floor().as_i64vec2().to_array()
    }
}

/// Faces, to be asked whether one of them holds a point.
struct FaceIndex<'a> {
    faces: &'a [Face],
    buckets: Buckets,
}

impl<'a> FaceIndex<'a> {
    fn new(faces: &'a [Face]) -> Self {
        let buckets = Buckets::new(faces.iter().map(|face| {
            let corners = || face.iter().flatten().copied();
            (corners().fold(DVec2::INFINITY, DVec2::min), corners().fold(DVec2::NEG_INFINITY, DVec2::max))
        }));
        Self { faces, buckets }
    }

    fn contains(&self, at: DVec2) -> bool {
        let list = self.buckets.lists.get(&self.buckets.cell_of(at));
        list.into_iter()
            .flatten()
            .any(|face| self.faces[*face as usize].iter().fold(false, |is, ring| is ^ crosses(ring, at)))
    }
}

/// Whether a ray from the point crosses the ring an odd number of times.
fn crosses(ring: &[DVec2], at: DVec2) -> bool {
    let mut inside = false;
    for (a, b) in ring.iter().zip(ring.iter().cycle().skip(1)) {
        if (a.y > at.y) != (b.y > at.y) {
            inside ^= at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x);
        }
    }
    inside
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::random::{Purpose, range};

    #[test]
    fn triangles_at_random_have_the_area_of_their_exact_union() {
        for case in 0..400_u32 {
            let draw =
                |face: u32, k: u32| f64::from(range(u64::from(case), face, Purpose::Scenery, k, -5.0, 5.0));
            let corner = |face: u32, k: u32| DVec2::new(draw(face, 2 * k), draw(face, 2 * k + 1));
            let face = |face: u32| vec![(0..3).map(|k| corner(face, k)).collect::<Vec<_>>()];
            let faces: Vec<Face> = (0..2 + case % 5).map(face).collect();
            let (own, exact) = (area(&union(&faces).unwrap()), area(&exact(&faces)));
            // a seam as wide as the tolerance along every edge
            assert!((own - exact).abs() < 0.15, "case {case}: {own} m2, exactly {exact} m2");
            assert!(exact > area(&faces[0]).abs() - 0.01, "case {case}: {exact} m2");
        }
    }
}
