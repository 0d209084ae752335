//! The regularised incomplete gamma function.
//!
//! Based on: Abramowitz and Stegun 1964, 6.5.29 (series) and 6.5.31 (continued fraction); Lentz 1976 (its evaluation);
//! Loader 2000, "Fast and accurate computation of binomial probabilities" (the factor in front, without cancellation).

use std::f64::consts::PI;

/// ln(2 pi) / 2.
const HALF_LN_TWO_PI: f64 = 0.918_938_533_204_672_8;
/// From here on Stirling's series is exact to rounding.
const STIRLING: f64 = 15.0;
/// Stands for 0 in a denominator of Lentz's method.
const TINY: f64 = 1e-300;
/// Most terms of a series or fraction. Both need some ten times the square root of the parameter.
pub(super) const TERMS: usize = 10_000_000;

/// `ln Gamma(a + 1) - (a + 1/2) ln a + a - ln(2 pi) / 2`: the error of Stirling's formula, a > 0.
pub(super) fn stirling_error(a: f64) -> f64 {
    if a < STIRLING {
        return libm::lgamma(a + 1.0) - (a + 0.5) * libm::log(a) + a - HALF_LN_TWO_PI;
    }
    let square = a * a;
    let inner = 1.0 / 1260.0 - (1.0 / 1680.0 - (1.0 / 1188.0 - 691.0 / 360_360.0 / square) / square) / square;
    (1.0 / 12.0 - (1.0 / 360.0 - inner / square) / square) / a
}

/// Loader's deviance `x ln(x / m) + m - x`, without cancellation where x is close to m.
pub(super) fn deviance(x: f64, m: f64) -> f64 {
    let difference = x - m;
    if difference.abs() >= 0.1 * (x + m) {
        return x * libm::log(x / m) + m - x;
    }
    let v = difference / (x + m);
    let (mut sum, mut term) = (difference * v, 2.0 * x * v);
    for j in 1..1000_u32 {
        term *= v * v;
        let next = sum + term / f64::from(2 * j + 1);
        if next.total_cmp(&sum).is_eq() {
            break;
        }
        sum = next;
    }
    sum
}

/// `x^a exp(-x) / Gamma(a + 1)`, a > 0, x > 0.
pub(super) fn front(a: f64, x: f64) -> f64 {
    if a >= STIRLING {
        return libm::exp(-deviance(a, x) - stirling_error(a)) / (2.0 * PI * a).sqrt();
    }
    let scale = libm::tgamma(a + 1.0);
    if x > 1e-5 && x < 1400.0 {
        // in two halves, neither of which underflows
        let half = libm::exp(-x / 2.0);
        return libm::pow(x, a) * half / scale * half;
    }
    libm::exp(a * libm::log(x) - x) / scale
}

/// P(a, x) by its series, quick for x below a + 1.
fn lower_series(a: f64, x: f64) -> f64 {
    let (mut sum, mut term, mut over) = (1.0, 1.0, a);
    for _ in 0..TERMS {
        over += 1.0;
        term *= x / over;
        sum += term;
        if term < 1e-17 * sum {
            break;
        }
    }
    front(a, x) * sum
}

/// Q(a, x) by its continued fraction, for x of a + 1 and above.
fn upper_fraction(a: f64, x: f64) -> f64 {
    let scale = front(a, x);
    if scale <= 0.0 {
        return 0.0;
    }
    let mut b = x + 1.0 - a;
    let (mut c, mut d) = (1.0 / TINY, 1.0 / b);
    let (mut h, mut i) = (d, 0.0);
    for _ in 0..TERMS {
        i += 1.0;
        let an = -i * (i - a);
        b += 2.0;
        d = an * d + b;
        d = 1.0 / if d.abs() < TINY { TINY } else { d };
        c = b + an / c;
        if c.abs() < TINY {
            c = TINY;
        }
        let step = c * d;
        h *= step;
        if (step - 1.0).abs() < 1e-16 {
            break;
        }
    }
    scale * a * h
}

/// Q(a, x), the upper regularised incomplete gamma function; a > 0.
pub(super) fn upper(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        1.0
    } else if x.is_infinite() {
        0.0
    } else if x < a + 1.0 {
        1.0 - lower_series(a, x)
    } else {
        upper_fraction(a, x)
    }
}

/// P(a, x), the lower regularised incomplete gamma function; a > 0.
pub(super) fn lower(a: f64, x: f64) -> f64 {
    if x <= 0.0 {
        0.0
    } else if x.is_infinite() {
        1.0
    } else if x < a + 1.0 {
        lower_series(a, x)
    } else {
        1.0 - upper_fraction(a, x)
    }
}
