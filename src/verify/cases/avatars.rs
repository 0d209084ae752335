//! Made-up avatars and gaits of theirs, and how both lie in buffers.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_precision_loss,
    reason = "small made-up numbers, written in the buffers' types"
)]

use crate::avatar::foot::footprints;
use crate::avatar::waist::bones;
use crate::avatar::{Avatar, CLIP_FRAMES, ClipFrame, FaceVertex, LEVELS, Material, Mesh, RestJoint, Vertex};
use crate::gait::{JOINT_COUNT, Joint};
use crate::kernels::shared::body::index::{
    POSE_STRIDE, RIG_BALLS, RIG_EYEBALL, RIG_EYES, RIG_PLACES, RIG_STRIDE, VERTEX_STRIDE,
};
use crate::reference::exact::{hash_u32, unit_f32};
use glam::{Mat4, Quat, Vec3};

/// Random numbers of a seed, counted.
#[derive(Debug)]
pub(super) struct Dice {
    seed: u32,
    count: u32,
}

impl Dice {
    pub(super) fn of(seed: u32) -> Self {
        Self { seed, count: 0 }
    }

    pub(super) fn bits(&mut self) -> u32 {
        self.count = self.count.wrapping_add(1);
        hash_u32(self.seed ^ hash_u32(self.count))
    }

    pub(super) fn below(&mut self, end: u32) -> u32 {
        self.bits() % end.max(1)
    }

    pub(super) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * unit_f32(self.bits())
    }

    pub(super) fn vector(&mut self, size: f32) -> Vec3 {
        Vec3::new(self.between(-size, size), self.between(-size, size), self.between(-size, size))
    }

    pub(super) fn rotation(&mut self) -> Quat {
        let [x, y, z, w] = [0; 4].map(|_| self.between(-1.0, 1.0));
        Quat::from_xyzw(x, y, z, w + 0.01).normalize()
    }
}

/// Joints of a standing adult, model space, m: arms spread, left is +x.
const REST: [[f32; 3]; JOINT_COUNT] = [
    [0.0, 0.95, 0.0],
    [0.0, 1.15, 0.0],
    [0.0, 1.45, -0.01],
    [0.0, 1.55, 0.01],
    [0.18, 1.40, 0.0],
    [0.45, 1.40, 0.0],
    [0.70, 1.40, 0.0],
    [-0.18, 1.40, 0.0],
    [-0.45, 1.40, 0.0],
    [-0.70, 1.40, 0.0],
    [0.10, 0.92, 0.0],
    [0.10, 0.50, 0.02],
    [0.10, 0.08, 0.0],
    [-0.10, 0.92, 0.0],
    [-0.10, 0.50, 0.02],
    [-0.10, 0.08, 0.0],
];

/// A made-up character: number 0 has the model's axes in every joint, any other has axes of its own in each.
pub fn avatar(number: usize, seed: u32) -> Avatar {
    let mut dice = Dice { seed: hash_u32(seed ^ 0xa7a7), count: number as u32 * 4096 };
    let size = 1.0 - 0.07 * number as f32;
    let mut axes = [Quat::IDENTITY; JOINT_COUNT]; // model from joint
    if number > 0 {
        axes = axes.map(|_| dice.rotation());
    }
    let joints = std::array::from_fn(|joint| {
        let at = Vec3::from(REST[joint]) * size;
        let (parent_at, parent_axes) = match joint {
            0 => (Vec3::ZERO, Quat::IDENTITY),
            _ => (Vec3::from(REST[Joint::PARENT[joint]]) * size, axes[Joint::PARENT[joint]]),
        };
        RestJoint {
            translation: parent_axes.inverse() * (at - parent_at),
            rotation: (parent_axes.inverse() * axes[joint]).normalize(),
            joint_from_mesh: Mat4::from_rotation_translation(axes[joint], at).inverse(),
        }
    });
    let levels: Vec<Mesh> =
        (0..LEVELS).map(|level| mesh(&mut dice, (90 + 40 * number) >> (2 * level), size)).collect();
    let face = face(&mut dice, &levels[0]);
    Avatar {
        name: format!("made up {number}"),
        joints,
        levels,
        eyes_in_head: axes[Joint::Head as usize].inverse() * Vec3::new(0.0, 0.08, 0.09) * size,
        face,
        eyeball: (number == 0 || seed & 1 == 0).then_some(Vec3::new(0.03, 1.63, 0.08) * size),
        height: 1.75 * size,
        paint: None,
        wardrobe: None,
    }
}

