//! Real recordings, where they are at hand: beside the crate in `../shared/data`, or where `GAITWAY_DATA` points.

use crate::common::data_set;
use gaitway::Emotion;
use gaitway::gait::import::import_file;
use gaitway::gait::{Gait, Joint, Recording, stride};
use glam::{Mat4, Quat, Vec3, Vec4};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// All files with an extension, in the folder and the folders in it, sorted.
pub(crate) fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(files(&path, extension));
        } else if path.extension().is_some_and(|e| e == extension) {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Strides of one take, checked for plausible speed and for what every gait promises.
fn strides_of(take: &Recording) -> Vec<stride::Stride> {
    assert!(take.report.iter().any(|line| line.contains("left is left")), "{}: {:?}", take.name, take.report);
    let strides = stride::strides(take).unwrap();
    for found in &strides {
        let speed = found.gait.speed;
        assert!((0.3..2.5).contains(&speed), "{}: {speed} m/s", found.gait.name);
        super::check_gait(&found.gait);
    }
    strides
}

fn show(class: &str, gaits: &[Gait]) {
    let speeds = gaits.iter().map(|gait| gait.speed);
    let (low, high) = (speeds.clone().fold(f32::MAX, f32::min), speeds.clone().fold(0.0, f32::max));
    let mean = speeds.sum::<f32>() / gaits.len() as f32;
    println!("{class}: {} strides, {low:.2} to {high:.2} m/s, mean {mean:.2}", gaits.len());
}

#[test]
fn cmu_walks_keep_the_speed_of_their_trials() {
    let Some(folder) = data_set("cmu-asfamc") else { return };
    let trials = std::fs::read_to_string(folder.join("trials.csv")).unwrap();
    let mut errors = Vec::new();
    let mut gaits = Vec::new();
    for path in files(&folder, "amc") {
        let take = import_file(&path).unwrap().remove(0);
        let row = trials.lines().find(|line| line.starts_with(&format!("{},", take.name))).unwrap();
        let stated: f32 = row.split(',').nth(3).unwrap().parse().unwrap();
        let strides = strides_of(&take);
        let speed = strides.iter().map(|s| s.gait.speed).sum::<f32>() / strides.len() as f32;
        errors.push((speed / stated - 1.0).abs());
        gaits.extend(strides.into_iter().map(|stride| stride.gait));
    }
    show("CMU", &gaits);
    errors.sort_by(f32::total_cmp);
    println!("CMU: speed against trials.csv off by {errors:.3?}");
    // Two trials of subject 38 begin standing still, which the trial's mean includes.
    assert!(errors[errors.len() / 2] < 0.02 && errors[errors.len() - 3] < 0.05);
}

#[test]
fn bandai_namco_and_100style_takes_give_straight_strides() {
    let mut classes: HashMap<String, Vec<Gait>> = HashMap::new();
    for folder in ["bandai-namco", "100style"].into_iter().filter_map(data_set) {
        for path in files(&folder, "bvh") {
            let take = import_file(&path).unwrap().remove(0);
            let strides = strides_of(&take);
            let class = take.acted.clone().unwrap_or_else(|| take.name.clone());
            let best = stride::best(&take).unwrap();
            let survey = stride::survey(&take).unwrap();
            assert!(survey.strides.iter().any(|s| s.gait.poses == best.poses));
            classes.entry(class).or_default().extend(strides.into_iter().map(|stride| stride.gait));
        }
    }
    let mut classes: Vec<_> = classes.into_iter().collect();
    classes.sort_by(|a, b| a.0.cmp(&b.0));
    for (class, gaits) in &classes {
        show(class, gaits);
    }
}

#[test]
fn every_egait_cycle_becomes_one_labelled_gait() {
    let Some(folder) = data_set("egait") else { return };
    let mut classes: HashMap<Option<Emotion>, Vec<Gait>> = HashMap::new();
    let mut sides: HashMap<(&str, bool), usize> = HashMap::new();
    for set in ["bml", "cmu", "ewalk", "ict", "sig"] {
        for take in import_file(&folder.join(format!("{set}.csv"))).unwrap() {
            assert!(take.cyclic);
            let swapped = take.report.iter().any(|line| line.contains("joints swapped"));
            *sides.entry((set, swapped)).or_insert(0) += 1;
            let gaits = stride::extract(&take).unwrap();
            assert_eq!(gaits.len(), 1, "{}", take.name);
            assert!((0.3..2.5).contains(&gaits[0].speed), "{}: {}", take.name, gaits[0].speed);
            super::check_gait(&gaits[0]);
            classes.entry(take.label).or_default().extend(gaits);
        }
    }
    // the order of the sides differs between E-Gait's sources, and within two of them.
    let expected = [
        (("bml", true), 84),
        (("cmu", false), 34),
        (("ewalk", false), 16),
        (("ewalk", true), 51),
        (("ict", false), 17),
        (("sig", false), 16),
        (("sig", true), 14),
    ];
    assert_eq!(sides, expected.into());
    assert!(!classes.contains_key(&None));
    for emotion in Emotion::ALL {
        show(emotion.name(), &classes[&Some(emotion)]);
    }
    assert_eq!(classes.values().map(Vec::len).sum::<usize>(), 232);
}

/// Real takes as a treadmill would have them: their mean travel taken out.
#[test]
fn real_walks_put_on_a_treadmill_keep_their_speed() {
    let mut ratios = Vec::new();
    for (set, ending) in [("cmu-asfamc", "amc"), ("bandai-namco", "bvh")] {
        let Some(folder) = data_set(set) else { continue };
        for path in files(&folder, ending) {
            let take = import_file(&path).unwrap().remove(0);
            let survey = stride::survey(&take).unwrap();
            assert!(!survey.on_the_spot, "{}", take.name);
            // The longest run of strides at an even pace, so that the belt's speed is one number.
            let [first, last] = [survey.strides.first(), survey.strides.last()].map(Option::unwrap);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "frames of a take")]
            let [from, to] = [first.begin, last.begin + last.duration]
                .map(|t| ((t * take.frame_rate).round() as usize).min(take.poses.len() - 1));
            let travel = (take.poses[to][0] - take.poses[from][0]).with_y(0.0);
            let truth = travel.length() / ((to - from) as f32 / take.frame_rate);
            let mut belt = take.clone();
            belt.poses = take.poses[from..=to].to_vec();
            for (i, pose) in belt.poses.iter_mut().enumerate() {
                let moved = travel * (i as f32 / (to - from) as f32);
                pose.iter_mut().for_each(|point| *point -= moved);
            }
            let found = stride::survey(&belt).unwrap();
            assert!(found.on_the_spot, "{}: not seen to be on a treadmill", take.name);
            if found.strides.is_empty() {
                continue;
            }
            let speed = found.strides.iter().map(|s| s.gait.speed).sum::<f32>() / found.strides.len() as f32;
            ratios.push(speed / truth);
        }
    }
    if ratios.is_empty() {
        return;
    }
    ratios.sort_by(f32::total_cmp);
    let at = |share: usize| ratios[ratios.len() * share / 100];
    println!(
        "treadmill: {} real takes, speed {:.2} (5 %) {:.2} (median) {:.2} (95 %) of the truth",
        ratios.len(),
        at(5),
        at(50),
        at(95)
    );
    assert!((at(50) - 1.0).abs() < 0.05 && at(5) > 0.8 && at(95) < 1.25);
}

