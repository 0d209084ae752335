//! How much of the sky walls and props keep from the ground at their feet: a map, made once for an environment.

use super::surface::PackedVertex;
use glam::{Vec2, Vec3};

/// Most cells a side.
const MOST: f32 = 1024.0;
/// Side of the smallest cell, m.
const FINEST: f32 = 0.2;
/// What begins higher than this stands on nothing, m.
const STANDS: f32 = 0.4;
/// What ends lower than this darkens nothing, m.
const LEAST: f32 = 0.1;
/// What is higher than this darkens no more, m.
const TALL: f32 = 2.0;
/// Share of the sky that a tall wall takes from the ground at its foot.
const FOOT: f32 = 0.55;
/// Distance at which that is down to a third, m.
const REACH: f32 = 0.8;

/// The map as `shaders/draw/environment.wgsl` reads it: bits of the corner's x and z, m, and of cells a metre; columns; rows;
/// then the cells row by row. A cell's word has, from the lowest byte up, itself, the next one, and the same of the next row: what a
/// place between them needs. 255 is all of the sky taken.
pub(super) fn bake(vertices: &[PackedVertex], indices: &[u32]) -> Vec<u32> {
    let standing = standing(vertices, indices);
    let (mut low, mut high) = (Vec2::INFINITY, Vec2::NEG_INFINITY);
    for (corners, _) in &standing {
        for corner in corners {
            (low, high) = (low.min(*corner), high.max(*corner));
        }
    }
    if !(low.is_finite() && high.is_finite()) {
        return vec![0; 5];
    }
    let margin = Vec2::splat(4.0 * REACH);
    let (low, size) = (low - margin, high - low + 2.0 * margin);
    let cell = (size.max_element() / MOST).max(FINEST);
    let mut map = Map::new(low, cell, size);
    // a cell that is coarser than the dark seam shows a fainter one, not a wider one
    let strength = FOOT * (REACH / cell).min(1.0);
    for (corners, height) in &standing {
        for i in 0..3 {
            map.line(corners[i], corners[(i + 1) % 3], strength * (height / TALL).min(1.0));
        }
    }
    map.spread();
    map.packed()
}

/// Triangles that stand on the ground: corners on (x, z), and height, m.
fn standing(vertices: &[PackedVertex], indices: &[u32]) -> Vec<([Vec2; 3], f32)> {
    let triangles = indices.chunks_exact(3).filter_map(|triangle| {
        let mut corners = [Vec3::ZERO; 3];
        for (corner, index) in corners.iter_mut().zip(triangle) {
            let [x, y, z, layer] = vertices.get(*index as usize)?[0];
            if layer > 0.0 {
                return None;
            }
            *corner = Vec3::new(x, y, z);
        }
        let [a, b, c] = corners.map(|corner| corner.y);
        let (low, high) = (a.min(b).min(c), a.max(b).max(c));
        (low < STANDS && high > LEAST && high > low).then(|| (corners.map(|p| Vec2::new(p.x, p.z)), high))
    });
    triangles.collect()
}

/// A grid of shares of the sky that are taken.
struct Map {
    low: Vec2,
    cell: f32,
    columns: usize,
    rows: usize,
    taken: Vec<f32>,
}

impl Map {
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at most 1,025")]
    fn new(low: Vec2, cell: f32, size: Vec2) -> Self {
        let [columns, rows] = (size / cell).to_array().map(|side| side.ceil() as usize + 1);
        Self { low, cell, columns, rows, taken: vec![0.0; columns * rows] }
    }

