//! A small analytic walker: enough of a gait to test retargeting, with known foot strikes.

use gaitway::gait::{Gait, JOINT_COUNT, Joint, Pose};
use glam::Vec3;
use std::f32::consts::{PI, TAU};

/// Parameters of the walker.
#[derive(Debug, Clone, Copy)]
pub struct Walker {
    pub speed: f32,
    pub cycle_time: f32,
    pub frames: usize,
    /// Size of the whole person; 1 is a leg of 0.84 m.
    pub size: f32,
    /// Forward lean of back and head, radians.
    pub slump: f32,
    /// Arm swing, radians.
    pub swing: f32,
}

impl Walker {
    pub const fn at(speed: f32, cycle_time: f32) -> Self {
        Self { speed, cycle_time, frames: 36, size: 1.0, slump: 0.06, swing: 0.4 }
    }

    /// Ankle in model space, phase counted from the foot's own strike.
    fn ankle(&self, phase: f32, x: f32) -> Vec3 {
        let travel = self.speed * self.cycle_time / self.size;
        let stance = 0.6;
        let u = phase.rem_euclid(1.0);
        let half = 0.5 * travel * stance;
        let back = 0.07 * travel;
        if u < stance {
            let late = ((u / stance - 0.65) / 0.35).max(0.0);
            return Vec3::new(x, 0.08 + 0.10 * late * late, half - back - travel * u + 0.06 * late * late);
        }
        let t = (u - stance) / (1.0 - stance);
        let ease = t * t * (3.0 - 2.0 * t);
        let lift = 0.10 * (1.0 - t) + 0.06 * (PI * t).sin();
        Vec3::new(
            x,
            0.08 + lift,
            (-half - back + 0.06) + (2.0 * half - 0.06) * (ease + 0.04 * (TAU * t).sin()),
        )
    }

    fn pose(&self, phase: f32) -> Pose {
        let mut p = [Vec3::ZERO; JOINT_COUNT];
        let set = |p: &mut Pose, joint: Joint, v: Vec3| p[joint as usize] = v;
        let bob = -0.015 * (2.0 * TAU * phase).cos();
        let sway = 0.02 * (TAU * (phase - 0.05)).sin();
        let root = Vec3::new(sway, 0.935 + bob, 0.0);
        let turn = 0.09 * (TAU * phase).cos();
        let lean = Vec3::new(0.0, self.slump.cos(), self.slump.sin());
        set(&mut p, Joint::Root, root);
        let spine = root + lean * 0.13;
        set(&mut p, Joint::Spine, spine);
        set(&mut p, Joint::Neck, spine + lean * 0.38);
        let head = 2.0 * self.slump;
        set(&mut p, Joint::Head, spine + lean * 0.38 + Vec3::new(0.0, head.cos(), head.sin()) * 0.12);
        for (side, left) in [(1.0, true), (-1.0, false)] {
            let own = phase + if left { 0.0 } else { 0.5 };
            let pick = |joint: Joint| if left { joint } else { joint.mirrored() };
            let across = |turn: f32, x: f32| Vec3::new(x * turn.cos(), 0.0, -x * turn.sin());
            let shoulder = spine + lean * 0.33 + across(turn, side * 0.18);
            // The arm swings against its own leg.
            let angle = -self.swing * (TAU * own).cos() + 0.05;
            let upper = Vec3::new(side * 0.12, -angle.cos(), angle.sin()).normalize();
            let bent = angle + 0.3 + 0.15 * (TAU * own).cos().abs();
            let fore = Vec3::new(side * 0.02, -bent.cos(), bent.sin()).normalize();
            let elbow = shoulder + upper * 0.29;
            set(&mut p, pick(Joint::LeftShoulder), shoulder);
            set(&mut p, pick(Joint::LeftElbow), elbow);
            set(&mut p, pick(Joint::LeftHand), elbow + fore * 0.25);
            let hip = root + across(-turn * 0.6, side * 0.09) - Vec3::Y * 0.04;
            let mut ankle = self.ankle(own, side * 0.06);
            let (thigh, shin) = (0.43, 0.41);
            let reach = (ankle - hip).clamp_length_max(0.999 * (thigh + shin));
            ankle = hip + reach;
            let d = reach.length();
            let along = (thigh * thigh - shin * shin + d * d) / (2.0 * d);
            let dir = reach / d;
            let bend = (Vec3::Z - dir * dir.z).normalize();
            let knee = hip + dir * along + bend * (thigh * thigh - along * along).max(0.0).sqrt();
            set(&mut p, pick(Joint::LeftHip), hip);
            set(&mut p, pick(Joint::LeftKnee), knee);
            set(&mut p, pick(Joint::LeftFoot), ankle);
        }
        p.map(|v| v * self.size)
    }

    pub fn gait(&self) -> Gait {
        let poses = (0..self.frames).map(|i| self.pose(i as f32 / self.frames as f32)).collect();
        Gait {
            name: format!("walk-{}", self.speed),
            poses,
            frame_rate: self.frames as f32 / self.cycle_time,
            speed: self.speed,
            ..Gait::default()
        }
    }
}

/// Left and right exchanged.
pub fn mirrored(gait: &Gait) -> Gait {
    let mirror = |pose: &Pose| -> Pose {
        std::array::from_fn(|j| pose[Joint::ALL[j].mirrored() as usize] * Vec3::new(-1.0, 1.0, 1.0))
    };
    Gait { poses: gait.poses.iter().map(mirror).collect(), ..gait.clone() }
}