/// E-Gait's CMU gaits are every 4th frame of CMU trials, turned and scaled: found there again, they tell whether our
/// forward kinematics, sides, levelling, scale and restored speed are right.
#[test]
fn egait_cycles_match_the_cmu_trials_they_came_from() {
    /// Joints that both skeletons have in the same place (E-Gait's trunk lacks a link above the neck).
    const SHARED: [Joint; 8] = [
        Joint::Root,
        Joint::Spine,
        Joint::LeftHip,
        Joint::LeftKnee,
        Joint::LeftFoot,
        Joint::RightHip,
        Joint::RightKnee,
        Joint::RightFoot,
    ];
    let (Some(egait), Some(cmu)) = (data_set("egait"), data_set("cmu-asfamc")) else { return };
    let mut matched = 0;
    for cycle in import_file(&egait.join("cmu.csv")).unwrap() {
        let subject = cycle.name.split('_').next().unwrap();
        let path = cmu.join(subject).join(format!("{}.amc", cycle.name));
        if !path.is_file() {
            continue;
        }
        let trial = import_file(&path).unwrap().remove(0);
        let points = |take: &Recording, first: usize, step: usize| -> Vec<Vec3> {
            let poses = take.poses[first..].iter().step_by(step).take(cycle.poses.len());
            poses.flat_map(|pose| SHARED.map(|joint| pose[joint as usize] - pose[0])).collect()
        };
        let ours = points(&cycle, 0, 1);
        let starts = 0..trial.poses.len() - 4 * cycle.poses.len() + 3;
        let fits = starts.map(|start| fit(&ours, &points(&trial, start, 4)));
        let best = fits.min_by(|a, b| a.error.total_cmp(&b.error)).unwrap();
        let tilt = (best.rotation * Vec3::Y).angle_between(Vec3::Y).to_degrees();
        let (speed, truth) = (stride::best(&cycle).unwrap().speed, stride::best(&trial).unwrap().speed);
        println!(
            "{}: off by {:.1} mm, tilt {tilt:.1} degrees, scale {:.3}, speed {speed:.2} of {truth:.2} m/s",
            cycle.name,
            best.error * 1000.0,
            best.scale
        );
        assert!(best.error < 0.011, "{}", cycle.name);
        assert!(tilt < 3.5, "{}", cycle.name);
        assert!((best.scale - 1.0).abs() < 0.11, "{}", cycle.name);
        assert!((speed / truth - 1.0).abs() < 0.16, "{}", cycle.name);
        matched += 1;
    }
    assert_eq!(matched, 9);
}

