//! How likely a planned study is to find an effect.
//!
//! Based on: Patnaik 1949 and Noether 1987 (the noncentral chi-square distribution as the limit of a rank test's statistic);
//! Iman and Davenport 1980, Communications in Statistics A9 (the statistic behind the finite formula); Wilson 1927 (interval of a
//! simulated power).

use super::describe::number;
use super::distribution::{chi_square_quantile, noncentral_chi_square_sf};
use super::error::{Error, at_least, inside_unit};
use super::interval::wilson_interval;
use crate::random::Random;
use rayon::prelude::*;
use serde::Serialize;

/// Most people that [`friedman_people`] tries.
const MOST_PEOPLE: usize = 100_000;

/// Power of Friedman's test: `P(X > c)` of the noncentral chi-square distribution with `k - 1` degrees of freedom and
/// `lambda = n (k - 1) W`, c the critical value at `alpha`.
///
/// `w` is Kendall's W of the population. That of a sample is greater by about `(1 - W) / n`: power computed from it, as if it
/// were the population's, is too high. The formula is the limit for small effects. For W above 0.1 simulated power is greater,
/// by up to six points: see [`friedman_power_finite`].
///
/// # Errors
/// No people, fewer than two conditions, W outside [0, 1], or alpha outside (0, 1).
pub fn friedman_power(people: usize, conditions: usize, w: f64, alpha: f64) -> Result<f64, Error> {
    power(people, conditions, w, alpha, number(people) * w)
}

/// Power of Friedman's test for effects that are not small: as [`friedman_power`], with `lambda = (n - 1) (k - 1) W / (1 - W)`.
///
/// Ranks vary less where conditions differ, by the share `1 - W`, which the limit neglects. The formula is that of Iman and
/// Davenport's statistic `(n - 1) W / (1 - W)` and is ours as a power. Simulated power of normal answers is within two points.
///
/// # Errors
/// As [`friedman_power`].
pub fn friedman_power_finite(people: usize, conditions: usize, w: f64, alpha: f64) -> Result<f64, Error> {
    if w >= 1.0 {
        return power(people, conditions, w, alpha, 0.0).map(|_| 1.0);
    }
    power(people, conditions, w, alpha, (number(people) - 1.0) * w / (1.0 - w))
}

/// The power for a noncentrality of so much a degree of freedom.
fn power(people: usize, conditions: usize, w: f64, alpha: f64, lambda: f64) -> Result<f64, Error> {
    at_least("people", people, 1)?;
    at_least("conditions", conditions, 2)?;
    inside_unit("alpha", alpha)?;
    if !(0.0..=1.0).contains(&w) {
        return Err(Error::Range { what: "W", value: w, range: "[0, 1]" });
    }
    let degrees = number(conditions - 1);
    let critical = chi_square_quantile(alpha, degrees);
    // beyond this the power is 1 to every digit, and the sum would take long
    let lambda = (lambda * degrees).min(20.0 * (critical + 100.0));
    Ok(noncentral_chi_square_sf(critical, degrees, lambda))
}

/// The least number of people with which Friedman's test reaches `power`.
///
/// # Errors
/// As [`friedman_power`]; a power outside (0, 1); more than 100,000 people needed.
pub fn friedman_people(conditions: usize, w: f64, alpha: f64, power: f64) -> Result<usize, Error> {
    inside_unit("power", power)?;
    let reaches = |people: usize| Ok(friedman_power(people, conditions, w, alpha)? >= power);
    if !reaches(MOST_PEOPLE)? {
        return Err(Error::Range { what: "W", value: w, range: "what 100,000 people suffice for" });
    }
    let (mut few, mut enough) = (0, MOST_PEOPLE);
    while enough - few > 1 {
        let middle = few.midpoint(enough);
        if reaches(middle)? { enough = middle } else { few = middle }
    }
    Ok(enough)
}

/// Outcome of simulated studies.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Simulated {
    /// Number of studies.
    pub studies: u64,
    /// Number with p at most alpha.
    pub significant: u64,
    /// Their share: the power, or the share of false positives where no effect was simulated.
    pub power: f64,
    /// Its 95 % Monte Carlo interval by Wilson.
    pub interval: [f64; 2],
}

/// Simulates `studies` studies: `study` makes one from a seed, tests it and returns its p.
///
/// Studies run in parallel. Their seeds depend on `seed` and their number alone, so the outcome is the same on any number of
/// threads.
///
/// # Errors
/// No studies; alpha outside (0, 1); a p that is NaN; the first error of a study.
pub fn simulate<E: Send + From<Error>>(
    studies: usize,
    seed: u64,
    alpha: f64,
    study: impl Fn(u64) -> Result<f64, E> + Sync,
) -> Result<Simulated, E> {
    at_least("studies", studies, 1)?;
    inside_unit("alpha", alpha)?;
    let mut random = Random::new(seed);
    let seeds: Vec<u64> = (0..studies).map(|_| random.bits()).collect();
    // all run before the first error is looked for: which one is first must not depend on threads
    let found: Vec<Result<f64, E>> = seeds.into_par_iter().map(&study).collect();
    let mut significant = 0;
    for p in found {
        let p = p?;
        if p.is_nan() {
            return Err(Error::Range { what: "p", value: p, range: "[0, 1]" }.into());
        }
        significant += u64::from(p <= alpha);
    }
    let studies = studies as u64;
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    let power = significant as f64 / studies as f64;
    Ok(Simulated { studies, significant, power, interval: wilson_interval(significant, studies, 0.95)? })
}
