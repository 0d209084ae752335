use super::*;
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
        likeliest(&Learning { raw: &raw, emotions }, &ridges, &inner_folds(&seen, emotions, 3)).unwrap()
    };
    // labels that say nothing: the more they are distrusted the better
    let nothing: Vec<Emotion> = (0..40).map(|i| Emotion::ALL[i % 2]).collect();
    assert!((chosen(&nothing) - 1000.0).abs() < 1e-9);
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
        gait.subject = Some((i % 8).to_string());
    }
    let seen: Vec<&Gait> = gaits.iter().collect();
    let folds = inner_folds(&seen, &emotions, 2);
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
