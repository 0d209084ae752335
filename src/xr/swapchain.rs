//! Images that are shared with the runtime: drawn into here, shown there.
//!
//! Where the safe wrapper loses a success code that matters (a timeout) the raw call is made instead.

use super::error::{Error, call, check};
use super::watch::Watch;
use crate::gpu::Device;
use ash::vk::{self, Handle as _};
use openxr as xr;
use std::sync::Arc;
use std::time::Duration;

/// Longest wait for an image. The runtime's compositor gives one back every few periods.
const IMAGE_TIMEOUT: Duration = Duration::from_secs(2);

/// Images of one layer per eye.
pub(super) struct Swapchain {
    chain: xr::Swapchain<xr::Vulkan>,
    images: Vec<vk::Image>,
    size: [u32; 2],
    device: Arc<Device>,
    /// How long images were waited for.
    pub(super) waited: Duration,
}

impl Swapchain {
    /// Makes images of a format, `size` pixels for each eye, for these uses beside being sampled by the compositor.
    pub(super) fn new(
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        format: vk::Format,
        size: [u32; 2],
        uses: xr::SwapchainUsageFlags,
    ) -> Result<Self, Error> {
        let chain = {
            let _queue = device.hold_queue();
            session
                .create_swapchain(&xr::SwapchainCreateInfo {
                    create_flags: xr::SwapchainCreateFlags::EMPTY,
                    usage_flags: uses | xr::SwapchainUsageFlags::SAMPLED,
                    format: u32::try_from(format.as_raw()).unwrap_or(0),
                    sample_count: 1,
                    width: size[0],
                    height: size[1],
                    face_count: 1,
                    array_size: 2,
                    mip_count: 1,
                })
                .map_err(call("xrCreateSwapchain"))?
        };
        let images = chain.enumerate_images().map_err(call("xrEnumerateSwapchainImages"))?;
        let images = images.into_iter().map(vk::Image::from_raw).collect();
        Ok(Self { chain, images, size, device: device.clone(), waited: Duration::ZERO })
    }

    /// The images.
    pub(super) fn images(&self) -> &[vk::Image] {
        &self.images
    }

    /// Pixels of one eye.
    pub(super) fn size(&self) -> [u32; 2] {
        self.size
    }

    /// Number of an image to draw into. No image of it is held: every `acquire` is followed by `release`, or the session is
    /// given up.
    pub(super) fn acquire(&mut self) -> Result<usize, Error> {
        let _queue = self.device.hold_queue();
        let raw = self.chain.as_raw();
        let fp = self.chain.instance().fp();
        let mut index = 0;
        let wait = xr::sys::SwapchainImageWaitInfo {
            ty: xr::sys::SwapchainImageWaitInfo::TYPE,
            next: std::ptr::null(),
            timeout: xr::Duration::from_nanos(i64::try_from(IMAGE_TIMEOUT.as_nanos()).unwrap_or(i64::MAX)),
        };
        // SAFETY: the swapchain is alive, and no image of it is held.
        unsafe {
            check(
                "xrAcquireSwapchainImage",
                (fp.acquire_swapchain_image)(raw, std::ptr::null(), &raw mut index),
            )?;
            let watch = Watch::start();
            check("xrWaitSwapchainImage", (fp.wait_swapchain_image)(raw, &raw const wait))?;
            self.waited += watch.idle();
        }
        let index = index as usize;
        let fault = xr::sys::Result::ERROR_RUNTIME_FAILURE;
        let is_known = index < self.images.len();
        is_known.then_some(index).ok_or(Error::Call { call: "xrAcquireSwapchainImage", result: fault })
    }

    /// Gives the image back that was acquired last; it must be in the layout of an attachment.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        let _queue = self.device.hold_queue();
        let release = self.chain.instance().fp().release_swapchain_image;
        // SAFETY: an image was acquired and waited for, and the device has finished with it.
        check("xrReleaseSwapchainImage", unsafe { release(self.chain.as_raw(), std::ptr::null()) })
    }

    /// An eye's part of the image that was released last.
    pub(super) fn of_eye(&self, eye: u32) -> xr::sys::SwapchainSubImage {
        let [width, height] = self.size.map(|side| i32::try_from(side).unwrap_or(i32::MAX));
        xr::sys::SwapchainSubImage {
            swapchain: self.chain.as_raw(),
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: 0, y: 0 },
                extent: xr::Extent2Di { width, height },
            },
            image_array_index: eye,
        }
    }
}
