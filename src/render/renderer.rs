//! The renderer: what is drawn, into what, in which order.

use super::Error;
use super::atmosphere::Atmosphere;
use super::attachments::{
    Attachments, EyeTarget, EyeViews, Part, begin_depth_target, draws, end_depth_target, eye_passes,
    occlusion, passes, samples, shadow_maps, stereo, view_mask,
};
use super::camera::View;
use super::commands::{Commands, Submitter};
use super::crowd::CrowdBuffers;
use super::direct::DirectDraws;
use super::flight::Flights;
use super::frame::{self, Frame, Shared};
use super::meshes::{CrowdMeshes, DrawnCrowd, FarLod};
use super::pack::MeshBuffers;
#[cfg(feature = "xr")]
use super::passes::MaskPass;
use super::passes::{
    ContactPass, CrowdPass, EnvironmentPass, FarPass, MarkerPass, OcclusionPass, OcclusionTest, OutsiderPass,
    PaintedPass, PlacePass, ShadowPass, SkyPass, SunMap, UserPass,
};
use super::pipelines::{SetIndex, Setup};
use super::settings::{Markers, Quality, Settings};
use super::submit::Output;
use super::surface::{Surface, surface};
use super::target::{COLOR_FORMAT, Format, GpuImage, ImageUse, Readback};
use super::uniforms::ViewBuffers;
use super::user::User;
use crate::avatar::PlaceModel;
use crate::gpu::{Device, Draws};
use crate::scenario::EnvironmentMesh;
use ash::vk;
use std::sync::Arc;

