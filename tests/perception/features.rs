//! The 29 features against values computed from the specification alone with Python and numpy, and what must hold of
//! them whatever the gait.

use crate::egait;
use gaitway::Emotion;
use gaitway::gait::walker::{Sex, WalkerStyle, person, walk};
use gaitway::gait::{Gait, Joint, Pose};
use gaitway::kernels::{KernelId, Phase, Store};
use gaitway::perception::features::{Batch, FEATURE_COUNT, FEATURES, Variant, features};
use glam::{Quat, Vec3};

/// Set, gait, variant, and the 29 values for the file's numbers taken for metres, rounded to f32, 30 Hz, 1.25 m/s.
type Expected = (&'static str, &'static str, Variant, [f64; FEATURE_COUNT]);

#[rustfmt::skip]
#[allow(clippy::unreadable_literal, reason = "as numpy printed them")]
const EXPECTED: [Expected; 9] = [
    ("bml", "ale_walk_an_1_fin", Variant::Paper, [0.178023453356, 142.659633373, 19.2348302651, 18.1055363623, 14.3244487568, 147.08686697, 0.260957984866, 0.276533270604, 0.643449244281, 0.639212846524, 0.0889415702818, 0.100687407564, 0.513065085438, 1.33505075925, 1.39805938862, 1.27150656658, 1.43575054851, 1.44759437987, 5.8440571141, 7.2606710113, 1.61161189214, 6.60407961119, 5.74727919509, 68.0127273123, 83.992367578, 36.4488095108, 111.709912999, 95.1073213782, 1.13333333333]),
    ("bml", "ale_walk_an_1_fin", Variant::Corrected, [0.177647593673, 142.659633373, 19.2348302651, 18.1055363623, 30.4929504744, 147.08686697, 0.260957984866, 0.276533270604, 0.643449244281, 0.639212846524, 0.0889415702818, 0.100687407564, 0.513065085438, 1.4122675612, 1.38689573458, 1.26291567237, 1.48262297783, 1.47864661344, 11.070172089, 7.73678154589, 2.69808114852, 8.3466782906, 7.88907113439, 392.526846524, 130.219036854, 103.426762588, 229.305059076, 220.636480699, 1.13333333333]),
    ("bml", "ale_walk_an_1_fin", Variant::StepCode, [178023.453356, 142.659633373, 19.2348302651, 18.1055363623, 30.4929504744, 147.08686697, 26.0957984866, 27.6533270604, 64.3449244281, 63.9212846524, 889.415702818, 1006.87407564, 12.0, 133.505075925, 139.805938862, 127.150656658, 143.575054851, 144.759437987, 584.40571141, 726.06710113, 161.161189214, 660.407961119, 574.727919509, 6801.27273123, 8399.2367578, 3644.88095108, 11170.9912999, 9510.73213782, 0.4]),
    ("cmu", "07_01", Variant::Paper, [0.1389567436, 155.833523028, 11.4450791242, 12.7213978477, 16.9540196968, 177.53730252, 0.227438172998, 0.238309264365, 0.664102989208, 0.673834114768, 0.073521151148, 0.112551723492, 0.554008517107, 1.26743506076, 1.33931110053, 1.24409199891, 1.33388036107, 1.34620724664, 4.29469449501, 5.66491065592, 1.35402480325, 9.07126433573, 10.0634835097, 129.388846605, 160.941883832, 65.1749189107, 215.231215214, 293.610342837, 1.1]),
    ("cmu", "07_01", Variant::Corrected, [0.139631539312, 155.833523028, 11.4450791242, 12.7213978477, 17.4706487914, 177.53730252, 0.227438172998, 0.238309264365, 0.664102989208, 0.673834114768, 0.073521151148, 0.112551723492, 0.554008517107, 1.28219601836, 1.33545618554, 1.25082980934, 1.32832151458, 1.33723280975, 5.69413028729, 5.98465276479, 1.8477684201, 9.74596428828, 11.0357780578, 218.601741485, 184.033308876, 94.6387443885, 287.356641583, 368.692499779, 1.1]),
    ("cmu", "07_01", Variant::StepCode, [138956.7436, 155.833523028, 11.4450791242, 12.7213978477, 17.4706487914, 177.53730252, 22.7438172998, 23.8309264365, 66.4102989208, 67.3834114768, 735.21151148, 1125.51723492, 16.5, 126.743506076, 133.931110053, 124.409199891, 133.388036107, 134.620724664, 429.469449501, 566.491065592, 135.402480325, 907.126433573, 1006.34835097, 12938.8846605, 16094.1883832, 6517.49189107, 21523.1215214, 29361.0342837, 0.55]),
    ("ewalk", "001_Sad", Variant::Paper, [0.160593512919, 125.688814452, 27.1489836406, 27.1622019073, 11.7950750024, 151.592591292, 0.178994656212, 0.195251053373, 0.626524347503, 0.671586392689, 0.0683639127622, 0.0790939939978, 0.415772967277, 1.27850523603, 1.21018785048, 1.27527844641, 1.30702786696, 1.32172154557, 4.91313272781, 5.89539235131, 2.66039955579, 6.18330508162, 6.60499240491, 219.696971408, 304.256186816, 121.356995495, 247.581153123, 235.640455302, 1.23333333333]),
    ("ewalk", "001_Sad", Variant::Corrected, [0.161169733036, 125.688814452, 27.1489836406, 27.1622019073, 19.4631174193, 151.592591292, 0.178994656212, 0.195251053373, 0.626524347503, 0.671586392689, 0.0683639127622, 0.0790939939978, 0.415772967277, 1.25575619354, 1.26161560041, 1.2724479228, 1.31099869467, 1.41090000128, 6.50358234286, 8.62039561029, 4.35626366146, 7.55255075715, 11.8933830854, 319.970477716, 455.353882183, 221.641795762, 333.140319355, 545.711956392, 1.23333333333]),
    ("ewalk", "001_Sad", Variant::StepCode, [160593.512919, 125.688814452, 27.1489836406, 27.1622019073, 19.4631174193, 151.592591292, 17.8994656212, 19.5251053373, 62.6524347503, 67.1586392689, 683.639127622, 790.939939978, 6.0, 127.850523603, 121.018785048, 127.527844641, 130.702786696, 132.172154557, 491.313272781, 589.539235131, 266.039955579, 618.330508162, 660.499240491, 21969.6971408, 30425.6186816, 12135.6995495, 24758.1153123, 23564.0455302, 0.2]),
];

