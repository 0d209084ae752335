//! The posture of a clip, by which an emotion is seen from afar: lean of trunk and head, carriage of the arms.

use super::{Avatar, Clip};
use crate::gait::{JOINT_COUNT, Joint};
use crate::kernels::layout::ClipPosture;
use glam::{Mat4, Quat, Vec3};

/// How a body is carried over a stride, against how it stands at rest with its arms hanging (see [`Avatar::far_body`]).
#[derive(Debug, Clone, Copy, PartialEq, Default)]
#[doc(hidden)]
pub struct Posture {
    /// Mean turn of the trunk about the hips, forwards, radians.
    pub lean: f32,
    /// Mean turn of the head against the trunk, forwards, radians.
    pub nod: f32,
    /// Mean turn of the arms away from the trunk, radians.
    pub spread: f32,
    /// Swing of the arms to either side of their middle, radians.
    pub swing: f32,
}

/// How little and how much far bodies show of each, whatever a clip does.
const RANGE: [[f32; 2]; 4] = [[-0.3, 0.5], [-0.5, 0.8], [-0.15, 0.7], [0.0, 0.9]];

impl Posture {
    /// The posture of a clip of this avatar.
    pub fn of(avatar: &Avatar, clip: &Clip) -> Self {
        let rest = Joints::of(&avatar.joints.map(|joint| joint.joint_from_mesh.inverse()), avatar);
        let frames: Vec<Joints> = clip
            .frames
            .iter()
            .map(|frame| Joints::of(&avatar.model_from_joint(&frame.rotations, frame.root), avatar))
            .collect();
        let mean = |angle: &dyn Fn(&Joints) -> f32| {
            let sum: f32 = frames.iter().map(|joints| angle(joints) - angle(&rest)).sum();
            sum / f32::from(u16::try_from(frames.len().max(1)).unwrap_or(u16::MAX))
        };
        let lean = mean(&|joints| joints.lean);
        let swing = [0, 1].map(|side| {
            let angles = frames.iter().map(|joints| joints.forwards[side]);
            let most = angles.clone().fold(f32::MIN, f32::max) - angles.fold(f32::MAX, f32::min);
            if frames.is_empty() { 0.0 } else { 0.5 * most }
        });
        let hanging = libm::atan2f(super::far::HANGING.x, -super::far::HANGING.y);
        let all: f32 = frames.iter().map(|joints| joints.outwards - hanging).sum();
        let spread = all / f32::from(u16::try_from(frames.len().max(1)).unwrap_or(u16::MAX));
        let found = [lean, mean(&|joints| joints.head) - lean, spread, 0.5 * (swing[0] + swing[1])];
        let [lean, nod, spread, swing] = [0, 1, 2, 3].map(|i| {
            let [least, most] = RANGE[i];
            if found[i].is_finite() { found[i].clamp(least, most) } else { 0.0 }
        });
        Self { lean, nod, spread, swing }
    }

    /// As it lies in `clip_postures`.
    pub const fn in_buffer(self) -> ClipPosture {
        let Self { lean, nod, spread, swing } = self;
        ClipPosture { lean, nod, spread, swing }
    }
}

/// Angles of one frame, radians.
struct Joints {
    lean: f32,
    head: f32,
    /// Of the arms against straight down, mean of both.
    outwards: f32,
    /// Of each arm against straight down.
    forwards: [f32; 2],
}

impl Joints {
    fn of(model_from_joint: &[Mat4; JOINT_COUNT], avatar: &Avatar) -> Self {
        let place = |joint: Joint| model_from_joint[joint as usize].w_axis.truncate();
        let trunk = place(Joint::Neck) - place(Joint::Root);
        // where the head's own forward direction points, which at rest is the mesh's
        let head =
            model_from_joint[Joint::Head as usize] * avatar.joints[Joint::Head as usize].joint_from_mesh;
        let ahead = Quat::from_mat4(&head) * Vec3::Z;
        let arm = |shoulder, hand| place(hand) - place(shoulder);
        let arms = [arm(Joint::LeftShoulder, Joint::LeftHand), arm(Joint::RightShoulder, Joint::RightHand)];
        let sides = [1.0, -1.0];
        Self {
            lean: libm::atan2f(trunk.z, trunk.y),
            head: libm::atan2f(-ahead.y, libm::hypotf(ahead.z, ahead.x)),
            outwards: 0.5 * (0..2).map(|i| libm::atan2f(arms[i].x * sides[i], -arms[i].y)).sum::<f32>(),
            forwards: arms.map(|arm| libm::atan2f(arm.z, -arm.y)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Sex, generated, retarget, standing};
    use super::*;
    use crate::emotion::Emotion;
    use crate::gait::walker;

    #[test]
    fn the_sad_hang_their_heads_and_hardly_swing_their_arms_and_who_stands_is_upright() {
        let avatar = generated(Sex::Female);
        let of = |emotion| {
            let gait = walker::person(emotion, walker::Sex::Female, 1, 0).unwrap();
            Posture::of(&avatar, &retarget(&gait, &avatar).unwrap())
        };
        let [sad, happy] = [of(Emotion::Sad), of(Emotion::Happy)];
        assert!(sad.lean + sad.nod > happy.lean + happy.nod + 0.15, "{sad:?} {happy:?}");
        assert!(happy.swing > 1.3 * sad.swing, "{sad:?} {happy:?}");
        let stands = standing(&avatar, Emotion::Neutral, 0);
        let still = Posture::of(&avatar, &stands);
        assert!(still.lean.abs() < 0.05 && still.nod.abs() < 0.05 && still.swing < 0.01, "{still:?}");
        assert_eq!(Posture::of(&avatar, &Clip { frames: Vec::new(), ..stands }).swing.to_bits(), 0);
    }
}