/// Draws a crowd and its environment.
pub struct Renderer {
    shadow: ShadowPass,
    #[cfg(feature = "xr")]
    mask: Option<MaskPass>,
    user: UserPass,
    crowd: CrowdPass,
    /// For characters with textures, if there are any.
    painted: Option<PaintedPass>,
    outsiders: OutsiderPass,
    environment: EnvironmentPass,
    /// The user's own place, if there is one.
    place: Option<PlacePass>,
    /// Goes before the attachments, which it reads.
    occlusion: Option<OcclusionPass>,
    far: FarPass,
    sky: SkyPass,
    /// At medium and high quality.
    contact: Option<ContactPass>,
    markers: MarkerPass,
    pub(super) meshes: Option<CrowdMeshes>,
    /// Distance from the eyes at which the third level of bodies with a pose begins, m.
    pub(super) third_begins: f32,
    /// How the crowd is drawn directly, where it is.
    pub(super) direct: Option<DirectDraws>,
    uniforms: ViewBuffers,
    attachments: Attachments,
    pub(super) eye_views: EyeViews,
    /// The image of [`Renderer::draw`] and where the host reads it; made when first needed.
    pub(super) offscreen: Option<(GpuImage, Readback)>,
    /// Where the host reads frames that were drawn into images of the caller; made when first needed.
    #[cfg(any(feature = "xr", feature = "view"))]
    pub(super) copy: Option<Readback>,
    pub(super) format: Format,
    pub(super) settings: Settings,
    submitter: Submitter,
    /// Frames that the device may still draw; `drop` waits for them before anything else goes.
    pub(super) flights: Flights,
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
            occlusion: occlusion(device, &settings),
            draws: draws(device, &settings),
            samples: format.samples.as_raw(),
            shadow_size: settings.shadow_size.min(largest / shadow_maps(&settings)),
            ..settings
        };
        let attachments = Attachments::new(device, &settings, format)?;
        let setup = setup(device, format, &settings);
        Ok(Self {
            shadow: ShadowPass::new(device, settings.shadow_size, shadow_maps(&settings))?,
            #[cfg(feature = "xr")]
            mask: None,
            user: UserPass::new(&setup)?,
            crowd: CrowdPass::new(&setup)?,
            painted: None,
            outsiders: OutsiderPass::new(&setup)?,
            environment: EnvironmentPass::new(&setup)?,
            place: None,
            occlusion: OcclusionPass::new(device, &settings, &attachments)?,
            far: FarPass::new(&setup)?,
            sky: SkyPass::new(&setup)?,
            contact: (settings.quality > Quality::Low).then(|| ContactPass::new(&setup)).transpose()?,
            markers: MarkerPass::new(&setup)?,
            meshes: None,
            third_begins: 0.0,
            direct: None,
            uniforms: ViewBuffers::new(device, &settings)?,
            attachments,
            eye_views: EyeViews::new(device),
            offscreen: None,
            #[cfg(any(feature = "xr", feature = "view"))]
            copy: None,
            format,
            settings,
            submitter: Submitter::new(device)?,
            flights: Flights::new(device)?,
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
    pub(super) fn submitter(&self) -> &Submitter {
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

    /// Forgets the caller's images that were drawn into. They are going, and were waited for.
    #[cfg(feature = "xr")]
    pub(super) fn forget_images(&mut self) {
        self.eye_views.clear();
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
        self.flights.wait_all()?;
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

    /// Draws frames of this size from now on, at most of that which the renderer was made for or changed to: into the first rows
    /// and columns of images that are as large as that.
    #[cfg(feature = "xr")]
    pub(crate) fn set_drawn_size(&mut self, [width, height]: [u32; 2]) {
        let [most_columns, most_rows] = self.attachments.size;
        self.settings.width = width.clamp(1, most_columns);
        self.settings.height = height.clamp(1, most_rows);
    }

    /// Replaces the environment; no surfaces, no environment.
    ///
    /// # Errors
    /// When a surface's lists do not fit together, it is larger than the device can bind, or memory is short.
    pub fn set_environment(&mut self, surfaces: &[Surface<'_>]) -> Result<(), Error> {
        self.flights.wait_all()?;
        self.environment.set(&self.submitter, surfaces, self.settings.atmosphere.lamps, (&[], &[]))
    }

    /// Replaces the environment by that of a scene.
    ///
    /// # Errors
    /// As [`Self::set_environment`].
    pub(super) fn set_scenery(&mut self, scenery: &EnvironmentMesh) -> Result<(), Error> {
        self.flights.wait_all()?;
        let far = (&scenery.far_indices[..], &scenery.distant[..]);
        self.environment.set(&self.submitter, &[surface(scenery)], self.settings.atmosphere.lamps, far)
    }

    /// Replaces the place that is drawn with the environment; none: there is none.
    ///
    /// # Errors
    /// When an index points past the vertices, there are more textures than the device takes, or memory is short.
    #[doc(hidden)]
    pub fn set_place(&mut self, place: Option<&PlaceModel>) -> Result<(), Error> {
        self.flights.wait_all()?;
        self.place = None;
        let setup = setup(self.submitter.device(), self.format, &self.settings);
        self.place = place.map(|model| PlacePass::new(&setup, &self.submitter, model)).transpose()?;
        Ok(())
    }

    /// Takes the indices of the crowd's meshes, their numbers of buckets and levels, their textures, and the models of other agents.
    /// The vertices stand in the engine's buffer `mesh_vertices`.
    ///
    /// # Errors
    /// When there are more textures than the device takes, or memory is short.
    pub fn set_meshes(&mut self, meshes: &MeshBuffers) -> Result<(), Error> {
        self.flights.wait_all()?;
        let made = CrowdMeshes::new(&self.submitter, meshes)?;
        let is_direct = self.settings.draws == Draws::Direct;
        let buckets = made.bucket_count + made.far_count;
        self.direct = is_direct.then(|| DirectDraws::new(self.device(), buckets)).transpose()?;
        self.outsiders.set(&self.submitter, &meshes.outsiders)?;
        self.painted = None;
        let setup = setup(self.submitter.device(), self.format, &self.settings);
        let paint = meshes.paint.as_ref();
        self.painted = paint.map(|paint| PaintedPass::new(&setup, &self.submitter, paint)).transpose()?;
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
        self.flights.wait_all()?;
        if self.mask.is_none() {
            let setup = setup(self.submitter.device(), self.format, &self.settings);
            self.mask = Some(MaskPass::new(&setup)?);
        }
        self.mask.as_mut().map_or(Ok(()), |mask| mask.set(&self.submitter, corners))
    }

    /// The first eye pass of a frame.
    pub(super) fn frame<'a>(
        &'a self,
        view: &'a View,
        crowd: Option<&'a CrowdBuffers<'a>>,
    ) -> Result<Frame<'a>, Error> {
        let crowd = crowd.zip(self.meshes.as_ref());
        let crowd = crowd.map(|(buffers, meshes)| DrawnCrowd::new(buffers, meshes)).transpose()?;
        Ok(Frame { view, settings: &self.settings, crowd, third_begins: self.third_begins, eye_pass: 0 })
    }

    /// Fills the descriptor sets of a slot, whose frame was waited for.
    pub(super) fn bind(&self, slot: usize, frame: &Frame<'_>) -> Result<(), Error> {
        if let Some(occlusion) = &self.occlusion {
            occlusion.bind(slot, frame)?;
        }
        for (pass, view) in self.uniforms.iter() {
            let shared = Shared { view, shadow: &self.shadow, crowd: frame.crowd };
            let index = SetIndex { slot, pass };
            #[cfg(feature = "xr")]
            if let Some(mask) = &self.mask {
                mask.bind(index)?;
            }
            self.user.bind(index, &shared)?;
            self.crowd.bind(index, &shared)?;
            if let Some(painted) = &self.painted {
                painted.bind(index, &shared)?;
            }
            self.outsiders.bind(index, &shared)?;
            self.environment.bind(index, &shared)?;
            if let Some(place) = &self.place {
                place.bind(index, &shared)?;
            }
            self.far.bind(index, &shared)?;
            self.sky.bind(index, &shared)?;
            if let Some(contact) = &self.contact {
                contact.bind(index, &shared)?;
            }
            self.markers.bind(index, frame, &shared)?;
        }
        Ok(())
    }

    /// Records a frame. [`Renderer::bind`] stands before it, with the same frame.
    pub(super) fn record(
        &self,
        commands: &Commands<'_>,
        frame: &Frame<'_>,
        output: &Output,
    ) -> Result<(), Error> {
        let [from, to] = frame::BEFORE;
        commands.barrier(from, to);
        let (uniforms, sun) = frame.uniforms(self.shadow.size());
        let near = sun.near_from_world().zip(sun.near);
        self.uniforms.update(commands, &uniforms, near.map(|(shadow_from_world, _)| shadow_from_world));
        self.user.update(commands);
        let [from, to] = frame::UNIFORMS;
        commands.barrier(from, to);
        let whole = SunMap { shadow_from_world: sun.shadow_from_world, pass: 0, near: None };
        let eye_passes = eye_passes(&self.settings) as usize;
        let near = near.map(|(shadow_from_world, near)| SunMap {
            shadow_from_world,
            pass: eye_passes,
            near: Some(near.casters),
        });
        let maps: Vec<SunMap> = std::iter::once(whole).chain(near).collect();
        self.shadow.record(commands, &maps, |map| {
            self.environment.record_shadow(frame, commands, map);
            if let Some(place) = &self.place {
                place.record_shadow(commands, map);
            }
            self.crowd.record_shadow(frame, commands, map);
            self.outsiders.record_shadow(frame, commands, map);
            if map.near.is_none() {
                self.far.record_shadow(frame, commands);
            }
        });
        let drawn = ImageUse::COLOR_WRITTEN;
        let stages = output.before | drawn.stages;
        let aspect = vk::ImageAspectFlags::COLOR;
        let from = ImageUse { stages, layout: vk::ImageLayout::UNDEFINED, ..drawn };
        commands.transition(&output.color.transitions(aspect, from, ImageUse::COLOR_ATTACHMENT));
        if let Some(depth) = output.depth {
            begin_depth_target(commands, depth);
        }
        for (eye_pass, target) in output.eyes.into_iter().enumerate().take(eye_passes) {
            let frame = Frame { eye_pass, ..*frame };
            commands.labelled(c"gaitway.frame", || self.record_eye_pass(commands, &frame, target))?;
        }
        commands.transition(&output.color.transitions(aspect, drawn, output.after));
        if let Some(depth) = output.depth {
            end_depth_target(commands, depth);
        }
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
            if let Some(painted) = &self.painted {
                painted.record(frame, commands);
            }
            self.outsiders.record(frame, commands);
            self.environment.record(frame, commands);
            if let Some(place) = &self.place {
                place.record(frame, commands);
            }
        };
        let last = || {
            if let Some(contact) = &self.contact {
                contact.record(frame, commands);
            }
            self.sky.record(commands, eye_pass);
            self.markers.record(frame, commands);
            self.user.record_overlays(commands, eye_pass);
        };
        let part = |is_first, is_last, draw: &dyn Fn()| {
            let part = Part { is_first, is_last };
            self.attachments.part(commands, target, frame.area(), part, draw);
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
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // what frames in flight use goes after them; on a lost device nothing is in use
        let _ = self.flights.wait_all();
    }
}

/// What the pipelines of all passes have in common.
fn setup<'a>(device: &'a Arc<Device>, format: Format, settings: &Settings) -> Setup<'a> {
    let (view_mask, passes) = (view_mask(settings), passes(settings));
    Setup { device, format, view_mask, passes, quality: settings.quality }
}
