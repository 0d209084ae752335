//! What is solid in a model of a place: where it stands between knee and head, seen from above.

use crate::scenario::polygon;
use glam::{DVec2, Vec2, Vec3};

/// Between these heights above the ground a model is in people's way, m: over a lower one they step, under a higher one they walk.
const IN_THE_WAY: [f32; 2] = [0.3, 1.8];
/// How far what is solid is widened to each side, m: a wall of one sheet has no area.
const WIDER: f32 = 0.01;

/// What of each triangle stands in people's way, seen from above, on (x, -z), m.
pub(super) fn faces(triangles: &[[Vec3; 3]]) -> Vec<polygon::Face> {
    triangles.iter().filter_map(shadow).map(|ring| vec![ring]).collect()
}

/// The outline from above of the part of a triangle that is in the way, a little wider.
fn shadow(triangle: &[Vec3; 3]) -> Option<Vec<DVec2>> {
    let [low, high] = IN_THE_WAY;
    let above = clipped(triangle, |corner| corner.y - low);
    let part = clipped(&above, |corner| high - corner.y);
    if part.is_empty() {
        return None;
    }
    let around = [-WIDER, WIDER].map(|x| [-WIDER, WIDER].map(|z| Vec2::new(x, z)));
    let points = part.iter().flat_map(|corner| {
        around.as_flattened().iter().map(|aside| (Vec2::new(corner.x, -corner.z) + aside).as_dvec2())
    });
    Some(hull(points.collect()))
}

/// The part of a flat polygon where a linear function of the place is not negative (Sutherland and Hodgman 1974).
fn clipped(corners: &[Vec3], inside: impl Fn(Vec3) -> f32) -> Vec<Vec3> {
    let mut kept = Vec::new();
    for (from, to) in corners.iter().zip(corners.iter().cycle().skip(1)) {
        let (a, b) = (inside(*from), inside(*to));
        if a >= 0.0 {
            kept.push(*from);
        }
        if (a >= 0.0) != (b >= 0.0) {
            kept.push(from.lerp(*to, a / (a - b)));
        }
    }
    kept
}

/// The convex outline of points, counter-clockwise (Andrew 1979).
fn hull(mut points: Vec<DVec2>) -> Vec<DVec2> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let chain = |points: &mut dyn Iterator<Item = &DVec2>| {
        let mut chain: Vec<DVec2> = Vec::new();
        for &point in points {
            while let [.., a, b] = chain[..]
                && (b - a).perp_dot(point - b) <= 0.0
            {
                chain.pop();
            }
            chain.push(point);
        }
        chain.pop(); // the first of the other chain
        chain
    };
    let mut outline = chain(&mut points.iter());
    outline.extend(chain(&mut points.iter().rev()));
    outline
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A wall of one sheet from `a` to `b` on the ground.
    fn wall(a: [f32; 2], b: [f32; 2], heights: [f32; 2]) -> [[Vec3; 3]; 2] {
        let at = |p: [f32; 2], k: usize| Vec3::new(p[0], heights[k], p[1]);
        [[at(a, 0), at(b, 0), at(b, 1)], [at(a, 0), at(b, 1), at(a, 1)]]
    }

    /// Whether any face covers a place (x, z).
    fn is_solid(triangles: &[[Vec3; 3]], x: f32, z: f32) -> bool {
        faces(triangles).iter().flatten().any(|ring| {
            let ring: Vec<Vec2> = ring.iter().map(|corner| corner.as_vec2()).collect();
            polygon::contains(&ring, Vec2::new(x, -z))
        })
    }

    #[test]
    fn walls_are_as_long_as_they_are_and_what_is_low_or_high_is_in_nobodys_way() {
        let sheet = wall([0.0, 1.0], [3.0, 1.0], [0.0, 2.5]);
        for (x, z, solid) in [(-0.02, 1.0, false), (0.01, 1.0, true), (2.9, 1.005, true), (2.9, 1.02, false)]
        {
            assert_eq!(is_solid(&sheet, x, z), solid, "{x} {z}");
        }
        for heights in [[0.0, 0.15], [2.1, 2.5]] {
            assert!(faces(&wall([0.0, 0.0], [3.0, 0.0], heights)).is_empty());
        }
        // a ramp from the ground to 3 m over 10 m is in the way from 1 m on to 6 m
        let at = |x: f32, z: f32| Vec3::new(x, 0.3 * x, z);
        let ramp =
            [[at(0.0, 0.0), at(0.0, 2.0), at(10.0, 2.0)], [at(0.0, 0.0), at(10.0, 2.0), at(10.0, 0.0)]];
        for (x, solid) in [(0.9, false), (1.1, true), (5.9, true), (6.1, false)] {
            assert_eq!(is_solid(&ramp, x, 1.0), solid, "{x}");
        }
        // each outline turns counter-clockwise and does not cross itself
        for ring in faces(&ramp).into_iter().flatten() {
            let ring: Vec<Vec2> = ring.iter().map(|corner| corner.as_vec2()).collect();
            assert!(polygon::signed_area(&ring) > 0.0 && polygon::self_intersection(&ring).is_none());
        }
    }
}
