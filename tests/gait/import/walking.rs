//! Both feet count alike, so that mirror images are treated alike; and what is no walking is refused, with the measure.

use super::data;
use super::movements::{Movement, OTHERS, RUNNING, mirrored, mirrored_pose, on_treadmill, turned};
use super::strikes::{STRAIGHT, Way, take};
use super::walker::Walker;
use crate::common::data_set;
use gaitway::Emotion;
use gaitway::gait::import::import_file;
use gaitway::gait::stride::{self, Refusal, Survey};
use gaitway::gait::walker::{Sex, WalkerStyle, walk};
use gaitway::gait::{Gait, Joint, Recording};

/// Mean distance of the joints of two gaits of as many frames, the second begun at a frame.
fn distance(a: &Gait, b: &Gait, shift: usize) -> f32 {
    let count = a.poses.len();
    let pairs = (0..count).flat_map(|i| a.poses[i].iter().zip(&b.poses[(i + shift) % count]));
    pairs.map(|(p, q)| p.distance(*q)).sum::<f32>() / (16 * count) as f32
}

/// Kinds of refusal, however often.
fn kinds(survey: &Survey) -> Vec<std::mem::Discriminant<Refusal>> {
    let mut counts: Vec<_> =
        survey.reasons().iter().map(|(count, why)| (*count, std::mem::discriminant(why))).collect();
    counts.sort_by_key(|(count, kind)| (*count, format!("{kind:?}")));
    counts.into_iter().map(|(_, kind)| kind).collect()
}

/// Surveys a take and its mirror image, which must be treated alike; returns the number of strides.
fn same_when_mirrored(recording: &Recording) -> usize {
    let what = &recording.name;
    let image = mirrored(recording);
    let (here, there) = match (stride::survey(recording), stride::survey(&image)) {
        (Ok(here), Ok(there)) => (here, there),
        (here, there) => {
            assert_eq!(here.is_err(), there.is_err(), "{what}");
            return 0;
        }
    };
    assert_eq!(here.strides.len(), there.strides.len(), "{what}");
    assert_eq!(here.apart().len(), there.apart().len(), "{what}");
    assert_eq!(here.refused.len(), there.refused.len(), "{what}");
    assert_eq!(kinds(&here), kinds(&there), "{what}");
    for (a, b) in here.strides.iter().zip(&there.strides) {
        // A cycle begins wherever its left foot strikes.
        assert!(recording.cyclic || (a.begin - b.begin).abs() < 1e-3, "{what}");
        assert!((a.duration - b.duration).abs() < 0.01, "{what}: {} s and {} s", a.duration, b.duration);
        // The one stride of a cycle is that of the left foot; of other takes either foot's.
        assert_eq!(a.foot, if recording.cyclic { b.foot } else { b.foot.mirrored() }, "{what}");
        assert!((a.gait.speed / b.gait.speed - 1.0).abs() < 0.01, "{what}");
        // Phase 0 is the left strike in both: half a cycle apart, more or less.
        let mut image = a.gait.clone();
        image.poses = image.poses.iter().map(mirrored_pose).collect();
        let count = image.poses.len();
        let shift =
            (0..count).min_by(|&i, &j| distance(&b.gait, &image, i).total_cmp(&distance(&b.gait, &image, j)));
        let shift = shift.unwrap();
        let (share, off) = (shift as f32 / count as f32, distance(&b.gait, &image, shift));
        assert!((0.25..=0.75).contains(&share), "{what}: shifted by {share}");
        assert!(off < 0.03, "{what}: off by {off} m");
    }
    here.strides.len()
}

#[test]
fn the_mirror_image_of_a_generated_walk_gives_the_mirrored_gaits() {
    let (mut accepted, mut takes) = (0, 0);
    for emotion in Emotion::ALL {
        let gait = walk(&WalkerStyle::preset(emotion, Sex::Male), "g").unwrap();
        for start in [0.0, 0.15, 0.3, 0.45, 0.6, 0.75, 0.9] {
            for noise in [0.0, 0.005, 0.015] {
                // So short that at times only one foot strikes twice.
                let way = Way { start, noise, seconds: 1.7 * gait.cycle_time(), ..STRAIGHT };
                let name = format!("{emotion} from phase {start} with noise {noise}");
                let recording = Recording { name, ..take(&gait, way) };
                accepted += usize::from(same_when_mirrored(&recording) > 0);
                takes += 1;
            }
        }
    }
    println!("{accepted} of {takes} short takes have a stride, and so have their mirror images");
    assert!(accepted > takes / 3 && accepted < takes);
}

