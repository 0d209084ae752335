//! People who stand: what the kernels `pose` and `idle` make of them over time.

use gaitway::Emotion;
use gaitway::avatar::{Avatar, CLIP_FRAMES, Sex, generated};
use gaitway::gait::walker;
use gaitway::gait::{JOINT_COUNT, Joint};
use gaitway::kernels::idle::{
    ARMS_SPREAD, CHEST_FOLLOWS, CHEST_RISES, LOOK_FAR, LOOK_RAMP, SWAY_AHEAD, SWAY_ASIDE,
};
use gaitway::kernels::layout::{Appearance, Stance};
use gaitway::kernels::pose::{REST_SPREAD, SHIFT_LASTS};
use gaitway::kernels::shared::body::NONE;
use gaitway::kernels::shared::body::index::POSE_STRIDE;
use gaitway::kernels::{Phase, Store};
use gaitway::reference;
use gaitway::reference::body::CLIP_STRIDE;
use gaitway::reference::idle::{breath_of, look_of, sway_of};
use gaitway::sim::{AvatarSet, bodies};
use glam::{Mat4, Quat, Vec3, Vec4};
use std::collections::BTreeMap;
use std::f32::consts::TAU;

/// A picture of a headset lasts this long at most, ms.
const PICTURE: u32 = 14;

/// Has everyone walk so much, with the strides of their first gaits.
fn walk(store: &mut Store, walk_weight: f32) {
    store.heading.fill(0.0);
    for (own, [gait, ..]) in store.stance.iter_mut().zip(&store.gaits) {
        let [.., stride] = store.clip_frames[*gait as usize * CLIP_STRIDE + JOINT_COUNT];
        *own = Stance { phase: own.phase, walk_weight, stride, ..Stance::default() };
    }
}

/// Agents that stand, men and women in turns, of an emotion each.
struct People {
    store: Store,
    avatars: Vec<Avatar>,
}

impl People {
    fn new(emotions: &[Emotion]) -> Self {
        let gaits = Emotion::ALL.map(|emotion| walker::person(emotion, walker::Sex::Female, 1, 0).unwrap());
        let cast = AvatarSet::new(&gaits, Sex::ALL.map(generated).to_vec()).unwrap();
        let (clip_frames, rig) = (bodies::pack_clips(cast.clips()), bodies::pack_rig(cast.avatars()));
        let mut store = Store { clip_frames, rig, ..Store::default() };
        store.frame.clip_count = cast.clips().len() as u32;
        store.frame.standing_clips[0] = [cast.standing_index(0), cast.standing_index(1), 0, 0];
        for (agent, emotion) in emotions.iter().enumerate() {
            let avatar = agent as u32 & 1;
            store.visible.push(agent as u32);
            store.heading.push(0.0);
            store.stance.push(Stance::default());
            store.appearance.push(Appearance::new(avatar, *emotion as u32, false, 1.0, [0; 4]));
            store.gaits.push([0, 1, 2, 3].map(|gait| cast.clip_index(avatar, gait)));
            store.gait_weights.push([1.0, 0.0, 0.0, 0.0]);
        }
        store.visible.push(NONE);
        store.local_rotations = vec![[0.0; 4]; emotions.len() * POSE_STRIDE];
        Self { store, avatars: cast.avatars().to_vec() }
    }

    fn of(emotion: Emotion, count: usize) -> Self {
        Self::new(&vec![emotion; count])
    }

    fn pose_at(&mut self, time: u32) {
        self.store.frame.gaze_time = time;
        reference::run(Phase::Pose, &mut self.store, 0);
        reference::run(Phase::Feet, &mut self.store, 0);
        reference::run(Phase::Idle, &mut self.store, 0);
    }

    fn rotations(&self, agent: usize) -> [Quat; JOINT_COUNT] {
        let pose = &self.store.local_rotations[agent * POSE_STRIDE..][..JOINT_COUNT];
        std::array::from_fn(|joint| Quat::from_array(pose[joint]))
    }

    /// Model-space transform of each joint.
    fn joints(&self, agent: usize) -> [Mat4; JOINT_COUNT] {
        let root = Vec4::from_array(self.store.local_rotations[agent * POSE_STRIDE + JOINT_COUNT]).truncate();
        self.avatars[agent & 1].model_from_joint(&self.rotations(agent), root)
    }

    fn at(&self, agent: usize, joint: Joint) -> Vec3 {
        self.joints(agent)[joint as usize].w_axis.truncate()
    }

