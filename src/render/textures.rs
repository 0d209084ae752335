//! Textures of a place: the layers of one image, all of one size, with their smaller levels.
//!
//! A shader picks a layer by its number, so all of a place is drawn without changing what is bound. Smaller levels are made
//! here, not by the device: a mean of four texels in linear light, the same everywhere.

use super::Error;
use super::commands::Submitter;
use super::pipelines::Resource;
use super::target::{GpuImage, ImageSpec, ImageUse, Transition, aspect_of};
use crate::gpu::{Buffer, Memory};
use crate::picture::Image;
use ash::vk;

/// Most texels a side.
const MOST_TEXELS: u32 = 2048;
/// Most bytes of the largest levels of all layers.
const MOST_BYTES: u64 = 256 << 20;

/// What the bytes of a texture are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Coding {
    /// Colours with the sRGB curve; alpha is linear.
    Srgb,
    /// Numbers.
    Linear,
}

/// An image with a layer for each texture.
pub(super) struct Textures {
    image: GpuImage,
}

impl Textures {
    /// Uploads textures; without any there is one white texel.
    pub(super) fn new(
        submitter: &Submitter,
        name: &'static str,
        images: &[Image],
        coding: Coding,
    ) -> Result<Self, Error> {
        let white = [Image::filled(1, 1, [255; 4])];
        let images = if images.is_empty() { &white[..] } else { images };
        let limits = &submitter.device().limits;
        let most = limits.max_image_array_layers;
        let layers = u32::try_from(images.len()).unwrap_or(u32::MAX);
        if layers > most {
            return Err(Error::Textures { count: images.len(), most });
        }
        let side = side_of(images, MOST_TEXELS.min(limits.max_image_dimension2_d));
        let format = match coding {
            Coding::Srgb => vk::Format::R8G8B8A8_SRGB,
            Coding::Linear => vk::Format::R8G8B8A8_UNORM,
        };
        let usage = vk::ImageUsageFlags::SAMPLED | vk::ImageUsageFlags::TRANSFER_DST;
        let levels = side.ilog2() + 1;
        let spec =
            ImageSpec { usage, layers, levels, is_array: true, ..ImageSpec::flat(name, [side; 2], format) };
        let image = GpuImage::new(submitter.device(), spec)?;
        for (layer, picture) in (0..).zip(images) {
            upload(submitter, &image, layer, &pyramid(picture, side, coding), layer + 1 == layers)?;
        }
        Ok(Self { image })
    }

    pub(super) fn resource(&self) -> Resource {
        Resource::Texture(self.image.view, ImageUse::SAMPLED.layout)
    }
}

/// Texels a side of all layers: those of the largest texture as a power of two, or fewer where memory would be short.
fn side_of(images: &[Image], most: u32) -> u32 {
    let largest = images.iter().map(|image| image.width.max(image.height)).max().unwrap_or(1);
    let mut side = largest.clamp(1, most).next_power_of_two().min(most);
    while side > 1 && 4 * u64::from(side).pow(2) * images.len() as u64 > MOST_BYTES {
        side /= 2;
    }
    side
}

/// Copies all levels of a layer.
fn upload(
    submitter: &Submitter,
    image: &GpuImage,
    layer: u32,
    levels: &[Image],
    is_last: bool,
) -> Result<(), Error> {
    let bytes: usize = levels.iter().map(|level| level.pixels.len()).sum();
    let mut staging = Buffer::new(submitter.device(), "staging", bytes as u64, Memory::Upload)?;
    let (mut offset, mut regions) = (0, Vec::new());
    for (number, level) in (0..).zip(levels) {
        let end = offset + level.pixels.len();
        if let Some(to) = staging.bytes_mut().get_mut(offset..end) {
            to.copy_from_slice(&level.pixels);
        }
        let subresource = vk::ImageSubresourceLayers::default()
            .aspect_mask(vk::ImageAspectFlags::COLOR)
            .mip_level(number)
            .base_array_layer(layer)
            .layer_count(1);
        let extent = vk::Extent3D { width: level.width, height: level.height, depth: 1 };
        regions.push(
            vk::BufferImageCopy::default()
                .buffer_offset(offset as u64)
                .image_subresource(subresource)
                .image_extent(extent),
        );
        offset = end;
    }
    let aspect = aspect_of(vk::Format::R8G8B8A8_UNORM);
    let change = |from, to| [Transition { image: image.raw, aspect, from, to }];
    submitter.submit(|commands| {
        if layer == 0 {
            let unused = ImageUse::discarded(vk::PipelineStageFlags2::NONE);
            commands.transition(&change(unused, ImageUse::COPY_TARGET));
        }
        // SAFETY: the buffer has the levels' bytes, and both live until the submission is done.
        unsafe {
            let layout = ImageUse::COPY_TARGET.layout;
            commands.raw().cmd_copy_buffer_to_image(
                commands.buffer,
                staging.raw,
                image.raw,
                layout,
                &regions,
            );
        }
        if is_last {
            commands.transition(&change(ImageUse::COPY_TARGET, ImageUse::SAMPLED));
        }
        Ok(())
    })
}

/// A texture as a square of so many texels a side, a power of two, and all of its smaller levels.
fn pyramid(image: &Image, side: u32, coding: Coding) -> Vec<Image> {
    let curve = Curve::new(coding);
    let mut levels = vec![resized(image, side, &curve)];
    while let Some(last) = levels.last().filter(|last| last.width > 1) {
        let half = last.width / 2;
        let next = averaged(last, half, &curve, |x, y| {
            [[0, 0], [1, 0], [0, 1], [1, 1]].map(|[right, down]| ([2 * x + right, 2 * y + down], 0.25))
        });
        levels.push(next);
    }
    levels
}

