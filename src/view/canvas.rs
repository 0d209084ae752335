//! The content of the window: the frame, the panel over it, and copies of both.

use super::Error;
use super::surface::{Slot, Surface};
use crate::gpu::{self, Buffer, Device, Memory, call};
use crate::picture::Image;
use crate::render::{
    COLOR_FORMAT, EyeImages, GpuImage, ImageSpec, ImageUse, Readback, Target, Transition, corners,
    first_layer,
};
use ash::vk;
use egui_ash_renderer::allocator::DefaultAllocator;
use egui_ash_renderer::{DynamicRendering, Options, RenderMode, RendererError};
use std::sync::Arc;

type Stage = vk::PipelineStageFlags2;
type Access = vk::AccessFlags2;
type Layout = vk::ImageLayout;

const DRAWN: ImageUse = ImageUse::COLOR_WRITTEN;
const READ: ImageUse = ImageUse { stages: Stage::ALL_TRANSFER, ..ImageUse::COPY_SOURCE };

/// A panel as egui made it.
pub(super) struct Overlay {
    pub(super) primitives: Vec<egui::ClippedPrimitive>,
    pub(super) textures: egui::TexturesDelta,
    pub(super) pixels_per_point: f32,
}

/// An image of the window's size, and what draws the panel onto it.
pub(super) struct Canvas {
    panel: egui_ash_renderer::Renderer<DefaultAllocator>,
    image: GpuImage,
    extent: vk::Extent2D,
    /// Where the host reads it; made when first needed.
    readback: Option<Readback>,
    /// Where the host writes images that come from memory; made when first needed.
    upload: Option<Buffer>,
    commands: vk::CommandBuffer,
    pool: vk::CommandPool,
    fence: vk::Fence,
    device: Arc<Device>,
}

fn panel_error(error: RendererError) -> crate::Error {
    match error {
        RendererError::Vulkan(result) => call("drawing the panel")(result).into(),
        other => Error::Panel(other.to_string()).into(),
    }
}

/// Written by a transfer at this stage.
fn written(stages: Stage) -> ImageUse {
    ImageUse { stages, access: Access::TRANSFER_WRITE, layout: Layout::TRANSFER_DST_OPTIMAL }
}

fn image(device: &Arc<Device>, extent: vk::Extent2D) -> Result<GpuImage, crate::Error> {
    let usage = vk::ImageUsageFlags::COLOR_ATTACHMENT | vk::ImageUsageFlags::TRANSFER_DST;
    let spec = ImageSpec { usage, ..ImageSpec::flat("canvas", [extent.width, extent.height], COLOR_FORMAT) };
    Ok(GpuImage::readable(device, spec)?)
}

impl Canvas {
    pub(super) fn new(device: &Arc<Device>, [width, height]: [u32; 2]) -> Result<Self, crate::Error> {
        let instance = &device.instance.raw;
        let extent = vk::Extent2D { width, height };
        let target = DynamicRendering {
            color_attachment_format: COLOR_FORMAT,
            depth_attachment_format: None,
            stencil_attachment_format: None,
        };
        let panel = egui_ash_renderer::Renderer::with_default_allocator(
            instance,
            device.physical,
            device.raw.clone(),
            RenderMode::DynamicRendering(target),
            Options { srgb_framebuffer: true, ..Options::default() },
        )
        .map_err(panel_error)?;
        let mut canvas = Self {
            panel,
            image: image(device, extent)?,
            extent,
            readback: None,
            upload: None,
            commands: vk::CommandBuffer::null(),
            pool: vk::CommandPool::null(),
            fence: vk::Fence::null(),
            device: device.clone(),
        };
        canvas.make_commands()?;
        Ok(canvas)
    }

    fn make_commands(&mut self) -> Result<(), gpu::Error> {
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let raw = &self.device.raw;
        // SAFETY: the create-infos are complete; `Drop` destroys what was made.
        unsafe {
            self.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
            let made = raw.allocate_command_buffers(&allocate).map_err(call("vkAllocateCommandBuffers"))?;
            self.commands = made.first().copied().unwrap_or_default();
            self.fence =
                raw.create_fence(&vk::FenceCreateInfo::default(), None).map_err(call("vkCreateFence"))?;
        }
        Ok(())
    }

