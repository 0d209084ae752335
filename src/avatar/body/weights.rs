//! Skin weights of the generated bodies, as functions of the position in the rest pose.

use super::shape::Shares;
use crate::gait::{JOINT_COUNT, Joint};
use glam::Vec3;

/// Hermite step from 0 at `low` to 1 at `high`.
pub(super) fn step(low: f32, high: f32, value: f32) -> f32 {
    let t = ((value - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Joints of one limb: (upper, middle, end), e.g. shoulder, elbow, hand.
pub(super) type Chain = [Joint; 3];

/// Joint positions of a body in its rest pose, with the blend widths that make it bend well.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bones {
    pub(super) at: [Vec3; JOINT_COUNT],
}

impl Bones {
    pub(super) fn of(&self, joint: Joint) -> Vec3 {
        self.at[joint as usize]
    }

    /// Head: rigid.
    pub(super) fn head(&self) -> Shares {
        let mut shares = [0.0; JOINT_COUNT];
        shares[Joint::Head as usize] = 1.0;
        shares
    }

    /// Trunk and neck: pelvis, waist and neck blended by height, thighs and shoulders by side.
    pub(super) fn trunk(&self, p: Vec3) -> Shares {
        let mut shares = [0.0; JOINT_COUNT];
        let above = self.above(p);
        let (neck, head) = (self.of(Joint::Neck).y, self.of(Joint::Head).y);
        let nape = step(neck - 0.02, neck + 0.05, p.y);
        let skull = step(head - 0.03, head + 0.02, p.y);
        shares[Joint::Root as usize] = 1.0 - above;
        shares[Joint::Spine as usize] = above * (1.0 - nape);
        shares[Joint::Neck as usize] = nape * (1.0 - skull);
        shares[Joint::Head as usize] = nape * skull;
        let (shoulder, hip) = (self.of(Joint::LeftShoulder), self.of(Joint::LeftHip));
        let arm = 0.5
            * step(shoulder.x - 0.07, shoulder.x + 0.03, p.x.abs())
            * step(shoulder.y - 0.16, shoulder.y - 0.02, p.y);
        let thigh = 0.8 * step(hip.y + 0.05, hip.y - 0.12, p.y) * step(0.0, hip.x, p.x.abs());
        let [shoulder, hip] = if p.x > 0.0 {
            [Joint::LeftShoulder, Joint::LeftHip]
        } else {
            [Joint::RightShoulder, Joint::RightHip]
        };
        for (joint, share) in [(shoulder, arm), (hip, thigh)] {
            shares.iter_mut().for_each(|s| *s *= 1.0 - share);
            shares[joint as usize] += share;
        }
        shares
    }

    /// How much of the trunk is the spine's: half at the navel, below the joint.
    fn above(&self, p: Vec3) -> f32 {
        let waist = self.of(Joint::Spine).y;
        step(waist - 0.17, waist + 0.11, p.y)
    }

    /// Skirt: each side hangs on its thigh, the middle on both, the belt on the waist.
    pub(super) fn skirt(&self, p: Vec3) -> Shares {
        let mut shares = [0.0; JOINT_COUNT];
        let hip = self.of(Joint::LeftHip);
        let down = step(hip.y + 0.06, hip.y - 0.16, p.y);
        let left = step(-hip.x, hip.x, p.x);
        let above = self.above(p);
        shares[Joint::Root as usize] = (1.0 - down) * (1.0 - above);
        shares[Joint::Spine as usize] = (1.0 - down) * above;
        shares[Joint::LeftHip as usize] = down * left;
        shares[Joint::RightHip as usize] = down * (1.0 - left);
        shares
    }

    /// Limb: blended along its line from `parent` over `widths` about each of its three joints.
    pub(super) fn limb(&self, p: Vec3, parent: Joint, chain: Chain, widths: [f32; 3]) -> Shares {
        let mut shares = [0.0; JOINT_COUNT];
        shares[parent as usize] = 1.0;
        let ends = [self.of(chain[1]), self.of(chain[2]), self.of(chain[2])];
        for i in 0..3 {
            let start = self.of(chain[i]);
            // The hand or foot goes on in the direction of the limb's last bone.
            let along = if i < 2 { ends[i] - start } else { start - self.of(chain[1]) };
            let t = along.normalize_or_zero().dot(p - start);
            let share = step(-widths[i], widths[i], t);
            shares.iter_mut().for_each(|s| *s *= 1.0 - share);
            shares[chain[i] as usize] += share;
        }
        shares
    }
}
