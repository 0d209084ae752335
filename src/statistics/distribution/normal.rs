//! The standard normal distribution.
//!
//! Based on: Abramowitz and Stegun 1964, 26.2.17 (by the complementary error function) and 26.2.23 (the first guess of
//! the quantile); Halley's method, which triples the digits in each step.

use std::f64::consts::{PI, SQRT_2};

/// P(Z <= z).
pub fn normal_cdf(z: f64) -> f64 {
    0.5 * libm::erfc(-z / SQRT_2)
}

/// P(Z > z).
pub fn normal_sf(z: f64) -> f64 {
    0.5 * libm::erfc(z / SQRT_2)
}

/// The z with P(Z <= z) = `p`: infinite for 0 and 1, NaN outside [0, 1].
pub fn normal_quantile(p: f64) -> f64 {
    if !(0.0..=1.0).contains(&p) {
        return f64::NAN;
    }
    if p >= 1.0 {
        f64::INFINITY
    } else if p > 0.5 {
        -lower_quantile(1.0 - p)
    } else if p >= 0.5 {
        0.0
    } else if p > 0.0 {
        lower_quantile(p)
    } else {
        f64::NEG_INFINITY
    }
}

/// The quantile for p in (0, 1/2).
fn lower_quantile(p: f64) -> f64 {
    let t = (-2.0 * libm::log(p)).sqrt();
    let above = 2.515_517 + t * (0.802_853 + t * 0.010_328);
    let below = 1.0 + t * (1.432_788 + t * (0.189_269 + t * 0.001_308));
    let mut z = above / below - t;
    for _ in 0..4 {
        // near the middle the error function keeps the digits that p - 1/2 has
        let error = if p > 0.25 { 0.5 * libm::erf(z / SQRT_2) + (0.5 - p) } else { normal_cdf(z) - p };
        let step = error * (2.0 * PI).sqrt() * libm::exp(z * z / 2.0);
        z -= step / (1.0 + z * step / 2.0);
    }
    z
}
