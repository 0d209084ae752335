//! Cameras: what is seen, from where, and the planes that bound it.
//!
//! Right-handed, y up, metres, radians. A view looks along its −z. Clip space is Vulkan's: y down, depth reversed
//! (1 at the near plane, 0 infinitely far), which spends the precision of a 32-bit float depth evenly.

use glam::camera::rh::{proj::vulkan, view::look_at_mat4};
use glam::{Mat4, Quat, Vec2, Vec3, Vec4};
use std::f32::consts::{FRAC_PI_2, PI};

/// Near plane of the perspective cameras, m.
#[doc(hidden)]
pub const NEAR: f32 = 0.05;

/// How a camera maps its view onto the image.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Projection {
    /// Perspective with the far plane at infinity.
    Perspective {
        /// Vertical field of view, radians.
        vertical_fov: f32,
        /// Near plane, m.
        near: f32,
    },
    /// Parallel projection: no perspective, distances can be measured in the image.
    Orthographic {
        /// Height of the image, m.
        height: f32,
        /// Far plane, m; the near plane is at the camera.
        far: f32,
    },
}

/// A camera: a pose in the world and a projection.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// Position, world frame, m.
    pub position: Vec3,
    /// Rotation of the view in the world (`world_from_view`).
    pub rotation: Quat,
    /// Projection.
    pub projection: Projection,
}

impl Camera {
    /// Field of view of the cameras made here, radians (50 degrees: a 27 mm lens on full frame).
    pub const VERTICAL_FOV: f32 = 0.872_664_6;

    /// A camera at `position` that looks at `target` with the given up direction (not along the view).
    ///
    /// If the two points coincide it looks along −z; if up lies along the view, another up is taken.
    pub fn look_at(position: Vec3, target: Vec3, up: Vec3) -> Self {
        let forward = (target - position).try_normalize().unwrap_or(Vec3::NEG_Z);
        let up = if forward.cross(up).length_squared() > 1e-8 {
            up
        } else if forward.y.abs() < 0.9 {
            Vec3::Y
        } else {
            Vec3::NEG_Z
        };
        let view_from_world = look_at_mat4(position, position + forward, up);
        let rotation = Quat::from_mat4(&view_from_world).inverse().normalize();
        let projection = Projection::Perspective { vertical_fov: Self::VERTICAL_FOV, near: NEAR };
        Self { position, rotation, projection }
    }

    /// The user's eyes: at `eyes`, looking along `heading` (about +y, 0 faces +z) and `pitch` upwards, radians.
    pub fn user_eyes(eyes: Vec3, heading: f32, pitch: f32) -> Self {
        let pitch = pitch.clamp(-1.55, 1.55); // short of straight up, where the heading would be lost
        let flat = Vec3::new(heading.sin(), 0.0, heading.cos());
        Self::look_at(eyes, eyes + flat * pitch.cos() + Vec3::Y * pitch.sin(), Vec3::Y)
    }

    /// A camera on a sphere about `target`: `distance` away, `azimuth` about +y (0 stands on the +z side),
    /// `elevation` above the horizon, radians.
    pub fn orbit(target: Vec3, distance: f32, azimuth: f32, elevation: f32) -> Self {
        let elevation = elevation.clamp(-1.55, 1.55);
        let out =
            Vec3::new(azimuth.sin() * elevation.cos(), elevation.sin(), azimuth.cos() * elevation.cos());
        Self::look_at(target + out * distance.max(NEAR), target, Vec3::Y)
    }

    /// Straight down onto the ground at `center`, as on a map: +x to the right, +z down. The image is `height`
    /// metres high; parallel projection.
    pub fn top(center: Vec2, height: f32) -> Self {
        /// Nothing in a scene is higher, m.
        const ALTITUDE: f32 = 200.0;
        let position = Vec3::new(center.x, ALTITUDE, center.y);
        let camera = Self::look_at(position, Vec3::new(center.x, 0.0, center.y), Vec3::NEG_Z);
        let projection = Projection::Orthographic { height: height.max(0.1), far: ALTITUDE * 2.0 };
        Self { projection, ..camera }
    }

