//! Small copies of what the headset shows, for a window.

use crate::picture::Image;
use crate::render::{
    COLOR_FORMAT, Error, GpuImage, ImageSpec, ImageUse, Readback, Renderer, Transition, corners, first_layer,
};
use ash::vk;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// Scales images down on the device and copies them to the host.
#[derive(Default)]
pub(super) struct Miniature {
    /// The small image and where the host reads it; made when first needed.
    made: Option<(GpuImage, Readback)>,
}

impl Miniature {
    /// Copies the first layer of an image that `renderer` has drawn to the host, scaled to `size` pixels. The image is in the
    /// layout of a colour attachment before and afterwards.
    ///
    /// # Errors
    /// When memory is short or a call fails.
    pub(super) fn copy(
        &mut self,
        renderer: &Renderer,
        from: vk::Image,
        size: [u32; 2],
    ) -> Result<Image, Error> {
        let (small, readback) = match self.made.take().filter(|(_, readback)| readback.size() == size) {
            Some(made) => made,
            None => make(renderer, size)?,
        };
        let settings = renderer.settings();
        let full = [settings.width, settings.height];
        renderer.submitter().submit(|commands| {
            let aspect = vk::ImageAspectFlags::COLOR;
            let drawn = ImageUse::COLOR_WRITTEN;
            let source = ImageUse { stages: Stage::BLIT, ..ImageUse::COPY_SOURCE };
            let target = ImageUse {
                stages: Stage::BLIT,
                access: Access::TRANSFER_WRITE,
                layout: Layout::TRANSFER_DST_OPTIMAL,
            };
            let change = |image, from, to| Transition { image, aspect, from, to };
            let unused = ImageUse::discarded(Stage::COPY);
            commands.transition(&[change(from, drawn, source), change(small.raw, unused, target)]);
            let region = [vk::ImageBlit::default()
                .src_subresource(first_layer())
                .src_offsets(corners(full))
                .dst_subresource(first_layer())
                .dst_offsets(corners(size))];
            // SAFETY: both images are in the layouts named, and as large as the corners say; recording has begun.
            unsafe {
                commands.raw().cmd_blit_image(
                    commands.buffer,
                    from,
                    source.layout,
                    small.raw,
                    target.layout,
                    &region,
                    vk::Filter::LINEAR,
                );
            }
            commands
                .transition(&[change(from, source, drawn), change(small.raw, target, ImageUse::COPY_SOURCE)]);
            readback.copy(commands.raw(), commands.buffer, &[small.raw], aspect);
            Ok(())
        })?;
        let image = readback.image();
        self.made = Some((small, readback));
        Ok(image)
    }
}

fn make(renderer: &Renderer, size: [u32; 2]) -> Result<(GpuImage, Readback), Error> {
    // nothing samples the image, but every image here has a view, and Vulkan wants a use for a view
    let usage = vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::SAMPLED;
    let spec = ImageSpec { usage, ..ImageSpec::flat("miniature", size, COLOR_FORMAT) };
    let image = GpuImage::readable(renderer.device(), spec)?;
    Ok((image, Readback::new(renderer.device(), "miniature readback", size, 1)?))
}
