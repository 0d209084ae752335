//! What an engine records: copies, uniforms, dispatches and the barriers between them.

use super::super::plan::{Command, Op, plan};
use super::super::{Buffer, Error};
use super::{Copy, Engine, TIMED_DISPATCHES};
use crate::kernels::shared::dispatch::MOST_GROUPS;
use crate::kernels::{BufferId, Dispatch, Extent, KernelId};
use ash::{ext, vk};
use std::ffi::CString;

/// Most bytes of one `vkCmdUpdateBuffer`.
const MOST_UPDATED: usize = 65_536;
/// Bytes of the three group counts of an indirect dispatch.
const ARGUMENTS: u64 = 12;

impl Engine {
    /// The error of a submission with these operations: a lost device says what it was doing.
    pub(crate) fn named(error: Error, ops: &[Op]) -> Error {
        match error {
            Error::Call { result: vk::Result::ERROR_DEVICE_LOST, .. } => {
                let names = ops.iter().filter_map(|op| match op {
                    Op::Dispatch(dispatch) => Some(dispatch.phase.entry().label),
                    Op::Set(_) | Op::CountStep => None,
                });
                let mut names: Vec<_> = names.collect();
                names.dedup();
                names.truncate(16);
                Error::DeviceLost { dispatches: names.join(", ") }
            }
            other => other,
        }
    }

