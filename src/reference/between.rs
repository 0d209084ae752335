//! Twin of `shaders/shared/between.wgsl`: how snapshots of a crowd are kept.

use crate::kernels::layout::BetweenUniforms;
use crate::kernels::shared::between::index::SNAPSHOT_STRIDE;

/// Where an agent's elements of the snapshot at a place begin.
pub fn moment_start(between: &BetweenUniforms, place: u32, agent: usize) -> usize {
    (place as usize * between.agent_count as usize + agent) * SNAPSHOT_STRIDE
}