    /// How far forwards the trunk is pitched against the pelvis, rad.
    fn chest(&self, agent: usize) -> f32 {
        let ahead = self.rotations(agent)[Joint::Spine as usize] * Vec3::Z;
        -ahead.y.asin()
    }
}

/// Largest less smallest.
fn range(values: impl IntoIterator<Item = f32>) -> f32 {
    let (low, high) = values.into_iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(v), h.max(v)));
    high - low
}

#[test]
fn people_breathe_12_to_20_times_a_minute_by_time_and_each_at_an_own_rate() {
    for emotion in Emotion::ALL {
        let mut rates = Vec::new();
        for agent in 0..100 {
            let full = |time: u32| breath_of(agent, emotion.index(), time) > 0.0;
            let rises: Vec<u32> =
                (0..6000).map(|k| 50 * k).filter(|time| full(time + 50) && !full(*time)).collect();
            let (first, last) = (rises[0], rises[rises.len() - 1]);
            rates.push(60_000.0 * (rises.len() - 1) as f32 / (last - first) as f32);
        }
        println!("{emotion}: {:.1} and {range:.1} more a minute", rates[0], range = range(rates.clone()));
        assert!(rates.iter().all(|rate| (12.0..=20.0).contains(rate)), "{emotion}: {rates:?}");
        assert!(range(rates) > 3.0);
    }
    // as drawn: the chest rises and falls with it, whether or not the phase of a walk goes on
    let mut people = People::of(Emotion::Neutral, 4);
    for agent in 0..4 {
        let mut of_full = [Vec::new(), Vec::new()];
        for time in (0..60_000_u32).step_by(250) {
            people.store.stance.iter_mut().for_each(|stance| stance.phase = time.wrapping_mul(0x0123_4567));
            people.pose_at(time);
            let breath = breath_of(agent as u32, 3, time);
            if breath.abs() > 0.7 {
                of_full[usize::from(breath > 0.0)].push(people.chest(agent));
            }
        }
        let [empty, full] = of_full.map(|all| all.iter().sum::<f32>() / all.len() as f32);
        assert!((empty - full - 2.0 * 0.9 * CHEST_RISES).abs() < 0.25 * CHEST_RISES, "{empty} {full}");
    }
}

#[test]
fn of_ten_people_no_two_stand_alike() {
    for emotion in Emotion::ALL {
        let mut people = People::of(emotion, 20);
        for time in [0, 5_000, 3_600_000, 4_000_000_000] {
            people.pose_at(time);
            // those of one body
            for (a, b) in (0..10).flat_map(|a| (a + 1..10).map(move |b| (2 * a, 2 * b))) {
                let (a, b) = (people.rotations(a), people.rotations(b));
                let apart = a.iter().zip(b).map(|(a, b)| a.angle_between(b)).fold(0.0, f32::max);
                assert!(
                    apart > 2.0_f32.to_radians(),
                    "{emotion} at {time} ms: {} degrees",
                    apart.to_degrees()
                );
            }
        }
    }
}

#[test]
fn feet_stay_where_they_are_within_two_millimetres() {
    let emotions = Emotion::ALL.map(|emotion| [emotion; 6]).concat();
    let mut people = People::new(&emotions);
    // ankles, and the ends of both soles
    let points: Vec<Vec<(usize, Vec3)>> = people
        .avatars
        .iter()
        .map(|avatar| {
            let of_foot = |foot: Joint| {
                let sole = avatar.levels[0].vertices.iter().filter(move |v| {
                    usize::from(v.joints[0]) == foot as usize && v.weights[0] > 0.9 && v.position.y < 0.02
                });
                let by_z = |a: &Vec3, b: &Vec3| a.z.total_cmp(&b.z);
                let places: Vec<Vec3> = sole.map(|v| v.position).collect();
                let ends = [places.iter().copied().min_by(by_z), places.iter().copied().max_by(by_z)];
                let ankle = avatar.joints[foot as usize].joint_from_mesh.inverse().w_axis.truncate();
                ends.into_iter().flatten().chain([ankle]).map(|p| (foot as usize, p)).collect::<Vec<_>>()
            };
            [of_foot(Joint::LeftFoot), of_foot(Joint::RightFoot)].concat()
        })
        .collect();
    assert!(points.iter().all(|points| points.len() == 6));
    let mut paths: BTreeMap<(usize, usize), Vec<Vec3>> = BTreeMap::new();
    for time in (0..60_000).step_by(100) {
        people.pose_at(time);
        for agent in 0..emotions.len() {
            let joints = people.joints(agent);
            for (number, (foot, place)) in points[agent & 1].iter().enumerate() {
                let mesh = people.avatars[agent & 1].joints[*foot].joint_from_mesh;
                let at = joints[*foot].transform_point3(mesh.transform_point3(*place));
                paths.entry((agent, number)).or_default().push(at);
            }
        }
    }
    let mut worst = 0.0_f32;
    for ((agent, number), path) in paths {
        for axis in 0..3 {
            let moved = range(path.iter().map(|p| p[axis]));
            worst = worst.max(moved);
            assert!(moved < 0.002, "{} {agent}: point {number} moves {moved} m", emotions[agent]);
        }
    }
    println!("feet move by {worst} m at most");
}

