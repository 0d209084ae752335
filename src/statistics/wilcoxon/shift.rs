//! The Hodges-Lehmann estimate of the size of a difference.
//!
//! Based on: Hodges and Lehmann 1963, Annals of Mathematical Statistics 34; Hollander and Wolfe 1999, 3.2 and 3.3 (the
//! interval by Tukey's counting of Walsh averages).

use super::super::describe::{floor, number};
use super::super::distribution::normal_quantile;
use super::super::error::{Error, at_least, finite, inside_unit};
use super::{MOST_EXACT, sign_sums};
use serde::Serialize;

/// Most differences whose averages of two are listed.
const MOST_DIFFERENCES: usize = 5000;

/// Location of paired differences.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Shift {
    /// Median of the averages of all pairs of differences, each with itself included.
    pub estimate: f64,
    /// Interval for the centre of symmetry.
    pub interval: [f64; 2],
    /// Confidence that the interval reaches: at least the level asked where one exists. Below six differences the whole range
    /// reaches less than 95 %. For answers with ties the true confidence is greater.
    pub confidence: f64,
}

/// The Hodges-Lehmann estimate with its interval; differences of 0 count like any other.
///
/// The interval inverts the exact signed-rank test without ties for up to [`MOST_EXACT`] differences, its normal approximation
/// beyond.
///
/// # Errors
/// No differences or more than 5,000; a difference that is not finite; a level outside (0, 1).
pub fn shift(differences: &[f64], level: f64) -> Result<Shift, Error> {
    finite("difference", differences)?;
    inside_unit("level", level)?;
    at_least("differences", differences.len(), 1)?;
    if differences.len() > MOST_DIFFERENCES {
        return Err(Error::TooMany { what: "differences", found: differences.len(), most: MOST_DIFFERENCES });
    }
    let mut averages = Vec::with_capacity(differences.len() * (differences.len() + 1) / 2);
    for (i, a) in differences.iter().enumerate() {
        averages.extend(differences[i..].iter().map(|b| f64::midpoint(*a, *b)));
    }
    averages.sort_by(f64::total_cmp);
    let count = averages.len();
    let estimate = f64::midpoint(averages[(count - 1) / 2], averages[count / 2]);
    let (outside, confidence) = cut(differences.len(), level);
    Ok(Shift { estimate, interval: [averages[outside], averages[count - 1 - outside]], confidence })
}

/// How many averages lie outside the interval on each side, and the confidence reached.
fn cut(differences: usize, level: f64) -> (usize, f64) {
    let tail = (1.0 - level) / 2.0;
    if differences > MOST_EXACT {
        let n = number(differences);
        let spread = (n * (n + 1.0) * (2.0 * n + 1.0) / 24.0).sqrt();
        let bound = n * (n + 1.0) / 4.0 + normal_quantile(tail) * spread;
        return (floor((bound - 0.5).max(0.0)), level);
    }
    // the interval [A_(c+1), A_(M-c)] misses the centre below with P(W <= c)
    let chances = sign_sums(&(1..=differences as u64).collect::<Vec<_>>());
    let mut below = chances[0];
    let mut outside = 0;
    while below + chances[outside + 1] <= tail {
        outside += 1;
        below += chances[outside];
    }
    (outside, 1.0 - 2.0 * below)
}
