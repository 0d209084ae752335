//! Where the sun looks: the part of the ground that the view shows, from the sun's direction.

use super::camera::View;
use glam::camera::rh::{proj::vulkan, view::look_at_mat4};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// Shadows reach this far from an eye near the ground, m.
const REACH: f32 = 35.0;
/// Bounds of the radius of the shadow map on the ground, m.
const RADIUS: (f32, f32) = (6.0, 250.0);
/// Half the depth of the shadow map along the sun's rays, m: what stands farther towards the sun casts no shadow.
const DEPTH: f32 = 200.0;

/// The sun's view of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SunView {
    /// World to the shadow map's clip space; depth 1 nearest to the sun.
    pub(crate) shadow_from_world: Mat4,
    /// Side of one texel, m.
    pub(crate) texel: f32,
}

/// Fits the shadow map of `size` texels to what `view` shows of the ground.
///
/// `sun` is the unit direction towards the sun. Radius and middle move in steps of texels, so that edges of shadows do
/// not crawl when the camera moves.
pub(crate) fn sun_view(view: &View, sun: Vec3, size: u32) -> SunView {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for eye in 0..view.eye_count.clamp(1, 2) as usize {
        for corner in [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::ONE] {
            let near = view.clip_from_world[eye].inverse() * Vec4::new(corner.x, corner.y, 1.0, 1.0);
            let start = near.truncate() / near.w;
            let ray = view.ray(eye, corner);
            let reach = REACH.max(3.0 * start.y);
            // as far as the ground, or as far as shadows reach
            let length = if ray.y < -1e-3 { (start.y / -ray.y).clamp(0.0, reach) } else { reach };
            let end = start + ray * length;
            for point in [start, end] {
                let point = point.with_y(point.y.clamp(0.0, 2.0));
                (low, high) = (low.min(point), high.max(point));
            }
        }
    }
    let wanted = (0.5 * (high - low).length()).clamp(RADIUS.0, RADIUS.1);
    let wanted = if wanted.is_finite() { wanted } else { RADIUS.1 };
    // one of few sizes: a quarter of an octave apart
    let radius = ((wanted.log2() * 4.0).ceil() / 4.0).exp2();
    #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
    let texel = 2.0 * radius / size.max(1) as f32;
    let middle = 0.5 * (low + high);
    let middle = if middle.is_finite() { middle } else { Vec3::ZERO };
    let up = if sun.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
    let turn = look_at_mat4(Vec3::ZERO, -sun, up);
    let center = turn.transform_point3(middle);
    let center = Vec3::new((center.x / texel).round() * texel, (center.y / texel).round() * texel, center.z);
    let view_from_world = Mat4::from_translation(-center) * turn;
    // near and far change places: depth 1 towards the sun
    let clip_from_view = vulkan::orthographic(-radius, radius, -radius, radius, DEPTH, -DEPTH);
    SunView { shadow_from_world: clip_from_view * view_from_world, texel }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sizes come in steps and must be the same")]
mod tests {
    use super::super::camera::Camera;
    use super::*;

    const SUN: Vec3 = Vec3::new(0.48, 0.8, 0.36);

    fn clip(fit: &SunView, p: Vec3) -> Vec3 {
        fit.shadow_from_world.project_point3(p)
    }

    #[test]
    fn what_the_view_shows_of_the_ground_is_on_the_shadow_map() {
        let cameras = [
            Camera::user_eyes(Vec3::new(3.0, 1.7, -2.0), 0.7, -0.1),
            Camera::orbit(Vec3::new(5.0, 0.0, 5.0), 25.0, 1.0, 0.6),
            Camera::top(Vec2::new(-4.0, 9.0), 30.0),
        ];
        for camera in cameras {
            let view = View::mono(&camera, 1280, 720);
            let fit = sun_view(&view, SUN, 2048);
            for (x, y) in [(0.0, 0.3), (-0.9, 0.9), (0.9, 0.9), (0.0, 0.95)] {
                let near = view.clip_from_world[0].inverse() * Vec4::new(x, y, 1.0, 1.0);
                let start = near.truncate() / near.w;
                let ray = view.ray(0, Vec2::new(x, y));
                let ground = start + ray * (start.y / -ray.y);
                let p = clip(&fit, ground);
                assert!(p.x.abs() <= 1.0 && p.y.abs() <= 1.0 && p.z > 0.0 && p.z < 1.0, "{camera:?} {p}");
            }
            assert!(fit.texel < 0.12, "{}", fit.texel);
        }
    }

    #[test]
    fn what_is_nearer_to_the_sun_has_the_larger_depth() {
        let view = View::mono(&Camera::orbit(Vec3::ZERO, 10.0, 0.0, 0.5), 64, 64);
        let fit = sun_view(&view, SUN, 1024);
        let (low, high) = (clip(&fit, Vec3::ZERO), clip(&fit, SUN * 3.0));
        assert!(high.z > low.z && (high.truncate() - low.truncate()).length() < 1e-4, "{low} {high}");
    }

    #[test]
    fn a_camera_that_moves_a_little_moves_the_map_by_whole_texels() {
        let at = |x: f32| {
            let camera = Camera::user_eyes(Vec3::new(x, 1.7, 0.0), 0.3, 0.0);
            sun_view(&View::mono(&camera, 640, 480), SUN, 1024)
        };
        let (a, b) = (at(0.0), at(0.033));
        assert_eq!(a.texel, b.texel);
        let moved = (clip(&b, Vec3::ZERO) - clip(&a, Vec3::ZERO)).truncate() * 512.0;
        assert!((moved - moved.round()).abs().max_element() < 0.02, "{moved}");
    }

    #[test]
    fn a_sun_in_the_zenith_and_a_view_of_the_sky_stay_finite() {
        let camera = Camera::user_eyes(Vec3::new(0.0, 1.7, 0.0), 0.0, 1.4);
        let fit = sun_view(&View::mono(&camera, 640, 480), Vec3::Y, 512);
        assert!(fit.shadow_from_world.is_finite() && fit.texel > 0.0);
    }
}
