//! The walkable area as one valid polygon: the bounds less the union of the obstacles, whether these overlap, touch, stick
//! out, lie in one another or cut the area into parts.
//!
//! Corners are rounded to a tenth of a millimetre, so that the operations on polygons are exact (`i_overlay`, on whole
//! numbers). Readers take one polygon (PedPy and JuPedSim refuse several), so of several parts those stay that people are
//! in, and if that is more than one, slits of two millimetres join them.

use super::plane::plane_from_ground;
use crate::ground::is_absent;
use glam::{DVec2, Vec2};
use i_overlay::core::fill_rule::FillRule;
use i_overlay::core::overlay::{IntOverlayOptions, Overlay, ShapeType};
use i_overlay::core::overlay_rule::OverlayRule;
use i_overlay::core::solver::Solver;
use i_overlay::i_float::int::point::IntPoint;
use std::collections::HashMap;

/// Units of the rounded corners in a metre.
const UNITS: f64 = 1e4;
/// Farthest corner, units: far beyond any scenario, and within what the operations bear.
const FARTHEST: f64 = 1e13;
/// Half the width of a slit, m.
const SLIT: f64 = 1e-3;
/// Half the width of a slit to the tip of a sliver is less than this, m.
const WIDEST: f64 = 0.1;
/// An agent that has moved less since its last look-up is taken to be in the same part, m.
const NEAR: f32 = 1.0;

type Ring = Vec<IntPoint<i64>>;
/// An outer ring, counter-clockwise in the formats' plane, and its holes, clockwise; none crosses itself or another.
type Part = Vec<Ring>;

/// What the walkable area of a file is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Ground {
    /// Parts into which the obstacles cut the area.
    pub parts: usize,
    /// Parts that people were in; more than one are joined by slits of two millimetres.
    pub peopled: usize,
}

/// The free ground, and in which of its parts people have been.
#[derive(Debug, Default)]
pub(super) struct Area {
    parts: Vec<Part>,
    peopled: Vec<bool>,
    /// Position of each agent at its last look-up.
    last: HashMap<u32, Vec2>,
}

impl Area {
    /// The bounds less the obstacles: ground outlines (x, z), m, each simple, in either orientation.
    pub(super) fn new(bounds: &[Vec2], obstacles: &[Vec<Vec2>]) -> Self {
        let mut overlay = overlay();
        overlay.add_contour(&ring(bounds), ShapeType::Subject);
        for obstacle in obstacles {
            overlay.add_contour(&ring(obstacle), ShapeType::Clip);
        }
        let parts = tidy(overlay.overlay(OverlayRule::Difference, FillRule::NonZero));
        Self { peopled: vec![false; parts.len()], parts, last: HashMap::new() }
    }

    pub(super) const fn is_empty(&self) -> bool {
        self.parts.is_empty()
    }

    /// Notes where people are (x, z), m.
    pub(super) fn visit(&mut self, people: impl Iterator<Item = (u32, Vec2)>) {
        if self.parts.len() < 2 {
            return;
        }
        for (id, place) in people.filter(|(_, place)| !is_absent(place.to_array())) {
            if self.last.get(&id).is_some_and(|last| last.distance(place) < NEAR) {
                continue;
            }
            self.last.insert(id, place);
            let at = unit(plane_from_ground(place));
            if let Some(part) = self.parts.iter().position(|part| contains(part, at)) {
                self.peopled[part] = true;
            }
        }
    }

    /// The parts that people were in, as one polygon. Where no part was visited: the largest.
    pub(super) fn polygon(&self) -> (String, Ground) {
        let area = |part: &Part| part.iter().map(signed_area).sum::<f64>();
        let peopled =
            self.parts.iter().zip(&self.peopled).filter(|(_, is)| **is).map(|(part, _)| part.clone());
        let mut kept: Vec<Part> = peopled.collect();
        let ground = Ground { parts: self.parts.len(), peopled: kept.len() };
        if kept.is_empty() {
            kept.extend(self.parts.iter().max_by(|a, b| area(a).total_cmp(&area(b))).cloned());
        }
        let mut width = SLIT;
        while kept.len() > 1 && width < WIDEST {
            let fewer = joined(&kept, width);
            if fewer.len() < kept.len() {
                kept = fewer;
            } else {
                width *= 2.0; // the tip of a sliver is thinner than what corners are rounded to
            }
        }
        (wkt(&kept), ground)
    }

    /// All parts as they are.
    pub(super) fn wkt(&self) -> String {
        wkt(&self.parts)
    }
}

