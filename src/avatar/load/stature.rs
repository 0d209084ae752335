//! How tall a character is: from the sole to the crown of its head. What it wears on its head does not count.

use super::super::Vertex;
use crate::gait::Joint;
use glam::Vec3;

/// Heights of the head at which its width is taken.
const SLICES: u16 = 24;
/// The crown is no higher above the head's joint than this times the head's usual width. Bare heads, of people and of
/// cartoon figures, have 1.0 to 1.4; a head in a hat is as wide as its face in most of its height.
const TALLEST: f32 = 1.6;

/// Height of the crown, in the units and the frame of the vertices (y up).
///
/// `figure` is the body without what hangs on the head as an object of its own; `head` the place of the head's joint.
pub(super) fn crown(vertices: &[Vertex], triangles: &[[u32; 3]], head: Vec3) -> f32 {
    let is_head = |v: &Vertex| usize::from(v.joints[0]) == Joint::Head as usize;
    let on_head: Vec<[Vec3; 3]> = triangles
        .iter()
        .map(|corners| corners.map(|corner| &vertices[corner as usize]))
        .filter(|corners| corners.iter().all(|v| is_head(v)))
        .map(|corners| corners.map(|v| v.position))
        .collect();
    let top = on_head.iter().flatten().map(|p| p.y).fold(f32::MIN, f32::max);
    if top <= head.y {
        let heights = triangles.iter().flatten().map(|corner| vertices[*corner as usize].position.y);
        return heights.fold(f32::MIN, f32::max);
    }
    let mut widths: Vec<f32> = (0..SLICES)
        .map(|i| head.y + (top - head.y) * (f32::from(i) + 0.5) / f32::from(SLICES))
        .map(|height| width(&on_head, height))
        .collect();
    widths.sort_by(f32::total_cmp);
    let usual = widths[widths.len() / 2];
    top.min(head.y + TALLEST * usual)
}

/// How wide a surface is at a height.
fn width(triangles: &[[Vec3; 3]], height: f32) -> f32 {
    let (mut left, mut right) = (f32::MAX, f32::MIN);
    for [a, b, c] in triangles {
        for (p, q) in [(a, b), (b, c), (c, a)] {
            if (p.y > height) != (q.y > height) {
                let x = p.x + (q.x - p.x) * (height - p.y) / (q.y - p.y);
                (left, right) = (left.min(x), right.max(x));
            }
        }
    }
    (right - left).max(0.0)
}
