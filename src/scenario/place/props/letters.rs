//! Letters of signs, drawn by strokes.

use crate::scenario::place::mesh::Builder;
use glam::{Vec2, Vec3};

/// Width and height of a letter in units of its grid, and the way from one to the next.
const GRID: Vec2 = Vec2::new(4.0, 6.0);
const ADVANCE: f32 = 5.8;
/// Half the width of a stroke in the same units.
const HALF_STROKE: f32 = 0.42;

/// Whether a text has nothing but letters that there are, and spaces.
#[cfg(test)]
pub(super) fn has(text: &str) -> bool {
    text.bytes().all(|letter| letter == b' ' || !strokes(letter).is_empty())
}

/// Strokes of a letter: points (column, row from below) joined one after the other, then the next stroke. None: a space.
const fn strokes(letter: u8) -> &'static [&'static [[u8; 2]]] {
    match letter {
        b'A' => &[&[[0, 0], [2, 6], [4, 0]], &[[1, 2], [3, 2]]],
        b'B' => &[
            &[[0, 0], [0, 6], [3, 6], [4, 5], [4, 4], [3, 3], [0, 3]],
            &[[3, 3], [4, 2], [4, 1], [3, 0], [0, 0]],
        ],
        b'C' => &[&[[4, 5], [3, 6], [1, 6], [0, 5], [0, 1], [1, 0], [3, 0], [4, 1]]],
        b'D' => &[&[[0, 0], [0, 6], [2, 6], [4, 4], [4, 2], [2, 0], [0, 0]]],
        b'E' => &[&[[4, 0], [0, 0], [0, 6], [4, 6]], &[[0, 3], [3, 3]]],
        b'F' => &[&[[0, 0], [0, 6], [4, 6]], &[[0, 3], [3, 3]]],
        b'G' => &[&[[4, 5], [3, 6], [1, 6], [0, 5], [0, 1], [1, 0], [3, 0], [4, 1], [4, 3], [2, 3]]],
        b'H' => &[&[[0, 0], [0, 6]], &[[4, 0], [4, 6]], &[[0, 3], [4, 3]]],
        b'I' => &[&[[2, 0], [2, 6]]],
        b'K' => &[&[[0, 0], [0, 6]], &[[4, 6], [0, 2]], &[[1, 3], [4, 0]]],
        b'L' => &[&[[0, 6], [0, 0], [4, 0]]],
        b'M' => &[&[[0, 0], [0, 6], [2, 3], [4, 6], [4, 0]]],
        b'N' => &[&[[0, 0], [0, 6], [4, 0], [4, 6]]],
        b'O' => &[&[[1, 0], [3, 0], [4, 1], [4, 5], [3, 6], [1, 6], [0, 5], [0, 1], [1, 0]]],
        b'P' => &[&[[0, 0], [0, 6], [3, 6], [4, 5], [4, 4], [3, 3], [0, 3]]],
        b'R' => &[&[[0, 0], [0, 6], [3, 6], [4, 5], [4, 4], [3, 3], [0, 3]], &[[2, 3], [4, 0]]],
        b'S' => &[&[
            [4, 5],
            [3, 6],
            [1, 6],
            [0, 5],
            [0, 4],
            [1, 3],
            [3, 3],
            [4, 2],
            [4, 1],
            [3, 0],
            [1, 0],
            [0, 1],
        ]],
        b'T' => &[&[[0, 6], [4, 6]], &[[2, 6], [2, 0]]],
        b'U' => &[&[[0, 6], [0, 1], [1, 0], [3, 0], [4, 1], [4, 6]]],
        b'W' => &[&[[0, 6], [1, 0], [2, 3], [3, 0], [4, 6]]],
        b'Y' => &[&[[0, 6], [2, 3], [4, 6]], &[[2, 3], [2, 0]]],
        _ => &[],
    }
}

/// Writes capitals on a wall that faces +z: about `middle`, `height` m tall or less, `room` m wide at most.
#[allow(clippy::cast_precision_loss, reason = "a few letters")]
pub(super) fn write(b: &mut Builder<'_>, text: &str, middle: Vec3, height: f32, room: f32, color: Vec3) {
    let wide = text.len() as f32 * ADVANCE - (ADVANCE - GRID.x);
    let unit = (height / GRID.y).min(room / wide);
    let start = -0.5 * Vec2::new(wide, GRID.y);
    for (number, letter) in text.bytes().enumerate() {
        let corner = start + Vec2::X * (number as f32 * ADVANCE);
        let at = |[x, y]: [u8; 2]| corner + Vec2::new(f32::from(x), f32::from(y));
        for pair in strokes(letter).iter().flat_map(|stroke| stroke.windows(2)) {
            let (from, to) = (at(pair[0]), at(pair[1]));
            let along = (to - from).normalize_or(Vec2::X) * HALF_STROKE;
            let (from, to, aside) = (from - along, to + along, along.perp());
            let corners = [from - aside, to - aside, to + aside, from + aside];
            b.quad(corners.map(|p| middle + (p * unit).extend(0.0)), color);
        }
    }
}
