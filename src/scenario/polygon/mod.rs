//! Plane geometry on the ground pair (x, z): orientation, containment, distances.
//!
//! Orientation is that of the stored pair, as if x ran right and z ran up a sheet of paper: a positive
//! [`signed_area`] is counter-clockwise. Solid obstacles are stored counter-clockwise, the outer bounds
//! clockwise, as RVO2 wants them: the walkable side is to the right of every edge. (Seen from above the world the
//! pair is mirrored, so there a solid obstacle runs clockwise.)
//!
//! Containment and crossings are written by hand in `f32`: starts are drawn by them, so their rounding is part of every
//! crowd's hash, and messages name the edges that cross. `i_overlay` rounds to integers and names none.

mod union;

pub use union::UnionError;
pub(crate) use union::{Face, largest_without, pieces, union};

use glam::Vec2;

/// Twice-halved cross sum, m²: positive when the polygon is counter-clockwise on (x, z).
///
/// Summed in f64 about the first vertex, so that far-off polygons keep their sign.
pub fn signed_area(polygon: &[Vec2]) -> f64 {
    let Some(&origin) = polygon.first() else { return 0.0 };
    let cross = |a: Vec2, b: Vec2| {
        let (a, b) = ((a - origin).as_dvec2(), (b - origin).as_dvec2());
        a.x * b.y - a.y * b.x
    };
    edges(polygon).map(|(a, b)| cross(a, b)).sum::<f64>() * 0.5
}

/// Edges of a closed polygon in order, the last one back to the first vertex.
pub fn edges(polygon: &[Vec2]) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
    let next = polygon.iter().copied().cycle().skip(1);
    polygon.iter().copied().zip(next)
}

/// The polygon turned counter-clockwise (`solid`) or clockwise (bounds), first vertex kept.
pub fn oriented(mut polygon: Vec<Vec2>, solid: bool) -> Vec<Vec2> {
    if (signed_area(&polygon) > 0.0) != solid && polygon.len() > 1 {
        polygon[1..].reverse();
    }
    polygon
}

/// Whether the point is inside, by the even-odd rule; orientation does not matter.
pub fn contains(polygon: &[Vec2], point: Vec2) -> bool {
    let mut inside = false;
    for (a, b) in edges(polygon) {
        if (a.y > point.y) != (b.y > point.y) {
            let x = a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x);
            inside ^= point.x < x;
        }
    }
    inside
}

/// Distance of a point to a segment, m.
pub fn point_segment_distance(point: Vec2, a: Vec2, b: Vec2) -> f32 {
    let along = b - a;
    let length_squared = along.length_squared();
    let t =
        if length_squared > 0.0 { ((point - a).dot(along) / length_squared).clamp(0.0, 1.0) } else { 0.0 };
    point.distance(a + along * t)
}

