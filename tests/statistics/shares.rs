//! Shares, confusion matrices, p values of several tests, and descriptions.

use crate::yardsticks::{Comparison, real, reals, rows, whole};
use gaitway::statistics::confusion::{accuracy_over_people, confusion};
use gaitway::statistics::{
    Adjustment, Alternative, adjust, binomial_test, describe, quantile, share_interval, wilson_interval,
};

#[test]
fn wilson_and_binomial_agree_with_statsmodels_and_scipy() {
    let (mut wilson, mut binomial) = (Comparison::default(), Comparison::default());
    for row in rows("wilson") {
        let [low, high] = wilson_interval(whole(&row[0]), whole(&row[1]), real(&row[2])).unwrap();
        wilson.see(low, real(&row[3]), row);
        wilson.see(high, real(&row[4]), row);
    }
    for row in rows("binomial") {
        for (i, side) in
            [Alternative::TwoSided, Alternative::Less, Alternative::Greater].into_iter().enumerate()
        {
            let p = binomial_test(whole(&row[0]), whole(&row[1]), real(&row[2]), side).unwrap();
            binomial.see(p, real(&row[3 + i]), &(row, side));
        }
    }
    wilson.tell("Wilson interval", 160);
    binomial.tell("binomial test", 240);
    assert_eq!(share_interval(0.3, 0), [0.0, 1.0]);
    let [a, b] = [wilson_interval(136, 192, 0.95).unwrap(), share_interval(136.0 / 192.0, 192)];
    assert!((a[0] - b[0]).abs() < 1e-15 && (a[1] - b[1]).abs() < 1e-15);
}

#[test]
fn adjusted_p_agree_with_statsmodels_in_the_order_given() {
    let mut found = Comparison::default();
    for row in rows("adjustments") {
        let p = reals(&row[0]);
        for (i, how) in
            [Adjustment::Bonferroni, Adjustment::Holm, Adjustment::BenjaminiHochberg].into_iter().enumerate()
        {
            for (ours, theirs) in adjust(&p, how).unwrap().into_iter().zip(reals(&row[1 + i])) {
                found.see(ours, theirs, &(row, how));
            }
        }
    }
    found.tell("Bonferroni, Holm, Benjamini-Hochberg", 1000);
    assert_eq!(adjust(&[], Adjustment::Holm).unwrap(), Vec::<f64>::new());
    assert_eq!(adjust(&[0.5, 0.01, 0.02], Adjustment::Holm).unwrap(), [0.5, 0.03, 0.04]);
}

#[test]
fn descriptions_agree_with_numpy() {
    let mut found = Comparison::default();
    for row in rows("descriptions") {
        let (values, theirs) = (reals(&row[0]), row.as_array().unwrap()[1..].iter().map(real));
        let ours = describe(&values).unwrap();
        let [low, median, high] = ours.quartiles;
        let all = [ours.mean, ours.deviation.unwrap(), low, median, high];
        let tails = [0.05, 0.975].map(|at| quantile(&values, at).unwrap());
        for (ours, theirs) in all.into_iter().chain(tails).zip(theirs) {
            found.see(ours, theirs, row);
        }
    }
    found.tell("mean, deviation, quantiles", 140);
    let one = describe(&[4.0]).unwrap();
    assert_eq!((one.deviation, one.quartiles), (None, [4.0; 3]));
}

#[test]
fn a_confusion_matrix_is_that_counted_by_hand() {
    // ten answers: shown a: 3 right of 4; b: 2 right of 3; c: 3 right of 3, but answered never otherwise
    let found = confusion(&[[3, 1, 0], [1, 2, 0], [0, 0, 3]]).unwrap();
    assert_eq!((found.answers, found.right), (10, 8));
    let [a, b, c] = [found.classes[0], found.classes[1], found.classes[2]];
    assert_eq!([a.recall, a.precision, c.unbiased_hit_rate], [Some(0.75), Some(0.75), Some(1.0)]);
    assert!((b.recall.unwrap() - 2.0 / 3.0).abs() < 1e-15);
    assert!((a.unbiased_hit_rate.unwrap() - 9.0 / 16.0).abs() < 1e-15);
    // pe = .16 + .09 + .09 = .34, po = .8
    assert!((found.kappa.unwrap().kappa - 0.46 / 0.66).abs() < 1e-15);
    // P(X >= 8 of 10) at 1/3 = (45 * 4 + 10 * 2 + 1) / 3^10
    assert!((found.p_above_chance - 201.0 / 59049.0).abs() < 1e-15);
}

#[test]
fn a_class_never_shown_or_answered_has_no_share() {
    let found = confusion(&[[5, 0], [0, 0]]).unwrap();
    assert_eq!((found.classes[1].recall, found.classes[1].precision, found.kappa), (None, None, None));
    assert_eq!(found.classes[1].recall_interval, [0.0, 1.0]);
    assert_eq!(found.accuracy, 1.0);
}

#[test]
fn the_bootstrap_over_people_is_wider_where_people_differ() {
    // twenty people of eight answers each: the same 60 % of right answers, by all alike or by twelve alone
    let answers = |right: usize| (0..8).map(|i| [0, usize::from(i >= right)]).collect::<Vec<_>>();
    let alike: Vec<_> = (0..20).map(|i| answers(if i % 5 == 0 { 4 } else { 5 })).collect();
    let apart: Vec<_> = (0..20).map(|i| answers(if i < 12 { 8 } else { 0 })).collect();
    let [alike, apart] = [alike, apart].map(|people| accuracy_over_people(&people, 4000, 0.95, 11).unwrap());
    assert!((alike.accuracy - 0.6).abs() < 1e-15 && (apart.accuracy - 0.6).abs() < 1e-15);
    // for shares that are all or nothing the interval is that of twelve of twenty
    assert!((apart.interval[0] - 0.4).abs() < 0.051 && (apart.interval[1] - 0.8).abs() < 0.051, "{apart:?}");
    assert!(alike.interval[1] - alike.interval[0] < 0.06, "{alike:?}");
}