    /// Takes another size, pixels.
    pub(super) fn resize(&mut self, [width, height]: [u32; 2]) -> Result<(), crate::Error> {
        let extent = vk::Extent2D { width, height };
        if extent != self.extent {
            self.image = image(&self.device, extent)?;
            (self.readback, self.upload) = (None, None);
            self.extent = extent;
        }
        Ok(())
    }

    /// What the frame is drawn into; copied to the host if that is wanted.
    pub(super) const fn target(&self, is_copied: bool) -> Target {
        Target { color: EyeImages::layered(self.image.raw), view: self.image.view, depth: None, is_copied }
    }

    /// Draws the panel over the frame and shows both in the window, if it takes an image just now. Returns a copy if that is
    /// wanted.
    pub(super) fn show(
        &mut self,
        mut overlay: Overlay,
        surface: &mut Surface,
        is_wanted: bool,
    ) -> Result<(bool, Option<Image>), crate::Error> {
        self.take_textures(&mut overlay.textures)?;
        if is_wanted && self.readback.is_none() {
            let size = [self.extent.width, self.extent.height];
            self.readback = Some(Readback::new(&self.device, "window readback", size, 1)?);
        }
        let slot = surface.acquire([self.extent.width, self.extent.height])?;
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: every submission is waited for, so the command buffer is not in use.
        unsafe { self.device.raw.begin_command_buffer(self.commands, &begin) }
            .map_err(call("vkBeginCommandBuffer"))?;
        self.draw_panel(&overlay)?;
        self.transition(self.image.raw, DRAWN, READ);
        if let Some(readback) = self.readback.as_ref().filter(|_| is_wanted) {
            let aspect = vk::ImageAspectFlags::COLOR;
            readback.copy(&self.device.raw, self.commands, &[self.image.raw], aspect);
        }
        if let Some(slot) = &slot {
            self.copy_to(slot);
        }
        // SAFETY: recording has begun.
        unsafe { self.device.raw.end_command_buffer(self.commands) }.map_err(call("vkEndCommandBuffer"))?;
        self.submit(slot.as_ref())?;
        for id in std::mem::take(&mut overlay.textures.free) {
            self.panel.free_texture(id).map_err(panel_error)?;
        }
        if let Some(slot) = &slot {
            surface.show(slot)?;
        }
        let copy = self.readback.as_ref().filter(|_| is_wanted).map(|readback| {
            let mut image = readback.image();
            image.pixels.chunks_exact_mut(4).for_each(|pixel| pixel[3] = 255);
            image
        });
        Ok((slot.is_some(), copy))
    }

    /// Shows an image from memory in the window, `size` pixels large, if it takes an image just now.
    pub(super) fn paint(
        &mut self,
        shown: &Image,
        surface: &mut Surface,
        size: [u32; 2],
    ) -> Result<bool, crate::Error> {
        self.resize([shown.width, shown.height])?;
        if self.upload.is_none() {
            let bytes = shown.pixels.len() as u64;
            self.upload = Some(Buffer::new(&self.device, "shown image", bytes, Memory::Upload)?);
        }
        let Some(upload) = &mut self.upload else { return Ok(false) };
        if let Some(to) = upload.bytes_mut().get_mut(..shown.pixels.len()) {
            to.copy_from_slice(&shown.pixels);
        }
        let upload = upload.raw;
        let Some(slot) = surface.acquire(size)? else { return Ok(false) };
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: every submission is waited for, so the command buffer is not in use.
        unsafe { self.device.raw.begin_command_buffer(self.commands, &begin) }
            .map_err(call("vkBeginCommandBuffer"))?;
        let written = written(Stage::COPY);
        self.transition(self.image.raw, ImageUse::discarded(Stage::ALL_TRANSFER), written);
        let region = [vk::BufferImageCopy::default()
            .image_extent(vk::Extent3D { width: self.extent.width, height: self.extent.height, depth: 1 })
            .image_subresource(first_layer())];
        // SAFETY: the image is in that layout, the buffer holds all its pixels; recording has begun.
        unsafe {
            let raw = &self.device.raw;
            raw.cmd_copy_buffer_to_image(self.commands, upload, self.image.raw, written.layout, &region);
        }
        self.transition(self.image.raw, written, READ);
        self.copy_to(&slot);
        // SAFETY: recording has begun.
        unsafe { self.device.raw.end_command_buffer(self.commands) }.map_err(call("vkEndCommandBuffer"))?;
        self.submit(Some(&slot))?;
        surface.show(&slot)?;
        Ok(true)
    }

