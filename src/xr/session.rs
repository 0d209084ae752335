//! One session with the headset: its swapchain, its spaces and its frame loop, in the order that OpenXR demands.
//!
//! `wait` (xrWaitFrame, xrBeginFrame) is always followed by `end` (xrEndFrame), with or without an image. Where the
//! safe wrapper loses a success code that matters (a timeout, a loss that is pending) the raw call is made instead.

use super::error::{Error, Loss, call, check};
use super::hidden::Hidden;
use super::input::Input;
use super::runtime::{Runtime, STEREO, handle};
use super::swapchain::Swapchain;
use super::views::{NEAR, Pose};
use super::watch::DeviceWaits;
use crate::gpu::Device;
use crate::render::{DEPTH_FORMAT, Target};
use ash::vk;
use openxr as xr;
use std::sync::Arc;
use std::time::Duration;

/// Formats that images may have, best first: all with the sRGB curve, since shaders write linear light.
const FORMATS: [vk::Format; 2] = [vk::Format::R8G8B8A8_SRGB, vk::Format::B8G8R8A8_SRGB];

/// Where a session stands.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum State {
    /// Not begun.
    Idle,
    /// May begin.
    Ready,
    /// Frames are in step, nothing is seen.
    Synchronized,
    /// Seen, but another application has the input.
    Visible,
    /// Seen, with input.
    Focused,
    /// Shall end.
    Stopping,
    /// Is over, as requested.
    Exiting,
}

impl State {
    /// Lower-case name.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Idle => "idle",
            Self::Ready => "ready",
            Self::Synchronized => "synchronized",
            Self::Visible => "visible",
            Self::Focused => "focused",
            Self::Stopping => "stopping",
            Self::Exiting => "exiting",
        }
    }
}

/// What happened since the last look.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Event {
    /// A new state.
    State(State),
    /// The user has recentred the view.
    Recentred,
    /// The display's refresh rate is another one now, Hz.
    Rate(f32),
}

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
    views: [xr::View; 2],
    pub(super) placed: [(Pose, xr::Fovf); 2],
}

/// A session; dropping it ends it and gives everything back.
pub(super) struct Session {
    // In the order in which they must go: views of images, swapchains, spaces, the session itself.
    /// Images of the swapchain to draw into: layer 0 is the left eye, layer 1 the right one.
    targets: Vec<Target>,
    color: Swapchain,
    depth: Option<Swapchain>,
    hidden: Hidden,
    room: xr::Space,
    head: xr::Space,
    pub(super) input: Option<Input>,
    waiter: xr::FrameWaiter,
    stream: xr::FrameStream<xr::Vulkan>,
    session: xr::Session<xr::Vulkan>,
    instance: xr::Instance,
    device: Arc<Device>,
    device_waits: DeviceWaits,
    blend: xr::EnvironmentBlendMode,
    format: vk::Format,
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
        let blend = *instance
            .enumerate_environment_blend_modes(runtime.system, STEREO)
            .map_err(call("xrEnumerateEnvironmentBlendModes"))?
            .first()
            .unwrap_or(&xr::EnvironmentBlendMode::OPAQUE);
        let room = room(&session)?;
        let head = session
            .create_reference_space(xr::ReferenceSpaceType::VIEW, xr::Posef::IDENTITY)
            .map_err(call("xrCreateReferenceSpace"))?;
        let known = session.enumerate_swapchain_formats().map_err(call("xrEnumerateSwapchainFormats"))?;
        let format = FORMATS.into_iter().find(|format| offers(&known, *format));
        let format = format.ok_or_else(|| Error::Lacks {
            runtime: runtime.info().runtime.clone(),
            what: "an sRGB image format of eight bits".to_owned(),
        })?;
        let size = size.unwrap_or(runtime.info().eye_size);
        let uses = xr::SwapchainUsageFlags::COLOR_ATTACHMENT | xr::SwapchainUsageFlags::TRANSFER_SRC;
        let color = Swapchain::new(&session, device, format, size, uses)?;
        // our depth is of one format, and goes along only where the runtime takes it
        let takes_depth =
            instance.exts().khr_composition_layer_depth.is_some() && offers(&known, DEPTH_FORMAT);
        let uses = xr::SwapchainUsageFlags::DEPTH_STENCIL_ATTACHMENT;
        let depth =
            takes_depth.then(|| Swapchain::new(&session, device, DEPTH_FORMAT, size, uses)).transpose()?;
        let input = Input::new(&instance, runtime.system, &session)?;
        let mut made = Self {
            targets: Vec::new(),
            color,
            depth,
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
        for image in made.color.images().to_vec() {
            let target = made.target(image)?;
            made.targets.push(target);
        }
        made.look_for_hidden()?;
        Ok(made)
    }

