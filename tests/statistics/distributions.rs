//! Distributions against mpmath with 60 digits.

use crate::yardsticks::{real, rows};
use gaitway::statistics::distribution::*;
use std::collections::BTreeMap;

fn ours(name: &str, at: &[f64]) -> f64 {
    let count = |i: usize| at[i] as u64;
    match name {
        "chi2_sf" => chi_square_sf(at[0], at[1]),
        "chi2_cdf" => chi_square_cdf(at[0], at[1]),
        "ncx2_sf" => noncentral_chi_square_sf(at[0], at[1], at[2]),
        "ncx2_cdf" => noncentral_chi_square_cdf(at[0], at[1], at[2]),
        "norm_sf" => normal_sf(at[0]),
        "norm_ppf" => normal_quantile(at[0]),
        "binom_at_least" => binomial_at_least(count(0), count(1), at[2]),
        "binom_at_most" => binomial_at_most(count(0), count(1), at[2]),
        "beta_cdf" => beta_cdf(at[0], at[1], at[2]),
        "beta_sf" => beta_sf(at[0], at[1], at[2]),
        "f_sf" => f_sf(at[0], at[1], at[2]),
        "f_isf" => f_quantile(at[0], at[1], at[2]),
        "t_sf" => student_sf(at[0], at[1]),
        "t_ppf" => student_quantile(at[0], at[1]),
        _ => panic!("{name}"),
    }
}

#[test]
fn distributions_hold_twelve_digits_deep_in_their_tails() {
    let mut largest = BTreeMap::new();
    let mut deepest = f64::INFINITY;
    for row in rows("distributions") {
        let row = row.as_array().unwrap();
        let (name, numbers) = (row[0].as_str().unwrap(), row[1..].iter().map(real).collect::<Vec<_>>());
        let (truth, at) = numbers.split_last().unwrap();
        let found = ours(name, at);
        let difference = if truth.abs() > 0.0 { (found / truth - 1.0).abs() } else { found.abs() };
        assert!(difference < 1e-12, "{name}{at:?}: {found:e}, yardstick {truth:e}");
        let entry = largest.entry(name).or_insert((0, 0.0_f64));
        *entry = (entry.0 + 1, entry.1.max(difference));
        if name.ends_with("sf") {
            deepest = deepest.min(*truth);
        }
    }
    assert!(deepest < 1e-290 && largest.len() == 14, "{deepest:e}");
    for (name, (count, difference)) in largest {
        println!("| {name} | {count} | {difference:.0e} |");
    }
}

#[test]
fn two_degrees_of_freedom_are_an_exponential_and_one_a_normal() {
    for x in [0.001, 1.0, 9.75, 100.0, 1400.0] {
        assert!((chi_square_sf(x, 2.0) / libm::exp(-x / 2.0) - 1.0).abs() < 1e-14);
        assert!((chi_square_sf(x, 1.0) / (2.0 * normal_sf(x.sqrt())) - 1.0).abs() < 1e-12);
    }
    assert!((chi_square_quantile(0.05, 2.0) - 5.991_464_547_107_98).abs() < 1e-12);
}

#[test]
fn quantiles_undo_their_distributions() {
    for p in [1e-12, 0.01, 0.3, 0.5, 0.8, 0.999] {
        for df in [0.7, 3.0, 250.0] {
            assert!((chi_square_sf(chi_square_quantile(p, df), df) / p - 1.0).abs() < 1e-10);
            assert!((f_sf(f_quantile(p, df, 9.0), df, 9.0) / p - 1.0).abs() < 1e-10);
            assert!((student_cdf(student_quantile(p, df), df) / p - 1.0).abs() < 1e-10);
        }
        assert!((normal_cdf(normal_quantile(p)) / p - 1.0).abs() < 1e-13);
    }
    // next to the middle the quantile is the distance from it, over the density there
    let tiny = 2.0_f64.powi(-30);
    assert!((normal_quantile(0.5 - tiny) / -(tiny * std::f64::consts::TAU.sqrt()) - 1.0).abs() < 1e-13);
}

#[test]
fn ends_are_exact_and_outside_the_domain_is_nan() {
    assert_eq!([chi_square_sf(0.0, 3.0), chi_square_sf(f64::INFINITY, 3.0)], [1.0, 0.0]);
    assert_eq!([f_sf(0.0, 2.0, 3.0), f_sf(f64::INFINITY, 2.0, 3.0)], [1.0, 0.0]);
    assert_eq!(
        [normal_quantile(0.0), normal_quantile(0.5), normal_quantile(1.0)],
        [f64::NEG_INFINITY, 0.0, f64::INFINITY]
    );
    assert_eq!(
        [binomial_at_least(0, 5, 0.2), binomial_at_least(6, 5, 0.2), binomial_at_most(5, 5, 0.2)],
        [1.0, 0.0, 1.0]
    );
    assert_eq!([binomial_pmf(0, 4, 0.0), binomial_pmf(4, 4, 1.0), binomial_pmf(2, 4, 1.0)], [1.0, 1.0, 0.0]);
    assert_eq!(student_sf(0.0, 5.0), 0.5);
    for nan in [
        chi_square_sf(1.0, 0.0),
        chi_square_sf(f64::NAN, 2.0),
        noncentral_chi_square_sf(1.0, 2.0, -1.0),
        normal_quantile(1.5),
        binomial_at_least(1, 2, 1.1),
        f_quantile(0.0, 2.0, 2.0),
        student_sf(1.0, -1.0),
        student_quantile(f64::NAN, 3.0),
        chi_square_quantile(0.5, f64::NAN),
    ] {
        assert!(nan.is_nan());
    }
}
