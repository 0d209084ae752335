//! Forward kinematics in the world and the matrices for skinning.

use super::body::{JOINTS, PARENTS, PALETTE_STRIDE, POSE_STRIDE, RIG_STRIDE, joint_translation, visible_agents};
use super::exact::sin_cos;
use super::quaternion::{add3, add4, quat_before_yaw, quat_mul, quat_rotate, scale3, scale4, turn_left, xyz};
use crate::kernels::palette::Slices;
use rayon::prelude::*;

/// Twin of `shaders/palette.wgsl`.
pub fn palette(b: Slices<'_>) {
    let Slices { visible, position, stance, look, rig, local_rotations, palettes } = b;
    let slots = palettes.par_chunks_mut(PALETTE_STRIDE).zip(local_rotations.par_chunks(POSE_STRIDE));
    visible_agents(visible).par_iter().zip(slots).for_each(|(agent, (palette, pose))| {
        let agent = *agent as usize;
        let avatar = (look[agent][0] & 255) as usize;
        let scale = f32::from_bits(look[agent][1]);
        let [x, z] = position[agent];
        let heading = stance[agent][0];

        let mut rotations = [[0.0; 4]; JOINTS];
        let mut origins = [[0.0; 3]; JOINTS];
        for joint in 0..JOINTS {
            if joint == 0 {
                let root = xyz(pose[JOINTS]);
                rotations[0] = quat_before_yaw(heading, pose[0]);
                let turned = scale3(turn_left(sin_cos(heading), root), scale);
                origins[0] = [x + turned[0], turned[1], z + turned[2]];
            } else {
                let parent = PARENTS[joint];
                let arm = quat_rotate(rotations[parent], joint_translation(rig, avatar, joint));
                rotations[joint] = quat_mul(rotations[parent], pose[joint]);
                origins[joint] = add3(origins[parent], scale3(arm, scale));
            }
            let rows = world_rows(rotations[joint], scale);
            let bind = avatar * RIG_STRIDE + joint * 4 + 1;
            for axis in 0..3 {
                let [mx, my, mz] = rows[axis];
                let turned = add4(scale4(rig[bind], mx), scale4(rig[bind + 1], my));
                let mut row = add4(turned, scale4(rig[bind + 2], mz));
                row[3] += origins[joint][axis];
                palette[joint * 3 + axis] = row;
            }
        }
    });
}

/// Rows of the rotation matrix of a unit quaternion, times a scale.
fn world_rows([x, y, z, w]: [f32; 4], scale: f32) -> [[f32; 3]; 3] {
    [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - z * w), 2.0 * (x * z + y * w)],
        [2.0 * (x * y + z * w), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - x * w)],
        [2.0 * (x * z - y * w), 2.0 * (y * z + x * w), 1.0 - 2.0 * (x * x + y * y)],
    ]
    .map(|row| scale3(row, scale))
}
