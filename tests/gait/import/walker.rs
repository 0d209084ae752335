//! A walker whose every position and foot strike is known exactly, and the file formats that carry it.

use gaitway::gait::{JOINT_COUNT, Joint, Pose, Recording};
use glam::{Quat, Vec3};
use std::f32::consts::{PI, TAU};
use std::fmt::Write;

/// An analytic walk on level ground: planted feet stand still, swinging feet follow a cycloid.
#[derive(Clone, Copy)]
pub(crate) struct Walker {
    /// Walking speed, m/s.
    pub(crate) speed: f32,
    /// Duration of a stride, s.
    pub(crate) cycle: f32,
    /// Time of the first left strike, s.
    pub(crate) first_strike: f32,
    /// Direction of travel about +y, radians.
    pub(crate) heading: f32,
    /// Turn per stride to the left, radians.
    pub(crate) turn: f32,
}

impl Default for Walker {
    fn default() -> Self {
        Self { speed: 1.2, cycle: 1.1, first_strike: 0.37, heading: 0.0, turn: 0.0 }
    }
}

/// Share of the stride that a foot is planted.
const STANCE: f32 = 0.62;

impl Walker {
    /// Position of the root's path on the ground and heading at a time, for a path that turns evenly.
    fn path(&self, t: f32) -> (Vec3, f32) {
        let rate = self.turn / self.cycle;
        let heading = self.heading + rate * t;
        let point = if rate.abs() < 1e-6 {
            Vec3::new(heading.sin(), 0.0, heading.cos()) * (self.speed * t)
        } else {
            Vec3::new(self.heading.cos() - heading.cos(), 0.0, heading.sin() - self.heading.sin())
                * (self.speed / rate)
        };
        (point, heading)
    }

    /// World position of an ankle; `side` is +1 left, -1 right.
    fn ankle(&self, t: f32, side: f32) -> Vec3 {
        let offset = if side > 0.0 { 0.0 } else { 0.5 };
        let cycles = (t - self.first_strike) / self.cycle + offset;
        let (whole, share) = (cycles.floor(), cycles.rem_euclid(1.0));
        // A foot lands below where the path will be at the middle of its stance.
        let print = |k: f32| {
            let middle = self.first_strike + (k - offset + STANCE / 2.0) * self.cycle;
            let (point, heading) = self.path(middle);
            point + Quat::from_rotation_y(heading) * Vec3::new(side * 0.09, 0.0, 0.0)
        };
        if share < STANCE {
            return print(whole);
        }
        let swing = (share - STANCE) / (1.0 - STANCE);
        let forward = (1.0 - (PI * swing).cos()) / 2.0;
        print(whole).lerp(print(whole + 1.0), forward) + Vec3::Y * (0.12 * (PI * swing).sin().powi(2))
    }

    /// The 16 joints at a time, m, y up; faces where it goes, left hand on its left.
    pub(crate) fn pose(&self, t: f32) -> Pose {
        let phase = (t - self.first_strike) / self.cycle;
        let (ground, heading) = self.path(t);
        let root = ground + Vec3::Y * (0.9 - 0.02 * (2.0 * TAU * phase).cos());
        figure(root, heading, |side| self.ankle(t, side), -0.25 * (TAU * phase).cos())
    }

    /// A take of some seconds.
    pub(crate) fn take(&self, seconds: f32, rate: f32) -> Recording {
        let frames = (0..).map(|i| i as f32 / rate).take_while(|t| *t < seconds);
        Recording::new("walker", rate, frames.map(|t| self.pose(t)).collect())
    }
}

