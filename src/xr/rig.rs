//! Where the user's room stands in the world, and how thumbsticks move it.

use super::views::Pose;
use crate::ground::{ground_from_world, heading_from_ground, world_from_ground};
use crate::render::Teleport;
use glam::{Quat, Vec2, Vec3};

/// Fastest walk by thumbstick, m/s: a brisk pedestrian.
const WALK_SPEED: f32 = 1.6;
/// One snap of a turn, radians: 30 degrees.
const SNAP: f32 = std::f32::consts::FRAC_PI_6;
/// A stick beyond this counts, and snaps again only after it was below half of it.
const PUSHED: f32 = 0.6;
/// A stick within this is at rest.
const DEAD_ZONE: f32 = 0.15;
/// Farthest teleport, m.
const TELEPORT_RANGE: f32 = 12.0;
/// Farther away nothing is shown of where a hand points, m.
const SHOWN_RANGE: f32 = 20.0;
/// How much of the edge of the view is darkened at once by a snap of a turn.
const SNAP_VIGNETTE: f32 = 0.6;

/// What thumbsticks and buttons say in one frame; each stick -1 to 1, x to the right, y away from the user.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Walk {
    /// Walks, as the head faces.
    pub stick: Vec2,
    /// Turns: x of the other stick.
    pub turn: f32,
    /// Whether a place to teleport to is being pointed at.
    pub aims: bool,
    /// Whether the room shall be recentred.
    pub recentres: bool,
}

/// The user's room in the world, and the state of locomotion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rig {
    /// Where the room's origin is on the ground, m.
    origin: Vec2,
    /// Height of the floor, m.
    floor: f32,
    /// Turn of the room about +y, radians.
    heading: f32,
    /// Where a recentred user stands and faces.
    home: (Vec2, f32),
    has_snapped: bool,
    /// Place aimed at, and whether the user may go there; taken when the aiming ends.
    aimed: Option<(Vec2, bool)>,
    /// 0 none to 1: how much of the edge of the view is darkened while being moved.
    vignette: f32,
}

impl Rig {
    /// A room whose user, at its origin and facing its -z, stands at `position` and faces `heading` (radians about +y, 0
    /// faces +z).
    pub fn new(position: Vec2, heading: f32) -> Self {
        let heading = heading + std::f32::consts::PI;
        Self {
            origin: position,
            floor: 0.0,
            heading,
            home: (position, heading),
            has_snapped: false,
            aimed: None,
            vignette: 0.0,
        }
    }

    /// The pose of the room.
    pub(super) fn world_from_room(&self) -> Pose {
        Pose {
            rotation: Quat::from_rotation_y(self.heading),
            position: world_from_ground(self.origin, self.floor),
        }
    }

    /// How much of the edge of the view is darkened, 0 to 1.
    pub fn vignette(&self) -> f32 {
        self.vignette
    }

    /// The place that is being pointed at, and whether the user may go there.
    pub fn aimed(&self) -> Option<(Vec2, bool)> {
        self.aimed
    }

    /// The same as it is shown: from the hand, which is in the room, to the floor.
    pub(super) fn teleport_shown(&self, hand: Option<Pose>) -> Option<Teleport> {
        let ((place, is_allowed), hand) = self.aimed.zip(hand)?;
        let from = hand.within(self.world_from_room()).position;
        Some(Teleport { from, to: world_from_ground(place, self.floor), is_allowed })
    }

    /// Moves the room for a frame of `seconds`. `head` and `hand` are in the room; `is_free` tells where the user may be
    /// moved to (walking in the room itself is never stopped).
    pub(super) fn walk(
        &mut self,
        walk: &Walk,
        head: Pose,
        hand: Option<Pose>,
        seconds: f32,
        is_free: impl Fn(Vec2) -> bool,
    ) {
        if walk.recentres {
            self.recentre(head);
        }
        self.snap(walk.turn, head);
        let moved = self.smooth(walk.stick, head, seconds, &is_free);
        self.teleport(walk.aims, head, hand, &is_free);
        // quickly dark, slowly light again
        let goal = if moved { 1.0 } else { 0.0 };
        let rate = if moved { 8.0 } else { 3.0 };
        self.vignette += (goal - self.vignette) * (rate * seconds).clamp(0.0, 1.0);
    }

