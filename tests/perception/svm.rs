//! The support vector machine against the stored answers of two others, linfa-svm and scikit-learn, and the
//! affective SVM on E-Gait.

use crate::egait;
use gaitway::Emotion;
use gaitway::gait::{Gait, import, stride};
use gaitway::library::GaitLibrary;
use gaitway::perception::affective_svm::AffectiveSvm;
use gaitway::perception::evaluate::{self, Grouping, Plan};
use gaitway::perception::model::{Model, Preparation};
use gaitway::perception::svm::{Gamma, Kernel, Scheme, Settings, Svm};
use gaitway::perception::{Method as _, Perceiver as _};
use std::collections::BTreeSet;

/// Numbers in [0, 1) that Python makes too.
struct Numbers(u64);

impl Iterator for Numbers {
    type Item = f64;

    fn next(&mut self) -> Option<f64> {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        Some((self.0 >> 40) as f64 / f64::from(1 << 24))
    }
}

/// 80 points in five dimensions, and four classes of them that overlap in none.
fn points() -> (Vec<Vec<f64>>, Vec<usize>) {
    let mut numbers = Numbers(12345);
    let points: Vec<Vec<f64>> =
        (0..80).map(|_| numbers.by_ref().take(5).map(|x| 2.0 * x - 1.0).collect()).collect();
    let class = |p: &Vec<f64>| usize::from(p[0] + p[1] * p[2] > 0.0) + 2 * usize::from(p[3] * p[3] > 0.3);
    let classes = points.iter().map(class).collect();
    (points, classes)
}

/// Decision values of linfa-svm, by kernel, C and machine; see the file's head.
const LINFA: &str = include_str!("linfa_svm.csv");

#[test]
fn decision_values_equal_those_of_linfa_svm() {
    let (points, classes) = points();
    let asked: Vec<Vec<f64>> =
        points.iter().step_by(10).map(|p| p.iter().map(|x| 0.5 * x + 0.1).collect()).collect();
    let rows: Vec<Vec<&str>> =
        LINFA.lines().filter(|line| !line.starts_with('#')).map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 45, "3 kernels, 3 values of C, 4 classes and a pair");
    for row in rows {
        let kernel = match row[0] {
            "linear" => Kernel::Linear,
            // a fifth is what Auto means for five numbers
            "0.2" => Kernel::Rbf(Gamma::Auto),
            gamma => Kernel::Rbf(Gamma::Value(gamma.parse().unwrap())),
        };
        // the pair (1, 3) is the fifth of six
        let (scheme, machine) = match row[2] {
            "pair" => (Scheme::OneVersusOne, 4),
            class => (Scheme::OneVersusRest, class.parse().unwrap()),
        };
        let settings =
            Settings { c: row[1].parse().unwrap(), kernel, scheme, tolerance: 1e-10, ..Settings::default() };
        let trained = Svm::train(&points, &classes, &settings).unwrap();
        assert_eq!(row.len(), 3 + asked.len());
        for (point, theirs) in asked.iter().zip(&row[3..]) {
            let (ours, theirs) = (trained.decisions(point)[machine], theirs.parse::<f64>().unwrap());
            assert!((ours - theirs).abs() < 1e-6, "{:?}: {ours} {theirs}", &row[..3]);
        }
    }
}

/// C, gamma, one-versus-one decisions of three points, their one-versus-rest decisions, one-versus-one answers for twelve.
type SklearnCase = (f64, Gamma, [[f64; 6]; 3], [[f64; 4]; 3], [usize; 12]);

