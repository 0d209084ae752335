//! What a primitive is painted with: vertex colours, base colour, and textures looked up at the vertices.

use super::super::Material;
use super::super::glb::MATERIALS;
use super::accessor::{self, Buffer};
use super::placement::Placement;
use glam::{Vec2, Vec3, Vec4};
use gltf::material::AlphaMode;
use serde_json::Value;

/// Points of a triangle, as shares of its corners, at which a cut-out is looked at.
const SAMPLES: [[f32; 3]; 7] = [
    [0.34, 0.33, 0.33],
    [0.7, 0.15, 0.15],
    [0.15, 0.7, 0.15],
    [0.15, 0.15, 0.7],
    [0.45, 0.45, 0.1],
    [0.45, 0.1, 0.45],
    [0.1, 0.45, 0.45],
];

/// Texture turned to linear RGB lookups, with alpha.
#[derive(Debug, Clone, Default)]
pub(super) struct Texture {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) channels: usize,
    pub(super) pixels: Vec<u8>,
}

impl Texture {
    fn linear(&self, uv: Vec2) -> Vec4 {
        let wrap = |v: f32, size: u32| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "0 <= v < size, then clamped"
            )]
            let texel = (v.rem_euclid(1.0) * size as f32) as usize;
            texel.min(size as usize - 1)
        };
        let at = (wrap(uv.y, self.height) * self.width as usize + wrap(uv.x, self.width)) * self.channels;
        let channel = |c: usize| {
            let slot = if self.channels < 3 { 0 } else { c };
            let value = f32::from(self.pixels.get(at + slot).copied().unwrap_or(255)) / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
        };
        let alpha = match self.channels {
            2 | 4 => f32::from(self.pixels.get(at + self.channels - 1).copied().unwrap_or(255)) / 255.0,
            _ => 1.0,
        };
        Vec4::new(channel(0), channel(1), channel(2), alpha)
    }
}

/// What a primitive is painted with.
pub(super) struct Paint<'a> {
    /// Vertex colour x base colour factor, linear, and alpha.
    pub(super) own: Vec<Vec4>,
    /// Base colour texture, and where on it each vertex lies.
    texture: Option<(&'a Texture, Vec<Vec2>)>,
}

impl<'a> Paint<'a> {
    /// That of a primitive whose material's lines of the document are `json`.
    ///
    /// # Errors
    /// When there are not as many colours or coordinates as vertices, or coordinates are moved by what is no number.
    pub(super) fn of(
        primitive: &gltf::Primitive<'_>,
        json: &Value,
        count: usize,
        buffers: &[Buffer],
        textures: &'a [Option<Texture>],
    ) -> Result<Self, String> {
        use gltf::Semantic;
        let surface = primitive.material().pbr_metallic_roughness();
        let mut factor = Vec4::from(surface.base_color_factor());
        if tint(primitive) != Material::Fixed {
            factor = Vec4::ONE.with_w(factor.w); // the base colour of a tinted material is only an example
        }
        let mut own = vec![factor.clamp(Vec4::ZERO, Vec4::ONE); count];
        if let Some(found) = primitive.get(&Semantic::Colors(0)) {
            let found = accessor::color(&found, buffers)?;
            if found.len() != count {
                return Err(format!("has {count} positions but {} colours", found.len()));
            }
            own.iter_mut().zip(found).for_each(|(color, own)| *color *= own.clamp(Vec4::ZERO, Vec4::ONE));
        }
        let mut texture = None;
        if let Some(info) = surface.base_color_texture()
            && let Some(Some(image)) = textures.get(info.texture().source().index())
        {
            let place = Placement::of(&json["pbrMetallicRoughness"]["baseColorTexture"])?;
            texture = place.places(primitive, count, buffers)?.map(|uv| (image, uv));
        }
        Ok(Self { own, texture })
    }

    /// Linear colour and alpha of a point of a triangle, by the shares of its corners.
    fn at(&self, corners: [u32; 3], shares: Vec3) -> Vec4 {
        let [a, b, c] = corners.map(|corner| corner as usize);
        let color = self.own[a] * shares.x + self.own[b] * shares.y + self.own[c] * shares.z;
        let texel = self
            .texture
            .as_ref()
            .map(|(texture, uv)| texture.linear(uv[a] * shares.x + uv[b] * shares.y + uv[c] * shares.z));
        color * texel.unwrap_or(Vec4::ONE)
    }

    /// The triangles that are seen at all: of a cut-out (MASK) those that are there for the larger part.
    pub(super) fn visible(&self, indices: Vec<u32>, primitive: &gltf::Primitive<'_>) -> Vec<u32> {
        if primitive.material().alpha_mode() != AlphaMode::Mask {
            return indices;
        }
        let cutoff = primitive.material().alpha_cutoff().unwrap_or(0.5);
        let is_there = |corners: &&[u32]| {
            let corners = [corners[0], corners[1], corners[2]];
            let there = SAMPLES.iter().filter(|shares| self.at(corners, Vec3::from(**shares)).w >= cutoff);
            2 * there.count() > SAMPLES.len()
        };
        indices.chunks_exact(3).filter(is_there).flatten().copied().collect()
    }

    /// Colours of the vertices; only what is blended keeps its alpha.
    pub(super) fn colors(&self, primitive: &gltf::Primitive<'_>) -> Vec<Vec4> {
        let is_blended = primitive.material().alpha_mode() == AlphaMode::Blend;
        let vertices = 0..u32::try_from(self.own.len()).unwrap_or(u32::MAX);
        let colors = vertices.map(|vertex| self.at([vertex; 3], Vec3::X));
        colors.map(|color| if is_blended { color } else { color.with_w(1.0) }).collect()
    }
}

/// Materials named by [`mod@super::super::glb`] take the agent's colours.
pub(super) fn tint(primitive: &gltf::Primitive<'_>) -> Material {
    let material = primitive.material();
    let known = MATERIALS.iter().find(|(_, name, _)| material.name() == Some(name));
    known.map_or(Material::Fixed, |(material, ..)| *material)
}
