//! Instance, device, queue, allocator and the validation layer's voice.

use super::{Error, call};
use ash::{ext, vk};
use gpu_allocator::vulkan::{Allocator, AllocatorCreateDesc};
use std::ffi::{CStr, CString, c_void};
use std::mem::ManuallyDrop;
use std::sync::{Arc, Mutex, PoisonError};

/// How much the validation layer checks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Validation {
    /// No layer.
    #[default]
    Off,
    /// Core checks.
    Core,
    /// Core and synchronization, with the heuristic that sees missing barriers between dispatches.
    Sync,
    /// The same and checks inside shaders.
    GpuAssisted,
}

impl Validation {
    /// From the environment variable `GAITWAY_VALIDATION`: `off`, `core`, `sync` or `gpu-av`.
    pub fn from_environment() -> Self {
        match std::env::var("GAITWAY_VALIDATION").as_deref() {
            Ok("core") => Self::Core,
            Ok("sync") => Self::Sync,
            Ok("gpu-av") => Self::GpuAssisted,
            _ => Self::Off,
        }
    }
}

/// What the validation layer has said since the program began. It outlives every device, so that leaks, which are
/// told while a device is destroyed, are heard.
static MESSAGES: Mutex<Vec<String>> = Mutex::new(Vec::new());

/// What the validation layer has said since the program began.
pub fn validation_messages() -> Vec<String> {
    MESSAGES.lock().unwrap_or_else(PoisonError::into_inner).clone()
}

extern "system" fn on_message(
    severity: vk::DebugUtilsMessageSeverityFlagsEXT,
    _kind: vk::DebugUtilsMessageTypeFlagsEXT,
    data: *const vk::DebugUtilsMessengerCallbackDataEXT<'_>,
    _user: *mut c_void,
) -> vk::Bool32 {
    // SAFETY: the layer passes a pointer to callback data that is valid during this call, with C strings or null.
    let (id, text) = unsafe {
        let data = &*data;
        (data.message_id_name_as_c_str().unwrap_or(c""), data.message_as_c_str().unwrap_or(c""))
    };
    let (id, text) = (id.to_string_lossy(), text.to_string_lossy());
    // GPU-assisted validation warns about its own settings
    let own = ["VALIDATION-SETTINGS", "WARNING-GPU-Assisted-Validation", "WARNING-Setting-Limit-Adjusted"];
    if !own.iter().any(|name| id.contains(name)) {
        MESSAGES.lock().unwrap_or_else(PoisonError::into_inner).push(format!("{severity:?} {id}: {text}"));
    }
    vk::FALSE
}

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
    /// Driver name and version, where the driver tells.
    pub driver: String,
    /// Why gaitway cannot use it, if it cannot.
    pub unusable: Option<String>,
}

struct Instance {
    entry: ash::Entry,
    raw: ash::Instance,
    messenger: Option<(ext::debug_utils::Instance, vk::DebugUtilsMessengerEXT)>,
}

/// A Vulkan device with one queue for compute, graphics and transfer.
pub struct Device {
    instance: Instance,
    pub(crate) raw: ash::Device,
    pub(crate) physical: vk::PhysicalDevice,
    pub(crate) queue: Mutex<vk::Queue>,
    pub(crate) family: u32,
    pub(crate) allocator: ManuallyDrop<Mutex<Allocator>>,
    pub(crate) names: Option<ext::debug_utils::Device>,
    pub(crate) limits: vk::PhysicalDeviceLimits,
    info: DeviceInfo,
}

impl std::fmt::Debug for Device {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Device").field("info", &self.info).finish_non_exhaustive()
    }
}

const LAYER: &CStr = c"VK_LAYER_KHRONOS_validation";

impl Instance {
    fn new(validation: Validation) -> Result<Self, Error> {
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
        let raw = unsafe { entry.create_instance(&create, None) }
            .map_err(|result| Error::NoDriver { call: "vkCreateInstance", result })?;
        let messenger = (validation != Validation::Off)
            .then(|| {
                let loader = ext::debug_utils::Instance::new(&entry, &raw);
                // SAFETY: the extension is enabled; the callback is a plain function.
                let made = unsafe { loader.create_debug_utils_messenger(&messenger_info(), None) };
                made.map(|made| (loader, made)).map_err(call("vkCreateDebugUtilsMessengerEXT"))
            })
            .transpose()?;
        Ok(Self { entry, raw, messenger })
    }

    fn devices(&self) -> Result<Vec<(vk::PhysicalDevice, DeviceInfo)>, Error> {
        // SAFETY: the instance is alive.
        let devices = unsafe { self.raw.enumerate_physical_devices() }
            .map_err(|result| Error::NoDriver { call: "vkEnumeratePhysicalDevices", result })?;
        Ok(devices.into_iter().enumerate().map(|(i, d)| (d, self.describe(i, d))).collect())
    }