/// `SVC(tol=1e-10)` and `OneVsRestClassifier(SVC(tol=1e-10))` of scikit-learn.
#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "as Python printed them")]
const SKLEARN: [SklearnCase; 2] = [
    (1.0, Gamma::Auto,
     [[0.8013761427742652, 0.5189187264840519, 1.3518678161610158, -0.46002050862677446, 1.0058433284569985, 1.1371710180565882],
      [-0.1362762019303228, 0.49140929980071457, 0.5576976322441802, 0.3345860650492827, 1.0618210405421364, 0.5498725933683477],
      [-0.6633968405730406, 0.44563701952529977, -0.27136240232753134, 0.8613637772114795, 0.47558754420929106, -0.3297221678351881]],
     [[-0.28991951346774913, -1.0868801344343537, -0.7550376074289991, -1.6798409361455275],
      [-0.9821880167631727, -0.5101299566110504, -0.9488932961213516, -1.3986117949664654],
      [-1.3331898026831057, -0.33551151365318566, -1.0981694931000645, -0.8115235577869977]],
     [0, 1, 1, 0, 0, 0, 1, 0, 3, 0, 1, 0]),
    (10.0, Gamma::Scale,
     [[0.7756346965388417, 0.5442968505226669, 1.5391377534581772, 0.600336425984499, 0.4296945394828088, 1.7414222177591905],
      [-1.3084692541210563, 0.4568633539638805, 0.6701658993944771, 1.2985360721837094, 1.7403264709110475, 0.7040791286944723],
      [-1.9038798208138679, 0.04275360026143554, -0.14818471200929662, 1.4118649724206491, 1.1143565281750996, -0.6790498773133321]],
     [[0.09369994338431653, -0.7985804866585342, -0.7153582406324159, -2.160062190721607],
      [-0.9023390862877274, 1.101078218349767, -1.0853529673671372, -2.248321504282386],
      [-1.9140652275877428, 1.260232515101173, -1.6075866439681261, -0.996915291205436]],
     [0, 1, 1, 0, 0, 0, 1, 0, 1, 0, 1, 0]),
];

#[test]
fn many_classes_are_separated_as_scikit_learn_does() {
    let (points, classes) = points();
    let asked: Vec<Vec<f64>> = points.iter().map(|p| p.iter().map(|x| 0.5 * x).collect()).collect();
    for (c, gamma, ovo, ovr, answers) in SKLEARN {
        let settings = Settings { c, kernel: Kernel::Rbf(gamma), tolerance: 1e-10, ..Settings::default() };
        let one = Svm::train(&points, &classes, &settings).unwrap();
        let rest = Settings { scheme: Scheme::OneVersusRest, ..settings };
        let rest = Svm::train(&points, &classes, &rest).unwrap();
        for (point, (ovo, ovr)) in asked.iter().zip(ovo.iter().zip(&ovr)) {
            for (ours, theirs) in
                one.decisions(point).iter().zip(ovo).chain(rest.decisions(point).iter().zip(ovr))
            {
                assert!((ours - theirs).abs() < 1e-6, "C {c}: {ours} {theirs}");
            }
        }
        let ours: Vec<usize> = asked[..12].iter().map(|point| one.predict(point)).collect();
        assert_eq!(ours, answers, "C {c}");
    }
}

/// Scheme, C, gamma, and right answers of 232 in the repeats with seeds 0, 1 and 2: stratified, then person-wise.
type EgaitCase = (Scheme, f64, Gamma, [u32; 6]);

/// What scikit-learn answers on the very same folds, with features that numpy computed (scaled on training folds).
#[rustfmt::skip]
const EGAIT: [EgaitCase; 8] = [
    (Scheme::OneVersusOne, 1.0, Gamma::Auto, [124, 121, 121, 125, 124, 126]),
    (Scheme::OneVersusOne, 1.0, Gamma::Scale, [131, 128, 130, 137, 142, 135]),
    (Scheme::OneVersusOne, 10.0, Gamma::Auto, [137, 136, 139, 145, 144, 145]),
    (Scheme::OneVersusOne, 10.0, Gamma::Scale, [127, 127, 126, 136, 131, 136]),
    (Scheme::OneVersusRest, 1.0, Gamma::Auto, [123, 126, 126, 128, 130, 128]),
    (Scheme::OneVersusRest, 1.0, Gamma::Scale, [129, 127, 128, 132, 136, 132]),
    (Scheme::OneVersusRest, 10.0, Gamma::Auto, [134, 133, 135, 137, 142, 135]),
    (Scheme::OneVersusRest, 10.0, Gamma::Scale, [136, 129, 134, 146, 135, 147]),
];

