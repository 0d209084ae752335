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
        let [low_x, low_y, high_x, high_y] = b.teleports[2 * own as usize];
        if here[0] < low_x || here[1] < low_y || here[0] > high_x || here[1] > high_y {
            continue;
        }
        let to = b.teleports[2 * own as usize + 1];
        let bits = hash_u32(agent as u32 ^ hash_u32(b.step.step_index ^ !b.step.seed));
        let share = [unit_f32(bits), unit_f32(hash_u32(bits))];
        b.position[agent] = [to[0] + (to[2] - to[0]) * share[0], to[1] + (to[3] - to[1]) * share[1]];
    }
}
