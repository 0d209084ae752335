//! What the primitives of a place are made of: materials by metal and roughness, and which images they use.

use super::accessor::{self, Buffer};
use glam::{Vec2, Vec3};
use gltf::material::AlphaMode;

/// An image of a document, and which coordinates it is looked up by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Lookup {
    pub(super) image: usize,
    set: u32,
}

/// A material; its base colour is in the colours of the vertices.
#[derive(Debug, Clone, Default)]
pub(super) struct Surface {
    /// Linear light that it sends out itself.
    pub(super) glow: Vec3,
    pub(super) roughness: f32,
    pub(super) metal: f32,
    /// Where alpha is below, there is nothing; none: it is everywhere.
    pub(super) cutoff: Option<f32>,
    /// Whether it is blended with what is behind.
    pub(super) is_blended: bool,
    pub(super) is_two_sided: bool,
    pub(super) color: Option<Lookup>,
    pub(super) normal: Option<(Lookup, f32)>,
    /// Roughness in green, metal in blue.
    pub(super) rough: Option<Lookup>,
    /// Occlusion in red, and how much of it counts.
    pub(super) occlusion: Option<(Lookup, f32)>,
}

impl Surface {
    /// The materials of a document, then that of primitives which name none.
    pub(super) fn all(gltf: &gltf::Gltf) -> Vec<Self> {
        let none = Self { roughness: 1.0, ..Self::default() };
        gltf.materials().map(|material| Self::of(&material)).chain([none]).collect()
    }

    fn of(material: &gltf::Material<'_>) -> Self {
        let surface = material.pbr_metallic_roughness();
        let lookup = |texture: gltf::Texture<'_>, set: u32| Lookup { image: texture.source().index(), set };
        let of_info = |info: gltf::texture::Info<'_>| lookup(info.texture(), info.tex_coord());
        Self {
            glow: Vec3::from(material.emissive_factor()),
            roughness: surface.roughness_factor().clamp(0.0, 1.0),
            metal: surface.metallic_factor().clamp(0.0, 1.0),
            cutoff: (material.alpha_mode() == AlphaMode::Mask)
                .then(|| material.alpha_cutoff().unwrap_or(0.5)),
            is_blended: material.alpha_mode() == AlphaMode::Blend,
            is_two_sided: material.double_sided(),
            color: surface.base_color_texture().map(of_info),
            normal: material
                .normal_texture()
                .map(|map| (lookup(map.texture(), map.tex_coord()), map.scale())),
            rough: surface.metallic_roughness_texture().map(of_info),
            occlusion: material
                .occlusion_texture()
                .map(|map| (lookup(map.texture(), map.tex_coord()), map.strength())),
        }
    }

    /// Where the vertices of a primitive lie on its textures: by the coordinates of its colours, or else of its first map.
    ///
    /// # Errors
    /// When there are not as many coordinates as vertices.
    pub(super) fn places(
        primitive: &gltf::Primitive<'_>,
        count: usize,
        buffers: &[Buffer],
    ) -> Result<Vec<Vec2>, String> {
        let own = Self::of(&primitive.material());
        let maps = [own.normal, own.occlusion].map(|map| map.map(|(lookup, _)| lookup));
        let first = [own.color, own.rough].into_iter().chain(maps).flatten().next();
        let found = first.and_then(|lookup| primitive.get(&gltf::Semantic::TexCoords(lookup.set)));
        let Some(found) = found else { return Ok(vec![Vec2::ZERO; count]) };
        let uv = accessor::vec2(&found, buffers)?;
        if uv.len() != count {
            return Err(format!("has {count} positions but {} texture coordinates", uv.len()));
        }
        Ok(uv)
    }
}
