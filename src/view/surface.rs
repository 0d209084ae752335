//! The window's side of Vulkan: a device that can show images in it, its surface, and the images it takes.

use super::Error;
use crate::gpu::instance::Maker;
use crate::gpu::{self, Device, Validation, call};
use ash::{khr, vk};
use std::ffi::{CStr, c_char};
use std::sync::Arc;
use winit::raw_window_handle::{
    HasDisplayHandle as _, HasWindowHandle as _, RawDisplayHandle, RawWindowHandle,
};
use winit::window::Window;

/// Formats of a window that images can be copied to as they are, best first.
const FORMATS: [vk::Format; 3] =
    [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_SRGB, vk::Format::A8B8G8R8_SRGB_PACK32];
/// Longest wait for an image of the window, ns: a compositor that shows nothing gives none.
const IMAGE_TIMEOUT: u64 = 200_000_000;

/// A window as the system knows it.
#[derive(Debug, Clone, Copy)]
struct Handles {
    display: RawDisplayHandle,
    window: RawWindowHandle,
}

impl Handles {
    fn of(window: &Window) -> Result<Self, Error> {
        let lost = |error| Error::NoDisplay(format!("the window is gone: {error}"));
        let display = window.display_handle().map_err(lost)?.as_raw();
        Ok(Self { display, window: window.window_handle().map_err(lost)?.as_raw() })
    }

    /// A surface for the window. The caller destroys it, before the instance and before the window.
    fn surface(&self, entry: &ash::Entry, instance: &ash::Instance) -> Result<vk::SurfaceKHR, gpu::Error> {
        // SAFETY: the instance was made with the extensions that the display needs; the window is alive.
        unsafe { ash_window::create_surface(entry, instance, self.display, self.window, None) }
            .map_err(call("vkCreateSurfaceKHR"))
    }
}

/// The device that shows images in a window.
///
/// # Errors
/// When no Vulkan device can, or Vulkan is missing.
pub(super) fn open(
    window: &Window,
    wanted: Option<&str>,
    validation: Validation,
) -> Result<Arc<Device>, crate::Error> {
    let maker = ForWindow { handles: Handles::of(window)? };
    Device::made_by(&maker, &gpu::Wanted::of(wanted), validation).map_err(|error| match error {
        gpu::Error::NoDevice { found, .. } => Error::NoPresenter(found).into(),
        gpu::Error::NoDriver { result: vk::Result::ERROR_EXTENSION_NOT_PRESENT, .. } => {
            Error::NoPresenter("a Vulkan loader or drivers that know no windows of this system".to_owned())
                .into()
        }
        other => other.into(),
    })
}

/// Makes Vulkan's instance and device with what a window needs.
struct ForWindow {
    handles: Handles,
}

/// The names that are there already, and more.
///
/// # Safety
/// `names` points to `count` names, or `count` is 0.
unsafe fn joined(names: *const *const c_char, count: u32, more: &[*const c_char]) -> Vec<*const c_char> {
    let mut all = more.to_vec();
    if count > 0 && !names.is_null() {
        // SAFETY: as the caller promises.
        all.extend_from_slice(unsafe { std::slice::from_raw_parts(names, count as usize) });
    }
    all
}

impl ForWindow {
    /// Whether a device has the extension for swapchains.
    fn has_swapchains(instance: &ash::Instance, physical: vk::PhysicalDevice) -> bool {
        // SAFETY: the device came from this instance.
        let known = unsafe { instance.enumerate_device_extension_properties(physical) };
        known.is_ok_and(|known| {
            known.iter().any(|extension| extension.extension_name_as_c_str() == Ok(khr::swapchain::NAME))
        })
    }
}

impl Maker for ForWindow {
    unsafe fn instance(
        &self,
        entry: &ash::Entry,
        create: &vk::InstanceCreateInfo<'_>,
    ) -> Result<vk::Instance, gpu::Error> {
        let wanted = ash_window::enumerate_required_extensions(self.handles.display)
            .map_err(|result| gpu::Error::NoDriver { call: "vkCreateInstance", result })?;
        let mut create = *create;
        // SAFETY: the caller keeps what `create` points to.
        let names =
            unsafe { joined(create.pp_enabled_extension_names, create.enabled_extension_count, wanted) };
        create = create.enabled_extension_names(&names);
        // SAFETY: as the caller promises; the names live until the call returns.
        unsafe { entry.create_instance(&create, None) }
            .map(|instance| instance.handle())
            .map_err(|result| gpu::Error::NoDriver { call: "vkCreateInstance", result })
    }

    fn physical_device(&self, _: vk::Instance) -> Result<Option<vk::PhysicalDevice>, gpu::Error> {
        Ok(None)
    }