    /// A wall from a to b.
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        clippy::cast_precision_loss,
        reason = "within the grid, which has margins"
    )]
    fn line(&mut self, a: Vec2, b: Vec2, taken: f32) {
        let steps = (a.distance(b) / (0.5 * self.cell)).ceil().max(1.0) as usize;
        for step in 0..=steps {
            let at = (a.lerp(b, step as f32 / steps as f32) - self.low) / self.cell;
            let index = at.y as usize * self.columns + at.x as usize;
            if let Some(cell) = self.taken.get_mut(index) {
                *cell = cell.max(taken);
            }
        }
    }

    /// Lets every cell have what its neighbours have, less by the way between: once down the grid and once up.
    fn spread(&mut self) {
        let straight = (-self.cell / REACH).exp();
        let slanted = (-self.cell * std::f32::consts::SQRT_2 / REACH).exp();
        let (columns, count) = (self.columns, self.taken.len());
        let before = [(1, straight), (columns - 1, slanted), (columns, straight), (columns + 1, slanted)];
        for index in 0..count {
            for (back, kept) in before {
                if let Some(other) = index.checked_sub(back) {
                    self.taken[index] = self.taken[index].max(kept * self.taken[other]);
                }
            }
        }
        for index in (0..count).rev() {
            for (ahead, kept) in before {
                if index + ahead < count {
                    self.taken[index] = self.taken[index].max(kept * self.taken[index + ahead]);
                }
            }
        }
    }

    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "0 to 255, and a thousand columns"
    )]
    fn packed(&self) -> Vec<u32> {
        let floats = [self.low.x, self.low.y, 1.0 / self.cell].map(f32::to_bits);
        let sides = [self.columns as u32, self.rows as u32];
        let mut words = [&floats[..], &sides[..]].concat();
        let byte = |index: usize| self.taken.get(index).map_or(0, |taken| (taken * 255.0).round() as u8);
        words.extend((0..self.taken.len()).map(|cell| {
            let next = cell + self.columns;
            u32::from_le_bytes([cell, cell + 1, next, next + 1].map(byte))
        }));
        words
    }
}

#[cfg(test)]
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "places on the map")]
mod tests {
    use super::*;

    /// Share taken at a place, of the nearest cell.
    fn taken(map: &[u32], place: Vec2) -> f32 {
        let [x, z, per_metre] = [map[0], map[1], map[2]].map(f32::from_bits);
        let at = (place - Vec2::new(x, z)) * per_metre;
        let index = at.y as u32 * map[3] + at.x as u32;
        (map[5 + index as usize] & 255) as f32 / 255.0
    }

    fn wall(layer: f32, low: f32) -> (Vec<PackedVertex>, Vec<u32>) {
        let corner = |x: f32, y: f32| [[x, y, 3.0, layer], [0.0, 0.0, 1.0, 0.0], [0.0; 4]];
        (
            vec![corner(-5.0, low), corner(5.0, low), corner(5.0, 4.0), corner(-5.0, 4.0)],
            vec![0, 1, 2, 0, 2, 3],
        )
    }

    #[test]
    fn the_ground_darkens_towards_a_wall_from_both_sides() {
        let (vertices, indices) = wall(0.0, 0.0);
        let map = bake(&vertices, &indices);
        let shades = [3.0, 3.6, 4.4, 5.5].map(|z| taken(&map, Vec2::new(0.0, z)));
        assert!(shades[0] > 0.5 && shades.is_sorted_by(|a, b| a > b), "{shades:?}");
        assert!(shades[3] < 0.05, "{shades:?}");
        let before = taken(&map, Vec2::new(0.0, 2.4));
        assert!((before - shades[1]).abs() < 0.15, "{before} {shades:?}");
    }

    #[test]
    fn a_word_has_its_cell_and_the_three_behind_it() {
        let (vertices, indices) = wall(0.0, 0.0);
        let map = bake(&vertices, &indices);
        let (columns, cells) = (map[3] as usize, &map[5..]);
        let own = |cell: usize| cells[cell] & 255;
        for (cell, word) in cells.iter().enumerate().take(cells.len() - columns - 1) {
            let four = [cell, cell + 1, cell + columns, cell + columns + 1].map(|other| own(other) as u8);
            assert_eq!(word.to_le_bytes(), four, "cell {cell}");
        }
    }

    #[test]
    fn what_hangs_in_the_air_and_what_lies_flat_darken_nothing() {
        for (layer, low) in [(1.0, 0.0), (0.0, 1.0)] {
            let (vertices, indices) = wall(layer, low);
            assert_eq!(bake(&vertices, &indices), [0; 5]);
        }
    }
}
