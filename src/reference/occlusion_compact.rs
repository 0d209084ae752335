//! Lists the visible agents, with the arguments of their draws.

use super::sight::{bucket_of, start_of};
use crate::kernels::occlusion_compact::Slices;
use crate::kernels::shared::scan::index::LANES;

/// Slots that are sifted.
fn sifted(b: &Slices<'_>) -> std::ops::Range<u32> {
    let start = |bucket| start_of(b.sight, b.bucket_start, bucket);
    start(b.sight.first_bucket)..start(b.sight.bucket_end)
}

/// Slots of each group.
fn groups(b: &Slices<'_>) -> impl ExactSizeIterator<Item = std::ops::Range<u32>> + use<> {
    let all = sifted(b);
    let of = move |group: usize| {
        let first = all.start + (group * LANES) as u32;
        first..all.end.min(first + LANES as u32)
    };
    (0..sifted(b).len().div_ceil(LANES)).map(of)
}

/// Twin of phase `count` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_count(b: Slices<'_>) {
    for (group, slots) in groups(&b).enumerate() {
        b.group_shown[group] = slots.map(|slot| 1 - b.hidden[slot as usize]).sum();
    }
}

/// Twin of phase `scan` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_scan(b: Slices<'_>) {
    let groups = groups(&b).len();
    let mut total = 0;
    for group in 0..groups {
        let seen = b.group_shown[group];
        b.group_shown[group] = total;
        total += seen;
    }
    b.group_shown[groups] = total;
}

/// Calls `visit` with each sifted slot, and how many are seen before it.
fn for_each(b: &mut Slices<'_>, visit: impl Fn(&mut Slices<'_>, u32, u32)) {
    for (group, slots) in groups(b).enumerate() {
        let mut before = b.group_shown[group];
        for slot in slots {
            visit(b, slot, before);
            before += 1 - b.hidden[slot as usize];
        }
    }
}

/// Twin of phase `starts` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_starts(mut b: Slices<'_>) {
    let start = |b: &mut Slices<'_>, slot, before| {
        for bucket in b.sight.first_bucket..=b.sight.bucket_end {
            if start_of(b.sight, b.bucket_start, bucket) == slot {
                b.bucket_shown[bucket as usize] = before;
            }
        }
    };
    for_each(&mut b, start);
    let (end, total) = (sifted(&b).end, b.group_shown[groups(&b).len()]);
    start(&mut b, end, total);
}

/// Twin of phase `list` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_list(mut b: Slices<'_>) {
    for_each(&mut b, |b, slot, before| {
        if b.hidden[slot as usize] == 0 {
            let bucket = bucket_of(b.sight, b.bucket_start, slot, b.sight.first_bucket);
            let place = start_of(b.sight, b.bucket_start, bucket) + before - b.bucket_shown[bucket as usize];
            b.shown[place as usize] = slot;
        }
    });
    for bucket in b.sight.first_bucket as usize..b.sight.bucket_end as usize {
        let at = bucket * 5;
        b.shown_args[at..at + 5].copy_from_slice(&b.draw_args[at..at + 5]);
        b.shown_args[at + 1] = b.bucket_shown[bucket + 1] - b.bucket_shown[bucket];
    }
}