    /// Records copies between staging memory and buffers.
    pub(super) fn encode_copies(
        &self,
        commands: vk::CommandBuffer,
        staging: &Buffer,
        copies: &[Copy],
        to_device: bool,
    ) {
        let raw = &self.device.raw;
        for (id, offset, length) in copies {
            let Some(buffer) = self.buffer(*id) else { continue };
            let (offset, size) = (*offset as u64, *length as u64);
            let region = vk::BufferCopy::default().size(size);
            // SAFETY: both buffers are at least that large; recording has begun.
            unsafe {
                if to_device {
                    raw.cmd_copy_buffer(commands, staging.raw, buffer.raw, &[region.src_offset(offset)]);
                } else {
                    raw.cmd_copy_buffer(commands, buffer.raw, staging.raw, &[region.dst_offset(offset)]);
                }
            }
        }
        // the host reads what was copied only after the fence, and through this dependency
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::COPY)
            .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::HOST)
            .dst_access_mask(vk::AccessFlags2::HOST_READ)];
        // SAFETY: recording has begun.
        unsafe {
            raw.cmd_pipeline_barrier2(commands, &vk::DependencyInfo::default().memory_barriers(&barrier));
        }
    }

    /// Records operations into the caller's command buffer, outside of rendering. They see all earlier writes, and their
    /// writes are visible to later dispatches, draws and their arguments.
    ///
    /// # Errors
    /// As of [`Engine::run`], without what only a submission meets.
    pub(crate) fn record_into(
        &self,
        commands: vk::CommandBuffer,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8>,
    ) -> Result<(), Error> {
        self.barrier(commands);
        self.encode_ops(commands, ops, &contents, false)
    }

    /// Whether this engine has these kernels.
    pub(crate) fn has(&self, kernels: &[KernelId]) -> bool {
        let mut phases = kernels.iter().flat_map(|kernel| kernel.kernel().phases);
        phases.all(|phase| self.pipelines[*phase as usize].is_some())
    }

    /// Records operations, barriers between them and after the last.
    pub(super) fn encode_ops(
        &self,
        commands: vk::CommandBuffer,
        ops: &[Op],
        contents: &impl Fn(usize, BufferId) -> Vec<u8>,
        timed: bool,
    ) -> Result<(), Error> {
        let raw = &self.device.raw;
        if timed {
            // SAFETY: recording has begun and the queries are not in use.
            unsafe { raw.cmd_reset_query_pool(commands, self.queries, 0, 2 * TIMED_DISPATCHES) };
        }
        let mut query = 0;
        let plan = plan(ops);
        let mut copied = None; // whether what was recorded since the last barrier copies
        for group in plan.split(|command| *command == Command::Barrier) {
            let copies = group.iter().any(|command| matches!(command, Command::Op(_, Op::Set(_))));
            match copied {
                None => {}
                Some(false) if !copies => self.barrier_between_dispatches(commands),
                Some(_) => self.barrier(commands),
            }
            copied = Some(copies);
            for command in group {
                match *command {
                    Command::Op(index, Op::Set(id)) => self.set(commands, id, &contents(index, id))?,
                    Command::Op(_, Op::CountStep) | Command::Barrier => {}
                    Command::Op(_, Op::Dispatch(dispatch)) => {
                        self.dispatch(commands, dispatch, timed.then_some(query))?;
                        query += 2;
                    }
                }
            }
        }
        self.barrier(commands);
        Ok(())
    }

    /// Records an operation that is no [`Op::Set`].
    pub(super) fn encode_op(&self, commands: vk::CommandBuffer, op: Op) -> Result<(), Error> {
        match op {
            Op::Set(_) | Op::CountStep => {}
            Op::Dispatch(dispatch) => self.dispatch(commands, dispatch, None)?,
        }
        Ok(())
    }

    /// Records that a buffer, if the engine has it, holds these contents.
    pub(super) fn set(
        &self,
        commands: vk::CommandBuffer,
        id: BufferId,
        contents: &[u8],
    ) -> Result<(), Error> {
        let Some(buffer) = self.buffer(id) else { return Ok(()) };
        let bytes = contents.len();
        self.fits(id, bytes)?;
        if bytes == 0 || bytes > MOST_UPDATED || !bytes.is_multiple_of(4) {
            return Err(Error::Contents { name: id.name(), bytes: bytes as u64, size: buffer.size() });
        }
        // SAFETY: the contents lie within the buffer and are as long as an update may be; recording has begun.
        unsafe { self.device.raw.cmd_update_buffer(commands, buffer.raw, 0, contents) };
        Ok(())
    }

    fn dispatch(
        &self,
        commands: vk::CommandBuffer,
        dispatch: Dispatch,
        query: Option<u32>,
    ) -> Result<(), Error> {
        let entry = dispatch.phase.entry();
        let Some(pipeline) = &self.pipelines[dispatch.phase as usize] else {
            return Err(Error::NoKernel(entry.label));
        };
        let program = &pipeline.program;
        if let Extent::Indirect(buffer, element) = dispatch.extent {
            let size = self.buffer(buffer).map_or(0, Buffer::size);
            if u64::from(element) * 4 + ARGUMENTS > size {
                return Err(Error::Arguments { kernel: entry.label, buffer: buffer.name(), element });
            }
        }
        let compiled = program.raw(dispatch.immediate)?;
        let raw = &self.device.raw;
        // SAFETY: recording has begun; pipeline, layout and set were made for each other; the group counts are
        // within what every Vulkan device takes; indirect arguments lie within their buffer, as was just seen.
        unsafe {
            self.label(commands, Some(&program.label));
            if let Some(query) = query {
                let stage = vk::PipelineStageFlags2::TOP_OF_PIPE;
                raw.cmd_write_timestamp2(commands, stage, self.queries, query);
            }
            raw.cmd_bind_pipeline(commands, vk::PipelineBindPoint::COMPUTE, compiled);
            raw.cmd_bind_descriptor_sets(
                commands,
                vk::PipelineBindPoint::COMPUTE,
                program.layout,
                0,
                &[pipeline.set],
                &[],
            );
            if entry.immediate.is_some() {
                let word = dispatch.immediate.to_ne_bytes();
                raw.cmd_push_constants(commands, program.layout, vk::ShaderStageFlags::COMPUTE, 0, &word);
            }
            match dispatch.extent {
                Extent::Invocations(count) => {
                    let groups = count.div_ceil(entry.workgroup_size[0]);
                    if groups > 0 {
                        raw.cmd_dispatch(commands, groups.min(MOST_GROUPS), groups.div_ceil(MOST_GROUPS), 1);
                    }
                }
                Extent::Indirect(buffer, element) => {
                    if let Some(buffer) = self.buffer(buffer) {
                        raw.cmd_dispatch_indirect(commands, buffer.raw, u64::from(element) * 4);
                    }
                }
            }
            if let Some(query) = query {
                let stage = vk::PipelineStageFlags2::COMPUTE_SHADER;
                raw.cmd_write_timestamp2(commands, stage, self.queries, query + 1);
            }
            self.label(commands, None);
        }
        Ok(())
    }

    /// Opens (with a name) or closes a debug label.
    fn label(&self, commands: vk::CommandBuffer, name: Option<&CString>) {
        let Some(loader): Option<&ext::debug_utils::Device> = self.device.names.as_ref() else { return };
        // SAFETY: recording has begun; labels are closed in the order they were opened.
        unsafe {
            match name {
                Some(name) => {
                    let label = vk::DebugUtilsLabelEXT::default().label_name(name);
                    loader.cmd_begin_debug_utils_label(commands, &label);
                }
                None => loader.cmd_end_debug_utils_label(commands),
            }
        }
    }

    /// Between dispatches and nothing else: a GPU waits less long than at [`Self::barrier`].
    fn barrier_between_dispatches(&self, commands: vk::CommandBuffer) {
        let (shader, written) =
            (vk::PipelineStageFlags2::COMPUTE_SHADER, vk::AccessFlags2::SHADER_STORAGE_WRITE);
        let read = vk::AccessFlags2::SHADER_STORAGE_READ | vk::AccessFlags2::UNIFORM_READ;
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(shader)
            .src_access_mask(written)
            .dst_stage_mask(shader | vk::PipelineStageFlags2::DRAW_INDIRECT)
            .dst_access_mask(written | read | vk::AccessFlags2::INDIRECT_COMMAND_READ)];
        // SAFETY: recording has begun.
        unsafe {
            let dependency = vk::DependencyInfo::default().memory_barriers(&barrier);
            self.device.raw.cmd_pipeline_barrier2(commands, &dependency);
        }
    }

    /// Between whatever is recorded: copies, dispatches, and draws that come after.
    pub(super) fn barrier(&self, commands: vk::CommandBuffer) {
        let before = vk::PipelineStageFlags2::COMPUTE_SHADER | vk::PipelineStageFlags2::ALL_TRANSFER;
        let after = before | vk::PipelineStageFlags2::DRAW_INDIRECT | vk::PipelineStageFlags2::VERTEX_SHADER;
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(before)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(after)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        // SAFETY: recording has begun.
        unsafe {
            let dependency = vk::DependencyInfo::default().memory_barriers(&barrier);
            self.device.raw.cmd_pipeline_barrier2(commands, &dependency);
        }
    }
}
