//! What is refused, and in which words.

use gaitway::statistics::agreement::{Metric, agreement, correlation, krippendorff_alpha};
use gaitway::statistics::confusion::{accuracy_over_people, confusion};
use gaitway::statistics::friedman::{concordance_interval, exact_p, friedman};
use gaitway::statistics::icc::{cronbach, icc};
use gaitway::statistics::kappa::{Weights, kappa, self_agreement};
use gaitway::statistics::power::{friedman_people, friedman_power};
use gaitway::statistics::stability::label_stability;
use gaitway::statistics::wilcoxon::{Method, Options, shift, wilcoxon};
use gaitway::statistics::{
    Adjustment, Alternative, Error, adjust, binomial_test, describe, quantile, ranks, wilson_interval,
};

#[track_caller]
fn refused<T: std::fmt::Debug>(result: Result<T, Error>, words: &str) {
    let message = result.unwrap_err().to_string();
    assert_eq!(message, words);
}

#[test]
fn tests_refuse_what_they_cannot_rank() {
    refused(friedman::<[f64; 3]>(&[]), "people: 0 found, at least 1 needed");
    refused(friedman(&[[1.0]]), "conditions: 1 found, at least 2 needed");
    refused(friedman(&[vec![1.0, 2.0], vec![1.0]]), "row 1 of answers has 1 columns, 2 expected");
    refused(friedman(&[[1.0, f64::NAN]]), "value 1 is NaN, a finite number is needed");
    refused(exact_p(&[[1.0; 5]]), "conditions of the exact test: 5 found, at most 4 allowed");
    refused(concordance_interval(&[[1.0; 3]], 0, 0.95, 1), "draws: 0 found, at least 1 needed");
    refused(concordance_interval(&[[1.0; 3]], 9, 1.0, 1), "level 1 lies outside (0, 1)");
    let exact = Options { method: Method::Exact, ..Options::default() };
    refused(wilcoxon(&[1.0; 201], exact), "differences of the exact test: 201 found, at most 200 allowed");
    refused(wilcoxon(&[1.0, f64::INFINITY], exact), "difference 1 is inf, a finite number is needed");
    refused(shift(&[], 0.95), "differences: 0 found, at least 1 needed");
    refused(ranks(&vec![0.0; 1_000_001]), "values to rank: 1000001 found, at most 1000000 allowed");
    refused(ranks(&[f64::NAN]), "value 0 is NaN, a finite number is needed");
}

#[test]
fn shares_refuse_what_is_no_share() {
    refused(wilson_interval(3, 2, 0.95), "successes 3 lies outside [0, trials]");
    refused(binomial_test(1, 2, 1.5, Alternative::Less), "chance 1.5 lies outside [0, 1]");
    refused(adjust(&[0.1, -0.2], Adjustment::Holm), "p -0.2 lies outside [0, 1]");
    refused(adjust(&[f64::NAN], Adjustment::Bonferroni), "p NaN lies outside [0, 1]");
    refused(describe(&[]), "values: 0 found, at least 1 needed");
    refused(quantile(&[1.0], 1.1), "quantile 1.1 lies outside [0, 1]");
    refused(confusion(&[[1, 2, 3], [4, 5, 6]]), "row 0 of counts has 3 columns, 2 expected");
    refused(confusion(&[[0, 0], [0, 0]]), "answers: 0 found, at least 1 needed");
    refused(
        accuracy_over_people(&[vec![[0, 0]], vec![]], 10, 0.95, 1),
        "answers of a person: 0 found, at least 1 needed",
    );
}

#[test]
fn agreement_refuses_what_does_not_vary() {
    refused(icc(&[[2.0, 3.0], [2.0, 3.0]], 0.95), "answers over targets do not vary, so ICC is undefined");
    refused(icc(&[[2.0, 3.0]], 0.95), "targets: 1 found, at least 2 needed");
    refused(
        cronbach(&[[1.0, 2.0], [2.0, 1.0]], 0.95),
        "sums of items do not vary, so Cronbach's alpha is undefined",
    );
    refused(kappa(&[[4, 0], [0, 0]], Weights::Linear), "answers do not vary, so kappa is undefined");
    refused(self_agreement(&[[1, 6]], 5), "answer 6 lies outside [1, points]");
    refused(
        label_stability(&[vec![1], vec![]], |_| 0, 10, 1),
        "raters of a unit: 0 found, at least 1 needed",
    );
    // What `perception` has always returned stays NaN.
    assert!(krippendorff_alpha(&[vec![2, 2]], Metric::Ordinal).is_nan());
    assert!(agreement(&[]).icc_single.is_nan() && correlation(&[]).r[0][1].is_nan());
}

#[test]
fn power_refuses_impossible_plans() {
    refused(friedman_power(30, 3, 1.2, 0.05), "W 1.2 lies outside [0, 1]");
    refused(friedman_power(30, 3, 0.2, 0.0), "alpha 0 lies outside (0, 1)");
    refused(friedman_people(3, 0.0, 0.05, 0.8), "W 0 lies outside what 100,000 people suffice for");
}
