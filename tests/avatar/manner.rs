//! Agents as individuals: what the kernel `manner` makes of a gait that many walk.

use crate::physique::adults;
use gaitway::avatar::anthropometry::Build;
use gaitway::avatar::{Avatar, CLIP_FRAMES, Sex, generated};
use gaitway::gait::{JOINT_COUNT, Joint, walker};
use gaitway::kernels::layout::{Appearance, Body, Stance};
use gaitway::kernels::manner::{DRAWS_OF_ARM, DRAWS_OF_TRUNK};
use gaitway::kernels::shared::body::NONE;
use gaitway::kernels::shared::body::index::{PALETTE_STRIDE, POSE_STRIDE};
use gaitway::kernels::{Phase, Store};
use gaitway::library::GaitLibrary;
use gaitway::reference::manner::own_share;
use gaitway::sim::{AvatarSet, bodies, order};
use gaitway::verify::cases::crossing::crossing;
use gaitway::{Emotion, reference};
use glam::{Mat4, Quat, Vec3, Vec4};

/// Leg length to which bodies are scaled where places of joints are compared, m.
const LEG: f32 = 0.87;
/// Phases of a stride at which bodies are looked at.
const PHASES: u32 = 16;
/// Pictures of a second.
const PICTURES: f32 = 120.0;
const ARMS: [[Joint; 3]; 2] = [
    [Joint::LeftShoulder, Joint::LeftElbow, Joint::LeftHand],
    [Joint::RightShoulder, Joint::RightElbow, Joint::RightHand],
];

/// Places of the joints from the root, m.
type Places = [Vec3; JOINT_COUNT];

/// Agents that walk with the built-in gaits of one emotion, each on a body of its gait's sex.
struct People {
    store: Store,
    avatars: Vec<Avatar>,
}

impl People {
    /// The gait of an agent is the one that `gait_of` names.
    fn new(emotion: Emotion, count: usize, gait_of: impl Fn(usize) -> usize) -> Self {
        let library = GaitLibrary::built_in().unwrap();
        let ids = library.gaits_for(emotion);
        let gaits: Vec<_> = ids.iter().map(|id| library.gaits()[*id as usize].clone()).collect();
        let cast = AvatarSet::new(&gaits, Sex::ALL.map(generated).to_vec()).unwrap();
        let mut store = crossing(count, 3.0);
        store.clip_frames = bodies::pack_clips(cast.clips());
        store.rig = bodies::pack_rig(cast.avatars());
        store.frame.clip_count = cast.clips().len() as u32;
        store.frame.standing_clips[0] = [cast.standing_index(0), cast.standing_index(1), 0, 0];
        store.frame.individuals = 1.0;
        store.step.time_step = 1.0 / PICTURES;
        store.visible = (0..count as u32).chain([NONE]).collect();
        for agent in 0..count {
            let gait = &gaits[gait_of(agent)];
            let avatar = u32::from(gait.provenance.sex == Some(walker::Sex::Male));
            let clip = cast.clip_index(avatar, gait_of(agent) as u32);
            let shown = cast.clip(clip);
            store.body[agent] = Body { walk_ratio: shown.walk_ratio(), ..store.body[agent] };
            store.heading[agent] = 0.0;
            let phase = store.stance[agent].phase;
            store.stance[agent] =
                Stance { phase, walk_weight: 1.0, stride: shown.stride_travel, ..Stance::default() };
            store.appearance.push(Appearance::new(avatar, emotion as u32, false, 1.0, [0; 4]));
            store.gaits.push([clip; 4]);
            store.gait_weights.push([1.0, 0.0, 0.0, 0.0]);
        }
        store.local_rotations = vec![[0.0; 4]; count * POSE_STRIDE];
        Self { store, avatars: cast.avatars().to_vec() }
    }

    /// All with the same gait.
    fn of_one_gait(emotion: Emotion, count: usize) -> Self {
        Self::new(emotion, count, |_| 2)
    }

    /// With as many gaits as there are.
    fn of_all_gaits(emotion: Emotion, count: usize) -> Self {
        Self::new(emotion, count, |agent| agent % 12)
    }

