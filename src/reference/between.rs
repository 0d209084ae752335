//! Twin of `shaders/shared/between.wgsl`: how snapshots of a crowd are kept.

use crate::kernels::layout::BetweenUniforms;

/// The index of an agent's element of the snapshot at a place.
pub const fn index_of(between: &BetweenUniforms, place: u32, agent: usize) -> usize {
    place as usize * between.agent_count as usize + agent
}
