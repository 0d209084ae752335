//! The renderer: what is drawn, into what, in which order.

use super::atmosphere::Atmosphere;
use super::attachments::{
    Attachments, EyeTarget, EyeViews, Part, begin_depth_target, eye_passes, samples, stereo, view_mask,
};
use super::camera::View;
use super::commands::{Commands, Submitter};
use super::crowd::CrowdBuffers;
use super::frame::{self, Frame, Shared};
use super::meshes::{CrowdMeshes, DrawnCrowd, FarLod};
use super::pack::MeshBuffers;
#[cfg(feature = "xr")]
use super::passes::MaskPass;
use super::passes::{
    CrowdPass, EnvironmentPass, FarPass, MarkerPass, OcclusionPass, OcclusionTest, OutsiderPass, ShadowPass,
    SkyPass, UserPass,
};
use super::pipelines::Setup;
use super::settings::{Markers, Settings};
use super::surface::Surface;
use super::target::{COLOR_FORMAT, DEPTH_FORMAT, EyeImages, Format, GpuImage, ImageSpec, ImageUse, Readback};
use super::uniforms::ViewBuffers;
use super::user::User;
use super::{Error, Image};
use crate::gpu::Device;
use ash::vk;
use std::sync::Arc;
use vk::PipelineStageFlags2 as Stage;

/// Images of the caller that a frame is drawn into.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Target {
    /// Where the colour goes.
    pub(crate) color: EyeImages,
    /// A view of all layers of the colour, for frames of one eye pass.
    pub(crate) view: vk::ImageView,
    /// Where the depth goes, if the caller wants it; in the layout of a depth attachment afterwards.
    pub(crate) depth: Option<EyeImages>,
    /// Whether the colour is copied to the host.
    pub(crate) is_copied: bool,
}

/// What a frame is drawn into.
#[derive(Debug, Clone, Copy)]
struct Output {
    color: EyeImages,
    depth: Option<EyeImages>,
    /// What each eye pass draws into.
    eyes: [EyeTarget; 2],
    /// Stage that used the colour last, or that waits for it.
    before: Stage,
    /// How the colour is used next.
    after: ImageUse,
}

/// Draws a crowd and its environment.
pub struct Renderer {
    shadow: ShadowPass,
    #[cfg(feature = "xr")]
    mask: Option<MaskPass>,
    user: UserPass,
    crowd: CrowdPass,
    outsiders: OutsiderPass,
    environment: EnvironmentPass,
    /// Goes before the attachments, which it reads.
    occlusion: Option<OcclusionPass>,
    far: FarPass,
    sky: SkyPass,
    markers: MarkerPass,
    meshes: Option<CrowdMeshes>,
    uniforms: ViewBuffers,
    attachments: Attachments,
    eye_views: EyeViews,
    /// The image of [`Renderer::draw`] and where the host reads it; made when first needed.
    offscreen: Option<(GpuImage, Readback)>,
    /// Where the host reads frames that were drawn into images of the caller; made when first needed.
    #[cfg(any(feature = "xr", feature = "view"))]
    copy: Option<Readback>,
    format: Format,
    settings: Settings,
    submitter: Submitter,
}

impl std::fmt::Debug for Renderer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Renderer").field("settings", &self.settings).finish_non_exhaustive()
    }
}

impl Renderer {
    /// Makes pipelines and images for frames as in `settings`.
    ///
    /// # Errors
    /// When the size is beyond the device, memory is short or a call fails.
    pub fn new(device: &Arc<Device>, settings: Settings) -> Result<Self, Error> {
        Self::with_format(device, settings, COLOR_FORMAT)
    }

    /// Like [`Renderer::new`], for output images of another format (a window's or a headset's).
    pub(crate) fn with_format(
        device: &Arc<Device>,
        settings: Settings,
        color: vk::Format,
    ) -> Result<Self, Error> {
        let format = Format { samples: samples(device, settings.samples), color };
        let largest = device.limits.max_image_dimension2_d.min(16_384);
        let settings = Settings {
            eyes: settings.eyes.clamp(1, 2),
            stereo: stereo(device, &settings),
            samples: format.samples.as_raw(),
            shadow_size: settings.shadow_size.min(largest),
            ..settings
        };
        let attachments = Attachments::new(device, &settings, format)?;
        let setup = setup(device, format, &settings);
        Ok(Self {
            shadow: ShadowPass::new(device, settings.shadow_size)?,
            #[cfg(feature = "xr")]
            mask: None,
            user: UserPass::new(&setup)?,
            crowd: CrowdPass::new(&setup)?,
            outsiders: OutsiderPass::new(&setup)?,
            environment: EnvironmentPass::new(&setup)?,
            occlusion: OcclusionPass::new(device, &settings, &attachments)?,
            far: FarPass::new(&setup)?,
            sky: SkyPass::new(&setup)?,
            markers: MarkerPass::new(&setup)?,
            meshes: None,
            uniforms: ViewBuffers::new(device, eye_passes(&settings))?,
            attachments,
            eye_views: EyeViews::new(device),
            offscreen: None,
            #[cfg(any(feature = "xr", feature = "view"))]
            copy: None,
            format,
            settings,
            submitter: Submitter::new(device)?,
        })
    }