#[test]
fn mirroring_real_takes_changes_no_decision() {
    let mut count = 0;
    for (set, ending) in
        [("cmu-asfamc", "amc"), ("bandai-namco", "bvh"), ("100style", "bvh"), ("egait", "csv")]
    {
        let Some(folder) = data_set(set) else { continue };
        for path in data::files(&folder, ending) {
            for take in import_file(&path).into_iter().flatten() {
                assert!(same_when_mirrored(&take) > 0, "{} is a walk", take.name);
                count += 1;
            }
        }
    }
    println!("{count} real takes and their mirror images");
}

#[test]
fn a_stride_of_the_right_foot_begins_with_the_left_strike_like_all_others() {
    let walker = Walker { first_strike: -0.1, ..Walker::default() };
    let take = walker.take(1.9, 60.0);
    let survey = stride::survey(&take).unwrap();
    assert_eq!(survey.strides.iter().map(|stride| stride.foot).collect::<Vec<_>>(), [Joint::RightFoot]);
    let found = &survey.strides[0];
    assert!((found.begin - 0.45).abs() < 0.03, "{}", found.begin);
    super::check_gait(&found.gait);
    // The left foot strikes at 1.0 s.
    let off = (0..16).map(|joint| {
        let place = |pose: &gaitway::gait::Pose| pose[joint] - pose[0];
        place(&found.gait.poses[0]).distance(place(&walker.pose(1.0)))
    });
    let off = off.fold(0.0, f32::max);
    assert!(off < 0.06, "phase 0 is {off} m from the pose at the left strike");
}

#[test]
fn boxing_dancing_and_jumping_are_no_walks_and_the_message_names_the_measure() {
    for movement in &OTHERS {
        for noise in [0.0, 0.002, 0.005, 0.015] {
            for rate in [30.0, 60.0] {
                let take = movement.take(10.0, rate, noise);
                let what = format!("{} at {rate} Hz with noise {noise}", movement.name);
                assert_eq!(same_when_mirrored(&take), 0, "{what} is taken for a walk");
                let message = stride::best(&take).unwrap_err().to_string();
                assert!(message.contains("no straight stride of a walk"), "{what}: {message}");
                let says_range =
                    ["needed", "needs 2", "are used", "not once"].iter().any(|words| message.contains(words));
                assert!(says_range, "{what}: {message}");
            }
        }
    }
}

#[test]
fn the_error_for_a_boxer_says_that_the_feet_do_not_pass_each_other() {
    let boxer = OTHERS.iter().find(|other| other.name.starts_with("boxing forwards")).unwrap();
    let survey = stride::survey(&boxer.take(10.0, 60.0, 0.002)).unwrap();
    let steps = survey.reasons().into_iter().find_map(|(_, why)| match why {
        Refusal::Steps(support) => Some(support.step),
        _ => None,
    });
    let [left, right] = steps.unwrap();
    assert!(left > 0.4 && right < -0.2, "left {left}, right {right}");
    let message = stride::best(&boxer.take(10.0, 60.0, 0.002)).unwrap_err().to_string();
    assert!(
        message.contains("feet do not pass each other") && message.contains("0.02 m or more"),
        "{message}"
    );
}

fn best_or_message(take: &Recording) -> Result<Gait, String> {
    stride::best(take).map_err(|error| error.to_string())
}

#[test]
fn treadmills_and_runners_are_accepted_backwards_and_sideways_walkers_are_not() {
    let walker = Walker::default();
    let walk = walker.take(8.0, 60.0);
    let mut backwards = walk.clone();
    backwards.poses.reverse();

    let gait = best_or_message(&on_treadmill(&walk, walker.speed)).unwrap();
    assert!(
        (gait.speed / walker.speed - 1.0).abs() < 0.03
            && !gait.provenance.notes.contains(&"running".to_owned())
    );
    let run = |movement: &Movement| movement.take(8.0, 60.0, 0.002);
    for take in [run(&RUNNING), on_treadmill(&run(&RUNNING), 3.0)] {
        let gait = best_or_message(&take).unwrap();
        assert!((gait.speed / 3.0 - 1.0).abs() < 0.05, "{}", gait.speed);
        assert!(
            gait.provenance.notes.contains(&"running".to_owned()),
            "not its name, but its mark: {}",
            gait.provenance
        );
        assert_eq!(same_when_mirrored(&take), stride::survey(&take).unwrap().strides.len());
    }
    for (take, expected) in [
        (backwards.clone(), "walks backwards: 180 degrees"),
        (on_treadmill(&backwards, -walker.speed), "not walking forwards"),
        (turned(&walk, 1.5), "walks sideways"),
        (turned(&walk, 3.0), "walks backwards"),
    ] {
        let message = best_or_message(&take).unwrap_err();
        assert!(message.contains(expected), "{message} should say {expected}");
        assert_eq!(same_when_mirrored(&take), 0);
    }
}
