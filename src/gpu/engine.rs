//! One Vulkan buffer per [`BufferId`], one pipeline per phase of a kernel, and lists of dispatches run in one submission.

mod embed;
mod encode;
mod repeat;
mod staging;
mod together;

use self::embed::Embedded;
use self::repeat::Repeated;
use self::staging::{Copy, fill, read, stage};
pub(crate) use self::together::{Part, Together};
use super::pipeline::{self, Pipeline, Program};
use super::plan::Op;
use super::{Buffer, Device, Error, FRAMES_IN_FLIGHT, Memory, call};
use crate::kernels::{BufferId, Dispatch, Kernel, KernelId, NEEDS, Phase, Store};
use ash::vk;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// Most dispatches that one submission can time.
const TIMED_DISPATCHES: u32 = 2048;

/// How long a dispatch ran on the device.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DispatchTime {
    /// The dispatch.
    pub dispatch: Dispatch,
    /// Milliseconds between the device's timestamps; by the clock, submission and wait included, where it has none.
    pub milliseconds: f64,
}

/// Buffers, pipelines and a command buffer on one device.
pub struct Engine {
    device: Arc<Device>,
    buffers: Vec<Option<Buffer>>,
    pipelines: Vec<Option<Pipeline>>,
    descriptors: vk::DescriptorPool,
    pool: vk::CommandPool,
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    queries: vk::QueryPool,
    /// Staging memory: to the device, and from it. The two want different kinds.
    staging: [Option<Buffer>; 2],
    /// What the submissions of the caller bring and report: [`Engine::encode`].
    embedded: [Embedded; FRAMES_IN_FLIGHT],
    /// What is submitted again and again: [`Engine::repeat`].
    repeated: Repeated,
    /// A number that no other engine has, and that is new whenever buffers are: what was recorded with it can be used again.
    version: u64,
}

fn next_version() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(1);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

impl std::fmt::Debug for Engine {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Engine").field("device", &self.device).finish_non_exhaustive()
    }
}

impl Engine {
    /// Makes pipelines for `kernels`, a buffer for everything they bind, as long as in `store`, and uploads all.
    ///
    /// # Errors
    /// When a buffer is larger than the device can bind, memory is short, or a call fails.
    pub fn new(device: &Arc<Device>, store: &Store, kernels: &[KernelId]) -> Result<Self, Error> {
        let arithmetic = device.arithmetic()?;
        let applied = |code: pipeline::Code| arithmetic.applied(&code).map(pipeline::Code::from);
        let code = |kernel| pipeline::code(kernel)?.into_iter().map(applied).collect();
        Self::of_code(device, store, kernels, code)
    }

