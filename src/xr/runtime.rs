//! The OpenXR runtime of this machine, and a Vulkan device made through it.

use super::error::{Error, call};
use super::input::ask_for_profiles;
use super::watch::DeviceWaits;
use crate::gpu::instance::{AroundSubmission, Maker};
use crate::gpu::{self, Device, Validation};
use ash::vk::{self, Handle};
use openxr as xr;
use std::ffi::c_void;
use std::sync::Arc;

/// The view configuration of a headset: one image for each of two eyes.
pub(super) const STEREO: xr::ViewConfigurationType = xr::ViewConfigurationType::PRIMARY_STEREO;

/// A runtime that was reached, with a headset.
pub struct Runtime {
    pub(super) instance: xr::Instance,
    pub(super) system: xr::SystemId,
    /// The extensions in use.
    pub(super) extensions: xr::ExtensionSet,
    /// How long the submissions of its devices were waited for.
    pub(super) waits: DeviceWaits,
    info: RuntimeInfo,
}

impl std::fmt::Debug for Runtime {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Runtime").field("info", &self.info).finish_non_exhaustive()
    }
}

/// A runtime and its headset.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
pub struct RuntimeInfo {
    /// Name and version of the runtime.
    pub runtime: String,
    /// Name of the headset.
    pub headset: String,
    /// Recommended pixels of one eye: a row, rows.
    pub eye_size: [u32; 2],
    /// Extensions in use.
    pub extensions: Vec<String>,
    /// Extensions that would be used but are not offered; nothing depends on them.
    pub absent: Vec<String>,
}

impl Runtime {
    /// Finds the runtime and its headset.
    ///
    /// # Errors
    /// Which part is missing: loader, runtime, service, an extension, a headset, or a second eye.
    pub fn open() -> Result<Self, Error> {
        Self::through(&loader_of_system()?)
    }

    /// Like [`Runtime::open`], through an entry point of the caller, such as one that plants faults.
    ///
    /// # Errors
    /// As [`Runtime::open`].
    pub fn through(entry: &xr::Entry) -> Result<Self, Error> {
        let known = entry.enumerate_extensions().map_err(Error::NoRuntime)?;
        if !known.khr_vulkan_enable2 {
            let (runtime, what) = ("of this machine".to_owned(), "XR_KHR_vulkan_enable2".to_owned());
            return Err(Error::Lacks { runtime, what });
        }
        let mut useful = xr::ExtensionSet::default();
        useful.khr_vulkan_enable2 = true;
        useful.ext_local_floor = true;
        useful.fb_display_refresh_rate = true;
        useful.khr_composition_layer_depth = true;
        useful.khr_visibility_mask = true;
        useful.ext_hand_tracking = true;
        ask_for_profiles(&mut useful);
        let wanted = useful.intersection(&known);
        let application = xr::ApplicationInfo {
            application_name: "gaitway",
            application_version: 1,
            engine_name: "gaitway",
            engine_version: 1,
            api_version: xr::Version::new(1, 0, 0),
        };
        let instance =
            entry.create_instance(&application, &wanted, &[], &()).map_err(|result| match result {
                xr::sys::Result::ERROR_RUNTIME_FAILURE | xr::sys::Result::ERROR_INSTANCE_LOST => {
                    Error::NoService(result)
                }
                xr::sys::Result::ERROR_RUNTIME_UNAVAILABLE => Error::NoRuntime(result),
                result => Error::Call { call: "xrCreateInstance", result },
            })?;
        let properties = instance.properties().map_err(call("xrGetInstanceProperties"))?;
        let runtime = format!("{} {}", properties.runtime_name, properties.runtime_version);
        let system =
            instance.system(xr::FormFactor::HEAD_MOUNTED_DISPLAY).map_err(|result| match result {
                xr::sys::Result::ERROR_FORM_FACTOR_UNAVAILABLE
                | xr::sys::Result::ERROR_FORM_FACTOR_UNSUPPORTED => Error::NoHeadset(runtime.clone()),
                result => call("xrGetSystem")(result),
            })?;
        let headset = instance.system_properties(system).map_err(call("xrGetSystemProperties"))?.system_name;
        let views = match instance.enumerate_view_configuration_views(system, STEREO) {
            Err(xr::sys::Result::ERROR_VIEW_CONFIGURATION_TYPE_UNSUPPORTED) => Vec::new(),
            other => other.map_err(call("xrEnumerateViewConfigurationViews"))?,
        };
        let [eye, _] = views.as_slice() else {
            return Err(Error::Lacks { runtime, what: "a view for each of two eyes".to_owned() });
        };
        let eye_size = [eye.recommended_image_rect_width, eye.recommended_image_rect_height];
        let names = |set: &xr::ExtensionSet| {
            let text = |name: &[u8]| String::from_utf8_lossy(name).trim_end_matches('\0').to_owned();
            set.names().into_iter().map(text).collect()
        };
        let (extensions, absent) = (names(&wanted), names(&useful.difference(&known)));
        let info = RuntimeInfo { runtime, headset, eye_size, extensions, absent };
        Ok(Self { instance, system, extensions: wanted, waits: DeviceWaits::default(), info })
    }

