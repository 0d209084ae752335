//! The emotions differ in the direction in which perceived emotions differ in E-Gait.

use crate::common::data_set;
use gaitway::Emotion;
use gaitway::gait::walker::{Sex, WalkerStyle, person, walk};
use gaitway::gait::{Gait, Joint, Pose};
use glam::Vec3;
use std::collections::BTreeMap;

/// Name, measure, whether classes are compared by their ratio, and the values of happy, angry and sad.
type Measure = (&'static str, fn(&Gait) -> f32, bool, [f32; 3]);

/// What is measured, and its means for happy, angry and sad against neutral on E-Gait's perceived labels
/// (labels.h5; 74 happy, 20 angry, 52 sad, 86 neutral gaits of BML, CMU, ICT, SIG and `EWalk`): a ratio, or a
/// difference for angles, to the neutral mean *of the same source*, averaged over gaits. All are free of the file's
/// rotations and of its unit.
const MEASURED: [Measure; 6] = [
    ("hand speed", hand_speed, true, [1.522, 1.555, 0.648]),
    ("foot speed", foot_speed, true, [1.091, 1.330, 0.832]),
    ("cycle time", Gait::cycle_time, true, [0.957, 0.836, 1.200]),
    ("stride length", Gait::stride_length, true, [1.011, 1.102, 0.966]),
    ("arm swing", arm_swing, true, [1.385, 1.304, 0.671]),
    ("angle between head, neck and spine (degrees)", head_angle, false, [2.408, 3.067, -4.278]),
];

fn mean_speed(gait: &Gait, joints: [Joint; 2]) -> f32 {
    let steps = gait.poses.windows(2);
    let path: f32 = steps
        .flat_map(|pair| joints.map(|joint| pair[1][joint as usize].distance(pair[0][joint as usize])))
        .sum();
    path / (2 * (gait.poses.len() - 1)) as f32 * gait.frame_rate
}

fn hand_speed(gait: &Gait) -> f32 {
    mean_speed(gait, [Joint::LeftHand, Joint::RightHand])
}

fn foot_speed(gait: &Gait) -> f32 {
    mean_speed(gait, [Joint::LeftFoot, Joint::RightFoot])
}

/// Largest distance between two places of a hand relative to the root, m, mean of both hands.
fn arm_swing(gait: &Gait) -> f32 {
    let extent = |hand: Joint| {
        let places: Vec<Vec3> = gait.poses.iter().map(|pose| pose[hand as usize] - pose[0]).collect();
        let pairs = places.iter().flat_map(|a| places.iter().map(move |b| a.distance(*b)));
        pairs.fold(0.0, f32::max)
    };
    0.5 * (extent(Joint::LeftHand) + extent(Joint::RightHand))
}

/// Feature 6 of the paper: the angle at the neck, 180 when head, neck and spine are in line, degrees.
fn head_angle(gait: &Gait) -> f32 {
    let angle = |pose: &Pose| (pose[3] - pose[2]).angle_between(pose[1] - pose[2]).to_degrees();
    gait.poses.iter().map(angle).sum::<f32>() / gait.poses.len() as f32
}

fn presets(emotion: Emotion) -> Vec<Gait> {
    Sex::ALL.map(|sex| walk(&WalkerStyle::preset(emotion, sex), "preset").unwrap()).to_vec()
}

fn mean(gaits: &[Gait], of: fn(&Gait) -> f32) -> f32 {
    gaits.iter().map(of).sum::<f32>() / gaits.len() as f32
}

fn against(value: f32, neutral: f32, ratio: bool) -> f32 {
    if ratio { value / neutral } else { value - neutral }
}

#[test]
fn presets_differ_from_neutral_as_perceived_emotions_do() {
    for (what, measure, ratio, data) in MEASURED {
        let neutral = mean(&presets(Emotion::Neutral), measure);
        for (emotion, data) in [Emotion::Happy, Emotion::Angry, Emotion::Sad].into_iter().zip(data) {
            let ours = against(mean(&presets(emotion), measure), neutral, ratio);
            println!("{what}: {emotion} {ours:.3}, E-Gait {data:.3} (neutral {neutral:.3})");
            let none = if ratio { 1.0 } else { 0.0 };
            assert!((ours > none) == (data > none), "{what}: {emotion} {ours} but E-Gait {data}");
            // As strong as the data, or up to a few times stronger; never caricature.
            let (strength, wanted) = ((ours - none).abs(), (data - none).abs());
            let least = if ratio { 0.5 } else { 0.4 };
            assert!(strength > least * wanted, "{what}: {emotion} {ours} is too faint against {data}");
            assert!(strength < 6.0 * wanted + 0.05, "{what}: {emotion} {ours} is a caricature of {data}");
        }
    }
}

#[test]
fn head_and_trunk_say_the_emotion() {
    // Forward lean of the head over the root, degrees. E-Gait (same gaits and method): happy 2.9 +- 0.6 less than
    // neutral, sad 3.0 +- 0.8 more; angry within its error.
    let lean = |gait: &Gait| {
        let angle = |pose: &Pose| (pose[3] - pose[0]).z.atan2((pose[3] - pose[0]).y).to_degrees();
        gait.poses.iter().map(angle).sum::<f32>() / gait.poses.len() as f32
    };
    let of = |emotion| presets(emotion).iter().map(lean).sum::<f32>() / 2.0;
    let [happy, angry, sad, neutral] = Emotion::ALL.map(of);
    println!("head lean: happy {happy:.1}, angry {angry:.1}, sad {sad:.1}, neutral {neutral:.1}");
    assert!(happy < neutral - 2.0 && sad > neutral + 3.0 && angry > neutral + 2.0);
}

#[test]
fn classes_keep_apart_when_individuals_vary() {
    for sex in Sex::ALL {
        let speeds = |emotion| -> Vec<f32> {
            (0..40).map(|index| hand_speed(&person(emotion, sex, 5, index).unwrap())).collect()
        };
        let quantile = |emotion, q: usize| {
            let mut values = speeds(emotion);
            values.sort_by(f32::total_cmp);
            values[q * (values.len() - 1) / 100]
        };
        // individuals differ as people do, so that the classes overlap; not by much
        assert!(quantile(Emotion::Sad, 90) < quantile(Emotion::Neutral, 10));
        assert!(quantile(Emotion::Neutral, 75) < quantile(Emotion::Happy, 25));
        assert!(quantile(Emotion::Neutral, 75) < quantile(Emotion::Angry, 25));
    }
}

/// Gaits of one E-Gait file as (perceived label, gait); sides are as in the file (our measures are symmetric).
fn egait(folder: &std::path::Path, source: &str, labels: &BTreeMap<String, Emotion>) -> Vec<(Emotion, Gait)> {
    let text = std::fs::read_to_string(folder.join(format!("{source}.csv"))).unwrap();
    let mut takes: BTreeMap<&str, Vec<Pose>> = BTreeMap::new();
    for line in text.lines().skip(1) {
        let mut cells = line.split(',');
        let key = cells.next().unwrap();
        let values: Vec<f32> = cells.skip(1).map(|cell| cell.parse().unwrap()).collect();
        let mut pose: Pose = [Vec3::ZERO; 16];
        for (joint, xyz) in pose.iter_mut().zip(values.chunks_exact(3)) {
            *joint = Vec3::from_slice(xyz);
        }
        takes.entry(key).or_default().push(pose);
    }
    let gait = |key: &str, poses| Gait {
        name: key.to_owned(),
        poses,
        frame_rate: 30.0,
        speed: 1.0,
        ..Gait::default()
    };
    takes.into_iter().map(|(key, poses)| (labels[key], gait(key, poses))).collect()
}

#[test]
fn the_numbers_above_are_those_of_e_gait() {
    let Some(folder) = data_set("egait") else { return };
    let table = std::fs::read_to_string(folder.join("gaits.csv")).unwrap();
    let labels: BTreeMap<String, Emotion> = table
        .lines()
        .skip(1)
        .map(|line| line.split(',').collect::<Vec<_>>())
        .map(|cells| (cells[1].to_owned(), cells[5].parse().unwrap()))
        .collect();
    let sources = ["bml", "cmu", "ict", "sig", "ewalk"].map(|source| egait(&folder, source, &labels));
    for (what, measure, ratio, expected) in MEASURED {
        for (emotion, expected) in [Emotion::Happy, Emotion::Angry, Emotion::Sad].into_iter().zip(expected) {
            let (mut sum, mut count) = (0.0, 0.0);
            for gaits in &sources {
                let of = |label| {
                    gaits.iter().filter(move |(l, _)| *l == label).map(move |(_, gait)| measure(gait))
                };
                let neutral = of(Emotion::Neutral).sum::<f32>() / of(Emotion::Neutral).count() as f32;
                sum += of(emotion).map(|value| against(value, neutral, ratio)).sum::<f32>();
                count += of(emotion).count() as f32;
            }
            let found = sum / count;
            assert!((found - expected).abs() < 0.002, "{what}: {emotion} is {found}, not {expected}");
        }
    }
}