#[test]
fn on_egait_every_setting_is_right_as_often_as_scikit_learn() {
    let mut gaits: Vec<Gait> = Vec::new();
    for set in egait::SETS {
        let Some(found) = egait::raw(set, 0.0) else { return };
        gaits.extend(found);
    }
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let emotions: Vec<Emotion> = gaits.iter().map(|gait| gait.label.unwrap()).collect();
    for (scheme, c, gamma, expected) in EGAIT {
        let settings = Settings { scheme, c, kernel: Kernel::Rbf(gamma), ..Settings::default() };
        let method = AffectiveSvm { settings, ..AffectiveSvm::default() };
        let groupings = [Grouping::Stratified { folds: 10 }, Grouping::Subject { folds: 10 }];
        for (grouping, expected) in groupings.into_iter().zip(expected.chunks(3)) {
            let plan = Plan { grouping, seeds: vec![0, 1, 2] };
            let found = evaluate::evaluate(&method, &gaits, &emotions, &plan).unwrap();
            println!(
                "{}: {}: {:.1} +- {:.1} %",
                method.describe(),
                grouping.describe(),
                found.accuracy_mean * 100.0,
                found.accuracy_sd * 100.0
            );
            for (accuracy, expected) in found.accuracies.iter().zip(expected) {
                // one gait in 232 may sit on a boundary to within the two solvers' tolerances
                let right = accuracy * 232.0;
                assert!(
                    (right - f64::from(*expected)).abs() < 1.1,
                    "{}: {right}, not {expected}",
                    method.describe()
                );
            }
        }
    }
}

#[test]
fn imported_egait_gaits_know_their_person_and_data_set() {
    let Some(folder) = egait::folder() else { return };
    let mut gaits = Vec::new();
    for set in egait::SETS {
        for take in import::import_file(&folder.join(format!("{set}.csv"))).unwrap() {
            gaits.push(stride::best(&take).unwrap());
        }
    }
    let index = std::fs::read_to_string(folder.join("gaits.csv")).unwrap();
    let rows: Vec<Vec<&str>> = index.lines().skip(1).map(|line| line.split(',').collect()).collect();
    assert_eq!((gaits.len(), rows.len()), (232, 232));
    for gait in &gaits {
        let row = rows.iter().find(|row| row[1] == gait.name).unwrap();
        assert_eq!(gait.provenance.dataset, row[2], "{}: {}", gait.name, gait.provenance);
        assert_eq!(evaluate::person(gait), format!("{}/{}", row[2], row[3]));
        assert_eq!(gait.label.unwrap().name(), row[5]);
    }
    let people: BTreeSet<String> = gaits.iter().map(evaluate::person).collect();
    println!("{} people", people.len());
    assert_eq!(people.len(), 92);
}

#[test]
fn a_model_comes_back_from_its_file_with_the_same_bits_and_no_other_version_is_read() {
    let library = GaitLibrary::built_in().unwrap();
    let gaits: Vec<&Gait> = library.gaits().iter().collect();
    let emotions: Vec<Emotion> = gaits.iter().map(|gait| gait.label.unwrap()).collect();
    let model = AffectiveSvm::default().model(&gaits, &emotions, 1).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("model.json");
    model.save(&path).unwrap();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "nothing half-written beside it");
    let loaded = Model::load(&path).unwrap();
    assert_eq!(loaded, model);
    for gait in &gaits {
        assert_eq!(loaded.predict(gait), model.predict(gait));
    }
    let right = gaits.iter().filter(|gait| Some(model.predict(gait).emotion) == gait.label).count();
    assert!(right * 10 >= gaits.len() * 9, "{right} of {}", gaits.len());

    let text = std::fs::read_to_string(&path).unwrap();
    let error = |text: &str| Model::from_json(text, "m.json").unwrap_err().to_string();
    let newer = error(&text.replacen("\"version\":2", "\"version\":3", 1));
    assert!(newer.contains("version 3") && newer.contains("reads versions 1 to 2"), "{newer}");
    assert!(error(&text.replacen("affective-svm", "karg-2010", 1)).contains("karg-2010"));
    assert!(error("{}").contains("format"));
    assert!(error(&text[..text.len() / 2]).starts_with("m.json: not a model in JSON"));
    assert!(error(&text.replacen("\"low\":[", "\"low\":[0.5,", 1)).contains("expected 29"));
    assert!(error(&text.replacen("\"classes\":[0,", "\"classes\":[7,", 1)).contains("classes"));
}