fn overlay() -> Overlay<i64> {
    // Corners on straight edges stay at first: where rings touch, both need the corner (see `tidy`).
    let options = IntOverlayOptions { preserve_output_collinear: true, ..IntOverlayOptions::ogc() };
    Overlay::new_custom(64, options, Solver::default())
}

fn unit(place: DVec2) -> IntPoint<i64> {
    #[allow(clippy::cast_possible_truncation, reason = "clamped; NaN gives 0")]
    let round = |part: f64| (part * UNITS).round().clamp(-FARTHEST, FARTHEST) as i64;
    IntPoint::new(round(place.x), round(place.y))
}

#[allow(clippy::cast_precision_loss, reason = "within 2^53")]
fn metres(at: IntPoint<i64>) -> DVec2 {
    DVec2::new(at.x as f64, at.y as f64) / UNITS
}

/// A ground outline in the plane, counter-clockwise: obstacles that overlap must not cancel each other.
fn ring(outline: &[Vec2]) -> Ring {
    let mut ring: Ring = outline.iter().map(|corner| unit(plane_from_ground(*corner))).collect();
    if signed_area(&ring) < 0.0 {
        ring.reverse();
    }
    ring
}

/// m², positive counter-clockwise.
fn signed_area(ring: &Ring) -> f64 {
    let Some(&origin) = ring.first() else { return 0.0 };
    let from = |at: &IntPoint<i64>| metres(*at) - metres(origin);
    let next = ring.iter().cycle().skip(1);
    0.5 * ring.iter().zip(next).map(|(a, b)| from(a).perp_dot(from(b))).sum::<f64>()
}

/// Removes corners on straight edges, unless another ring touches there. Written in decimals, such a corner would lie a
/// rounding error off the edge.
fn tidy(parts: Vec<Part>) -> Vec<Part> {
    let mut uses: HashMap<[i64; 2], u32> = HashMap::new();
    for corner in parts.iter().flatten().flatten() {
        *uses.entry([corner.x, corner.y]).or_default() += 1;
    }
    let tidied = |ring: Ring| {
        let mut kept: Ring = Vec::with_capacity(ring.len());
        for (i, &at) in ring.iter().enumerate() {
            let before = kept.last().copied().unwrap_or(ring[ring.len() - 1]);
            let after = ring[(i + 1) % ring.len()];
            let wide = |a: i64, b: i64| i128::from(a) * i128::from(b);
            let turn = wide(at.x - before.x, after.y - at.y) - wide(at.y - before.y, after.x - at.x);
            if turn != 0 || uses.get(&[at.x, at.y]).is_some_and(|uses| *uses > 1) {
                kept.push(at);
            }
        }
        kept
    };
    let part = |part: Part| part.into_iter().map(tidied).filter(|ring| ring.len() > 2).collect();
    parts.into_iter().map(part).filter(|part: &Part| !part.is_empty()).collect()
}

/// Whether a place is in a part, by the even-odd rule over all its rings.
fn contains(part: &Part, at: IntPoint<i64>) -> bool {
    let at = metres(at);
    let crosses = |a: DVec2, b: DVec2| {
        (a.y > at.y) != (b.y > at.y) && at.x < a.x + (at.y - a.y) / (b.y - a.y) * (b.x - a.x)
    };
    let edges = part.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
    edges.filter(|(a, b)| crosses(metres(**a), metres(**b))).count() % 2 == 1
}

/// The first part joined with the one that is nearest to it, by a slit of twice `width`, m.
fn joined(parts: &[Part], width: f64) -> Vec<Part> {
    let mut overlay = overlay();
    for part in parts {
        overlay.add_source(part, ShapeType::Subject);
    }
    if let Some((first, others)) = parts.split_first()
        && let Some((a, b)) = nearest(first, others)
    {
        let along = (b - a).normalize_or(DVec2::X) * width;
        let across = along.perp();
        let corners = [a - along - across, b + along - across, b + along + across, a - along + across];
        overlay.add_contour(&corners.map(unit), ShapeType::Clip);
    }
    tidy(overlay.overlay(OverlayRule::Union, FillRule::NonZero))
}

