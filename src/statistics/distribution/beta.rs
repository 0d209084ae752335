//! The regularised incomplete beta function, and binomial, F and Student's distribution from it.
//!
//! Based on: Abramowitz and Stegun 1964, 26.5.8 (continued fraction), 26.5.24 (binomial), 26.6.2 (F), 26.7.1 (t);
//! Loader 2000, "Fast and accurate computation of binomial probabilities".

use super::gamma::{TERMS, deviance, stirling_error};
use super::solve;
use std::f64::consts::PI;

/// Stands for 0 in a denominator of Lentz's method.
const TINY: f64 = 1e-300;

/// `Gamma(a + b + 1) / (Gamma(a + 1) Gamma(b + 1)) x^a y^b` with y = 1 - x; a, b, x, y > 0.
fn binomial_term(a: f64, b: f64, x: f64, y: f64) -> f64 {
    let n = a + b;
    let exponent = stirling_error(n) - stirling_error(a) - stirling_error(b);
    libm::exp(exponent - deviance(a, n * x) - deviance(b, n * y)) * (n / (2.0 * PI * a * b)).sqrt()
}

/// The continued fraction of `I_x(a, b)` by Lentz's method.
fn fraction(a: f64, b: f64, x: f64) -> f64 {
    let bounded = |value: f64| if value.abs() < TINY { TINY } else { value };
    let (mut c, mut d) = (1.0, 1.0 / bounded(1.0 - (a + b) * x / (a + 1.0)));
    let (mut h, mut m) = (d, 0.0);
    for _ in 0..TERMS {
        m += 1.0;
        let even = m * (b - m) * x / ((a + 2.0 * m - 1.0) * (a + 2.0 * m));
        d = 1.0 / bounded(1.0 + even * d);
        c = bounded(1.0 + even / c);
        h *= c * d;
        let odd = -(a + m) * (a + b + m) * x / ((a + 2.0 * m) * (a + 2.0 * m + 1.0));
        d = 1.0 / bounded(1.0 + odd * d);
        c = bounded(1.0 + odd / c);
        let step = c * d;
        h *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    h
}

/// `I_x(a, b)` with y = 1 - x given apart, so that neither end loses digits; a, b > 0.
fn regularised(a: f64, b: f64, x: f64, y: f64) -> f64 {
    if x <= 0.0 {
        return 0.0;
    }
    if y <= 0.0 {
        return 1.0;
    }
    let scale = a * b / (a + b) * binomial_term(a, b, x, y);
    if x * (a + b + 2.0) < a + 1.0 {
        scale * fraction(a, b, x) / a
    } else {
        1.0 - scale * fraction(b, a, y) / b
    }
}

/// Distribution function of the beta distribution: `I_x(a, b)`; NaN unless a, b > 0.
pub fn beta_cdf(x: f64, a: f64, b: f64) -> f64 {
    if a > 0.0 && b > 0.0 { regularised(a, b, x.clamp(0.0, 1.0), 1.0 - x.clamp(0.0, 1.0)) } else { f64::NAN }
}

/// Survival function of the beta distribution: `1 - I_x(a, b)`; NaN unless a, b > 0.
pub fn beta_sf(x: f64, a: f64, b: f64) -> f64 {
    if a > 0.0 && b > 0.0 { regularised(b, a, 1.0 - x.clamp(0.0, 1.0), x.clamp(0.0, 1.0)) } else { f64::NAN }
}

/// P(X = `successes`) in `trials` with chance `p`; NaN for p outside [0, 1].
pub fn binomial_pmf(successes: u64, trials: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    let Some(failures) = trials.checked_sub(successes) else { return 0.0 };
    let (a, b) = (real(successes), real(failures));
    match (successes, failures) {
        (0, 0) => 1.0,
        (0, _) => libm::exp(b * libm::log1p(-p)),
        (_, 0) => libm::pow(p, a),
        _ if p <= 0.0 || p >= 1.0 => 0.0,
        _ => binomial_term(a, b, p, 1.0 - p),
    }
}

/// P(X >= `successes`) in `trials` with chance `p`; NaN for p outside [0, 1].
pub fn binomial_at_least(successes: u64, trials: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    match (successes, trials.checked_sub(successes)) {
        (0, _) => 1.0,
        (_, None) => 0.0,
        (_, Some(failures)) => regularised(real(successes), real(failures) + 1.0, p, 1.0 - p),
    }
}

/// P(X <= `successes`) in `trials` with chance `p`; NaN for p outside [0, 1].
pub fn binomial_at_most(successes: u64, trials: u64, p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    match trials.checked_sub(successes) {
        None | Some(0) => 1.0,
        Some(failures) => regularised(real(failures), real(successes) + 1.0, 1.0 - p, p),
    }
}

/// P(F > x) with degrees of freedom `above` and `below`; NaN unless both exceed 0.
pub fn f_sf(x: f64, above: f64, below: f64) -> f64 {
    if !(above > 0.0 && below > 0.0) || x.is_nan() {
        return f64::NAN;
    }
    let x = x.max(0.0);
    let sum = below + above * x;
    if sum.is_infinite() { 0.0 } else { regularised(below / 2.0, above / 2.0, below / sum, above * x / sum) }
}

/// The x with P(F > x) = `upper`, `upper` in (0, 1); NaN otherwise.
pub fn f_quantile(upper: f64, above: f64, below: f64) -> f64 {
    solve(upper, |x| f_sf(x, above, below))
}

/// P(T > t) of Student's distribution; NaN unless `df` exceeds 0.
pub fn student_sf(t: f64, df: f64) -> f64 {
    if df.is_nan() || df <= 0.0 || t.is_nan() {
        return f64::NAN;
    }
    // beyond 1e150 the square would overflow, and the ratio is 0 to every digit of the complement
    let sum = df + t * t;
    let (x, y) = if sum.is_finite() { (df / sum, t * t / sum) } else { (df / t / t, 1.0) };
    let half = 0.5 * regularised(df / 2.0, 0.5, x, y);
    if t < 0.0 { 1.0 - half } else { half }
}

/// P(T <= t) of Student's distribution; NaN unless `df` exceeds 0.
pub fn student_cdf(t: f64, df: f64) -> f64 {
    student_sf(-t, df)
}

/// The t with P(T <= t) = `p`, `p` in (0, 1); NaN otherwise.
pub fn student_quantile(p: f64, df: f64) -> f64 {
    if p < 0.5 {
        -solve(p, |t| student_sf(t, df))
    } else if p > 0.5 {
        solve(1.0 - p, |t| student_sf(t, df))
    } else if p.is_nan() || df.is_nan() || df <= 0.0 {
        f64::NAN
    } else {
        0.0
    }
}

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
const fn real(count: u64) -> f64 {
    count as f64
}
