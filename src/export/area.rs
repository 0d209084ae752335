//! The walkable area as well-known text.

use super::trajectory::plane_from_ground;
use glam::{DVec2, Vec2};
use std::fmt::Write;

/// `POLYGON ((outer), (hole), ..)` in the plane of trajectories (see [`plane_from_ground`]): outer ring
/// counter-clockwise, holes clockwise, as simple features want them, each closed by its first point.
pub(super) fn polygon(bounds: &[Vec2], obstacles: &[Vec<Vec2>]) -> String {
    let mut text = String::from("POLYGON (");
    ring(&mut text, bounds, false);
    for hole in obstacles {
        text.push_str(", ");
        ring(&mut text, hole, true);
    }
    text.push(')');
    text
}

fn ring(text: &mut String, corners: &[Vec2], clockwise: bool) {
    let mut points: Vec<DVec2> = corners.iter().copied().map(plane_from_ground).collect();
    let next = points.iter().cycle().skip(1);
    let area: f64 = points.iter().zip(next).map(|(a, b)| a.perp_dot(*b)).sum();
    if (area < 0.0) != clockwise {
        points.reverse();
    }
    text.push('(');
    for (i, point) in points.iter().chain(points.first()).enumerate() {
        let comma = if i > 0 { ", " } else { "" };
        // Writing to a String cannot fail.
        let _ = write!(text, "{comma}{} {}", point.x, point.y);
    }
    text.push(')');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rings_are_closed_and_holes_run_the_other_way() {
        let square = |s: f32| vec![Vec2::new(0., 0.), Vec2::new(s, 0.), Vec2::new(s, s), Vec2::new(0., s)];
        let text = polygon(&square(4.0), &[square(1.0)]);
        assert_eq!(text, "POLYGON ((0 -4, 4 -4, 4 0, 0 0, 0 -4), (0 0, 1 0, 1 -1, 0 -1, 0 0))");
    }
}
