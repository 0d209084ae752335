//! What the shaders are told about a picture.

use super::camera::View;
use super::renderer::Renderer;
use super::shadow;
use crate::kernels::layout::ViewUniforms;
use glam::{Mat4, Vec3, Vec4};

/// Side of a cell of the pattern by which near bodies fade, pixels.
const FADE_CELL: f32 = 3.0;

impl Renderer {
    /// From where and how near bodies fade: both eyes; right, down and ahead, the first two in cells at unit distance.
    fn fade(&self, view: &View) -> [[f32; 4]; 5] {
        let clip = &view.clip_from_world[0];
        let [x, y, w] = [0, 1, 3].map(|row| clip.row(row).truncate());
        let across = w.length().max(1e-6);
        let ahead = w.try_normalize().unwrap_or(Vec3::Z);
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let sides = [self.settings.width as f32, self.settings.height as f32];
        // without the shift of a skewed projection; half a picture is one unit of clip space
        let cells = |row: Vec3, side: f32| {
            let row = row / across;
            (row - ahead * row.dot(ahead)) * (0.5 * side / FADE_CELL)
        };
        let eyes = if view.eye_count == 2 { view.eyes } else { [view.eyes[0]; 2] };
        [eyes[0], eyes[1], cells(x, sides[0]), cells(y, sides[1]), ahead].map(|v| v.extend(0.0).to_array())
    }

    /// What the shaders need to know about this picture.
    pub(crate) fn view_uniforms(&self, view: &View) -> ViewUniforms {
        let air = &self.settings.atmosphere;
        let sun = air.sun_direction.try_normalize().unwrap_or(Vec3::Y);
        let fit = shadow::sun_view(view, sun, self.shadow_size);
        let with = |xyz: Vec3, w: f32| xyz.extend(w).to_array();
        let matrices = |f: &dyn Fn(&Mat4) -> Mat4| view.clip_from_world.map(|m| f(&m).to_cols_array_2d());
        let haze = if view.parallel { 0.0 } else { 1.0 };
        let markers = self.settings.markers.unwrap_or_default();
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let texels = self.shadow_size as f32;
        ViewUniforms {
            clip_from_world: matrices(&|m| *m),
            world_from_clip: matrices(&Mat4::inverse),
            eyes: view.eyes.map(|eye| with(eye, haze)),
            shadow_from_world: fit.shadow_from_world.to_cols_array_2d(),
            sun_direction: with(sun, fit.texel),
            sun_color: with(air.sun, 1.0 / texels),
            sky_zenith: with(air.zenith, 0.0),
            sky_light: with(air.sky_light, 0.0),
            sky_horizon: with(air.horizon, air.haze.max(0.0)),
            ground_bounce: with(air.ground_bounce, air.exposure),
            emotion_colors: markers.colors.map(|color| Vec4::from((color, markers.opacity)).to_array()),
            fade: self.fade(view),
            level_count: self.meshes.as_ref().map_or(1, |meshes| meshes.level_count),
            bucket_count: self.meshes.as_ref().map_or(0, |meshes| meshes.bucket_count),
            marker_radius: markers.radius,
            marker_width: markers.width,
            far_count: self.meshes.as_ref().map_or(0, |meshes| meshes.far_count),
            samples: self.settings.samples,
            ..ViewUniforms::default()
        }
    }
}
