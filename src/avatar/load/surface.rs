//! What the primitives of a place are made of: materials by metal and roughness, and which images they use.

use super::accessor::Buffer;
use super::placement::Placement;
use glam::{Vec2, Vec3};
use gltf::material::AlphaMode;
use serde_json::Value;

/// An image of a document, and where it lies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Lookup {
    pub(super) image: usize,
    place: Placement,
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
    /// which do not lie where the first does; the report says which.
    pub(super) fn all(
        gltf: &gltf::Gltf,
        json: &Value,
        is_there: impl Fn(usize) -> bool,
        report: &mut Vec<String>,
    ) -> Vec<Self> {
        let none = Self { roughness: 1.0, ..Self::default() };
        let mut all = Vec::new();
        for (number, material) in gltf.materials().enumerate() {
            let fault =
                |message| report.push(format!("material {number}: {message}; that texture is left out"));
            let mut surface = Self::of(&material, &json["materials"][number], fault);
            let others = surface.keep(&is_there);
            if others > 0 {
                report.push(format!(
                    "material {number}: {others} of its textures use other coordinates than the first, or move them otherwise; left out"
                ));
            }
            all.push(surface);
        }
        all.into_iter().chain([none]).collect()
    }

    /// All of its textures; the first says where they lie.
    fn lookups(&self) -> impl Iterator<Item = Lookup> {
        let maps = [self.normal, self.occlusion].map(|map| map.map(|(lookup, _)| lookup));
        [self.color, self.rough].into_iter().chain(maps).flatten()
    }

    /// Keeps the textures that are there and lie where the first does; how many lie elsewhere.
    fn keep(&mut self, is_there: impl Fn(usize) -> bool) -> usize {
        let is_image = |lookup: &Lookup| is_there(lookup.image);
        self.color = self.color.filter(is_image);
        self.rough = self.rough.filter(is_image);
        self.normal = self.normal.filter(|(lookup, _)| is_image(lookup));
        self.occlusion = self.occlusion.filter(|(lookup, _)| is_image(lookup));
        let before = self.lookups().count();
        let Some(first) = self.lookups().next() else { return 0 };
        let is_same = |lookup: &Lookup| lookup.place == first.place;
        self.rough = self.rough.filter(is_same);
        self.normal = self.normal.filter(|(lookup, _)| is_same(lookup));
        self.occlusion = self.occlusion.filter(|(lookup, _)| is_same(lookup));
        before - self.lookups().count()
    }

    /// A material and its lines of the document; `fault` takes what is wrong with one of its textures.
    fn of(material: &gltf::Material<'_>, json: &Value, mut fault: impl FnMut(String)) -> Self {
        let surface = material.pbr_metallic_roughness();
        let of_surface = &json["pbrMetallicRoughness"];
        let mut lookup = |texture: gltf::Texture<'_>, line: &Value| {
            let place = Placement::of(line).map_err(&mut fault).ok()?;
            Some(Lookup { image: texture.source().index(), place })
        };
        Self {
            glow: Vec3::from(material.emissive_factor()),
            roughness: surface.roughness_factor().clamp(0.0, 1.0),
            metal: surface.metallic_factor().clamp(0.0, 1.0),
            cutoff: (material.alpha_mode() == AlphaMode::Mask)
                .then(|| material.alpha_cutoff().unwrap_or(0.5)),
            is_blended: material.alpha_mode() == AlphaMode::Blend,
            is_two_sided: material.double_sided(),
            color: surface
                .base_color_texture()
                .and_then(|map| lookup(map.texture(), &of_surface["baseColorTexture"])),
            normal: material
                .normal_texture()
                .and_then(|map| Some((lookup(map.texture(), &json["normalTexture"])?, map.scale()))),
            rough: surface
                .metallic_roughness_texture()
                .and_then(|map| lookup(map.texture(), &of_surface["metallicRoughnessTexture"])),
            occlusion: material
                .occlusion_texture()
                .and_then(|map| Some((lookup(map.texture(), &json["occlusionTexture"])?, map.strength()))),
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
        let first = self.lookups().next();
        let found = first.map(|lookup| lookup.place.places(primitive, count, buffers)).transpose()?;
        Ok(found.flatten().unwrap_or_else(|| vec![Vec2::ZERO; count]))
    }
}
