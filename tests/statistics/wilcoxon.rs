//! Wilcoxon's signed-rank test and the Hodges-Lehmann estimate.

use crate::generator::Random;
use crate::yardsticks::{Comparison, real, reals, rows};
use gaitway::statistics::Alternative;
use gaitway::statistics::wilcoxon::{Method, Options, Zeros, shift, wilcoxon};

const ZEROS: [Zeros; 3] = [Zeros::Wilcoxon, Zeros::Pratt, Zeros::ZSplit];

fn alternative(name: &str) -> Alternative {
    match name {
        "two-sided" => Alternative::TwoSided,
        "less" => Alternative::Less,
        _ => Alternative::Greater,
    }
}

#[test]
fn five_hundred_tables_agree_with_scipy_in_every_mode() {
    let (mut p, mut z) = (Comparison::default(), Comparison::default());
    for row in rows("wilcoxon") {
        let (d, normal) = (reals(&row[0]), reals(&row[2]));
        let mut normal = normal.into_iter();
        for zeros in ZEROS {
            for continuity in [false, true] {
                let alternative = alternative(row[1].as_str().unwrap());
                let options = Options { zeros, alternative, method: Method::Normal, continuity };
                let found = wilcoxon(&d, options).unwrap();
                p.see(found.p, normal.next().unwrap(), &(row, zeros, continuity));
                if !continuity {
                    // scipy's z of a two-sided test is never positive
                    let ours = if alternative == Alternative::TwoSided { -found.z.abs() } else { found.z };
                    z.see(ours, normal.next().unwrap(), &(row, zeros));
                }
            }
        }
    }
    p.tell("Wilcoxon, normal p", 3000);
    z.tell("Wilcoxon, z", 1500);
}

#[test]
fn exact_p_is_that_of_all_signs() {
    let mut found = [("enumeration", 400), ("counting", 600), ("scipy", 250)]
        .map(|(how, least)| (how, least, Comparison::default()));
    for row in rows("wilcoxon") {
        let d = reals(&row[0]);
        for ((zeros, p), how) in ZEROS.into_iter().zip(reals(&row[3])).zip(row[4].as_array().unwrap()) {
            let alternative = alternative(row[1].as_str().unwrap());
            let test = wilcoxon(&d, Options { zeros, alternative, method: Method::Exact, continuity: false })
                .unwrap();
            assert!(test.exact);
            let (.., comparison) = found.iter_mut().find(|(name, ..)| Some(*name) == how.as_str()).unwrap();
            comparison.see(test.p, p, &(row, zeros));
        }
    }
    for (how, least, comparison) in found {
        comparison.tell(&format!("Wilcoxon, exact p by {how}"), least);
    }
}

#[test]
fn estimates_agree_with_the_listed_averages() {
    let mut found = Comparison::default();
    for row in rows("shifts") {
        let ours = shift(&reals(&row[0]), real(&row[1])).unwrap();
        found.see(ours.estimate, real(&row[2]), row);
        found.see(ours.interval[0], real(&row[3]), row);
        found.see(ours.interval[1], real(&row[4]), row);
        found.see(ours.confidence, real(&row[5]), row);
    }
    found.tell("Hodges-Lehmann", 400);
}

#[test]
fn hollander_and_wolfes_depression_scores_give_their_numbers() {
    // Hollander and Wolfe 1999, table 3.1: nine patients before and after treatment. T+ = 5, one-sided P = .020 (R: 0.01953),
    // estimate -0.46, 96.1 % interval from -0.786 to -0.010.
    let before = [1830, 500, 1620, 2480, 1680, 1880, 1550, 3060, 1300];
    let after = [878, 647, 598, 2050, 1060, 1290, 1060, 3140, 1290];
    let d: Vec<f64> =
        after.iter().zip(before).map(|(after, before)| f64::from(after - before) / 1e3).collect();
    let test = wilcoxon(&d, Options { alternative: Alternative::Less, ..Options::default() }).unwrap();
    assert!((test.w_plus - 5.0).abs() < 1e-12 && (test.p - 10.0 / 512.0).abs() < 1e-15, "{test:?}");
    assert!((test.rank_biserial - (5.0 - 40.0) / 45.0).abs() < 1e-15);
    let found = shift(&d, 0.95).unwrap();
    assert!((found.estimate + 0.46).abs() < 1e-12 && (found.confidence - 0.9609).abs() < 1e-4, "{found:?}");
    assert!(
        (found.interval[0] + 0.786).abs() < 1e-12 && (found.interval[1] + 0.010).abs() < 1e-12,
        "{found:?}"
    );
}

#[test]
fn no_difference_has_a_result() {
    for zeros in ZEROS {
        for method in [Method::Auto, Method::Exact, Method::Normal] {
            for d in [&[][..], &[0.0, -0.0, 0.0]] {
                for alternative in [Alternative::TwoSided, Alternative::Less, Alternative::Greater] {
                    let options = Options { zeros, alternative, method, continuity: true };
                    let test = wilcoxon(d, options).unwrap();
                    assert_eq!([test.p, test.z, test.r, test.rank_biserial], [1.0, 0.0, 0.0, 0.0]);
                    assert_eq!((test.pairs, test.zeros), (d.len(), d.len()));
                }
            }
        }
    }
}

#[test]
fn the_normal_method_nears_the_exact_one_at_its_limit() {
    let mut random = Random::new(4);
    let d: Vec<f64> =
        (0..200).map(|_| (random.unit() * 9.0 - 4.2).round()).filter(|d| d.abs() > 0.0).collect();
    let p = |method| wilcoxon(&d, Options { method, ..Options::default() }).unwrap();
    let (exact, normal) = (p(Method::Auto), p(Method::Normal));
    assert!(exact.exact && !normal.exact && (exact.p - normal.p).abs() < 2e-3, "{exact:?} {normal:?}");
    // r of paired data: z over the root of their number, with the sign of the difference
    assert!((exact.r - exact.z / (d.len() as f64).sqrt()).abs() < 1e-15);
    let long: Vec<f64> = d.iter().chain(&d).copied().collect();
    let test = wilcoxon(&long, Options::default()).unwrap();
    assert!(!test.exact && test.p < normal.p);
}

#[test]
fn the_interval_by_the_normal_distribution_joins_the_exact_one() {
    let at = |n: u32| {
        let d: Vec<f64> = (0..n).map(|i| f64::from(i) / f64::from(n)).collect();
        shift(&d, 0.95).unwrap().interval
    };
    let (exact, normal) = (at(200), at(201));
    assert!(
        (exact[0] - normal[0]).abs() < 2e-3 && (exact[1] - normal[1]).abs() < 2e-3,
        "{exact:?} {normal:?}"
    );
}