/// The 16 joints of a figure with its ankles (+1 left, -1 right) where they are asked for; the left hand swings this far.
pub(crate) fn figure(root: Vec3, heading: f32, ankle: impl Fn(f32) -> Vec3, left_swing: f32) -> Pose {
    let body = |x: f32, y: f32, z: f32| root + Quat::from_rotation_y(heading) * Vec3::new(x, y, z);
    let mut pose = [root; JOINT_COUNT];
    pose[Joint::Spine as usize] = body(0.0, 0.2, 0.0);
    pose[Joint::Neck as usize] = body(0.0, 0.5, 0.01);
    pose[Joint::Head as usize] = body(0.0, 0.6, 0.03);
    for (side, shoulder, hip) in [(1.0, 4, 10), (-1.0, 7, 13)] {
        let swing = left_swing * side;
        pose[shoulder] = body(0.18 * side, 0.45, 0.0);
        pose[shoulder + 1] = body(0.22 * side, 0.17, swing / 2.0);
        pose[shoulder + 2] = body(0.22 * side, -0.05, 0.1 + swing);
        let (hip_point, ankle) = (body(0.09 * side, -0.02, 0.0), ankle(side));
        let leg = ankle - hip_point;
        let bend = (0.46_f32.powi(2) - leg.length_squared() / 4.0).max(0.0).sqrt();
        let front = (Quat::from_rotation_y(heading) * Vec3::Z).reject_from(leg.normalize()).normalize();
        pose[hip] = hip_point;
        pose[hip + 1] = (hip_point + ankle) / 2.0 + front * bend;
        pose[hip + 2] = ankle;
    }
    pose
}

/// Angles of a joint at a frame, degrees: arbitrary, so that any mistake of order or frame shows.
fn angles(joint: usize, frame: usize) -> [f32; 3] {
    [0, 1, 2].map(|axis| 40.0 * ((joint * 7 + axis * 3) as f32 + 0.3 * frame as f32).sin())
}

/// A BVH of a take: three position and three rotation channels at every joint, a rotation order per joint.
pub(crate) fn bvh(take: &Recording, scale: f32) -> String {
    const ORDERS: [[usize; 3]; 3] = [[2, 0, 1], [0, 1, 2], [1, 2, 0]];
    let mut text = "HIERARCHY\n".to_owned();
    open(&mut text, 0, &ORDERS);
    let rate = take.frame_rate;
    let _ = write!(text, "MOTION\nFrames: {}\nFrame Time: {}\n", take.poses.len(), 1.0 / rate);
    for (frame, pose) in take.poses.iter().enumerate() {
        let mut rotations = [Quat::IDENTITY; JOINT_COUNT];
        // Depth first, as the channels are written.
        for joint in depth_first(0) {
            let parent = Joint::PARENT[joint];
            let (origin, turned) =
                if joint == 0 { (Vec3::ZERO, Quat::IDENTITY) } else { (pose[parent], rotations[parent]) };
            let local = turned.inverse() * (pose[joint] - origin) * scale;
            let angles = angles(joint, frame);
            let order = ORDERS[joint % 3];
            let [a, b, c] =
                order.map(|axis| Quat::from_axis_angle(Vec3::AXES[axis], angles[axis].to_radians()));
            rotations[joint] = turned * (a * b * c);
            let [p, q, r] = order.map(|axis| angles[axis]);
            let _ = write!(text, "{} {} {} {p} {q} {r} ", local.y, local.x, local.z);
        }
        text.push('\n');
    }
    text
}

fn children(joint: usize) -> impl Iterator<Item = usize> {
    (1..JOINT_COUNT).filter(move |&child| Joint::PARENT[child] == joint)
}

fn depth_first(joint: usize) -> Vec<usize> {
    std::iter::once(joint).chain(children(joint).flat_map(depth_first)).collect()
}

fn open(text: &mut String, joint: usize, orders: &[[usize; 3]; 3]) {
    let kind = if joint == 0 { "ROOT" } else { "JOINT" };
    let [a, b, c] = orders[joint % 3].map(|axis| ["X", "Y", "Z"][axis]);
    let name = Joint::ALL[joint].name();
    let _ = write!(text, "{kind} {name}\n{{\nOFFSET 9 9 9\nCHANNELS 6 Yposition Xposition Zposition ");
    let _ = writeln!(text, "{a}rotation {b}rotation {c}rotation");
    children(joint).for_each(|child| open(text, child, orders));
    if children(joint).next().is_none() {
        text.push_str("End Site\n{\nOFFSET 0 0 1\n}\n");
    }
    text.push_str("}\n");
}

