//! Who is hidden behind what has been drawn already.

use super::sight::{bucket_of, start_of};
use crate::kernels::layout::SightUniforms;
use crate::kernels::occlude::{BEHIND, DOWN, MOST_TILES, NEARER, PAD, Slices};
use crate::kernels::shared::block::BLOCK;

/// How an eye sees a box of an agent.
struct Seen {
    is_judged: bool,
    low: [u32; 2],
    high: [u32; 2],
    nearest: f32,
}

fn tile_at(pixel: f32, side: u32, most: u32) -> u32 {
    let tile = (pixel / side as f32).floor();
    if !(tile > 0.0) {
        return 0;
    }
    if tile >= most as f32 {
        return most;
    }
    tile as u32
}

fn look_at(b: &Slices<'_>, eye: usize, agent: usize, bounds: [f32; 4]) -> Seen {
    let sight = b.sight;
    let m = &sight.clip_from_world[eye];
    let [reach, lowest, highest, _] = bounds;
    let scale = f32::from_bits(b.look[agent][1]);
    let [at_x, at_z] = b.position[agent];
    let foot = b.elevation[agent];
    let radius = reach * scale;
    let (mut low, mut high) = ([1.0e30_f32; 2], [-1.0e30_f32; 2]);
    let mut nearest = 0.0;
    for corner in 0..8 {
        let x = at_x + if corner & 1 == 1 { radius } else { -radius };
        let y = foot + if corner & 2 == 2 { highest } else { lowest } * scale;
        let z = at_z + if corner & 4 == 4 { radius } else { -radius };
        let row = |i: usize| m[0][i] * x + m[1][i] * y + m[2][i] * z + m[3][i];
        let w = row(3);
        if !(w > BEHIND) {
            return Seen { is_judged: false, low: [0; 2], high: [0; 2], nearest: 0.0 };
        }
        let pixel = [(row(0) / w * 0.5 + 0.5) * sight.width, (row(1) / w * 0.5 + 0.5) * sight.height];
        let depth = row(2) / w;
        for axis in 0..2 {
            low[axis] = if pixel[axis] < low[axis] { pixel[axis] } else { low[axis] };
            high[axis] = if pixel[axis] > high[axis] { pixel[axis] } else { high[axis] };
        }
        nearest = if depth > nearest { depth } else { nearest };
    }
    if high[0] < -1.0 || high[1] < -1.0 || low[0] > sight.width + 1.0 || low[1] > sight.height + 1.0 {
        return Seen { is_judged: true, low: [0; 2], high: [0; 2], nearest: 0.0 };
    }
    let most = [sight.tile_columns - 1, sight.tile_rows - 1];
    let sides = [sight.tile_width, sight.tile_height];
    let first = [0, 1].map(|axis| tile_at(low[axis] - PAD, sides[axis], most[axis]));
    let end = [0, 1].map(|axis| tile_at(high[axis] + PAD, sides[axis], most[axis]) + 1);
    let tiles = (end[0] - first[0]) * (end[1] - first[1]);
    Seen { is_judged: tiles <= MOST_TILES, low: first, high: end, nearest }
}

/// The tiles of an eye that a box touches.
fn tiles(sight: &SightUniforms, eye: usize, seen: &Seen) -> impl Iterator<Item = usize> + use<> {
    let columns = sight.tile_columns as usize;
    let base = eye * columns * sight.tile_rows as usize;
    let across = seen.low[0] as usize..seen.high[0] as usize;
    (seen.low[1] as usize..seen.high[1] as usize)
        .flat_map(move |row| across.clone().map(move |column| base + row * columns + column))
}

/// The blocks of tiles that it touches.
fn blocks(sight: &SightUniforms, eye: usize, seen: &Seen) -> impl Iterator<Item = usize> + use<> {
    let columns = sight.tile_columns.div_ceil(BLOCK);
    let base = eye as u32 * columns * sight.tile_rows.div_ceil(BLOCK);
    let range = |axis: usize| seen.low[axis] / BLOCK..seen.high[axis].div_ceil(BLOCK);
    let across = range(0);
    range(1).flat_map(move |row| across.clone().map(move |column| (base + row * columns + column) as usize))
}

fn is_behind(b: &Slices<'_>, eye: usize, seen: &Seen) -> bool {
    let nearest = seen.nearest * NEARER;
    tiles(b.sight, eye, seen).all(|tile| b.farthest[tile] > nearest)
}

/// Twin of `shaders/occlude.wgsl`.
pub fn occlude(b: Slices<'_>) {
    let sight = b.sight;
    let first = start_of(sight, b.bucket_start, sight.first_bucket);
    let end = start_of(sight, b.bucket_start, sight.bucket_end);
    for slot in first..end {
        let bucket = bucket_of(sight, b.bucket_start, slot, sight.first_bucket);
        let agent = b.visible[slot as usize] as usize;
        let head = sight.bounds[bucket as usize][1][2] * f32::from_bits(b.look[agent][1]);
        if end - first < sight.fewest || sight.eye_height > b.elevation[agent] + head + DOWN {
            if b.level == 1 {
                b.hidden[slot as usize] = 0;
            }
            continue;
        }
        let mut is_hidden = true;
        for part in 0..2 * sight.eye_count.min(2) as usize {
            let eye = part >> 1;
            let seen = look_at(&b, eye, agent, sight.bounds[bucket as usize][1 - (part & 1)]);
            if b.level == 0 {
                if seen.is_judged {
                    blocks(sight, eye, &seen).for_each(|block| b.wanted[block] = 1);
                }
            } else {
                is_hidden = seen.is_judged && is_behind(&b, eye, &seen);
                if !is_hidden {
                    break;
                }
            }
        }
        if b.level == 1 {
            b.hidden[slot as usize] = u32::from(is_hidden);
        }
    }
}