    /// Over the shoulder of an agent: behind and above its `position` (on the ground), looking past it where it heads.
    pub fn follow(position: Vec3, heading: f32, distance: f32) -> Self {
        let forward = Vec3::new(heading.sin(), 0.0, heading.cos());
        let eyes = position - forward * distance.max(0.5) + Vec3::Y * (1.5 + 0.35 * distance);
        Self::look_at(eyes, position + forward * 1.5 + Vec3::Y * 1.2, Vec3::Y)
    }

    /// In front of an agent at its own height, looking at its face.
    pub fn portrait(position: Vec3, heading: f32, distance: f32) -> Self {
        let forward = Vec3::new(heading.sin(), 0.0, heading.cos());
        let eyes = position + forward * distance.max(0.5) + Vec3::Y * 1.5;
        Self::look_at(eyes, position + Vec3::Y * 1.0, Vec3::Y)
    }

    /// The same camera with another vertical field of view, radians; no change to a parallel projection.
    #[must_use]
    pub fn with_fov(mut self, radians: f32) -> Self {
        if let Projection::Perspective { vertical_fov, .. } = &mut self.projection {
            *vertical_fov = radians.clamp(0.02, PI - 0.1);
        }
        self
    }

    /// The way between two cameras: `t` from 0 (this one) to 1. The projection is the nearer one's.
    #[must_use]
    pub fn blend(&self, other: &Self, t: f32) -> Self {
        let t = t.clamp(0.0, 1.0);
        let projection = match (self.projection, other.projection) {
            (
                Projection::Perspective { vertical_fov: a, near: n },
                Projection::Perspective { vertical_fov: b, near: m },
            ) => Projection::Perspective { vertical_fov: a + (b - a) * t, near: n + (m - n) * t },
            (a, b) => {
                if t < 0.5 {
                    a
                } else {
                    b
                }
            }
        };
        Self {
            position: self.position.lerp(other.position, t),
            rotation: self.rotation.slerp(other.rotation, t),
            projection,
        }
    }

    /// Unit vector that the camera looks along, world frame.
    pub fn forward(&self) -> Vec3 {
        self.rotation * Vec3::NEG_Z
    }

    /// World to view.
    pub fn view_from_world(&self) -> Mat4 {
        Mat4::from_rotation_translation(self.rotation, self.position).inverse()
    }

    /// View to clip space, for an image of this width over height.
    pub fn clip_from_view(&self, aspect: f32) -> Mat4 {
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        match self.projection {
            Projection::Perspective { vertical_fov, near } => {
                vulkan::perspective_infinite_reverse(vertical_fov, aspect, near)
            }
            Projection::Orthographic { height, far } => {
                let (x, y) = (0.5 * height * aspect, 0.5 * height);
                // near and far change places: depth 1 at the camera
                vulkan::orthographic(-x, x, -y, y, far, 0.0)
            }
        }
    }

    /// World to clip space.
    pub fn clip_from_world(&self, aspect: f32) -> Mat4 {
        self.clip_from_view(aspect) * self.view_from_world()
    }
}

/// Heading and pitch change when the pointer is dragged over the image; helper for orbiting and looking around.
#[doc(hidden)]
pub fn wrap_heading(heading: f32) -> f32 {
    (heading + PI).rem_euclid(2.0 * PI) - PI
}

