//! The Vulkan instance and the devices that the machine has.

use super::drivers::{draws_indirectly, is_tiler};
use super::validation::{LAYER, Validation, bool_setting, messenger_info};
use super::{Error, call};
use crate::kernels::NEEDS;
use ash::{ext, vk};
use std::ffi::CStr;
use std::sync::OnceLock;

/// What kind of device it is, best first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum DeviceKind {
    /// A graphics card.
    Discrete,
    /// A GPU inside the processor.
    Integrated,
    /// A GPU of a virtual machine.
    Virtual,
    /// A software device such as lavapipe.
    Cpu,
    /// Anything else.
    Other,
}

impl DeviceKind {
    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Discrete => "discrete",
            Self::Integrated => "integrated",
            Self::Virtual => "virtual",
            Self::Cpu => "cpu",
            Self::Other => "other",
        }
    }
}

/// A device that the machine has, usable or not.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceInfo {
    /// Position in the loader's list.
    pub index: usize,
    /// Name as the driver gives it.
    pub name: String,
    /// Kind.
    pub kind: DeviceKind,
    /// Vulkan version, `major.minor.patch`.
    pub api: String,
    /// Driver name and version, where the driver reports them.
    pub driver: String,
    /// Whether it draws images tile by tile in memory of its own, as GPUs of phones do.
    pub is_tiler: bool,
    /// Whether its indexed indirect draws draw something, as far as is known.
    pub draws_indirectly: bool,
    /// Why gaitway cannot use it, if it cannot.
    pub unusable: Option<String>,
}

/// A device and its driver. What was compiled, and what was found of the arithmetic, holds for all of the same.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct DriverId {
    /// Number of the maker.
    pub(super) vendor: u32,
    /// The maker's number of the device.
    pub(super) device: u32,
    /// The driver's version, in its own form.
    pub(super) version: u32,
    /// Changes when the driver's compiled pipelines do.
    pub(super) cache_uuid: [u8; vk::UUID_SIZE],
}

impl DriverId {
    pub(super) const fn of(properties: &vk::PhysicalDeviceProperties) -> Self {
        Self {
            vendor: properties.vendor_id,
            device: properties.device_id,
            version: properties.driver_version,
            cache_uuid: properties.pipeline_cache_uuid,
        }
    }
}

/// Runs around a wait for a submission. It calls its argument once, which waits and may submit before.
pub(crate) type AroundSubmission = Box<dyn Fn(&mut dyn FnMut()) + Send + Sync>;

