//! Walkers on a way without an end.

use super::exact::{hash_u32, unit_f32};
use crate::kernels::shared::absent::NOBODY;
use crate::kernels::teleport::Slices;

/// Twin of `shaders/teleport.wgsl`.
pub fn teleport(b: Slices<'_>) {
    for agent in 0..b.step.agent_count as usize {
        let own = b.teleport_of[agent];
        if own == NOBODY {
            continue;
        }
        let here = b.position[agent];
        let boxes = b.teleports[own as usize];
        let ([low_x, low_y], [high_x, high_y]) = (boxes.from_low, boxes.from_high);
        if here[0] < low_x || here[1] < low_y || here[0] > high_x || here[1] > high_y {
            continue;
        }
        let bits = hash_u32(agent as u32 ^ hash_u32(b.step.step_index ^ !b.step.seed));
        let ([x, z], [end_x, end_z]) = (boxes.to_low, boxes.to_high);
        b.position[agent] = [x + (end_x - x) * unit_f32(bits), z + (end_z - z) * unit_f32(hash_u32(bits))];
    }
}
