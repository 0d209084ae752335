//! Where a texture lies: which coordinates it is looked up by, and how `KHR_texture_transform` moves them.

use super::accessor::{self, Buffer};
use glam::{Mat2, Vec2};
use serde::Deserialize as _;
use serde_json::Value;

/// The extension's name.
const TRANSFORM: &str = "KHR_texture_transform";

/// Where a texture lies on what is made of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placement {
    /// Number of the coordinates.
    set: u32,
    /// They are scaled and turned, then offset.
    turned: Mat2,
    offset: Vec2,
}

/// The extension as it is written.
#[derive(serde::Deserialize)]
#[serde(default, rename_all = "camelCase")]
struct Transform {
    offset: [f32; 2],
    /// Counter-clockwise as coordinates are seen, that is with the second one downwards, rad.
    rotation: f32,
    scale: [f32; 2],
    tex_coord: Option<u32>,
}

impl Default for Transform {
    fn default() -> Self {
        Self { offset: [0.0; 2], rotation: 0.0, scale: [1.0; 2], tex_coord: None }
    }
}

impl Placement {
    /// That of a line of the document which names a texture (`textureInfo`).
    ///
    /// # Errors
    /// A message where the extension is not as it should be.
    pub(super) fn of(line: &Value) -> Result<Self, String> {
        let set = line["texCoord"].as_u64().and_then(|set| u32::try_from(set).ok()).unwrap_or(0);
        let Transform { offset, rotation, scale, tex_coord } = match &line["extensions"][TRANSFORM] {
            Value::Null => Transform::default(),
            written => Transform::deserialize(written).map_err(|error| format!("{TRANSFORM}: {error}"))?,
        };
        let (sine, cosine) = libm::sincosf(rotation);
        let turned = Mat2::from_cols(Vec2::new(cosine, -sine) * scale[0], Vec2::new(sine, cosine) * scale[1]);
        let offset = Vec2::from(offset);
        if !turned.is_finite() || !offset.is_finite() {
            return Err(format!("{TRANSFORM}: a number is too large; 32 bits hold up to 3.4e38"));
        }
        Ok(Self { set: tex_coord.unwrap_or(set), turned, offset })
    }

    /// Where the vertices of a primitive lie on the texture; none where it does not have these coordinates.
    ///
    /// # Errors
    /// When there are not as many coordinates as vertices.
    pub(super) fn places(
        &self,
        primitive: &gltf::Primitive<'_>,
        count: usize,
        buffers: &[Buffer],
    ) -> Result<Option<Vec<Vec2>>, String> {
        let Some(found) = primitive.get(&gltf::Semantic::TexCoords(self.set)) else { return Ok(None) };
        let mut places = accessor::vec2(&found, buffers)?;
        if places.len() != count {
            return Err(format!("has {count} positions but {} texture coordinates", places.len()));
        }
        places.iter_mut().for_each(|place| *place = self.turned * *place + self.offset);
        Ok(Some(places))
    }
}
