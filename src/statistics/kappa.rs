//! Cohen's kappa of two ratings of the same things, and the agreement of raters with themselves.
//!
//! `kappa = (po - pe) / (1 - pe)` with weighted agreement `po = sum w_ij p_ij` and `pe = sum w_ij p_i. p_.j`.
//!
//! Based on: Cohen 1960, Educational and Psychological Measurement 20; Cohen 1968, Psychological Bulletin 70 (weights);
//! Fleiss, Cohen and Everitt 1969, Psychological Bulletin 72 (standard error in large samples).

use super::describe::number;
use super::distribution::normal_quantile;
use super::error::{Error, at_least, columns};
use serde::{Deserialize, Serialize};

/// How much two unlike answers agree; categories i and j of k.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Weights {
    /// Not at all.
    Equal,
    /// `1 - |i - j| / (k - 1)`.
    Linear,
    /// `1 - (i - j)^2 / (k - 1)^2`.
    Quadratic,
}

impl Weights {
    fn of(self, i: usize, j: usize, categories: usize) -> f64 {
        let distance = number(i.abs_diff(j)) / number(categories - 1);
        match self {
            Self::Equal => f64::from(u8::from(i == j)),
            Self::Linear => 1.0 - distance,
            Self::Quadratic => 1.0 - distance * distance,
        }
    }
}

/// Cohen's kappa.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Kappa {
    /// 1 is perfect agreement, 0 is chance.
    pub kappa: f64,
    /// Standard error of kappa in large samples.
    pub error: f64,
    /// 95 % interval by the standard error, within [-1, 1].
    pub interval: [f64; 2],
}

/// Kappa of a square table of counts, `[first rating][second rating]`.
///
/// # Errors
/// Fewer than two categories, a table that is not square, no counts, or all counts in one category.
pub fn kappa<R: AsRef<[u64]>>(counts: &[R], weights: Weights) -> Result<Kappa, Error> {
    let (total, categories) = square(counts)?;
    let share = |i: usize, j: usize| real(counts[i].as_ref()[j]) / total;
    let all = || 0..categories;
    let rows: Vec<f64> = all().map(|i| all().map(|j| share(i, j)).sum()).collect();
    let columns: Vec<f64> = all().map(|j| all().map(|i| share(i, j)).sum()).collect();
    let weight = |i: usize, j: usize| weights.of(i, j, categories);
    let over = |term: &dyn Fn(usize, usize) -> f64| -> f64 {
        all().flat_map(|i| all().map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum()
    };
    // disagreement, which keeps its digits where agreement is near 1
    let observed = over(&|i, j| (1.0 - weight(i, j)) * share(i, j));
    let expected = over(&|i, j| (1.0 - weight(i, j)) * rows[i] * columns[j]);
    if expected <= 0.0 {
        return Err(Error::Constant { what: "answers", statistic: "kappa" });
    }
    let kappa = 1.0 - observed / expected;
    let row_weight: Vec<f64> = all().map(|i| all().map(|j| columns[j] * weight(i, j)).sum()).collect();
    let column_weight: Vec<f64> = all().map(|j| all().map(|i| rows[i] * weight(i, j)).sum()).collect();
    let squares = over(&|i, j| {
        share(i, j) * (weight(i, j) - (row_weight[i] + column_weight[j]) * (1.0 - kappa)).powi(2)
    });
    let centre = kappa - (1.0 - expected) * (1.0 - kappa);
    let error = ((squares - centre * centre).max(0.0) / total).sqrt() / expected;
    let half = -normal_quantile(0.025) * error;
    Ok(Kappa { kappa, error, interval: [(kappa - half).max(-1.0), (kappa + half).min(1.0)] })
}

/// How far raters agree with themselves.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct SelfAgreement {
    /// Number of repeated answers.
    pub pairs: usize,
    /// Share of answers that are equal.
    pub equal: f64,
    /// Mean absolute difference, in points of the scale.
    pub mean_difference: f64,
    /// Kappa with quadratic weights; `None` where all answers are one point of the scale.
    pub kappa: Option<Kappa>,
}

/// Agreement of first and second answers, `[first, second]`, 1 to `points`.
///
/// # Errors
/// No pairs, fewer than two points, or an answer outside 1 to `points`.
pub fn self_agreement(pairs: &[[u8; 2]], points: u8) -> Result<SelfAgreement, Error> {
    at_least("repeated answers", pairs.len(), 1)?;
    at_least("points of the scale", usize::from(points), 2)?;
    let mut counts = vec![vec![0_u64; usize::from(points)]; usize::from(points)];
    for &[first, second] in pairs {
        for answer in [first, second] {
            if !(1..=points).contains(&answer) {
                return Err(Error::Range { what: "answer", value: f64::from(answer), range: "[1, points]" });
            }
        }
        counts[usize::from(first - 1)][usize::from(second - 1)] += 1;
    }
    let count = number(pairs.len());
    let differences = || pairs.iter().map(|[first, second]| first.abs_diff(*second));
    Ok(SelfAgreement {
        pairs: pairs.len(),
        equal: number(differences().filter(|&difference| difference == 0).count()) / count,
        mean_difference: differences().map(f64::from).sum::<f64>() / count,
        kappa: kappa(&counts, Weights::Quadratic).ok(),
    })
}

/// Total and number of categories of a square table with counts.
pub(super) fn square<R: AsRef<[u64]>>(counts: &[R]) -> Result<(f64, usize), Error> {
    let found = columns("counts", counts)?;
    at_least("categories", counts.len(), 2)?;
    if found != counts.len() {
        return Err(Error::Ragged { what: "counts", row: 0, found, expected: counts.len() });
    }
    let total: u64 = counts.iter().flat_map(AsRef::as_ref).sum();
    at_least("answers", usize::try_from(total).unwrap_or(usize::MAX), 1)?;
    Ok((real(total), counts.len()))
}

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
pub(super) const fn real(count: u64) -> f64 {
    count as f64
}
