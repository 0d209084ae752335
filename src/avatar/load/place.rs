//! Places: models that people walk in, with their materials and textures.

use super::super::Error;
use super::super::model::{PlaceMaterial, PlaceModel, PlaceVertex};
use super::model::{Standing, read};
use super::paint::Texture;
use super::source::{Part, Source};
use super::surface::{Lookup, Surface};
use crate::picture::Image;
use std::collections::BTreeMap;
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
    let mut made = Made {
        source: &source,
        model: PlaceModel::default(),
        colors: Images::default(),
        maps: Images::default(),
    };
    for surface in &source.surfaces {
        made.material(surface);
    }
    for part in &source.parts {
        made.part(part);
    }
    let model = made.finish();
    if model.solid.is_empty() && model.open.is_empty() {
        return Err(Error::Unusable { name, message: "the model has no triangles".to_owned() });
    }
    Ok(model)
}

/// Images that are used, by their number in the file.
#[derive(Default)]
struct Images {
    number: BTreeMap<usize, u32>,
}

impl Images {
    fn take(&mut self, lookup: Lookup) -> u32 {
        let next = u32::try_from(self.number.len()).unwrap_or(u32::MAX);
        *self.number.entry(lookup.image).or_insert(next)
    }

    fn pictures(&self, textures: &[Texture]) -> Vec<Image> {
        let mut all: Vec<(u32, usize)> =
            self.number.iter().map(|(image, number)| (*number, *image)).collect();
        all.sort_unstable();
        all.into_iter().filter_map(|(_, image)| textures.get(image)).map(rgba).collect()
    }
}

/// An image with all four channels.
fn rgba(texture: &Texture) -> Image {
    let Texture { width, height, channels, ref pixels } = *texture;
    let four = |texel: &[u8]| match *texel {
        [grey] => [grey, grey, grey, 255],
        [grey, alpha] => [grey, grey, grey, alpha],
        [r, g, b] => [r, g, b, 255],
        [r, g, b, alpha, ..] => [r, g, b, alpha],
        [] => [255; 4],
    };
    let mut rgba: Vec<u8> = pixels.chunks_exact(channels.max(1)).flat_map(four).collect();
    rgba.resize(width as usize * height as usize * 4, 255);
    Image { width, height, pixels: rgba }
}

struct Made<'a> {
    source: &'a Source,
    model: PlaceModel,
    colors: Images,
    maps: Images,
}

impl Made<'_> {
    fn material(&mut self, surface: &Surface) {
        let cutoff = surface.cutoff.or(surface.is_blended.then_some(LEAST_BLENDED)).unwrap_or(0.0);
        let made = PlaceMaterial {
            glow: surface.glow,
            roughness: surface.roughness,
            metal: surface.metal,
            cutoff,
            color: surface.color.map(|lookup| self.colors.take(lookup)),
            rough: surface.rough.map(|lookup| self.maps.take(lookup)),
            normal: surface.normal.map(|(lookup, scale)| (self.maps.take(lookup), scale)),
            occlusion: surface.occlusion.map(|(lookup, strength)| (self.maps.take(lookup), strength)),
        };
        self.model.materials.push(made);
    }

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

    fn finish(self) -> PlaceModel {
        let Self { source, mut model, colors, maps } = self;
        model.colors = colors.pictures(&source.textures);
        model.maps = maps.pictures(&source.textures);
        model
    }
}
