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
    /// The materials of a document, then that of primitives which name none. Maps are left out whose image is not there, or
    /// which other coordinates belong to than to the first; the report says which.
    pub(super) fn all(
        gltf: &gltf::Gltf,
        is_there: impl Fn(usize) -> bool,
        report: &mut Vec<String>,
    ) -> Vec<Self> {
        let none = Self { roughness: 1.0, ..Self::default() };
        let mut all: Vec<Self> = gltf.materials().map(|material| Self::of(&material)).collect();
        for (number, surface) in all.iter_mut().enumerate() {
            let others = surface.keep(&is_there);
            if others > 0 {
                report.push(format!(
                    "material {number}: {others} of its textures use other coordinates than the first; left out"
                ));
            }
        }
        if gltf.extensions_used().any(|name| name == "KHR_texture_transform") {
            report
                .push("KHR_texture_transform: its offsets and scales of textures are not applied".to_owned());
        }
        all.into_iter().chain([none]).collect()
    }

    /// All of its textures; the first says which coordinates are used.
    fn lookups(&self) -> impl Iterator<Item = Lookup> {
        let maps = [self.normal, self.occlusion].map(|map| map.map(|(lookup, _)| lookup));
        [self.color, self.rough].into_iter().chain(maps).flatten()
    }

    /// Keeps the textures that are there and use the coordinates of the first; how many use others.
    fn keep(&mut self, is_there: impl Fn(usize) -> bool) -> usize {
        let is_image = |lookup: &Lookup| is_there(lookup.image);
        self.color = self.color.filter(is_image);
        self.rough = self.rough.filter(is_image);
        self.normal = self.normal.filter(|(lookup, _)| is_image(lookup));
        self.occlusion = self.occlusion.filter(|(lookup, _)| is_image(lookup));
        let before = self.lookups().count();
        let Some(first) = self.lookups().next() else { return 0 };
        let is_same = |lookup: &Lookup| lookup.set == first.set;
        self.rough = self.rough.filter(is_same);
        self.normal = self.normal.filter(|(lookup, _)| is_same(lookup));
        self.occlusion = self.occlusion.filter(|(lookup, _)| is_same(lookup));
        before - self.lookups().count()
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
        &self,
        primitive: &gltf::Primitive<'_>,
        count: usize,
        buffers: &[Buffer],
    ) -> Result<Vec<Vec2>, String> {
        let found =
            self.lookups().next().and_then(|lookup| primitive.get(&gltf::Semantic::TexCoords(lookup.set)));
        let Some(found) = found else { return Ok(vec![Vec2::ZERO; count]) };
        let uv = accessor::vec2(&found, buffers)?;
        if uv.len() != count {
            return Err(format!("has {count} positions but {} texture coordinates", uv.len()));
        }
        Ok(uv)
    }
}
