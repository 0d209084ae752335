//! Puts the pose of every visible agent on the floor it stands on.

use super::body::visible_agents;
use crate::kernels::shared::body::index::{JOINTS, POSE_STRIDE};
use crate::kernels::stand::Slices;

/// Twin of `shaders/stand.wgsl`.
pub fn stand(b: Slices<'_>) {
    let Slices { visible, elevation, appearance, local_rotations } = b;
    for (agent, pose) in visible_agents(visible).iter().zip(local_rotations.chunks_mut(POSE_STRIDE)) {
        let agent = *agent as usize;
        let [_, height, ..] = &mut pose[JOINTS];
        *height += elevation[agent] / appearance[agent].scale;
    }
}