#[test]
fn a_model_of_version_1_is_still_read_and_sees_what_it_saw() {
    let library = GaitLibrary::generated(5, 3).unwrap();
    let gaits: Vec<&Gait> = library.gaits().iter().collect();
    let emotions: Vec<Emotion> = gaits.iter().map(|gait| gait.label.unwrap()).collect();
    let model = AffectiveSvm::default().model(&gaits, &emotions, 1).unwrap();
    let mut old: serde_json::Value = serde_json::from_str(&model.to_json().unwrap()).unwrap();
    for key in ["preparation", "novelty", "held_out"] {
        old.as_object_mut().unwrap().remove(key);
    }
    old["version"] = 1.into();
    let old = Model::from_json(&old.to_string(), "old.json").unwrap();
    assert_eq!((old.preparation(), old.knows_novelty()), (Preparation::Repaired, false));
    for gait in gaits {
        let (then, now) = (old.predict(gait), model.predict(gait));
        assert_eq!(then.probabilities.map(f64::to_bits), now.probabilities.map(f64::to_bits));
        assert!(then.novelty.is_none() && !then.is_unlike() && now.novelty.is_some());
    }
}

#[test]
fn the_emotion_told_is_the_most_probable_one_also_where_the_machine_decides_otherwise() {
    // labels without any sense: decision values and calibrated probabilities then disagree most often
    let library = GaitLibrary::generated(9, 8).unwrap();
    let gaits: Vec<&Gait> = library.gaits().iter().collect();
    let emotions: Vec<Emotion> = (0..gaits.len()).map(|i| Emotion::ALL[i * i % 7 % 4]).collect();
    let mut apart = 0;
    for scheme in [Scheme::OneVersusOne, Scheme::OneVersusRest] {
        let fallback = AffectiveSvm::default();
        let settings = Settings { scheme, ..fallback.settings.clone() };
        let method = AffectiveSvm { settings, ..fallback };
        let model = method.model(&gaits, &emotions, 1).unwrap();
        let decided = method.train(&gaits, &emotions, 1).unwrap();
        for gait in &gaits {
            let seen = model.predict(gait);
            assert!(seen.probabilities.iter().all(|p| *p <= seen.probabilities[seen.emotion.index()]));
            assert_eq!(model.emotion(gait), seen.emotion);
            apart += usize::from(decided.emotion(gait) != seen.emotion);
        }
    }
    assert!(apart > 0, "nothing was tested");
}

/// How long it takes is said, not asserted: that is the machine's. (Below a second on two cores, optimised.)
#[test]
fn ten_thousand_gaits_are_judged_side_by_side_as_one_by_one() {
    // labels without any sense make nearly every training gait a support vector: as many as E-Gait's 223 and more
    let library = GaitLibrary::generated(9, 30).unwrap();
    let train: Vec<&Gait> = library.gaits().iter().collect();
    let emotions: Vec<Emotion> = (0..train.len()).map(|i| Emotion::ALL[i * i % 7 % 4]).collect();
    let model = AffectiveSvm::default().model(&train, &emotions, 1).unwrap();
    assert!(model.svm().unwrap().support_count() > 220);
    // 60 frames at 30 Hz: nothing is dropped by resampling
    let mut gaits = library.gaits().to_vec();
    for gait in &mut gaits {
        gait.poses.truncate(60);
        gait.poses.extend_from_within(..60 - gait.poses.len());
        gait.frame_rate = 30.0;
    }
    let count = gaits.len();
    let gaits: Vec<&Gait> = gaits.iter().cycle().take(10_000).collect();
    assert!(gaits.iter().all(|gait| gait.poses.len() == 60));
    let pool = rayon::ThreadPoolBuilder::new().num_threads(2).build().unwrap();
    let begin = std::time::Instant::now();
    let predictions = pool.install(|| model.predict_all(&gaits));
    let seconds = begin.elapsed().as_secs_f64();
    println!(
        "{} gaits, {} support vectors: {seconds:.3} s",
        predictions.len(),
        model.svm().unwrap().support_count()
    );
    assert_eq!(predictions.len(), 10_000);
    let one_by_one: Vec<_> = gaits[..count].iter().map(|gait| model.predict(gait).probabilities).collect();
    assert!(
        predictions
            .iter()
            .zip(one_by_one.iter().cycle())
            .all(|(a, b)| a.probabilities.map(f64::to_bits) == b.map(f64::to_bits))
    );
}