/// The planes that bound what a clip matrix shows: left, right, bottom and top of the image in any order, near, far.
///
/// World frame; a point is inside a plane where `dot(plane.xyz, point) + plane.w >= 0`, and `plane.w` is in metres.
/// A far plane at infinity has normal 0 and lets everything pass. Works for skewed projections of headsets too.
#[doc(hidden)]
pub fn frustum_planes(clip_from_world: &Mat4) -> [Vec4; 6] {
    let [x, y, z, w] = [0, 1, 2, 3].map(|i| clip_from_world.row(i));
    // inside: −w ≤ x ≤ w, −w ≤ y ≤ w, 0 ≤ z ≤ w
    [w + x, w - x, w + y, w - y, w - z, z].map(|plane| {
        let length = plane.truncate().length();
        // far at infinity: its row is (0, 0, 0, near)
        if length > 1e-6 { plane / length } else { Vec4::new(0.0, 0.0, 0.0, 1.0) }
    })
}

/// What is drawn: one camera matrix per eye.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct View {
    /// World to clip space per eye; the second is used when `eye_count` is 2.
    pub clip_from_world: [Mat4; 2],
    /// Position of each eye, world frame, m.
    pub eyes: [Vec3; 2],
    /// 1 for an image or a window, 2 for a headset.
    pub eye_count: u32,
    /// Whether the projection is parallel: a map, which has no haze.
    pub parallel: bool,
}

impl View {
    /// One eye through a camera, for an image of this size in pixels.
    pub fn mono(camera: &Camera, width: u32, height: u32) -> Self {
        let clip = camera.clip_from_world(aspect(width, height));
        let parallel = matches!(camera.projection, Projection::Orthographic { .. });
        Self { clip_from_world: [clip; 2], eyes: [camera.position; 2], eye_count: 1, parallel }
    }

    /// Two eyes, `interpupillary` metres apart about the camera.
    pub fn stereo(camera: &Camera, interpupillary: f32, width: u32, height: u32) -> Self {
        let aside = camera.rotation * Vec3::X * (0.5 * interpupillary);
        let eye = |position| Camera { position, ..*camera };
        let (left, right) = (eye(camera.position - aside), eye(camera.position + aside));
        let clip = |camera: &Camera| camera.clip_from_world(aspect(width, height));
        Self {
            clip_from_world: [clip(&left), clip(&right)],
            eyes: [left.position, right.position],
            eye_count: 2,
            parallel: matches!(camera.projection, Projection::Orthographic { .. }),
        }
    }

    /// Frustum planes of both eyes, as `FrameUniforms::planes` wants them (of one eye twice for one eye).
    pub fn planes(&self) -> [[f32; 4]; 12] {
        let mut planes = [[0.0; 4]; 12];
        for eye in 0..2 {
            let matrix = &self.clip_from_world[if self.eye_count == 2 { eye } else { 0 }];
            for (to, plane) in planes[6 * eye..].iter_mut().zip(frustum_planes(matrix)) {
                *to = plane.to_array();
            }
        }
        planes
    }

    /// Midpoint of the eyes, m.
    pub fn center(&self) -> Vec3 {
        if self.eye_count == 2 { (self.eyes[0] + self.eyes[1]) * 0.5 } else { self.eyes[0] }
    }

    /// Pixels of a metre at a metre's distance in images of so many rows, without the shift of a skewed projection; on a map at any
    /// distance.
    pub(crate) fn focal(&self, rows: u32) -> f32 {
        let clip = &self.clip_from_world[0];
        let [up, ahead] = [1, 3].map(|row| clip.row(row).truncate());
        let ahead = ahead.normalize_or_zero();
        #[allow(clippy::cast_precision_loss, reason = "at most 16 384")]
        let half = 0.5 * rows as f32;
        half * (up - ahead * up.dot(ahead)).length()
    }

    /// Where a world point appears, in pixels from the top left corner, and its depth; `None` behind the eye.
    pub fn pixel_from_world(&self, eye: usize, point: Vec3, width: u32, height: u32) -> Option<Vec3> {
        let clip = self.clip_from_world[eye.min(1)] * point.extend(1.0);
        (clip.w > 0.0).then(|| {
            let ndc = clip.truncate() / clip.w;
            Vec3::new((ndc.x * 0.5 + 0.5) * to_f32(width), (ndc.y * 0.5 + 0.5) * to_f32(height), ndc.z)
        })
    }

