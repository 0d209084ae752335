//! Twin of `shaders/shared/between.wgsl`: how moments of a crowd are kept.

use crate::kernels::layout::BetweenUniforms;
use crate::kernels::shared::between::index::MOMENT_STRIDE;

/// Where an agent's elements of the moment at a place begin.
pub fn moment_start(between: &BetweenUniforms, place: u32, agent: usize) -> usize {
    (place as usize * between.agent_count as usize + agent) * MOMENT_STRIDE
}
