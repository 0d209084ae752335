//! Where the sun looks: the part of the ground that the view shows, from the sun's direction.

use super::camera::View;
use glam::camera::rh::{proj::vulkan, view::look_at_mat4};
use glam::{Mat4, Vec2, Vec3, Vec4};

/// Shadows reach this far from an eye near the ground, m.
const REACH: f32 = 35.0;
/// The finer map reaches this far, m. From eyes that are farther above the ground nothing is so near.
const NEAR_REACH: f32 = 6.0;
/// A map that is not so many times as fine as the whole one is not worth its time.
const LEAST_FINER: f32 = 1.9;
/// Heads are at most so high above what is near the eyes, m: people on a storey above among them.
const HIGHEST: f32 = 8.5;
/// Shadows are as long as if the sun were at least so high, as the sine of its elevation.
const LEAST_HEIGHT: f32 = 0.05;
/// Bounds of the radius of the shadow map on the ground, m.
const RADIUS: (f32, f32) = (6.0, 250.0);
/// Least radius of the finer one, m.
const NEAR_RADIUS: f32 = 2.0;
/// Half the depth of the shadow map along the sun's rays, m: what stands farther towards the sun casts no shadow.
const DEPTH: f32 = 200.0;

/// The sun's view of the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct SunView {
    /// World to the shadow map's clip space; depth 1 nearest to the sun.
    pub(crate) shadow_from_world: Mat4,
    /// Side of one texel, m.
    pub(crate) texel: f32,
    /// A finer map of what is near the eyes, where there is something.
    pub(crate) near: Option<Near>,
}

/// A part of the shadow map that has a map of its own, of as many texels and the same depth.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Near {
    /// Its middle in the clip space of the whole.
    pub(crate) middle: Vec2,
    /// How many times as fine it is.
    pub(crate) finer: f32,
    /// How far from the eyes what casts shadows into it can stand, m.
    pub(crate) casters: f32,
}

impl SunView {
    /// World to the clip space of the finer map.
    pub(crate) fn near_from_world(&self) -> Option<Mat4> {
        let Near { middle, finer, .. } = self.near?;
        let moved = Mat4::from_translation(Vec3::new(-middle.x, -middle.y, 0.0));
        Some(Mat4::from_scale(Vec3::new(finer, finer, 1.0)) * moved * self.shadow_from_world)
    }
}

/// Fits the shadow map of `size` texels to what `view` shows of the ground, and a finer one to what of it is near.
///
/// `sun` is the unit direction towards the sun. Radius and middle move in steps of texels, so that edges of shadows do
/// not crawl when the camera moves.
pub(crate) fn sun_view(view: &View, sun: Vec3, size: u32) -> SunView {
    let up = if sun.y.abs() > 0.99 { Vec3::Z } else { Vec3::Y };
    let turn = look_at_mat4(Vec3::ZERO, -sun, up);
    let whole = Square::fitted(bounds(view, |height| REACH.max(3.0 * height)), &turn, RADIUS.0, size);
    let view_from_world = Mat4::from_translation(-whole.center) * turn;
    // near and far change places: depth 1 towards the sun
    let radius = whole.radius;
    let clip_from_view = vulkan::orthographic(-radius, radius, -radius, radius, DEPTH, -DEPTH);
    let is_low = (0..view.eye_count.clamp(1, 2) as usize).all(|eye| view.eyes[eye].y < NEAR_REACH);
    let near = (is_low && !view.parallel).then(|| {
        let (low, high) = bounds(view, |_| NEAR_REACH);
        let near = Square::fitted((low, high), &turn, NEAR_RADIUS, size);
        let middle = clip_from_view.project_point3(near.center - whole.center).truncate(); // clip space has y downwards
        // from the eyes to the middle, on to a corner of the map, and as long as shadows are
        let away = view.center().distance(0.5 * (low + high));
        let height = sun.y.max(LEAST_HEIGHT);
        let shadow = HIGHEST * (1.0 - height * height).max(0.0).sqrt() / height;
        let casters = away + near.radius * std::f32::consts::SQRT_2 / height + shadow;
        Near { middle, finer: radius / near.radius, casters }
    });
    SunView {
        shadow_from_world: clip_from_view * view_from_world,
        texel: whole.texel,
        near: near.filter(|near| near.finer >= LEAST_FINER),
    }
}

/// A box, low and high corner, about what a view shows of the ground and of people, as far as shadows reach. `reach` gives that by
/// the height of the place where a ray starts, m.
fn bounds(view: &View, reach: impl Fn(f32) -> f32) -> (Vec3, Vec3) {
    let (mut low, mut high) = (Vec3::INFINITY, Vec3::NEG_INFINITY);
    for eye in 0..view.eye_count.clamp(1, 2) as usize {
        for corner in [Vec2::new(-1.0, -1.0), Vec2::new(1.0, -1.0), Vec2::new(-1.0, 1.0), Vec2::ONE] {
            let near = view.clip_from_world[eye].inverse() * Vec4::new(corner.x, corner.y, 1.0, 1.0);
            let start = near.truncate() / near.w;
            let ray = view.ray(eye, corner);
            let reach = reach(start.y);
            // as far as the ground, or as far as shadows reach
            let length = if ray.y < -1e-3 { (start.y / -ray.y).clamp(0.0, reach) } else { reach };
            let end = start + ray * length;
            for point in [start, end] {
                let point = point.with_y(point.y.clamp(0.0, 2.0));
                (low, high) = (low.min(point), high.max(point));
            }
        }
    }
    (low, high)
}

