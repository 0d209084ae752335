//! One session with the headset: its swapchain, its spaces and its frame loop, in the order that OpenXR demands.
//!
//! `wait` (xrWaitFrame, xrBeginFrame) is always followed by `end` (xrEndFrame), with or without an image. Where the
//! safe wrapper loses a success code that matters (a timeout, a loss that is pending) the raw call is made instead.

use super::error::{Error, Loss, call};
use super::hidden::Hidden;
use super::input::{Active, Input};
use super::panel::layer::PanelImages;
use super::runtime::{Runtime, STEREO, handle};
use super::state::{Event, State};
use super::swapchain::{EyeChains, ImageKind};
use super::views::Pose;
use super::watch::DeviceWaits;
use crate::gpu::Device;
use crate::render::{DEPTH_FORMAT, Stereo, Target};
use ash::vk;
use openxr as xr;
use openxr::EnvironmentBlendMode as BlendMode;
use std::sync::Arc;
use std::time::Duration;

/// Formats that images may have, best first: all with the sRGB curve, since shaders write linear light.
const FORMATS: [vk::Format; 2] = [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_SRGB];

/// A frame that was begun and must be ended.
#[derive(Debug, Clone, Copy)]
#[must_use = "a frame that was begun must be ended"]
pub(super) struct Frame {
    /// When it will be seen, in the runtime's time.
    pub(super) display: xr::Time,
    /// Length of a period of the display.
    pub(super) period: Duration,
    /// Whether an image is wanted.
    pub(super) wants_image: bool,
}

/// Where the eyes are and what they see, in the room.
#[derive(Clone, Copy)]
pub(super) struct Eyes {
    pub(super) views: [xr::View; 2],
    pub(super) placed: [(Pose, xr::Fovf); 2],
}

/// A session; dropping it ends it and gives everything back.
pub(super) struct Session {
    // In the order in which they must go: views of images, swapchains, spaces, the session itself.
    /// Views of both layers of the images to draw into, where they have two.
    views: Vec<(vk::Image, vk::ImageView)>,
    pub(super) color: EyeChains,
    pub(super) depth: Option<EyeChains>,
    /// Made with the first panel.
    pub(super) panel: Option<PanelImages>,
    hidden: Hidden,
    pub(super) room: xr::Space,
    head: xr::Space,
    pub(super) input: Option<Input>,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    pub(super) session: xr::Session<xr::Vulkan>,
    pub(super) instance: xr::Instance,
    pub(super) device: Arc<Device>,
    device_waits: DeviceWaits,
    pub(super) blend: BlendMode,
    pub(super) format: vk::Format,
    state: State,
    is_running: bool,
}

impl std::fmt::Debug for Session {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Session")
            .field("state", &self.state)
            .field("size", &self.size())
            .finish_non_exhaustive()
    }
}

/// A session with what waits for its frames and what submits them.
type RawSession = (xr::Session<xr::Vulkan>, xr::FrameWaiter, xr::FrameStream<xr::Vulkan>);

/// Creates a session on a device that was made through the runtime.
fn create(runtime: &Runtime, device: &Arc<Device>) -> Result<RawSession, Error> {
    let binding = xr::vulkan::SessionCreateInfo {
        instance: handle(device.instance.raw.handle()).cast(),
        physical_device: handle(device.physical).cast(),
        device: handle(device.raw.handle()).cast(),
        queue_family_index: device.family,
        queue_index: 0,
    };
    // SAFETY: the device was made through this runtime; the guard keeps it until xrDestroySession has returned.
    let created = unsafe {
        runtime.instance.create_session_with_guard::<xr::Vulkan>(
            runtime.system,
            &binding,
            Box::new(device.clone()),
        )
    };
    created.map_err(call("xrCreateSession"))
}

/// Whether the runtime's list of formats has this one.
fn offers(known: &[u32], format: vk::Format) -> bool {
    u32::try_from(format.as_raw()).is_ok_and(|format| known.contains(&format))
}

