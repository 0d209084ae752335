//! Operations that are recorded once and submitted as often as they are wanted. The host does not wait for them.

use super::super::plan::Op;
use super::super::{Error, call};
use super::Engine;
use crate::kernels::BufferId;
use ash::vk;

/// Submissions that may be under way at a time: the device has work while the host prepares more.
const SUBMISSIONS: usize = 3;

/// What is recorded, and the submissions of it.
#[derive(Default)]
pub(super) struct Repeated {
    /// What `commands` does; none if nothing is recorded.
    ops: Vec<Op>,
    commands: vk::CommandBuffer,
    submissions: [Submission; SUBMISSIONS],
    next: usize,
}

#[derive(Default)]
struct Submission {
    /// What runs once before the repeated operations.
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    /// Whether it was not waited for yet.
    is_under_way: bool,
}

impl Engine {
    pub(super) fn make_repeated(&mut self) -> Result<(), Error> {
        let raw = &self.device.raw;
        let count = u32::try_from(SUBMISSIONS + 1).unwrap_or(1);
        let allocate =
            vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(count);
        // SAFETY: the pool was made; `Drop` destroys it and the fences.
        unsafe {
            let mut made = raw
                .allocate_command_buffers(&allocate)
                .map_err(call("vkAllocateCommandBuffers"))?
                .into_iter();
            self.repeated.commands = made.next().unwrap_or_default();
            for (submission, commands) in self.repeated.submissions.iter_mut().zip(made) {
                submission.commands = commands;
                let fence = vk::FenceCreateInfo::default();
                submission.fence = raw.create_fence(&fence, None).map_err(call("vkCreateFence"))?;
            }
        }
        Ok(())
    }

    /// Sets buffers, then runs the operations, in order, so many times. None of them is an [`Op::Set`]. Returns once they are
    /// submitted; what is submitted later, by any call, comes after them. [`Self::finish`] waits for them.
    ///
    /// # Errors
    /// As of [`Engine::run`].
    pub fn repeat(&mut self, sets: &[(BufferId, Vec<u8>)], ops: &[Op], times: u32) -> Result<(), Error> {
        if self.repeated.ops != ops {
            self.record_repeated(ops)?;
        }
        let slot = self.repeated.next;
        self.finish_one(slot)?;
        let Repeated { commands, submissions, .. } = &self.repeated;
        let Submission { commands: first, fence, .. } = submissions[slot];
        self.record_to(first, vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT, |engine| {
            engine.barrier_to_all(first);
            for (id, contents) in sets {
                engine.set(first, *id, contents)?;
            }
            if !sets.is_empty() {
                engine.barrier(first);
            }
            Ok(())
        })?;
        let all: Vec<_> = std::iter::once(first).chain((0..times).map(|_| *commands)).collect();
        self.device.submit(&all, fence).map_err(|error| Self::named(error, ops))?;
        self.repeated.submissions[slot].is_under_way = true;
        self.repeated.next = (slot + 1) % SUBMISSIONS;
        Ok(())
    }

    /// Waits until everything is done that was submitted.
    ///
    /// # Errors
    /// When the device is lost.
    pub fn finish(&mut self) -> Result<(), Error> {
        (0..SUBMISSIONS).try_for_each(|slot| self.finish_one(slot))
    }

    fn finish_one(&mut self, slot: usize) -> Result<(), Error> {
        let submission = &mut self.repeated.submissions[slot];
        if !std::mem::take(&mut submission.is_under_way) {
            return Ok(());
        }
        let outcome = self.device.finish(submission.fence);
        outcome.map_err(|error| Self::named(error, &self.repeated.ops))
    }

    /// The operations that are under way, for the name of an error.
    pub(super) fn under_way(&self) -> &[Op] {
        let is_any = self.repeated.submissions.iter().any(|submission| submission.is_under_way);
        if is_any { &self.repeated.ops } else { &[] }
    }

    /// Forgets what is recorded, since the buffers that it binds change. Nothing is under way then.
    pub(super) fn forget_repeated(&mut self) -> Result<(), Error> {
        self.finish()?;
        self.repeated.ops.clear();
        Ok(())
    }

    fn record_repeated(&mut self, ops: &[Op]) -> Result<(), Error> {
        self.forget_repeated()?;
        let commands = self.repeated.commands;
        let flags = vk::CommandBufferUsageFlags::SIMULTANEOUS_USE;
        self.record_to(commands, flags, |engine| {
            engine.encode_ops(commands, ops, &|_, _| Vec::new(), false)
        })?;
        self.repeated.ops = ops.to_vec();
        Ok(())
    }

    /// Waits for everything, whatever comes of it, and drops what was made here.
    pub(super) fn drop_repeated(&mut self) {
        for slot in 0..SUBMISSIONS {
            let _ = self.finish_one(slot);
        }
        for submission in &self.repeated.submissions {
            // SAFETY: every submission was waited for; null handles are ignored by Vulkan.
            unsafe { self.device.raw.destroy_fence(submission.fence, None) };
        }
    }

    /// Records that whatever comes waits for whatever was.
    pub(super) fn barrier_to_all(&self, commands: vk::CommandBuffer) {
        let barrier = [vk::MemoryBarrier2::default()
            .src_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .src_access_mask(vk::AccessFlags2::MEMORY_WRITE)
            .dst_stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            .dst_access_mask(vk::AccessFlags2::MEMORY_READ | vk::AccessFlags2::MEMORY_WRITE)];
        // SAFETY: recording has begun.
        unsafe {
            let dependency = vk::DependencyInfo::default().memory_barriers(&barrier);
            self.device.raw.cmd_pipeline_barrier2(commands, &dependency);
        }
    }
}
