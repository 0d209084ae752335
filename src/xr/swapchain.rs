//! Images that are shared with the runtime: drawn into here, shown there.
//!
//! Both eyes share one swapchain of two layers, so that one pass can draw them. A runtime that has none of two layers gets a
//! swapchain for each eye.
//! Where the safe wrapper loses a success code that matters (a timeout) the raw call is made instead.

use super::error::{Error, call, check};
use super::watch::Watch;
use crate::gpu::Device;
use crate::render::EyeImages;
use ash::vk::{self, Handle as _};
use openxr as xr;
use std::sync::Arc;
use std::time::Duration;

/// Longest wait for an image. The runtime's compositor gives one back every few periods.
const IMAGE_TIMEOUT: Duration = Duration::from_secs(2);

/// What images are to be.
#[derive(Debug, Clone, Copy)]
pub(super) struct ImageKind {
    pub(super) format: vk::Format,
    /// Pixels of one eye.
    pub(super) size: [u32; 2],
    /// Uses beside being sampled by the compositor.
    pub(super) uses: xr::SwapchainUsageFlags,
}

/// The images of both eyes.
pub(super) enum EyeChains {
    /// Two layers of one swapchain.
    Layered(Swapchain),
    /// A swapchain for each eye.
    Single([Swapchain; 2]),
}

impl EyeChains {
    /// Makes layered images, or single ones where the runtime refuses those.
    pub(super) fn new(
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        kind: ImageKind,
    ) -> Result<Self, Error> {
        match Swapchain::new(session, device, kind, 2) {
            Ok(chain) => Ok(Self::Layered(chain)),
            Err(Error::Call { .. }) => Self::single(session, device, kind),
            Err(error) => Err(error),
        }
    }

    /// Makes images of another kind, layered or single as these are.
    pub(super) fn beside(
        &self,
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        kind: ImageKind,
    ) -> Result<Self, Error> {
        match self {
            Self::Layered(_) => Swapchain::new(session, device, kind, 2).map(Self::Layered),
            Self::Single(_) => Self::single(session, device, kind),
        }
    }

    fn single(
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        kind: ImageKind,
    ) -> Result<Self, Error> {
        let one = || Swapchain::new(session, device, kind, 1);
        Ok(Self::Single([one()?, one()?]))
    }

    /// The images of two layers: none where each eye has its own.
    pub(super) fn layered(&self) -> &[vk::Image] {
        match self {
            Self::Layered(chain) => &chain.images,
            Self::Single(_) => &[],
        }
    }

    /// Pixels of one eye.
    pub(super) fn size(&self) -> [u32; 2] {
        let (Self::Layered(chain) | Self::Single([chain, _])) = self;
        chain.size
    }

    /// How long images were waited for.
    pub(super) fn waited(&self) -> Duration {
        match self {
            Self::Layered(chain) => chain.waited,
            Self::Single([left, right]) => left.waited + right.waited,
        }
    }

    /// Images to draw into. No others are held: every `acquire` is followed by `release`, or the session is given up.
    pub(super) fn acquire(&mut self) -> Result<EyeImages, Error> {
        Ok(match self {
            Self::Layered(chain) => EyeImages::layered(chain.acquire()?),
            Self::Single([left, right]) => EyeImages::single([left.acquire()?, right.acquire()?]),
        })
    }

    /// Gives the images back that were acquired last; they must be in the layout of an attachment.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        match self {
            Self::Layered(chain) => chain.release(),
            Self::Single(chains) => chains.iter_mut().try_for_each(Swapchain::release),
        }
    }

    /// An eye's part of the images that were released last, of which so many pixels were drawn.
    pub(super) fn of_eye(&self, eye: usize, drawn: [u32; 2]) -> xr::sys::SwapchainSubImage {
        let [width, height] = drawn.map(|side| i32::try_from(side).unwrap_or(i32::MAX));
        let (chain, layer) = match self {
            Self::Layered(chain) => (chain, u32::from(eye != 0)),
            Self::Single([left, right]) => (if eye == 0 { left } else { right }, 0),
        };
        xr::sys::SwapchainSubImage {
            swapchain: chain.chain.as_raw(),
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x: 0, y: 0 },
                extent: xr::Extent2Di { width, height },
            },
            image_array_index: layer,
        }
    }
}

/// One swapchain.
pub(super) struct Swapchain {
    chain: xr::Swapchain<xr::Vulkan>,
    images: Vec<vk::Image>,
    size: [u32; 2],
    device: Arc<Device>,
    /// How long images were waited for.
    waited: Duration,
}

impl Swapchain {
    /// Makes images of so many layers.
    pub(super) fn new(
        session: &xr::Session<xr::Vulkan>,
        device: &Arc<Device>,
        kind: ImageKind,
        layers: u32,
    ) -> Result<Self, Error> {
        let ImageKind { format, size, uses } = kind;
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
                    array_size: layers,
                    mip_count: 1,
                })
                .map_err(call("xrCreateSwapchain"))?
        };
        let images = chain.enumerate_images().map_err(call("xrEnumerateSwapchainImages"))?;
        let images = images.into_iter().map(vk::Image::from_raw).collect();
        Ok(Self { chain, images, size, device: device.clone(), waited: Duration::ZERO })
    }

    /// How long images were waited for.
    pub(super) const fn waited(&self) -> Duration {
        self.waited
    }

    /// An image to write to. No other is held.
    pub(super) fn acquire(&mut self) -> Result<vk::Image, Error> {
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
        let fault = xr::sys::Result::ERROR_RUNTIME_FAILURE;
        let image = self.images.get(index as usize).copied();
        image.ok_or(Error::Call { call: "xrAcquireSwapchainImage", result: fault })
    }

    /// Gives the image back that was acquired; it must be in the layout of an attachment.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        let _queue = self.device.hold_queue();
        let release = self.chain.instance().fp().release_swapchain_image;
        // SAFETY: an image was acquired and waited for, and the device has finished with it.
        check("xrReleaseSwapchainImage", unsafe { release(self.chain.as_raw(), std::ptr::null()) })
    }

    /// A part of the image that was released last: left, top, width, height.
    pub(super) fn part(&self, part: [u32; 4]) -> xr::sys::SwapchainSubImage {
        let [x, y, width, height] = part.map(|side| i32::try_from(side).unwrap_or(i32::MAX));
        xr::sys::SwapchainSubImage {
            swapchain: self.chain.as_raw(),
            image_rect: xr::Rect2Di {
                offset: xr::Offset2Di { x, y },
                extent: xr::Extent2Di { width, height },
            },
            image_array_index: 0,
        }
    }
}