fn assert_close(what: &str, found: &[f64], expected: &[f64], relative: f64) {
    for ((found, expected), feature) in found.iter().zip(expected).zip(FEATURES) {
        let error = (found - expected).abs();
        assert!(
            error <= relative * expected.abs().max(1.0),
            "{what}: {} is {found}, expected {expected}",
            feature.name
        );
    }
}

#[test]
fn features_of_three_gaits_equal_an_independent_computation() {
    for (set, key, variant, expected) in EXPECTED {
        let Some(gaits) = egait::raw(set, 1.25) else { return };
        let gait = gaits.iter().find(|gait| gait.name == key).unwrap();
        assert_close(&format!("{key}, {}", variant.name()), &features(gait, variant), &expected, 1e-9);
    }
}

fn walkers() -> Vec<Gait> {
    let of = |emotion| Sex::ALL.map(|sex| person(emotion, sex, 5, 2).unwrap());
    Emotion::ALL.into_iter().flat_map(of).collect()
}

fn mapped(gait: &Gait, change: impl Fn(&Pose) -> Pose) -> Gait {
    Gait { poses: gait.poses.iter().map(change).collect(), ..gait.clone() }
}

/// The index of the same feature of the other side.
fn other_side(index: usize) -> usize {
    let name = FEATURES[index].name;
    let other = if name.starts_with("left") {
        name.replacen("left", "right", 1)
    } else {
        name.replacen("right", "left", 1)
    };
    FEATURES.iter().position(|feature| feature.name == other).unwrap()
}

#[test]
fn swapping_the_sides_swaps_the_features_of_the_sides_and_leaves_the_others() {
    for gait in walkers() {
        for variant in Variant::ALL {
            let own = features(&gait, variant);
            // names swapped, and the body mirrored
            let named = mapped(&gait, |pose| Joint::ALL.map(|joint| pose[joint.mirrored() as usize]));
            let mirrored = mapped(&named, |pose| pose.map(|point| point * Vec3::new(-1.0, 1.0, 1.0)));
            for swapped in [named, mirrored] {
                let swapped: Vec<f64> = features(&swapped, variant).to_vec();
                let mut expected: Vec<f64> = (0..FEATURE_COUNT).map(|i| own[other_side(i)]).collect();
                if variant == Variant::StepCode {
                    // which maxima the authors' box misses depends on the order of the joints
                    expected[0] = swapped[0];
                }
                assert_close(&format!("{}, {}", gait.name, variant.name()), &swapped, &expected, 1e-9);
            }
        }
    }
}

