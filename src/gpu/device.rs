//! A device with its queue and allocator.

use super::arithmetic::{self, Arithmetic, Part, Setting};
use super::cache::PipelineCache;
use super::drivers::Draws;
use super::instance::{AroundSubmission, DeviceInfo, DriverId, Instance, Maker, Own};
use super::open::{Opened, Priority, draws_every_view};
use super::validation::Validation;
use super::wanted::Wanted;
use super::{Error, call};
use crate::kernels::link::FloatMode;
use ash::{ext, vk};
use gpu_allocator::AllocationSizes;
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::ffi::CString;
use std::mem::ManuallyDrop;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;

/// A Vulkan device with one queue for compute, graphics and transfer.
pub struct Device {
    pub(crate) instance: Instance,
    pub(crate) raw: ash::Device,
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) queue: Mutex<vk::Queue>,
    pub(crate) family: u32,
    pub(crate) allocator: ManuallyDrop<Mutex<Allocator>>,
    pub(crate) names: Option<ext::debug_utils::Device>,
    pub(crate) limits: vk::PhysicalDeviceLimits,
    /// Bits of its timestamps; 0 where it has none.
    pub(crate) timestamp_bits: u32,
    pub(super) driver: DriverId,
    /// What its pipelines are made with.
    pub(crate) cache: PipelineCache,
    /// Whether one pass can draw both eyes.
    pub(crate) multiview: bool,
    /// How crowds are drawn where no setting says it: never [`Draws::Auto`].
    pub(crate) draws: Draws,
    /// How its kernels are to be computed.
    pub(super) setting: Setting,
    /// What may be declared of its floats.
    float_modes: Vec<FloatMode>,
    /// The arithmetic of its kernels, once it is settled.
    pub(super) arithmetic: OnceLock<Arithmetic>,
    info: DeviceInfo,
    validation: Validation,
    /// The priority that was asked for.
    priority: Priority,
    /// Whether the driver gave a low one.
    pub(super) has_low_priority: bool,
    /// Runs around every wait for a submission.
    around_submission: Option<AroundSubmission>,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Device").field("info", &self.info).finish_non_exhaustive()
    }
}

impl Device {
    /// Opens a device: the one of that name or number ([`Wanted::of`]).
    ///
    /// # Errors
    /// When there is no loader, no driver, no such device, or the device cannot be opened.
    pub fn open(wanted: Option<&str>, validation: Validation) -> Result<Arc<Self>, Error> {
        Self::made_by(&Own, &Wanted::of(wanted), validation)
    }

    /// Like [`Device::open`], whatever option and environment say of the arithmetic.
    ///
    /// # Errors
    /// As of [`Device::open`].
    pub fn open_with(
        wanted: Option<&str>,
        validation: Validation,
        setting: Setting,
    ) -> Result<Arc<Self>, Error> {
        Self::made_with(&Own, &Wanted::of(wanted), validation, setting, Priority::Normal)
    }

    /// Opens a device whose work has some priority.
    ///
    /// # Errors
    /// As of [`Device::open`], and where every device is software but none is to be.
    pub fn open_at(wanted: &Wanted, validation: Validation, priority: Priority) -> Result<Arc<Self>, Error> {
        Self::made_at(&Own, wanted, validation, priority)
    }

    /// Like [`Device::open`], but `maker` makes instance and device and may choose the physical device.
    pub(crate) fn made_by(
        maker: &dyn Maker,
        wanted: &Wanted,
        validation: Validation,
    ) -> Result<Arc<Self>, Error> {
        Self::made_at(maker, wanted, validation, Priority::Normal)
    }

    pub(super) fn made_at(
        maker: &dyn Maker,
        wanted: &Wanted,
        validation: Validation,
        priority: Priority,
    ) -> Result<Arc<Self>, Error> {
        Self::made_with(maker, wanted, validation, Setting::of_process()?, priority)
    }

    /// The same physical device, opened again in the same way, after this one was lost.
    ///
    /// # Errors
    /// As of [`Device::open`].
    pub fn reopen(&self) -> Result<Arc<Self>, Error> {
        let Self { info, validation, setting, priority, .. } = self;
        Self::made_with(&Own, &Wanted::Number(info.index), *validation, setting.clone(), *priority)
    }

