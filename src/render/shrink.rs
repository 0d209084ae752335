//! A small copy of a picture that was drawn into somebody else's image: for a window that shows what the headset shows.

use super::target::{COLOR_FORMAT, GpuImage, ImageSpec, Transition};
use super::{Error, Image, Renderer};
use crate::gpu::{Buffer, Memory};
use ash::vk;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// A small image and where the host reads it.
pub(crate) struct Small {
    image: GpuImage,
    readback: Buffer,
    size: [u32; 2],
}

impl Renderer {
    /// Copies the first layer of an image that [`Renderer::draw_into`] has drawn, made `size` pixels large, to the host. The
    /// image stays in the layout of a colour attachment.
    ///
    /// # Errors
    /// When memory is short or a call fails.
    pub(crate) fn shrink(&mut self, from: vk::Image, [width, height]: [u32; 2]) -> Result<Image, Error> {
        let small = match self.small.take().filter(|small| small.size == [width, height]) {
            Some(small) => small,
            None => self.make_small([width, height])?,
        };
        let full = [self.settings.width, self.settings.height];
        self.submit(|raw, commands| {
            let aspect = vk::ImageAspectFlags::COLOR;
            let drawn = (
                Stage::COLOR_ATTACHMENT_OUTPUT,
                Access::COLOR_ATTACHMENT_WRITE,
                Layout::COLOR_ATTACHMENT_OPTIMAL,
            );
            let source = (Stage::BLIT, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
            let target = (Stage::BLIT, Access::TRANSFER_WRITE, Layout::TRANSFER_DST_OPTIMAL);
            let copied = (Stage::COPY, Access::TRANSFER_READ, Layout::TRANSFER_SRC_OPTIMAL);
            let image = small.image.raw;
            self.transition(
                commands,
                &[
                    Transition { image: from, aspect, from: drawn, to: source },
                    Transition {
                        image,
                        aspect,
                        from: (Stage::COPY, Access::NONE, Layout::UNDEFINED),
                        to: target,
                    },
                ],
            );
            let region = [vk::ImageBlit::default()
                .src_subresource(first_layer())
                .src_offsets(corners(full))
                .dst_subresource(first_layer())
                .dst_offsets(corners([width, height]))];
            // SAFETY: both images are in the layouts named, and as large as the corners say; recording has begun.
            unsafe {
                raw.cmd_blit_image(commands, from, source.2, image, target.2, &region, vk::Filter::LINEAR);
            }
            self.transition(
                commands,
                &[
                    Transition { image: from, aspect, from: source, to: drawn },
                    Transition { image, aspect, from: target, to: copied },
                ],
            );
            let region = [vk::BufferImageCopy::default()
                .image_extent(vk::Extent3D { width, height, depth: 1 })
                .image_subresource(first_layer())];
            let barrier = [vk::MemoryBarrier2::default()
                .src_stage_mask(Stage::COPY)
                .src_access_mask(Access::TRANSFER_WRITE)
                .dst_stage_mask(Stage::HOST)
                .dst_access_mask(Access::HOST_READ)];
            // SAFETY: the image is in that layout, and the buffer has room for it; recording has begun.
            unsafe {
                raw.cmd_copy_image_to_buffer(commands, image, copied.2, small.readback.raw, &region);
                raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&barrier));
            }
            Ok(())
        })?;
        let mut pixels = small.readback.bytes().to_vec();
        pixels.truncate(width as usize * height as usize * 4);
        self.small = Some(small);
        Ok(Image { width, height, pixels })
    }

    fn make_small(&self, [width, height]: [u32; 2]) -> Result<Small, Error> {
        let image = GpuImage::new(
            &self.device,
            ImageSpec {
                name: "small picture",
                extent: vk::Extent2D { width, height },
                layers: 1,
                format: COLOR_FORMAT,
                samples: vk::SampleCountFlags::TYPE_1,
                // sampled by nobody, but an image has a view, and a view wants a use
                usage: vk::ImageUsageFlags::TRANSFER_SRC
                    | vk::ImageUsageFlags::TRANSFER_DST
                    | vk::ImageUsageFlags::SAMPLED,
            },
        )?;
        let bytes = u64::from(width) * u64::from(height) * 4;
        let readback = Buffer::new(&self.device, "small picture readback", bytes, Memory::Readback)?;
        Ok(Small { image, readback, size: [width, height] })
    }
}

fn first_layer() -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers {
        aspect_mask: vk::ImageAspectFlags::COLOR,
        mip_level: 0,
        base_array_layer: 0,
        layer_count: 1,
    }
}

fn corners(size: [u32; 2]) -> [vk::Offset3D; 2] {
    let side = |pixels: u32| i32::try_from(pixels).unwrap_or(i32::MAX);
    [vk::Offset3D::default(), vk::Offset3D { x: side(size[0]), y: side(size[1]), z: 1 }]
}
