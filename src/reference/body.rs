//! Twin of `shaders/shared/body.wgsl` and `rig.wgsl`: how bodies lie in the flat buffers.

use crate::avatar::{Avatar, CLIP_FRAMES, ClipFrame, Vertex};
use crate::gait::JOINT_COUNT;

/// Elements of a pose in `clip_frames` and `local_rotations`: 16 local rotations, then the root's position.
pub const POSE_STRIDE: usize = JOINT_COUNT + 1;
/// Elements of an avatar in `rig`: per joint its rest translation and three rows of `joint_from_mesh`, then the eyes.
pub const RIG_STRIDE: usize = 4 * JOINT_COUNT + 1;
/// Element of an avatar's rig that holds the midpoint of the eyes in the head joint.
pub const RIG_EYES: usize = 4 * JOINT_COUNT;
/// Elements of an agent in `palettes`: three rows per joint.
pub const PALETTE_STRIDE: usize = 3 * JOINT_COUNT;
/// Elements of a vertex in `mesh_vertices`.
pub const VERTEX_STRIDE: usize = 4;
/// Elements of a vertex in `skinned`.
pub const SKINNED_STRIDE: usize = 2;
/// Elements of a clip in `clip_frames`.
pub const CLIP_STRIDE: usize = CLIP_FRAMES * POSE_STRIDE;
/// Ends the list `visible`; in `agent_bucket`: not drawn.
pub const NONE: u32 = u32::MAX;
/// Agents that one invocation of `compact` walks, and invocations of a group of the kernels per visible agent.
pub const RUN: usize = 64;
/// Most buckets there can be: columns of `bucket_counts`.
pub const COLUMNS: usize = 16;

/// Slots that `visible` must have for a capacity: a whole number of groups and at least one [`NONE`].
pub const fn visible_slots(capacity: usize) -> usize {
    (capacity / RUN + 1) * RUN
}

/// The visible agents: what stands before the first [`NONE`].
pub fn visible_agents(visible: &[u32]) -> &[u32] {
    &visible[..visible.iter().position(|agent| *agent == NONE).unwrap_or(visible.len())]
}

/// Rest translation of a joint in its parent, m.
pub fn joint_translation(rig: &[[f32; 4]], avatar: usize, joint: usize) -> [f32; 3] {
    let [x, y, z, _] = rig[avatar * RIG_STRIDE + joint * 4];
    [x, y, z]
}

/// Where the model's +z points, seen from the joint at rest: a column of `joint_from_mesh`, not normalised.
pub fn joint_forward(rig: &[[f32; 4]], avatar: usize, joint: usize) -> [f32; 3] {
    let at = avatar * RIG_STRIDE + joint * 4;
    [rig[at + 1][2], rig[at + 2][2], rig[at + 3][2]]
}

/// An avatar as it lies in `rig`.
pub fn rig_elements(avatar: &Avatar) -> [[f32; 4]; RIG_STRIDE] {
    let mut rig = [[0.0; 4]; RIG_STRIDE];
    for (joint, rest) in avatar.joints.iter().enumerate() {
        rig[joint * 4] = rest.translation.extend(0.0).to_array();
        for axis in 0..3 {
            rig[joint * 4 + 1 + axis] = rest.joint_from_mesh.row(axis).to_array();
        }
    }
    rig[RIG_EYES] = avatar.eyes_in_head.extend(0.0).to_array();
    rig
}

/// A frame of a clip as it lies in `clip_frames`.
pub fn clip_elements(frame: &ClipFrame) -> [[f32; 4]; POSE_STRIDE] {
    std::array::from_fn(|element| match frame.rotations.get(element) {
        Some(rotation) => rotation.to_array(),
        None => frame.root.extend(0.0).to_array(),
    })
}

/// A vertex as it lies in `mesh_vertices`.
pub fn vertex_elements(vertex: &Vertex) -> [[f32; 4]; VERTEX_STRIDE] {
    [
        vertex.position.extend(f32::from_bits(vertex.material as u32)).to_array(),
        vertex.normal.extend(f32::from_bits(u32::from_le_bytes(vertex.joints))).to_array(),
        vertex.weights,
        vertex.color.extend(0.0).to_array(),
    ]
}
