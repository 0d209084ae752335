//! Materials and textures of a file as the renderer takes them.

use super::super::model::{Textured, TexturedMaterial};
use super::paint::Texture;
use super::source::Source;
use super::surface::Lookup;
use crate::picture::Image;
use std::collections::BTreeMap;

/// The materials of a file, by their numbers there, and the images that they use.
pub(super) fn textured(source: &Source) -> Textured {
    let (mut colors, mut maps) = (Images::default(), Images::default());
    let materials = source
        .surfaces
        .iter()
        .map(|surface| TexturedMaterial {
            glow: surface.glow,
            roughness: surface.roughness,
            metal: surface.metal,
            cutoff: surface.cutoff.unwrap_or(0.0),
            is_blended: surface.is_blended,
            is_two_sided: surface.is_two_sided,
            color: surface.color.map(|lookup| colors.take(lookup)),
            rough: surface.rough.map(|lookup| maps.take(lookup)),
            normal: surface.normal.map(|(lookup, scale)| (maps.take(lookup), scale)),
            occlusion: surface.occlusion.map(|(lookup, strength)| (maps.take(lookup), strength)),
        })
        .collect();
    let [colors, maps] = [colors, maps].map(|images| images.pictures(&source.textures));
    Textured { materials, colors, maps }
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