    fn made_with(
        maker: &dyn Maker,
        wanted: &Wanted,
        validation: Validation,
        setting: Setting,
        priority: Priority,
    ) -> Result<Arc<Self>, Error> {
        let draws = Draws::of_process()?;
        let instance = Instance::new(validation, maker)?;
        let mut devices = instance.devices()?;
        let chosen = maker.physical_device(instance.raw.handle())?;
        if let Some(chosen) = chosen {
            devices.retain(|(device, _)| *device == chosen);
        }
        for (device, info) in &mut devices {
            if let (None, Some(family)) = (&info.unusable, instance.family(*device)) {
                info.unusable = maker.refusal(&instance.entry, &instance.raw, *device, family);
            }
        }
        let wanted = if chosen.is_some() { &Wanted::Best } else { wanted };
        let best = wanted.choose(devices.iter().map(|(_, info)| info)).map(|info| info.index);
        let Some((physical, info)) = devices.iter().find(|(_, info)| Some(info.index) == best).cloned()
        else {
            let software = Wanted::Best.choose(devices.iter().map(|(_, info)| info));
            if let (Wanted::Hardware, Some(info)) = (wanted, software) {
                return Err(Error::OnlySoftware { name: info.name.clone() });
            }
            let list: Vec<_> = devices
                .iter()
                .map(|(_, i)| {
                    format!("{}: {} ({})", i.index, i.name, i.unusable.as_deref().unwrap_or("usable"))
                })
                .collect();
            let found = if list.is_empty() { "none".to_owned() } else { list.join(", ") };
            return Err(Error::NoDevice { wanted: wanted.clone(), found });
        };
        let family = instance.family(physical).unwrap_or(0);
        let Opened { raw, multiview, has_low_priority } =
            Opened::new(maker, &instance, physical, family, priority)?;
        // SAFETY: the queue was asked for when the device was made; the device came from the instance.
        let (queue, properties, memory) = unsafe {
            (
                raw.get_device_queue(family, 0),
                instance.raw.get_physical_device_properties(physical),
                instance.raw.get_physical_device_memory_properties(physical),
            )
        };
        let driver = DriverId::of(&properties);
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw.clone(),
            device: raw.clone(),
            physical_device: physical,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: block_sizes(&memory),
        })
        .map_err(|error| Error::Memory {
            name: "allocator".to_owned(),
            bytes: 0,
            reason: error.to_string(),
        })?;
        let names = instance.messenger.is_some().then(|| ext::debug_utils::Device::new(&instance.raw, &raw));
        Ok(Arc::new(Self {
            physical,
            queue: Mutex::new(queue),
            family,
            allocator: ManuallyDrop::new(Mutex::new(allocator)),
            names,
            limits: properties.limits,
            timestamp_bits: instance.timestamp_bits(physical, family),
            driver,
            cache: if setting.is_lasting() {
                PipelineCache::open(&raw, driver)
            } else {
                PipelineCache::none(driver)
            },
            multiview: multiview && draws_every_view(&info.driver),
            draws: draws.or(if info.draws_indirectly { Draws::Indirect } else { Draws::Direct }),
            setting,
            float_modes: arithmetic::float_modes(&instance.raw, physical),
            arithmetic: OnceLock::new(),
            info,
            raw,
            validation,
            priority,
            has_low_priority,
            around_submission: maker.around_submission(),
            instance,
        }))
    }

    /// What the device is.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Arithmetic with careful code for these parts.
    pub(super) fn arithmetic_of(&self, careful: Vec<Part>) -> Arithmetic {
        Arithmetic::new(careful, self.float_modes.clone(), self.setting.faults.clone())
    }

    /// Name and driver in one line, with a low priority, and with the arithmetic where it is known not to be the device's own.
    pub fn describe(&self) -> String {
        let Self { info: DeviceInfo { name, driver, .. }, arithmetic, .. } = self;
        let priority = if self.has_low_priority { ", low priority" } else { "" };
        match arithmetic.get().filter(|arithmetic| !arithmetic.careful().is_empty()) {
            Some(careful) => format!("{name} [{driver}]{priority}, arithmetic {careful}"),
            None => format!("{name} [{driver}]{priority}"),
        }
    }

    /// Names a Vulkan object for captures and validation messages.
    pub(crate) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        if let (Some(loader), Ok(name)) = (&self.names, CString::new(name)) {
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle belongs to this device; a name that cannot be set is no loss.
            let _ = unsafe { loader.set_debug_utils_object_name(&info) };
        }
    }

    /// Locks the queue. Calls of other libraries that use it, and presenting, may overlap with no submission.
    pub(crate) fn hold_queue(&self) -> std::sync::MutexGuard<'_, vk::Queue> {
        self.queue.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// What the device can do with images of a format.
    pub(crate) fn format_properties(&self, format: vk::Format) -> vk::FormatProperties {
        // SAFETY: the physical device came from this instance.
        unsafe { self.instance.raw.get_physical_device_format_properties(self.physical, format) }
    }

    /// The type, among those of these bits, of memory that the device takes only when its tiles do not suffice. Only transient
    /// attachments are bound to it, and only tilers have it.
    pub(crate) fn lazy_memory(&self, types: u32) -> Option<u32> {
        // SAFETY: the physical device came from this instance.
        let memory = unsafe { self.instance.raw.get_physical_device_memory_properties(self.physical) };
        let is_lazy = |index: &u32| {
            let flags = memory.memory_types[*index as usize].property_flags;
            types & (1 << index) != 0 && flags.contains(vk::MemoryPropertyFlags::LAZILY_ALLOCATED)
        };
        (0..memory.memory_type_count).find(is_lazy)
    }

    /// Submits one command buffer and waits until the device has done it.
    pub(crate) fn submit_and_wait(&self, commands: vk::CommandBuffer, fence: vk::Fence) -> Result<(), Error> {
        let queue = self.hold_queue();
        self.around(|| self.submit_to(*queue, &[commands], fence).and_then(|()| self.wait(fence)))
    }

    /// Submits command buffers, which [`Device::finish`] waits for.
    pub(crate) fn submit(&self, commands: &[vk::CommandBuffer], fence: vk::Fence) -> Result<(), Error> {
        let queue = self.hold_queue();
        self.submit_to(*queue, commands, fence)
    }

    /// Waits until the device has done the submission of this fence. Afterwards, what the submission uses may be dropped,
    /// also after an error.
    pub(crate) fn finish(&self, fence: vk::Fence) -> Result<(), Error> {
        self.around(|| {
            until_over(
                || self.wait_once(fence),
                || {
                    let _queue = self.hold_queue();
                    self.wait_idle()
                },
            )
        })
    }

    /// Runs what waits for the device.
    fn around(&self, mut wait: impl FnMut() -> Result<(), Error>) -> Result<(), Error> {
        let Some(around) = &self.around_submission else { return wait() };
        let mut outcome = Ok(());
        around(&mut || outcome = wait());
        outcome
    }

    /// Submits command buffers to the queue, which the caller holds.
    fn submit_to(
        &self,
        queue: vk::Queue,
        commands: &[vk::CommandBuffer],
        fence: vk::Fence,
    ) -> Result<(), Error> {
        let info = |one: &vk::CommandBuffer| vk::CommandBufferSubmitInfo::default().command_buffer(*one);
        let infos: Vec<_> = commands.iter().map(info).collect();
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&infos)];
        self.reset(fence)?;
        // SAFETY: the command buffers are recorded and may be submitted again, the fence is unsignalled, the queue is locked.
        unsafe { self.raw.queue_submit2(queue, &submit, fence) }.map_err(call("vkQueueSubmit2"))
    }

    /// Resets a fence for a submission, just before it. A fence that could not be reset after its last submission would end
    /// the next wait at once, and buffers in use would be dropped.
    pub(crate) fn reset(&self, fence: vk::Fence) -> Result<(), Error> {
        // SAFETY: the fence is of this device, and every submission that would signal it was waited for.
        unsafe { self.raw.reset_fences(&[fence]) }.map_err(call("vkResetFences"))
    }

    /// Waits for the fence of a submission, whose queue the caller holds. Afterwards, what the submission uses may be dropped,
    /// also after an error.
    pub(crate) fn wait(&self, fence: vk::Fence) -> Result<(), Error> {
        until_over(|| self.wait_once(fence), || self.wait_idle())
    }

    fn wait_once(&self, fence: vk::Fence) -> Result<(), vk::Result> {
        // SAFETY: the fence is of this device and has been handed to a submission.
        unsafe { self.raw.wait_for_fences(&[fence], true, u64::MAX) }
    }

    /// Waits for all work of the device, whose queue the caller holds.
    fn wait_idle(&self) -> Result<(), vk::Result> {
        // SAFETY: the caller holds the only queue of the device.
        unsafe { self.raw.device_wait_idle() }
    }
}