#[test]
fn carriage_is_no_stronger_than_actors_show() {
    for (emotion, most) in [(Emotion::Sad, 16.0), (Emotion::Angry, 8.0)] {
        let mut people = People::of(emotion, 60);
        let mut worst = f32::MIN;
        for time in (0..120_000).step_by(500) {
            people.pose_at(time);
            for agent in 0..60 {
                let joints = people.joints(agent);
                let head = Joint::Head as usize;
                let ahead = joints[head] * people.avatars[agent & 1].joints[head].joint_from_mesh;
                let face = ahead.transform_vector3(Vec3::Z);
                let trunk = people.at(agent, Joint::Neck) - people.at(agent, Joint::Root);
                let found = if emotion == Emotion::Sad { -face.y.asin() } else { trunk.z.atan2(trunk.y) };
                worst = worst.max(found.to_degrees());
            }
        }
        println!("{emotion}: {worst:.1} of {most} degrees");
        assert!(worst < most && worst > 0.6 * most, "{emotion}: {worst}");
    }
}

#[test]
fn weight_shifts_every_8_to_30_seconds_and_twice_as_often_when_angry() {
    for emotion in Emotion::ALL {
        let mut people = People::of(emotion, 30);
        let mut side = vec![(false, 0); 30];
        let mut waits = Vec::new();
        for time in (0..600_000).step_by(100) {
            people.pose_at(time);
            for (agent, (is_left, since)) in side.iter_mut().enumerate() {
                let root = people.at(agent, Joint::Root).x;
                let feet = [Joint::LeftFoot, Joint::RightFoot].map(|foot| people.at(agent, foot).x);
                let over = root - 0.5 * (feet[0] + feet[1]);
                // half of a centimetre to one side: sway alone does not do that
                if (over.abs() > 0.005 && (over > 0.0) != *is_left) || *since == 0 {
                    if *since > 1 {
                        waits.push((time - *since) as f32 * 1e-3);
                    }
                    // the first wait began before the film
                    (*is_left, *since) = (over > 0.0, if *since == 0 { 1 } else { time });
                }
            }
        }
        let [least, most] = if emotion == Emotion::Angry { [4.0, 15.0] } else { [8.0, 30.0] };
        let mean = waits.iter().sum::<f32>() / waits.len() as f32;
        println!("{emotion}: {} shifts, {mean:.1} s apart in the mean", waits.len());
        let odd: Vec<_> = waits.iter().filter(|wait| !(least..=most).contains(*wait)).collect();
        assert!(odd.is_empty(), "{emotion}: {odd:?}");
        assert!((mean - 0.5 * (least + most)).abs() < 0.1 * most && range(waits) > 0.5 * (most - least));
    }
}

#[test]
fn hips_sway_by_five_to_ten_millimetres() {
    for agent in 0..40 {
        let ways = [(0, SWAY_AHEAD), (1, SWAY_ASIDE)].map(|(axis, most)| {
            0.93 * range((0..120_000).step_by(100).map(|time| most * sway_of(agent, axis, time)))
        });
        let larger = ways[0].max(ways[1]);
        assert!((0.005..0.010).contains(&larger) && ways.iter().all(|way| *way > 0.003), "{agent}: {ways:?}");
    }
    // as drawn: nothing else pitches the pelvis
    let mut people = People::of(Emotion::Neutral, 8);
    let mut pitches = vec![Vec::new(); 8];
    for time in (0..120_000).step_by(200) {
        people.pose_at(time);
        for (agent, pitches) in pitches.iter_mut().enumerate() {
            let ahead = people.rotations(agent)[Joint::Root as usize] * Vec3::Z;
            pitches.push(0.93 * -ahead.y);
        }
    }
    let ways: Vec<f32> = pitches.into_iter().map(range).collect();
    assert!(ways.iter().all(|way| (0.005..0.010).contains(way)), "{ways:?}");
}