    /// Puts the user back to where the scene has them, facing as it says.
    fn recentre(&mut self, head: Pose) {
        self.heading = self.home.1 - yaw(head.rotation);
        self.origin = Vec2::ZERO;
        let stands = self.user(head);
        self.origin = self.home.0 - stands;
    }

    /// The user's place on the ground.
    pub(super) fn user(&self, head: Pose) -> Vec2 {
        ground_from_world(head.within(self.world_from_room()).position)
    }

    fn snap(&mut self, turn: f32, head: Pose) {
        if turn.abs() < 0.5 * PUSHED {
            self.has_snapped = false;
        } else if turn.abs() > PUSHED && !self.has_snapped {
            self.has_snapped = true;
            self.vignette = self.vignette.max(SNAP_VIGNETTE);
            // about the user, who stays where they are; the stick to the right turns to the right
            let before = self.user(head);
            self.heading -= SNAP * turn.signum();
            self.origin += before - self.user(head);
        }
    }

    fn smooth(&mut self, stick: Vec2, head: Pose, seconds: f32, is_free: &impl Fn(Vec2) -> bool) -> bool {
        let push = stick.length().min(1.0);
        if push < DEAD_ZONE {
            return false;
        }
        let facing = head.within(self.world_from_room()).rotation;
        let ahead = ground_from_world(facing * Vec3::NEG_Z).normalize_or_zero();
        let right = ground_from_world(facing * Vec3::X).normalize_or_zero();
        let step = (right * stick.x + ahead * stick.y).normalize_or_zero() * (push * WALK_SPEED * seconds);
        let at = self.user(head);
        // along a wall when not through it
        for part in [step, Vec2::new(step.x, 0.0), Vec2::new(0.0, step.y)] {
            if is_free(at + part) {
                self.origin += part;
                return part.length_squared() > 0.0;
            }
        }
        false
    }

    fn teleport(&mut self, aims: bool, head: Pose, hand: Option<Pose>, is_free: &impl Fn(Vec2) -> bool) {
        if aims {
            let hand = hand.map(|hand| hand.within(self.world_from_room()));
            let user = self.user(head);
            self.aimed = hand
                .and_then(|hand| ground_hit(hand, self.floor))
                .filter(|place| place.distance(user) <= SHOWN_RANGE)
                .map(|place| (place, place.distance(user) <= TELEPORT_RANGE && is_free(place)));
        } else if let Some((place, true)) = self.aimed.take() {
            self.origin += place - self.user(head);
        }
    }
}

/// Where the ray along a pose's -z meets the floor.
fn ground_hit(pose: Pose, floor: f32) -> Option<Vec2> {
    let direction = pose.rotation * Vec3::NEG_Z;
    let fall = pose.position.y - floor;
    (direction.y < -0.05 && fall > 0.0)
        .then(|| ground_from_world(pose.position + direction * (fall / -direction.y)))
}

