//! Somebody who walks by the kernels `integrate`, `elevate`, `pose` and `feet`, and what is seen of it.

use gaitway::avatar::{Avatar, Sex, Vertex, generated};
use gaitway::gait::{Gait, JOINT_COUNT, Joint, walker};
use gaitway::kernels::layout::{Appearance, Body, Stance};
use gaitway::kernels::shared::body::NONE;
use gaitway::kernels::shared::body::index::POSE_STRIDE;
use gaitway::kernels::shared::floors::index::FLOOR_STRIDE;
use gaitway::kernels::{Phase, Store};
use gaitway::sim::{AvatarSet, bodies};
use gaitway::verify::cases::crossing::crossing;
use gaitway::{Emotion, reference};
use glam::{Mat4, Quat, Vec3, Vec4};

/// Pictures of a second.
pub const PICTURES: f32 = 120.0;

/// A point nearer to the ground is on it, m.
const TOUCHES: f32 = 0.0015;

/// Somebody who walks straight on.
pub struct Walker {
    pub store: Store,
    pub avatar: Avatar,
    /// Of the gait, m/s.
    pub speed: f32,
}

impl Walker {
    pub fn new(gait: Gait, avatar: Avatar, speed: f32) -> Self {
        let cast = AvatarSet::new(&[gait], vec![avatar.clone()]).unwrap();
        let clip = cast.clip(0);
        let mut store = crossing(1, 1.0);
        store.step.wrap = 0.0;
        (store.step.time_step, store.step.inverse_time_step) = (1.0 / PICTURES, PICTURES);
        let [foot_down, foot_stands] = cast.feet_of(0, 0, 1.0);
        let body = Body {
            radius: 0.25,
            max_speed: 3.0,
            preferred_speed: clip.speed,
            walk_ratio: clip.walk_ratio(),
            foot_down,
            foot_stands,
        };
        store.body = vec![body];
        store.position = vec![[0.0, 0.0]];
        store.elevation = vec![0.0];
        let stride = 2.0 * (speed * body.walk_ratio).sqrt();
        store.heading = vec![0.0];
        store.stance = vec![Stance { walk_weight: 1.0, stride, ..Stance::default() }];
        store.clip_frames = bodies::pack_clips(cast.clips());
        store.rig = bodies::pack_rig(cast.avatars());
        store.frame.clip_count = cast.clips().len() as u32;
        store.frame.standing_clips[0] = [cast.standing_index(0), 0, 0, 0];
        store.visible = vec![0, NONE];
        store.appearance = vec![Appearance::new(0, 3, false, 1.0, [0; 4])];
        store.gaits = vec![[0; 4]];
        store.gait_weights = vec![[1.0, 0.0, 0.0, 0.0]];
        store.local_rotations = vec![[0.0; 4]; POSE_STRIDE];
        Self { store, avatar, speed: clip.speed }
    }

    pub fn person(emotion: Emotion, sex: walker::Sex, share: f32) -> Self {
        let gait = walker::person(emotion, sex, 1, 0).unwrap();
        let body = generated(if sex == walker::Sex::Female { Sex::Female } else { Sex::Male });
        let speed = Self::new(gait.clone(), body.clone(), 1.0).speed;
        Self::new(gait, body, share * speed)
    }

    /// Goes on to the next picture at a velocity, m/s.
    pub fn go(&mut self, velocity: [f32; 2]) {
        self.store.agent_slot[0] = 0;
        self.store.new_velocity[0] = velocity;
        reference::run(Phase::Integrate, &mut self.store, 0);
        if self.store.step.floor_count > 0 {
            reference::run(Phase::Elevate, &mut self.store, 0);
        }
        self.draw();
    }

    /// Poses the body.
    pub fn draw(&mut self) {
        for phase in [Phase::Pose, Phase::Feet] {
            reference::run(phase, &mut self.store, 0);
        }
    }

    /// Lays floors: (low x, low z, high x, high z), then the plane's slopes along x and z and its height at the origin, m.
    pub fn lay(&mut self, floors: &[([f32; 4], [f32; 3])]) {
        self.store.step.floor_count = floors.len() as u32;
        self.store.floors.clear();
        for ([low_x, low_z, high_x, high_z], [a, b, c]) in floors {
            let edges = [[1.0, 0.0, -low_x], [0.0, 1.0, -low_z], [-1.0, 0.0, *high_x], [0.0, -1.0, *high_z]];
            self.store.floors.push([*a, *b, *c, 0.0]);
            self.store.floors.extend(edges.map(|[n, m, d]| [n, m, d, 0.0]));
            self.store.floors.extend([[0.0, 0.0, 1.0, 0.0]; FLOOR_STRIDE - 5]);
        }
    }

    /// The height of the floor at a point, m.
    pub fn floor(&self, at: Vec3) -> f32 {
        let count = self.store.step.floor_count as usize * FLOOR_STRIDE;
        let floors = &self.store.floors[..count];
        reference::elevate::standing(floors, [at.x, at.z], self.store.elevation[0]).height
    }

