//! A panel's picture as images of the runtime, for a layer of its own beside the one of the eyes: its letters stay sharp.

use super::super::error::Error;
use super::super::swapchain::{ImageKind, Swapchain};
use super::WIDTH;
use super::picture::ROWS;
use crate::gpu::{Buffer, Device, FRAMES_IN_FLIGHT, Memory};
use crate::picture::Image;
use crate::render::{Commands, ImageUse, Transition, first_layer};
use ash::vk;
use openxr as xr;
use std::sync::Arc;
use vk::{AccessFlags2 as Access, ImageLayout as Layout, PipelineStageFlags2 as Stage};

/// The images, and where the host writes what they show next.
pub(in super::super) struct PanelImages {
    pub(in super::super) chain: Swapchain,
    /// One for each frame in flight.
    uploads: [Buffer; FRAMES_IN_FLIGHT],
    /// The image that the present frame writes.
    acquired: Option<vk::Image>,
    /// Whether an image was written: before that there is nothing to show.
    is_written: bool,
}

impl PanelImages {
    /// Images in one of the session's formats.
    pub(in super::super) fn new(
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        format: vk::Format,
    ) -> Result<Self, Error> {
        let uses = xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::TRANSFER_DST;
        let kind = ImageKind { format, size: [WIDTH, ROWS], uses };
        let bytes = u64::from(WIDTH) * u64::from(ROWS) * 4;
        let upload = || Buffer::new(device, "panel", bytes, Memory::Upload);
        Ok(Self {
            chain: Swapchain::new(session, device, kind, 1)?,
            uploads: [upload()?, upload()?],
            acquired: None,
            is_written: false,
        })
    }

    /// Takes what the frame of a slot, of which the one before was waited for, is to write.
    pub(in super::super) fn write(
        &mut self,
        slot: usize,
        image: &Image,
        swaps_red: bool,
    ) -> Result<(), Error> {
        if self.acquired.is_none() {
            self.acquired = Some(self.chain.acquire()?);
        }
        let to = self.uploads[slot].bytes_mut();
        for (to, from) in to.chunks_exact_mut(4).zip(image.pixels.chunks_exact(4)) {
            let [r, g, b, a] = [from[0], from[1], from[2], from[3]];
            to.copy_from_slice(&if swaps_red { [b, g, r, a] } else { [r, g, b, a] });
        }
        Ok(())
    }

    /// Records the copy into the image that was acquired. The image is in the layout of a colour attachment afterwards.
    pub(in super::super) fn record(&self, commands: &Commands<'_>, slot: usize) {
        let Some(image) = self.acquired else { return };
        let aspect = vk::ImageAspectFlags::COLOR;
        let unused = ImageUse::discarded(Stage::COLOR_ATTACHMENT_OUTPUT);
        let target = ImageUse {
            stages: Stage::COPY,
            access: Access::TRANSFER_WRITE,
            layout: Layout::TRANSFER_DST_OPTIMAL,
        };
        commands.transition(&[Transition { image, aspect, from: unused, to: target }]);
        let region = [vk::BufferImageCopy::default()
            .image_extent(vk::Extent3D { width: WIDTH, height: ROWS, depth: 1 })
            .image_subresource(first_layer())];
        // SAFETY: the image is in that layout and of that size, the buffer holds as many bytes; recording has begun.
        unsafe {
            let (buffer, raw) = (commands.buffer, commands.raw());
            raw.cmd_copy_buffer_to_image(buffer, self.uploads[slot].raw, image, target.layout, &region);
        }
        commands.transition(&[Transition { image, aspect, from: target, to: ImageUse::COLOR_WRITTEN }]);
    }

    /// Hands an image over that was written.
    pub(in super::super) fn release(&mut self) -> Result<(), Error> {
        if self.acquired.take().is_some() {
            self.chain.release()?;
            self.is_written = true;
        }
        Ok(())
    }

    /// Whether there is something to show.
    pub(in super::super) const fn is_written(&self) -> bool {
        self.is_written
    }

    /// A part of the image that was released last.
    pub(in super::super) fn part(&self, part: [u32; 4]) -> xr::sys::SwapchainSubImage {
        self.chain.part(part)
    }
}