    fn refusal(
        &self,
        entry: &ash::Entry,
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        family: u32,
    ) -> Option<String> {
        if !Self::has_swapchains(instance, physical) {
            return Some("cannot show pictures in windows".to_owned());
        }
        let surface = match self.handles.surface(entry, instance) {
            Ok(surface) => surface,
            Err(error) => return Some(error.to_string()),
        };
        let loader = khr::surface::Instance::new(entry, instance);
        // SAFETY: device, surface and loader are of one instance; the surface is destroyed once, after its use.
        let can_show = unsafe {
            let can_show = loader.get_physical_device_surface_support(physical, family, surface);
            loader.destroy_surface(surface, None);
            can_show
        };
        (can_show != Ok(true)).then(|| "cannot show pictures in this window".to_owned())
    }

    unsafe fn device(
        &self,
        _: &ash::Entry,
        instance: &ash::Instance,
        physical: vk::PhysicalDevice,
        create: &vk::DeviceCreateInfo<'_>,
    ) -> Result<vk::Device, gpu::Error> {
        let swapchain: &CStr = khr::swapchain::NAME;
        let mut create = *create;
        // SAFETY: the caller keeps what `create` points to.
        let names = unsafe {
            let (names, count) = (create.pp_enabled_extension_names, create.enabled_extension_count);
            joined(names, count, &[swapchain.as_ptr()])
        };
        create = create.enabled_extension_names(&names);
        // SAFETY: as the caller promises; the names live until the call returns.
        unsafe { instance.create_device(physical, &create, None) }
            .map(|device| device.handle())
            .map_err(call("vkCreateDevice"))
    }
}

/// The images of a window at one size.
struct Images {
    swapchain: vk::SwapchainKHR,
    images: Vec<vk::Image>,
    /// Signalled when an image is ready to be shown, one for each: the last showing may still wait on it.
    drawn: Vec<vk::Semaphore>,
    extent: vk::Extent2D,
}

/// An image of the window, to be copied to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Slot {
    index: u32,
    pub(super) image: vk::Image,
    pub(super) extent: vk::Extent2D,
    /// To be waited for before the image is written.
    pub(super) free: vk::Semaphore,
    /// To be signalled when it is written.
    pub(super) drawn: vk::Semaphore,
}

/// A window's surface and its images, replaced when they no longer fit.
pub(super) struct Surface {
    device: Arc<Device>,
    loader: khr::surface::Instance,
    swapchains: khr::swapchain::Device,
    raw: vk::SurfaceKHR,
    format: vk::SurfaceFormatKHR,
    images: Option<Images>,
    free: vk::Semaphore,
    /// How often images were made.
    made: u32,
}

impl Surface {
    pub(super) fn new(device: &Arc<Device>, window: &Window) -> Result<Self, crate::Error> {
        let (entry, instance) = (&device.instance.entry, &device.instance.raw);
        let raw = Handles::of(window)?.surface(entry, instance)?;
        let mut surface = Self {
            device: device.clone(),
            loader: khr::surface::Instance::new(entry, instance),
            swapchains: khr::swapchain::Device::new(instance, &device.raw),
            raw,
            format: vk::SurfaceFormatKHR::default(),
            images: None,
            free: vk::Semaphore::null(),
            made: 0,
        };
        surface.format = surface.choose_format()?;
        // SAFETY: the device is alive; `Drop` destroys the semaphore.
        surface.free = unsafe { device.raw.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }
            .map_err(call("vkCreateSemaphore"))?;
        Ok(surface)
    }

    /// How often the window's images were made.
    pub(super) const fn made(&self) -> u32 {
        self.made
    }

    fn choose_format(&self) -> Result<vk::SurfaceFormatKHR, crate::Error> {
        // SAFETY: device and surface are of one instance and alive.
        let known =
            unsafe { self.loader.get_physical_device_surface_formats(self.device.physical, self.raw) }
                .map_err(gpu_call("vkGetPhysicalDeviceSurfaceFormatsKHR"))?;
        let of = |wanted: vk::Format| {
            let fits = |found: &&vk::SurfaceFormatKHR| {
                found.format == wanted && found.color_space == vk::ColorSpaceKHR::SRGB_NONLINEAR
            };
            known.iter().find(fits).copied()
        };
        FORMATS.into_iter().find_map(of).ok_or_else(|| {
            let names: Vec<String> = known.iter().map(|found| format!("{:?}", found.format)).collect();
            Error::NoFormat(names.join(", ")).into()
        })
    }

