//! Sorts the visible agents by bucket and id, and writes the arguments of what follows.

use super::body::far_slot;
use crate::kernels::KernelId;
use crate::kernels::compact::Slices;
use crate::kernels::layout::{FrameUniforms, MeshRange};
use crate::kernels::shared::body::NONE;
use crate::kernels::shared::dispatch::MOST_GROUPS;
use crate::kernels::shared::dispatch::index::RUN;
use crate::kernels::shared::ranks::index::COLUMNS;
use crate::kernels::shared::scan::index::LANES;

/// Agents of each group.
fn groups(frame: &FrameUniforms) -> impl ExactSizeIterator<Item = std::ops::Range<usize>> + use<> {
    let agents = frame.agent_count as usize;
    (0..agents.div_ceil(LANES)).map(move |group| group * LANES..(group * LANES + LANES).min(agents))
}

/// Twin of phase `count` of `shaders/compact.wgsl`.
pub fn compact_count(b: Slices<'_>) {
    for (group, agents) in groups(b.frame).enumerate() {
        let buckets = &b.agent_bucket[agents];
        let near = buckets.iter().filter(|bucket| is_near(**bucket, b.frame)).count();
        let seen = buckets.iter().filter(|bucket| **bucket < b.frame.bucket_count).count();
        b.bucket_counts[group * COLUMNS] = near as u32;
        b.bucket_counts[group * COLUMNS + 1] = seen as u32;
    }
}

/// Twin of phase `scan_visible` of `shaders/compact.wgsl`.
pub fn compact_scan_visible(b: Slices<'_>) {
    (0..2).for_each(|column| scan_column(b.bucket_counts, groups(b.frame).len(), column));
}

/// Twin of phase `demote` of `shaders/compact.wgsl`.
pub fn compact_demote(mut b: Slices<'_>) {
    for (group, agents) in groups(b.frame).enumerate() {
        apply_capacities(&mut b, group, agents);
    }
}

/// Twin of phase `scan_buckets` of `shaders/compact.wgsl`.
pub fn compact_scan_buckets(b: Slices<'_>) {
    (0..COLUMNS).for_each(|column| scan_column(b.bucket_counts, groups(b.frame).len(), column));
}

/// Twin of phase `list` of `shaders/compact.wgsl`.
pub fn compact_list(b: Slices<'_>) {
    for (group, agents) in groups(b.frame).enumerate() {
        let mut next = [0; COLUMNS];
        for (bucket, next) in next.iter_mut().enumerate().take(b.frame.bucket_count as usize) {
            *next = b.bucket_start[bucket] + b.bucket_counts[group * COLUMNS + bucket];
        }
        for bucket in far_buckets(b.frame) {
            next[bucket] = b.bucket_start[bucket + 1] + b.bucket_counts[group * COLUMNS + bucket];
        }
        for agent in agents {
            let bucket = b.agent_bucket[agent];
            if bucket != NONE {
                b.visible[next[bucket as usize] as usize] = agent as u32;
                next[bucket as usize] += 1;
            }
        }
    }
}

fn is_near(bucket: u32, frame: &FrameUniforms) -> bool {
    bucket < frame.bucket_count && bucket.is_multiple_of(frame.level_count)
}

/// Two for each avatar, empty where far bodies are not asked for.
fn far_buckets(frame: &FrameUniforms) -> std::ops::Range<usize> {
    let avatars = frame.bucket_count / frame.level_count.max(1);
    frame.bucket_count as usize..(frame.bucket_count + 2 * avatars) as usize
}

fn scan_column(bucket_counts: &mut [u32], groups: usize, column: usize) {
    let mut total = 0;
    for group in 0..groups {
        let count = bucket_counts[group * COLUMNS + column];
        bucket_counts[group * COLUMNS + column] = total;
        total += count;
    }
    bucket_counts[groups * COLUMNS + column] = total;
}

