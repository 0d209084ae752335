//! Avatars with rigs as others make them.

use gaitway::avatar::{Avatar, RestJoint};
use gaitway::gait::Joint;
use glam::{Mat4, Quat};

/// A copy of the avatar whose joints have other axes (for tests of rigs as they come) and another size.
pub fn with_joint_axes(avatar: &Avatar, axes: &[Quat; 16], size: f32) -> Avatar {
    let rest = avatar.joints.map(|joint| joint.rotation);
    let model = avatar.model_from_joint(&rest, avatar.joints[0].translation);
    let turned: Vec<Mat4> = (0..16)
        .map(|j| Mat4::from_rotation_translation(axes[j], model[j].w_axis.truncate() * size))
        .collect();
    let mut copy = avatar.clone();
    for j in 0..16 {
        let local = if j == 0 { turned[0] } else { turned[Joint::PARENT[j]].inverse() * turned[j] };
        let (_, rotation, translation) = local.to_scale_rotation_translation();
        copy.joints[j] = RestJoint { translation, rotation, joint_from_mesh: turned[j].inverse() };
    }
    for mesh in &mut copy.levels {
        mesh.vertices.iter_mut().for_each(|v| v.position *= size);
    }
    copy.eyes_in_head = axes[Joint::Head as usize].inverse() * avatar.eyes_in_head * size;
    copy.height *= size;
    copy
}