/// Returns only when the submission is over, since its buffers may be dropped then. A wait that fails for want of memory is
/// repeated. After any other failure the device has to be idle first. A lost device has no work left.
fn until_over(
    mut wait: impl FnMut() -> Result<(), vk::Result>,
    mut idle: impl FnMut() -> Result<(), vk::Result>,
) -> Result<(), Error> {
    const AGAIN: [vk::Result; 3] =
        [vk::Result::TIMEOUT, vk::Result::ERROR_OUT_OF_HOST_MEMORY, vk::Result::ERROR_OUT_OF_DEVICE_MEMORY];
    const LOST: vk::Result = vk::Result::ERROR_DEVICE_LOST;
    loop {
        let Err(result) = wait() else { return Ok(()) };
        if !AGAIN.contains(&result) && (result == LOST || matches!(idle(), Ok(()) | Err(LOST))) {
            return Err(call("vkWaitForFences")(result));
        }
        std::thread::sleep(Duration::from_millis(1));
    }
}

/// How much memory is taken from the driver at a time: usually 256 MiB of the device's and 64 MiB of the host's, but at most a
/// sixteenth of the largest heap, so that little memory has room for more than one buffer.
fn block_sizes(memory: &vk::PhysicalDeviceMemoryProperties) -> AllocationSizes {
    let largest = memory.memory_heaps_as_slice().iter().map(|heap| heap.size).max().unwrap_or(0);
    let at_most = |mib: u64| (mib << 20).min(largest / 16);
    AllocationSizes::new(at_most(256), at_most(64))
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: buffers and pipelines hold an `Arc` of this device, so none is left or being made; the allocator frees
        // its memory before the device goes, the device before the instance (the last field).
        unsafe {
            let _ = self.raw.device_wait_idle();
            self.cache.close(&self.raw);
            ManuallyDrop::drop(&mut self.allocator);
            self.raw.destroy_device(None);
        }
        let _ = &self.instance.entry;
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use crate::gpu::for_tests;

    #[test]
    fn a_wait_comes_back_only_when_the_work_is_over() {
        const MEMORY: vk::Result = vk::Result::ERROR_OUT_OF_HOST_MEMORY;
        const LOST: vk::Result = vk::Result::ERROR_DEVICE_LOST;
        const UNKNOWN: vk::Result = vk::Result::ERROR_UNKNOWN;
        type Results<'a> = &'a [Result<(), vk::Result>];
        // what waiting says, one after the other, what being idle says, and what comes of it
        let cases: [(Results<'_>, Results<'_>, bool); 5] = [
            (&[Err(vk::Result::TIMEOUT), Err(MEMORY), Ok(())], &[], true),
            (&[Err(LOST)], &[], false),
            (&[Err(UNKNOWN)], &[Ok(())], false),
            (&[Err(UNKNOWN), Err(UNKNOWN)], &[Err(MEMORY), Err(LOST)], false),
            (&[Err(UNKNOWN), Ok(())], &[Err(UNKNOWN)], true),
        ];
        for (waits, idles, is_done) in cases {
            let (mut wait, mut idle) = (waits.iter().copied(), idles.iter().copied());
            let outcome = until_over(|| wait.next().unwrap(), || idle.next().unwrap());
            assert_eq!(outcome.is_ok(), is_done, "{waits:?} {idles:?}");
            assert!(
                wait.next().is_none() && idle.next().is_none(),
                "{waits:?} {idles:?}: came back too early"
            );
        }
    }

    #[test]
    fn a_fence_that_was_left_signalled_does_not_end_the_next_wait() {
        let Some(device) = for_tests::device() else { return };
        let raw = &device.raw;
        // SAFETY: the create-infos are complete; what is made is destroyed when its submission is over.
        unsafe {
            let signalled = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
            let fence = raw.create_fence(&signalled, None).unwrap();
            let pool = vk::CommandPoolCreateInfo::default().queue_family_index(device.family);
            let pool = raw.create_command_pool(&pool, None).unwrap();
            let one = vk::CommandBufferAllocateInfo::default().command_pool(pool).command_buffer_count(1);
            let commands = raw.allocate_command_buffers(&one).unwrap()[0];
            raw.begin_command_buffer(commands, &vk::CommandBufferBeginInfo::default()).unwrap();
            raw.end_command_buffer(commands).unwrap();
            for _ in 0..2 {
                device.submit_and_wait(commands, fence).unwrap();
                assert!(raw.get_fence_status(fence).unwrap(), "signalled by this submission");
            }
            raw.destroy_fence(fence, None);
            raw.destroy_command_pool(pool, None);
        }
        drop(device);
        for_tests::assert_silent(); // which says what is wrong with fences
    }
}