    fn take_textures(&mut self, textures: &mut egui::TexturesDelta) -> Result<(), crate::Error> {
        for (id, deltas) in std::mem::take(&mut textures.set) {
            for delta in &deltas {
                let queue = self.device.hold_queue();
                self.panel.set_texture(*queue, self.pool, id, delta).map_err(panel_error)?;
            }
        }
        Ok(())
    }

    fn draw_panel(&mut self, overlay: &Overlay) -> Result<(), crate::Error> {
        // the frame was drawn by an earlier submission, which was waited for
        self.transition(self.image.raw, DRAWN, ImageUse::COLOR_ATTACHMENT);
        let targets = [vk::RenderingAttachmentInfo::default()
            .image_view(self.image.view)
            .image_layout(Layout::COLOR_ATTACHMENT_OPTIMAL)
            .load_op(vk::AttachmentLoadOp::LOAD)
            .store_op(vk::AttachmentStoreOp::STORE)];
        let rendering = vk::RenderingInfo::default()
            .render_area(vk::Rect2D { extent: self.extent, ..Default::default() })
            .layer_count(1)
            .color_attachments(&targets);
        // SAFETY: recording has begun and the image is in the layout of an attachment.
        unsafe { self.device.raw.cmd_begin_rendering(self.commands, &rendering) };
        let drawn =
            self.panel.cmd_draw(self.commands, self.extent, overlay.pixels_per_point, &overlay.primitives);
        // SAFETY: rendering has begun.
        unsafe { self.device.raw.cmd_end_rendering(self.commands) };
        drawn.map_err(panel_error)
    }

    /// Copies everything to an image of the window, which may have another order of colours and, just after a change of
    /// size, other measures.
    fn copy_to(&self, slot: &Slot) {
        let written = written(Stage::BLIT);
        // the submission waits at this stage for the image to be free
        self.transition(slot.image, ImageUse::discarded(Stage::BLIT), written);
        let region = [vk::ImageBlit::default()
            .src_subresource(first_layer())
            .src_offsets(corners([self.extent.width, self.extent.height]))
            .dst_subresource(first_layer())
            .dst_offsets(corners([slot.extent.width, slot.extent.height]))];
        // SAFETY: both images are in the layouts named; recording has begun.
        unsafe {
            self.device.raw.cmd_blit_image(
                self.commands,
                self.image.raw,
                READ.layout,
                slot.image,
                written.layout,
                &region,
                vk::Filter::NEAREST,
            );
        }
        let shown = ImageUse { layout: Layout::PRESENT_SRC_KHR, ..ImageUse::discarded(Stage::NONE) };
        self.transition(slot.image, written, shown);
    }

    fn transition(&self, image: vk::Image, from: ImageUse, to: ImageUse) {
        let aspect = vk::ImageAspectFlags::COLOR;
        let barriers = [Transition { image, aspect, from, to }.barrier()];
        let dependency = vk::DependencyInfo::default().image_memory_barriers(&barriers);
        // SAFETY: recording has begun, outside of rendering; the image is alive.
        unsafe { self.device.raw.cmd_pipeline_barrier2(self.commands, &dependency) };
    }

    fn submit(&self, slot: Option<&Slot>) -> Result<(), gpu::Error> {
        let semaphore =
            |semaphore, stage| vk::SemaphoreSubmitInfo::default().semaphore(semaphore).stage_mask(stage);
        let waits: Vec<_> = slot.iter().map(|slot| semaphore(slot.free, Stage::BLIT)).collect();
        let signals: Vec<_> = slot.iter().map(|slot| semaphore(slot.drawn, Stage::ALL_COMMANDS)).collect();
        let infos = [vk::CommandBufferSubmitInfo::default().command_buffer(self.commands)];
        let submit = [vk::SubmitInfo2::default()
            .command_buffer_infos(&infos)
            .wait_semaphore_infos(&waits)
            .signal_semaphore_infos(&signals)];
        let raw = &self.device.raw;
        let queue = self.device.hold_queue();
        self.device.reset(self.fence)?;
        // SAFETY: the command buffer is recorded and not in use, the fence is unsignalled, the queue is held.
        unsafe { raw.queue_submit2(*queue, &submit, self.fence) }.map_err(call("vkQueueSubmit2"))?;
        self.device.wait(self.fence)
    }
}

impl Drop for Canvas {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: every submission was waited for; null handles are ignored.
        unsafe {
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}
