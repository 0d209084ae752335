//! Engines on one device whose steps are submitted together: one barrier serves all of them, so that many small crowds fill a
//! device that one of them would leave idle.

use super::super::plan::{Command, Op, plan};
use super::super::{Device, Error, call};
use super::Engine;
use crate::kernels::BufferId;
use ash::vk;
use std::sync::Arc;

/// Submissions that may be under way at a time.
const SUBMISSIONS: usize = 3;

/// What one engine takes part with: what is set before the steps, and the operations of a step.
pub(crate) struct Part<'a> {
    pub(crate) engine: &'a Engine,
    pub(crate) sets: Vec<(BufferId, Vec<u8>)>,
    pub(crate) ops: Vec<Op>,
}

/// The commands of one step of several engines, recorded once.
pub(crate) struct Together {
    device: Arc<Device>,
    pool: vk::CommandPool,
    step: vk::CommandBuffer,
    first: [vk::CommandBuffer; SUBMISSIONS],
    fences: [vk::Fence; SUBMISSIONS],
    is_under_way: [bool; SUBMISSIONS],
    next: usize,
    /// What `step` is recorded of: versions and operations of the engines.
    recorded: Vec<(u64, Vec<Op>)>,
}

impl std::fmt::Debug for Together {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Together").field("engines", &self.recorded.len()).finish_non_exhaustive()
    }
}

impl Together {
    /// Makes command buffers on a device.
    pub(crate) fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let mut new = Self {
            device: device.clone(),
            pool: vk::CommandPool::null(),
            step: vk::CommandBuffer::null(),
            first: [vk::CommandBuffer::null(); SUBMISSIONS],
            fences: [vk::Fence::null(); SUBMISSIONS],
            is_under_way: [false; SUBMISSIONS],
            next: 0,
            recorded: Vec::new(),
        };
        let raw = &device.raw;
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        // SAFETY: the create-infos are complete and the device is alive; `Drop` destroys what was made.
        unsafe {
            new.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate = vk::CommandBufferAllocateInfo::default()
                .command_pool(new.pool)
                .command_buffer_count(u32::try_from(1 + SUBMISSIONS).unwrap_or(1));
            let made = raw.allocate_command_buffers(&allocate).map_err(call("vkAllocateCommandBuffers"))?;
            if let [step, first @ ..] = made.as_slice() {
                new.step = *step;
                new.first.copy_from_slice(first);
            }
            for fence in &mut new.fences {
                *fence =
                    raw.create_fence(&vk::FenceCreateInfo::default(), None).map_err(call("vkCreateFence"))?;
            }
        }
        Ok(new)
    }

    /// Whether it is of this device.
    pub(crate) fn is_on(&self, device: &Arc<Device>) -> bool {
        Arc::ptr_eq(&self.device, device)
    }

    /// Sets buffers, then runs the operations of a step of all parts so many times. The operations of the parts are of the same
    /// phases; how many invocations they have may differ. Returns once they are submitted; [`Self::finish`] waits for them, and
    /// no engine may go before.
    ///
    /// # Errors
    /// As of [`Engine::run`].
    pub(crate) fn repeat(&mut self, parts: &[Part<'_>], times: u32) -> Result<(), Error> {
        let Some(leader) = parts.first() else { return Ok(()) };
        let is_recorded = self.recorded.len() == parts.len()
            && parts
                .iter()
                .zip(&self.recorded)
                .all(|(part, (version, ops))| part.engine.version == *version && part.ops == *ops);
        if !is_recorded {
            self.record(parts)?;
        }
        let slot = self.next;
        self.finish_one(slot)?;
        let (first, fence) = (self.first[slot], self.fences[slot]);
        leader.engine.record_to(first, vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT, |_| {
            leader.engine.barrier_to_all(first);
            for part in parts {
                for (id, contents) in &part.sets {
                    part.engine.set(first, *id, contents)?;
                }
            }
            leader.engine.barrier(first);
            Ok(())
        })?;
        let all: Vec<_> = std::iter::once(first).chain((0..times).map(|_| self.step)).collect();
        self.device.submit(&all, fence).map_err(|error| Engine::named(error, &leader.ops))?;
        self.is_under_way[slot] = true;
        self.next = (slot + 1) % SUBMISSIONS;
        Ok(())
    }

    fn record(&mut self, parts: &[Part<'_>]) -> Result<(), Error> {
        self.finish()?;
        self.recorded.clear();
        let Some(leader) = parts.first() else { return Ok(()) };
        let commands = self.step;
        leader.engine.record_to(commands, vk::CommandBufferUsageFlags::SIMULTANEOUS_USE, |_| {
            for command in plan(&leader.ops) {
                match command {
                    Command::Barrier => leader.engine.barrier(commands),
                    Command::Op(index, _) => {
                        for part in parts {
                            part.engine.encode_op(commands, part.ops[index])?;
                        }
                    }
                }
            }
            leader.engine.barrier(commands);
            Ok(())
        })?;
        self.recorded = parts.iter().map(|part| (part.engine.version, part.ops.clone())).collect();
        Ok(())
    }

    /// Waits until everything is done that was submitted.
    pub(crate) fn finish(&mut self) -> Result<(), Error> {
        (0..SUBMISSIONS).try_for_each(|slot| self.finish_one(slot))
    }

    fn finish_one(&mut self, slot: usize) -> Result<(), Error> {
        if !std::mem::take(&mut self.is_under_way[slot]) {
            return Ok(());
        }
        let ops = self.recorded.first().map_or(&[][..], |(_, ops)| ops);
        self.device.finish(self.fences[slot]).map_err(|error| Engine::named(error, ops))
    }
}

impl Drop for Together {
    fn drop(&mut self) {
        for slot in 0..SUBMISSIONS {
            let _ = self.finish_one(slot);
        }
        // SAFETY: every submission was waited for; null handles are ignored by Vulkan.
        unsafe {
            self.fences.iter().for_each(|fence| self.device.raw.destroy_fence(*fence, None));
            self.device.raw.destroy_command_pool(self.pool, None);
        }
    }
}
