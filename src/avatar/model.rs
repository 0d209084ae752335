//! What is read of files with characters and models.

use super::Avatar;
use crate::picture::Image;
use glam::{Vec2, Vec3, Vec4};

/// A loaded character and what was inferred about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The character.
    pub avatar: Avatar,
    /// One line per inference or repair: joint map, unit, facing, rest pose, what was left out.
    pub report: Vec<String>,
}

/// A model as it stands in its scene: metres, y up, front faces counter-clockwise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Model {
    /// Positions, m.
    pub positions: Vec<Vec3>,
    /// Unit normals.
    pub normals: Vec<Vec3>,
    /// Linear colours, 0 to 1.
    pub colors: Vec<Vec3>,
    /// Three indices per triangle.
    pub indices: Vec<u32>,
}

/// A place as it stands in its scene, with materials and textures: metres, y up, front faces counter-clockwise.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct PlaceModel {
    /// Its vertices.
    pub vertices: Vec<PlaceVertex>,
    /// Three indices per triangle of what is seen from its front only.
    pub solid: Vec<u32>,
    /// The same of what has two sides or holes.
    pub open: Vec<u32>,
    /// What it is made of.
    pub textured: Textured,
}

impl PlaceModel {
    /// All triangles, m.
    pub fn triangles(&self) -> Vec<[Vec3; 3]> {
        let corner =
            |index: u32| self.vertices.get(index as usize).map_or(Vec3::ZERO, |vertex| vertex.position);
        let both = self.solid.chunks_exact(3).chain(self.open.chunks_exact(3));
        both.map(|three| [corner(three[0]), corner(three[1]), corner(three[2])]).collect()
    }
}

/// A vertex of a place.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlaceVertex {
    /// Position, m.
    pub position: Vec3,
    /// Unit normal.
    pub normal: Vec3,
    /// Linear base colour, 0 to 1, before textures.
    pub color: Vec3,
    /// Place on the textures: (0, 0) is their first texel, (1, 1) behind the last.
    pub uv: Vec2,
    /// Number of the material.
    pub material: u32,
}

/// Materials and their textures.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Textured {
    /// The materials.
    pub materials: Vec<TexturedMaterial>,
    /// Textures of colours, with the sRGB curve; alpha is linear.
    pub colors: Vec<Image>,
    /// Textures of numbers: normals, occlusion, roughness and metal.
    pub maps: Vec<Image>,
}

/// A material with textures, as glTF 2.0 has it (section 3.9).
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TexturedMaterial {
    /// Linear light that it sends out itself.
    pub glow: Vec3,
    /// How rough it is, 0 to 1.
    pub roughness: f32,
    /// How much of a metal it is, 0 to 1.
    pub metal: f32,
    /// Where alpha is below, there is nothing; 0: it is everywhere.
    pub cutoff: f32,
    /// Whether alpha says how much of what is behind it hides.
    pub is_blended: bool,
    /// Whether it is seen from its back, too.
    pub is_two_sided: bool,
    /// Number among the textures of colours.
    pub color: Option<u32>,
    /// Among the maps: roughness in green, metal in blue, both times those above.
    pub rough: Option<u32>,
    /// Among the maps: normals, and how much their slopes count.
    pub normal: Option<(u32, f32)>,
    /// Among the maps: occlusion in red, and how much it counts.
    pub occlusion: Option<(u32, f32)>,
}

/// What the finest mesh of a loaded character is painted with.
#[doc(hidden)]
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Paint {
    /// Of each vertex of the finest mesh.
    pub corners: Vec<PaintCorner>,
    /// What they are made of.
    pub textured: Textured,
}

/// A vertex of a painted mesh.
#[doc(hidden)]
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PaintCorner {
    /// Linear base colour and alpha, 0 to 1, before textures; the renderer multiplies it with the agent's colour.
    pub color: Vec4,
    /// Place on the textures: (0, 0) is their first texel, (1, 1) behind the last.
    pub uv: Vec2,
    /// Number of the material.
    pub material: u32,
}
