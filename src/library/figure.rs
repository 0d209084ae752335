//! The stick figure that shows a library in a glTF viewer: a skeleton of mean size, a thin mesh, and the joint
//! rotations of each gait. Only for looking: the exact joint positions stand beside the clips.

use crate::gait::{Gait, JOINT_COUNT, Joint, Pose};
use glam::{Quat, Vec3};

/// Share of the shank's rotation that the foot follows.
const FOOT_FOLLOWS: f32 = 0.5;

/// The skeleton at rest: standing, arms down, every rotation identity.
pub(super) struct Skeleton {
    /// Offset of each joint from its parent (the root: from the origin), m.
    pub(super) offsets: [Vec3; JOINT_COUNT],
}

impl Skeleton {
    /// Mean distances over all frames of all gaits.
    #[allow(clippy::cast_possible_truncation, reason = "means of lengths in f32")]
    pub(super) fn mean(gaits: &[Gait]) -> Self {
        let mut lengths = [0.0_f64; JOINT_COUNT];
        let (mut shoulders, mut hips, mut frames) = (0.0_f64, 0.0_f64, 0.0_f64);
        for pose in gaits.iter().flat_map(|gait| &gait.poses) {
            for (joint, &parent) in Joint::PARENT.iter().enumerate() {
                lengths[joint] += f64::from(pose[joint].distance(pose[parent]));
            }
            shoulders += f64::from(pose[4].distance(pose[7]));
            hips += f64::from(pose[10].distance(pose[13]));
            frames += 1.0;
        }
        let mean = |sum: f64| if frames > 0.0 { (sum / frames) as f32 } else { 0.0 };
        let mut offsets = [Vec3::ZERO; JOINT_COUNT];
        for joint in Joint::ALL {
            let index = joint as usize;
            let length = mean(lengths[index]);
            let across = |width: f64| Vec3::new((0.5 * mean(width)).min(length), 0.0, 0.0);
            let left = if index == joint.mirrored() as usize || index < joint.mirrored() as usize {
                1.0
            } else {
                -1.0
            };
            offsets[index] = match joint {
                Joint::Root => Vec3::ZERO,
                Joint::Spine | Joint::Neck | Joint::Head => Vec3::Y * length,
                Joint::LeftShoulder | Joint::RightShoulder => slanted(across(shoulders), length, left, 1.0),
                Joint::LeftHip | Joint::RightHip => slanted(across(hips), length, left, -1.0),
                _ => -Vec3::Y * length,
            };
        }
        let leg = [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot];
        offsets[0] = Vec3::Y * -leg.into_iter().map(|joint| offsets[joint as usize].y).sum::<f32>();
        Self { offsets }
    }

    /// Rest position of each joint, m.
    pub(super) fn positions(&self) -> [Vec3; JOINT_COUNT] {
        let mut positions = self.offsets;
        for joint in 1..JOINT_COUNT {
            positions[joint] += positions[Joint::PARENT[joint]];
        }
        positions
    }

    /// Size of the walker of `gait` relative to this skeleton, by the length of the legs.
    pub(super) fn scale_of(&self, gait: &Gait) -> f32 {
        let own = self.offsets[11].length() + self.offsets[12].length();
        let pose = &gait.poses[0];
        let leg = pose[10].distance(pose[11]) + pose[11].distance(pose[12]);
        if own > 1e-3 && leg > 1e-3 { leg / own } else { 1.0 }
    }

    /// Rotation of each joint relative to its parent, such that the figure's bones point as in `pose`.
    pub(super) fn rotations(&self, pose: &Pose) -> [Quat; JOINT_COUNT] {
        let mut world = [Quat::IDENTITY; JOINT_COUNT];
        for joint in Joint::ALL {
            let index = joint as usize;
            let parent = if index == 0 { Quat::IDENTITY } else { world[Joint::PARENT[index]] };
            world[index] = match joint {
                Joint::Root => upright(pose[1] - pose[0], pose[10] - pose[13], parent),
                Joint::Spine => upright(pose[2] - pose[1], pose[4] - pose[7], parent),
                Joint::LeftFoot | Joint::RightFoot => {
                    parent * Quat::IDENTITY.slerp(parent.inverse(), FOOT_FOLLOWS)
                }
                Joint::Head | Joint::LeftHand | Joint::RightHand => parent,
                // The one child of neck, shoulders, elbows, hips and knees is the next joint.
                _ => aimed(parent, self.offsets[index + 1], pose[index + 1] - pose[index]),
            };
        }
        let mut local = world;
        for joint in 1..JOINT_COUNT {
            local[joint] = (world[Joint::PARENT[joint]].inverse() * world[joint]).normalize();
        }
        local
    }
}

