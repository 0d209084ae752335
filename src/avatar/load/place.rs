//! Places: models that people walk in, with their materials and textures.

use super::super::Error;
use super::super::model::{PlaceModel, PlaceVertex};
use super::model::{Standing, read};
use super::source::{Part, Source};
use super::textured::textured;
use std::path::Path;

/// Of what is blended, the least alpha that is drawn: as if it were whole.
const LEAST_BLENDED: f32 = 0.5;

/// Reads a place. What is blended is drawn whole where it is more there than not, and left out elsewhere.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Packed`] and [`Error::Unusable`] when it is packed, malformed, has
/// an image that cannot be read, or has no triangles.
pub(crate) fn place(path: &Path) -> Result<PlaceModel, Error> {
    let (name, source) = read(path, Source::read_place)?;
    let mut made = Made { source: &source, model: PlaceModel::default() };
    for part in &source.parts {
        made.part(part);
    }
    let mut model = made.model;
    model.textured = textured(&source);
    for material in model.textured.materials.iter_mut().filter(|material| material.is_blended) {
        material.cutoff = LEAST_BLENDED;
    }
    if model.solid.is_empty() && model.open.is_empty() {
        return Err(Error::Unusable { name, message: "the model has no triangles".to_owned() });
    }
    Ok(model)
}

struct Made<'a> {
    source: &'a Source,
    model: PlaceModel,
}

impl Made<'_> {
    fn part(&mut self, part: &Part) {
        let surface = &self.source.surfaces[part.surface];
        let alpha = |corner: &u32| part.colors[*corner as usize].w;
        let stands = Standing::of(self.source, part, |t| {
            !surface.is_blended || t.iter().map(alpha).sum::<f32>() >= 3.0 * LEAST_BLENDED
        });
        let model = &mut self.model;
        let first = u32::try_from(model.vertices.len()).unwrap_or(u32::MAX);
        let material = u32::try_from(part.surface).unwrap_or(0);
        let places = stands.positions.into_iter().zip(stands.normals);
        let corners = places.zip(part.colors.iter().zip(&part.uv));
        model.vertices.extend(corners.map(|((position, normal), (color, uv))| PlaceVertex {
            position,
            normal,
            color: color.truncate(),
            uv: *uv,
            material,
        }));
        let has_holes = surface.color.is_some() && (surface.is_blended || surface.cutoff.is_some());
        let to = if surface.is_two_sided || has_holes { &mut model.open } else { &mut model.solid };
        to.extend(stands.triangles.iter().flatten().map(|corner| first + corner));
    }
}