/// Whether two segments share a point.
pub fn segments_meet(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> bool {
    let side = |p: Vec2, q: Vec2, r: Vec2| (q - p).perp_dot(r - p);
    let (s1, s2, s3, s4) = (side(a, b, c), side(a, b, d), side(c, d, a), side(c, d, b));
    if ((s1 > 0.0 && s2 < 0.0) || (s1 < 0.0 && s2 > 0.0))
        && ((s3 > 0.0 && s4 < 0.0) || (s3 < 0.0 && s4 > 0.0))
    {
        return true;
    }
    let on =
        |s: f32, p: Vec2, q: Vec2, r: Vec2| s == 0.0 && r.cmpge(p.min(q)).all() && r.cmple(p.max(q)).all();
    on(s1, a, b, c) || on(s2, a, b, d) || on(s3, c, d, a) || on(s4, c, d, b)
}

/// Distance between two segments, m; 0 when they meet.
pub fn segment_distance(a: Vec2, b: Vec2, c: Vec2, d: Vec2) -> f32 {
    if segments_meet(a, b, c, d) {
        return 0.0;
    }
    point_segment_distance(a, c, d)
        .min(point_segment_distance(b, c, d))
        .min(point_segment_distance(c, a, b))
        .min(point_segment_distance(d, a, b))
}

/// The first pair of edges of a closed polygon that cross or touch though they are not neighbours, by index.
pub fn self_intersection(polygon: &[Vec2]) -> Option<(usize, usize)> {
    let all: Vec<(Vec2, Vec2)> = edges(polygon).collect();
    for i in 0..all.len() {
        for j in i + 2..all.len() {
            let neighbours = i == 0 && j + 1 == all.len();
            if !neighbours && segments_meet(all[i].0, all[i].1, all[j].0, all[j].1) {
                return Some((i, j));
            }
        }
    }
    None
}

/// Regular polygon of `sides` corners about `center`, counter-clockwise, first corner at `turn` radians.
#[allow(clippy::cast_precision_loss, reason = "a handful of sides")]
pub fn regular(center: Vec2, radius: f32, sides: u32, turn: f32) -> Vec<Vec2> {
    let angle = |i: u32| turn + std::f32::consts::TAU * i as f32 / sides as f32;
    (0..sides).map(|i| center + radius * Vec2::from_angle(angle(i))).collect()
}

/// Rectangle about `center` with full `size`, turned by `heading` about +y, counter-clockwise.
pub fn rectangle(center: Vec2, size: Vec2, heading: f32) -> Vec<Vec2> {
    let (sin, cos) = libm::sincosf(heading);
    // A turn by `heading` about +y takes (x, z) to (x cos + z sin, -x sin + z cos).
    let place = |x: f32, z: f32| center + Vec2::new(x * cos + z * sin, z * cos - x * sin);
    let half = size * 0.5;
    vec![place(-half.x, -half.y), place(half.x, -half.y), place(half.x, half.y), place(-half.x, half.y)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square() -> Vec<Vec2> {
        rectangle(Vec2::ZERO, Vec2::splat(2.0), 0.0)
    }

    #[test]
    fn solids_turn_counter_clockwise_and_bounds_clockwise() {
        assert!((signed_area(&square()) - 4.0).abs() < 1e-9);
        let mut clockwise = square();
        clockwise.reverse();
        assert!(signed_area(&oriented(clockwise.clone(), true)) > 0.0);
        assert!(signed_area(&oriented(square(), false)) < 0.0);
        assert_eq!(oriented(clockwise.clone(), false), clockwise);
        assert!(signed_area(&regular(Vec2::new(1e4, 1e4), 0.1, 8, 0.3)) > 0.0);
    }

    #[test]
    fn the_walkable_side_is_to_the_right_of_every_edge() {
        for (polygon, solid) in [(square(), true), (oriented(square(), false), false)] {
            for (a, b) in edges(&polygon) {
                let right = (a + b) * 0.5 - (b - a).perp() * 0.01;
                assert_eq!(contains(&polygon, right), !solid);
            }
        }
    }

    #[test]
    fn distances_and_crossings_are_those_of_the_drawing() {
        let v = Vec2::new;
        assert!((segment_distance(v(0., 0.), v(2., 0.), v(1., 1.), v(1., 3.)) - 1.0).abs() < 1e-6);
        assert!(segment_distance(v(0., 0.), v(2., 0.), v(1., -1.), v(1., 3.)) < 1e-6);
        assert!((point_segment_distance(v(5., 4.), v(0., 0.), v(2., 0.)) - 5.0).abs() < 1e-6);
        assert!((point_segment_distance(v(3., 4.), v(0., 0.), v(0., 0.)) - 5.0).abs() < 1e-6);
        assert!(segments_meet(v(0., 0.), v(2., 0.), v(1., 0.), v(3., 0.)), "collinear overlap");
        assert_eq!(self_intersection(&square()), None);
        assert_eq!(self_intersection(&[v(0., 0.), v(2., 2.), v(2., 0.), v(0., 2.)]), Some((0, 2)));
    }

    #[test]
    fn a_heading_turns_a_rectangle_like_it_turns_a_model() {
        let turned = rectangle(Vec2::ZERO, Vec2::new(2.0, 4.0), 0.7);
        let world = glam::Quat::from_rotation_y(0.7) * glam::Vec3::new(-1.0, 0.0, -2.0);
        assert!(turned[0].distance(crate::ground::ground_from_world(world)) < 1e-5);
    }
}
