//! Triangles in parts: what lies near one another is drawn together, or left out together.

use glam::{Mat4, Vec3};

/// Most triangles of a part.
const MOST: usize = 4096;

/// Triangles that are drawn together.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// The first of its indices.
    pub(super) first: u32,
    /// How many it has.
    pub(super) count: u32,
    low: Vec3,
    high: Vec3,
}

/// The indices of triangles, those of each part one after the other, and the parts. `corner` is where a vertex is.
pub(super) fn split(corner: impl Fn(u32) -> Vec3, indices: &[u32]) -> (Vec<u32>, Vec<Part>) {
    let mut triangles: Vec<([u32; 3], Vec3)> = indices
        .chunks_exact(3)
        .map(|t| ([t[0], t[1], t[2]], t.iter().map(|index| corner(*index)).sum::<Vec3>() / 3.0))
        .collect();
    let mut parts = Vec::new();
    divide(&mut triangles, &mut |part| {
        let first = parts.last().map_or(0, |before: &Part| before.first + before.count);
        let count = u32::try_from(3 * part.len()).unwrap_or(u32::MAX);
        let corners = || part.iter().flat_map(|(t, _)| t.iter().map(|index| corner(*index)));
        let (low, high) = (corners().fold(Vec3::MAX, Vec3::min), corners().fold(Vec3::MIN, Vec3::max));
        parts.push(Part { first, count, low, high });
    });
    (triangles.iter().flat_map(|(t, _)| *t).collect(), parts)
}

/// Halves triangles by where their middles lie, along the longer side, until the parts are small.
fn divide(triangles: &mut [([u32; 3], Vec3)], found: &mut impl FnMut(&[([u32; 3], Vec3)])) {
    if triangles.len() <= MOST {
        if !triangles.is_empty() {
            found(triangles);
        }
        return;
    }
    let low = triangles.iter().fold(Vec3::MAX, |low, (_, middle)| low.min(*middle));
    let high = triangles.iter().fold(Vec3::MIN, |high, (_, middle)| high.max(*middle));
    let axis = (high - low).max_position();
    let half = triangles.len() / 2;
    triangles.select_nth_unstable_by(half, |a, b| a.1[axis].total_cmp(&b.1[axis]));
    let (below, above) = triangles.split_at_mut(half);
    divide(below, found);
    divide(above, found);
}

impl Part {
    /// The same part behind so many other indices.
    pub(super) fn behind(self, others: u32) -> Self {
        Self { first: others + self.first, ..self }
    }

    /// Whether any of it can lie in the clip space of one of these matrices.
    pub(super) fn is_seen(&self, clip_from_world: &[Mat4]) -> bool {
        let corners: [Vec3; 8] = std::array::from_fn(|i| {
            let of = |bit: usize, axis: usize| if i & bit == 0 { self.low[axis] } else { self.high[axis] };
            Vec3::new(of(1, 0), of(2, 1), of(4, 2))
        });
        clip_from_world.iter().any(|matrix| {
            let clip = || corners.iter().map(|corner| *matrix * corner.extend(1.0));
            // all corners beyond one side: the box is beyond it, since sides are planes
            !(clip().all(|p| p.x < -p.w)
                || clip().all(|p| p.x > p.w)
                || clip().all(|p| p.y < -p.w)
                || clip().all(|p| p.y > p.w)
                || clip().all(|p| p.z > p.w)
                || clip().all(|p| p.z < 0.0))
        })
    }
}

/// The ranges of indices of the parts that are seen, first and count; neighbours are joined.
pub(super) fn seen<'a>(
    parts: impl IntoIterator<Item = &'a Part>,
    clip_from_world: &[Mat4],
) -> Vec<(u32, u32)> {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for part in parts.into_iter().filter(|part| part.is_seen(clip_from_world)) {
        match ranges.last_mut() {
            Some((first, count)) if *first + *count == part.first => *count += part.count,
            _ => ranges.push((part.first, part.count)),
        }
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::avatar::PlaceVertex;
    use crate::render::Camera;
    use crate::render::camera::View;
    use glam::Vec2;

    /// A sheet of so many squares a side, 1 m each, on the ground about the origin.
    fn sheet(side: u32) -> (Vec<PlaceVertex>, Vec<u32>) {
        let row = side + 1;
        #[allow(clippy::cast_precision_loss, reason = "small")]
        let at = |i: u32| i as f32 - 0.5 * side as f32;
        let vertex = |i: u32| PlaceVertex {
            position: Vec3::new(at(i % row), 0.0, at(i / row)),
            normal: Vec3::Y,
            color: Vec3::ONE,
            uv: Vec2::ZERO,
            material: 0,
        };
        let square = |i: u32| {
            let a = i / side * row + i % side;
            [a, a + row, a + 1, a + 1, a + row, a + row + 1]
        };
        ((0..row * row).map(vertex).collect(), (0..side * side).flat_map(square).collect())
    }

    fn at(vertices: &[PlaceVertex]) -> impl Fn(u32) -> Vec3 + '_ {
        |index| vertices[index as usize].position
    }

    #[test]
    fn parts_hold_every_triangle_once_and_lie_together() {
        let (vertices, indices) = sheet(200);
        let (sorted, parts) = split(at(&vertices), &indices);
        let triangles = |indices: &[u32]| {
            let mut all: Vec<Vec<u32>> = indices.chunks_exact(3).map(<[u32]>::to_vec).collect();
            all.sort_unstable();
            all
        };
        assert_eq!(triangles(&sorted), triangles(&indices));
        assert!(parts.len() >= 20, "{} parts", parts.len());
        let mut next = 0;
        for part in &parts {
            assert!(part.first == next && part.count as usize <= 3 * MOST);
            next += part.count;
            let size = part.high - part.low;
            assert!(size.x < 80.0 && size.z < 80.0, "{size}");
        }
        assert_eq!(next as usize, indices.len());
        assert_eq!(split(at(&vertices), &[]), (Vec::new(), Vec::new()));
    }

    #[test]
    fn only_what_can_be_seen_is_drawn() {
        let (vertices, indices) = sheet(200);
        let (_, parts) = split(at(&vertices), &indices);
        let drawn = |eyes: Vec3, heading: f32, pitch: f32| {
            let view = View::mono(&Camera::user_eyes(eyes, heading, pitch), 400, 300);
            seen(&parts, &view.clip_from_world[..1]).iter().map(|(_, count)| *count as usize).sum::<usize>()
        };
        let middle = Vec3::new(0.0, 1.7, 0.0);
        let ahead = drawn(middle, 0.0, 0.0);
        assert!(ahead > 0 && ahead < indices.len() / 2, "{ahead} of {}", indices.len());
        assert_eq!(drawn(Vec3::new(0.0, 1.7, 150.0), 0.0, 0.0), 0, "behind the back");
        assert_eq!(drawn(Vec3::new(0.0, 1.7, -400.0), 0.0, 0.0), indices.len(), "all of it ahead");
        // of the parts of two eyes, each sees its own
        let views = [0.0, std::f32::consts::PI]
            .map(|heading| View::mono(&Camera::user_eyes(middle, heading, 0.0), 400, 300).clip_from_world[0]);
        let both: usize = seen(&parts, &views).iter().map(|(_, count)| *count as usize).sum();
        assert!(both > ahead);
    }
}