    fn describe(&self, index: usize, device: vk::PhysicalDevice) -> DeviceInfo {
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
            unusable: self.missing(device, api),
        }
    }

    /// What this device lacks, if anything.
    fn missing(&self, device: vk::PhysicalDevice, api: u32) -> Option<String> {
        if api < vk::API_VERSION_1_3 {
            return Some("needs Vulkan 1.3".to_owned());
        }
        let mut v11 = vk::PhysicalDeviceVulkan11Features::default();
        let mut v13 = vk::PhysicalDeviceVulkan13Features::default();
        // SAFETY: the device came from this instance and has Vulkan 1.3.
        unsafe {
            let mut features = vk::PhysicalDeviceFeatures2::default().push_next(&mut v11).push_next(&mut v13);
            self.raw.get_physical_device_features2(device, &mut features);
        }
        if v13.synchronization2 == vk::FALSE || v13.dynamic_rendering == vk::FALSE {
            return Some("lacks synchronization2 or dynamicRendering".to_owned());
        }
        if v11.multiview == vk::FALSE {
            return Some("lacks multiview".to_owned());
        }
        self.family(device).is_none().then(|| "has no queue for graphics and compute".to_owned())
    }

    fn family(&self, device: vk::PhysicalDevice) -> Option<u32> {
        // SAFETY: the device came from this instance.
        let families = unsafe { self.raw.get_physical_device_queue_family_properties(device) };
        let both = vk::QueueFlags::COMPUTE | vk::QueueFlags::GRAPHICS;
        families
            .iter()
            .position(|family| family.queue_flags.contains(both))
            .and_then(|i| u32::try_from(i).ok())
    }
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

fn messenger_info() -> vk::DebugUtilsMessengerCreateInfoEXT<'static> {
    // not INFO: with it the loader itself writes some sixty lines
    vk::DebugUtilsMessengerCreateInfoEXT::default()
        .message_severity(
            vk::DebugUtilsMessageSeverityFlagsEXT::ERROR | vk::DebugUtilsMessageSeverityFlagsEXT::WARNING,
        )
        .message_type(
            vk::DebugUtilsMessageTypeFlagsEXT::VALIDATION | vk::DebugUtilsMessageTypeFlagsEXT::PERFORMANCE,
        )
        .pfn_user_callback(Some(on_message))
}

fn bool_setting<'a>(name: &'a CStr, value: &'a [u8; 4]) -> vk::LayerSettingEXT<'a> {
    vk::LayerSettingEXT::default()
        .layer_name(LAYER)
        .setting_name(name)
        .ty(vk::LayerSettingTypeEXT::BOOL32)
        .values(value)
}

/// The devices of this machine in the loader's order.
///
/// # Errors
/// When there is no Vulkan loader or no driver at all.
pub fn list() -> Result<Vec<DeviceInfo>, Error> {
    Ok(Instance::new(Validation::Off)?.devices()?.into_iter().map(|(_, info)| info).collect())
}

impl Device {
    /// Opens a device: the one whose name contains `wanted` or whose index it is; without it the environment
    /// variable `GAITWAY_DEVICE`; without that the best (discrete, integrated, virtual, software).
    ///
    /// # Errors
    /// When there is no loader, no driver, no such device, or the device cannot be opened.
    pub fn open(wanted: Option<&str>, validation: Validation) -> Result<Arc<Self>, Error> {
        let instance = Instance::new(validation)?;
        let devices = instance.devices()?;
        let environment = std::env::var("GAITWAY_DEVICE").ok();
        let wanted = wanted.or(environment.as_deref()).filter(|name| !name.is_empty());
        let fits = |info: &DeviceInfo| {
            wanted.is_none_or(|w| {
                w.parse() == Ok(info.index) || info.name.to_lowercase().contains(&w.to_lowercase())
            })
        };
        let best = devices
            .iter()
            .filter(|(_, info)| info.unusable.is_none() && fits(info))
            .min_by_key(|(_, info)| (info.kind, info.index));
        let Some((physical, info)) = best.cloned() else {
            let list: Vec<_> = devices
                .iter()
                .map(|(_, i)| {
                    format!("{}: {} ({})", i.index, i.name, i.unusable.as_deref().unwrap_or("usable"))
                })
                .collect();
            let found = if list.is_empty() { "none".to_owned() } else { list.join(", ") };
            return Err(Error::NoDevice { wanted: wanted.unwrap_or("any").to_owned(), found });
        };
        let family = instance.family(physical).unwrap_or(0);
        let raw = open_device(&instance, physical, family)?;
        // SAFETY: the queue was asked for when the device was made; the device came from the instance.
        let (queue, limits) = unsafe {
            (raw.get_device_queue(family, 0), instance.raw.get_physical_device_properties(physical).limits)
        };
        let allocator = Allocator::new(&AllocatorCreateDesc {
            instance: instance.raw.clone(),
            device: raw.clone(),
            physical_device: physical,
            debug_settings: gpu_allocator::AllocatorDebugSettings::default(),
            buffer_device_address: false,
            allocation_sizes: gpu_allocator::AllocationSizes::default(),
        })
        .map_err(|error| Error::Memory {
            name: "allocator".to_owned(),
            bytes: 0,
            reason: error.to_string(),
        })?;
        let names = instance.messenger.is_some().then(|| ext::debug_utils::Device::new(&instance.raw, &raw));
        Ok(Arc::new(Self {
            raw,
            physical,
            queue: Mutex::new(queue),
            family,
            allocator: ManuallyDrop::new(Mutex::new(allocator)),
            names,
            limits,
            info,
            instance,
        }))
    }

