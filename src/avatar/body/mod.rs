//! The two generated bodies (S-24): low-polygon people made of lofted rings, skinned to the 16 driven joints.
//!
//! Everything is in the rest pose of model space: metres, y up, facing +z, arms hanging slightly out. All rest
//! rotations are the identity, so a joint's rotation reads as a turn of the model's own axes. Proportions are
//! those of adults (stature 1.64 m and 1.76 m, head about 1/7.5 of it); clothing and hair are tinted per agent.
//! What an agent wears beside a body's own outfit is in `clothes`.

mod clothes;
mod expression;
mod eye;
mod face;
pub(in crate::avatar) mod figure;
mod hair;
mod hand;
mod head;
mod limbs;
mod shape;
mod trunk;
mod weights;

use super::wardrobe::{Clothes, Tailoring, Wardrobe};
use super::{Avatar, FaceVertex, LEVELS, Mesh, RestJoint};
use crate::gait::{JOINT_COUNT, Joint, walker};
use glam::{Mat4, Quat, Vec3};
pub(in crate::avatar) use shape::pack;
use shape::{Builder, Paint, Shares};
use std::sync::Arc;
use weights::Bones;

use super::Material;

/// Which of the two bodies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Sex {
    /// 1.64 m; its own outfit has bobbed hair and a skirt.
    Female,
    /// 1.76 m; its own outfit has trousers.
    Male,
}

impl Sex {
    /// Both, in a fixed order.
    pub const ALL: [Self; 2] = [Self::Female, Self::Male];

    /// Lower-case name, also the avatar's name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Female => "female",
            Self::Male => "male",
        }
    }
}

/// Measures of a body, metres. Points are those of the left side.
struct Measures {
    sex: Sex,
    height: f32,
    eyes: Vec3,
    bones: Bones,
}

const SKIN: Paint = Paint::tinted(Material::Skin, 1.0);
const HAIR: Paint = Paint::tinted(Material::Hair, 1.0);
const TOP: Paint = Paint::tinted(Material::Top, 1.0);
const BOTTOM: Paint = Paint::tinted(Material::Bottom, 1.0);
const SHOE: Paint = Paint::fixed(0.035, 0.03, 0.03);
const SOLE: Paint = Paint::fixed(0.012, 0.012, 0.012);

/// One of the two bodies: three levels of detail of about 3,400, 440 and 150 triangles. What it may wear beside its own outfit
/// is its [`Avatar::wardrobe`].
pub fn generated(sex: Sex) -> Avatar {
    let measures = Measures::of(sex);
    let joints = std::array::from_fn(|joint| {
        let position = measures.bones.at[joint];
        let parent = if joint == 0 { Vec3::ZERO } else { measures.bones.at[Joint::PARENT[joint]] };
        RestJoint {
            translation: position - parent,
            rotation: Quat::IDENTITY,
            joint_from_mesh: Mat4::from_translation(-position),
        }
    });
    let mut levels = Vec::new();
    let mut faces = Vec::new();
    let of = match sex {
        Sex::Female => walker::Sex::Female,
        Sex::Male => walker::Sex::Male,
    };
    let mut wardrobe = Wardrobe { sex: of, collar: measures.collar(), levels: Vec::new() };
    for level in 0..LEVELS {
        let (mesh, face, own) = measures.mesh(level);
        let (others, _, of_others) = measures.clothes(level);
        levels.push(mesh);
        faces.push(face);
        wardrobe.levels.push(Clothes { own, others, of_others });
    }
    Avatar {
        name: sex.name().to_owned(),
        joints,
        levels,
        eyes_in_head: measures.eyes - measures.bones.of(Joint::Head),
        eyeball: Some(head::Skull::of(&measures).eyeball()),
        face: faces.swap_remove(0),
        height: measures.top(),
        paint: None,
        wardrobe: Some(Arc::new(wardrobe)),
    }
}

/// A mesh, what of it an expression moves, and what an outfit changes.
type Made = (Mesh, Vec<FaceVertex>, Vec<Tailoring>);

impl Measures {
    /// The top of the hair, which differs from the wanted stature by a few millimetres, m.
    fn top(&self) -> f32 {
        let bones = self.bones;
        let head = |_: Vec3| bones.head();
        let mut builder = Builder::new(0);
        self.head(&mut builder, &head);
        let (mesh, ..) = builder.finish();
        mesh.vertices.iter().map(|v| v.position.y).fold(0.0, f32::max)
    }

