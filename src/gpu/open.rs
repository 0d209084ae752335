//! How a device is opened: with which features, and how urgent its work is.

use super::Error;
use super::instance::{Instance, Maker};
use ash::{ext, khr, vk};
use std::ffi::CStr;

/// How urgent the work of a device is beside that of other devices on the same GPU.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Priority {
    /// As urgent as that of others.
    #[default]
    Normal,
    /// It gives way to others, such as frames that must be ready in time, where the driver has priorities. Elsewhere it is as
    /// urgent.
    Low,
}

/// A device that was just opened.
pub(super) struct Opened {
    pub(super) raw: ash::Device,
    pub(super) multiview: bool,
    /// Whether its work gives way to others.
    pub(super) has_low_priority: bool,
}

/// The features that are used where they are there.
struct Features {
    core: vk::PhysicalDeviceFeatures,
    // One structure a feature: a maker may chain its own (timeline semaphores), and Vulkan allows no feature twice.
    multiview: vk::PhysicalDeviceMultiviewFeatures<'static>,
    // timeline semaphores, addresses and the memory model are what GPU-assisted validation instruments with
    timeline: vk::PhysicalDeviceTimelineSemaphoreFeatures<'static>,
    memory_model: vk::PhysicalDeviceVulkanMemoryModelFeatures<'static>,
    addresses: vk::PhysicalDeviceBufferDeviceAddressFeatures<'static>,
    query_reset: vk::PhysicalDeviceHostQueryResetFeatures<'static>,
    synchronization: vk::PhysicalDeviceSynchronization2Features<'static>,
    rendering: vk::PhysicalDeviceDynamicRenderingFeatures<'static>,
}

impl Features {
    fn of(instance: &ash::Instance, physical: vk::PhysicalDevice) -> Self {
        let mut v11 = vk::PhysicalDeviceVulkan11Features::default();
        let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
        // SAFETY: the device came from this instance; it has Vulkan 1.3, so these structures are known to it.
        let known = unsafe {
            let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut v11).push_next(&mut v12);
            instance.get_physical_device_features2(physical, &mut all);
            all.features
        };
        let has = |feature| feature == vk::TRUE;
        Self {
            core: vk::PhysicalDeviceFeatures {
                robust_buffer_access: known.robust_buffer_access,
                vertex_pipeline_stores_and_atomics: known.vertex_pipeline_stores_and_atomics,
                fragment_stores_and_atomics: known.fragment_stores_and_atomics,
                ..Default::default()
            },
            multiview: vk::PhysicalDeviceMultiviewFeatures::default().multiview(has(v11.multiview)),
            timeline: vk::PhysicalDeviceTimelineSemaphoreFeatures::default()
                .timeline_semaphore(has(v12.timeline_semaphore)),
            memory_model: vk::PhysicalDeviceVulkanMemoryModelFeatures::default()
                .vulkan_memory_model(has(v12.vulkan_memory_model))
                .vulkan_memory_model_device_scope(has(v12.vulkan_memory_model_device_scope)),
            addresses: vk::PhysicalDeviceBufferDeviceAddressFeatures::default()
                .buffer_device_address(has(v12.buffer_device_address)),
            query_reset: vk::PhysicalDeviceHostQueryResetFeatures::default()
                .host_query_reset(has(v12.host_query_reset)),
            synchronization: vk::PhysicalDeviceSynchronization2Features::default().synchronization2(true),
            rendering: vk::PhysicalDeviceDynamicRenderingFeatures::default().dynamic_rendering(true),
        }
    }

    /// A device with these features.
    fn create(&mut self) -> vk::DeviceCreateInfo<'_> {
        vk::DeviceCreateInfo::default()
            .enabled_features(&self.core)
            .push_next(&mut self.multiview)
            .push_next(&mut self.timeline)
            .push_next(&mut self.memory_model)
            .push_next(&mut self.addresses)
            .push_next(&mut self.query_reset)
            .push_next(&mut self.synchronization)
            .push_next(&mut self.rendering)
    }
}

impl Opened {
    /// Opens a device with one queue. A driver that refuses the priority gives one without.
    pub(super) fn new(
        maker: &dyn Maker,
        instance: &Instance,
        physical: vk::PhysicalDevice,
        family: u32,
        priority: Priority,
    ) -> Result<Self, Error> {
        let mut features = Features::of(&instance.raw, physical);
        let multiview = features.multiview.multiview == vk::TRUE;
        let create = features.create();
        let open = |create: &vk::DeviceCreateInfo<'_>, has_low_priority| {
            // SAFETY: all pointers in `create` live until the call returns; every feature and extension asked for is there;
            // the handle is that of the device just made.
            unsafe {
                let raw = maker.device(&instance.entry, &instance.raw, physical, create)?;
                Ok(Self { raw: ash::Device::load(instance.raw.fp_v1_0(), raw), multiview, has_low_priority })
            }
        };
        let queue = vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&[1.0]);
        if let (Priority::Low, Some(extension)) = (priority, priorities(instance, physical)) {
            let mut low = vk::DeviceQueueGlobalPriorityCreateInfoKHR::default()
                .global_priority(vk::QueueGlobalPriorityKHR::LOW);
            let (queues, extensions) = ([queue.push_next(&mut low)], [extension.as_ptr()]);
            let create = create.queue_create_infos(&queues).enabled_extension_names(&extensions);
            if let Ok(opened) = open(&create, true) {
                return Ok(opened);
            }
        }
        open(&create.queue_create_infos(&[queue]), false)
    }
}

