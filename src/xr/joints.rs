//! Hands that the runtime sees without controllers (`XR_EXT_hand_tracking`).

use super::error::{Error, call};
use super::views::Pose;
use crate::render::{JOINTS, Joints};
use glam::Vec3;
use openxr as xr;

/// A hand in the room: its palm (-z towards the fingers, +y out of its back), and all joints.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Seen {
    pub(super) palm: Pose,
    pub(super) joints: Joints,
}

impl Seen {
    /// The joints in the world.
    pub(super) fn within(&self, room: Pose) -> Joints {
        Joints(self.joints.0.map(|(place, radius)| (room.position + room.rotation * place, radius)))
    }
}

/// What follows the left and the right hand.
pub(super) struct Trackers([xr::HandTracker; 2]);

impl Trackers {
    /// Followers of both hands, where runtime and headset have them.
    pub(super) fn new(
        instance: &xr::Instance,
        system: xr::SystemId,
        session: &xr::Session<xr::Vulkan>,
    ) -> Result<Option<Self>, Error> {
        if instance.exts().ext_hand_tracking.is_none() {
            return Ok(None);
        }
        let sees = instance.supports_hand_tracking(system).map_err(call("xrGetSystemProperties"))?;
        let of = |hand| session.create_hand_tracker(hand).map_err(call("xrCreateHandTrackerEXT"));
        sees.then(|| Ok(Self([of(xr::Hand::LEFT)?, of(xr::Hand::RIGHT)?]))).transpose()
    }

    /// The hands that are seen at `time`.
    pub(super) fn read(&self, room: &xr::Space, time: xr::Time) -> Result<[Option<Seen>; 2], Error> {
        let mut seen = [None; 2];
        for (seen, tracker) in seen.iter_mut().zip(&self.0) {
            let found = room.locate_hand_joints(tracker, time).map_err(call("xrLocateHandJointsEXT"))?;
            *seen = found.and_then(|found| hand(&found));
        }
        Ok(seen)
    }
}

/// A hand of which every joint is known.
fn hand(found: &[xr::HandJointLocation; JOINTS]) -> Option<Seen> {
    let known = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::POSITION_VALID;
    let mut joints = Joints([(Vec3::ZERO, 0.0); JOINTS]);
    for (joint, found) in joints.0.iter_mut().zip(found) {
        if !found.location_flags.contains(known) {
            return None;
        }
        // a hand's joints are millimetres to centimetres thick
        *joint = (Pose::from_xr(found.pose)?.position, found.radius.clamp(0.002, 0.05));
    }
    let palm = found.first().and_then(|palm| Pose::from_xr(palm.pose))?;
    Some(Seen { palm, joints })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;
    use glam::Quat;

    #[test]
    fn a_hand_is_seen_when_all_its_joints_are_and_stands_where_the_room_does() {
        let known = xr::SpaceLocationFlags::ORIENTATION_VALID | xr::SpaceLocationFlags::POSITION_VALID;
        let position = xr::Vector3f { x: 1.0, y: 0.5, z: 0.0 };
        let pose = xr::Posef { position, ..xr::Posef::IDENTITY };
        let mut joints =
            [xr::HandJointLocation { location_flags: known, pose, radius: f32::INFINITY }; JOINTS];
        let seen = hand(&joints).unwrap();
        let turn = Quat::from_rotation_y(std::f32::consts::FRAC_PI_2);
        let (place, radius) = seen.within(Pose { rotation: turn, position: Vec3::X }).0[25];
        assert!((place - Vec3::new(1.0, 0.5, -1.0)).length() < 1e-6, "{place}");
        assert!((radius - 0.05).abs() < 1e-6, "{radius}");
        joints[17].location_flags = xr::SpaceLocationFlags::ORIENTATION_VALID;
        assert!(hand(&joints).is_none());
    }
}
