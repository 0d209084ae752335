//! A character as it is drawn, and a gait on it.

/// Frames of a [`Clip`]; a power of two, so that the frame index is the top bits of the phase.
pub use crate::kernels::shared::body::index::CLIP_FRAMES;

use super::model::Paint;
use super::wardrobe::Wardrobe;
use crate::gait::{JOINT_COUNT, Joint};
use glam::{Mat4, Quat, Vec3};
use std::sync::Arc;

/// Most levels of detail an avatar may have; level 0 is the finest.
pub const LEVELS: usize = 3;

/// One of the 16 driven joints in the rest pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RestJoint {
    /// Translation in the parent joint's space (model space for the root), metres.
    pub translation: Vec3,
    /// Rest rotation relative to the parent joint (to model space for the root).
    pub rotation: Quat,
    /// Mesh space to this joint's space (glTF: inverse bind matrix).
    pub joint_from_mesh: Mat4,
}

/// A vertex of a body, mesh space (model space: metres, y up, facing +z, feet at y = 0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Vertex {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Linear colour, 0 to 1; the renderer multiplies it with the agent's colour of `material`.
    pub color: Vec3,
    /// How much of what is behind it the surface hides, 0 to 1; 1 of everything but glass.
    pub alpha: f32,
    /// Which of the agent's colours tints this vertex.
    pub material: Material,
    /// Up to four driven joints, as [`Joint`] indices. In the finest mesh also `LEFT_EYE`, `RIGHT_EYE` and `LIDS` of
    /// [`crate::kernels::shared::body`], where the avatar has an [`eyeball`](Avatar::eyeball).
    pub joints: [u8; 4],
    /// Their weights, sum 1.
    pub weights: [f32; 4],
}

impl Vertex {
    /// Its joints with the head in place of eyes and lids, which no gait drives.
    pub fn driven_joints(&self) -> [u8; 4] {
        self.joints.map(|joint| if usize::from(joint) < JOINT_COUNT { joint } else { Joint::Head as u8 })
    }
}

/// Which of an agent's colours tints a vertex.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
#[repr(u32)]
pub enum Material {
    /// The vertex colour as it is (textured characters, eyes, shoes).
    #[default]
    Fixed = 0,
    /// The agent's skin colour.
    Skin = 1,
    /// The agent's hair or headwear colour.
    Hair = 2,
    /// The agent's shirt, jacket or dress colour.
    Top = 3,
    /// The agent's trousers or skirt colour.
    Bottom = 4,
}

/// A triangle mesh of one level of detail. Triangles wind counter-clockwise seen from outside.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Mesh {
    /// Vertices.
    pub vertices: Vec<Vertex>,
    /// Three indices into `vertices` per triangle.
    pub indices: Vec<u32>,
}

/// What moves less of a face is not seen, m.
pub(super) const UNSEEN: f32 = 5e-5;

/// How a vertex of a face or a hand moves with the numbers of an [`Expression`](crate::kernels::layout::Expression): how far it goes
/// from its place at rest, mesh space, m, where that number is 1 and the others are 0.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FaceVertex {
    /// Number of the vertex in the finest mesh.
    pub vertex: u32,
    /// With the height of the brows' inner ends.
    pub inner_brow: Vec3,
    /// With the height of their outer ends.
    pub outer_brow: Vec3,
    /// With the height of the mouth's corners above 0.
    pub corners_up: Vec3,
    /// With their depth below 0.
    pub corners_down: Vec3,
    /// With how far the mouth is open.
    pub opened: Vec3,
    /// With how tightly the lips are pressed together.
    pub pressed: Vec3,
    /// With how far the hands are clenched.
    pub fist: Vec3,
    /// How its normal changes with that, 1.
    pub fist_normal: Vec3,
    /// With how far the eyes are shut, of a character without eyeballs of its own.
    pub blink: Vec3,
}

