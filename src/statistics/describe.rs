//! Mean, spread and quantiles of plain numbers.
//!
//! Based on: Hyndman and Fan 1996, "Sample quantiles in statistical packages", The American Statistician 50, type 7.

use super::error::{Error, at_least, finite};
use serde::Serialize;

/// Summary of a sample.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Description {
    /// Number of values.
    pub count: usize,
    /// Arithmetic mean.
    pub mean: f64,
    /// Standard deviation with divisor `count - 1`; `None` for one value.
    pub deviation: Option<f64>,
    /// Least value.
    pub least: f64,
    /// Quartiles of type 7: lower quartile, median, upper quartile.
    pub quartiles: [f64; 3],
    /// Greatest value.
    pub greatest: f64,
}

/// Describes a sample of one value or more.
///
/// # Errors
/// An empty sample, or a value that is not finite.
pub fn describe(values: &[f64]) -> Result<Description, Error> {
    at_least("values", values.len(), 1)?;
    finite("value", values)?;
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    let deviation = (values.len() > 1).then(|| (squares / (number(values.len()) - 1.0)).sqrt());
    let sorted = sorted(values);
    Ok(Description {
        count: values.len(),
        mean,
        deviation,
        least: sorted[0],
        quartiles: [0.25, 0.5, 0.75].map(|at| of_sorted(&sorted, at)),
        greatest: sorted[sorted.len() - 1],
    })
}

/// The quantile of type 7 at `at` in [0, 1]: linear between the order statistics, `h = (n - 1) at`.
///
/// # Errors
/// An empty sample, a value that is not finite, or `at` outside [0, 1].
pub fn quantile(values: &[f64], at: f64) -> Result<f64, Error> {
    at_least("values", values.len(), 1)?;
    finite("value", values)?;
    if !(0.0..=1.0).contains(&at) {
        return Err(Error::Range { what: "quantile", value: at, range: "[0, 1]" });
    }
    Ok(of_sorted(&sorted(values), at))
}

/// The quantile of type 7 of sorted finite values, one or more.
pub(super) fn of_sorted(sorted: &[f64], at: f64) -> f64 {
    let place = number(sorted.len() - 1) * at;
    let below = floor(place);
    let fraction = place - number(below);
    let low = sorted[below];
    let high = sorted[(below + 1).min(sorted.len() - 1)];
    low + fraction * (high - low)
}

/// The two ends of a percentile interval of `level`, of draws in any order.
pub(super) fn percentile_interval(mut draws: Vec<f64>, level: f64) -> [f64; 2] {
    draws.sort_by(f64::total_cmp);
    let outside = (1.0 - level) / 2.0;
    [of_sorted(&draws, outside), of_sorted(&draws, 1.0 - outside)]
}

/// Arithmetic mean of one value or more.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / number(values.len())
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted
}

/// The whole part of a number that is at least 0 and indexes a slice.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "at least 0, at most a length")]
pub(super) const fn floor(place: f64) -> usize {
    place as usize
}

/// A count as a number; exact below 2^53.
#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
pub(super) const fn number(count: usize) -> f64 {
    count as f64
}
