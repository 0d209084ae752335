//! Whether a label depends on which raters happened to answer.
//!
//! Based on: Efron and Tibshirani 1993, "An Introduction to the Bootstrap" (raters of a unit drawn with replacement).

use super::describe::{mean, number};
use super::error::{Error, at_least};
use crate::random::Random;
use serde::Serialize;

/// How stable labels are.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Stability {
    /// Share of resamples in which the label of each unit stays, in the order given.
    pub units: Vec<f64>,
    /// Their mean.
    pub mean: f64,
}

/// Draws the raters of each unit with replacement, `draws` times, and counts how often `label` gives what it gives for the
/// raters as they are.
///
/// `units` are answers, `[unit][rater]`. Each unit draws from a generator of its own, so that its share does not depend on
/// other units.
///
/// # Errors
/// No units, a unit without raters, or no draws.
pub fn label_stability<T, L: PartialEq>(
    units: &[Vec<T>],
    label: impl Fn(&[&T]) -> L,
    draws: usize,
    seed: u64,
) -> Result<Stability, Error> {
    at_least("units", units.len(), 1)?;
    at_least("draws", draws, 1)?;
    let mut seeds = Random::new(seed);
    let mut shares = Vec::with_capacity(units.len());
    for answers in units {
        at_least("raters of a unit", answers.len(), 1)?;
        let mut random = Random::new(seeds.bits());
        let given = label(&answers.iter().collect::<Vec<_>>());
        let mut chosen = Vec::with_capacity(answers.len());
        let mut kept = 0;
        for _ in 0..draws {
            chosen.clear();
            chosen.extend((0..answers.len()).map(|_| &answers[random.below(answers.len())]));
            kept += usize::from(label(&chosen) == given);
        }
        shares.push(number(kept) / number(draws));
    }
    let mean = mean(&shares);
    Ok(Stability { units: shares, mean })
}

/// The paper's label of a gait: the question with the greatest mean answer, if that exceeds `theta`; of equal means the first.
pub fn greatest_mean<const N: usize>(answers: &[&[u8; N]], theta: f64) -> Option<usize> {
    let sums: [u64; N] =
        std::array::from_fn(|question| answers.iter().map(|answer| u64::from(answer[question])).sum());
    let greatest = *sums.iter().max()?;
    #[allow(clippy::cast_precision_loss, reason = "sums of answers are far below 2^53")]
    let exceeds = greatest as f64 > theta * number(answers.len());
    exceeds.then(|| sums.iter().position(|&sum| sum == greatest))?
}