impl Session {
    /// Makes a session on a device that was made through the runtime. `size` is that of one eye in pixels; none: what the
    /// runtime recommends.
    ///
    /// # Errors
    /// When a call fails, or the runtime has no usable image format.
    pub(super) fn new(
        runtime: &Runtime,
        device: &Arc<Device>,
        size: Option<[u32; 2]>,
    ) -> Result<Self, Error> {
        let instance = runtime.instance.clone();
        let (session, waiter, stream) = create(runtime, device)?;
        let lacks =
            |what: &str| Error::Lacks { runtime: runtime.info().runtime.clone(), what: what.to_owned() };
        let modes = instance
            .enumerate_environment_blend_modes(runtime.system, STEREO)
            .map_err(call("xrEnumerateEnvironmentBlendModes"))?;
        let blend = blend(&modes).ok_or_else(|| lacks("an environment blend mode"))?;
        let room = room(&session)?;
        let head = session
            .create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)
            .map_err(call("xrCreateReferenceSpace"))?;
        let known = session.enumerate_swapchain_formats().map_err(call("xrEnumerateSwapchainFormats"))?;
        let format = FORMATS.into_iter().find(|format| offers(&known, *format));
        let format = format.ok_or_else(|| lacks("an sRGB image format of eight bits"))?;
        let size = size.unwrap_or(runtime.info().eye_size);
        let uses = xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::TRANSFER_SRC;
        let color = EyeChains::new(&session, device, ImageKind { format, size, uses })?;
        // our depth is of one format, and goes along only where the runtime takes it
        let takes_depth =
            instance.exts().khr_composition_layer_depth.is_some() && offers(&known, DEPTH_FORMAT);
        let uses = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let kind = ImageKind { format: DEPTH_FORMAT, size, uses };
        let depth = takes_depth.then(|| color.beside(&session, device, kind)).transpose()?;
        let input = Input::new(runtime, &session)?;
        let mut made = Self {
            views: Vec::new(),
            color,
            depth,
            panel: None,
            hidden: Hidden::default(),
            room,
            head,
            input: Some(input),
            waiter,
            stream,
            session,
            instance,
            device: device.clone(),
            device_waits: runtime.waits.clone(),
            blend,
            format,
            state: State::Idle,
            is_running: false,
        };
        for image in made.color.layered().to_vec() {
            let view = made.view(image)?;
            made.views.push((image, view));
        }
        made.look_for_hidden()?;
        Ok(made)
    }

    /// A view of both layers of an image.
    fn view(&self, image: vk::Image) -> Result<vk::ImageView, Error> {
        let create = vk::ImageViewCreateInfo::default()
            .image(image)
            .format(self.format)
            .view_type(vk::ImageViewType::TYPE_2D_ARRAY)
            .subresource_range(vk::ImageSubresourceRange {
                aspect_mask: vk::ImageAspectFlags::COLOR,
                base_mip_level: 0,
                level_count: 1,
                base_array_layer: 0,
                layer_count: 2,
            });
        // SAFETY: the image belongs to the swapchain, which outlives the view.
        let view = unsafe { self.device.raw.create_image_view(&create, None) };
        Ok(view.map_err(crate::gpu::call("vkCreateImageView"))?)
    }

    /// How long the device and images of the swapchain were waited for so far.
    pub(super) fn waited(&self) -> Duration {
        let depth = self.depth.as_ref().map_or(Duration::ZERO, EyeChains::waited);
        let panel = self.panel.as_ref().map_or(Duration::ZERO, |panel| panel.chain.waited());
        self.color.waited() + depth + panel + self.device_waits.sum()
    }

    /// Pixels of one eye.
    pub(super) fn size(&self) -> [u32; 2] {
        self.color.size()
    }

    /// How both eyes are drawn: one pass needs both in one image.
    pub(super) fn stereo(&self) -> Stereo {
        match self.color {
            EyeChains::Layered(_) => Stereo::Auto,
            EyeChains::Single(_) => Stereo::TwoPasses,
        }
    }

    /// How the display blends pictures with the world behind it.
    pub(super) const fn blend(&self) -> BlendMode {
        self.blend
    }

    /// Whether the runtime takes the depth of frames.
    pub(super) fn takes_depth(&self) -> bool {
        self.depth.is_some()
    }

    /// What the lenses hide.
    pub(super) fn hidden(&mut self) -> &mut Hidden {
        &mut self.hidden
    }

    /// Asks the runtime what the lenses hide.
    fn look_for_hidden(&mut self) -> Result<(), Error> {
        if self.instance.exts().khr_visibility_mask.is_none() {
            return Ok(());
        }
        let kind = xr::VisibilityMaskTypeKHR::HIDDEN_TRIANGLE_MESH;
        let of_eye = |eye| {
            let mask = self.session.get_visibility_mask_khr(STEREO, eye, kind);
            mask.map_err(call("xrGetVisibilityMaskKHR"))
        };
        let masks = [of_eye(0)?, of_eye(1)?];
        self.hidden.set(masks);
        Ok(())
    }

    /// The format of the swapchain's images.
    pub(super) fn format(&self) -> vk::Format {
        self.format
    }

    /// Whether frames are to be waited for.
    pub(super) fn is_running(&self) -> bool {
        self.is_running
    }

    /// Asks the runtime to end the session in good order.
    pub(super) fn request_exit(&self) -> Result<(), Error> {
        self.session.request_exit().map_err(call("xrRequestExitSession"))
    }

    /// What happened since; begins and ends the session as the runtime says.
    pub(super) fn poll(&mut self) -> Result<Vec<Event>, Error> {
        let mut events = Vec::new();
        let mut buffer = xr::EventDataBuffer::new();
        while let Some(event) = self.instance.poll_event(&mut buffer).map_err(call("xrPollEvent"))? {
            match event {
                xr::Event::SessionStateChanged(change) => {
                    let state = change.state();
                    self.change(state)?;
                    events.push(Event::State(self.state));
                }
                xr::Event::InstanceLossPending(_) => return Err(Error::Lost(Loss::Instance)),
                xr::Event::ReferenceSpaceChangePending(_) => events.push(Event::Recentred),
                xr::Event::VisibilityMaskChangedKHR(_) => self.look_for_hidden()?,
                xr::Event::DisplayRefreshRateChangedFB(change) => {
                    events.push(Event::Rate(change.to_display_refresh_rate()));
                }
                _ => {}
            }
        }
        Ok(events)
    }

    fn change(&mut self, state: xr::SessionState) -> Result<(), Error> {
        self.state = match state {
            xr::SessionState::READY => {
                self.session.begin(STEREO).map_err(call("xrBeginSession"))?;
                self.is_running = true;
                State::Ready
            }
            xr::SessionState::SYNCHRONIZED => State::Synchronized,
            xr::SessionState::VISIBLE => State::Visible,
            xr::SessionState::FOCUSED => State::Focused,
            xr::SessionState::STOPPING => {
                self.is_running = false;
                self.session.end().map_err(call("xrEndSession"))?;
                State::Stopping
            }
            xr::SessionState::EXITING => State::Exiting,
            xr::SessionState::LOSS_PENDING => return Err(Error::Lost(Loss::Session)),
            _ => State::Idle,
        };
        Ok(())
    }

    /// Refresh rates on offer, Hz; none where the runtime does not report them.
    pub(super) fn refresh_rates(&self) -> Result<Vec<f32>, Error> {
        if self.instance.exts().fb_display_refresh_rate.is_none() {
            return Ok(Vec::new());
        }
        let known = self.session.enumerate_display_refresh_rates();
        known.map_err(call("xrEnumerateDisplayRefreshRatesFB"))
    }

    /// The display's refresh rate, Hz, where the runtime reports it.
    pub(super) fn refresh_rate(&self) -> Result<Option<f32>, Error> {
        if self.instance.exts().fb_display_refresh_rate.is_none() {
            return Ok(None);
        }
        self.session.get_display_refresh_rate().map(Some).map_err(call("xrGetDisplayRefreshRateFB"))
    }

    /// Asks for one of [`Session::refresh_rates`]; the runtime need not follow.
    pub(super) fn ask_refresh_rate(&self, rate: f32) -> Result<(), Error> {
        self.session.request_display_refresh_rate(rate).map_err(call("xrRequestDisplayRefreshRateFB"))
    }

    /// Waits until it is time for the next frame and begins it.
    pub(super) fn wait(&mut self) -> Result<Frame, Error> {
        let state = self.waiter.wait().map_err(call("xrWaitFrame"))?;
        self.stream.begin().map_err(call("xrBeginFrame"))?;
        let period = u64::try_from(state.predicted_display_period.as_nanos()).unwrap_or(0);
        Ok(Frame {
            display: state.predicted_display_time,
            period: Duration::from_nanos(period),
            wants_image: state.should_render,
        })
    }

    /// Where the eyes will be, in the room; none while the headset does not know where it is.
    pub(super) fn locate(&self, frame: &Frame) -> Result<Option<Eyes>, Error> {
        let (flags, views) =
            self.session.locate_views(STEREO, frame.display, &self.room).map_err(call("xrLocateViews"))?;
        let known = xr::ViewStateFlags::ORIENTATION_VALID | xr::ViewStateFlags::POSITION_VALID;
        let Ok(views) = <[xr::View; 2]>::try_from(views) else { return Ok(None) };
        let poses = views.map(|view| Pose::from_xr(view.pose));
        Ok(match (flags.contains(known), poses) {
            (true, [Some(left), Some(right)]) => {
                Some(Eyes { views, placed: [(left, views[0].fov), (right, views[1].fov)] })
            }
            _ => None,
        })
    }

    /// Where the head will be, in the room.
    pub(super) fn head(&self, frame: &Frame) -> Result<Option<Pose>, Error> {
        let found = self.head.locate(&self.room, frame.display).map_err(call("xrLocateSpace"))?;
        let known = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::POSITION_VALID;
        Ok(found.location_flags.contains(known).then(|| Pose::from_xr(found.pose)).flatten())
    }

    /// What hands and sticks do.
    pub(super) fn read_input(&self, frame: &Frame, active: Active) -> Result<super::input::Reading, Error> {
        match &self.input {
            Some(input) if self.state == State::Focused => {
                input.read(&self.session, &self.room, frame.display, active)
            }
            _ => Ok(super::input::Reading::default()),
        }
    }

    /// Images to draw into.
    pub(super) fn acquire(&mut self) -> Result<Target, Error> {
        let color = self.color.acquire()?;
        let depth = self.depth.as_mut().map(EyeChains::acquire).transpose()?;
        let view = self.views.iter().find(|(image, _)| color.each() == [*image]);
        let view = view.map_or(vk::ImageView::null(), |(_, view)| *view);
        Ok(Target { color, view, depth, is_copied: false })
    }

    /// Gives the images back that were acquired last; they must be in the layouts of attachments.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        self.panel.as_mut().map_or(Ok(()), PanelImages::release)?;
        self.color.release()?;
        self.depth.as_mut().map_or(Ok(()), EyeChains::release)
    }
}

