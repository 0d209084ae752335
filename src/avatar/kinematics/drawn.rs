//! The body as drawn: its joints, the pitch of its feet, and whether planted soles slide.

use super::angles::Walk;
use crate::avatar::foot::{Footprint, footprint, vertices};
use crate::avatar::{Avatar, CLIP_FRAMES, Clip};
use crate::gait::{Gait, Joint, Pose};
use glam::{Mat4, Vec3};

/// A sole below this height touches the ground, m.
const ON_GROUND: f32 = 0.006;

/// What passes over the ground faster, in speeds of the walk, is in swing, however low.
const STILL: f32 = 0.2;

const FEET: [Joint; 2] = [Joint::LeftFoot, Joint::RightFoot];

/// The walk of a body, and the mean slide of its planted soles, mm a frame.
pub(super) fn walk(gait: &Gait, clip: &Clip, avatar: &Avatar) -> (Walk, f32) {
    let model: Vec<[Mat4; Joint::ALL.len()]> =
        clip.frames.iter().map(|frame| avatar.model_from_joint(&frame.rotations, frame.root)).collect();
    let (poses, foot_pitch) = model.iter().map(|joints| picture(joints, avatar)).unzip();
    let slides: Vec<f32> =
        FEET.into_iter().filter_map(|foot| slide(clip, avatar, &model, foot)).flatten().collect();
    let walk = Walk { poses, foot_pitch, cycle_time: gait.cycle_time(), travel: clip.stride_travel };
    (walk, super::angles::mean(&slides))
}

/// Places of the joints of a body, m, and the pitch of its feet against where they stand flat: left, right; degrees, toe up.
pub(crate) fn picture(model_from_joint: &[Mat4; Joint::ALL.len()], avatar: &Avatar) -> (Pose, [f32; 2]) {
    let rest_rotations = avatar.joints.map(|joint| joint.rotation);
    let rest = avatar.model_from_joint(&rest_rotations, avatar.joints[0].translation);
    let pitch = |foot: Joint| {
        let foot = foot as usize;
        let ahead = (model_from_joint[foot] * rest[foot].inverse()).transform_vector3(Vec3::Z);
        libm::atan2f(ahead.y, ahead.z).to_degrees()
    };
    (model_from_joint.map(|joint| joint.w_axis.truncate()), FEET.map(pitch))
}

/// How far heel and ball of a foot move along the ground in each frame in which they touch it, mm. None for a body without
/// vertices there.
fn slide(clip: &Clip, avatar: &Avatar, model: &[[Mat4; Joint::ALL.len()]], foot: Joint) -> Option<Vec<f32>> {
    let joint = foot as usize;
    vertices(avatar, foot).next()?;
    let rest = avatar.joints[joint].joint_from_mesh.inverse().w_axis.truncate();
    let Footprint { heel, ball, .. } = footprint(avatar, foot, rest);
    #[allow(clippy::cast_precision_loss, reason = "64")]
    let back = Vec3::Z * clip.stride_travel / CLIP_FRAMES as f32;
    let mut slides = Vec::new();
    for point in [heel, ball] {
        let bound = avatar.joints[joint].joint_from_mesh.transform_point3(point);
        let path: Vec<Vec3> = model.iter().map(|joints| joints[joint].transform_point3(bound)).collect();
        let count = path.len();
        for frame in 0..count {
            let [before, now, after] = [frame + count - 1, frame, frame + 1].map(|k| path[k % count]);
            let over_ground = |from: Vec3, to: Vec3| libm::hypotf(to.x - from.x, to.z - from.z + back.z);
            let moved = [over_ground(before, now), over_ground(now, after)];
            let is_planted = moved.iter().all(|moved| *moved < STILL * back.z);
            if is_planted && [before, now, after].iter().all(|p| p.y < ON_GROUND) {
                slides.push(500.0 * over_ground(before, after + back));
            }
        }
    }
    Some(slides)
}
