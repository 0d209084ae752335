//! Finds the agents hidden behind bodies that are drawn already.

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
    let body = b.appearance[agent];
    let tall = body.scale * body.stature();
    let [at_x, at_z] = b.position[agent];
    let foot = b.elevation[agent];
    let radius = reach * body.scale * body.breadth();
    let (mut low, mut high) = ([1.0e30_f32; 2], [-1.0e30_f32; 2]);
    let mut nearest = 0.0;
    for corner in 0..8 {
        let x = at_x + if corner & 1 == 1 { radius } else { -radius };
        let y = foot + if corner & 2 == 2 { highest } else { lowest } * tall;
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
    tiles(b.sight, eye, seen).all(|tile| b.tile_depth[tile] > nearest)
}

/// Slots that are sifted, each with its bucket and agent.
fn candidates<'a>(b: &Slices<'a>) -> impl Iterator<Item = (usize, usize, usize)> + use<'a> {
    let (sight, starts, visible) = (b.sight, b.bucket_start, b.visible);
    let mut bucket = sight.first_bucket;
    (start_of(sight, starts, bucket)..start_of(sight, starts, sight.bucket_end)).map(move |slot| {
        bucket = bucket_of(sight, starts, slot, bucket);
        (slot as usize, bucket as usize, visible[slot as usize] as usize)
    })
}

/// Whether an agent of a bucket is shown whatever stands before it.
fn is_shown(b: &Slices<'_>, agent: usize, bucket: usize) -> bool {
    let sight = b.sight;
    let start = |bucket| start_of(sight, b.bucket_start, bucket);
    let [_, [_, _, top, _]] = sight.bounds[bucket];
    let body = b.appearance[agent];
    let head = top * (body.scale * body.stature());
    start(sight.bucket_end) - start(sight.first_bucket) < sight.fewest
        || sight.eye_height > b.elevation[agent] + head + DOWN
}

/// How the eyes see the boxes of an agent, heads first.
fn parts(b: &Slices<'_>, agent: usize, bucket: usize) -> impl Iterator<Item = (usize, Seen)> {
    let count = 2 * b.sight.eye_count.min(2) as usize;
    (0..count).map(move |part| {
        let eye = part >> 1;
        (eye, look_at(b, eye, agent, b.sight.bounds[bucket][1 - (part & 1)]))
    })
}

/// Twin of phase `mark` of `shaders/occlude.wgsl`.
pub fn occlude_mark(b: Slices<'_>) {
    for (_, bucket, agent) in candidates(&b) {
        if is_shown(&b, agent, bucket) {
            continue;
        }
        let marked: Vec<usize> = parts(&b, agent, bucket)
            .filter(|(_, seen)| seen.is_judged)
            .flat_map(|(eye, seen)| blocks(b.sight, eye, &seen))
            .collect();
        marked.into_iter().for_each(|block| b.wanted[block] = 1);
    }
}

/// Twin of phase `judge` of `shaders/occlude.wgsl`.
pub fn occlude_judge(b: Slices<'_>) {
    for (slot, bucket, agent) in candidates(&b) {
        let is_behind = |(eye, seen): (usize, Seen)| seen.is_judged && is_behind(&b, eye, &seen);
        let is_hidden = !is_shown(&b, agent, bucket) && parts(&b, agent, bucket).all(is_behind);
        b.hidden[slot] = u32::from(is_hidden);
    }
}