fn mesh(dice: &mut Dice, vertex_count: usize, size: f32) -> Mesh {
    let vertices = (0..vertex_count)
        .map(|_| {
            let joints = [0; 4].map(|_| dice.below(JOINT_COUNT as u32) as u8);
            let mut weights = [0; 4].map(|_| dice.between(0.0, 1.0));
            if dice.below(3) == 0 {
                weights = [1.0, 0.0, 0.0, 0.0];
            }
            let sum: f32 = weights.iter().sum();
            Vertex {
                position: Vec3::from(REST[usize::from(joints[0])]) * size + dice.vector(0.1),
                normal: dice.vector(1.0).try_normalize().unwrap_or(Vec3::Y),
                color: dice.vector(0.5) + 0.5,
                alpha: 1.0,
                material: [Material::Fixed, Material::Skin, Material::Hair, Material::Top, Material::Bottom]
                    [dice.below(5) as usize],
                joints,
                weights: weights.map(|weight| weight / sum),
            }
        })
        .collect();
    let indices = (0..vertex_count * 3).map(|_| dice.below(vertex_count as u32)).collect();
    Mesh { vertices, indices }
}

/// Every third vertex moves with the face, each number of it in a way of its own.
fn face(dice: &mut Dice, mesh: &Mesh) -> Vec<FaceVertex> {
    let vertices = (0..mesh.vertices.len() as u32).step_by(3);
    let mut way = || dice.vector(0.01);
    vertices
        .map(|vertex| FaceVertex {
            vertex,
            inner_brow: way(),
            outer_brow: way(),
            corners_up: way(),
            corners_down: way(),
            opened: way(),
            pressed: way(),
            fist: way(),
            fist_normal: way(),
            blink: way(),
        })
        .collect()
}

/// A made-up gait of an avatar: every joint swings about an axis of its own; `swing` 0 stands still.
pub(super) fn clip(avatar: &Avatar, dice: &mut Dice, swing: f32) -> Vec<ClipFrame> {
    let motion: [_; JOINT_COUNT] = std::array::from_fn(|_| {
        let axis = dice.vector(1.0).try_normalize().unwrap_or(Vec3::X);
        (axis, dice.between(0.0, std::f32::consts::TAU))
    });
    (0..CLIP_FRAMES)
        .map(|frame| {
            let phase = frame as f32 / CLIP_FRAMES as f32 * std::f32::consts::TAU;
            ClipFrame {
                rotations: std::array::from_fn(|joint| {
                    let (axis, start) = motion[joint];
                    // the middle of the body moves less than the limbs do
                    let most = if joint < 4 { 0.12 } else { 0.7 };
                    let angle = most * swing * libm::sinf(phase + start);
                    let q = (avatar.joints[joint].rotation * Quat::from_axis_angle(axis, angle)).normalize();
                    if dice.below(8) == 0 { -q } else { q }
                }),
                root: avatar.joints[0].translation
                    + Vec3::new(0.02 * libm::sinf(phase), 0.03 * libm::cosf(2.0 * phase), 0.0) * swing,
            }
        })
        .collect()
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
    rig[RIG_EYEBALL] = avatar.eyeball.map_or([0.0; 4], |left| left.extend(1.0).to_array());
    for (ball, print) in rig[RIG_BALLS..].iter_mut().zip(footprints(avatar)) {
        *ball = print.in_rig();
    }
    for (element, part) in rig[RIG_PLACES..].iter_mut().zip(bones(avatar).as_flattened()) {
        *element = part.extend(0.0).to_array();
    }
    rig
}

/// A frame of a clip whose strides go so far, m, as it lies in `clip_frames`.
pub fn clip_elements(frame: &ClipFrame, travel: f32) -> [[f32; 4]; POSE_STRIDE] {
    std::array::from_fn(|element| match frame.rotations.get(element) {
        Some(rotation) => rotation.to_array(),
        None => frame.root.extend(travel).to_array(),
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
