use super::*;
use crate::gait::Joint;
use crate::gait::walker::{Sex, WalkerStyle, walk};

/// Walkers of the emotions, `count` of each.
fn walkers(emotions: &[Emotion], count: u32, seed: u64) -> (Vec<Gait>, Vec<Emotion>) {
    let mut found = (Vec::new(), Vec::new());
    for &emotion in emotions {
        for index in 0..count {
            let style = WalkerStyle::preset(emotion, Sex::Female).vary(seed, index);
            found.0.push(walk(&style, &format!("{emotion}{index}")).unwrap());
            found.1.push(emotion);
        }
    }
    found
}

#[test]
fn walkers_that_it_has_not_seen_are_recognised() {
    let (gaits, emotions) = walkers(&Emotion::ALL, 8, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let perceiver = PhasePerceiver::default().train(&seen, &emotions, 7).unwrap();
    let (others, wanted) = walkers(&Emotion::ALL, 5, 2);
    let right =
        others.iter().zip(&wanted).filter(|(gait, emotion)| perceiver.emotion(gait) == **emotion).count();
    assert!(right >= 19, "{right} of 20");
    for gait in &others {
        let p = perceiver.probabilities(gait);
        assert!(p.iter().all(|p| (0.0..=1.0).contains(p)) && (p.iter().sum::<f64>() - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_same_arguments_give_the_same_bits() {
    // labels that say nothing: nothing is certain
    let (gaits, _) = walkers(&[Emotion::Neutral], 24, 1);
    let emotions: Vec<Emotion> = (0..24).map(|i| Emotion::ALL[i % 4]).collect();
    let seen: Vec<&Gait> = gaits.iter().collect();
    let (others, _) = walkers(&[Emotion::Neutral], 1, 2);
    let told =
        |seed| PhasePerceiver::default().train(&seen, &emotions, seed).unwrap().probabilities(&others[0]);
    assert_eq!(told(3).map(f64::to_bits), told(3).map(f64::to_bits));
}

#[test]
fn the_ridge_is_the_one_under_which_people_left_out_are_likeliest() {
    let (gaits, _) = walkers(&[Emotion::Neutral], 40, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let chosen = |emotions: &[Emotion]| {
        let raw: Vec<Arc<Vec<f64>>> = gaits.iter().map(|gait| Arc::new(descriptor(gait))).collect();
        let ridges = [1000.0, 100.0, 10.0, 1.0];
        likeliest(&Learning { raw: &raw, emotions }, &ridges, &inner_folds(&seen, emotions, FOLDS, 3))
            .unwrap()
    };
    // labels that say nothing: the more they are distrusted the better, but for chance
    let mut nothing: Vec<Emotion> = (0..40).map(|i| Emotion::ALL[i % 2]).collect();
    let ridges: Vec<f64> = (0..9)
        .map(|seed| {
            crate::random::Random::new(seed).shuffle(&mut nothing);
            chosen(&nothing)
        })
        .collect();
    let distrusted = ridges.iter().filter(|ridge| ridge.total_cmp(&1000.0).is_eq()).count();
    assert!(distrusted >= 6, "{ridges:?}");
    // labels that say all
    let slow = |gait: &Gait| gait.cycle_time() > 1.1;
    let all: Vec<Emotion> =
        gaits.iter().map(|g| if slow(g) { Emotion::Sad } else { Emotion::Happy }).collect();
    assert!(chosen(&all) < 100.0, "{}", chosen(&all));
}

#[test]
fn inner_folds_hold_people_apart() {
    let (mut gaits, emotions) = walkers(&Emotion::ALL, 6, 1);
    for (i, gait) in gaits.iter_mut().enumerate() {
        gait.provenance.subject = Some((i % 8).to_string());
    }
    let seen: Vec<&Gait> = gaits.iter().collect();
    let folds = inner_folds(&seen, &emotions, FOLDS, 2);
    for (i, a) in folds.iter().enumerate() {
        assert!((i % 8..24).step_by(8).all(|j| folds[j] == *a), "{folds:?}");
    }
    assert_eq!(folds.iter().max(), Some(&4));
}

#[test]
fn an_emotion_that_was_not_learned_is_not_answered() {
    let (gaits, emotions) = walkers(&[Emotion::Angry, Emotion::Sad], 5, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let perceiver = PhasePerceiver::default().train(&seen, &emotions, 0).unwrap();
    let (others, _) = walkers(&[Emotion::Happy], 3, 2);
    for gait in &others {
        let p = perceiver.probabilities(gait);
        assert!(p[Emotion::Happy.index()] == 0.0 && p[Emotion::Neutral.index()] == 0.0);
    }
}

#[test]
fn what_cannot_be_learned_from_is_refused_with_the_reason() {
    let refused = |method: &PhasePerceiver, gaits: &[Gait], emotions: &[Emotion]| {
        let seen: Vec<&Gait> = gaits.iter().collect();
        method.train(&seen, emotions, 0).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let (mut gaits, emotions) = walkers(&[Emotion::Angry, Emotion::Sad], 3, 1);
    let bad = PhasePerceiver { ridges: vec![0.0], ..PhasePerceiver::default() };
    assert!(refused(&bad, &gaits, &emotions).contains("ridges [0.0]"));
    let method = PhasePerceiver::default();
    assert!(refused(&method, &gaits, &emotions[..2]).contains("6 gaits"));
    assert!(refused(&method, &gaits[..3], &emotions[..3]).contains("angry"));
    gaits[4].poses[0][3].y = f32::NAN;
    assert!(refused(&method, &gaits, &emotions).contains("sad1"));
    let same = vec![gaits[0].clone(); 6];
    assert!(refused(&method, &same, &emotions).contains("different motion"));
}

#[test]
fn a_model_from_its_file_answers_with_the_bits_of_the_perceiver_of_a_fold() {
    let (gaits, emotions) = walkers(&Emotion::ALL, 6, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let method = PhasePerceiver::default();
    let of_fold = method.train(&seen, &emotions, 3).unwrap();
    let model = method.model(&seen, &emotions, 3).unwrap();
    let loaded = Model::from_json(&model.to_json().unwrap(), "model.json").unwrap();
    assert_eq!(loaded, model);
    let (others, _) = walkers(&Emotion::ALL, 4, 2);
    for gait in &others {
        let bits = |p: [f64; 4]| p.map(f64::to_bits);
        assert_eq!(bits(of_fold.probabilities(gait)), bits(loaded.predict(gait).probabilities));
        assert_eq!(of_fold.emotion(gait), loaded.predict(gait).emotion);
        assert_eq!(loaded.predict(gait), model.predict(gait));
    }
}

#[test]
fn a_damaged_model_is_refused_with_the_reason() {
    let (gaits, emotions) = walkers(&Emotion::ALL, 3, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let text = PhasePerceiver::default().model(&seen, &emotions, 0).unwrap().to_json().unwrap();
    let refused = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        Model::from_json(&text.replacen(from, to, 1), "m.json").unwrap_err().to_string()
    };
    assert!(refused("\"mean\":[", "\"mean\":[1.0,").contains("180 means"));
    assert!(refused("\"planes\":[[", "\"planes\":[[1.0,").contains("181 numbers"));
    assert!(refused("\"emotions\":[\"happy\",", "\"emotions\":[").contains("4 planes for 3"));
    assert!(refused("\"rest\":", "\"rest\":-").contains("above 0"));
    assert!(refused("phase-perceiver", "affective-svm").contains("m.json: "));
}

#[test]
fn motion_that_is_no_walk_is_unlike_and_a_walk_is_not() {
    let model = Model::built_in().unwrap();
    let walk = walk(&WalkerStyle::preset(Emotion::Neutral, Sex::Male), "walk").unwrap();
    assert!(!model.predict(&walk).is_unlike());
    assert!(model.predict(&jumping_jack(&walk)).is_unlike());
    assert!(model.predict(&boxing(&walk)).is_unlike());
    let broken = Gait { poses: vec![[glam::Vec3::NAN; 16]; 30], ..walk };
    assert!(model.predict(&broken).is_unlike());
}

/// Arms and legs open and close together, on the spot.
fn jumping_jack(walk: &Gait) -> Gait {
    let mut gait = Gait { speed: 0.3, ..walk.clone() };
    let count = walk.poses.len() as f32;
    let still = walk.poses[0];
    for (i, pose) in gait.poses.iter_mut().enumerate() {
        let open = 0.5 - 0.5 * (i as f32 / count * std::f32::consts::TAU).cos();
        for joint in Joint::ALL {
            let (point, other) = (still[joint as usize], still[joint.mirrored() as usize]);
            pose[joint as usize] = (point + other * glam::Vec3::new(-1.0, 1.0, 1.0)) / 2.0;
        }
        for (joint, side) in [
            (Joint::LeftElbow, 1.0),
            (Joint::RightElbow, -1.0),
            (Joint::LeftHand, 1.0),
            (Joint::RightHand, -1.0),
        ] {
            let shoulder = pose[if side > 0.0 { Joint::LeftShoulder } else { Joint::RightShoulder } as usize];
            let reach = pose[joint as usize].distance(shoulder);
            let angle = 2.8 * open;
            pose[joint as usize] = shoulder + reach * glam::Vec3::new(side * angle.sin(), -angle.cos(), 0.0);
        }
        for (joint, side) in [
            (Joint::LeftKnee, 0.15),
            (Joint::RightKnee, -0.15),
            (Joint::LeftFoot, 0.3),
            (Joint::RightFoot, -0.3),
        ] {
            pose[joint as usize].x += side * open;
        }
    }
    gait
}

/// Walking legs, but hands before the face, of which the left one strikes twice a cycle.
fn boxing(walk: &Gait) -> Gait {
    let mut gait = walk.clone();
    let count = walk.poses.len() as f32;
    for (i, pose) in gait.poses.iter_mut().enumerate() {
        let strike = (i as f32 / count * 2.0 * std::f32::consts::TAU).sin().max(0.0);
        for (side, out) in [
            ([Joint::LeftShoulder, Joint::LeftElbow, Joint::LeftHand], strike),
            ([Joint::RightShoulder, Joint::RightElbow, Joint::RightHand], 0.2),
        ] {
            let shoulder = pose[side[0] as usize];
            pose[side[1] as usize] = shoulder + glam::Vec3::new(0.0, 0.2 * out - 0.2, 0.1 + 0.15 * out);
            pose[side[2] as usize] = shoulder + glam::Vec3::new(0.0, 0.05 - 0.05 * out, 0.2 + 0.4 * out);
        }
    }
    gait
}