/// An offset of `length` with this sideways part, up (+1) or down (-1) for the rest.
fn slanted(across: Vec3, length: f32, left: f32, up: f32) -> Vec3 {
    Vec3::new(left * across.x, up * (length * length - across.x * across.x).max(0.0).sqrt(), 0.0)
}

/// The rotation that turns +y to `up` and +x as nearly as possible to `left`; `fallback` if they are degenerate.
fn upright(up: Vec3, left: Vec3, fallback: Quat) -> Quat {
    let (Some(y), Some(z)) = (up.try_normalize(), left.cross(up).try_normalize()) else { return fallback };
    Quat::from_mat3(&glam::Mat3::from_cols(y.cross(z), y, z)).normalize()
}

/// `parent` turned on by the shortest way so that `offset` points along `direction`.
fn aimed(parent: Quat, offset: Vec3, direction: Vec3) -> Quat {
    match ((parent * offset).try_normalize(), direction.try_normalize()) {
        (Some(from), Some(to)) => (Quat::from_rotation_arc(from, to) * parent).normalize(),
        _ => parent,
    }
}

/// The figure's mesh: one thin octahedron per bone, flat shaded, each rigid to one joint.
#[derive(Default)]
pub(super) struct Mesh {
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Vec<Vec3>,
    pub(super) joints: Vec<u8>,
}

impl Mesh {
    pub(super) fn of(skeleton: &Skeleton) -> Self {
        let at = skeleton.positions();
        let size = skeleton.offsets[11].length() + skeleton.offsets[12].length();
        let mut mesh = Self::default();
        for (joint, &parent) in (0_u8..).zip(&Joint::PARENT).skip(1) {
            let trunk = joint <= Joint::Neck as u8;
            let thickness = size * if trunk { 0.05 } else { 0.03 };
            mesh.bone(at[parent], at[usize::from(joint)], thickness, u8::try_from(parent).unwrap_or(0));
        }
        let head = at[Joint::Head as usize];
        mesh.bone(head - Vec3::Y * 0.13 * size, head + Vec3::Y * 0.17 * size, 0.1 * size, Joint::Head as u8);
        let nose = head + Vec3::Z * 0.06 * size;
        mesh.bone(nose, nose + Vec3::Z * 0.1 * size, 0.02 * size, Joint::Head as u8);
        for foot in [Joint::LeftFoot, Joint::RightFoot] {
            let ankle = at[foot as usize];
            let (heel, toe) = (Vec3::new(0.0, -0.04, -0.06) * size, Vec3::new(0.0, -0.07, 0.22) * size);
            mesh.bone(ankle + heel, ankle + toe, 0.03 * size, foot as u8);
        }
        mesh
    }

    /// An octahedron between two points, widest near the first.
    fn bone(&mut self, from: Vec3, to: Vec3, thickness: f32, joint: u8) {
        let Some(along) = (to - from).try_normalize() else { return };
        let side = along.any_orthonormal_vector() * thickness;
        let other = along.cross(side);
        let waist = from.lerp(to, 0.25);
        let ring = [waist + side, waist + other, waist - side, waist - other];
        for i in 0..4 {
            let (a, b) = (ring[i], ring[(i + 1) % 4]);
            self.triangle([to, a, b], joint);
            self.triangle([from, b, a], joint);
        }
    }

    fn triangle(&mut self, corners: [Vec3; 3], joint: u8) {
        let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
        for corner in corners {
            self.positions.push(corner);
            self.normals.push(normal);
            self.joints.push(joint);
        }
    }
}
