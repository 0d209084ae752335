//! Lists the visible agents, with the arguments of their draws.

use super::sight::{bucket_of, start_of};
use crate::kernels::occlusion_compact::Slices;
use crate::kernels::shared::dispatch::index::RUN;

/// Slots that are seen before number `count` of the sifted ones, the first of which is `first`.
fn seen_before(b: &Slices<'_>, first: u32, count: u32) -> u32 {
    let run = count as usize / RUN;
    let of_run = (run * RUN) as u32..count;
    b.run_shown[run] + of_run.map(|i| 1 - b.hidden[(first + i) as usize]).sum::<u32>()
}

/// Slots that are sifted.
fn sifted(b: &Slices<'_>) -> std::ops::Range<u32> {
    let sight = b.sight;
    let start = |bucket| start_of(sight, b.bucket_start, bucket);
    start(sight.first_bucket)..start(sight.bucket_end)
}

/// Slots of each run.
fn runs(b: &Slices<'_>) -> impl Iterator<Item = (usize, std::ops::Range<u32>)> + use<> {
    let all = sifted(b);
    let of = move |run: usize| {
        let first = all.start + (run * RUN) as u32;
        (run, first..all.end.min(first + RUN as u32))
    };
    (0..sifted(b).len().div_ceil(RUN)).map(of)
}

/// Twin of phase `count` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_count(b: Slices<'_>) {
    for (run, slots) in runs(&b) {
        b.run_shown[run] = slots.map(|slot| 1 - b.hidden[slot as usize]).sum();
    }
}

/// Twin of phase `scan` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_scan(b: Slices<'_>) {
    let runs = sifted(&b).len().div_ceil(RUN);
    let mut total = 0;
    for run in 0..runs {
        let seen = b.run_shown[run];
        b.run_shown[run] = total;
        total += seen;
    }
    b.run_shown[runs] = total;
}

/// Twin of phase `list` of `shaders/occlusion_compact.wgsl`.
pub fn occlusion_compact_list(mut b: Slices<'_>) {
    let (sight, first) = (b.sight, sifted(&b).start);
    for (run, slots) in runs(&b) {
        write_shown(&mut b, run, first, slots);
    }
    for bucket in sight.first_bucket..sight.bucket_end {
        let at = bucket as usize * 5;
        let before = |bucket: u32| seen_before(&b, first, start_of(sight, b.bucket_start, bucket) - first);
        let count = before(bucket + 1) - before(bucket);
        b.shown_args[at..at + 5].copy_from_slice(&b.draw_args[at..at + 5]);
        b.shown_args[at + 1] = count;
    }
}

fn write_shown(b: &mut Slices<'_>, run: usize, first: u32, slots: std::ops::Range<u32>) {
    let sight = b.sight;
    let mut seen = b.run_shown[run];
    let mut bucket = bucket_of(sight, b.bucket_start, slots.start, sight.first_bucket);
    let mut before = seen_before(b, first, start_of(sight, b.bucket_start, bucket) - first);
    for slot in slots {
        let of_slot = bucket_of(sight, b.bucket_start, slot, bucket);
        if of_slot != bucket {
            bucket = of_slot;
            before = seen;
        }
        if b.hidden[slot as usize] == 0 {
            let at = start_of(sight, b.bucket_start, bucket) + seen - before;
            b.shown[at as usize] = slot;
            seen += 1;
        }
    }
}
