//! Recording and submitting command buffers.

use super::Error;
use super::pipelines::{Program, SetIndex};
use super::target::Transition;
use crate::gpu::{self, Buffer, Device, Memory, call};
use ash::vk;
use std::ffi::CStr;
use std::sync::Arc;
use vk::{AccessFlags2 as Access, PipelineStageFlags2 as Stage};

/// A command buffer in the recording state.
#[derive(Clone, Copy)]
pub(crate) struct Commands<'a> {
    device: &'a Device,
    pub(crate) buffer: vk::CommandBuffer,
    /// The frame in flight that they are of: its descriptor sets are bound.
    slot: usize,
}

impl<'a> Commands<'a> {
    /// Begins to record. The command buffer is not in use.
    pub(super) fn begin(device: &'a Device, buffer: vk::CommandBuffer, slot: usize) -> Result<Self, Error> {
        let begin = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the caller's promise: the command buffer is not in use.
        unsafe { device.raw.begin_command_buffer(buffer, &begin) }.map_err(call("vkBeginCommandBuffer"))?;
        Ok(Self { device, buffer, slot })
    }

    /// Ends recording.
    pub(super) fn end(self) -> Result<(), Error> {
        // SAFETY: recording has begun.
        Ok(unsafe { self.raw().end_command_buffer(self.buffer) }.map_err(call("vkEndCommandBuffer"))?)
    }

    /// Ends recording what is not submitted.
    pub(super) fn discard(self) {
        let none = vk::CommandBufferResetFlags::empty();
        // SAFETY: nothing was submitted; what cannot be reset cannot be begun again, and that is an error.
        let _ = unsafe { self.raw().reset_command_buffer(self.buffer, none) };
    }
}

impl Commands<'_> {
    pub(crate) fn raw(&self) -> &ash::Device {
        &self.device.raw
    }

    /// Records under a label, which captures and validation messages show.
    pub(super) fn labelled<T>(&self, name: &CStr, record: impl FnOnce() -> T) -> T {
        let Some(loader) = self.device.names.as_ref() else { return record() };
        let label = vk::DebugUtilsLabelEXT::default().label_name(name);
        // SAFETY: recording has begun.
        unsafe { loader.cmd_begin_debug_utils_label(self.buffer, &label) };
        let recorded = record();
        // SAFETY: recording has begun, and the label is open.
        unsafe { loader.cmd_end_debug_utils_label(self.buffer) };
        recorded
    }

    /// Orders all memory accesses of `from` before those of `to`. Stands outside of rendering.
    pub(super) fn barrier(&self, from: (Stage, Access), to: (Stage, Access)) {
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(from.0)
            .src_access_mask(from.1)
            .dst_stage_mask(to.0)
            .dst_access_mask(to.1)];
        // SAFETY: recording has begun, outside of rendering.
        unsafe {
            let dependency = vk::DependencyInfo::default().memory_barriers(&barrier);
            self.raw().cmd_pipeline_barrier2(self.buffer, &dependency);
        }
    }

    /// Changes layouts of images. Stands outside of rendering.
    pub(crate) fn transition(&self, transitions: &[Transition]) {
        let barriers: Vec<_> = transitions.iter().map(|transition| transition.barrier()).collect();
        // SAFETY: recording has begun, outside of rendering; the images are alive.
        unsafe {
            let dependency = vk::DependencyInfo::default().image_memory_barriers(&barriers);
            self.raw().cmd_pipeline_barrier2(self.buffer, &dependency);
        }
    }

    /// Records draws into these attachments. The images are in the layouts that `rendering` names.
    pub(super) fn rendering(&self, rendering: &vk::RenderingInfo<'_>, draw: impl FnOnce()) {
        // SAFETY: recording has begun and the images are in the layouts of the attachments.
        unsafe { self.raw().cmd_begin_rendering(self.buffer, rendering) };
        self.draw_within(rendering.render_area);
        draw();
        // SAFETY: rendering has begun.
        unsafe { self.raw().cmd_end_rendering(self.buffer) };
    }

    /// Draws into this part of the attachments from now on.
    pub(super) fn draw_within(&self, area: vk::Rect2D) {
        #[allow(clippy::cast_precision_loss, reason = "sides of images are far below 2^24")]
        let viewport = vk::Viewport {
            x: area.offset.x as f32,
            y: area.offset.y as f32,
            width: area.extent.width as f32,
            height: area.extent.height as f32,
            max_depth: 1.0,
            ..Default::default()
        };
        // SAFETY: recording has begun.
        unsafe {
            self.raw().cmd_set_viewport(self.buffer, 0, &[viewport]);
            self.raw().cmd_set_scissor(self.buffer, 0, &[area]);
        }
    }

    /// Binds a pipeline of a program and the program's descriptor set of a pass.
    pub(super) fn use_program(&self, program: &Program, pipeline: vk::Pipeline, pass: usize) {
        let point = vk::PipelineBindPoint::GRAPHICS;
        let sets = [program.set(SetIndex { slot: self.slot, pass })];
        // SAFETY: the pipeline and the set were made with the program's layout; recording has begun.
        unsafe {
            self.raw().cmd_bind_pipeline(self.buffer, point, pipeline);
            self.raw().cmd_bind_descriptor_sets(self.buffer, point, program.layout, 0, &sets, &[]);
        }
    }

    /// Sets the immediates of a program's vertex shader.
    pub(super) fn push(&self, program: &Program, bytes: &[u8]) {
        let stage = vk::ShaderStageFlags::VERTEX;
        // SAFETY: the layout has that many bytes of immediates; recording has begun.
        unsafe { self.raw().cmd_push_constants(self.buffer, program.layout, stage, 0, bytes) };
    }
}

