//! What people do in front of cameras besides walking: figures on the skeleton of [`Walker`], with where root and ankles
//! go as functions of time; and mirror images.

use super::walker;
use gaitway::gait::{Joint, Pose, Recording};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};

/// A figure that faces +z. Lengths in m, times in s; `side` is +1 left, -1 right.
pub(crate) struct Movement {
    pub(crate) name: &'static str,
    /// Root at a time.
    root: fn(f32) -> Vec3,
    /// Ankle at a time, over the ground.
    ankle: fn(f32, f32) -> Vec3,
}

/// A foot's own place.
fn home(side: f32) -> Vec3 {
    Vec3::new(0.1 * side, 0.0, 0.0)
}

/// Share of a period since it began, from 0 to 1.
fn share(t: f32, period: f32, offset: f32) -> f32 {
    (t / period + offset).rem_euclid(1.0)
}

/// 0 to 1 and back while `share` goes from `from` to `to`; 0 outside.
fn bump(share: f32, from: f32, to: f32) -> f32 {
    if (from..to).contains(&share) { (PI * (share - from) / (to - from)).sin().powi(2) } else { 0.0 }
}

/// 0 before `from`, 1 after `to`, smooth between.
fn ramp(share: f32, from: f32, to: f32) -> f32 {
    let t = ((share - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn standing(t: f32) -> Vec3 {
    Vec3::new(0.01 * t.sin(), 0.92, 0.015 * (1.3 * t).sin())
}

/// Offset of the phase of each foot: they take turns.
fn turn(side: f32) -> f32 {
    if side > 0.0 { 0.0 } else { 0.5 }
}

/// Feet that swing from `back` to `front` over a part of each stride and stand for the rest.
fn run(t: f32, side: f32, speed: f32, cycle: f32) -> Vec3 {
    let stance = 0.34;
    let cycles = t / cycle + turn(side);
    let (whole, part) = (cycles.floor(), cycles.rem_euclid(1.0));
    let print = |k: f32| home(side) * 0.5 + Vec3::Z * (speed * cycle * (k - turn(side) + stance / 2.0));
    if part < stance {
        return print(whole);
    }
    let swing = (part - stance) / (1.0 - stance);
    let forward = (1.0 - (PI * swing).cos()) / 2.0;
    print(whole).lerp(print(whole + 1.0), forward)
        + Vec3::Y * (0.4 * (PI * swing).sin() * (1.0 - 0.4 * swing))
}

/// What is no walking.
pub(crate) const OTHERS: [Movement; 15] = [
    Movement { name: "standing", root: standing, ankle: |_, side| home(side) },
    Movement {
        name: "boxing, bouncing on both feet",
        root: |t| standing(t) + Vec3::new(0.0, 0.03 * (TAU * 2.2 * t).sin(), 0.12 * (TAU * 0.4 * t).sin()),
        ankle: |t, side| {
            home(side)
                + Vec3::new(
                    0.0,
                    0.03 * (TAU * 2.2 * t).sin().max(0.0),
                    0.22 * side + 0.12 * (TAU * 0.4 * t).sin(),
                )
        },
    },
    Movement {
        name: "boxing, shifting the weight",
        root: |t| standing(t) + Vec3::new(0.05 * (TAU * t).sin(), 0.0, 0.06 * (TAU * t).sin()),
        ankle: |t, side| {
            let part = share(t, 1.0, turn(side));
            home(side) + Vec3::new(0.0, 0.04 * bump(part, 0.0, 0.4), 0.2 * side + 0.06 * bump(part, 0.1, 0.9))
        },
    },
    Movement {
        name: "boxing forwards, the left foot first",
        root: |t| standing(t) + Vec3::Z * (0.35 * t),
        ankle: |t, side| {
            let cycles = t / 0.8 + 0.5 * turn(side);
            let moved = cycles.floor() + ramp(cycles.rem_euclid(1.0), 0.0, 0.4);
            let lift = 0.04 * bump(cycles.rem_euclid(1.0), 0.0, 0.4);
            home(side) + Vec3::new(0.0, lift, 0.2 * side + 0.35 * 0.8 * (moved - 0.5 * turn(side)))
        },
    },
    Movement {
        name: "jumping jacks",
        root: |t| Vec3::new(0.0, 0.9 + 0.12 * (TAU * 1.1 * t).sin().abs(), 0.01 * (3.0 * t).sin()),
        ankle: |t, side| {
            let wide = 0.5 - 0.5 * (TAU * 0.55 * t).cos();
            home(side)
                + Vec3::new(0.3 * side * wide, 0.12 * (TAU * 1.1 * t).sin().abs(), 0.01 * (3.0 * t).sin())
        },
    },
    Movement {
        name: "squats",
        root: |t| Vec3::new(0.0, 0.7 + 0.2 * (TAU * 0.5 * t).cos(), -0.1 + 0.1 * (TAU * 0.5 * t).cos()),
        ankle: |_, side| home(side) * 1.5,
    },
    Movement {
        name: "dance: steps to the side",
        root: |t| standing(t) + Vec3::X * (0.3 * (TAU * 0.5 * t).sin()),
        ankle: |t, side| {
            let part = share(t, 2.0, turn(side));
            let out = ramp(part, 0.0, 0.2) - ramp(part, 0.5, 0.7);
            let lift = 0.06 * (bump(part, 0.0, 0.2) + bump(part, 0.5, 0.7));
            home(side) + Vec3::new(0.35 * side * out, lift, 0.0)
        },
    },
    Movement {
        name: "dance: forward and back",
        root: |t| standing(t) + Vec3::Z * (0.12 * (TAU * 0.5 * t).sin()),
        ankle: |t, side| {
            // Mambo: the left foot goes forward and home, then the right one backward and home.
            let part = share(t, 2.0, turn(side));
            let out = ramp(part, 0.0, 0.12) - ramp(part, 0.25, 0.37);
            let lift = 0.06 * (bump(part, 0.0, 0.12) + bump(part, 0.25, 0.37));
            home(side) + Vec3::new(0.0, lift, 0.3 * side * out)
        },
    },
    Movement {
        name: "dance: box step",
        root: |t| {
            let part = TAU * share(t, 3.0, 0.0);
            standing(t) + Vec3::new(0.15 * part.cos(), 0.0, 0.15 * part.sin())
        },
        ankle: |t, side| {
            // Forward, sideways, close; back, sideways, close.
            let part = share(t, 3.0, 0.0);
            let (a, b) = if side > 0.0 { ([0.0, 0.33], [0.66, 0.83]) } else { ([0.17, 0.33], [0.5, 0.83]) };
            let forward = ramp(part, a[0], a[0] + 0.14) - ramp(part, b[0], b[0] + 0.14);
            let right = ramp(part, a[1], a[1] + 0.14) - ramp(part, b[1], b[1] + 0.14);
            let lift = [a[0], a[1], b[0], b[1]].map(|at| bump(part, at, at + 0.14)).iter().sum::<f32>();
            home(side) + Vec3::new(-0.3 * right, 0.05 * lift, 0.3 * forward)
        },
    },
    Movement {
        name: "walking sideways",
        root: |t| standing(t) + Vec3::X * (0.5 * t),
        ankle: |t, side| {
            let cycles = t / 0.9 + 0.5 * turn(side);
            let moved = cycles.floor() + ramp(cycles.rem_euclid(1.0), 0.0, 0.4);
            let lift = 0.05 * bump(cycles.rem_euclid(1.0), 0.0, 0.4);
            home(side) + Vec3::new(0.05 * side + 0.5 * 0.9 * (moved - 0.5 * turn(side)), lift, 0.0)
        },
    },
    Movement {
        name: "marching on the spot",
        root: |t| standing(t) + Vec3::Y * (0.02 * (TAU * 2.0 * t).cos()),
        ankle: |t, side| {
            let up = bump(share(t, 1.0, turn(side)), 0.0, 0.45);
            home(side) + Vec3::new(0.0, 0.25 * up, 0.06 * up)
        },
    },
    Movement {
        name: "running on the spot",
        root: |t| standing(t) + Vec3::Y * (0.04 * (TAU * 2.0 * 1.5 * t).sin().abs()),
        ankle: |t, side| {
            let part = share(t, 1.0 / 1.5, turn(side));
            home(side) + Vec3::new(0.0, 0.3 * bump(part, 0.0, 0.65), -0.15 * bump(part, 0.0, 0.65))
        },
    },
    Movement {
        name: "lunges",
        root: |t| {
            Vec3::new(
                0.0,
                0.85 - 0.15 * bump(share(t, 1.2, 0.0), 0.1, 0.9),
                0.25 * bump(share(t, 1.2, 0.0), 0.1, 0.9),
            )
        },
        ankle: |t, side| {
            let part = share(t, 2.4, turn(side));
            let out = ramp(part, 0.0, 0.12) - ramp(part, 0.33, 0.45);
            let lift = 0.1 * (bump(part, 0.0, 0.12) + bump(part, 0.33, 0.45));
            home(side) + Vec3::new(0.0, lift, 0.6 * out)
        },
    },
    Movement {
        name: "jumping forwards on both feet",
        root: |t| {
            let (k, part) = ((t / 0.9).floor(), share(t, 0.9, 0.0));
            Vec3::new(0.0, 0.85 + 0.15 * bump(part, 0.3, 0.9), 0.6 * (k + ramp(part, 0.3, 0.9)))
        },
        ankle: |t, side| {
            let (k, part) = ((t / 0.9).floor(), share(t, 0.9, 0.0));
            home(side) + Vec3::new(0.0, 0.2 * bump(part, 0.35, 0.85), 0.6 * (k + ramp(part, 0.35, 0.85)))
        },
    },
    Movement {
        name: "hopping on the left foot",
        root: |t| {
            let (k, part) = ((t / 0.6).floor(), share(t, 0.6, 0.0));
            Vec3::new(0.0, 0.88 + 0.1 * bump(part, 0.3, 0.9), 0.4 * (k + ramp(part, 0.1, 1.0)))
        },
        ankle: |t, side| {
            let (k, part) = ((t / 0.6).floor(), share(t, 0.6, 0.0));
            if side > 0.0 {
                home(side) + Vec3::new(0.0, 0.12 * bump(part, 0.35, 0.85), 0.4 * (k + ramp(part, 0.35, 0.85)))
            } else {
                home(side) + Vec3::new(0.0, 0.35, 0.4 * (k + ramp(part, 0.1, 1.0)) - 0.1)
            }
        },
    },
];

/// Running at 3 m/s.
pub(crate) const RUNNING: Movement = Movement {
    name: "running",
    root: |t| Vec3::new(0.0, 0.86 + 0.04 * (2.0 * TAU * (t / 0.72 + 0.42)).sin(), 3.0 * t),
    ankle: |t, side| run(t, side, 3.0, 0.72),
};

impl Movement {
    /// A take of some seconds, everything shaken by noise of this standard deviation, m.
    pub(crate) fn take(&self, seconds: f32, rate: f32, noise: f32) -> Recording {
        let mut random = Noise(11);
        let frames = (0..).map(|i| i as f32 / rate).take_while(|t| *t < seconds);
        let poses = frames.map(|t| {
            let pose = walker::figure((self.root)(t), 0.0, |side| (self.ankle)(t, side), 0.0);
            pose.map(|point| point + Vec3::new(random.next(), random.next(), random.next()) * noise)
        });
        Recording::new(self.name, rate, poses.collect())
    }
}

/// Noise of standard deviation 1, from four uniform numbers each.
pub(crate) struct Noise(pub(crate) u64);

impl Noise {
    pub(crate) fn next(&mut self) -> f32 {
        let mut uniform = || {
            self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (self.0 >> 40) as f32 / (1_u64 << 24) as f32 - 0.5
        };
        (0..4).map(|_| uniform()).sum::<f32>() * 3.0_f32.sqrt()
    }
}

/// The mirror image of a pose: left and right exchanged, x negated.
pub(crate) fn mirrored_pose(pose: &Pose) -> Pose {
    Joint::ALL.map(|joint| pose[joint.mirrored() as usize] * Vec3::new(-1.0, 1.0, 1.0))
}

/// The mirror image of a take.
pub(crate) fn mirrored(take: &Recording) -> Recording {
    Recording { poses: take.poses.iter().map(mirrored_pose).collect(), ..take.clone() }
}

/// A take whose body is turned about the vertical through its root by an angle, as it goes on as before.
pub(crate) fn turned(take: &Recording, angle: f32) -> Recording {
    let turn = Quat::from_rotation_y(angle);
    let pose = |pose: &Pose| pose.map(|point| pose[0] + turn * (point - pose[0]));
    Recording { poses: take.poses.iter().map(pose).collect(), ..take.clone() }
}

/// A take as a treadmill of this speed (m/s, towards -z) has it.
pub(crate) fn on_treadmill(take: &Recording, speed: f32) -> Recording {
    let mut take = take.clone();
    for (i, pose) in take.poses.iter_mut().enumerate() {
        pose.iter_mut().for_each(|point| point.z -= speed * i as f32 / take.frame_rate);
    }
    take
}