struct Fit {
    rotation: Quat,
    scale: f32,
    /// Root mean square distance, m.
    error: f32,
}

/// The rotation and scale that take points `a` nearest to points `b` (Horn 1987; power iteration).
fn fit(a: &[Vec3], b: &[Vec3]) -> Fit {
    let mean = |points: &[Vec3]| points.iter().sum::<Vec3>() / points.len() as f32;
    let (ma, mb) = (mean(a), mean(b));
    let pairs = || a.iter().zip(b).map(|(p, q)| (*p - ma, *q - mb));
    let s = |i: usize, j: usize| pairs().map(|(p, q)| p[i] * q[j]).sum::<f32>();
    let (xx, yy, zz) = (s(0, 0), s(1, 1), s(2, 2));
    let (x, y, z) = (s(1, 2) - s(2, 1), s(2, 0) - s(0, 2), s(0, 1) - s(1, 0));
    let (xy, yz, zx) = (s(0, 1) + s(1, 0), s(1, 2) + s(2, 1), s(2, 0) + s(0, 2));
    let matrix = Mat4::from_cols(
        Vec4::new(xx + yy + zz, x, y, z),
        Vec4::new(x, xx - yy - zz, xy, zx),
        Vec4::new(y, xy, yy - xx - zz, yz),
        Vec4::new(z, zx, yz, zz - xx - yy),
    );
    let size = pairs().map(|(p, _)| p.length_squared()).sum::<f32>();
    let mut quaternion = Vec4::new(1.0, 0.1, 0.1, 0.1);
    for _ in 0..200 {
        // Shifted, so that the largest eigenvalue is also the largest in magnitude.
        quaternion = (matrix * quaternion + quaternion * size).normalize();
    }
    let rotation = Quat::from_xyzw(quaternion.y, quaternion.z, quaternion.w, quaternion.x);
    let scale = pairs().map(|(p, q)| (rotation * p).dot(q)).sum::<f32>() / size;
    let squares = pairs().map(|(p, q)| (rotation * p * scale - q).length_squared()).sum::<f32>();
    Fit { rotation, scale, error: (squares / a.len() as f32).sqrt() }
}
