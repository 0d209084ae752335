use super::*;
use crate::gait::Provenance;
use crate::perception::Perceiver;
use glam::Vec3;

fn gait(name: &str, dataset: &str, subject: Option<&str>) -> Gait {
    Gait {
        name: name.to_owned(),
        poses: vec![[Vec3::ZERO; 16]; 2],
        frame_rate: 30.0,
        speed: 1.0,
        provenance: Provenance {
            dataset: dataset.to_owned(),
            subject: subject.map(str::to_owned),
            ..Provenance::default()
        },
        ..Gait::default()
    }
}

/// 60 gaits of 15 people in 3 data sets.
fn gaits() -> (Vec<Gait>, Vec<Emotion>) {
    let gaits =
        (0..60).map(|i| gait(&format!("g{i}"), &format!("set{}", i % 3), Some(&format!("{}", i / 3 % 5))));
    (gaits.collect(), (0..60).map(|i| Emotion::ALL[(i * i + i / 7) % 4]).collect())
}

/// Answers the emotion that it saw most often.
struct Majority;

impl Method for Majority {
    fn name(&self) -> &'static str {
        "majority"
    }

    fn train(&self, _: &[&Gait], emotions: &[Emotion], _: u64) -> Result<Box<dyn Perceiver>, Error> {
        let mut counts = [0.0; 4];
        for emotion in emotions {
            counts[emotion.index()] += 1.0;
        }
        Ok(Box::new(Fixed(counts)))
    }
}

struct Fixed([f64; 4]);

impl Perceiver for Fixed {
    fn probabilities(&self, _: &Gait) -> [f64; 4] {
        self.0
    }
}

#[test]
fn a_person_is_a_subject_of_a_data_set_or_else_a_take() {
    assert_eq!(person(&gait("ale_walk_an_1_fin", "bml", Some("ale"))), "bml/ale");
    let mut take = gait("07_01#2", "mocap", None);
    assert_eq!(person(&take), "mocap/07_01#2");
    take.provenance.take = "07_01".to_owned();
    assert_eq!(person(&take), "mocap/07_01");
}

#[test]
fn stratified_folds_have_their_share_of_each_class() {
    let classes: Vec<usize> = (0..97).map(|i| [0, 0, 0, 1, 1, 2][i % 6]).collect();
    for seed in 0..5 {
        let folds = stratified(&classes, 10, seed);
        for class in 0..3 {
            let count = |fold| (0..97).filter(|&i| classes[i] == class && folds[i] == fold).count();
            let (low, high) = (0..10).map(count).fold((97, 0), |(l, h), n| (l.min(n), h.max(n)));
            assert!(high - low <= 1, "seed {seed}, class {class}: {low} to {high}");
        }
        let size = |fold| folds.iter().filter(|&&f| f == fold).count();
        assert!((0..10).all(|fold| (9..=10).contains(&size(fold))));
    }
    assert_ne!(stratified(&classes, 10, 0), stratified(&classes, 10, 1));
}

#[test]
fn no_person_is_in_two_folds_and_folds_are_of_like_size() {
    let (gaits, emotions) = gaits();
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let mut seen = std::collections::BTreeSet::new();
    for seed in 0..4 {
        let folds = folds(&gaits, &emotions, Grouping::Subject { folds: 5 }, seed).unwrap();
        let mut of_person = BTreeMap::new();
        for (gait, fold) in gaits.iter().zip(&folds) {
            assert_eq!(of_person.entry(person(gait)).or_insert(*fold), fold, "seed {seed}");
        }
        let size = |fold| folds.iter().filter(|&&f| f == fold).count();
        assert!((0..5).all(|fold| (8..=16).contains(&size(fold))), "{folds:?}");
        seen.insert(folds);
    }
    assert!(seen.len() > 1, "seeds shuffle");
}

#[test]
fn one_data_set_is_one_fold() {
    let (gaits, emotions) = gaits();
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let folds = folds(&gaits, &emotions, Grouping::Dataset, 0).unwrap();
    assert!(folds.iter().enumerate().all(|(i, &fold)| fold == i % 3));
}

#[test]
fn counts_of_a_known_method_are_right() {
    let (gaits, _) = gaits();
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let emotions: Vec<Emotion> =
        (0..60).map(|i| if i % 4 == 0 { Emotion::Sad } else { Emotion::Angry }).collect();
    let plan = Plan { grouping: Grouping::Stratified { folds: 5 }, seeds: vec![1, 2] };
    let found = evaluate(&Majority, &gaits, &emotions, &plan).unwrap();
    assert_eq!(found.confusion, [[0; 4], [0, 90, 0, 0], [0, 30, 0, 0], [0; 4]]);
    assert_eq!(found.recall.map(|share| (share * 100.0).round().to_string()), ["0", "100", "0", "0"]);
    assert!((found.accuracy_mean - 0.75).abs() < 1e-12 && found.accuracy_sd.abs() < 1e-12);
    assert_eq!(found.by_dataset.len(), 3);
}

#[test]
fn too_few_groups_are_refused_with_both_numbers() {
    let (gaits, emotions) = gaits();
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let text = folds(&gaits, &emotions, Grouping::Subject { folds: 16 }, 0).unwrap_err().to_string();
    assert!(text.contains("15 people for 16 folds"), "{text}");
    let text = folds(&gaits, &emotions, Grouping::Stratified { folds: 1 }, 0).unwrap_err().to_string();
    assert!(text.contains("at least 2"), "{text}");
}
