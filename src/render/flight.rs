//! Frames in flight: the device draws one while the host records the next.
//!
//! A frame takes the slot of the frame before last: its command buffer, its descriptor sets, its memory for the host to
//! read. So the host waits for that frame first. What only the device uses is one for all frames: barriers order them.

use super::Error;
use super::commands::Commands;
use crate::gpu::{Device, FRAMES_IN_FLIGHT, call, ticks};
use ash::vk;
use std::cell::Cell;
use std::sync::Arc;
use std::time::{Duration, Instant};
use vk::PipelineStageFlags2 as Stage;

/// Timestamps of a frame: before and after it.
const STAMPS: u32 = 2;
/// Queries of a timestamp. lavapipe 25.0 takes as many as a pass before has views, whatever Vulkan says.
const QUERIES: u32 = 2;

/// The slots of frames.
pub(super) struct Flights {
    device: Arc<Device>,
    pool: vk::CommandPool,
    /// None where the device has no timestamps.
    queries: Option<vk::QueryPool>,
    flights: [Flight; FRAMES_IN_FLIGHT],
    next: Cell<usize>,
}

#[derive(Default)]
struct Flight {
    commands: vk::CommandBuffer,
    fence: vk::Fence,
    /// When the frame was submitted that was not waited for yet.
    submitted: Cell<Option<Instant>>,
}

impl Flights {
    pub(super) fn new(device: &Arc<Device>) -> Result<Self, Error> {
        let mut made = Self {
            device: device.clone(),
            pool: vk::CommandPool::null(),
            queries: None,
            flights: Default::default(),
            next: Cell::new(0),
        };
        let pool = vk::CommandPoolCreateInfo::default()
            .queue_family_index(device.family)
            .flags(vk::CommandPoolCreateFlags::RESET_COMMAND_BUFFER);
        let raw = &device.raw;
        let count = u32::try_from(FRAMES_IN_FLIGHT).unwrap_or(1);
        // SAFETY: the create-infos are complete; `Drop` destroys what was made.
        unsafe {
            made.pool = raw.create_command_pool(&pool, None).map_err(call("vkCreateCommandPool"))?;
            let allocate =
                vk::CommandBufferAllocateInfo::default().command_pool(made.pool).command_buffer_count(count);
            let buffers =
                raw.allocate_command_buffers(&allocate).map_err(call("vkAllocateCommandBuffers"))?;
            for (flight, commands) in made.flights.iter_mut().zip(buffers) {
                flight.commands = commands;
                let fence = vk::FenceCreateInfo::default();
                flight.fence = raw.create_fence(&fence, None).map_err(call("vkCreateFence"))?;
            }
            if device.timestamp_bits > 0 {
                let queries = vk::QueryPoolCreateInfo::default()
                    .query_type(vk::QueryType::TIMESTAMP)
                    .query_count(count * STAMPS * QUERIES);
                made.queries =
                    Some(raw.create_query_pool(&queries, None).map_err(call("vkCreateQueryPool"))?);
            }
        }
        Ok(made)
    }

    /// The slot that the next frame takes.
    pub(super) fn next(&self) -> usize {
        self.next.get()
    }

    /// Waits for the frame of a slot. Returns how long the device took for it; none where there was no frame, or it cannot be
    /// known. Afterwards, what the frame uses may be dropped, also after an error.
    pub(super) fn wait(&self, slot: usize) -> Result<Option<Duration>, Error> {
        let Some(flight) = self.flights.get(slot) else { return Ok(None) };
        let Some(submitted) = flight.submitted.take() else { return Ok(None) };
        let begin = Instant::now();
        self.device.finish(flight.fence)?;
        if let Some(queries) = self.queries {
            return Ok(self.measured(queries, slot));
        }
        // a wait that takes its time ends when the device does
        let has_waited = begin.elapsed() > Duration::from_micros(500);
        Ok(has_waited.then(|| submitted.elapsed()))
    }

    /// Frames that were not waited for yet.
    #[cfg(all(test, feature = "xr"))]
    pub(super) fn count(&self) -> usize {
        self.flights.iter().filter(|flight| flight.submitted.get().is_some()).count()
    }

    /// Waits for all frames.
    pub(super) fn wait_all(&self) -> Result<(), Error> {
        (0..FRAMES_IN_FLIGHT).try_for_each(|slot| self.wait(slot).map(drop))
    }

    /// Records a frame and submits it. The frame before last was waited for.
    pub(super) fn submit(
        &self,
        record: impl FnOnce(&Commands<'_>) -> Result<(), Error>,
    ) -> Result<(), Error> {
        let slot = self.next();
        let Some(flight) = self.flights.get(slot) else { return Ok(()) };
        self.wait(slot)?;
        let commands = Commands::begin(&self.device, flight.commands, slot)?;
        self.stamp(&commands, slot, 0);
        record(&commands).inspect_err(|_| commands.discard())?;
        self.stamp(&commands, slot, 1);
        commands.end()?;
        self.device.submit(&[flight.commands], flight.fence)?;
        flight.submitted.set(Some(Instant::now()));
        self.next.set((slot + 1) % FRAMES_IN_FLIGHT);
        Ok(())
    }

    /// Has the device note the time when all work before is done.
    fn stamp(&self, commands: &Commands<'_>, slot: usize, number: u32) {
        let Some(queries) = self.queries else { return };
        let first = first_query(slot, 0);
        let (raw, buffer) = (commands.raw(), commands.buffer);
        // SAFETY: recording has begun, outside of rendering; the slot's queries are in the pool, and not in use.
        unsafe {
            if number == 0 {
                raw.cmd_reset_query_pool(buffer, queries, first, STAMPS * QUERIES);
            }
            raw.cmd_write_timestamp2(buffer, Stage::ALL_COMMANDS, queries, first_query(slot, number));
        }
    }

    /// Time between the timestamps of a slot.
    fn measured(&self, queries: vk::QueryPool, slot: usize) -> Option<Duration> {
        let read = |number| {
            let mut stamp = [0_u64];
            let (first, flags) = (first_query(slot, number), vk::QueryResultFlags::TYPE_64);
            // SAFETY: the query is in the pool, and the submission that wrote it was waited for.
            let read = unsafe { self.device.raw.get_query_pool_results(queries, first, &mut stamp, flags) };
            read.ok().map(|()| stamp[0])
        };
        let ticks = ticks([read(0)?, read(1)?], self.device.timestamp_bits);
        #[allow(clippy::cast_precision_loss, reason = "a short time")]
        let nanoseconds = ticks as f64 * f64::from(self.device.limits.timestamp_period);
        Some(Duration::from_secs_f64((nanoseconds * 1e-9).clamp(0.0, 3600.0)))
    }
}

/// The first query of a timestamp.
fn first_query(slot: usize, number: u32) -> u32 {
    (u32::try_from(slot).unwrap_or(0) * STAMPS + number) * QUERIES
}

impl Drop for Flights {
    fn drop(&mut self) {
        let _ = self.wait_all();
        let raw = &self.device.raw;
        // SAFETY: every frame was waited for; null handles are ignored.
        unsafe {
            for flight in &self.flights {
                raw.destroy_fence(flight.fence, None);
            }
            raw.destroy_query_pool(self.queries.unwrap_or_default(), None);
            raw.destroy_command_pool(self.pool, None);
        }
    }
}
