//! Draws and roundings of simulated answers.

use crate::random::Random;

/// A draw of the standard normal distribution, from the sum of twelve uniform ones: within 6 of 0, the same on every machine.
pub(super) fn normal(random: &mut Random) -> f64 {
    (0..12).map(|_| random.unit()).sum::<f64>() - 6.0
}

/// The point nearest to a number, within a scale.
#[allow(clippy::cast_possible_truncation, reason = "clamped to a scale")]
pub(super) fn cut(number: f64, least: i64, greatest: i64) -> i64 {
    #[allow(clippy::cast_precision_loss, reason = "scales are short")]
    let (low, high) = (least as f64, greatest as f64);
    number.round().clamp(low, high) as i64
}
