//! Keeps what pictures show of a crowd's present snapshot.

use super::between::moment_start;
use crate::kernels::keep_snapshot::Slices;

/// Twin of `shaders/keep_snapshot.wgsl`.
pub fn keep_snapshot(b: Slices<'_>) {
    for agent in 0..b.between.agent_count as usize {
        let at = moment_start(b.between, b.place, agent);
        let ([x, z], [heading, walk]) = (b.position[agent], b.stance[agent]);
        b.snapshots[at] = [x, z, heading, walk].map(f32::to_bits);
        b.snapshots[at + 1] = [b.phase[agent], b.elevation[agent].to_bits(), 0, 0];
        b.snapshots[at + 2] = b.gait_weights[agent].map(f32::to_bits);
    }
}
