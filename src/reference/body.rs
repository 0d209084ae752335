//! Twin of `shaders/shared/body.wgsl` and `rig.wgsl`: how bodies lie in the flat buffers.

/// Joints of a body, by number as in `gait::skeleton::Joint`.
pub const JOINTS: usize = 16;
/// The chest.
pub const SPINE: usize = 1;
/// The joint that gazes turn first.
pub const NECK: usize = 2;
/// The joint that carries the eyes.
pub const HEAD: usize = 3;
/// Parent of each joint; parents stand before their children, the root is its own.
pub const PARENTS: [usize; JOINTS] = [0, 0, 1, 2, 1, 4, 5, 1, 7, 8, 0, 10, 11, 0, 13, 14];
/// Frames of a clip.
pub const CLIP_FRAMES: usize = 64;
/// Elements of a pose in `clip_frames` and `local_rotations`: 16 local rotations, then the root's position.
pub const POSE_STRIDE: usize = JOINTS + 1;
/// Elements of an avatar in `rig`: per joint its rest translation and three rows of `joint_from_mesh`, then the eyes.
pub const RIG_STRIDE: usize = 4 * JOINTS + 1;
/// Element of an avatar's rig that holds the midpoint of the eyes in the head joint.
pub const RIG_EYES: usize = 4 * JOINTS;
/// Elements of an agent in `palettes`: three rows per joint.
pub const PALETTE_STRIDE: usize = 3 * JOINTS;
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