    /// Their bodies become those of adults as in ANSUR II.
    fn built_as_adults(mut self) -> Self {
        let count = self.store.appearance.len();
        let adults = Sex::ALL.map(|sex| adults(sex, count));
        for (agent, looks) in self.store.appearance.iter_mut().enumerate() {
            let person = &adults[looks.avatar() as usize][agent];
            looks.scale = Build::scale(person);
            let build = Build::of(person, looks.scale);
            looks.set_size(build.stature, build.breadth);
            self.store.physique.push(build.physique);
            self.store.position[agent] = [0.0; 2];
        }
        self.store.palettes = vec![[0.0; 4]; count * PALETTE_STRIDE];
        self
    }

    fn draw(&mut self) {
        for phase in [Phase::Pose, Phase::Feet, Phase::Manner, Phase::Idle] {
            reference::run(phase, &mut self.store, 0);
        }
    }

    fn draw_at(&mut self, phase: u32) {
        let phase = (u64::from(phase) * (1 << 32) / u64::from(PHASES)) as u32;
        self.store.stance.iter_mut().for_each(|stance| stance.phase = phase);
        self.draw();
    }

    /// Where everyone's joints are at so many phases of the stride.
    fn stride(&mut self) -> Vec<Vec<Places>> {
        self.at_each_phase(|people| people.agents().map(|agent| people.places(agent)).collect())
    }

    /// The same of the bodies as built.
    fn stride_as_built(&mut self) -> Vec<Vec<Places>> {
        let rests: Vec<Places> = self
            .avatars
            .iter()
            .map(|avatar| avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate()))
            .collect();
        self.at_each_phase(|people| {
            reference::run(Phase::Palette, &mut people.store, 0);
            let built = |agent: usize| {
                let palette = &people.store.palettes[agent * PALETTE_STRIDE..][..3 * JOINT_COUNT];
                let rest = &rests[people.store.appearance[agent].avatar() as usize];
                from_root(std::array::from_fn(|joint| {
                    let row =
                        |axis: usize| Vec4::from(palette[3 * joint + axis]).dot(rest[joint].extend(1.0));
                    Vec3::new(row(0), row(1), row(2))
                }))
            };
            people.agents().map(built).collect()
        })
    }

    /// A stride as everyone is drawn, and as their gaits have it.
    fn drawn_and_of_gaits(&mut self) -> [Vec<Vec<Places>>; 2] {
        let drawn = self.stride();
        self.store.frame.individuals = 0.0;
        [drawn, self.stride()]
    }

    fn at_each_phase(&mut self, look: impl Fn(&mut Self) -> Vec<Places>) -> Vec<Vec<Places>> {
        (0..PHASES)
            .map(|phase| {
                self.draw_at(phase);
                look(self)
            })
            .collect()
    }

    fn agents(&self) -> std::ops::Range<usize> {
        0..self.store.appearance.len()
    }

    fn rotations(&self, agent: usize) -> [Quat; JOINT_COUNT] {
        let pose = &self.store.local_rotations[agent * POSE_STRIDE..][..JOINT_COUNT];
        std::array::from_fn(|joint| Quat::from_array(pose[joint]))
    }

    fn joints(&self, agent: usize) -> [Mat4; JOINT_COUNT] {
        let root = Vec4::from_array(self.store.local_rotations[agent * POSE_STRIDE + JOINT_COUNT]).truncate();
        let avatar = self.store.appearance[agent].avatar() as usize;
        self.avatars[avatar].model_from_joint(&self.rotations(agent), root)
    }

    fn places(&self, agent: usize) -> Places {
        from_root(self.joints(agent).map(|joint| joint.w_axis.truncate()))
    }
}

fn from_root(places: Places) -> Places {
    places.map(|place| place - places[0])
}

/// Length of a body's left leg, m.
fn leg(body: &Places) -> f32 {
    let [hip, knee, foot] = [Joint::LeftHip, Joint::LeftKnee, Joint::LeftFoot].map(|j| body[j as usize]);
    hip.distance(knee) + knee.distance(foot)
}

