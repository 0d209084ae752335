//! Keeps the drawn state of a crowd's present snapshot.

use super::between::index_of;
use crate::kernels::keep_snapshot::Slices;
use crate::kernels::layout::{Snapshot, Stance};

/// Twin of `shaders/keep_snapshot.wgsl`.
pub fn keep_snapshot(b: Slices<'_>) {
    for agent in 0..b.between.agent_count as usize {
        let Stance { phase, walk_weight, left, right, turns, lean, heights, slopes, stride, foresight } =
            b.stance[agent];
        b.snapshots[index_of(b.between, b.place, agent)] = Snapshot {
            position: b.position[agent],
            heading: b.heading[agent],
            walk_weight,
            gait_weights: b.gait_weights[agent],
            phase,
            elevation: b.elevation[agent],
            stride,
            foresight,
            left,
            right,
            turns,
            lean,
            heights,
            slopes,
        };
    }
}
