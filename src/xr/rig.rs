//! Where the user's room stands in the world, and how thumbsticks move it. The room's floor follows the floors of the
//! scene: a user who walks up a ramp or a stair rises step by step, as agents do.

use super::views::Pose;
use crate::ground::{ground_from_world, heading_from_ground, world_from_ground};
use crate::render::Teleport;
use crate::scenario::Floors;
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

/// How fast the room's floor follows that under the user, 1/s: the steps of a stair are felt as a slope.
const SETTLE: f32 = 10.0;

/// Where the user may go.
pub struct Terrain<'a> {
    /// What there is to stand on.
    pub floors: &'a Floors,
    /// Whether a place on a floor of some height (m) is free.
    pub is_free: &'a dyn Fn(Vec2, f32) -> bool,
}

impl std::fmt::Debug for Terrain<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Terrain").field("floors", &self.floors.count()).finish_non_exhaustive()
    }
}

/// Where a user stands and faces.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stand {
    /// Place on the ground, m.
    pub position: Vec2,
    /// Height of the floor, m.
    pub elevation: f32,
    /// Heading about +y, radians.
    pub heading: f32,
}

/// What thumbsticks and buttons say in one frame; each stick -1 to 1, x to the right, y away from the user.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Walk {
    /// Walks, as the head faces.
    pub stick: Vec2,
    /// Turns: x of the other stick.
    pub turn: f32,
    /// Whether a place to teleport to is being pointed at.
    pub aims: bool,
    /// Whether to recentre the room.
    pub recentres: bool,
}

/// The user's room in the world, and the state of locomotion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rig {
    /// Where the room's origin is on the ground, m.
    origin: Vec2,
    /// Height of the room's floor, m.
    floor: f32,
    /// Height of the floor that the user stands on, m, which the room's follows.
    elevation: f32,
    /// Turn of the room about +y, radians.
    heading: f32,
    /// Where a recentred user stands, and how the room is turned then.
    home: Stand,
    has_snapped: bool,
    /// Place aimed at, its height, m, and whether the user may go there; taken when the aiming ends.
    aimed: Option<(Vec2, f32, bool)>,
    /// 0 none to 1: how much of the edge of the view is darkened while being moved.
    vignette: f32,
}