#[test]
fn heads_look_aside_now_and_then_most_often_the_happy() {
    let shares = Emotion::ALL.map(|emotion| {
        let mut aside = 0;
        for agent in 0..40 {
            let looks: Vec<f32> =
                (0..1200).map(|k| look_of(agent, emotion.index(), 100 * k)[0].to_degrees()).collect();
            assert!(looks.iter().all(|look| look.abs() <= 25.0));
            // a look lasts one to four seconds
            for look in looks.split(|look| *look == 0.0).filter(|look| !look.is_empty()) {
                assert!(look.len() <= 41, "{emotion} {agent}: {} s", look.len() / 10);
            }
            aside += looks.iter().filter(|look| look.abs() > 5.0).count();
        }
        f64::from(aside as u32) / 48_000.0
    });
    println!("looks aside (happy, angry, sad, neutral): {shares:.2?} of the time");
    let [happy, angry, sad, neutral] = shares;
    assert!(happy > 1.3 * angry && angry > sad && neutral > sad && sad > 0.05 && happy < 0.6);
}

/// The most that a joint may turn between pictures, rad: what looks, breath and sway turn it, and the weight of a clip.
fn most_turn(store: &Store, emotion: Emotion) -> f32 {
    let first = store.frame.standing_clips[0][0] as usize;
    let frame = |clip: usize, number: usize, joint: usize| {
        let at = clip * CLIP_STRIDE + number % CLIP_FRAMES * POSE_STRIDE + joint;
        Quat::from_array(store.clip_frames[at])
    };
    let clips = first..first + 12;
    let steps = clips.flat_map(|clip| (0..CLIP_FRAMES).map(move |number| (clip, number)));
    let steepest = steps
        .flat_map(|(clip, number)| (0..JOINT_COUNT).map(move |joint| (clip, number, joint)))
        .map(|(clip, number, joint)| frame(clip, number, joint).angle_between(frame(clip, number + 1, joint)))
        .fold(0.0, f32::max);
    // an eased way is half as fast again in its middle as in the mean
    let loops = 0.5 + 2.0 * REST_SPREAD as f32 / u32::MAX as f32;
    let shift = 1.5 * loops * CLIP_FRAMES as f32 / SHIFT_LASTS[emotion.index()] as f32;
    let look = 1.5 * LOOK_FAR / LOOK_RAMP * (1.0 + CHEST_FOLLOWS);
    let slow = (CHEST_RISES + ARMS_SPREAD) * TAU * 20.0 / 60_000.0 + (SWAY_AHEAD + SWAY_ASIDE) * TAU / 3000.0;
    PICTURE as f32 * (shift * steepest + look + slow)
}

#[test]
fn no_joint_jumps_between_two_pictures() {
    for emotion in Emotion::ALL {
        let mut people = People::of(emotion, 12);
        let most = most_turn(&people.store, emotion);
        assert!(most < 3.5_f32.to_radians(), "the bound itself is of {} degrees", most.to_degrees());
        // from well within days
        let mut before: Option<Vec<[Quat; JOINT_COUNT]>> = None;
        let mut worst = 0.0_f32;
        for time in (86_400_000..86_460_000).step_by(PICTURE as usize) {
            people.pose_at(time);
            let now: Vec<_> = (0..12).map(|agent| people.rotations(agent)).collect();
            for (before, now) in before.iter().flatten().zip(&now) {
                let turned = before.iter().zip(now).map(|(a, b)| a.angle_between(*b)).fold(0.0, f32::max);
                worst = worst.max(turned);
            }
            before = Some(now);
        }
        println!("{emotion}: {:.2} of {:.2} degrees", worst.to_degrees(), most.to_degrees());
        assert!(worst < most && worst > 0.002, "{emotion}: {worst} rad, at most {most}");
    }
}

#[test]
fn who_walks_is_drawn_as_the_gait_says_at_any_time() {
    let mut people = People::of(Emotion::Happy, 4);
    walk(&mut people.store, 1.0);
    people.store.stance.iter_mut().for_each(|stance| stance.phase = 5 << 26);
    let gait = people.store.gaits[0][0] as usize;
    for time in [0, 77_777, u32::MAX] {
        people.pose_at(time);
        let frame = gait * CLIP_STRIDE + 5 * POSE_STRIDE;
        for element in 0..POSE_STRIDE {
            let drawn = Vec4::from_array(people.store.local_rotations[element]);
            let mut wanted = Vec4::from_array(people.store.clip_frames[frame + element]);
            if element == JOINT_COUNT {
                wanted.w = 1.0; // the stride, over that of the gait
            }
            assert!(drawn.abs_diff_eq(wanted, 1e-6), "{element}: {drawn} {wanted}");
        }
    }
    let posed = people.store.local_rotations.clone();
    reference::run(Phase::Idle, &mut people.store, 0);
    assert_eq!(posed, people.store.local_rotations);
}