/// The texture in another size: between its texels where it grows, and a mean of four in each where it shrinks.
fn resized(image: &Image, side: u32, curve: &Curve) -> Image {
    if image.width == side && image.height == side {
        return image.clone();
    }
    #[allow(clippy::cast_precision_loss, reason = "at most 16,384 texels")]
    let scale = [image.width, image.height].map(|from| from as f32 / side as f32);
    let most = [image.width, image.height];
    // where a texel's middle lies in the old texture; repeated beyond its edges, as textures are
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_possible_wrap,
        clippy::cast_precision_loss,
        clippy::cast_sign_loss,
        reason = "at most 16,384 texels, wrapped into range"
    )]
    let along = move |axis: usize, at: u32| {
        let middle = (at as f32 + 0.5) * scale[axis] - 0.5;
        let wrap = |texel: f32| (texel as i32).rem_euclid(most[axis] as i32) as u32;
        (wrap(middle.floor()), wrap(middle.floor() + 1.0), middle - middle.floor())
    };
    averaged(image, side, curve, |x, y| {
        let ((left, right, aside), (upper, lower, down)) = (along(0, x), along(1, y));
        [
            ([left, upper], (1.0 - aside) * (1.0 - down)),
            ([right, upper], aside * (1.0 - down)),
            ([left, lower], (1.0 - aside) * down),
            ([right, lower], aside * down),
        ]
    })
}

/// A square whose texels are means of four of an image, by their shares.
fn averaged(image: &Image, side: u32, curve: &Curve, of: impl Fn(u32, u32) -> [([u32; 2], f32); 4]) -> Image {
    let mut pixels = Vec::with_capacity(side as usize * side as usize * 4);
    for y in 0..side {
        for x in 0..side {
            let mut sum = [0.0; 4];
            for ([column, row], share) in of(x, y) {
                let texel = image.pixel(column, row).unwrap_or([255; 4]);
                for (channel, (sum, byte)) in sum.iter_mut().zip(texel).enumerate() {
                    *sum += share * curve.value(channel, byte);
                }
            }
            pixels.extend((0..4).map(|channel| curve.byte(channel, sum[channel])));
        }
    }
    Image { width: side, height: side, pixels }
}

/// Bytes as linear light, and back.
struct Curve {
    coding: Coding,
    linear: [f32; 256],
}

impl Curve {
    fn new(coding: Coding) -> Self {
        #[allow(clippy::cast_precision_loss, reason = "a byte")]
        let linear = std::array::from_fn(|byte| {
            let value = byte as f32 / 255.0;
            if value <= 0.04045 { value / 12.92 } else { libm::powf((value + 0.055) / 1.055, 2.4) }
        });
        Self { coding, linear }
    }

    fn is_curved(&self, channel: usize) -> bool {
        self.coding == Coding::Srgb && channel < 3
    }

    fn value(&self, channel: usize, byte: u8) -> f32 {
        if self.is_curved(channel) { self.linear[usize::from(byte)] } else { f32::from(byte) / 255.0 }
    }

    /// The byte nearest to a value.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "0 to 255")]
    fn byte(&self, channel: usize, value: f32) -> u8 {
        if !self.is_curved(channel) {
            return (value.clamp(0.0, 1.0) * 255.0 + 0.5) as u8;
        }
        let above = self.linear.partition_point(|linear| *linear < value).min(255);
        let below = above.saturating_sub(1);
        let nearer = if value - self.linear[below] < self.linear[above] - value { below } else { above };
        nearer as u8
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn levels_are_means_in_linear_light_down_to_one_texel() {
        let mut image = Image::filled(4, 4, [0, 0, 0, 0]);
        image.fill(0, 0, 2, 4, [255, 255, 255, 255]);
        let levels = pyramid(&image, 4, Coding::Srgb);
        assert_eq!(levels.iter().map(|level| level.width).collect::<Vec<_>>(), [4, 2, 1]);
        assert_eq!(levels[0], image);
        assert_eq!(levels[1].pixel(0, 0), Some([255; 4]));
        // half the light has byte 188 on the curve of sRGB; alpha is linear
        assert_eq!(levels[2].pixel(0, 0), Some([188, 188, 188, 128]));
        let numbers = pyramid(&image, 4, Coding::Linear);
        assert_eq!(numbers[2].pixel(0, 0), Some([128; 4]));
    }

    #[test]
    fn sizes_are_powers_of_two_that_fit_into_memory() {
        let of =
            |width, height, count| side_of(&vec![Image { width, height, pixels: Vec::new() }; count], 2048);
        assert_eq!(of(1, 1, 1), 1);
        assert_eq!(of(300, 100, 1), 512);
        assert_eq!(of(16_384, 16_384, 1), 2048);
        assert_eq!(of(2048, 2048, 16), 2048);
        assert_eq!(of(2048, 2048, 17), 1024);
        assert_eq!(of(2048, 2048, 1000), 256);
    }

    #[test]
    fn a_texture_of_another_size_keeps_its_colours_and_repeats_beyond_its_edges() {
        let curve = Curve::new(Coding::Srgb);
        let plain = resized(&Image::filled(3, 5, [10, 200, 30, 40]), 8, &curve);
        assert_eq!(plain, Image::filled(8, 8, [10, 200, 30, 40]));
        let mut halves = Image::filled(2, 1, [0, 0, 0, 255]);
        halves.set(1, 0, [255, 255, 255, 255]);
        let wide = resized(&halves, 4, &curve);
        let reds: Vec<u8> = (0..4).map(|x| wide.pixel(x, 0).unwrap()[0]).collect();
        assert_eq!(reds, [137, 137, 225, 225]);
        for byte in 0..=255 {
            assert_eq!(curve.byte(0, curve.value(0, byte)), byte);
        }
    }
}