    /// The settings, with what the device could not do changed to what it can.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// The device that draws.
    pub(crate) fn device(&self) -> &Arc<Device> {
        self.submitter.device()
    }

    /// Submits commands to the device that draws.
    #[cfg(feature = "xr")]
    pub(crate) fn submitter(&self) -> &Submitter {
        &self.submitter
    }

    /// Changes sun, sky and haze.
    pub fn set_atmosphere(&mut self, atmosphere: Atmosphere) {
        self.settings.atmosphere = atmosphere;
    }

    /// Changes the rings under the agents.
    pub fn set_markers(&mut self, markers: Option<Markers>) {
        self.settings.markers = markers;
    }

    /// Shows these hands, this aim and this vignette from the next frame on.
    pub fn set_user(&mut self, user: User) {
        self.user.set(user);
    }

    /// Changes the size of the images.
    ///
    /// # Errors
    /// When the size is beyond the device or memory is short; the old size stays then.
    pub fn resize(&mut self, width: u32, height: u32) -> Result<(), Error> {
        let settings = Settings { width, height, ..self.settings };
        let attachments = Attachments::new(self.device(), &settings, self.format)?;
        self.occlusion = OcclusionPass::new(self.device(), &settings, &attachments)?;
        self.attachments = attachments;
        self.eye_views.clear();
        self.offscreen = None;
        #[cfg(any(feature = "xr", feature = "view"))]
        {
            self.copy = None;
        }
        self.settings = settings;
        Ok(())
    }

