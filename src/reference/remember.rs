//! Keeps what pictures show of a crowd's present moment.

use super::between::moment_start;
use crate::kernels::remember::Slices;

/// Twin of `shaders/remember.wgsl`.
pub fn remember(b: Slices<'_>) {
    for agent in 0..b.between.agent_count as usize {
        let at = moment_start(b.between, b.place, agent);
        let ([x, z], [heading, walk]) = (b.position[agent], b.stance[agent]);
        b.moments[at] = [x, z, heading, walk].map(f32::to_bits);
        b.moments[at + 1] = [b.phase[agent], b.elevation[agent].to_bits(), 0, 0];
        b.moments[at + 2] = b.gait_weights[agent].map(f32::to_bits);
    }
}