#[test]
fn in_half_a_stride_the_upper_body_is_half_way_to_the_mean_of_its_gait_and_the_legs_are_not() {
    let mut people = People::of(Emotion::Happy, 1);
    walk(&mut people.store, 1.0);
    people.store.stance[0].stride *= 0.5;
    people.store.stance.iter_mut().for_each(|stance| stance.phase = 5 << 26);
    let first = people.store.gaits[0][0] as usize * CLIP_STRIDE;
    let rotation = |frame: usize, joint: usize| people.store.clip_frames[first + frame * POSE_STRIDE + joint];
    let wanted: [Quat; JOINT_COUNT] = std::array::from_fn(|joint| {
        let shown = Quat::from_array(rotation(5, joint));
        if joint == 0 || joint >= Joint::LeftHip as usize {
            return shown;
        }
        let frames = (0..CLIP_FRAMES).map(|frame| Quat::from_array(rotation(frame, joint)));
        let mean = frames.reduce(|sum, q| if sum.dot(q) < 0.0 { sum - q } else { sum + q }).unwrap();
        shown.lerp(mean.normalize(), 0.5)
    });
    let moved = wanted[Joint::LeftShoulder as usize]
        .angle_between(Quat::from_array(rotation(5, Joint::LeftShoulder as usize)));
    assert!(moved > 0.05, "the arm swings: {moved}");
    reference::run(Phase::Pose, &mut people.store, 0);
    for (joint, (drawn, wanted)) in people.rotations(0).into_iter().zip(wanted).enumerate() {
        assert!(drawn.angle_between(wanted) < 2e-3, "{joint}: {drawn} {wanted}");
    }
}

#[test]
fn stopping_and_changing_ones_mood_go_smoothly() {
    let mut people = People::of(Emotion::Happy, 8);
    let apart = |a: &People, b: &People| {
        let turned = |agent| {
            let pairs = a.rotations(agent).into_iter().zip(b.rotations(agent));
            pairs.map(|(a, b)| a.angle_between(b)).fold(0.0, f32::max)
        };
        (0..8).map(turned).fold(0.0, f32::max)
    };
    let mut steps = |set: &dyn Fn(&mut Store, f32)| {
        let mut worst = 0.0_f32;
        let mut before: Option<People> = None;
        for step in 0..=100u16 {
            set(&mut people.store, f32::from(step) / 100.0);
            people.pose_at(500_000);
            if let Some(before) = &before {
                worst = worst.max(apart(before, &people));
            }
            before = Some(People { store: people.store.clone(), avatars: people.avatars.clone() });
        }
        worst
    };
    let stopping = steps(&|store, share| walk(store, 1.0 - share));
    let saddening = steps(&|store, share| {
        store.gait_weights.fill([1.0 - share, 0.0, share, 0.0]);
        store.appearance.iter_mut().for_each(|own| own.set_emotion(if share > 0.55 { 2 } else { 0 }));
    });
    println!("in a hundredth of the way: {stopping} and {saddening} rad");
    assert!(stopping < 0.03 && (0.001..0.02).contains(&saddening), "{stopping} {saddening}");
}

#[test]
fn in_paper_mode_heads_are_left_to_the_formulas() {
    let mut people = People::of(Emotion::Happy, 30);
    let face = |people: &People, agent| {
        let [spine, neck, head] =
            [Joint::Spine, Joint::Neck, Joint::Head].map(|joint| people.rotations(agent)[joint as usize]);
        let ahead = spine * neck * head * Vec3::Z;
        ahead.x.atan2(ahead.z)
    };
    let mut turned = |mode: u32| {
        people.store.frame.gaze_mode = mode;
        let mut faces = vec![Vec::new(); 30];
        for time in (0..20_000).step_by(500) {
            people.pose_at(time);
            faces.iter_mut().enumerate().for_each(|(agent, all)| all.push(face(&people, agent)));
        }
        faces.into_iter().map(range).fold(0.0, f32::max)
    };
    assert!(turned(0) > 0.2 && turned(1) < 0.12, "{} {}", turned(0), turned(1));
}
