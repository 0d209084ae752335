//! People who go at other speeds than their gaits: what the kernels `integrate`, `pose` and `feet` make of them.

use gaitway::avatar::{Avatar, Sex, Vertex, generated};
use gaitway::gait::{Gait, JOINT_COUNT, Joint, walker};
use gaitway::kernels::layout::{Appearance, Body, Stance};
use gaitway::kernels::shared::body::NONE;
use gaitway::kernels::shared::body::index::POSE_STRIDE;
use gaitway::kernels::{Phase, Store};
use gaitway::sim::{AvatarSet, bodies};
use gaitway::verify::cases::crossing::crossing;
use gaitway::{Emotion, reference};
use glam::{Mat4, Quat, Vec3, Vec4};

/// Pictures of a second.
const PICTURES: f32 = 120.0;

/// A point nearer to the ground is on it, m.
const TOUCHES: f32 = 0.0015;

/// Somebody who walks straight on.
struct Walker {
    store: Store,
    avatar: Avatar,
    /// Of the gait, m/s.
    speed: f32,
}

impl Walker {
    fn new(gait: Gait, avatar: Avatar, speed: f32) -> Self {
        let cast = AvatarSet::new(&[gait], vec![avatar.clone()]).unwrap();
        let clip = cast.clip(0);
        let mut store = crossing(1, 1.0);
        store.step.wrap = 0.0;
        store.step.time_step = 1.0 / PICTURES;
        let body =
            Body { radius: 0.25, max_speed: 3.0, preferred_speed: clip.speed, walk_ratio: clip.walk_ratio() };
        store.body = vec![body];
        store.position = vec![[0.0, 0.0]];
        store.phase = vec![0];
        let stride = 2.0 * (speed * body.walk_ratio).sqrt();
        store.stance = vec![Stance { heading: 0.0, walk_weight: 1.0, stride, ..Stance::default() }];
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

    fn person(emotion: Emotion, sex: walker::Sex, share: f32) -> Self {
        let gait = walker::person(emotion, sex, 1, 0).unwrap();
        let body = generated(if sex == walker::Sex::Female { Sex::Female } else { Sex::Male });
        let speed = Self::new(gait.clone(), body.clone(), 1.0).speed;
        Self::new(gait, body, share * speed)
    }

    /// Goes on to the next picture at a velocity, m/s.
    fn go(&mut self, velocity: [f32; 2]) {
        self.store.agent_slot[0] = 0;
        self.store.new_velocity[0] = velocity;
        for phase in [Phase::Integrate, Phase::Pose, Phase::Feet] {
            reference::run(phase, &mut self.store, 0);
        }
    }

    /// World from joint, m.
    fn joints(&self) -> [Mat4; JOINT_COUNT] {
        let pose = &self.store.local_rotations;
        let rotations = std::array::from_fn(|joint| Quat::from_array(pose[joint]));
        let [x, z] = self.store.position[0];
        let root = Vec4::from_array(pose[JOINT_COUNT]).truncate();
        let heading = Quat::from_rotation_y(self.store.stance[0].heading);
        let world = Mat4::from_rotation_translation(heading, Vec3::new(x, 0.0, z));
        self.avatar.model_from_joint(&rotations, root).map(|model| world * model)
    }

    /// Points of a sole up to the ball of the foot, m: the toes bend.
    fn sole(&self, foot: Joint) -> Vec<Vec3> {
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
    fn knee(&self) -> f32 {
        let at = self.joints().map(|joint| joint.w_axis.truncate());
        let [hip, knee, foot] =
            [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot].map(|joint| at[joint as usize]);
        (knee - hip).angle_between(foot - knee).to_degrees()
    }
}

/// What a walk at one speed looked like, over some strides.
#[derive(Debug, Default)]
struct Seen {
    /// Farthest way of a point of a sole from where it touched the ground until it left it, m.
    slide: f32,
    /// In pictures in which it was on the ground in the one before, mean and most, m.
    moves: (f32, f32),
    /// The lowest point of a sole, m.
    lowest: f32,
    /// Highest and lowest of the root, m.
    bob: f32,
    /// Way of the left hand ahead of the root, m.
    swing: f32,
    /// Left knee by percent of the stride, degrees.
    knee: Vec<f32>,
    /// Strides in the time, and their length, m.
    strides: f32,
    length: f32,
}

fn watch(walker: &mut Walker, speed: f32, seconds: f32) -> Seen {
    watch_all(walker, |_| [0.0, speed], seconds)
}

fn watch_all(walker: &mut Walker, velocity: impl Fn(f32) -> [f32; 2], seconds: f32) -> Seen {
    let feet = [Joint::LeftFoot, Joint::RightFoot];
    let mut seen = Seen { lowest: 1.0, ..Seen::default() };
    let mut marks: Vec<Option<(Vec3, Vec3)>> = Vec::new();
    let (mut roots, mut hands, mut knees) = (Vec::new(), Vec::new(), vec![(0.0, 0.0); 100]);
    let (mut total, mut count) = (0.0, 0.0);
    for picture in 0..(seconds * PICTURES) as u16 {
        let before = walker.store.phase[0];
        walker.go(velocity(f32::from(picture) / PICTURES));
        let gone = walker.store.phase[0].wrapping_sub(before) as f32 / 2.0_f32.powi(32);
        seen.strides += gone;
        let points = feet.map(|foot| walker.sole(foot)).concat();
        marks.resize(points.len(), None);
        for (mark, point) in marks.iter_mut().zip(points) {
            seen.lowest = seen.lowest.min(point.y);
            if point.y >= TOUCHES {
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
        let percent = (f64::from(walker.store.phase[0]) / 2.0_f64.powi(32) * 100.0) as usize;
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

/// Shares of the gait's speed.
const SHARES: [f32; 7] = [0.25, 0.4, 0.5, 0.65, 0.8, 1.0, 1.2];

fn women() -> impl Iterator<Item = (Emotion, f32, Seen)> {
    let all = Emotion::ALL.into_iter().flat_map(|emotion| SHARES.map(|share| (emotion, share)));
    all.map(|(emotion, share)| {
        let mut walker = Walker::person(emotion, walker::Sex::Female, share);
        let speed = share * walker.speed;
        (emotion, share, watch(&mut walker, speed, 6.0 / share.sqrt()))
    })
}

#[test]
fn length_and_rate_of_strides_go_with_the_root_of_the_speed() {
    for emotion in Emotion::ALL {
        let mut own = Walker::person(emotion, walker::Sex::Male, 1.0);
        let gait = own.speed;
        let usual_length = watch(&mut own, gait, 4.0).length;
        for share in SHARES {
            let mut walker = Walker::person(emotion, walker::Sex::Male, share);
            let speed = share * walker.speed;
            let seen = watch(&mut walker, speed, 10.0);
            assert!((seen.length / usual_length - share.sqrt()).abs() < 0.001, "{emotion} {share}: {seen:?}");
            assert!((seen.strides * seen.length - 10.0 * speed).abs() < 0.01, "{emotion} {share}: {seen:?}");
        }
    }
}

#[test]
fn planted_feet_stay_on_the_ground_and_where_they_are_at_every_speed() {
    for (emotion, share, seen) in women() {
        let (mean, most) = seen.moves;
        println!(
            "{emotion} {share}: {mean} m a picture, {most} at most; {} m in all; low {}",
            seen.slide, seen.lowest
        );
        assert!(
            mean < 0.0001 && seen.slide < 0.02,
            "{emotion} at {share}: {mean} m a picture, {} in all",
            seen.slide
        );
        assert!(seen.lowest > -0.001, "{emotion} at {share}: {} m below the ground", -seen.lowest);
    }
}

#[test]
fn who_goes_slower_swings_and_bobs_less() {
    for emotion in Emotion::ALL {
        let all: Vec<Seen> = women().filter(|(own, ..)| *own == emotion).map(|(.., seen)| seen).collect();
        for (slower, faster) in all.iter().zip(&all[1..]) {
            let [bob, swing] = [slower.bob / faster.bob, slower.swing / faster.swing];
            assert!(bob < 1.0 && swing < 1.01, "{emotion}: {bob} of the bob, {swing} of the swing");
        }
        let [slowest, .., usual, _] = &all[..] else { unreachable!("there are more shares") };
        assert!(slowest.bob < 0.4 * usual.bob && slowest.swing < 0.6 * usual.swing, "{emotion}");
    }
}

/// Schwartz et al. 2008, slow, free and fast: flexion of the knee under load and in swing, degrees.
#[test]
fn knees_give_and_bend_by_speed_as_measured() {
    for (speed, load, swing) in [(0.8, 12.0, 54.0), (1.25, 19.0, 58.0), (1.7, 23.0, 60.0)] {
        let body = Walker::person(Emotion::Neutral, walker::Sex::Female, 1.0);
        let mut walker = Walker::person(Emotion::Neutral, walker::Sex::Female, speed / body.speed);
        let seen = watch(&mut walker, speed, 8.0);
        let most = |range: std::ops::Range<usize>| seen.knee[range].iter().fold(0.0, |a: f32, b| a.max(*b));
        let found = [most(5..25), most(55..90)];
        println!("{speed} m/s: {found:.1?} degrees");
        assert!((found[0] - load).abs() < 5.0 && (found[1] - swing).abs() < 10.0, "{speed} m/s: {found:?}");
    }
}

#[test]
fn nothing_jumps_while_somebody_sets_off_hurries_and_stops() {
    for emotion in Emotion::ALL {
        let mut walker = Walker::person(emotion, walker::Sex::Male, 1.0);
        let own = walker.speed;
        walker.store.stance[0] = Stance::default();
        let mut before: Option<[Quat; JOINT_COUNT]> = None;
        let mut worst = 0.0_f32;
        for picture in 0..1200u16 {
            let time = f32::from(picture) / PICTURES;
            let speed = match time {
                ..2.0 => 0.0,
                ..5.0 => own * (0.5 * (time - 2.0)).min(1.0),
                ..7.0 => 1.3 * own,
                _ => (1.3 * own - 1.5 * (time - 7.0)).max(0.0),
            };
            walker.go([0.0, speed]);
            let joints = walker.joints().map(|joint| joint.to_scale_rotation_translation().1);
            if let Some(before) = before {
                let turned = before.iter().zip(&joints).map(|(a, b)| a.angle_between(*b));
                worst = worst.max(turned.fold(0.0, f32::max));
            }
            before = Some(joints);
        }
        println!("{emotion}: {:.1} degrees in a picture", worst.to_degrees());
        assert!(worst.to_degrees() < 7.0, "{emotion}: {} degrees", worst.to_degrees());
    }
}

/// Puts somebody who walks at the gait's speed at a phase of the stride, and stands still from then on.
fn stopped(emotion: Emotion, phase: u32) -> (Walker, Seen) {
    let mut walker = Walker::person(emotion, walker::Sex::Female, 1.0);
    let speed = walker.speed;
    watch(&mut walker, speed, 3.0);
    while (walker.store.phase[0].wrapping_sub(phase) as i32).unsigned_abs() > 1 << 26 {
        walker.go([0.0, speed]);
    }
    let seen = watch(&mut walker, 0.0, 4.0);
    (walker, seen)
}

#[test]
fn who_stops_finishes_the_step() {
    for (emotion, part) in Emotion::ALL.into_iter().flat_map(|e| (0..8u32).map(move |part| (e, part))) {
        let (walker, seen) = stopped(emotion, part << 29);
        let own = walker.store.stance[0];
        println!(
            "{emotion} {part}: {:?} slide {}, {} strides; {own:?}",
            seen.moves, seen.slide, seen.strides
        );
    }
}

#[test]
fn who_turns_on_the_spot_steps() {
    for emotion in Emotion::ALL {
        let (mut walker, _) = stopped(emotion, 0);
        // slower than anybody walks
        let seen = watch_all(&mut walker, |time| if time < 2.0 { [-0.06, -0.01] } else { [0.0, 0.0] }, 5.0);
        let own = walker.store.stance[0];
        println!("{emotion}: {:?} slide {}, {} strides; {own:?}", seen.moves, seen.slide, seen.strides);
    }
}

#[test]
fn who_goes_in_circles_plants_the_feet() {
    for (emotion, radius) in Emotion::ALL.into_iter().flat_map(|e| [1.0, 2.0, 5.0].map(|radius| (e, radius)))
    {
        let mut walker = Walker::person(emotion, walker::Sex::Female, 0.8);
        let speed = 0.8 * walker.speed;
        let way = |time: f32| {
            let (sine, cosine) = (time * speed / radius).sin_cos();
            [speed * sine, speed * cosine]
        };
        let seen = watch_all(&mut walker, way, 10.0);
        println!("{emotion} {radius}: {:?} slide {} {:?}", seen.moves, seen.slide, walker.store.stance[0]);
    }
}
