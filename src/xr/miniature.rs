//! Small copies of what the headset shows, for a window.

use crate::gpu::FRAMES_IN_FLIGHT;
use crate::picture::Image;
use crate::render::{
    COLOR_FORMAT, Commands, Error, GpuImage, ImageSpec, ImageUse, Readback, Renderer, Transition, corners,
    first_layer,
};
use ash::vk;
use glam::Mat4;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// Scales images down on the device and copies them to the host, as a part of the frames that drew them.
#[derive(Default)]
pub(super) struct Miniature {
    made: Option<Made>,
}

struct Made {
    size: [u32; 2],
    /// The small image, which only the device uses.
    small: GpuImage,
    /// Where the host reads it, for each frame in flight, and clip from world space of the eye if there is a copy.
    copies: [(Readback, Option<Mat4>); FRAMES_IN_FLIGHT],
}

impl Miniature {
    /// Makes room for copies of `size` pixels of what `renderer` draws.
    ///
    /// # Errors
    /// When memory is short or a call fails.
    pub(super) fn prepare(&mut self, renderer: &Renderer, size: [u32; 2]) -> Result<(), Error> {
        if self.made.as_ref().is_some_and(|made| made.size == size) {
            return Ok(());
        }
        renderer.finish(false)?; // frames in flight copy to where they were told to
        self.made = None;
        // nothing samples the image, but every image here has a view, and Vulkan wants a use for a view
        let usage = vk::ImageUsageFlags::TRANSFER_DST | vk::ImageUsageFlags::SAMPLED;
        let spec = ImageSpec { usage, ..ImageSpec::flat("miniature", size, COLOR_FORMAT) };
        let readback = || Readback::new(renderer.device(), "miniature readback", size, 1);
        let copies = [(readback()?, None), (readback()?, None)];
        self.made = Some(Made { size, small: GpuImage::readable(renderer.device(), spec)?, copies });
        Ok(())
    }

    /// Records the copy of the first layer of an image, of `full` pixels, that was drawn by the frame of a slot. The image is in
    /// the layout of a colour attachment before and afterwards.
    pub(super) fn record(
        &mut self,
        commands: &Commands<'_>,
        slot: usize,
        from: vk::Image,
        full: [u32; 2],
        clip: Mat4,
    ) {
        let Some(Made { size, small, copies }) = &mut self.made else { return };
        let (readback, copied) = &mut copies[slot];
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
            .dst_offsets(corners(*size))];
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
        commands.transition(&[change(from, source, drawn), change(small.raw, target, ImageUse::COPY_SOURCE)]);
        readback.copy(commands.raw(), commands.buffer, &[small.raw], aspect);
        *copied = Some(clip);
    }

    /// The copy that the frame of a slot made, which was waited for, and clip from world space of its eye.
    pub(super) fn take(&mut self, slot: usize) -> Option<(Image, Mat4)> {
        let (readback, copied) = &mut self.made.as_mut()?.copies[slot];
        copied.take().map(|clip| (readback.image(), clip))
    }
}
