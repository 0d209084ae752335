//! Twin of `shaders/shared/between.wgsl`: how moments of a crowd are kept.

use crate::kernels::layout::BetweenUniforms;

/// Elements of one agent in a moment: ground position, heading, walk weight; phase, elevation, 0, 0; gait weights.
pub const MOMENT_STRIDE: usize = 3;

/// Where an agent's elements of the moment at a place begin.
pub fn moment_start(between: &BetweenUniforms, place: u32, agent: usize) -> usize {
    (place as usize * between.agent_count as usize + agent) * MOMENT_STRIDE
}