/// How far people are from their mean: RMS over the joints but the root and over the phases, cm at a leg of 0.87 m. So
/// `gaitway gait measure` does it.
fn spread(stride: &[Vec<Places>]) -> f32 {
    let mut squares = Vec::new();
    for bodies in stride {
        let scaled: Vec<Places> = bodies.iter().map(|body| body.map(|p| p * (LEG / leg(body)))).collect();
        for joint in 1..JOINT_COUNT {
            let middle = mean_place(&scaled, joint);
            squares.extend(scaled.iter().map(|body| body[joint].distance_squared(middle)));
        }
    }
    100.0 * (squares.iter().sum::<f32>() / squares.len() as f32).sqrt()
}

fn mean_place(bodies: &[Places], joint: usize) -> Vec3 {
    bodies.iter().map(|body| body[joint]).sum::<Vec3>() / bodies.len() as f32
}

/// Mean difference between the ranges through which both upper arms swing, degrees.
fn asymmetry(stride: &[Vec<Places>]) -> f32 {
    let count = stride[0].len();
    let of = |agent: usize| {
        let [left, right] = ARMS.map(|[shoulder, elbow, _]| {
            range(stride.iter().map(|bodies| {
                let arm = bodies[agent][elbow as usize] - bodies[agent][shoulder as usize];
                arm.z.atan2(-arm.y).to_degrees()
            }))
        });
        (left - right).abs()
    };
    (0..count).map(of).sum::<f32>() / count as f32
}

/// Largest less smallest.
fn range(values: impl IntoIterator<Item = f32>) -> f32 {
    let (low, high) = values.into_iter().fold((f32::MAX, f32::MIN), |(l, h), v| (l.min(v), h.max(v)));
    high - low
}

#[test]
fn shares_are_bounded_independent_and_zero_in_the_mean() {
    const PEOPLE: u32 = 4_000;
    let draws = DRAWS_OF_TRUNK + 2 * DRAWS_OF_ARM;
    assert_eq!(draws, 19, "components of an individual");
    let shares: Vec<Vec<f32>> =
        (0..draws).map(|draw| (0..PEOPLE).map(|agent| own_share(agent, draw)).collect()).collect();
    let mean_product =
        |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f32>() / a.len() as f32;
    for (number, own) in shares.iter().enumerate() {
        assert!(own.iter().all(|share| share.abs() <= 1.0));
        let mean = own.iter().sum::<f32>() / own.len() as f32;
        let deviation = mean_product(own, own).sqrt();
        // four standard errors; three uniform draws have a third of the range as their deviation
        assert!(mean.abs() < 4.0 / 3.0 / (PEOPLE as f32).sqrt(), "{number}: {mean}");
        assert!((deviation - 1.0 / 3.0).abs() < 0.02, "{number}: {deviation}");
        for (other, others) in shares.iter().enumerate().skip(number + 1) {
            let together = 9.0 * mean_product(own, others);
            assert!(together.abs() < 0.08, "{number} and {other}: {together}");
        }
    }
}

#[test]
fn individuals_of_each_emotion_spread_as_people_do() {
    for emotion in Emotion::ALL {
        let mut crowd = People::of_all_gaits(emotion, 600);
        let [drawn, clips] = crowd.drawn_and_of_gaits();
        let own = People::of_one_gait(emotion, 600).stride();
        let built = People::of_all_gaits(emotion, 600).built_as_adults().stride_as_built();
        let cm = [&clips, &own, &drawn, &built].map(|stride| spread(stride));
        let degrees = [&clips, &own, &drawn].map(|stride| asymmetry(stride));
        println!(
            "{emotion}: gaits, individuals of one, both, and builds: {cm:.1?} cm, arms unequal by {degrees:.1?}"
        );
        // people's 5 to 7 cm are those of bodies of every build
        assert!((5.0..7.0).contains(&cm[3]) && cm[2] > cm[0] + 0.5, "{emotion}: {cm:?}");
        assert!(cm[3] > cm[2] + 0.1, "{emotion}: builds differ: {cm:?}");
        assert!((2.5..3.5).contains(&cm[1]), "{emotion}: {cm:?}");
        assert!((6.0..12.0).contains(&degrees[2]), "{emotion}: {degrees:?}");
    }
}