    /// Unit direction of the ray through a point of the image (x right, y down, each from −1 to 1), world frame.
    pub fn ray(&self, eye: usize, ndc: Vec2) -> Vec3 {
        let world_from_clip = self.clip_from_world[eye.min(1)].inverse();
        let near = world_from_clip * Vec4::new(ndc.x, ndc.y, 1.0, 1.0);
        let far = world_from_clip * Vec4::new(ndc.x, ndc.y, 0.0, 1.0); // w is 0 when infinitely far
        (far.truncate() * near.w - near.truncate() * far.w).normalize_or(Vec3::NEG_Z)
    }
}

/// Width over height.
#[doc(hidden)]
pub fn aspect(width: u32, height: u32) -> f32 {
    to_f32(width) / to_f32(height.max(1))
}

#[allow(clippy::cast_precision_loss, reason = "picture sizes are far below 2^24")]
fn to_f32(value: u32) -> f32 {
    value as f32
}

/// A camera that a person steers: orbit about a target, which can be moved over the ground.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrbitControl {
    /// What the camera turns about, m.
    pub target: Vec3,
    /// Distance from it, m.
    pub distance: f32,
    /// Angle about +y, radians; 0 stands on the +z side.
    pub azimuth: f32,
    /// Angle above the horizon, radians.
    pub elevation: f32,
}

impl OrbitControl {
    /// Turns by a drag of (x right, y down) in fractions of the image's height.
    pub fn turn(&mut self, drag: Vec2) {
        self.azimuth = wrap_heading(self.azimuth - drag.x * PI);
        self.elevation = (self.elevation + drag.y * FRAC_PI_2).clamp(0.02, 1.55);
    }

    /// Moves the target over the ground by a drag of (x right, y down) in fractions of the image's height, so the
    /// ground follows the pointer.
    pub fn pan(&mut self, drag: Vec2) {
        let right = Vec3::new(self.azimuth.cos(), 0.0, -self.azimuth.sin());
        let back = Vec3::new(self.azimuth.sin(), 0.0, self.azimuth.cos());
        self.target -= (right * drag.x + back * drag.y) * self.distance;
    }

    /// Comes nearer by a factor below 1 or goes away by one above 1.
    pub fn zoom(&mut self, factor: f32) {
        self.distance = (self.distance * factor).clamp(0.5, 500.0);
    }

    /// The camera.
    pub fn camera(&self) -> Camera {
        Camera::orbit(self.target, self.distance, self.azimuth, self.elevation)
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "a constant is copied")]
mod tests {
    use super::*;

    const W: u32 = 160;
    const H: u32 = 90;

    fn pixel(camera: &Camera, point: Vec3) -> Vec3 {
        View::mono(camera, W, H).pixel_from_world(0, point, W, H).unwrap()
    }

    #[test]
    fn what_a_camera_looks_at_is_in_the_middle_right_is_right_and_up_is_up() {
        let camera = Camera::look_at(Vec3::new(3.0, 2.0, 5.0), Vec3::new(0.0, 1.0, 0.0), Vec3::Y);
        let middle = pixel(&camera, Vec3::new(0.0, 1.0, 0.0));
        assert!((middle.truncate() - Vec2::new(80.0, 45.0)).length() < 1e-3, "{middle}");
        let right = camera.rotation * Vec3::X;
        assert!(pixel(&camera, Vec3::Y + right).x > 80.0);
        assert!(pixel(&camera, Vec3::Y * 2.0).y < 45.0);
        assert!((camera.forward() - Vec3::new(-3.0, -1.0, -5.0).normalize()).length() < 1e-6);
    }