/// The extension by which queues of this device have priorities, if it has one.
fn priorities(instance: &Instance, physical: vk::PhysicalDevice) -> Option<&'static CStr> {
    // SAFETY: the device came from this instance.
    let known = unsafe { instance.raw.enumerate_device_extension_properties(physical) }.ok()?;
    let is_known =
        |name: &&CStr| known.iter().any(|extension| extension.extension_name_as_c_str() == Ok(*name));
    [khr::global_priority::NAME, ext::global_priority::NAME].into_iter().find(is_known)
}

/// Whether a driver that has multiview draws it right: lavapipe of Mesa 22.3 claims it and draws one view wrong.
pub(super) fn draws_every_view(driver: &str) -> bool {
    let lavapipe = driver.strip_prefix("llvmpipe Mesa ");
    let major = lavapipe.and_then(|version| version.split('.').next()?.parse::<u32>().ok());
    major.is_none_or(|major| major >= 23)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::super::instance::Own;
    use super::super::{Device, Validation, Wanted};
    use super::*;
    use crate::gpu::for_tests;
    use std::cell::RefCell;

    /// Makes devices as they are wanted, or refuses those with a priority. Notes the priority that each was wanted with.
    #[derive(Default)]
    struct Gatekeeper {
        refuses: bool,
        asked: RefCell<Vec<Option<vk::QueueGlobalPriorityKHR>>>,
    }

    impl Maker for Gatekeeper {
        unsafe fn instance(
            &self,
            entry: &ash::Entry,
            create: &vk::InstanceCreateInfo<'_>,
        ) -> Result<vk::Instance, Error> {
            // SAFETY: as the caller promises.
            unsafe { Own.instance(entry, create) }
        }

        fn physical_device(&self, instance: vk::Instance) -> Result<Option<vk::PhysicalDevice>, Error> {
            Own.physical_device(instance)
        }

        unsafe fn device(
            &self,
            entry: &ash::Entry,
            instance: &ash::Instance,
            physical: vk::PhysicalDevice,
            create: &vk::DeviceCreateInfo<'_>,
        ) -> Result<vk::Device, Error> {
            // SAFETY: as the caller promises; the only structure that we chain to a queue is that of its priority.
            let priority = unsafe {
                let queue = &*create.p_queue_create_infos;
                queue.p_next.cast::<vk::DeviceQueueGlobalPriorityCreateInfoKHR<'_>>().as_ref()
            };
            self.asked.borrow_mut().push(priority.map(|priority| priority.global_priority));
            if self.refuses && priority.is_some() {
                let result = vk::Result::ERROR_NOT_PERMITTED_KHR;
                return Err(Error::Call { call: "vkCreateDevice", result });
            }
            // SAFETY: as the caller promises.
            unsafe { Own.device(entry, instance, physical, create) }
        }
    }

    #[test]
    fn work_that_gives_way_is_asked_for_and_done_without_where_it_is_refused() {
        let Some(device) = for_tests::device() else { return };
        let wanted = Wanted::Number(device.info().index);
        let has_priorities = priorities(&device.instance, device.physical).is_some();
        println!("queues have priorities: {has_priorities}");
        let validation = Validation::from_environment().unwrap();
        let low = Some(vk::QueueGlobalPriorityKHR::LOW);
        for (refuses, priority) in [(false, Priority::Normal), (false, Priority::Low), (true, Priority::Low)]
        {
            let keeper = Gatekeeper { refuses, ..Gatekeeper::default() };
            let made = Device::made_at(&keeper, &wanted, validation, priority).unwrap();
            let asks = has_priorities && priority == Priority::Low;
            let asked = match (asks, refuses) {
                (true, true) => vec![low, None],
                (true, false) => vec![low],
                _ => vec![None],
            };
            assert_eq!(*keeper.asked.borrow(), asked, "{priority:?}, refused: {refuses}");
            assert_eq!(made.has_low_priority, asks && !refuses);
            drop(made);
        }
        drop(device);
        for_tests::assert_silent();
    }

    #[test]
    fn only_an_old_lavapipe_is_not_trusted_with_multiview() {
        assert!(!draws_every_view("llvmpipe Mesa 22.3.6 (LLVM 15.0.6)"));
        for driver in ["llvmpipe Mesa 25.0.7-2+deb13u1 (LLVM 19.1.7)", "NVIDIA 570.1", "llvmpipe Mesa", ""] {
            assert!(draws_every_view(driver), "{driver}");
        }
    }
}