#[test]
fn the_heading_of_the_body_does_not_matter_to_corrected_posture_and_does_to_that_of_the_paper() {
    let changes = walkers().into_iter().map(|gait| {
        let turned = mapped(&gait, |pose| pose.map(|point| Quat::from_rotation_y(0.7) * point));
        let (own, other) = (features(&gait, Variant::Corrected), features(&turned, Variant::Corrected));
        assert_close("corrected", &other[..13], &own[..13], 1e-5);
        let paper = [&gait, &turned].map(|gait| features(gait, Variant::Paper)[0]);
        (paper[1] / paper[0] - 1.0).abs()
    });
    let most = changes.fold(0.0, f64::max);
    assert!(most > 0.05, "the box of the paper changes by {most}");
}

#[test]
fn speeds_are_those_over_the_ground() {
    for gait in walkers() {
        let own = features(&gait, Variant::Corrected);
        let standing = features(&Gait { speed: 0.0, ..gait.clone() }, Variant::Corrected);
        // the head goes along with the walker; a foot must catch up, so its mean speed is at least the walker's
        assert!((own[15] / f64::from(gait.speed) - 1.0).abs() < 0.05, "{}: head {}", gait.name, own[15]);
        assert!(own[16] >= f64::from(gait.speed) * 0.98 && standing[15] < 0.5 * own[15]);
        // a constant velocity has neither acceleration nor jerk
        assert_close(&gait.name, &own[18..28], &standing[18..28], 1e-9);
    }
}

/// The same walk sampled at another rate: the features stay, the jerks, which ask for more than 30 Hz can tell, nearly.
#[test]
fn corrected_features_do_not_depend_on_the_frame_rate_and_those_of_the_paper_do() {
    let style = WalkerStyle::preset(Emotion::Happy, Sex::Female);
    let fine = walk(&style, "fine").unwrap();
    let half = Gait {
        poses: fine.poses.iter().step_by(2).copied().collect(),
        frame_rate: fine.frame_rate / 2.0,
        ..fine.clone()
    };
    assert!(half.poses.len() * 2 == fine.poses.len(), "an even number of frames");
    let [a, b] = [&fine, &half].map(|gait| features(gait, Variant::Corrected));
    for (i, feature) in FEATURES.iter().enumerate() {
        let allowed = if feature.name.ends_with("jerk") { 0.15 } else { 0.02 };
        assert!((a[i] / b[i] - 1.0).abs() < allowed, "{}: {} {}", feature.name, a[i], b[i]);
    }
    let [a, b] = [&fine, &half].map(|gait| features(gait, Variant::StepCode));
    assert!((a[13] / b[13] - 1.0).abs() > 0.3, "the authors' speeds are per frame: {} {}", a[13], b[13]);
}

#[test]
fn degenerate_gaits_give_numbers_or_none_but_no_panic() {
    let gait = |frames| Gait { poses: vec![[Vec3::ZERO; 16]; frames], ..walkers()[0].clone() };
    for variant in Variant::ALL {
        assert!(features(&gait(0), variant).iter().all(|value| value.is_nan()));
        for frames in 1..6 {
            let found = features(&gait(frames), variant);
            assert!(found.iter().all(|value| value.is_finite()), "{frames} frames, {variant:?}: {found:?}");
        }
        let broken = mapped(&gait(9), |pose| pose.map(|_| Vec3::NAN));
        assert!(features(&broken, variant).iter().any(|value| value.is_nan()));
    }
}

#[test]
fn the_kernel_agrees_with_the_features_in_f64() {
    let mut gaits = walkers();
    if let Some(bml) = egait::raw("bml", 1.25) {
        gaits.extend(bml);
    }
    let gaits: Vec<&Gait> = gaits.iter().collect();
    let batch = Batch::new(&gaits).unwrap();
    let mut store = Store {
        feature_rows: vec![[f32::NAN; 4]; gaits.len() * 8],
        gait_frames: batch.frames,
        gait_table: batch.table,
        failure: vec![u32::MAX; KernelId::ALL.len()],
        ..Store::default()
    };
    gaitway::reference::run(Phase::GaitFeatures, &mut store, 0);
    assert_eq!(store.failure[KernelId::GaitFeatures as usize], u32::MAX);
    for (gait, row) in gaits.iter().zip(store.feature_rows.chunks(8)) {
        let row: Vec<f64> = row.iter().flatten().take(FEATURE_COUNT).map(|x| f64::from(*x)).collect();
        let own = features(gait, Variant::Corrected);
        // differences of f32 positions over a thirtieth of a second, cubed: 1e-7 m become 0.03 m/s3
        assert_close(&gait.name, &row[..23], &own[..23], 2e-3);
        for i in 23..28 {
            assert!((row[i] - own[i]).abs() < 0.05 + 1e-3 * own[i], "{}: {} {}", gait.name, row[i], own[i]);
        }
        assert!((row[28] - own[28]).abs() < 1e-6);
    }
}
