//! Agreement of raters.

use crate::yardsticks::{Comparison, answers, digits, real, reals, rows};
use gaitway::statistics::agreement::{Metric, agreement, krippendorff_alpha};
use gaitway::statistics::icc::{Icc, cronbach, icc};
use gaitway::statistics::kappa::{Weights, kappa, self_agreement};
use gaitway::statistics::stability::{greatest_mean, label_stability};

#[test]
fn kappa_agrees_with_statsmodels() {
    let mut found = Comparison::default();
    for row in rows("kappas") {
        let counts: Vec<Vec<u64>> = serde_json::from_value(row[0].clone()).unwrap();
        for (i, weights) in [Weights::Equal, Weights::Linear, Weights::Quadratic].into_iter().enumerate() {
            let ours = kappa(&counts, weights).unwrap();
            found.see(ours.kappa, real(&row[1 + 2 * i]), &(row, weights));
            found.see(ours.error, real(&row[2 + 2 * i]), &(row, weights));
            let half = 1.959_963_984_540_054 * ours.error;
            let bounds = [(ours.kappa - half).max(-1.0), (ours.kappa + half).min(1.0)];
            found.see(ours.interval[0], bounds[0], &(row, weights));
            found.see(ours.interval[1], bounds[1], &(row, weights));
        }
    }
    found.tell("kappa, standard error, interval", 600);
}

#[test]
fn intraclass_correlations_and_cronbach_agree_with_pingouin() {
    let (mut icc_found, mut alpha) = (Comparison::default(), Comparison::default());
    for row in rows("reliability") {
        let table = answers(&row[0], &row[1]);
        let ours = icc(&table, 0.95).unwrap();
        let models = [ours.one_way, ours.agreement, ours.consistency];
        let single = |model: &Icc| [model.single, model.single_interval[0], model.single_interval[1]];
        let mean = |model: &Icc| [model.mean, model.mean_interval[0], model.mean_interval[1]];
        let all = models.iter().map(single).chain(models.iter().map(mean));
        for (ours, theirs) in all.zip(row[2].as_array().unwrap()) {
            for (ours, theirs) in ours.into_iter().zip(reals(theirs)) {
                icc_found.see(ours, theirs, row);
            }
        }
        for (model, theirs) in [ours.one_way, ours.consistency].iter().zip(row[3].as_array().unwrap()) {
            icc_found.see(model.f, real(&theirs[0]), row);
            icc_found.see(model.p, real(&theirs[1]), row);
        }
        let found = cronbach(&table, 0.95).unwrap();
        for (ours, theirs) in
            [found.alpha, found.interval[0], found.interval[1]].into_iter().zip(reals(&row[4]))
        {
            alpha.see(ours, theirs, row);
        }
        // The one-way model of tables with gaps is the same where there are none.
        let units: Vec<Vec<u8>> = digits(&row[0], &row[1]);
        let one_way = agreement(&units);
        assert!((one_way.icc_single - ours.one_way.single).abs() < 1e-12);
        assert!((one_way.icc_mean - ours.one_way.mean).abs() < 1e-11 * ours.one_way.mean.abs().max(1.0));
        // Cronbach's alpha is ICC(3,k).
        assert!((found.alpha - ours.consistency.mean).abs() < 1e-12);
    }
    icc_found.tell("ICC with intervals, F and p", 1300);
    alpha.tell("Cronbach's alpha with Feldt's interval", 180);
}

#[test]
fn intraclass_correlations_are_those_of_shrout_and_fleiss() {
    // Shrout and Fleiss 1979, tables 2 and 4: six targets, four judges
    let table = [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
        .map(|row| row.map(f64::from));
    let found = icc(&table, 0.95).unwrap();
    let all = [found.one_way, found.agreement, found.consistency].map(|model| [model.single, model.mean]);
    for (found, published) in all.iter().flatten().zip([0.17, 0.44, 0.29, 0.62, 0.71, 0.91]) {
        assert!((found - published).abs() < 5e-3, "{found} {published}");
    }
}

#[test]
fn raters_who_agree_perfectly_have_a_result() {
    let found = icc(&[[1.0, 1.0], [3.0, 3.0], [5.0, 5.0]], 0.95).unwrap();
    for model in [found.one_way, found.agreement, found.consistency] {
        assert_eq!([model.single, model.mean, model.p], [1.0, 1.0, 0.0]);
        assert_eq!([model.single_interval, model.mean_interval], [[1.0; 2]; 2]);
    }
}

#[test]
fn krippendorffs_alpha_agrees_with_his_package() {
    let mut found = Comparison::default();
    for row in rows("alphas") {
        let table = answers(
            &serde_json::json!(row[1].as_str().unwrap().len() / row[0].as_u64().unwrap() as usize),
            &row[1],
        );
        let units: Vec<Vec<u8>> = (0..table[0].len())
            .map(|unit| table.iter().map(|rater| rater[unit] as u8).filter(|&answer| answer > 0).collect())
            .collect();
        for (i, metric) in [Metric::Nominal, Metric::Ordinal, Metric::Interval].into_iter().enumerate() {
            found.see(krippendorff_alpha(&units, metric), real(&row[2 + i]), &(row, metric));
        }
    }
    found.tell("Krippendorff's alpha", 150);
}

#[test]
fn repeated_answers_agree_as_counted_by_hand() {
    let found = self_agreement(&[[1, 1], [2, 3], [5, 3], [3, 3]], 5).unwrap();
    assert_eq!([found.equal, found.mean_difference], [0.5, 0.75]);
    // squares observed (1 + 4) / 4; expected, over 16 pairs of firsts 1 2 5 3 and seconds 1 3 3 3: 48 / 16
    assert!((found.kappa.unwrap().kappa - (1.0 - 1.25 / 3.0)).abs() < 1e-12, "{found:?}");
    let same = self_agreement(&[[2, 2], [2, 2]], 5).unwrap();
    assert!(same.equal > 0.99 && same.kappa.is_none());
}

#[test]
fn a_label_is_as_stable_as_its_raters_are_many_and_of_one_mind() {
    let happy = |count: usize, of: usize| -> Vec<[u8; 4]> {
        (0..of).map(|i| if i < count { [5, 1, 1, 2] } else { [2, 1, 1, 5] }).collect()
    };
    let units = [happy(10, 10), happy(7, 10), happy(70, 100), vec![[3; 4]; 6]];
    let found = label_stability(&units, |answers| greatest_mean(answers, 3.0), 2000, 5).unwrap();
    assert_eq!([found.units[0], found.units[3]], [1.0, 1.0]); // the last stays without a label
    assert!((0.8..0.97).contains(&found.units[1]) && found.units[2] > 0.998, "{found:?}");
    // what a unit draws does not depend on how others are drawn
    let first = label_stability(&units[..2], |answers| greatest_mean(answers, 3.0), 2000, 5).unwrap();
    assert_eq!(first.units, found.units[..2]);
}

#[test]
fn the_label_is_the_greatest_mean_above_theta() {
    let answers = [[5, 1, 1, 4], [3, 1, 1, 4]];
    let label = |theta| greatest_mean(&answers.iter().collect::<Vec<_>>(), theta);
    assert_eq!([label(3.5), label(3.99), label(4.0)], [Some(0), Some(0), None]);
}