impl Rig {
    /// A room whose user, at its origin and facing its -z, stands and faces as `stand` says (a heading of 0 faces +z).
    pub fn new(stand: Stand) -> Self {
        let heading = stand.heading + std::f32::consts::PI;
        Self {
            origin: stand.position,
            floor: stand.elevation,
            elevation: stand.elevation,
            heading,
            home: Stand { heading, ..stand },
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

    /// Height of the floor that the user stands on, m.
    pub fn elevation(&self) -> f32 {
        self.elevation
    }

    /// The place that is being pointed at, its height, m, and whether the user may go there.
    pub fn aimed(&self) -> Option<(Vec2, f32, bool)> {
        self.aimed
    }

    /// The same as it is shown: from the hand, which is in the room, to the floor.
    pub(super) fn teleport_shown(&self, hand: Option<Pose>) -> Option<Teleport> {
        let ((place, height, is_allowed), hand) = self.aimed.zip(hand)?;
        let from = hand.within(self.world_from_room()).position;
        Some(Teleport { from, to: world_from_ground(place, height), is_allowed })
    }

    /// Moves the room for a frame of `seconds`. `head` and `hand` are in the room; `terrain` says where the user may be
    /// moved to. Walking in the room itself is never stopped. A user who walks off an edge there keeps their height.
    pub(super) fn walk(
        &mut self,
        walk: &Walk,
        head: Pose,
        hand: Option<Pose>,
        seconds: f32,
        terrain: &Terrain<'_>,
    ) {
        if walk.recentres {
            self.recentre(head);
        }
        self.snap(walk.turn, head);
        let moved = self.smooth(walk.stick, head, seconds, terrain);
        self.teleport(walk.aims, head, hand, terrain);
        self.elevation = terrain.floors.footing(self.user(head), self.elevation).unwrap_or(self.elevation);
        self.floor += (self.elevation - self.floor) * (SETTLE * seconds).clamp(0.0, 1.0);
        // quickly dark, slowly light again
        let goal = if moved { 1.0 } else { 0.0 };
        let rate = if moved { 8.0 } else { 3.0 };
        self.vignette += (goal - self.vignette) * (rate * seconds).clamp(0.0, 1.0);
    }

    /// Puts the user back to where the scene has them, facing as it says.
    fn recentre(&mut self, head: Pose) {
        self.heading = self.home.heading - yaw(head.rotation);
        self.origin = Vec2::ZERO;
        let stands = self.user(head);
        self.origin = self.home.position - stands;
        (self.elevation, self.floor) = (self.home.elevation, self.home.elevation);
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

    fn smooth(&mut self, stick: Vec2, head: Pose, seconds: f32, terrain: &Terrain<'_>) -> bool {
        let push = stick.length().min(1.0);
        if push < DEAD_ZONE {
            return false;
        }
        let facing = head.within(self.world_from_room()).rotation;
        let ahead = ground_from_world(facing * Vec3::NEG_Z).normalize_or_zero();
        let right = ground_from_world(facing * Vec3::X).normalize_or_zero();
        let step = (right * stick.x + ahead * stick.y).normalize_or_zero() * (push * WALK_SPEED * seconds);
        let at = self.user(head);
        // along a wall or an edge when not through it or off it
        for part in [step, Vec2::new(step.x, 0.0), Vec2::new(0.0, step.y)] {
            let footing = terrain.floors.footing(at + part, self.elevation);
            if footing.is_some_and(|height| (terrain.is_free)(at + part, height)) {
                self.origin += part;
                return part.length_squared() > 0.0;
            }
        }
        false
    }

    fn teleport(&mut self, aims: bool, head: Pose, hand: Option<Pose>, terrain: &Terrain<'_>) {
        if aims {
            let hand = hand.map(|hand| hand.within(self.world_from_room()));
            let user = self.user(head);
            self.aimed = hand
                .and_then(|hand| terrain.floors.hit(hand.position, hand.rotation * Vec3::NEG_Z))
                .filter(|(place, _)| place.distance(user) <= SHOWN_RANGE)
                .map(|(place, height)| {
                    let is_near = place.distance(user) <= TELEPORT_RANGE;
                    (place, height, is_near && (terrain.is_free)(place, height))
                });
        } else if let Some((place, height, true)) = self.aimed.take() {
            self.origin += place - self.user(head);
            (self.elevation, self.floor) = (height, height);
        }
    }
}

/// Turn about +y of a rotation that looks along -z.
fn yaw(rotation: Quat) -> f32 {
    heading_from_ground(-ground_from_world(rotation * Vec3::NEG_Z))
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests; heights are copies")]
mod tests {
    use super::*;
    use std::f32::consts::FRAC_PI_2;

    fn head(x: f32, z: f32, turn: f32) -> Pose {
        Pose { rotation: Quat::from_rotation_y(turn), position: Vec3::new(x, 1.6, z) }
    }

    fn at(x: f32, z: f32, heading: f32) -> Stand {
        Stand { position: Vec2::new(x, z), elevation: 0.0, heading }
    }

    /// The ground, all of it free or none.
    fn walk(rig: &mut Rig, walk: &Walk, head: Pose, hand: Option<Pose>, seconds: f32, free: bool) {
        let terrain = Terrain { floors: &Floors::default(), is_free: &|_, _| free };
        rig.walk(walk, head, hand, seconds, &terrain);
    }

    fn facing(rig: &Rig, head: Pose) -> Vec2 {
        ground_from_world(head.within(rig.world_from_room()).rotation * Vec3::NEG_Z)
    }

    #[test]
    fn the_user_begins_where_and_as_the_scene_says() {
        for heading in [0.0, FRAC_PI_2, 3.0, -1.0_f32] {
            let rig = Rig::new(at(4.0, -2.0, heading));
            let at = head(0.0, 0.0, 0.0);
            assert!((rig.user(at) - Vec2::new(4.0, -2.0)).length() < 1e-5);
            assert!((facing(&rig, at) - Vec2::new(heading.sin(), heading.cos())).length() < 1e-5);
        }
    }

    #[test]
    fn a_snap_turns_about_the_user_once_a_push() {
        let mut rig = Rig::new(at(0.0, 0.0, 0.0));
        let at = head(0.7, -0.4, 0.3);
        let (before, faced) = (rig.user(at), facing(&rig, at));
        let push = Walk { turn: 0.9, ..Walk::default() };
        for _ in 0..5 {
            walk(&mut rig, &push, at, None, 0.01, true);
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
        let mut rig = Rig::new(at(0.0, 0.0, 0.0));
        let at = head(0.0, 0.0, FRAC_PI_2);
        let ahead = facing(&rig, at);
        let push = Walk { stick: Vec2::Y, ..Walk::default() };
        for _ in 0..100 {
            walk(&mut rig, &push, at, None, 0.01, true);
        }
        assert!((rig.user(at) - ahead * WALK_SPEED).length() < 1e-3);
        assert!(rig.vignette() > 0.9);
        let stays = rig.user(at);
        walk(&mut rig, &push, at, None, 1.0, false);
        assert_eq!(rig.user(at), stays);
    }

    #[test]
    fn a_teleport_takes_the_user_where_the_hand_pointed_if_that_is_free_and_near() {
        let mut rig = Rig::new(at(1.0, 1.0, 0.0));
        let at = head(0.2, 0.1, 0.0);
        let down = |pitch: f32| Pose { rotation: Quat::from_rotation_x(-pitch), position: Vec3::Y };
        let aim = Walk { aims: true, ..Walk::default() };
        walk(&mut rig, &aim, at, Some(down(0.3)), 0.01, true);
        let (place, _, is_allowed) = rig.aimed().unwrap();
        let shown = rig.teleport_shown(Some(down(0.3))).unwrap();
        assert!(is_allowed && shown.is_allowed && (shown.to.x - place.x).abs() < 1e-6 && shown.to.y == 0.0);
        assert!((shown.from.y - 1.0).abs() < 1e-6 && (shown.from.x - 1.0).abs() < 1e-5);
        walk(&mut rig, &Walk::default(), at, Some(down(0.3)), 0.01, true);
        assert!((rig.user(at) - place).length() < 1e-5 && rig.aimed().is_none());
        let stays = rig.user(at);
        for (hand, free, aimed) in
            [(down(0.06), true, Some(false)), (down(-0.3), true, None), (down(0.3), false, Some(false))]
        {
            walk(&mut rig, &aim, at, Some(hand), 0.01, free);
            assert_eq!(rig.aimed().map(|(_, _, is_allowed)| is_allowed), aimed);
            walk(&mut rig, &Walk::default(), at, Some(hand), 0.01, free);
            assert_eq!(rig.user(at), stays);
        }
    }

    #[test]
    fn recentring_brings_the_user_home() {
        let mut rig = Rig::new(at(2.0, 3.0, 1.0));
        let at = head(1.5, -0.8, 2.2);
        walk(&mut rig, &Walk { recentres: true, ..Walk::default() }, at, None, 0.01, true);
        assert!((rig.user(at) - Vec2::new(2.0, 3.0)).length() < 1e-4);
        assert!((facing(&rig, at) - Vec2::new(1.0_f32.sin(), 1.0_f32.cos())).length() < 1e-4);
    }

    /// A ramp of ten metres along x up to a deck of 3 m, eight metres long, with railings along both, over a road.
    fn bridge() -> Floors {
        let scenario: crate::scenario::Scenario = toml::from_str(
            r#"
            name = "bridge"
            bounds = [[-40.0, -40.0], [40.0, -40.0], [40.0, 40.0], [-40.0, 40.0]]
            [[floors]]
            polygon = [[-14.0, -2.0], [-4.0, -2.0], [-4.0, 2.0], [-14.0, 2.0]]
            heights = [0.0, 3.0, 3.0]
            railings = [0, 2]
            [[floors]]
            polygon = [[-4.0, -2.0], [4.0, -2.0], [4.0, 2.0], [-4.0, 2.0]]
            heights = [3.0]
            railings = [0, 2]
            "#,
        )
        .unwrap();
        scenario.geometry().floors
    }

    #[test]
    fn the_stick_walks_up_a_ramp_and_no_farther_than_the_edge() {
        let floors = bridge();
        let is_free = |place, height| floors.admits(place, 0.3, height);
        let terrain = Terrain { floors: &floors, is_free: &is_free };
        let mut rig = Rig::new(at(-16.0, 0.0, FRAC_PI_2));
        let stands = head(0.0, 0.0, 0.0);
        let push = Walk { stick: Vec2::Y, ..Walk::default() };
        let mut fastest = 0.0_f32;
        let eyes = |rig: &Rig| stands.within(rig.world_from_room()).position;
        for _ in 0..2000 {
            let before = eyes(&rig).y;
            rig.walk(&push, stands, None, 0.011, &terrain);
            fastest = fastest.max((eyes(&rig).y - before).abs());
            let want = ((rig.user(stands).x + 14.0) * 0.3).clamp(0.0, 3.0);
            assert!((rig.elevation() - want).abs() < 0.01, "{} {want}", rig.elevation());
        }
        // at the far edge, where there is no ramp down
        assert!((3.5..4.03).contains(&rig.user(stands).x), "{}", rig.user(stands));
        assert!((eyes(&rig).y - 4.6).abs() < 1e-3 && fastest < 0.02, "{fastest} m in a frame");
        // aside there is a railing
        let aside = Walk { stick: Vec2::X, ..Walk::default() };
        (0..500).for_each(|_| rig.walk(&aside, stands, None, 0.011, &terrain));
        assert!(rig.user(stands).y.abs() < 1.71 && rig.elevation() == 3.0, "{}", rig.user(stands));
        // leaning over it, in the room, the user does not fall
        let over = head(3.0, 0.0, 0.0);
        rig.walk(&Walk::default(), over, None, 0.011, &terrain);
        assert!(floors.footing(rig.user(over), 3.0).is_none() && rig.elevation() == 3.0);
    }

    #[test]
    fn who_walks_under_the_bridge_stays_under_it() {
        let floors = bridge();
        let is_free = |place, height| floors.admits(place, 0.3, height);
        let terrain = Terrain { floors: &floors, is_free: &is_free };
        let mut rig = Rig::new(at(0.0, -8.0, 0.0));
        let stands = head(0.0, 0.0, 0.0);
        let push = Walk { stick: Vec2::Y, ..Walk::default() };
        (0..1000).for_each(|_| rig.walk(&push, stands, None, 0.011, &terrain));
        assert!(rig.user(stands).y > 8.0 && rig.elevation() == 0.0, "{}", rig.user(stands));
    }

    #[test]
    fn a_teleport_lands_on_the_floor_that_is_pointed_at() {
        let floors = bridge();
        let is_free = |place, height| floors.admits(place, 0.3, height);
        let terrain = Terrain { floors: &floors, is_free: &is_free };
        let stands = head(0.0, 0.0, 0.0);
        let aim = Walk { aims: true, ..Walk::default() };
        let pitched = |pitch: f32| Pose { rotation: Quat::from_rotation_x(-pitch), position: Vec3::Y };
        // from the deck down the ramp, and from the ground up at the deck's underside
        let deck = Stand { elevation: 3.0, ..at(0.0, 0.0, -FRAC_PI_2) };
        let mut rig = Rig::new(deck);
        rig.walk(&aim, stands, Some(pitched(0.4)), 0.011, &terrain);
        let (place, height, is_allowed) = rig.aimed().unwrap();
        assert!(
            is_allowed && (height - ((place.x + 14.0) * 0.3).clamp(0.0, 3.0)).abs() < 1e-4,
            "{place} {height}"
        );
        assert!((rig.teleport_shown(Some(pitched(0.4))).unwrap().to.y - height).abs() < 1e-6);
        rig.walk(&Walk::default(), stands, Some(pitched(0.4)), 0.011, &terrain);
        assert!((rig.user(stands) - place).length() < 1e-4 && (rig.elevation() - height).abs() < 1e-4);
        let mut below = Rig::new(at(0.0, 0.0, 0.0));
        below.walk(&aim, stands, Some(pitched(-0.9)), 0.011, &terrain);
        assert_eq!(below.aimed(), None);
        // over the railing to the ground
        let mut over = Rig::new(Stand { elevation: 3.0, ..at(0.0, 1.0, 0.0) });
        over.walk(&aim, stands, Some(pitched(0.7)), 0.011, &terrain);
        assert!(
            over.aimed()
                .is_some_and(|(place, height, is_allowed)| height == 0.0 && place.y > 2.0 && is_allowed)
        );
        // home again, upstairs
        rig.walk(&Walk { recentres: true, ..Walk::default() }, stands, None, 0.011, &terrain);
        assert!(rig.elevation() == 3.0 && rig.user(stands).length() < 1e-4);
    }
}