/// A command buffer that is recorded, submitted and waited for, again and again: for all but frames.
pub(crate) struct Submitter {
    device: Arc<Device>,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
}

impl Submitter {
    pub(super) fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let mut made = Self {
            device: device.clone(),
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
        };
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let raw = &device.raw;
        // SAFETY: the create-infos are complete; `Drop` destroys what was made.
        unsafe {
            made.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(made.pool).command_buffer_count(1);
            let buffers =
                raw.allocate_command_buffers(&allocate).map_err(call("vkAllocateCommandBuffers"))?;
            made.commands = buffers.first().copied().unwrap_or_default();
            let fence = vk::FenceCreateInfo::default();
            made.fence = raw.create_fence(&fence, None).map_err(call("vkCreateFence"))?;
        }
        Ok(made)
    }

    pub(crate) fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// Records commands, submits them and waits until the device has done them.
    pub(crate) fn submit(
        &self,
        record: impl FnOnce(&Commands<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        // every submission is waited for, so the command buffer is not in use
        let commands = Commands::begin(&self.device, self.commands, 0)?;
        record(&commands).inspect_err(|_| commands.discard())?;
        commands.end()?;
        Ok(self.device.submit_and_wait(self.commands, self.fence)?)
    }

    /// Makes a device buffer with these contents.
    pub(super) fn upload(&self, name: &'static str, bytes: &[u8]) -> Result<Buffer, Error> {
        let limit = u64::from(self.device.limits.max_storage_buffer_range);
        if bytes.len() as u64 > limit {
            return Err(gpu::Error::TooLarge { name, bytes: bytes.len() as u64, limit }.into());
        }
        let mut staging = Buffer::new(&self.device, "staging", bytes.len() as u64, Memory::Upload)?;
        if let Some(to) = staging.bytes_mut().get_mut(..bytes.len()) {
            to.copy_from_slice(bytes);
        }
        let buffer = Buffer::new(&self.device, name, bytes.len() as u64, Memory::Device)?;
        self.submit(|commands| {
            if !bytes.is_empty() {
                let region = [vk::BufferCopy::default().size(bytes.len() as u64)];
                // SAFETY: both buffers are at least that long and live until the submission is done.
                unsafe {
                    commands.raw().cmd_copy_buffer(commands.buffer, staging.raw, buffer.raw, &region);
                }
            }
            Ok(())
        })?;
        Ok(buffer)
    }
}

impl Drop for Submitter {
    fn drop(&mut self) {
        let raw = &self.device.raw;
        // SAFETY: every submission was waited for; null handles are ignored.
        unsafe {
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}
