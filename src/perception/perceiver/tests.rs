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
fn one_seed_gives_the_same_bits_and_another_seed_others() {
    // labels that say nothing: no discriminant is certain
    let (gaits, _) = walkers(&[Emotion::Neutral], 24, 1);
    let emotions: Vec<Emotion> = (0..24).map(|i| Emotion::ALL[i % 4]).collect();
    let seen: Vec<&Gait> = gaits.iter().collect();
    let (others, _) = walkers(&[Emotion::Neutral], 1, 2);
    let told =
        |seed| PhasePerceiver::default().train(&seen, &emotions, seed).unwrap().probabilities(&others[0]);
    assert_eq!(told(3).map(f64::to_bits), told(3).map(f64::to_bits));
    assert_ne!(told(3).map(f64::to_bits), told(4).map(f64::to_bits));
}

#[test]
fn an_emotion_that_was_not_learned_is_not_answered() {
    let (gaits, emotions) = walkers(&[Emotion::Angry, Emotion::Sad], 5, 1);
    let seen: Vec<&Gait> = gaits.iter().collect();
    let perceiver = PhasePerceiver::default().train(&seen, &emotions, 0).unwrap();
    let (others, _) = walkers(&[Emotion::Happy], 3, 2);
    for gait in &others {
        let p = perceiver.probabilities(gait);
        assert!(p[Emotion::Happy.index()] < 1e-12 && p[Emotion::Neutral.index()] < 1e-12);
    }
}

#[test]
fn what_cannot_be_learned_from_is_refused_with_the_reason() {
    let refused = |method: &PhasePerceiver, gaits: &[Gait], emotions: &[Emotion]| {
        let seen: Vec<&Gait> = gaits.iter().collect();
        method.train(&seen, emotions, 0).err().map(|error| error.to_string()).unwrap_or_default()
    };
    let (mut gaits, emotions) = walkers(&[Emotion::Angry, Emotion::Sad], 3, 1);
    let bad = PhasePerceiver { ridge: 0.0, ..PhasePerceiver::default() };
    assert!(refused(&bad, &gaits, &emotions).contains("ridge 0"));
    let method = PhasePerceiver::default();
    assert!(refused(&method, &gaits, &emotions[..2]).contains("6 gaits"));
    assert!(refused(&method, &gaits[..3], &emotions[..3]).contains("angry"));
    gaits[4].poses[0][3].y = f32::NAN;
    assert!(refused(&method, &gaits, &emotions).contains("sad1"));
    let same = vec![gaits[0].clone(); 6];
    assert!(refused(&method, &same, &emotions).contains("different motion"));
}