/// Makes the Vulkan instance and device, and may add what its own library needs of them.
pub(crate) trait Maker {
    /// Makes the instance.
    ///
    /// # Safety
    /// Everything that `create` points to is alive; `entry` outlives the instance.
    unsafe fn instance(
        &self,
        entry: &ash::Entry,
        create: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, Error>;

    /// The one device that may be used, where the maker chooses.
    fn physical_device(&self, instance: vk::Instance) -> Result<Option<vk::PhysicalDevice>, Error>;

    /// Why a device cannot be used, though it has what kernels and draws need.
    fn refusal(
        &self,
        _entry: &ash::Entry,
        _instance: &ash::Instance,
        _physical: vk::PhysicalDevice,
        _family: u32,
    ) -> Option<String> {
        None
    }

    /// What runs around the waits for submissions of the device, such as a timer.
    fn around_submission(&self) -> Option<AroundSubmission> {
        None
    }

    /// Makes the device.
    ///
    /// # Safety
    /// Everything that `create` points to is alive; `physical` is of `instance`, which outlives the device.
    unsafe fn device(
        &self,
        entry: &ash::Entry,
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        create: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, Error>;
}

/// Makes both through the Vulkan loader alone.
#[derive(Debug)]
pub(crate) struct Own;

impl Maker for Own {
    unsafe fn instance(
        &self,
        entry: &ash::Entry,
        create: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, Error> {
        // SAFETY: as the caller promises.
        unsafe { entry.create_instance(create, None) }
            .map(|instance| instance.handle())
            .map_err(|result| Error::NoDriver { call: "vkCreateInstance", result })
    }

    fn physical_device(&self, _: vk::Instance) -> Result<Option<vk::PhysicalDevice>, Error> {
        Ok(None)
    }

    unsafe fn device(
        &self,
        _: &ash::Entry,
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        create: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, Error> {
        // SAFETY: as the caller promises.
        unsafe { instance.create_device(physical, create, None) }
            .map(|device| device.handle())
            .map_err(call("vkCreateDevice"))
    }
}

/// Less address space than this is not tried, bytes: a driver that finds too little ends the program.
#[cfg(unix)]
const LEAST_ADDRESS_SPACE: u64 = 2 << 30;

/// Most address space that this process may have (`ulimit -v`), bytes.
#[cfg(unix)]
fn address_space() -> Option<u64> {
    let mut limit = libc::rlimit { rlim_cur: 0, rlim_max: 0 };
    // SAFETY: writes into the structure and nowhere else.
    let result = unsafe { libc::getrlimit(libc::RLIMIT_AS, &raw mut limit) };
    (result == 0 && limit.rlim_cur != libc::RLIM_INFINITY).then_some(limit.rlim_cur)
}

/// Keeps the drivers loaded for as long as the process lives, by an instance that is never destroyed. Loaders unload a driver with its
/// last instance, and NVIDIA's (580) refuses to be loaded once more after some fifty times.
fn keep_drivers(entry: &ash::Entry) {
    static KEPT: OnceLock<Option<(ash::Entry, ash::Instance)>> = OnceLock::new();
    KEPT.get_or_init(|| {
        // SAFETY: nothing is asked for; what is made, and the loader, are never let go.
        let instance = unsafe { entry.create_instance(&vk::InstanceCreateInfo::default(), None) };
        Some((entry.clone(), instance.ok()?)) // without it all works as well, but for so many times
    });
}

pub(crate) struct Instance {
    pub(crate) entry: ash::Entry,
    pub(crate) raw: ash::Instance,
    pub(crate) messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
}

impl Instance {
    pub(crate) fn new(validation: Validation, maker: &dyn Maker) -> Result<Self, Error> {
        #[cfg(unix)]
        if let Some(bytes) = address_space().filter(|bytes| *bytes < LEAST_ADDRESS_SPACE) {
            return Err(Error::AddressSpace { mib: bytes >> 20, least: LEAST_ADDRESS_SPACE >> 20 });
        }
        // SAFETY: loads the system's Vulkan loader, whose initialisers have no requirements on us.
        let entry = unsafe { ash::Entry::load() }.map_err(|error| Error::NoLoader(error.to_string()))?;
        let mut layers = Vec::new();
        let mut layer_version = 0;
        if validation != Validation::Off {
            // SAFETY: the entry is loaded.
            let known = unsafe { entry.enumerate_instance_layer_properties() }
                .map_err(call("vkEnumerateInstanceLayerProperties"))?;
            let layer = known.iter().find(|layer| layer.layer_name_as_c_str() == Ok(LAYER));
            layer_version = layer.ok_or(Error::NoValidationLayer)?.spec_version;
            layers.push(LAYER.as_ptr());
        }
        let extensions: &[_] =
            if validation == Validation::Off { &[] } else { &[ext::debug_utils::NAME.as_ptr()] };
        let application = vk::ApplicationInfo::default()
            .application_name(c"gaitway")
            .engine_name(c"gaitway")
            .api_version(vk::API_VERSION_1_3);
        let sync = [vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION];
        let assisted = [
            vk::ValidationFeatureEnableEXT::SYNCHRONIZATION_VALIDATION,
            vk::ValidationFeatureEnableEXT::GPU_ASSISTED,
            vk::ValidationFeatureEnableEXT::GPU_ASSISTED_RESERVE_BINDING_SLOT,
        ];
        let enabled: &[_] = match validation {
            Validation::Off | Validation::Core => &[],
            Validation::Sync => &sync,
            Validation::GpuAssisted => &assisted,
        };
        let mut features = vk::ValidationFeaturesEXT::default().enabled_validation_features(enabled);
        let mut messenger = messenger_info();
        let yes = 1_u32.to_ne_bytes();
        let mut settings =
            [bool_setting(c"syncval_shader_accesses_heuristic", &yes), bool_setting(c"validate_sync", &yes)];
        settings.iter_mut().for_each(|setting| setting.value_count = 1); // ash counts bytes
        let mut layer_settings = vk::LayerSettingsCreateInfoEXT::default().settings(&settings);
        let mut create = vk::InstanceCreateInfo::default()
            .application_info(&application)
            .enabled_layer_names(&layers)
            .enabled_extension_names(extensions);
        if validation != Validation::Off {
            create = create.push_next(&mut features).push_next(&mut messenger);
            // older layers call the structure an error
            if validation != Validation::Core && layer_version >= vk::make_api_version(0, 1, 4, 0) {
                create = create.push_next(&mut layer_settings);
            }
        }
        // SAFETY: all pointers in `create` live until the call returns.
        let raw = unsafe { maker.instance(&entry, &create) }?;
        // SAFETY: the handle is that of an instance which was just made through this entry.
        let raw = unsafe { ash::Instance::load(entry.static_fn(), raw) };
        let messenger = (validation != Validation::Off)
            .then(|| {
                let loader = ext::debug_utils::Instance::new(&entry, &raw);
                // SAFETY: the extension is enabled; the callback is a plain function.
                let made = unsafe { loader.create_debug_utils_messenger(&messenger_info(), None) };
                made.map(|made| (loader, made)).map_err(call("vkCreateDebugUtilsMessengerEXT"))
            })
            .transpose()?;
        keep_drivers(&entry);
        Ok(Self { entry, raw, messenger })
    }

    pub(crate) fn devices(&self) -> Result<Vec<(vk::PhysicalDevice, DeviceInfo)>, Error> {
        // SAFETY: the instance is alive.
        let devices = unsafe { self.raw.enumerate_physical_devices() }
            .map_err(|result| Error::NoDriver { call: "vkEnumeratePhysicalDevices", result })?;
        Ok(devices.into_iter().enumerate().map(|(i, d)| (d, self.describe(i, d))).collect())
    }

    pub(crate) fn describe(&self, index: usize, device: vk::PhysicalDevice) -> DeviceInfo {
        let mut driver = vk::PhysicalDeviceDriverProperties::default();
        // SAFETY: the device came from this instance; the 1.2 structure is chained only where 1.2 is there.
        let properties = unsafe {
            let plain = self.raw.get_physical_device_properties(device);
            if plain.api_version >= vk::API_VERSION_1_2 {
                let mut both = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
                self.raw.get_physical_device_properties2(device, &mut both);
            }
            plain
        };
        let text = |name: Option<&CStr>| name.map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        let api = properties.api_version;
        let version = |v| {
            format!("{}.{}.{}", vk::api_version_major(v), vk::api_version_minor(v), vk::api_version_patch(v))
        };
        DeviceInfo {
            index,
            name: text(properties.device_name_as_c_str().ok()),
            kind: match properties.device_type {
                vk::PhysicalDeviceType::DISCRETE_GPU => DeviceKind::Discrete,
                vk::PhysicalDeviceType::INTEGRATED_GPU => DeviceKind::Integrated,
                vk::PhysicalDeviceType::VIRTUAL_GPU => DeviceKind::Virtual,
                vk::PhysicalDeviceType::CPU => DeviceKind::Cpu,
                _ => DeviceKind::Other,
            },
            api: version(api),
            driver: format!(
                "{} {}",
                text(driver.driver_name_as_c_str().ok()),
                text(driver.driver_info_as_c_str().ok())
            )
            .trim()
            .to_owned(),
            is_tiler: is_tiler(driver.driver_id, properties.vendor_id),
            draws_indirectly: draws_indirectly(driver.driver_id),
            unusable: self.missing(device, api, &properties.limits),
        }
    }

    /// What this device lacks, if anything.
    fn missing(
        &self,
        device: vk::PhysicalDevice,
        api: u32,
        limits: &vk::PhysicalDeviceLimits,
    ) -> Option<String> {
        if api < vk::API_VERSION_1_3 {
            return Some("needs Vulkan 1.3".to_owned());
        }
        if let Some(short) = short(limits) {
            return Some(short);
        }
        let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
        // SAFETY: the device came from this instance and has Vulkan 1.3.
        unsafe {
            let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut v13);
            self.raw.get_physical_device_features2(device, &mut features);
        }
        if v13.synchronization2 == vk::FALSE || v13.dynamic_rendering == vk::FALSE {
            return Some("lacks synchronization2 or dynamicRendering".to_owned());
        }
        self.family(device).is_none().then(|| "has no queue for graphics and compute".to_owned())
    }

    pub(crate) fn family(&self, device: vk::PhysicalDevice) -> Option<u32> {
        // SAFETY: the device came from this instance.
        let families = unsafe { self.raw.get_physical_device_queue_family_properties(device) };
        let both = vk::QueueFlags::COMPUTE | vk::QueueFlags::GRAPHICS;
        families
            .iter()
            .position(|family| family.queue_flags.contains(both))
            .and_then(|i| u32::try_from(i).ok())
    }

    /// Bits of the timestamps that queues of a family write; 0 where they write none.
    pub(crate) fn timestamp_bits(&self, device: vk::PhysicalDevice, family: u32) -> u32 {
        // SAFETY: the device came from this instance.
        let families = unsafe { self.raw.get_physical_device_queue_family_properties(device) };
        families.get(family as usize).map_or(0, |family| family.timestamp_valid_bits)
    }
}

/// The first limit that is too low for the shaders.
fn short(limits: &vk::PhysicalDeviceLimits) -> Option<String> {
    let limits = [
        (
            "storage buffers of a stage",
            limits.max_per_stage_descriptor_storage_buffers,
            NEEDS.storage_buffers,
        ),
        (
            "uniform buffers of a stage",
            limits.max_per_stage_descriptor_uniform_buffers,
            NEEDS.uniform_buffers,
        ),
        ("sampled images of a stage", limits.max_per_stage_descriptor_sampled_images, NEEDS.sampled_images),
        ("resources of a stage", limits.max_per_stage_resources, NEEDS.resources),
        ("bytes of a uniform buffer", limits.max_uniform_buffer_range, NEEDS.uniform_range),
        ("bytes of immediates", limits.max_push_constants_size, NEEDS.immediates),
        ("invocations of a workgroup", limits.max_compute_work_group_invocations, NEEDS.invocations),
        ("bytes of workgroup memory", limits.max_compute_shared_memory_size, NEEDS.workgroup_memory),
    ];
    let (what, has, needed) = limits.into_iter().find(|(_, has, needed)| has < needed)?;
    Some(format!("has {has} {what}, needs {needed}"))
}

impl Drop for Instance {
    fn drop(&mut self) {
        // SAFETY: everything made from this instance is gone: `Device` drops its own parts first.
        unsafe {
            if let Some((loader, messenger)) = self.messenger.take() {
                loader.destroy_debug_utils_messenger(messenger, None);
            }
            self.raw.destroy_instance(None);
        }
    }
}

/// The devices of this machine in the loader's order.
///
/// # Errors
/// When there is no Vulkan loader or no driver at all.
pub fn list() -> Result<Vec<DeviceInfo>, Error> {
    Ok(Instance::new(Validation::Off, &Own)?.devices()?.into_iter().map(|(_, info)| info).collect())
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn a_device_is_refused_for_the_limit_that_is_too_low() {
        let enough = vk::PhysicalDeviceLimits {
            max_per_stage_descriptor_storage_buffers: 12,
            max_per_stage_descriptor_uniform_buffers: 13,
            max_per_stage_descriptor_sampled_images: 128,
            max_per_stage_resources: 128,
            max_uniform_buffer_range: 16_384,
            max_push_constants_size: 128,
            max_compute_work_group_invocations: 128,
            max_compute_shared_memory_size: 16_384,
            ..Default::default()
        };
        assert_eq!(short(&enough), None, "Android 15");
        let few = vk::PhysicalDeviceLimits { max_per_stage_descriptor_storage_buffers: 4, ..enough };
        assert_eq!(short(&few).unwrap(), "has 4 storage buffers of a stage, needs 12");
        let small = vk::PhysicalDeviceLimits { max_compute_work_group_invocations: 32, ..enough };
        assert!(short(&small).unwrap().starts_with("has 32 invocations of a workgroup, needs "));
    }
}