#[test]
fn both_arms_of_an_agent_have_one_posture_and_balance_its_trunk() {
    for emotion in Emotion::ALL {
        let mut people = People::of_one_gait(emotion, 600);
        let [drawn, gait] = people.drawn_and_of_gaits();
        // ahead of the gait, rad: the trunk from the waist up, the upper arms from the shoulders down
        let own = |agent: usize| {
            let lines = [
                (Joint::Spine, Joint::Neck, 1.0),
                (Joint::LeftShoulder, Joint::LeftElbow, -1.0),
                (Joint::RightShoulder, Joint::RightElbow, -1.0),
            ];
            lines.map(|(from, to, up)| {
                let ahead = |body: &Places| {
                    let line = body[to as usize] - body[from as usize];
                    line.z.atan2(up * line.y)
                };
                let differs =
                    |(drawn, gait): (&Vec<Places>, &Vec<Places>)| ahead(&drawn[agent]) - ahead(&gait[agent]);
                drawn.iter().zip(&gait).map(differs).sum::<f32>() / PHASES as f32
            })
        };
        let all: Vec<_> = people.agents().map(own).collect();
        let product = |a: usize, b: usize| all.iter().map(|own| own[a] * own[b]).sum::<f32>();
        let together = product(1, 2) / (product(1, 1) * product(2, 2)).sqrt();
        let balance = (product(0, 1) + product(0, 2)) / (2.0 * product(0, 0));
        println!("{emotion}: arms agree by {together:.2} and take {balance:.2} of the trunk's lean");
        assert!(together > 0.6 && (-0.6..-0.2).contains(&balance), "{emotion}: {together} {balance}");
    }
}

#[test]
fn no_two_of_a_hundred_agents_with_one_gait_are_alike() {
    for emotion in Emotion::ALL {
        let stride = People::of_one_gait(emotion, 100).stride();
        let mut apart = Vec::new();
        for a in 0..100 {
            for b in a + 1..100 {
                let farthest = |bodies: &Vec<Places>| {
                    let both = bodies[a].iter().zip(&bodies[b]);
                    both.map(|(a, b)| a.distance(*b)).fold(0.0, f32::max)
                };
                apart.push(100.0 * stride.iter().map(farthest).sum::<f32>() / PHASES as f32);
            }
        }
        let least = apart.iter().copied().fold(f32::MAX, f32::min);
        let mean = apart.iter().sum::<f32>() / apart.len() as f32;
        println!("{emotion}: the joint farthest apart is by {mean:.1} cm, of the most alike by {least:.1}");
        assert!(least > 1.5 && mean > 7.0, "{emotion}: {least} {mean}");
    }
}

#[test]
fn two_thousand_agents_walk_in_the_mean_as_their_gait() {
    for emotion in Emotion::ALL {
        let mut people = People::of_one_gait(emotion, 2_000);
        let [drawn, gait] = people.drawn_and_of_gaits();
        let mut worst = 0.0_f32;
        for (drawn, gait) in drawn.iter().zip(&gait) {
            for (joint, place) in gait[0].iter().enumerate() {
                worst = worst.max(mean_place(drawn, joint).distance(*place));
            }
        }
        println!("{emotion}: the mean is within {:.1} mm of the gait", 1e3 * worst);
        assert!(worst < 0.008, "{emotion}: {worst} m");
    }
}

/// How far a place is outside of the trunk, over the trunk's own half width and depth: 1 is on its surface.
fn outside(body: &Places, place: Vec3) -> f32 {
    let neck = body[Joint::Neck as usize];
    let middle = neck * (place.y / neck.y).clamp(0.0, 1.0);
    let [width, depth] = [0.16, 0.11].map(|size| size * leg(body) / LEG);
    ((place.x - middle.x) / width).hypot((place.z - middle.z) / depth)
}

/// Upper arm, and forearm; then places along the arm from the elbow down.
fn arm_of(body: &Places, arm: &[Joint; 3]) -> ([Vec3; 2], [Vec3; 3]) {
    let [shoulder, elbow, hand] = arm.map(|joint| body[joint as usize]);
    ([elbow - shoulder, hand - elbow], [elbow, 0.5 * (elbow + hand), hand])
}

