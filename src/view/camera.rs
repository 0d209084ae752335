//! The camera that the window's user steers: round a point, through the air, or after an agent.

use crate::render::Camera;
use crate::render::camera::{OrbitControl, wrap_heading};
use glam::{Vec2, Vec3};
use std::f32::consts::PI;

/// Flying speed at a walker's height, m/s; it grows with height, for the way is longer there.
const FLY_SPEED: f32 = 4.0;
/// Height per which the flying speed doubles, m.
const FLY_HEIGHT: f32 = 8.0;
/// Lowest a flying camera goes, m.
const LOWEST: f32 = 0.3;
/// Share of the distance that the orbit's target moves in a second while a key is held.
const PAN_RATE: f32 = 0.6;

/// How the camera is steered.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum CameraMode {
    /// Round a point on the ground.
    #[default]
    Orbit,
    /// Free, with the keys.
    Fly,
    /// Round the agent that is picked.
    Follow,
}

impl CameraMode {
    /// All, in the order of the panel, with their names.
    pub const ALL: [(Self, &str); 3] = [(Self::Orbit, "orbit"), (Self::Fly, "fly"), (Self::Follow, "follow")];
}

/// Which way the keys point: right, up and forwards, each -1, 0 or 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Push {
    /// To the right.
    pub right: f32,
    /// Upwards.
    pub up: f32,
    /// Forwards.
    pub forward: f32,
    /// Whether it is to go four times as fast.
    pub is_fast: bool,
}

/// The camera and how it is steered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rig {
    mode: CameraMode,
    orbit: OrbitControl,
    /// Flying: eye (m), heading about +y and pitch upwards (radians).
    eye: Vec3,
    heading: f32,
    pitch: f32,
}

impl Rig {
    /// An orbit that begins at `eye` and goes round `target`, m.
    pub fn new(eye: Vec3, target: Vec3) -> Self {
        let arm = eye - target;
        let orbit = OrbitControl {
            target,
            distance: arm.length().max(0.5),
            azimuth: arm.x.atan2(arm.z),
            elevation: arm.y.atan2(arm.x.hypot(arm.z)),
        };
        Self { mode: CameraMode::Orbit, orbit, eye, heading: 0.0, pitch: 0.0 }
    }

    /// How it is steered.
    pub const fn mode(&self) -> CameraMode {
        self.mode
    }

    /// Steers otherwise from now on, from where the camera is.
    pub fn set_mode(&mut self, mode: CameraMode) {
        if mode == self.mode {
            return;
        }
        let camera = self.camera();
        let forward = camera.forward();
        if mode == CameraMode::Fly {
            self.eye = camera.position;
            self.heading = forward.x.atan2(forward.z);
            self.pitch = forward.y.clamp(-1.0, 1.0).asin();
        } else if self.mode == CameraMode::Fly {
            // round the point on the ground that is looked at, if it is not too far
            let away = if forward.y < -0.05 { (self.eye.y / -forward.y).min(60.0) } else { 10.0 };
            let target = self.eye + forward * away;
            let mode = self.mode;
            *self = Self { mode, ..Self::new(self.eye, Vec3::new(target.x, target.y.max(0.0), target.z)) };
        }
        self.mode = mode;
    }

    /// The agent that is followed has come to `at` (m), if there is one.
    pub fn follow(&mut self, at: Option<Vec3>) {
        if let (CameraMode::Follow, Some(at)) = (self.mode, at) {
            self.orbit.target = at + Vec3::Y * 1.2;
        }
    }

    /// Turns by a drag of (x right, y down) in fractions of the frame's height.
    pub fn turn(&mut self, drag: Vec2) {
        if self.mode == CameraMode::Fly {
            self.heading = wrap_heading(self.heading + drag.x * 0.5 * PI);
            self.pitch = (self.pitch + drag.y * 0.5 * PI).clamp(-1.5, 1.5);
        } else {
            self.orbit.turn(drag);
        }
    }

    /// Moves along by a drag of (x right, y down) in fractions of the frame's height.
    pub fn pan(&mut self, drag: Vec2) {
        match self.mode {
            CameraMode::Orbit => self.orbit.pan(drag),
            CameraMode::Fly => {
                let (right, _) = self.ways();
                self.eye += (Vec3::Y * drag.y - right * drag.x) * self.eye.y.max(1.0);
                self.eye.y = self.eye.y.max(LOWEST);
            }
            CameraMode::Follow => self.orbit.turn(drag),
        }
    }