    /// What the device is.
    pub fn info(&self) -> &DeviceInfo {
        &self.info
    }

    /// Name and driver in one line.
    pub fn describe(&self) -> String {
        format!("{} [{}]", self.info.name, self.info.driver)
    }

    /// Names a Vulkan object for captures and validation messages.
    pub(crate) fn name<H: vk::Handle>(&self, handle: H, name: &str) {
        if let (Some(loader), Ok(name)) = (&self.names, CString::new(name)) {
            let info = vk::DebugUtilsObjectNameInfoEXT::default().object_handle(handle).object_name(&name);
            // SAFETY: the handle belongs to this device; a name that cannot be set is no loss.
            let _ = unsafe { loader.set_debug_utils_object_name(&info) };
        }
    }

    /// Features of image formats, for the renderer.
    pub(crate) fn format_properties(&self, format: vk::Format) -> vk::FormatProperties {
        // SAFETY: the physical device came from this instance.
        unsafe { self.instance.raw.get_physical_device_format_properties(self.physical, format) }
    }

    /// Submits one command buffer and waits until the device has done it.
    pub(crate) fn submit_and_wait(&self, commands: vk::CommandBuffer, fence: vk::Fence) -> Result<(), Error> {
        let queue = self.queue.lock().unwrap_or_else(PoisonError::into_inner);
        let infos = [vk::CommandBufferSubmitInfo::default().command_buffer(commands)];
        let submit = [vk::SubmitInfo2::default().command_buffer_infos(&infos)];
        // SAFETY: the command buffer is recorded and not in use, the fence is unsignalled, the queue is locked.
        unsafe {
            self.raw.queue_submit2(*queue, &submit, fence).map_err(call("vkQueueSubmit2"))?;
            self.raw.wait_for_fences(&[fence], true, u64::MAX).map_err(call("vkWaitForFences"))?;
            self.raw.reset_fences(&[fence]).map_err(call("vkResetFences"))
        }
    }
}

fn open_device(instance: &Instance, physical: vk::PhysicalDevice, family: u32) -> Result<ash::Device, Error> {
    // SAFETY: the device came from this instance.
    let known = unsafe { instance.raw.get_physical_device_features(physical) };
    let features = vk::PhysicalDeviceFeatures {
        robust_buffer_access: known.robust_buffer_access,
        vertex_pipeline_stores_and_atomics: known.vertex_pipeline_stores_and_atomics,
        fragment_stores_and_atomics: known.fragment_stores_and_atomics,
        ..Default::default()
    };
    let mut v11 = vk::PhysicalDeviceVulkan11Features::default();
    let mut v12 = vk::PhysicalDeviceVulkan12Features::default();
    // SAFETY: the device has Vulkan 1.3, so these structures are known to it.
    unsafe {
        let mut all = vk::PhysicalDeviceFeatures2::default().push_next(&mut v11).push_next(&mut v12);
        instance.raw.get_physical_device_features2(physical, &mut all);
    }
    let mut want11 = vk::PhysicalDeviceVulkan11Features::default().multiview(v11.multiview == vk::TRUE);
    // timeline semaphores, 8-bit storage and the memory model are what GPU-assisted validation instruments with
    let mut want12 = vk::PhysicalDeviceVulkan12Features::default()
        .timeline_semaphore(v12.timeline_semaphore == vk::TRUE)
        .vulkan_memory_model(v12.vulkan_memory_model == vk::TRUE)
        .vulkan_memory_model_device_scope(v12.vulkan_memory_model_device_scope == vk::TRUE)
        .buffer_device_address(v12.buffer_device_address == vk::TRUE)
        .host_query_reset(v12.host_query_reset == vk::TRUE);
    let mut want13 =
        vk::PhysicalDeviceVulkan13Features::default().synchronization2(true).dynamic_rendering(true);
    let priorities = [1.0];
    let queues =
        [vk::DeviceQueueCreateInfo::default().queue_family_index(family).queue_priorities(&priorities)];
    let create = vk::DeviceCreateInfo::default()
        .queue_create_infos(&queues)
        .enabled_features(&features)
        .push_next(&mut want11)
        .push_next(&mut want12)
        .push_next(&mut want13);
    // SAFETY: all pointers in `create` live until the call returns; every feature asked for is there.
    unsafe { instance.raw.create_device(physical, &create, None) }.map_err(call("vkCreateDevice"))
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: buffers and pipelines hold an `Arc` of this device, so none is left; the allocator frees its
        // memory before the device goes, the device before the instance (the last field).
        unsafe {
            let _ = self.raw.device_wait_idle();
            ManuallyDrop::drop(&mut self.allocator);
            self.raw.destroy_device(None);
        }
        let _ = &self.instance.entry;
    }
}