/// A character that gaits can drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Avatar {
    /// Name.
    pub name: String,
    /// The 16 driven joints, indexed by [`Joint`], parents by [`Joint::PARENT`].
    pub joints: [RestJoint; JOINT_COUNT],
    /// Meshes from fine to coarse, 1 to [`LEVELS`].
    pub levels: Vec<Mesh>,
    /// Midpoint of the eyes in the head joint's space, m.
    pub eyes_in_head: Vec3,
    /// Centre of the left eyeball in mesh space, m, where eyes turn; the right one is its mirror image.
    pub eyeball: Option<Vec3>,
    /// What an expression moves in the finest mesh, by number of vertex; nothing where a character has no face that moves.
    pub face: Vec<FaceVertex>,
    /// Standing height from sole to crown, m: headwear does not count.
    pub height: f32,
    /// Textures of the finest mesh, of characters from files that have some. Coarser meshes have the colours of vertices.
    #[doc(hidden)]
    pub paint: Option<Arc<Paint>>,
    /// What a generated body may wear; none: all agents have the avatar's own outfit.
    #[doc(hidden)]
    pub wardrobe: Option<Arc<Wardrobe>>,
}

/// One frame of a [`Clip`]: what the pose kernel samples.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClipFrame {
    /// Rotation of each joint relative to its parent (`parent_from_joint`), indexed by [`Joint`].
    pub rotations: [Quat; JOINT_COUNT],
    /// Position of the root joint in model space, m.
    pub root: Vec3,
}

impl ClipFrame {
    /// The mean of frames: rotations as normalised sums, each aligned with the first; no rotation of no frames.
    pub fn mean(frames: &[Self]) -> Self {
        let rotations = std::array::from_fn(|joint| {
            let all = frames.iter().map(|frame| frame.rotations[joint]);
            let sum = all.reduce(|sum, q| if sum.dot(q) < 0.0 { sum - q } else { sum + q });
            sum.unwrap_or(Quat::IDENTITY).normalize()
        });
        let root = frames.iter().map(|frame| frame.root).sum::<Vec3>() / (frames.len().max(1) as f32);
        Self { rotations, root }
    }
}

/// A gait retargeted onto one avatar: [`CLIP_FRAMES`] frames at equal phase steps over one cycle, phase 0 = left
/// foot strike, quaternions of neighbouring frames (and of the wrap-around) in the same hemisphere.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// The frames.
    pub frames: Vec<ClipFrame>,
    /// Metres of ground covered per cycle by *this avatar*, so that its planted feet stand still.
    pub stride_travel: f32,
    /// Preferred speed of this avatar in this gait, m/s: `stride_travel` over the gait's cycle time.
    pub speed: f32,
}

impl Clip {
    /// Step length over step rate, m s, which a person keeps at every speed; 0 of a body that stands.
    pub fn walk_ratio(&self) -> f32 {
        if self.speed > 0.0 { self.stride_travel * self.stride_travel / (4.0 * self.speed) } else { 0.0 }
    }
}

impl Avatar {
    /// The highest point at rest, m: [`Self::height`] and what is worn on the head.
    pub fn top(&self) -> f32 {
        let vertices = self.levels.iter().flat_map(|mesh| &mesh.vertices);
        vertices.map(|vertex| vertex.position.y).fold(self.height, f32::max)
    }

    /// Model-space transform of each joint for the given local rotations and root position.
    pub fn model_from_joint(&self, rotations: &[Quat; JOINT_COUNT], root: Vec3) -> [Mat4; JOINT_COUNT] {
        let mut model = [Mat4::IDENTITY; JOINT_COUNT];
        for joint in 0..JOINT_COUNT {
            let translation =
                if joint == Joint::Root as usize { root } else { self.joints[joint].translation };
            let local = Mat4::from_rotation_translation(rotations[joint], translation);
            model[joint] = if joint == 0 { local } else { model[Joint::PARENT[joint]] * local };
        }
        model
    }
}
