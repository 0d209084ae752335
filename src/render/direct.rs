//! Draws whose arguments the host knows, for drivers whose indexed indirect draws draw nothing.
//!
//! Kernels choose who is drawn, and write how many bodies of each bucket there are. A bound instead of a count would run the
//! vertex shader for all bodies that there could be, and a count of the frame before would miss who is new. So the host waits for
//! the kernels of each frame, reads the arguments that they wrote, and records draws of exactly these: nobody is missing, and
//! the image is that of indirect draws. The price is one wait in each frame, while which the device draws nothing.

use super::Error;
use super::commands::{Commands, Submitter};
use super::meshes::{DRAW_ARGS_STRIDE, DrawnCrowd};
use crate::gpu::{Buffer, Device, Memory};
use ash::vk;
use std::sync::Arc;
use vk::{AccessFlags2 as Access, PipelineStageFlags2 as Stage};

/// Where the host reads the arguments of draws.
pub(super) struct DirectDraws {
    arguments: Buffer,
}

/// The arguments of a frame's draws, in the order of the buffer `draw_args`.
pub(super) struct KnownDraws(Vec<vk::DrawIndexedIndirectCommand>);

/// What kernels and copies wrote, before it is copied.
const WRITTEN: (Stage, Access) = (
    Stage::from_raw(Stage::COMPUTE_SHADER.as_raw() | Stage::ALL_TRANSFER.as_raw()),
    Access::from_raw(Access::SHADER_STORAGE_WRITE.as_raw() | Access::TRANSFER_WRITE.as_raw()),
);

impl DirectDraws {
    /// For a crowd of so many buckets.
    pub(super) fn new(device: &Arc<Device>, buckets: u32) -> Result<Self, Error> {
        let bytes = 2 * u64::from(buckets) * u64::from(DRAW_ARGS_STRIDE);
        Ok(Self { arguments: Buffer::new(device, "draw arguments", bytes, Memory::Readback)? })
    }

    /// Has the device do what `before` records, waits for it, and reads the arguments that are there afterwards.
    pub(super) fn read(
        &self,
        submitter: &Submitter,
        crowd: &DrawnCrowd<'_>,
        before: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
    ) -> Result<KnownDraws, Error> {
        let arguments = crowd.buffers.draw_args;
        submitter.submit(|commands| {
            before(commands.buffer)?;
            self.copy(commands, arguments);
            Ok(())
        })?;
        Ok(KnownDraws::of(self.arguments.bytes()))
    }

    fn copy(&self, commands: &Commands<'_>, from: &Buffer) {
        commands.barrier(WRITTEN, (Stage::COPY, Access::TRANSFER_READ));
        let region = [vk::BufferCopy::default().size(self.arguments.size().min(from.size()))];
        // SAFETY: recording has begun; both buffers are that long and live until the submission was waited for.
        unsafe {
            commands.raw().cmd_copy_buffer(commands.buffer, from.raw, self.arguments.raw, &region);
        }
        commands.barrier((Stage::COPY, Access::TRANSFER_WRITE), (Stage::HOST, Access::HOST_READ));
    }
}

impl KnownDraws {
    fn of(bytes: &[u8]) -> Self {
        let command = |bytes: &[u8]| {
            let word = |at: usize| std::array::from_fn(|byte| bytes[4 * at + byte]);
            vk::DrawIndexedIndirectCommand {
                index_count: u32::from_ne_bytes(word(0)),
                instance_count: u32::from_ne_bytes(word(1)),
                first_index: u32::from_ne_bytes(word(2)),
                vertex_offset: i32::from_ne_bytes(word(3)),
                first_instance: u32::from_ne_bytes(word(4)),
            }
        };
        Self(bytes.chunks_exact(DRAW_ARGS_STRIDE as usize).map(command).collect())
    }

    /// Records the draw at a place of the buffer, if it draws anything.
    ///
    /// # Safety
    /// Rendering has begun, and pipeline and indices are bound.
    pub(super) unsafe fn draw(&self, commands: &Commands<'_>, place: u32) {
        let Some(draw) = self.0.get(place as usize).filter(|draw| draw.instance_count > 0) else { return };
        // SAFETY: the caller's promise; the kernel copied what is drawn from the table of the meshes.
        unsafe {
            commands.raw().cmd_draw_indexed(
                commands.buffer,
                draw.index_count,
                draw.instance_count,
                draw.first_index,
                draw.vertex_offset,
                draw.first_instance,
            );
        }
    }
}
