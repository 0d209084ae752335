//! The uniforms of a frame, which all draw shaders share.

use super::Error;
use super::attachments::{eye_passes, passes, shadow_maps};
use super::camera::View;
use super::commands::Commands;
use super::frame::Frame;
use super::settings::Settings;
use super::sun::{self, SunView};
use crate::gpu::{Buffer, Device, Memory};
use crate::kernels::layout::ViewUniforms;
use glam::{Mat4, Vec3, Vec4};
use std::sync::Arc;

/// Side of a cell of the pattern by which near bodies fade, pixels.
const FADE_CELL: f32 = 3.0;

/// A uniform buffer for each eye pass, and after them one for the finer shadow map, where there is one.
pub(super) struct ViewBuffers {
    buffers: Vec<Buffer>,
    eye_passes: usize,
}

impl ViewBuffers {
    pub(super) fn new(device: &Arc<Device>, settings: &Settings) -> Result<Self, Error> {
        let size = size_of::<ViewUniforms>() as u64;
        let buffers = (0..passes(settings)).map(|_| Buffer::new(device, "view", size, Memory::Device));
        Ok(Self { buffers: buffers.collect::<Result<_, _>>()?, eye_passes: eye_passes(settings) as usize })
    }

    /// The passes and their buffers, those of the eyes first.
    pub(super) fn iter(&self) -> impl Iterator<Item = (usize, &Buffer)> {
        self.buffers.iter().enumerate()
    }

    /// Records the update of all buffers. `near_from_world`: to the clip space of the finer shadow map.
    pub(super) fn update(
        &self,
        commands: &Commands<'_>,
        uniforms: &ViewUniforms,
        near_from_world: Option<Mat4>,
    ) {
        for (pass, buffer) in self.iter() {
            let uniforms = match near_from_world.filter(|_| pass >= self.eye_passes) {
                Some(near) => ViewUniforms { shadow_from_world: near.to_cols_array_2d(), ..*uniforms },
                None if self.eye_passes > 1 && pass < self.eye_passes => one_eye(uniforms, pass),
                None => *uniforms,
            };
            let bytes = bytemuck::bytes_of(&uniforms);
            // SAFETY: recording has begun, outside of rendering; the contents are a few hundred bytes, a multiple of
            // four, and fit the buffer.
            unsafe { commands.raw().cmd_update_buffer(commands.buffer, buffer.raw, 0, bytes) };
        }
    }
}

/// The same parameters with one of the eyes as the only one.
fn one_eye(both: &ViewUniforms, eye: usize) -> ViewUniforms {
    ViewUniforms {
        clip_from_world: [both.clip_from_world[eye]; 2],
        world_from_clip: [both.world_from_clip[eye]; 2],
        eyes: [both.eyes[eye]; 2],
        ..*both
    }
}

/// Where and how near bodies fade: both eyes; right, down and ahead, the first two in cells at unit distance.
fn fade(view: &View, settings: &Settings) -> [[f32; 4]; 5] {
    let clip = &view.clip_from_world[0];
    let [x, y, w] = [0, 1, 3].map(|row| clip.row(row).truncate());
    let across = w.length().max(1e-6);
    let ahead = w.try_normalize().unwrap_or(Vec3::Z);
    #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
    let sides = [settings.width as f32, settings.height as f32];
    // without the shift of a skewed projection; half an image is one unit of clip space
    let cells = |row: Vec3, side: f32| {
        let row = row / across;
        (row - ahead * row.dot(ahead)) * (0.5 * side / FADE_CELL)
    };
    let eyes = if view.eye_count == 2 { view.eyes } else { [view.eyes[0]; 2] };
    [eyes[0], eyes[1], cells(x, sides[0]), cells(y, sides[1]), ahead].map(|v| v.extend(0.0).to_array())
}

/// Side of a pixel at a distance of 1 m, or of a parallel projection's at any distance, m.
fn pixel(view: &View, settings: &Settings) -> f32 {
    // half an image is one unit of clip space, which is w times as high
    let row = view.clip_from_world[0].row(1).truncate().length();
    #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
    let rows = settings.height as f32;
    2.0 / (rows * row.max(1e-6))
}

impl Frame<'_> {
    /// The uniforms of both eyes, and the view of the sun, with shadow maps of so many texels a side.
    pub(super) fn uniforms(&self, shadow_size: u32) -> (ViewUniforms, SunView) {
        let (view, meshes) = (self.view, self.crowd.map(|crowd| crowd.meshes));
        let air = &self.settings.atmosphere;
        let sun = air.sun_direction.try_normalize().unwrap_or(Vec3::Y);
        let maps = shadow_maps(self.settings);
        let mut fit = sun::sun_view(view, sun, shadow_size);
        fit.near = fit.near.filter(|_| maps > 1);
        let with = |xyz: Vec3, w: f32| xyz.extend(w).to_array();
        let matrices = |f: &dyn Fn(&Mat4) -> Mat4| view.clip_from_world.map(|m| f(&m).to_cols_array_2d());
        let haze = if view.parallel { 0.0 } else { 1.0 };
        let markers = self.settings.markers.unwrap_or_default();
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let (texels, share) = (shadow_size as f32, 1.0 / maps as f32);
        let near = fit.near.map_or(Vec3::ZERO, |near| near.middle.extend(near.finer));
        let uniforms = ViewUniforms {
            clip_from_world: matrices(&|m| *m),
            world_from_clip: matrices(&Mat4::inverse),
            eyes: view.eyes.map(|eye| with(eye, haze)),
            shadow_from_world: fit.shadow_from_world.to_cols_array_2d(),
            near_shadow: with(near, share),
            sun_direction: with(sun, fit.texel),
            sun_color: with(air.sun, 1.0 / texels),
            sky_zenith: with(air.zenith, 0.0),
            sky_light: with(air.sky_light, 0.0),
            sky_horizon: with(air.horizon, air.haze.max(0.0)),
            ground_bounce: with(air.ground_bounce, air.exposure),
            emotion_colors: markers.colors.map(|color| Vec4::from((color, markers.opacity)).to_array()),
            fade: fade(view, self.settings),
            level_count: meshes.map_or(1, |meshes| meshes.level_count),
            bucket_count: meshes.map_or(0, |meshes| meshes.bucket_count),
            marker_radius: markers.radius,
            marker_width: markers.width,
            far_count: meshes.map_or(0, |meshes| meshes.far_count),
            samples: self.settings.samples,
            quality: self.settings.quality as u32,
            pixel: pixel(view, self.settings),
        };
        (uniforms, fit)
    }
}