    /// The same with the code that `code` gives for the phases of a kernel.
    pub(super) fn of_code(
        device: &Arc<Device>,
        store: &Store,
        kernels: &[KernelId],
        code: impl Fn(&'static Kernel) -> Result<Vec<pipeline::Code>, Error>,
    ) -> Result<Self, Error> {
        Self::of_programs(device, store, kernels, |kernel| {
            let code = code(kernel)?.into_iter().zip(kernel.phases);
            let contents = store.step.contents();
            let program = |code: pipeline::Code, phase: &Phase| {
                Program::new(device, phase.entry(), code.into_owned(), contents).map(Arc::new)
            };
            code.map(|(code, phase)| program(code, phase)).collect()
        })
    }

    /// An engine on the same device, with the programs of this one and buffers of its own.
    ///
    /// # Errors
    /// As of [`Engine::new`], and when this engine lacks a kernel.
    pub fn beside(&self, store: &Store, kernels: &[KernelId]) -> Result<Self, Error> {
        Self::of_programs(&self.device, store, kernels, |kernel| {
            let program = |phase: &Phase| match &self.pipelines[*phase as usize] {
                Some(pipeline) => Ok(pipeline.program.clone()),
                None => Err(Error::NoKernel(phase.entry().label)),
            };
            kernel.phases.iter().map(program).collect()
        })
    }

    /// An engine of programs, which `programs` gives for the phases of a kernel.
    fn of_programs(
        device: &Arc<Device>,
        store: &Store,
        kernels: &[KernelId],
        programs: impl Fn(&'static Kernel) -> Result<Vec<Arc<Program>>, Error>,
    ) -> Result<Self, Error> {
        let mut engine = Self {
            device: device.clone(),
            buffers: BufferId::ALL.iter().map(|_| None).collect(),
            pipelines: Phase::ALL.iter().map(|_| None).collect(),
            descriptors: vk::DescriptorPool::null(),
            pool: vk::CommandPool::null(),
            commands: vk::CommandBuffer::null(),
            fence: vk::Fence::null(),
            queries: vk::QueryPool::null(),
            staging: [None, None],
            embedded: Default::default(),
            repeated: Repeated::default(),
            version: next_version(),
        };
        engine.make_commands(kernels.iter().map(|kernel| kernel.kernel().phases.len()).sum())?;
        for kernel in kernels.iter().map(|kernel| kernel.kernel()) {
            for binding in kernel.bindings {
                engine.make_buffer(binding.buffer, store.bytes(binding.buffer).len() as u64)?;
            }
            for (&phase, program) in kernel.phases.iter().zip(programs(kernel)?) {
                let entry = phase.entry();
                let made = Pipeline::new(device, entry, program, engine.descriptors, &engine.buffers)?;
                engine.pipelines[phase as usize] = Some(made);
            }
        }
        let made: Vec<_> =
            BufferId::ALL.into_iter().filter(|id| engine.buffers[*id as usize].is_some()).collect();
        engine.upload(store, &made)?;
        Ok(engine)
    }

    /// The device.
    pub fn device(&self) -> &Arc<Device> {
        &self.device
    }

    /// The Vulkan buffer of a name, if a kernel of this engine binds it.
    pub fn buffer(&self, id: BufferId) -> Option<&Buffer> {
        self.buffers[id.home() as usize].as_ref()
    }

    /// Bytes of all buffers on the device.
    pub fn bytes(&self) -> u64 {
        self.buffers.iter().flatten().map(Buffer::size).sum()
    }

    fn make_commands(&mut self, phases: usize) -> Result<(), Error> {
        let count = u32::try_from(phases.max(1)).unwrap_or(u32::MAX);
        let sizes = [
            vk::DescriptorPoolSize::default()
                .ty(vk::DescriptorType::STORAGE_BUFFER)
                .descriptor_count(NEEDS.storage_buffers * count),
            vk::DescriptorPoolSize::default()
                .ty(vk::DescriptorType::UNIFORM_BUFFER)
                .descriptor_count(NEEDS.uniform_buffers * count),
        ];
        let descriptors = vk::DescriptorPoolCreateInfo::default().max_sets(count).pool_sizes(&sizes);
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(self.device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let queries = vk::QueryPoolCreateInfo::default()
            .query_type(vk::QueryType::TIMESTAMP)
            .query_count(2 * TIMED_DISPATCHES);
        let raw = &self.device.raw;
        // SAFETY: the create-infos are complete and the device is alive; `Drop` destroys what was made.
        unsafe {
            self.descriptors =
                raw.create_descriptor_pool(&descriptors, None).map_err(call("vkCreateDescriptorPool"))?;
            self.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(self.pool).command_buffer_count(1);
            self.commands = raw
                .allocate_command_buffers(&allocate)
                .map_err(call("vkAllocateCommandBuffers"))?
                .first()
                .copied()
                .unwrap_or_default();
            self.fence =
                raw.create_fence(&vk::FenceCreateInfo::default(), None).map_err(call("vkCreateFence"))?;
            self.queries = raw.create_query_pool(&queries, None).map_err(call("vkCreateQueryPool"))?;
        }
        self.make_repeated()
    }

    /// Makes buffers that no kernel of this engine binds, for group counts of its dispatches, as long as in `store`.
    ///
    /// # Errors
    /// As of [`Engine::new`].
    pub fn add_buffers(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        for &id in ids {
            self.make_buffer(id, store.bytes(id).len() as u64)?;
        }
        self.upload(store, ids)
    }

    fn make_buffer(&mut self, id: BufferId, bytes: u64) -> Result<(), Error> {
        if self.buffers[id as usize].is_some() || id.home() != id {
            return Ok(());
        }
        let limits = &self.device.limits;
        let limit =
            if id.is_uniform() { limits.max_uniform_buffer_range } else { limits.max_storage_buffer_range };
        if bytes > u64::from(limit) {
            return Err(Error::TooLarge { name: id.name(), bytes, limit: u64::from(limit) });
        }
        self.buffers[id as usize] = Some(Buffer::new(&self.device, id.name(), bytes, Memory::Device)?);
        Ok(())
    }

    /// Copies buffers from the host to the device; a buffer whose length has changed is replaced.
    ///
    /// # Errors
    /// When a buffer is larger than the device can bind, memory is short, or a call fails.
    pub fn replace(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        let ids = self.at_home(ids);
        let mut made = Vec::new();
        for &id in &ids {
            let bytes = store.bytes(id).len() as u64;
            let fits = self.buffer(id).is_some_and(|buffer| buffer.size() == Buffer::rounded(bytes));
            if !fits {
                self.forget_repeated()?;
                self.buffers[id as usize] = None;
                self.make_buffer(id, bytes)?;
                made.push(id);
            }
        }
        if !made.is_empty() {
            self.version = next_version();
            for entry in Phase::ALL.map(Phase::entry) {
                let binds = entry.bindings.iter().any(|b| made.contains(&b.buffer));
                if let Some(pipeline) = self.pipelines[entry.phase as usize].as_ref().filter(|_| binds) {
                    pipeline.bind(&self.device, entry, &self.buffers);
                }
            }
        }
        self.upload(store, &ids)
    }

    /// Copies buffers from the host to the device.
    ///
    /// # Errors
    /// When a buffer of the store is longer than it was when it was made, a call fails or memory for staging is short.
    pub fn upload(&mut self, store: &Store, ids: &[BufferId]) -> Result<(), Error> {
        self.bring_to_device()?; // what was brought before is older
        let copies = self.layout(&self.at_home(ids), store)?;
        fill(&self.device, &mut self.staging[0], &copies, store)?;
        self.copy(self.staging[0].as_ref(), &copies, true)
    }

    /// Copies buffers from the device to the host; the store's buffers keep their lengths.
    ///
    /// # Errors
    /// When a buffer of the store is longer than the device's, a call fails or memory for staging is short.
    pub fn download(&mut self, store: &mut Store, ids: &[BufferId]) -> Result<(), Error> {
        let copies = self.layout(ids, store)?;
        stage(&self.device, &mut self.staging[1], &copies, Memory::Readback)?;
        self.copy(self.staging[1].as_ref(), &copies, false)?;
        if let Some(staging) = &self.staging[1] {
            read(staging, &copies, store);
        }
        Ok(())
    }

    /// Refuses more bytes than a buffer of this engine has.
    fn fits(&self, id: BufferId, bytes: usize) -> Result<(), Error> {
        match self.buffer(id).map(Buffer::size) {
            Some(size) if bytes as u64 > size => {
                Err(Error::Contents { name: id.name(), bytes: bytes as u64, size })
            }
            _ => Ok(()),
        }
    }

    fn present(&self, ids: &[BufferId]) -> Vec<BufferId> {
        ids.iter().copied().filter(|id| self.buffer(*id).is_some()).collect()
    }

    /// Those that are there and are no part of another.
    fn at_home(&self, ids: &[BufferId]) -> Vec<BufferId> {
        ids.iter().copied().filter(|id| self.buffers[*id as usize].is_some()).collect()
    }

    /// Places of buffers' contents, as long as in `store`, one after another in staging memory.
    fn layout(&self, ids: &[BufferId], store: &Store) -> Result<Vec<Copy>, Error> {
        let ids = self.present(ids);
        let mut end = 0;
        let mut copies = Vec::with_capacity(ids.len());
        for id in ids {
            let length = store.bytes(id).len();
            self.fits(id, length)?;
            if length > 0 {
                copies.push((id, end, length));
                end += length.next_multiple_of(16);
            }
        }
        Ok(copies)
    }

    fn copy(&self, staging: Option<&Buffer>, copies: &[Copy], to_device: bool) -> Result<(), Error> {
        let Some(staging) = staging.filter(|_| !copies.is_empty()) else { return Ok(()) };
        self.record(|engine, commands| {
            engine.encode_copies(commands, staging, copies, to_device);
            Ok(())
        })
    }

    /// Records, submits and waits.
    fn record(&self, body: impl FnOnce(&Self, vk::CommandBuffer) -> Result<(), Error>) -> Result<(), Error> {
        let flags = vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT;
        self.record_to(self.commands, flags, |engine| body(engine, self.commands))?;
        let outcome = self.device.submit_and_wait(self.commands, self.fence);
        outcome.map_err(|error| match self.under_way() {
            [] => error,
            ops => Self::named(error, ops),
        })
    }

    /// Records into a command buffer that is not in use.
    fn record_to(
        &self,
        commands: vk::CommandBuffer,
        flags: vk::CommandBufferUsageFlags,
        body: impl FnOnce(&Self) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let raw = &self.device.raw;
        let begin = vk::CommandBufferBeginInfo::default().flags(flags);
        // SAFETY: every submission of the command buffer was waited for.
        unsafe { raw.begin_command_buffer(commands, &begin) }.map_err(call("vkBeginCommandBuffer"))?;
        if let Err(error) = body(self) {
            let none = vk::CommandBufferResetFlags::empty();
            // SAFETY: what was recorded was not submitted; what cannot be reset cannot be begun again, and that is an error.
            let _ = unsafe { raw.reset_command_buffer(commands, none) };
            return Err(error);
        }
        // SAFETY: recording has begun.
        unsafe { raw.end_command_buffer(commands) }.map_err(call("vkEndCommandBuffer"))
    }

    /// Runs the operations in order, barriers between them where their buffers demand it.
    ///
    /// `contents(index, buffer)` gives what the operation [`Op::Set`] number `index` writes.
    ///
    /// # Errors
    /// When a dispatch needs a kernel that this engine lacks, contents do not fit their buffer, or group counts lie beyond
    /// theirs. When a call fails or the device is lost.
    pub fn run(
        &mut self,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8>,
        timed: bool,
    ) -> Result<Vec<DispatchTime>, Error> {
        let dispatches = ops.iter().filter(|op| matches!(op, Op::Dispatch(_))).count();
        let timed = timed && dispatches <= TIMED_DISPATCHES as usize;
        if timed && self.device.timestamp_bits == 0 {
            return self.run_by_the_clock(ops, contents);
        }
        let outcome = self.record(|engine, commands| engine.encode_ops(commands, ops, &contents, timed));
        outcome.map_err(|error| Self::named(error, ops))?;
        if timed { self.times(ops) } else { Ok(Vec::new()) }
    }

    /// Runs every operation in a submission of its own, timed by the clock, on a device without timestamps.
    fn run_by_the_clock(
        &self,
        ops: &[Op],
        contents: impl Fn(usize, BufferId) -> Vec<u8>,
    ) -> Result<Vec<DispatchTime>, Error> {
        let mut times = Vec::new();
        for (index, op) in ops.iter().enumerate() {
            let begin = Instant::now();
            let (one, its_contents) = (std::slice::from_ref(op), |_, id| contents(index, id));
            let outcome =
                self.record(|engine, commands| engine.encode_ops(commands, one, &its_contents, false));
            outcome.map_err(|error| Self::named(error, one))?;
            if let Op::Dispatch(dispatch) = op {
                let milliseconds = begin.elapsed().as_secs_f64() * 1e3;
                times.push(DispatchTime { dispatch: *dispatch, milliseconds });
            }
        }
        Ok(times)
    }

    fn times(&self, ops: &[Op]) -> Result<Vec<DispatchTime>, Error> {
        let dispatches = ops.iter().filter_map(|op| match op {
            Op::Dispatch(dispatch) => Some(*dispatch),
            Op::Set(_) | Op::CountStep => None,
        });
        let dispatches: Vec<_> = dispatches.collect();
        let mut stamps = vec![0_u64; dispatches.len() * 2];
        if stamps.is_empty() {
            return Ok(Vec::new());
        }
        let flags = vk::QueryResultFlags::TYPE_64 | vk::QueryResultFlags::WAIT;
        // SAFETY: the queries were written by the submission that has been waited for.
        unsafe { self.device.raw.get_query_pool_results(self.queries, 0, &mut stamps, flags) }
            .map_err(call("vkGetQueryPoolResults"))?;
        let period = f64::from(self.device.limits.timestamp_period) * 1e-6;
        let bits = self.device.timestamp_bits;
        let time = |(dispatch, stamps): (Dispatch, &[u64])| DispatchTime {
            dispatch,
            milliseconds: ticks([stamps[0], stamps[1]], bits) as f64 * period,
        };
        Ok(dispatches.into_iter().zip(stamps.chunks_exact(2)).map(time).collect())
    }
}

/// Ticks between two timestamps of so many bits, which begin again at 0 behind their end.
pub(crate) fn ticks([begin, end]: [u64; 2], bits: u32) -> u64 {
    let most = u64::MAX >> 64_u32.saturating_sub(bits).min(63);
    let ticks = end.wrapping_sub(begin) & most;
    if ticks > most / 2 { 0 } else { ticks } // a clock that went back
}

impl Drop for Engine {
    fn drop(&mut self) {
        self.drop_repeated();
        let raw = &self.device.raw;
        // SAFETY: every submission was waited for; null handles are ignored by Vulkan.
        unsafe {
            raw.destroy_query_pool(self.queries, None);
            raw.destroy_fence(self.fence, None);
            raw.destroy_command_pool(self.pool, None);
            raw.destroy_descriptor_pool(self.descriptors, None);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::ticks;

    #[test]
    fn a_timestamp_that_begins_again_gives_the_time_all_the_same() {
        assert_eq!(ticks([100, 130], 64), 30);
        assert_eq!(ticks([(1 << 36) - 10, 20], 36), 30);
        assert_eq!(ticks([u64::MAX - 9, 20], 64), 30);
        assert_eq!(ticks([130, 100], 64), 0);
        assert_eq!(ticks([130, 100], 36), 0);
    }
}