    /// Makes the window's images for this size of the window; none while it has no area.
    fn make(&mut self, size: [u32; 2]) -> Result<(), gpu::Error> {
        // SAFETY: device and surface are of one instance and alive.
        let can =
            unsafe { self.loader.get_physical_device_surface_capabilities(self.device.physical, self.raw) }
                .map_err(call("vkGetPhysicalDeviceSurfaceCapabilitiesKHR"))?;
        let extent = if can.current_extent.width == u32::MAX {
            // the window takes the size of its images
            let (least, most) = (can.min_image_extent, can.max_image_extent);
            vk::Extent2D {
                width: size[0].clamp(least.width, most.width.max(least.width)),
                height: size[1].clamp(least.height, most.height.max(least.height)),
            }
        } else {
            can.current_extent
        };
        self.forget();
        if extent.width == 0 || extent.height == 0 {
            return Ok(());
        }
        let most = if can.max_image_count == 0 { u32::MAX } else { can.max_image_count };
        let opaque = vk::CompositeAlphaFlagsKHR::OPAQUE;
        let alpha = if can.supported_composite_alpha.contains(opaque) {
            opaque
        } else {
            vk::CompositeAlphaFlagsKHR::INHERIT
        };
        let create = vk::SwapchainCreateInfoKHR::default()
            .surface(self.raw)
            .min_image_count((can.min_image_count + 1).min(most))
            .image_format(self.format.format)
            .image_color_space(self.format.color_space)
            .image_extent(extent)
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::TRANSFER_DST)
            .image_sharing_mode(vk::SharingMode::EXCLUSIVE)
            .pre_transform(can.current_transform)
            .composite_alpha(alpha)
            .present_mode(vk::PresentModeKHR::FIFO)
            .clipped(true);
        // SAFETY: the create-info is within what the surface can; `forget` destroys what is made.
        unsafe {
            let swapchain =
                self.swapchains.create_swapchain(&create, None).map_err(call("vkCreateSwapchainKHR"))?;
            let mut made = Images { swapchain, images: Vec::new(), drawn: Vec::new(), extent };
            let images = self.swapchains.get_swapchain_images(swapchain);
            made.images = images.as_ref().cloned().unwrap_or_default();
            self.images = Some(made);
            images.map_err(call("vkGetSwapchainImagesKHR"))?;
        }
        if let Some(made) = &mut self.images {
            for _ in 0..made.images.len() {
                // SAFETY: the device is alive.
                let one =
                    unsafe { self.device.raw.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) };
                made.drawn.push(one.map_err(call("vkCreateSemaphore"))?);
            }
        }
        self.made += 1;
        Ok(())
    }

    /// Destroys the images. Nothing is being drawn to them: every submission is waited for.
    pub(super) fn forget(&mut self) {
        let Some(made) = self.images.take() else { return };
        let queue = self.device.hold_queue();
        // SAFETY: the queue is held, and idle afterwards, so that no showing waits on a semaphore any more.
        unsafe {
            let _ = self.device.raw.queue_wait_idle(*queue);
            for semaphore in made.drawn {
                self.device.raw.destroy_semaphore(semaphore, None);
            }
            self.swapchains.destroy_swapchain(made.swapchain, None);
        }
    }

    /// An image to copy to, for a window of `size` pixels; `None` when there is none just now.
    pub(super) fn acquire(&mut self, size: [u32; 2]) -> Result<Option<Slot>, gpu::Error> {
        if self.images.is_none() {
            self.make(size)?;
        }
        let Some(made) = &self.images else { return Ok(None) };
        // SAFETY: the semaphore is unsignalled and nothing waits for it: the submission that waited for it is done.
        let got = unsafe {
            self.swapchains.acquire_next_image(made.swapchain, IMAGE_TIMEOUT, self.free, vk::Fence::null())
        };
        match got {
            // an image that is not quite right is shown all the same: its semaphore is signalled
            Ok((index, _)) => {
                let place = index as usize;
                let (Some(image), Some(drawn)) = (made.images.get(place), made.drawn.get(place)) else {
                    return Ok(None);
                };
                Ok(Some(Slot { index, image: *image, extent: made.extent, free: self.free, drawn: *drawn }))
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.forget();
                Ok(None)
            }
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => Ok(None),
            Err(result) => Err(call("vkAcquireNextImageKHR")(result)),
        }
    }

    /// Shows an image that was written.
    pub(super) fn show(&mut self, slot: &Slot) -> Result<(), gpu::Error> {
        let Some(made) = &self.images else { return Ok(()) };
        let (waits, chains, indices) = ([slot.drawn], [made.swapchain], [slot.index]);
        let info =
            vk::PresentInfoKHR::default().wait_semaphores(&waits).swapchains(&chains).image_indices(&indices);
        let shown = {
            let queue = self.device.hold_queue();
            // SAFETY: the image was acquired and its semaphore is signalled by a submission; the queue is held.
            unsafe { self.swapchains.queue_present(*queue, &info) }
        };
        match shown {
            Ok(false) => Ok(()),
            Ok(true) | Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.forget();
                Ok(())
            }
            Err(result) => Err(call("vkQueuePresentKHR")(result)),
        }
    }
}

fn gpu_call(name: &'static str) -> impl FnOnce(vk::Result) -> crate::Error {
    move |result| call(name)(result).into()
}

impl Drop for Surface {
    fn drop(&mut self) {
        self.forget();
        // SAFETY: the images are gone; the semaphore is used by no submission; the instance and the window are alive.
        unsafe {
            self.device.raw.destroy_semaphore(self.free, None);
            self.loader.destroy_surface(self.raw, None);
        }
    }
}