#[test]
fn elbows_bend_forwards_and_arms_stay_beside_the_trunk() {
    for emotion in Emotion::ALL {
        let mut people = People::of_all_gaits(emotion, 1_200);
        let [drawn, gaits] = people.drawn_and_of_gaits();
        let (mut straightest, mut most) = (f32::MAX, 0.0_f32);
        let (mut nearest, mut nearest_gait) = (f32::MAX, f32::MAX);
        for (drawn, gait) in drawn.iter().flatten().zip(gaits.iter().flatten()) {
            for arm in &ARMS {
                let ([upper, fore], places) = arm_of(drawn, arm);
                let ([gait_upper, gait_fore], gait_places) = arm_of(gait, arm);
                // about the same axis, as seen from the upper arm
                let same = Quat::from_rotation_arc(gait_upper.normalize(), upper.normalize());
                let hinge = same * gait_upper.cross(gait_fore).normalize();
                let bend = upper.cross(fore).dot(hinge).atan2(upper.dot(fore));
                straightest = straightest.min(bend / gait_upper.angle_between(gait_fore));
                most = most.max(bend.to_degrees());
                let least = |body: &Places, places: [Vec3; 3]| {
                    places.map(|place| outside(body, place)).into_iter().fold(f32::MAX, f32::min)
                };
                nearest = nearest.min(least(drawn, places));
                nearest_gait = nearest_gait.min(least(gait, gait_places));
            }
        }
        println!(
            "{emotion}: elbows have {straightest:.2} of the gait's bend at least, and {most:.0} degrees at most; arms are at \
             {nearest:.2} of the trunk's size at least, those of the gaits at {nearest_gait:.2}"
        );
        assert!(straightest > 0.3 && most < 140.0, "{emotion}: {straightest} {most}");
        assert!(nearest > 1.0, "{emotion}: {nearest} {nearest_gait}");
    }
}

#[test]
fn pelvis_and_legs_are_the_gaits_own() {
    let mut people = People::of_all_gaits(Emotion::Happy, 60);
    for phase in 0..PHASES {
        people.draw_at(phase);
        let drawn = people.store.local_rotations.clone();
        people.store.frame.individuals = 0.0;
        people.draw_at(phase);
        people.store.frame.individuals = 1.0;
        for (element, (drawn, gait)) in drawn.iter().zip(&people.store.local_rotations).enumerate() {
            let joint = element % POSE_STRIDE;
            let is_upper = (Joint::Spine as usize..Joint::LeftHip as usize).contains(&joint);
            let is_hand = [Joint::LeftHand, Joint::RightHand].iter().any(|hand| *hand as usize == joint);
            let is_same = drawn.map(f32::to_bits) == gait.map(f32::to_bits);
            assert!(is_same != (is_upper && !is_hand), "element {joint} at {phase}");
        }
    }
}

#[test]
fn agents_that_stand_and_crowds_without_individuals_are_drawn_as_before() {
    let mut people = People::of_all_gaits(Emotion::Sad, 40);
    for (walk_weight, individuals) in [(0.0, 1.0), (1.0, 0.0), (0.5, 0.0)] {
        people.store.frame.individuals = individuals;
        people.store.stance.iter_mut().for_each(|stance| stance.walk_weight = walk_weight);
        for phase in [Phase::Pose, Phase::Feet] {
            reference::run(phase, &mut people.store, 0);
        }
        let before = people.store.local_rotations.clone();
        reference::run(Phase::Manner, &mut people.store, 0);
        assert!(before == people.store.local_rotations, "{walk_weight} {individuals}");
    }
    let is_due = |store: &Store| {
        order::frame_dispatches(&store.frame).iter().any(|dispatch| dispatch.phase == Phase::Manner)
    };
    assert!(!is_due(&people.store), "what is not asked for costs nothing");
    people.store.frame.individuals = 1.0;
    assert!(is_due(&people.store));
}