    /// Goes nearer by so many notches of a wheel, or away.
    pub fn zoom(&mut self, notches: f32) {
        if self.mode == CameraMode::Fly {
            let forward = self.camera().forward();
            self.eye += forward * (notches * 0.15 * self.speed());
            self.eye.y = self.eye.y.max(LOWEST);
        } else {
            self.orbit.zoom(0.9_f32.powf(notches.clamp(-20.0, 20.0)));
        }
    }

    /// Lets the keys that are held move it for `seconds`.
    pub fn push(&mut self, push: Push, seconds: f32) {
        let factor = if push.is_fast { 4.0 } else { 1.0 };
        match self.mode {
            CameraMode::Fly => {
                let (right, _) = self.ways();
                let way = right * push.right + Vec3::Y * push.up + self.camera().forward() * push.forward;
                self.eye += way * (self.speed() * factor * seconds);
                self.eye.y = self.eye.y.max(LOWEST);
            }
            CameraMode::Orbit => {
                self.orbit.pan(Vec2::new(-push.right, push.forward) * (PAN_RATE * factor * seconds));
                self.orbit.zoom((push.up * seconds).exp());
            }
            CameraMode::Follow => self.orbit.zoom(((push.up - push.forward) * seconds).exp()),
        }
    }

    /// The camera as it stands.
    pub fn camera(&self) -> Camera {
        match self.mode {
            CameraMode::Fly => Camera::user_eyes(self.eye, self.heading, self.pitch),
            _ => self.orbit.camera(),
        }
    }

    /// Right and forwards on the ground.
    fn ways(&self) -> (Vec3, Vec3) {
        let forward = Vec3::new(self.heading.sin(), 0.0, self.heading.cos());
        (forward.cross(Vec3::Y), forward)
    }

    fn speed(&self) -> f32 {
        FLY_SPEED * (1.0 + (self.eye.y / FLY_HEIGHT).clamp(0.0, 20.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(a: Vec3, b: Vec3) -> bool {
        (a - b).length() < 1e-3
    }

    #[test]
    fn changing_the_way_of_steering_does_not_move_the_view() {
        let mut rig = Rig::new(Vec3::new(12.0, 8.0, -9.0), Vec3::new(1.0, 0.0, 2.0));
        let before = rig.camera();
        assert!(near(before.position, Vec3::new(12.0, 8.0, -9.0)));
        for mode in [CameraMode::Fly, CameraMode::Orbit, CameraMode::Fly] {
            rig.set_mode(mode);
            assert_eq!(rig.mode(), mode);
            assert!(near(rig.camera().position, before.position), "{mode:?} {}", rig.camera().position);
            assert!(near(rig.camera().forward(), before.forward()), "{mode:?}");
        }
    }

    #[test]
    fn keys_fly_forwards_to_the_right_and_up_and_never_into_the_ground() {
        let mut rig = Rig::new(Vec3::new(0.0, 2.0, -10.0), Vec3::new(0.0, 2.0, 0.0));
        rig.set_mode(CameraMode::Fly);
        rig.push(Push { forward: 1.0, ..Push::default() }, 1.0);
        let ahead = rig.camera().position;
        assert!(ahead.z > -7.0 && ahead.x.abs() < 1e-3, "{ahead}");
        rig.push(Push { right: 1.0, ..Push::default() }, 1.0);
        // looking along +z with y up, right is -x
        assert!(rig.camera().position.x < -2.0, "{}", rig.camera().position);
        rig.push(Push { up: -1.0, is_fast: true, ..Push::default() }, 9.0);
        assert!((rig.camera().position.y - LOWEST).abs() < 1e-6);
    }

    #[test]
    fn dragging_to_the_right_turns_what_is_seen_to_the_right() {
        let mut rig = Rig::new(Vec3::new(0.0, 2.0, -10.0), Vec3::new(0.0, 2.0, 0.0));
        rig.set_mode(CameraMode::Fly);
        rig.turn(Vec2::new(0.1, 0.0));
        // the camera looks further left, so that things move to the right
        assert!(rig.camera().forward().x > 0.1, "{}", rig.camera().forward());
    }

    #[test]
    fn it_follows_the_picked_person() {
        let mut rig = Rig::new(Vec3::new(0.0, 5.0, 10.0), Vec3::ZERO);
        rig.follow(Some(Vec3::X * 50.0));
        assert!(rig.camera().position.x.abs() < 1e-3, "only when it is to follow");
        rig.set_mode(CameraMode::Follow);
        rig.follow(Some(Vec3::X * 50.0));
        rig.follow(None);
        assert!((rig.camera().position.x - 50.0).abs() < 1e-3);
        rig.push(Push { forward: 1.0, ..Push::default() }, 0.5);
        assert!((rig.camera().position - Vec3::X * 50.0).length() < 10.0);
    }
}