/// The blend mode of frames among those that the runtime offers, best first: opaque, or what the runtime likes best. A
/// display that one can see through has no opaque one.
fn blend(offered: &[BlendMode]) -> Option<BlendMode> {
    let opaque = BlendMode::OPAQUE;
    if offered.contains(&opaque) { Some(opaque) } else { offered.first().copied() }
}

/// Lower-case name of a blend mode.
pub(super) const fn blend_name(mode: BlendMode) -> &'static str {
    match mode {
        BlendMode::OPAQUE => "opaque",
        BlendMode::ADDITIVE => "additive",
        BlendMode::ALPHA_BLEND => "alpha-blend",
        _ => "unknown",
    }
}

/// The space in which the user walks: the floor under them if the runtime knows it.
fn room(session: &xr::Session<xr::Vulkan>) -> Result<xr::Space, Error> {
    let known = session.enumerate_reference_spaces().map_err(call("xrEnumerateReferenceSpaces"))?;
    let local = xr::ReferenceSpaceType::LOCAL;
    let wanted = [xr::ReferenceSpaceType::LOCAL_FLOOR, xr::ReferenceSpaceType::STAGE, local];
    let kind = wanted.into_iter().find(|kind| known.contains(kind)).unwrap_or(local);
    // without a floor: LOCAL begins at the eyes, whose height is then a grown-up's
    let down = if kind == local { -1.6 } else { 0.0 };
    let pose = xr::Posef { position: xr::Vector3f { x: 0.0, y: down, z: 0.0 }, ..xr::Posef::IDENTITY };
    session.create_reference_space(kind, pose).map_err(call("xrCreateReferenceSpace"))
}

impl Drop for Session {
    fn drop(&mut self) {
        // SAFETY: nothing is being drawn: every submission was waited for. Views go before their images.
        unsafe {
            let _ = self.device.raw.device_wait_idle();
            for (_, view) in self.views.drain(..) {
                self.device.raw.destroy_image_view(view, None);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_opaque_wherever_the_runtime_has_that() {
        const OPAQUE: BlendMode = BlendMode::OPAQUE;
        const ADDITIVE: BlendMode = BlendMode::ADDITIVE;
        assert_eq!(blend(&[BlendMode::ALPHA_BLEND, ADDITIVE, OPAQUE]), Some(OPAQUE));
        assert_eq!(blend(&[ADDITIVE, BlendMode::ALPHA_BLEND]), Some(ADDITIVE));
        assert_eq!(blend(&[]), None);
    }
}
