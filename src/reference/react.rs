//! An agent that has not yet reacted stands.

use crate::kernels::react::Slices;

/// Twin of `shaders/react.wgsl`.
pub fn react(b: Slices<'_>) {
    let agents = b.step.agent_count as usize;
    for (preferred, reaction) in b.preferred_velocity[..agents].iter_mut().zip(b.reaction) {
        if b.step.step_index < *reaction {
            *preferred = [0.0, 0.0];
        }
    }
}