    /// World from joint, m.
    pub fn joints(&self) -> [Mat4; JOINT_COUNT] {
        let pose = &self.store.local_rotations;
        let rotations = std::array::from_fn(|joint| Quat::from_array(pose[joint]));
        let [x, z] = self.store.position[0];
        let root = Vec4::from_array(pose[JOINT_COUNT]).truncate();
        let heading = Quat::from_rotation_y(self.store.heading[0]);
        let world = Mat4::from_rotation_translation(heading, Vec3::new(x, self.store.elevation[0], z));
        self.avatar.model_from_joint(&rotations, root).map(|model| world * model)
    }

    /// Points of a sole up to the ball of the foot, m: the toes bend.
    pub fn sole(&self, foot: Joint) -> Vec<Vec3> {
        let foot = foot as usize;
        let is_sole =
            |v: &&Vertex| usize::from(v.joints[0]) == foot && v.weights[0] > 0.99 && v.position.y < 0.02;
        let vertices: Vec<_> = self.avatar.levels[0].vertices.iter().filter(is_sole).collect();
        let end = |end: fn(f32, f32) -> f32| vertices.iter().map(|v| v.position.z).reduce(end).unwrap();
        let (heel, tip) = (end(f32::min), end(f32::max));
        let world = self.joints()[foot] * self.avatar.joints[foot].joint_from_mesh;
        let behind_toes = vertices.into_iter().filter(|v| v.position.z <= heel + 0.73 * (tip - heel));
        behind_toes.map(|v| world.transform_point3(v.position)).collect()
    }

    /// Flexion of the left knee, degrees.
    pub fn knee(&self) -> f32 {
        let at = self.joints().map(|joint| joint.w_axis.truncate());
        let [hip, knee, foot] =
            [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot].map(|joint| at[joint as usize]);
        (knee - hip).angle_between(foot - knee).to_degrees()
    }
}

/// What a walk at one speed looked like, over some strides.
#[derive(Debug, Default)]
pub struct Seen {
    /// Farthest way of a point of a sole from where it touched the ground until it left it, m.
    pub slide: f32,
    /// In pictures in which it was on the ground in the one before, mean and most, m.
    pub moves: (f32, f32),
    /// The lowest point of a sole, above the floor, m.
    pub lowest: f32,
    /// Highest and lowest of the root, m.
    pub bob: f32,
    /// Way of the left hand ahead of the root, m.
    pub swing: f32,
    /// Left knee by percent of the stride, degrees.
    pub knee: Vec<f32>,
    /// Strides in the time, and their length, m.
    pub strides: f32,
    pub length: f32,
}

pub fn watch(walker: &mut Walker, speed: f32, seconds: f32) -> Seen {
    watch_all(walker, |_| [0.0, speed], seconds)
}

pub fn watch_all(walker: &mut Walker, velocity: impl Fn(f32) -> [f32; 2], seconds: f32) -> Seen {
    let feet = [Joint::LeftFoot, Joint::RightFoot];
    let mut seen = Seen { lowest: 1.0, ..Seen::default() };
    let mut marks: Vec<Option<(Vec3, Vec3)>> = Vec::new();
    let (mut roots, mut hands, mut knees) = (Vec::new(), Vec::new(), vec![(0.0, 0.0); 100]);
    let (mut total, mut count) = (0.0, 0.0);
    for picture in 0..(seconds * PICTURES) as u16 {
        let before = walker.store.stance[0].phase;
        walker.go(velocity(f32::from(picture) / PICTURES));
        let gone = walker.store.stance[0].phase.wrapping_sub(before) as f32 / 2.0_f32.powi(32);
        seen.strides += gone;
        let points = feet.map(|foot| walker.sole(foot)).concat();
        marks.resize(points.len(), None);
        for (mark, point) in marks.iter_mut().zip(points) {
            let above = point.y - walker.floor(point);
            seen.lowest = seen.lowest.min(above);
            if above >= TOUCHES {
                *mark = None;
                continue;
            }
            let (first, last) = mark.unwrap_or((point, point));
            if mark.is_some() {
                let moved = (point - last).with_y(0.0).length();
                (total, count) = (total + moved, count + 1.0);
                seen.moves.1 = seen.moves.1.max(moved);
            }
            seen.slide = seen.slide.max((point - first).with_y(0.0).length());
            *mark = Some((first, point));
        }
        let at = walker.joints().map(|joint| joint.w_axis.truncate());
        roots.push(at[Joint::Root as usize].y);
        hands.push(at[Joint::LeftHand as usize].z - at[Joint::Root as usize].z);
        let percent = (f64::from(walker.store.stance[0].phase) / 2.0_f64.powi(32) * 100.0) as usize;
        knees[percent] = (knees[percent].0 + walker.knee(), knees[percent].1 + 1.0);
    }
    seen.moves.0 = total / f32::max(count, 1.0);
    let range = |all: &[f32]| {
        let (low, high) = all.iter().fold((f32::MAX, f32::MIN), |(l, h), x| (l.min(*x), h.max(*x)));
        high - low
    };
    (seen.bob, seen.swing) = (range(&roots), range(&hands));
    seen.knee = knees.into_iter().map(|(sum, n)| sum / f32::max(n, 1.0)).collect();
    seen.length = walker.store.stance[0].stride;
    seen
}