    /// Replaces the environment; no surfaces, no environment.
    ///
    /// # Errors
    /// When a surface's lists do not fit together, it is larger than the device can bind, or memory is short.
    pub fn set_environment(&mut self, surfaces: &[Surface<'_>]) -> Result<(), Error> {
        self.environment.set(&self.submitter, surfaces)
    }

    /// Takes the indices of the crowd's meshes, their numbers of buckets and levels, and the models of other agents. The
    /// vertices stand in the engine's buffer `mesh_vertices`.
    ///
    /// # Errors
    /// When memory is short.
    pub fn set_meshes(&mut self, meshes: &MeshBuffers) -> Result<(), Error> {
        let made = CrowdMeshes::new(&self.submitter, meshes)?;
        self.outsiders.set(&self.submitter, &meshes.outsiders)?;
        self.meshes = Some(made);
        Ok(())
    }

    /// Leaves these triangles of the eyes' images black: the lenses of a headset hide them. `corners` are in clip space, the left
    /// eye's, then as many of the right one's. An empty list hides nothing.
    ///
    /// # Errors
    /// When memory is short.
    #[cfg(feature = "xr")]
    pub(crate) fn set_mask(&mut self, corners: &[[f32; 4]]) -> Result<(), Error> {
        self.mask = None;
        let setup = setup(self.submitter.device(), self.format, &self.settings);
        self.mask = MaskPass::new(&setup, &self.submitter, corners)?;
        Ok(())
    }

    /// Draws a frame and copies it to the host; with two eyes, the left one stands left of the right one.
    ///
    /// # Errors
    /// When a crowd buffer is too short, memory is short or a call fails.
    pub fn draw(&mut self, view: &View, crowd: Option<&CrowdBuffers<'_>>) -> Result<Image, Error> {
        let image = self.draw_offscreen(view, crowd, true)?;
        image.ok_or(Error::NoBuffer { shader: "draw", binding: "offscreen" })
    }

    /// Like [`Renderer::draw`]; the image is copied to the host only if that is wanted.
    pub(crate) fn draw_offscreen(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        is_copied: bool,
    ) -> Result<Option<Image>, Error> {
        if self.offscreen.is_none() {
            self.offscreen = Some(self.make_offscreen()?);
        }
        let missing = || Error::NoBuffer { shader: "draw", binding: "offscreen" };
        let target = self.offscreen.as_ref().map(|(image, _)| (image.raw, image.view)).ok_or_else(missing)?;
        let color = EyeImages::layered(target.0);
        let target = Target { color, view: target.1, depth: None, is_copied };
        let output = self.output(&target, Stage::COPY, ImageUse::COPY_SOURCE)?;
        let readback = self.offscreen.as_ref().map(|(_, readback)| readback).filter(|_| target.is_copied);
        let frame = self.frame(view, crowd)?;
        self.bind(&frame)?;
        self.submitter.submit(|commands| {
            self.record(commands, &frame, &output)?;
            if let Some(readback) = readback {
                let (images, aspect) = (target.color.each(), vk::ImageAspectFlags::COLOR);
                readback.copy(commands.raw(), commands.buffer, images, aspect);
            }
            Ok(())
        })?;
        Ok(readback.map(|readback| self.assemble(readback.bytes())))
    }

    /// Draws into images of the caller. The colour is left in the layout of a colour attachment, and copied to the host if
    /// that is wanted. What `before` records comes first, in the same submission.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(crate) fn draw_into(
        &mut self,
        view: &View,
        crowd: Option<&CrowdBuffers<'_>>,
        target: &Target,
        before: impl FnOnce(vk::CommandBuffer) -> Result<(), Error>,
    ) -> Result<Option<Image>, Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        if target.is_copied && self.copy.is_none() {
            self.copy = Some(Readback::new(self.device(), "frame readback", [width, height], eyes)?);
        }
        let (drawn, copied) = (ImageUse::COLOR_WRITTEN, ImageUse::COPY_SOURCE);
        let after = if target.is_copied { copied } else { drawn };
        let output = self.output(target, Stage::COLOR_ATTACHMENT_OUTPUT, after)?;
        let readback = self.copy.as_ref().filter(|_| target.is_copied);
        let frame = self.frame(view, crowd)?;
        self.bind(&frame)?;
        self.submitter.submit(|commands| {
            before(commands.buffer)?;
            self.record(commands, &frame, &output)?;
            if let Some(readback) = readback {
                let aspect = vk::ImageAspectFlags::COLOR;
                readback.copy(commands.raw(), commands.buffer, target.color.each(), aspect);
                commands.transition(&target.color.transitions(aspect, copied, drawn));
            }
            Ok(())
        })?;
        Ok(readback.map(|readback| self.assemble(readback.bytes())))
    }

    fn make_offscreen(&self) -> Result<(GpuImage, Readback), Error> {
        let Settings { width, height, eyes, .. } = self.settings;
        let (size, usage) = ([width, height], vk::ImageUsageFlags::COLOR_ATTACHMENT);
        let spec = ImageSpec { layers: eyes, usage, ..ImageSpec::flat("offscreen", size, self.format.color) };
        let image = GpuImage::readable(self.device(), spec)?;
        Ok((image, Readback::new(self.device(), "offscreen readback", size, eyes)?))
    }

    /// What each eye pass draws into, of the images of a target.
    fn output(&mut self, target: &Target, before: Stage, after: ImageUse) -> Result<Output, Error> {
        let Target { color, view, depth, .. } = *target;
        let colors = match eye_passes(&self.settings) {
            1 => [view; 2],
            _ => self.eye_views.of(color, self.format.color, &self.settings)?,
        };
        let depths = match depth {
            Some(depth) => self.eye_views.of(depth, DEPTH_FORMAT, &self.settings)?.map(Some),
            None => [None; 2],
        };
        let eyes = [0, 1].map(|eye| EyeTarget { color: colors[eye], depth: depths[eye] });
        Ok(Output { color, depth, eyes, before, after })
    }

    /// The first eye pass of a frame.
    fn frame<'a>(&'a self, view: &'a View, crowd: Option<&'a CrowdBuffers<'a>>) -> Result<Frame<'a>, Error> {
        let crowd = crowd.zip(self.meshes.as_ref());
        let crowd = crowd.map(|(buffers, meshes)| DrawnCrowd::new(buffers, meshes)).transpose()?;
        Ok(Frame { view, settings: &self.settings, crowd, eye_pass: 0 })
    }

    /// Fills the descriptor sets. They must not be in use by the device.
    fn bind(&self, frame: &Frame<'_>) -> Result<(), Error> {
        if let Some(occlusion) = &self.occlusion {
            occlusion.bind(frame)?;
        }
        for (eye_pass, view) in self.uniforms.iter() {
            let shared = Shared { view, shadow: &self.shadow, crowd: frame.crowd };
            #[cfg(feature = "xr")]
            if let Some(mask) = &self.mask {
                mask.bind(eye_pass)?;
            }
            self.user.bind(eye_pass, &shared)?;
            self.crowd.bind(eye_pass, &shared)?;
            self.outsiders.bind(eye_pass, &shared)?;
            self.environment.bind(eye_pass, &shared)?;
            self.far.bind(eye_pass, &shared)?;
            self.sky.bind(eye_pass, &shared)?;
            self.markers.bind(&Frame { eye_pass, ..*frame }, &shared)?;
        }
        Ok(())
    }

    /// Records a frame. [`Renderer::bind`] stands before it, with the same frame.
    fn record(&self, commands: &Commands<'_>, frame: &Frame<'_>, output: &Output) -> Result<(), Error> {
        let [from, to] = frame::BEFORE;
        commands.barrier(from, to);
        self.uniforms.update(commands, &frame.uniforms(self.shadow.size()));
        self.user.update(commands);
        let [from, to] = frame::UNIFORMS;
        commands.barrier(from, to);
        self.shadow.record(commands, || {
            self.environment.record_shadow(commands);
            self.crowd.record_shadow(frame, commands);
            self.outsiders.record_shadow(frame, commands);
            self.far.record_shadow(frame, commands);
        });
        let drawn = ImageUse::COLOR_WRITTEN;
        let stages = output.before | drawn.stages;
        let aspect = vk::ImageAspectFlags::COLOR;
        let from = ImageUse { stages, layout: vk::ImageLayout::UNDEFINED, ..drawn };
        commands.transition(&output.color.transitions(aspect, from, ImageUse::COLOR_ATTACHMENT));
        if let Some(depth) = output.depth {
            begin_depth_target(commands, depth);
        }
        for ((eye_pass, _), target) in self.uniforms.iter().zip(output.eyes) {
            let frame = Frame { eye_pass, ..*frame };
            commands.labelled(c"gaitway.frame", || self.record_eye_pass(commands, &frame, target))?;
        }
        commands.transition(&output.color.transitions(aspect, drawn, output.after));
        let [from, to] = frame::AFTER;
        commands.barrier(from, to);
        Ok(())
    }

    /// Records one eye pass, from near to far: what is near hides what is far before its pixels are shaded.
    fn record_eye_pass(
        &self,
        commands: &Commands<'_>,
        frame: &Frame<'_>,
        target: EyeTarget,
    ) -> Result<(), Error> {
        let eye_pass = frame.eye_pass;
        self.attachments.begin(commands);
        let near = || {
            #[cfg(feature = "xr")]
            if let Some(mask) = &self.mask {
                mask.record(commands, eye_pass);
            }
            self.user.record_solids(commands, eye_pass);
            self.crowd.record(frame, commands);
            self.outsiders.record(frame, commands);
            self.environment.record(commands, eye_pass);
        };
        let last = || {
            self.sky.record(commands, eye_pass);
            self.markers.record(frame, commands);
            self.user.record_overlays(commands, eye_pass);
        };
        let part = |is_first, is_last, draw: &dyn Fn()| {
            self.attachments.part(commands, target, Part { is_first, is_last }, draw);
        };
        let Some(test) = self.occlusion_test(frame, target) else {
            part(true, true, &|| {
                near();
                self.far.record(frame, commands);
                last();
            });
            return Ok(());
        };
        part(true, false, &near);
        test.record(frame, commands, FarLod::Lod3)?;
        part(false, false, &|| self.far.record_unoccluded(frame, commands, FarLod::Lod3));
        test.record(frame, commands, FarLod::Lod4)?;
        part(false, true, &|| {
            self.far.record_unoccluded(frame, commands, FarLod::Lod4);
            last();
        });
        Ok(())
    }

    /// The occlusion test of an eye pass. The caller's image for depth is written by the last part only, so the test
    /// needs depth of our own: that of several samples.
    fn occlusion_test<'a>(&'a self, frame: &Frame<'a>, target: EyeTarget) -> Option<OcclusionTest<'a>> {
        let keeps_depth = target.depth.is_none() || self.attachments.is_multisampled();
        self.occlusion.as_ref()?.test(frame, &self.attachments, keeps_depth)
    }

    /// Puts the eyes' images side by side.
    fn assemble(&self, bytes: &[u8]) -> Image {
        let Settings { width, height, eyes, .. } = self.settings;
        let one = width as usize * height as usize * 4;
        let mut eye_images = bytes.chunks_exact(one).take(eyes as usize).map(|pixels| Image {
            width,
            height,
            pixels: pixels.to_vec(),
        });
        if eyes == 1 {
            return eye_images.next().unwrap_or_else(|| Image::filled(width, height, [0; 4]));
        }
        let mut both = Image::filled(width * eyes, height, [0; 4]);
        for (eye, image) in (0_u32..).zip(eye_images) {
            both.blit(&image, eye * width, 0);
        }
        both
    }
}

/// What the pipelines of all passes have in common.
fn setup<'a>(device: &'a Arc<Device>, format: Format, settings: &Settings) -> Setup<'a> {
    Setup { device, format, view_mask: view_mask(settings), eye_passes: eye_passes(settings) }
}