/// What a map shows, seen from the sun.
#[derive(Debug, Clone, Copy)]
struct Square {
    /// In the sun's view.
    center: Vec3,
    /// Half its side, m.
    radius: f32,
    /// Side of a texel, m.
    texel: f32,
}

impl Square {
    /// About a box, with at least this radius. `turn` turns the world to the sun's view.
    fn fitted((low, high): (Vec3, Vec3), turn: &Mat4, least: f32, size: u32) -> Self {
        let wanted = (0.5 * (high - low).length()).clamp(least, RADIUS.1);
        let wanted = if wanted.is_finite() { wanted } else { RADIUS.1 };
        // one of few sizes: a quarter of an octave apart
        let radius = ((wanted.log2() * 4.0).ceil() / 4.0).exp2();
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let texel = 2.0 * radius / size.max(1) as f32;
        let middle = 0.5 * (low + high);
        let middle = if middle.is_finite() { middle } else { Vec3::ZERO };
        let center = turn.transform_point3(middle);
        let whole = |length: f32| (length / texel).round() * texel;
        Self { center: Vec3::new(whole(center.x), whole(center.y), center.z), radius, texel }
    }
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
    fn the_finer_map_shows_what_is_near_the_eyes_and_lies_in_the_whole_one() {
        for pitch in [-0.6, -0.1, 0.1] {
            let camera = Camera::user_eyes(Vec3::new(3.0, 1.7, -2.0), 0.7, pitch);
            let view = View::mono(&camera, 1280, 720);
            let fit = sun_view(&view, SUN, 2048);
            let (near, near_from_world) = (fit.near.unwrap(), fit.near_from_world().unwrap());
            assert!(fit.texel / near.finer < 0.01, "{}", fit.texel / near.finer);
            for (x, y, way) in [(0.0, 0.0, 2.0), (0.8, 0.5, 4.0), (-0.8, 0.9, 3.0), (0.0, -0.5, 5.0)] {
                let seen = view.eyes[0] + view.ray(0, Vec2::new(x, y)) * way;
                if !(0.0..=2.0).contains(&seen.y) {
                    continue;
                }
                let (close, whole) = (near_from_world.project_point3(seen), clip(&fit, seen));
                assert!(close.truncate().abs().max_element() <= 1.0, "{pitch} {seen} {close}");
                let same = (whole.truncate() - near.middle) * near.finer;
                assert!((close.truncate() - same).length() < 1e-4 && (close.z - whole.z).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn who_can_cast_a_shadow_into_the_finer_map_is_the_farther_the_lower_the_sun_stands() {
        let camera = Camera::user_eyes(Vec3::new(3.0, 1.7, -2.0), 0.7, -0.1);
        let view = View::mono(&camera, 1280, 720);
        let mut before = 0.0;
        for degrees in [80.0_f32, 53.0, 30.0, 10.0] {
            let (up, along) = degrees.to_radians().sin_cos();
            let sun = Vec3::new(0.0, up, along);
            let fit = sun_view(&view, sun, 2048);
            let (reach, near_from_world) = (fit.near.unwrap().casters, fit.near_from_world().unwrap());
            assert!(reach > before, "{degrees} degrees: {reach} m");
            before = reach;
            // what stands farther than that has its head, and all below it, beyond the map's edge
            for step in 0..16_u8 {
                let away = Vec2::from_angle(f32::from(step) * std::f32::consts::FRAC_PI_8) * (1.01 * reach);
                let foot = view.eyes[0].with_y(0.0) + Vec3::new(away.x, 0.0, away.y);
                for height in [0.0, 1.0, 2.5, HIGHEST] {
                    let at = near_from_world.project_point3(foot.with_y(height));
                    assert!(at.truncate().abs().max_element() > 1.0, "{degrees} degrees, {away}: {at}");
                }
            }
        }
    }

    #[test]
    fn from_far_above_and_on_maps_there_is_no_finer_map() {
        let above = Camera::orbit(Vec3::ZERO, 40.0, 0.0, 0.8);
        let map = Camera::top(Vec2::ZERO, 4.0);
        for camera in [above, map] {
            assert_eq!(sun_view(&View::mono(&camera, 640, 480), SUN, 1024).near_from_world(), None);
        }
    }

    #[test]
    fn a_sun_in_the_zenith_and_a_view_of_the_sky_stay_finite() {
        let camera = Camera::user_eyes(Vec3::new(0.0, 1.7, 0.0), 0.0, 1.4);
        let fit = sun_view(&View::mono(&camera, 640, 480), Vec3::Y, 512);
        assert!(fit.shadow_from_world.is_finite() && fit.texel > 0.0);
    }
}