/// The two places of a part and of others that are nearest to each other.
fn nearest(part: &Part, others: &[Part]) -> Option<(DVec2, DVec2)> {
    let edges = |part: &Part| -> Vec<(DVec2, DVec2)> {
        let all = part.iter().flat_map(|ring| ring.iter().zip(ring.iter().cycle().skip(1)));
        all.map(|(a, b)| (metres(*a), metres(*b))).collect()
    };
    let foot = |at: DVec2, (a, b): (DVec2, DVec2)| {
        let along = b - a;
        a + along * ((at - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0)
    };
    let own = edges(part);
    let mut best: Option<(DVec2, DVec2)> = None;
    for theirs in others.iter().flat_map(edges) {
        for &mine in &own {
            // Two edges that do not cross are nearest at an end of one of them.
            let pairs = [(mine.0, foot(mine.0, theirs)), (foot(theirs.0, mine), theirs.0)];
            for (a, b) in pairs {
                if best.is_none_or(|(c, d)| a.distance_squared(b) < c.distance_squared(d)) {
                    best = Some((a, b));
                }
            }
        }
    }
    best
}

/// `POLYGON ((outer), (hole), ..)`, or MULTIPOLYGON of several: outer rings counter-clockwise, holes clockwise, as simple
/// features want them.
fn wkt(parts: &[Part]) -> String {
    let ring = |ring: &Vec<_>| ring.iter().map(|corner| metres(*corner).to_array()).collect();
    let polygons: Vec<Vec<Vec<[f64; 2]>>> =
        parts.iter().map(|part| part.iter().map(ring).collect()).collect();
    crate::wkt::text(&polygons)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(x: f32, z: f32, side: f32) -> Vec<Vec2> {
        let at = |i: f32, j: f32| Vec2::new(x + i * side, z + j * side);
        vec![at(0., 0.), at(1., 0.), at(1., 1.), at(0., 1.)]
    }

    fn size(area: &Area) -> f64 {
        area.parts.iter().flatten().map(signed_area).sum()
    }

    #[test]
    fn rings_are_closed_and_holes_run_the_other_way() {
        let area = Area::new(&square(0., 0., 4.), &[square(1., 1., 1.)]);
        assert_eq!(area.wkt(), "POLYGON ((0 0, 0 -4, 4 -4, 4 0, 0 0), (1 -2, 1 -1, 2 -1, 2 -2, 1 -2))");
    }

    #[test]
    fn obstacles_that_overlap_touch_stick_out_or_lie_in_one_another_count_once() {
        let bounds = square(0., 0., 10.);
        let free = |obstacles: &[Vec<Vec2>]| {
            let area = Area::new(&bounds, obstacles);
            (area.parts.len(), (size(&area) * 1e3).round() / 1e3)
        };
        let mut other_way = square(2., 2., 2.);
        other_way.reverse();
        assert_eq!(free(&[square(1., 1., 2.), other_way]), (1, 93.0), "overlap, whatever their orientation");
        assert_eq!(free(&[square(1., 1., 2.), square(3., 1., 2.)]), (1, 92.0), "a common edge");
        assert_eq!(free(&[square(0., 1., 2.)]), (1, 96.0), "at the bounds");
        assert_eq!(free(&[square(9., 9., 2.)]), (1, 99.0), "sticks out");
        assert_eq!(free(&[square(1., 1., 4.), square(2., 2., 1.)]), (1, 84.0), "nested");
        assert_eq!(free(&[square(20., 1., 4.)]), (1, 100.0), "outside");
        assert_eq!(free(&[square(-1., -1., 12.)]), (0, 0.0), "nothing left");
        let wall = vec![Vec2::new(4., -1.), Vec2::new(5., -1.), Vec2::new(5., 11.), Vec2::new(4., 11.)];
        assert_eq!(free(&[wall]), (2, 90.0), "cut in two");
    }

    #[test]
    fn of_several_parts_those_with_people_stay_joined_by_a_slit() {
        let wall = vec![Vec2::new(4., -1.), Vec2::new(5., -1.), Vec2::new(5., 11.), Vec2::new(4., 11.)];
        let area = || Area::new(&square(0., 0., 10.), std::slice::from_ref(&wall));
        let (text, ground) = area().polygon();
        assert_eq!(ground, Ground { parts: 2, peopled: 0 });
        assert!(text.starts_with("POLYGON ((") && text.contains("10 -10"), "the larger: {text}");
        let mut left = area();
        left.visit([(0, Vec2::new(1., 1.)), (1, Vec2::splat(crate::ground::ABSENT))].into_iter());
        let (text, ground) = left.polygon();
        assert_eq!(ground, Ground { parts: 2, peopled: 1 });
        assert_eq!(text, "POLYGON ((0 0, 0 -10, 4 -10, 4 0, 0 0))");
        left.visit([(0, Vec2::new(8., 1.))].into_iter());
        let (text, ground) = left.polygon();
        assert_eq!((ground.peopled, text.matches('(').count()), (2, 2), "one ring: {text}");
    }
}