    /// Names, sizes and extensions.
    pub fn info(&self) -> &RuntimeInfo {
        &self.info
    }

    /// The Vulkan device that the headset is connected to.
    ///
    /// # Errors
    /// When Vulkan is missing, or the runtime's device cannot be used.
    pub fn device(&self, validation: Validation) -> Result<Arc<Device>, Error> {
        // required before a session may be made, whatever the answer
        self.instance
            .graphics_requirements::<xr::Vulkan>(self.system)
            .map_err(call("xrGetVulkanGraphicsRequirements2KHR"))?;
        let (instance, waits) = (self.instance.clone(), self.waits.clone());
        let maker = ThroughRuntime { instance, system: self.system, waits };
        Ok(Device::made_by(&maker, &gpu::Wanted::Best, validation)?)
    }
}

/// The OpenXR loader. On Windows it is a part of this program, since applications bring it there; elsewhere it belongs to the
/// system.
fn loader_of_system() -> Result<xr::Entry, Error> {
    #[cfg(windows)]
    let entry = xr::Entry::linked(&());
    #[cfg(not(windows))]
    // SAFETY: loads the system's OpenXR loader, whose initialisers have no requirements on us.
    let entry = unsafe { xr::Entry::load(&()) };
    entry.map_err(|error| Error::NoLoader(error.to_string()))
}

/// Makes Vulkan's instance and device through the runtime, which adds the extensions that it needs.
struct ThroughRuntime {
    instance: xr::Instance,
    system: xr::SystemId,
    waits: DeviceWaits,
}

/// A Vulkan handle as OpenXR spells it.
pub(super) fn handle<H: Handle>(vulkan: H) -> *const c_void {
    std::ptr::with_exposed_provenance(usize::try_from(vulkan.as_raw()).unwrap_or(0))
}

/// OpenXR's spelling of a Vulkan handle as one.
fn handle_from<H: Handle>(openxr: *const c_void) -> H {
    H::from_raw(openxr.expose_provenance() as u64)
}

fn runtime_error(call: &'static str) -> impl FnOnce(xr::sys::Result) -> gpu::Error {
    move |result| gpu::Error::Maker { call, result: result.to_string() }
}

fn vulkan_error(call: &'static str) -> impl FnOnce(xr::sys::platform::VkResult) -> gpu::Error {
    move |result| gpu::Error::Call { call, result: vk::Result::from_raw(result) }
}

fn loader(entry: &ash::Entry) -> xr::sys::platform::VkGetInstanceProcAddr {
    // SAFETY: both are `PFN_vkGetInstanceProcAddr`, spelt with other names for the same pointers.
    unsafe {
        std::mem::transmute::<vk::PFN_vkGetInstanceProcAddr, xr::sys::platform::VkGetInstanceProcAddr>(
            entry.static_fn().get_instance_proc_addr,
        )
    }
}

impl Maker for ThroughRuntime {
    unsafe fn instance(
        &self,
        entry: &ash::Entry,
        create: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, gpu::Error> {
        // SAFETY: the caller keeps what `create` points to.
        let made = unsafe {
            self.instance.create_vulkan_instance(self.system, loader(entry), (&raw const *create).cast())
        };
        made.map_err(runtime_error("xrCreateVulkanInstanceKHR"))?
            .map(|raw| handle_from(raw.cast()))
            .map_err(vulkan_error("vkCreateInstance"))
    }

    fn physical_device(&self, instance: vk::Instance) -> Result<Option<vk::PhysicalDevice>, gpu::Error> {
        // SAFETY: the instance was made through this runtime.
        let found = unsafe { self.instance.vulkan_graphics_device(self.system, handle(instance)) };
        Ok(Some(handle_from(found.map_err(runtime_error("xrGetVulkanGraphicsDevice2KHR"))?.cast())))
    }

    fn around_submission(&self) -> Option<AroundSubmission> {
        Some(self.waits.around_submission())
    }

    unsafe fn device(
        &self,
        entry: &ash::Entry,
        _: &ash::Instance,
        physical: vk::PhysicalDevice,
        create: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, gpu::Error> {
        // SAFETY: the caller keeps what `create` points to; the physical device is the runtime's choice.
        let made = unsafe {
            let create = (&raw const *create).cast();
            self.instance.create_vulkan_device(self.system, loader(entry), handle(physical), create)
        };
        made.map_err(runtime_error("xrCreateVulkanDeviceKHR"))?
            .map(|raw| handle_from(raw.cast()))
            .map_err(vulkan_error("vkCreateDevice"))
    }
}