/// A CSV of takes with a column `key`, in E-Gait's names.
pub(crate) fn csv(takes: &[&Recording], scale: f32) -> String {
    let names = Joint::ALL.map(|joint| joint.name().replace("left_", "l_").replace("right_", "r_"));
    let mut text = "key,frame".to_owned();
    for name in names {
        let _ = write!(text, ",{name}_x,{name}_y,{name}_z");
    }
    for take in takes {
        for (frame, pose) in take.poses.iter().enumerate() {
            let _ = write!(text, "\n{},{frame}", take.name);
            for p in pose {
                let _ = write!(text, ",{},{},{}", p.x * scale, p.y * scale, p.z * scale);
            }
        }
    }
    text.push('\n');
    text
}

/// An ASF in CMU's names: a body in a T-pose facing +z whose left thigh has an axis frame of its own.
pub(crate) fn asf() -> String {
    let mut text =
        ":version 1.10\n:units\n  mass 1\n  length 0.45\n  angle deg\n:root\n  order TX TY TZ RX RY RZ\n  \
                    axis XYZ\n  position 0 0 0\n  orientation 0 0 0\n:bonedata\n"
            .to_owned();
    let mut hierarchy = String::new();
    let mut bone = |name: &str, parent: &str, direction: &str, length: f32, axis: &str| {
        let _ = writeln!(
            text,
            "begin\nid 1\nname {name}\ndirection {direction}\nlength {length}\naxis {axis} XYZ"
        );
        let _ = writeln!(text, "dof rx ry rz\nlimits (-1 1)\n(-1 1)\n(-1 1)\nend");
        let _ = writeln!(hierarchy, "{parent} {name}");
    };
    bone("upperback", "root", "0 1 0", 5.0, "0 0 0");
    bone("lowerneck", "upperback", "0 1 0", 1.5, "0 0 0");
    bone("head", "lowerneck", "0 1 0", 1.5, "0 0 0");
    for (side, x) in [("l", 1), ("r", -1)] {
        let out = format!("{x} 0 0");
        bone(&format!("{side}clavicle"), "upperback", &out, 3.0, "0 0 0");
        bone(&format!("{side}humerus"), &format!("{side}clavicle"), &out, 5.0, "0 0 0");
        bone(&format!("{side}radius"), &format!("{side}humerus"), &out, 4.0, "0 0 0");
        bone(&format!("{side}hand"), &format!("{side}radius"), &out, 1.0, "0 0 0");
        bone(&format!("{side}hipjoint"), "root", &out, 1.6, "0 0 0");
        bone(&format!("{side}femur"), &format!("{side}hipjoint"), "0 -1 0", 7.0, "0 90 0");
        bone(&format!("{side}tibia"), &format!("{side}femur"), "0 -1 0", 7.0, "0 0 0");
        bone(&format!("{side}foot"), &format!("{side}tibia"), "0 0 1", 2.0, "0 0 0");
    }
    format!("{text}:hierarchy\nbegin\n{hierarchy}end\n")
}

/// An AMC on [`asf`]: the left thigh swings by `rz` degrees in its axis frame, knees bend a little.
pub(crate) fn amc(frames: usize, rz: impl Fn(usize) -> f32) -> String {
    let mut text = "#!OML:ASF\n:FULLY-SPECIFIED\n:DEGREES\n".to_owned();
    for frame in 0..frames {
        let _ = writeln!(text, "{}\nroot 0 15 {} 0 0 0", frame + 1, frame as f32 * 0.1);
        for name in ["upperback", "lowerneck", "head"] {
            let _ = writeln!(text, "{name} 0 0 0");
        }
        for side in ["l", "r"] {
            for name in ["clavicle", "humerus", "radius", "hand", "hipjoint", "foot"] {
                let _ = writeln!(text, "{side}{name} 0 0 0");
            }
            let swing = if side == "l" { rz(frame) } else { 0.0 };
            let _ = writeln!(text, "{side}femur 0 0 {swing}\n{side}tibia 20 0 0");
        }
    }
    text
}