    #[test]
    fn depth_is_one_at_the_near_plane_and_falls_towards_zero() {
        let camera = Camera::user_eyes(Vec3::ZERO, 0.0, 0.0);
        let depth = |z: f32| pixel(&camera, Vec3::new(0.0, 0.0, z)).z;
        assert!((depth(NEAR) - 1.0).abs() < 1e-5);
        assert!(depth(1.0) > depth(2.0) && depth(1e4) > 0.0 && depth(1e4) < 1e-4);
        let top = Camera::top(Vec2::ZERO, 10.0);
        let (high, low) = (pixel(&top, Vec3::Y * 2.0).z, pixel(&top, Vec3::ZERO).z);
        assert!(high > low && low > 0.0 && high < 1.0);
    }

    #[test]
    fn the_users_eyes_follow_heading_and_pitch() {
        for (heading, pitch, want) in [
            (0.0, 0.0, Vec3::Z),
            (FRAC_PI_2, 0.0, Vec3::X),
            (0.0, 0.5, Vec3::new(0.0, 0.5_f32.sin(), 0.5_f32.cos())),
        ] {
            let camera = Camera::user_eyes(Vec3::new(1.0, 1.7, 2.0), heading, pitch);
            assert!((camera.forward() - want).length() < 1e-5, "{heading} {pitch} {}", camera.forward());
            assert!((camera.rotation * Vec3::X).y.abs() < 1e-6, "the horizon is level");
        }
        assert!(Camera::user_eyes(Vec3::ZERO, 0.0, 9.0).view_from_world().is_finite());
    }

    #[test]
    fn the_map_shows_x_to_the_right_and_z_downwards_in_metres() {
        let camera = Camera::top(Vec2::new(5.0, -3.0), 9.0);
        let at = |x: f32, z: f32| pixel(&camera, Vec3::new(x, 0.0, z)).truncate();
        assert!((at(5.0, -3.0) - Vec2::new(80.0, 45.0)).length() < 1e-3);
        assert!((at(6.0, -3.0) - Vec2::new(90.0, 45.0)).length() < 1e-3, "{}", at(6.0, -3.0));
        assert!((at(5.0, -2.0) - Vec2::new(80.0, 55.0)).length() < 1e-3);
    }

    #[test]
    fn orbit_stands_where_asked_and_looks_at_the_target() {
        let target = Vec3::new(1.0, 0.5, -2.0);
        let camera = Camera::orbit(target, 4.0, FRAC_PI_2, 0.0);
        assert!((camera.position - (target + Vec3::X * 4.0)).length() < 1e-5);
        assert!((camera.forward() - Vec3::NEG_X).length() < 1e-5);
        let camera = Camera::orbit(target, 4.0, 0.3, FRAC_PI_2);
        assert!(camera.view_from_world().is_finite() && camera.position.y > 4.4);
    }

    #[test]
    fn follow_and_portrait_see_the_agent_from_behind_and_from_the_front() {
        let (agent, heading) = (Vec3::new(4.0, 0.0, 1.0), 1.0_f32);
        let forward = Vec3::new(heading.sin(), 0.0, heading.cos());
        let behind = Camera::follow(agent, heading, 3.0);
        assert!(behind.forward().dot(forward) > 0.5 && (agent - behind.position).dot(forward) > 2.9);
        let front = Camera::portrait(agent, heading, 3.0);
        assert!(front.forward().dot(forward) < -0.9);
        for camera in [behind, front] {
            let p = pixel(&camera, agent + Vec3::Y);
            assert!(p.x > 0.0 && p.x < 160.0 && p.y > 0.0 && p.y < 90.0, "{p}");
        }
    }

