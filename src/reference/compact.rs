//! Sorts the visible agents by bucket and id, and writes the arguments of what follows.

use super::body::{COLUMNS, NONE, RUN};
use crate::kernels::KernelId;
use crate::kernels::compact::Slices;

/// Groups along one axis, on every device.
const MOST_GROUPS: u32 = 65535;

/// Twin of `shaders/compact.wgsl`.
pub fn compact(mut b: Slices<'_>) {
    let agents = b.frame.agent_count as usize;
    let runs = agents.div_ceil(RUN);
    let run_agents = |run: usize| run * RUN..(run * RUN + RUN).min(agents);
    match b.level {
        0 => {
            for run in 0..runs {
                let buckets = &b.agent_bucket[run_agents(run)];
                let near = buckets.iter().filter(|bucket| is_near(**bucket, b.frame.level_count)).count();
                let seen = buckets.iter().filter(|bucket| **bucket != NONE).count();
                b.bucket_counts[run * COLUMNS] = near as u32;
                b.bucket_counts[run * COLUMNS + 1] = seen as u32;
            }
        }
        1 => (0..2).for_each(|column| scan_column(b.bucket_counts, runs, column)),
        2 => (0..runs).for_each(|run| apply_capacities(&mut b, run, run_agents(run))),
        3 => (0..COLUMNS).for_each(|column| scan_column(b.bucket_counts, runs, column)),
        4 => write_arguments(&mut b, runs),
        _ => {
            for run in 0..runs {
                let mut next = [0; COLUMNS];
                for (bucket, next) in next.iter_mut().enumerate().take(b.frame.bucket_count as usize) {
                    *next = b.bucket_start[bucket] + b.bucket_counts[run * COLUMNS + bucket];
                }
                for agent in run_agents(run) {
                    let bucket = b.agent_bucket[agent];
                    if bucket != NONE {
                        b.visible[next[bucket as usize] as usize] = agent as u32;
                        next[bucket as usize] += 1;
                    }
                }
            }
        }
    }
}

fn is_near(bucket: u32, level_count: u32) -> bool {
    bucket != NONE && bucket.is_multiple_of(level_count)
}

fn scan_column(bucket_counts: &mut [u32], runs: usize, column: usize) {
    let mut total = 0;
    for run in 0..runs {
        let count = bucket_counts[run * COLUMNS + column];
        bucket_counts[run * COLUMNS + column] = total;
        total += count;
    }
    bucket_counts[runs * COLUMNS + column] = total;
}

fn apply_capacities(b: &mut Slices<'_>, run: usize, agents: std::ops::Range<usize>) {
    let mut near = b.bucket_counts[run * COLUMNS];
    let mut seen = b.bucket_counts[run * COLUMNS + 1];
    let mut counts = [0; COLUMNS];
    for agent in agents {
        let mut bucket = b.agent_bucket[agent];
        if bucket == NONE {
            continue;
        }
        let is_last = seen >= b.frame.visible_capacity;
        let mut demoted = false;
        if is_near(bucket, b.frame.level_count) {
            demoted = near >= b.frame.near_capacity.min(MOST_GROUPS);
            near += 1;
        }
        seen += 1;
        if is_last || (demoted && b.frame.level_count == 1) {
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
    b.bucket_counts[run * COLUMNS..(run + 1) * COLUMNS].copy_from_slice(&counts);
}

fn write_arguments(b: &mut Slices<'_>, runs: usize) {
    let mut start = 0;
    for bucket in 0..b.frame.bucket_count as usize {
        let count = b.bucket_counts[runs * COLUMNS + bucket];
        let [first_index, index_count, first_vertex, vertex_count] = b.mesh_table[bucket];
        b.bucket_start[bucket] = start;
        start += count;
        b.draw_args[bucket * 5..bucket * 5 + 5].copy_from_slice(&[
            index_count,
            count,
            first_index,
            first_vertex,
            0,
        ]);
        let levels = b.frame.level_count as usize;
        if bucket.is_multiple_of(levels) {
            let at = 3 + bucket / levels * 3;
            b.dispatch_args[at..at + 3].copy_from_slice(&[vertex_count.div_ceil(RUN as u32), count, 1]);
        }
    }
    b.bucket_start[b.frame.bucket_count as usize] = start;
    b.dispatch_args[..3].copy_from_slice(&[start.div_ceil(RUN as u32), 1, 1]);
    let start = start as usize;
    b.visible[start..(start / RUN + 1) * RUN].fill(NONE);
}