    fn target(&self, image: vk::Image) -> Result<Target, Error> {
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
        let view = unsafe { self.device.raw.create_image_view(&create, None) }
            .map_err(crate::gpu::call("vkCreateImageView"))?;
        Ok(Target { image, view, depth: None, is_copied: false })
    }

    /// How long the device and images of the swapchain were waited for so far.
    pub(super) fn waited(&self) -> Duration {
        let depth = self.depth.as_ref().map_or(Duration::ZERO, |depth| depth.waited);
        self.color.waited + depth + self.device_waits.sum()
    }

    /// Pixels of one eye.
    pub(super) fn size(&self) -> [u32; 2] {
        self.color.size()
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
    pub(super) fn read_input(&self, frame: &Frame) -> Result<super::input::Reading, Error> {
        match &self.input {
            Some(input) if self.state == State::Focused => {
                input.read(&self.session, &self.room, frame.display)
            }
            _ => Ok(super::input::Reading::default()),
        }
    }

    /// An image to draw into.
    pub(super) fn acquire(&mut self) -> Result<Target, Error> {
        let index = self.color.acquire()?;
        let depth = match &mut self.depth {
            Some(depth) => {
                let index = depth.acquire()?;
                depth.images().get(index).copied()
            }
            None => None,
        };
        let fault = xr::sys::Result::ERROR_RUNTIME_FAILURE;
        let target = self.targets.get(index).map(|target| Target { depth, ..*target });
        target.ok_or(Error::Call { call: "xrAcquireSwapchainImage", result: fault })
    }

    /// Gives the images back that were acquired last; they must be in the layouts of attachments.
    pub(super) fn release(&mut self) -> Result<(), Error> {
        self.color.release()?;
        self.depth.as_mut().map_or(Ok(()), Swapchain::release)
    }

    /// Ends the frame: with the image that was drawn for these eyes, or without one.
    pub(super) fn end(&mut self, frame: Frame, eyes: Option<&Eyes>) -> Result<(), Error> {
        let _queue = self.device.hold_queue();
        // depth is reversed and has no end: 0 is infinitely far, 1 as near as is drawn
        let depths = self.depth.as_ref().map(|depth| {
            [0, 1].map(|eye| xr::sys::CompositionLayerDepthInfoKHR {
                ty: xr::sys::CompositionLayerDepthInfoKHR::TYPE,
                next: std::ptr::null(),
                sub_image: depth.of_eye(eye),
                min_depth: 0.0,
                max_depth: 1.0,
                near_z: f32::INFINITY,
                far_z: NEAR,
            })
        });
        let depth_of =
            |eye: usize| depths.as_ref().map_or(std::ptr::null(), |depths| (&raw const depths[eye]).cast());
        let views = |eyes: &Eyes| {
            [0, 1].map(|eye: u8| xr::sys::CompositionLayerProjectionView {
                ty: xr::sys::CompositionLayerProjectionView::TYPE,
                next: depth_of(usize::from(eye)),
                pose: eyes.views[usize::from(eye)].pose,
                fov: eyes.views[usize::from(eye)].fov,
                sub_image: self.color.of_eye(u32::from(eye)),
            })
        };
        let views = eyes.map(views);
        let layer = views.as_ref().map(|views| xr::sys::CompositionLayerProjection {
            ty: xr::sys::CompositionLayerProjection::TYPE,
            next: std::ptr::null(),
            layer_flags: xr::CompositionLayerFlags::EMPTY,
            space: self.room.as_raw(),
            view_count: 2,
            views: views.as_ptr(),
        });
        let layers = [layer.as_ref().map_or(std::ptr::null(), |layer| (&raw const *layer).cast())];
        let info = xr::sys::FrameEndInfo {
            ty: xr::sys::FrameEndInfo::TYPE,
            next: std::ptr::null(),
            display_time: frame.display,
            environment_blend_mode: self.blend,
            layer_count: u32::from(layer.is_some()),
            layers: layers.as_ptr(),
        };
        // SAFETY: the frame was begun; everything `info` points to lives until the call returns.
        check("xrEndFrame", unsafe { (self.instance.fp().end_frame)(self.session.as_raw(), &raw const info) })
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
            for target in self.targets.drain(..) {
                self.device.raw.destroy_image_view(target.view, None);
            }
        }
    }
}
