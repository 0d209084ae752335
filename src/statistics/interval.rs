//! Intervals and tests of a share.
//!
//! Based on: Wilson 1927, "Probable inference, the law of succession, and statistical inference", JASA 22.

use super::Alternative;
use super::distribution::{binomial_at_least, binomial_at_most, binomial_pmf, normal_quantile};
use super::error::{Error, inside_unit};

/// z of a two-sided interval of 95 %.
const Z: f64 = 1.959_963_984_540_054;

/// The 95 % interval of a share of `count` by Wilson (1927); of nothing, anything is possible.
///
/// The share may be a mean over repetitions, and need not be a whole number out of `count`.
pub fn share_interval(share: f64, count: u64) -> [f64; 2] {
    wilson(share, count, Z)
}

/// The interval of `successes` in `trials` at `level`, by Wilson; [0, 1] for no trials.
///
/// # Errors
/// More successes than trials, or a level outside (0, 1).
pub fn wilson_interval(successes: u64, trials: u64, level: f64) -> Result<[f64; 2], Error> {
    inside_unit("level", level)?;
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    let (hits, count) = (successes as f64, trials as f64);
    if successes > trials {
        return Err(Error::Range { what: "successes", value: hits, range: "[0, trials]" });
    }
    let share = if trials == 0 { 0.0 } else { hits / count };
    Ok(wilson(share, trials, -normal_quantile((1.0 - level) / 2.0)))
}

fn wilson(share: f64, count: u64, z: f64) -> [f64; 2] {
    if count == 0 {
        return [0.0, 1.0];
    }
    #[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
    let n = count as f64;
    let whole = 1.0 + z * z / n;
    let middle = (share + z * z / (2.0 * n)) / whole;
    let half = z * (share * (1.0 - share) / n + z * z / (4.0 * n * n)).sqrt() / whole;
    // rounding must not leave the share itself outside
    [(middle - half).clamp(0.0, share), (middle + half).clamp(share, 1.0)]
}

/// Exact binomial test of `successes` in `trials` against the share `chance`.
///
/// Two-sided p sums all outcomes that are no likelier than the one found (the rule of R and scipy, with their relative
/// tolerance of 1e-7).
///
/// # Errors
/// More successes than trials, or a chance outside [0, 1].
pub fn binomial_test(
    successes: u64,
    trials: u64,
    chance: f64,
    alternative: Alternative,
) -> Result<f64, Error> {
    if successes > trials {
        #[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
        return Err(Error::Range { what: "successes", value: successes as f64, range: "[0, trials]" });
    }
    if !(0.0..=1.0).contains(&chance) {
        return Err(Error::Range { what: "chance", value: chance, range: "[0, 1]" });
    }
    Ok(match alternative {
        Alternative::Greater => binomial_at_least(successes, trials, chance),
        Alternative::Less => binomial_at_most(successes, trials, chance),
        Alternative::TwoSided => {
            let bound = binomial_pmf(successes, trials, chance) * (1.0 + 1e-7);
            let chances = (0..=trials).map(|count| binomial_pmf(count, trials, chance));
            chances.filter(|&one| one <= bound).sum::<f64>().min(1.0)
        }
    })
}