/// Goes on to the next picture at a speed, m/s.
fn go(people: &mut People, speed: f32) {
    for agent in 0..people.store.visible.len() - 1 {
        people.store.agent_slot[agent] = agent as u32;
        people.store.new_velocity[agent] = [0.0, speed];
    }
    reference::run(Phase::Integrate, &mut people.store, 0);
}

#[test]
fn no_joint_jumps_while_people_start_and_stop() {
    let mut people = People::of_all_gaits(Emotion::Happy, 24);
    let mut before: Option<Vec<[Quat; JOINT_COUNT]>> = None;
    let (mut worst, mut most) = (0.0_f32, 0.0_f32);
    for picture in 0..(10.0 * PICTURES) as u32 {
        let time = picture as f32 / PICTURES;
        // on and off every second and a quarter, within a quarter of a second
        let speed = 1.3 * (0.5 - 4.0 * ((0.4 * time).fract() - 0.5).abs() + 0.5).clamp(0.0, 1.0);
        go(&mut people, speed);
        people.store.frame.gaze_time = (1e3 * time) as u32;
        let mut rotations = |individuals: f32| -> Vec<[Quat; JOINT_COUNT]> {
            people.store.frame.individuals = individuals;
            people.draw();
            (0..24).map(|agent| people.rotations(agent)).collect()
        };
        let (gaits, drawn) = (rotations(0.0), rotations(1.0));
        // what is an agent's own
        let own: Vec<[Quat; JOINT_COUNT]> = gaits
            .iter()
            .zip(&drawn)
            .map(|(gait, drawn)| std::array::from_fn(|joint| gait[joint].conjugate() * drawn[joint]))
            .collect();
        for (before, now) in before.iter().flatten().zip(&own) {
            for joint in 0..JOINT_COUNT {
                worst = worst.max(before[joint].angle_between(now[joint]));
                most = most.max(now[joint].angle_between(Quat::IDENTITY));
            }
        }
        before = Some(own);
    }
    // the walk comes and goes as fast; two fifths for the strides that go on meanwhile, on the spot, too
    let bound = 1.4 * most * people.store.step.blend_rate / PICTURES + 0.15_f32.to_radians();
    let [most, worst, bound] = [most, worst, bound].map(f32::to_degrees);
    println!("own angles are {most:.1} degrees at most, and change by {worst:.2} of {bound:.2} in a picture");
    assert!(most > 10.0 && worst < bound && bound < 1.5, "{most} {worst} {bound}");
}

#[test]
fn short_strides_swing_less_and_hold_as_much() {
    let mut people = People::of_one_gait(Emotion::Happy, 300);
    let usual = people.stride();
    people.store.stance.iter_mut().for_each(|stance| stance.stride *= 0.3);
    let short = people.stride();
    people.store.frame.individuals = 0.0;
    let gait = people.stride();
    // how far what the arms do of their own goes, and where its middle is, m
    let own = |stride: &[Vec<Places>], of: &[Vec<Places>]| {
        let hand = |bodies: &[Places], agent: usize| {
            let [shoulder, elbow, _] = ARMS[0].map(|joint| bodies[agent][joint as usize]);
            (elbow - shoulder).z
        };
        let figures = (0..300).map(|agent| {
            let ways: Vec<f32> =
                stride.iter().zip(of).map(|(own, gait)| hand(own, agent) - hand(gait, agent)).collect();
            let middle = ways.iter().sum::<f32>() / ways.len() as f32;
            (range(ways), middle.abs())
        });
        figures.fold((0.0, 0.0), |sum, own| (sum.0 + own.0 / 300.0, sum.1 + own.1 / 300.0))
    };
    people.store.stance.iter_mut().for_each(|stance| stance.stride /= 0.3);
    let usual_gait = people.stride();
    let ((swings, holds), (less, as_much)) = (own(&usual, &usual_gait), own(&short, &gait));
    println!(
        "arms swing {swings:.3} m of their own, in short strides {less:.3}; they hold {holds:.3} and {as_much:.3}"
    );
    assert!((less / swings - 0.3).abs() < 0.06 && (as_much / holds - 1.0).abs() < 0.1);
    assert_eq!(usual.len(), PHASES as usize);
    assert!(CLIP_FRAMES.is_multiple_of(PHASES as usize), "phases are frames of clips");
}