fn apply_capacities(b: &mut Slices<'_>, group: usize, agents: std::ops::Range<usize>) {
    let mut near = b.bucket_counts[group * COLUMNS];
    let mut seen = b.bucket_counts[group * COLUMNS + 1];
    let mut counts = [0; COLUMNS];
    for agent in agents {
        let mut bucket = b.agent_bucket[agent];
        if bucket == NONE {
            continue;
        }
        if bucket >= b.frame.bucket_count {
            counts[bucket as usize] += 1;
            continue;
        }
        let is_last = seen >= b.frame.visible_capacity;
        let mut demoted = false;
        if is_near(bucket, b.frame) {
            demoted = near >= b.frame.near_capacity.min(MOST_GROUPS);
            near += 1;
        }
        seen += 1;
        if is_last || (demoted && b.frame.level_count == 1) {
            let [.., lod3_distance] = b.frame.level_distance;
            if lod3_distance > 0.0 {
                bucket = b.frame.bucket_count + bucket / b.frame.level_count;
                b.agent_bucket[agent] = bucket;
                counts[bucket as usize] += 1;
                continue;
            }
            b.agent_bucket[agent] = NONE;
            let first = &mut b.failure[KernelId::Compact as usize];
            *first = (*first).min(agent as u32);
            continue;
        }
        if demoted {
            bucket += 1;
            b.agent_bucket[agent] = bucket;
        }
        counts[bucket as usize] += 1;
    }
    b.bucket_counts[group * COLUMNS..(group + 1) * COLUMNS].copy_from_slice(&counts);
}

fn write_command(b: &mut Slices<'_>, command: usize, mesh: usize, count: u32) {
    let MeshRange { first_index, index_count, first_vertex, .. } = b.mesh_table[mesh];
    let words = [index_count, count, first_index, first_vertex, 0];
    b.draw_args[command * 5..command * 5 + 5].copy_from_slice(&words);
}

/// Writes how the agents of a bucket are drawn, and how their shadows are: one level coarser. How many they are.
fn write_draw(b: &mut Slices<'_>, groups: usize, bucket: usize) -> u32 {
    let count = b.bucket_counts[groups * COLUMNS + bucket];
    write_command(b, bucket, bucket, count);
    let (buckets, levels) = (b.frame.bucket_count as usize, b.frame.level_count as usize);
    let is_coarsest = bucket >= buckets || bucket % levels == levels - 1;
    let shadow = if is_coarsest { bucket } else { bucket + 1 };
    write_command(b, far_buckets(b.frame).end + bucket, shadow, count);
    count
}

/// Twin of phase `arguments` of `shaders/compact.wgsl`.
pub fn compact_arguments(mut b: Slices<'_>) {
    let groups = groups(b.frame).len();
    let mut start = 0;
    for bucket in 0..b.frame.bucket_count as usize {
        let count = write_draw(&mut b, groups, bucket);
        b.bucket_start[bucket] = start;
        start += count;
        let levels = b.frame.level_count as usize;
        if bucket.is_multiple_of(levels) {
            let at = 3 + bucket / levels * 3;
            b.dispatch_args[at..at + 3].copy_from_slice(&[
                b.mesh_table[bucket].vertex_count.div_ceil(RUN as u32),
                count,
                1,
            ]);
        }
    }
    b.bucket_start[b.frame.bucket_count as usize] = start;
    b.dispatch_args[..3].copy_from_slice(&[start.div_ceil(RUN as u32), 1, 1]);
    let start = start as usize;
    b.visible[start..(start / RUN + 1) * RUN].fill(NONE);
    let mut far = far_slot(b.frame.visible_capacity as usize) as u32;
    let far_buckets = far_buckets(b.frame);
    for bucket in far_buckets.clone() {
        b.bucket_start[bucket + 1] = far;
        far += write_draw(&mut b, groups, bucket);
    }
    b.bucket_start[far_buckets.end + 1] = far;
}