/// Turn about +y of a rotation that looks along -z.
fn yaw(rotation: Quat) -> f32 {
    heading_from_ground(-ground_from_world(rotation * Vec3::NEG_Z))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    fn head(x: f32, z: f32, turn: f32) -> Pose {
        Pose { rotation: Quat::from_rotation_y(turn), position: Vec3::new(x, 1.6, z) }
    }

    fn facing(rig: &Rig, head: Pose) -> Vec2 {
        ground_from_world(head.within(rig.world_from_room()).rotation * Vec3::NEG_Z)
    }

    #[test]
    fn the_user_begins_where_and_as_the_scene_says() {
        for heading in [0.0, FRAC_PI_2, 3.0, -1.0_f32] {
            let rig = Rig::new(Vec2::new(4.0, -2.0), heading);
            let at = head(0.0, 0.0, 0.0);
            assert!((rig.user(at) - Vec2::new(4.0, -2.0)).length() < 1e-5);
            assert!((facing(&rig, at) - Vec2::new(heading.sin(), heading.cos())).length() < 1e-5);
        }
    }

    #[test]
    fn a_snap_turns_about_the_user_once_a_push() {
        let mut rig = Rig::new(Vec2::ZERO, 0.0);
        let at = head(0.7, -0.4, 0.3);
        let (before, faced) = (rig.user(at), facing(&rig, at));
        let push = Walk { turn: 0.9, ..Walk::default() };
        for _ in 0..5 {
            rig.walk(&push, at, None, 0.01, |_| true);
        }
        assert!((rig.user(at) - before).length() < 1e-5);
        assert!(rig.vignette() > 0.5, "a turn darkens the edge for a moment");
        let turned = facing(&rig, at).angle_to(faced).abs();
        assert!((turned - SNAP).abs() < 1e-5, "{turned}");
        // to the right: seen from above with z down the page, clockwise
        let right = Vec2::new(-faced.y, faced.x);
        assert!(facing(&rig, at).dot(right) > 0.0);
    }

    #[test]
    fn the_stick_walks_as_the_head_faces_and_stops_at_walls() {
        let mut rig = Rig::new(Vec2::ZERO, 0.0);
        let at = head(0.0, 0.0, FRAC_PI_2);
        let ahead = facing(&rig, at);
        let push = Walk { stick: Vec2::Y, ..Walk::default() };
        for _ in 0..100 {
            rig.walk(&push, at, None, 0.01, |_| true);
        }
        assert!((rig.user(at) - ahead * WALK_SPEED).length() < 1e-3);
        assert!(rig.vignette() > 0.9);
        let stays = rig.user(at);
        rig.walk(&push, at, None, 1.0, |_| false);
        assert_eq!(rig.user(at), stays);
    }

    #[test]
    fn a_teleport_takes_the_user_where_the_hand_pointed_if_that_is_free_and_near() {
        let mut rig = Rig::new(Vec2::new(1.0, 1.0), 0.0);
        let at = head(0.2, 0.1, 0.0);
        let down = |pitch: f32| Pose { rotation: Quat::from_rotation_x(-pitch), position: Vec3::Y };
        let aim = Walk { aims: true, ..Walk::default() };
        rig.walk(&aim, at, Some(down(0.3)), 0.01, |_| true);
        let (place, is_allowed) = rig.aimed().unwrap();
        let shown = rig.teleport_shown(Some(down(0.3))).unwrap();
        assert!(is_allowed && shown.is_allowed && (shown.to.x - place.x).abs() < 1e-6 && shown.to.y == 0.0);
        assert!((shown.from.y - 1.0).abs() < 1e-6 && (shown.from.x - 1.0).abs() < 1e-5);
        rig.walk(&Walk::default(), at, Some(down(0.3)), 0.01, |_| true);
        assert!((rig.user(at) - place).length() < 1e-5 && rig.aimed().is_none());
        let stays = rig.user(at);
        for (hand, free, aimed) in
            [(down(0.06), true, Some(false)), (down(-0.3), true, None), (down(0.3), false, Some(false))]
        {
            rig.walk(&aim, at, Some(hand), 0.01, |_| free);
            assert_eq!(rig.aimed().map(|(_, is_allowed)| is_allowed), aimed);
            rig.walk(&Walk::default(), at, Some(hand), 0.01, |_| free);
            assert_eq!(rig.user(at), stays);
        }
    }

    #[test]
    fn recentring_brings_the_user_home() {
        let mut rig = Rig::new(Vec2::new(2.0, 3.0), 1.0);
        let at = head(1.5, -0.8, 2.2);
        rig.walk(&Walk { recentres: true, ..Walk::default() }, at, None, 0.01, |_| true);
        assert!((rig.user(at) - Vec2::new(2.0, 3.0)).length() < 1e-4);
        assert!((facing(&rig, at) - Vec2::new(1.0_f32.sin(), 1.0_f32.cos())).length() < 1e-4);
    }
}
