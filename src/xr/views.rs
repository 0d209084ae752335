//! OpenXR's poses and fields of view as matrices.

use crate::render::View;
use glam::{Mat4, Quat, Vec3, Vec4};
use openxr as xr;

/// Nearest distance that is drawn, m: a hand before the face still is.
pub(super) const NEAR: f32 = 0.05;

/// A pose: rotation and position.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Pose {
    pub(super) rotation: Quat,
    pub(super) position: Vec3,
}

impl Pose {
    /// The pose, if it holds numbers and a rotation.
    pub(super) fn from_xr(pose: xr::Posef) -> Option<Self> {
        let (o, p) = (pose.orientation, pose.position);
        let rotation = Quat::from_xyzw(o.x, o.y, o.z, o.w);
        let position = Vec3::new(p.x, p.y, p.z);
        let usable = rotation.is_finite() && rotation.length_squared() > 1e-6 && position.is_finite();
        usable.then(|| Self { rotation: rotation.normalize(), position })
    }

    /// As OpenXR has it.
    pub(super) fn to_xr(self) -> xr::Posef {
        let ([x, y, z], [a, b, c, w]) = (self.position.to_array(), self.rotation.to_array());
        xr::Posef { orientation: xr::Quaternionf { x: a, y: b, z: c, w }, position: xr::Vector3f { x, y, z } }
    }

    /// This pose within a space that itself stands at `outer`.
    pub(super) fn within(self, outer: Self) -> Self {
        Self {
            rotation: outer.rotation * self.rotation,
            position: outer.position + outer.rotation * self.position,
        }
    }
}

/// Clip from view space for a field of view that need not be symmetric: reversed depth without end, y down.
pub(super) fn projection(fov: xr::Fovf) -> Mat4 {
    let (left, right) = (fov.angle_left.tan(), fov.angle_right.tan());
    let (up, down) = (fov.angle_up.tan(), fov.angle_down.tan());
    let (width, height) = ((right - left).max(1e-3), (up - down).max(1e-3));
    Mat4::from_cols(
        Vec4::new(2.0 / width, 0.0, 0.0, 0.0),
        Vec4::new(0.0, -2.0 / height, 0.0, 0.0),
        Vec4::new((right + left) / width, -(up + down) / height, 0.0, -1.0),
        Vec4::new(0.0, 0.0, NEAR, 0.0),
    )
}

/// Both eyes in the world: their poses and fields of view, given in a room that stands at `world_from_room`.
pub(super) fn view(eyes: [(Pose, xr::Fovf); 2], world_from_room: Pose) -> View {
    let placed = eyes.map(|(pose, fov)| (pose.within(world_from_room), fov));
    View {
        clip_from_world: placed.map(|(pose, fov)| {
            projection(fov) * Mat4::from_rotation_translation(pose.rotation, pose.position).inverse()
        }),
        eyes: placed.map(|(pose, _)| pose.position),
        eye_count: 2,
        parallel: false,
    }
}

/// Both eyes of a user who has just come into a room that stands at `world_from_room`: a grown-up at its middle.
pub(super) fn at_start(world_from_room: Pose) -> View {
    const FOV: xr::Fovf = xr::Fovf { angle_left: -0.8, angle_right: 0.8, angle_up: 0.8, angle_down: -0.8 };
    let eye = |x: f32| (Pose { rotation: Quat::IDENTITY, position: Vec3::new(x, 1.6, 0.0) }, FOV);
    view([eye(-0.032), eye(0.032)], world_from_room)
}

#[cfg(test)]
mod tests {
    use super::*;

    const SKEWED: xr::Fovf =
        xr::Fovf { angle_left: -0.9, angle_right: 0.7, angle_up: 0.8, angle_down: -0.95 };

    #[test]
    fn the_edges_of_the_field_of_view_are_the_edges_of_the_picture() {
        let clip = projection(SKEWED);
        let ndc = |direction: Vec3| clip.project_point3(direction * 3.0);
        let at = |x: f32, y: f32| Vec3::new(x.tan(), y.tan(), -1.0);
        assert!((ndc(at(-0.9, 0.0)).x + 1.0).abs() < 1e-6 && (ndc(at(0.7, 0.0)).x - 1.0).abs() < 1e-6);
        // Vulkan's y points down
        assert!((ndc(at(0.0, 0.8)).y + 1.0).abs() < 1e-6 && (ndc(at(0.0, -0.95)).y - 1.0).abs() < 1e-6);
        let depth = |z: f32| clip.project_point3(Vec3::new(0.0, 0.0, z)).z;
        assert!((depth(-NEAR) - 1.0).abs() < 1e-6 && depth(-1.0) > depth(-100.0) && depth(-1e5) > 0.0);
    }

    #[test]
    fn eyes_stand_in_the_room_and_the_room_in_the_world() {
        let half_turn = Quat::from_rotation_y(std::f32::consts::PI);
        let room = Pose { rotation: half_turn, position: Vec3::new(10.0, 0.0, 5.0) };
        let eye = |x: f32| (Pose { rotation: Quat::IDENTITY, position: Vec3::new(x, 1.6, 0.0) }, SKEWED);
        let view = view([eye(-0.03), eye(0.03)], room);
        assert!((view.eyes[0] - Vec3::new(10.03, 1.6, 5.0)).length() < 1e-5);
        // the room is turned: what lies ahead of the eyes (-z) is +z in the world
        let ahead = view.clip_from_world[0] * Vec4::new(10.03, 1.6, 9.0, 1.0);
        assert!(ahead.w > 0.0);
    }

    #[test]
    fn a_pose_without_numbers_is_none() {
        let mut pose = xr::Posef::IDENTITY;
        assert!(Pose::from_xr(pose).is_some());
        pose.position.x = f32::NAN;
        assert!(Pose::from_xr(pose).is_none());
        let zero = xr::Quaternionf { x: 0.0, y: 0.0, z: 0.0, w: 0.0 };
        assert!(Pose::from_xr(xr::Posef { orientation: zero, ..xr::Posef::IDENTITY }).is_none());
    }
}
