//! A small copy of a picture that was drawn into somebody else's image: for a window that shows what the headset shows.

use super::target::{COLOR_FORMAT, GpuImage, Readback, Transition, corners, first_layer};
use super::{Error, Image, Renderer};
use ash::vk;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// A small image and where the host reads it.
pub(crate) struct Small {
    image: GpuImage,
    readback: Readback,
}

impl Renderer {
    /// Copies the first layer of an image that [`Renderer::draw_into`] has drawn, made `size` pixels large, to the host. The
    /// image stays in the layout of a colour attachment.
    ///
    /// # Errors
    /// When memory is short or a call fails.
    pub(crate) fn shrink(&mut self, from: vk::Image, [width, height]: [u32; 2]) -> Result<Image, Error> {
        let small = match self.small.take().filter(|small| small.readback.size() == [width, height]) {
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
            small.readback.copy(raw, commands, image, aspect);
            Ok(())
        })?;
        let picture = small.readback.image();
        self.small = Some(small);
        Ok(picture)
    }

    fn make_small(&self, size: [u32; 2]) -> Result<Small, Error> {
        // sampled by nobody, but an image has a view, and a view wants a use
        let usage = vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::SAMPLED;
        let image = GpuImage::readable(&self.device, "small picture", (size, 1), COLOR_FORMAT, usage)?;
        let readback = Readback::new(&self.device, "small picture readback", size, 1)?;
        Ok(Small { image, readback })
    }
}