    fn of(sex: Sex) -> Self {
        // Left joints: shoulder, elbow and hand share a line 13 degrees out of the vertical.
        let (middle, shoulder, arm, legs, eyes, height) = match sex {
            Sex::Female => (
                [(0.905, 0.0), (1.02, -0.005), (1.375, -0.012), (1.455, 0.002)],
                Vec3::new(0.158, 1.322, -0.01),
                [0.272, 0.238],
                [
                    Vec3::new(0.085, 0.865, 0.0),
                    Vec3::new(0.08, 0.455, 0.012),
                    Vec3::new(0.075, 0.078, -0.012),
                ],
                Vec3::new(0.0, 1.536, 0.085),
                1.64,
            ),
            Sex::Male => (
                [(0.965, 0.0), (1.09, -0.005), (1.485, -0.012), (1.57, 0.002)],
                Vec3::new(0.184, 1.425, -0.01),
                [0.298, 0.258],
                [
                    Vec3::new(0.092, 0.925, 0.0),
                    Vec3::new(0.089, 0.49, 0.012),
                    Vec3::new(0.086, 0.085, -0.012),
                ],
                Vec3::new(0.0, 1.652, 0.09),
                1.76,
            ),
        };
        let out = 13.0_f32.to_radians();
        let down = Vec3::new(libm::sinf(out), -libm::cosf(out), 0.0);
        // Elbows bend a little forward at rest; later steps take forward from this.
        let fore = (down + Vec3::new(-0.03, 0.0, 0.16)).normalize();
        let elbow = shoulder + down * arm[0];
        let left = [shoulder, elbow, elbow + fore * arm[1], legs[0], legs[1], legs[2]];
        let mirrored = left.map(|p| p * Vec3::new(-1.0, 1.0, 1.0));
        let mut at = [Vec3::ZERO; JOINT_COUNT];
        for (joint, (y, z)) in middle.into_iter().enumerate() {
            at[joint] = Vec3::new(0.0, y, z);
        }
        at[4..7].copy_from_slice(&left[..3]);
        at[7..10].copy_from_slice(&mirrored[..3]);
        at[10..13].copy_from_slice(&left[3..]);
        at[13..16].copy_from_slice(&mirrored[3..]);
        Self { sex, height, eyes, bones: Bones { at } }
    }

    /// Shares of an arm's joints.
    fn of_arm(&self, p: Vec3) -> Shares {
        let chain = if p.x > 0.0 {
            [Joint::LeftShoulder, Joint::LeftElbow, Joint::LeftHand]
        } else {
            [Joint::RightShoulder, Joint::RightElbow, Joint::RightHand]
        };
        self.bones.limb(p, Joint::Spine, chain, [0.06, 0.045, 0.025])
    }

    /// Shares of a leg's joints.
    fn of_leg(&self, p: Vec3) -> Shares {
        let chain = if p.x > 0.0 {
            [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot]
        } else {
            [Joint::RightHip, Joint::RightKnee, Joint::RightFoot]
        };
        self.bones.limb(p, Joint::Root, chain, [0.075, 0.06, 0.035])
    }

    fn mesh(&self, level: usize) -> Made {
        let bones = self.bones;
        let trunk = |p: Vec3| bones.trunk(p);
        let skirt = |p: Vec3| bones.skirt(p);
        let head = |_: Vec3| bones.head();
        let arm = |p: Vec3| self.of_arm(p);
        let leg = |p: Vec3| self.of_leg(p);
        let foot = |p: Vec3| -> Shares {
            let mut shares = [0.0; JOINT_COUNT];
            shares[if p.x > 0.0 { Joint::LeftFoot } else { Joint::RightFoot } as usize] = 1.0;
            shares
        };
        let mut builder = Builder::new(level);
        self.trunk(&mut builder, &trunk, &skirt);
        self.head(&mut builder, &head);
        for left in [true, false] {
            self.arm(&mut builder, left, &arm);
            self.leg(&mut builder, left, &leg, &foot);
        }
        builder.finish()
    }
}

#[cfg(test)]
mod tests;