    #[test]
    fn planes_hold_what_the_picture_shows_and_nothing_else() {
        let cameras = [
            Camera::look_at(Vec3::new(3.0, 2.0, 5.0), Vec3::ZERO, Vec3::Y),
            Camera::top(Vec2::new(1.0, 1.0), 12.0),
            Camera::orbit(Vec3::ZERO, 20.0, 2.0, 0.6).with_fov(0.3),
        ];
        let mut seen = [0, 0];
        for camera in cameras {
            let matrix = camera.clip_from_world(aspect(W, H));
            let planes = frustum_planes(&matrix);
            for i in 0..4000_u32 {
                let unit = |k: u32| {
                    let bits =
                        (i.wrapping_mul(2_654_435_761) ^ k.wrapping_mul(40_503)).wrapping_mul(2_246_822_519);
                    f32::from((bits >> 16) as u16) / 65_535.0 * 2.0 - 1.0
                };
                let p = Vec3::new(unit(1), unit(2), unit(3)) * 15.0;
                let clip = matrix * p.extend(1.0);
                let shown =
                    clip.x.abs() <= clip.w && clip.y.abs() <= clip.w && clip.z >= 0.0 && clip.z <= clip.w;
                let margin = planes.iter().map(|n| n.truncate().dot(p) + n.w).fold(f32::INFINITY, f32::min);
                if margin.abs() > 1e-3 {
                    assert_eq!(margin > 0.0, shown, "{p} {margin}");
                    seen[usize::from(shown)] += 1;
                }
            }
        }
        assert!(seen[0] > 1000 && seen[1] > 300, "{seen:?}");
    }

    #[test]
    fn plane_distances_are_metres() {
        let camera = Camera::user_eyes(Vec3::ZERO, 0.0, 0.0);
        let planes = frustum_planes(&camera.clip_from_world(1.0));
        let near = planes[4];
        assert!((near.truncate() - Vec3::Z).length() < 1e-5 && (near.w + NEAR).abs() < 1e-5, "{near}");
        assert_eq!(planes[5], Vec4::W, "the far plane lets everything pass");
    }

    #[test]
    fn two_eyes_stand_apart_to_the_left_and_right() {
        let camera = Camera::user_eyes(Vec3::new(0.0, 1.7, 0.0), 0.0, 0.0);
        let view = View::stereo(&camera, 0.064, W, H);
        // looking along +z with y up, right is −x
        assert!((view.eyes[1] - view.eyes[0] - Vec3::new(-0.064, 0.0, 0.0)).length() < 1e-6);
        assert!((view.center() - camera.position).length() < 1e-6);
        let p = Vec3::new(0.0, 1.7, 2.0);
        let x = |eye| view.pixel_from_world(eye, p, W, H).unwrap().x;
        assert!(x(0) > x(1), "near things stand further right for the left eye");
        assert_ne!(view.planes()[0], view.planes()[6]);
    }

    #[test]
    fn rays_go_through_the_pixels_they_were_asked_for() {
        for camera in [Camera::orbit(Vec3::ZERO, 5.0, 0.4, 0.7), Camera::top(Vec2::ZERO, 5.0)] {
            let view = View::mono(&camera, W, H);
            assert!((view.ray(0, Vec2::ZERO) - camera.forward()).length() < 1e-4);
            if let Projection::Perspective { .. } = camera.projection {
                let point = camera.position + view.ray(0, Vec2::new(0.5, -0.25)) * 7.0;
                let p = view.pixel_from_world(0, point, W, H).unwrap();
                assert!((p.truncate() - Vec2::new(120.0, 33.75)).length() < 0.01, "{p}");
            }
        }
    }

    #[test]
    fn steering_turns_pans_and_stays_above_the_ground() {
        let mut control = OrbitControl { target: Vec3::ZERO, distance: 10.0, azimuth: 0.0, elevation: 0.5 };
        control.turn(Vec2::new(0.1, -9.0));
        assert!(control.azimuth < 0.0 && control.elevation > 0.0);
        control.azimuth = 0.0;
        control.pan(Vec2::new(0.1, 0.0));
        assert!(control.target.x < 0.0, "dragging right moves the scene right, the target left");
        control.zoom(0.0);
        assert!(control.distance >= 0.5 && control.camera().view_from_world().is_finite());
    }
}
