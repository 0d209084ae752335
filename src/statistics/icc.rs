//! Intraclass correlations of complete tables, and Cronbach's alpha.
//!
//! With mean squares between targets B, within targets W, between raters J and of the residual E, n targets, k raters:
//! `ICC(1,1) = (B - W) / (B + (k - 1) W)`, `ICC(2,1) = (B - E) / (B + (k - 1) E + k (J - E) / n)`,
//! `ICC(3,1) = (B - E) / (B + (k - 1) E)`, and for means of k raters `(B - W) / B`, `(B - E) / (B + (J - E) / n)`,
//! `(B - E) / B`.
//!
//! Based on: Shrout and Fleiss 1979, Psychological Bulletin 86; `McGraw` and Wong 1996, Psychological Methods 1 (intervals);
//! Cronbach 1951, Psychometrika 16; Feldt 1965, Psychometrika 30 (its interval).

use super::describe::{mean, number};
use super::distribution::{f_quantile, f_sf};
use super::error::{Error, at_least, columns, finite, inside_unit};
use serde::Serialize;

/// One model of the intraclass correlation.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Icc {
    /// Reliability of one rater.
    pub single: f64,
    /// Its interval.
    pub single_interval: [f64; 2],
    /// Reliability of the mean of all raters; minus infinity where all targets have one mean.
    pub mean: f64,
    /// Its interval.
    pub mean_interval: [f64; 2],
    /// F of the test against 0; infinite where raters agree perfectly.
    pub f: f64,
    /// Degrees of freedom of F.
    pub degrees: [usize; 2],
    /// P of an F at least as great.
    pub p: f64,
}

/// The three models of Shrout and Fleiss.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct IccModels {
    /// Number of targets.
    pub targets: usize,
    /// Number of raters: k of the means.
    pub raters: usize,
    /// ICC(1,1) and ICC(1,k): each target has its own raters.
    pub one_way: Icc,
    /// ICC(2,1) and ICC(2,k): raters drawn at random, absolute agreement.
    pub agreement: Icc,
    /// ICC(3,1) and ICC(3,k): these raters only, consistency.
    pub consistency: Icc,
}

/// Mean squares of a complete table.
struct Squares {
    targets: f64,
    raters: f64,
    between: f64,
    within: f64,
    judges: f64,
    residual: f64,
}

impl Squares {
    fn new<R: AsRef<[f64]>>(rows: &[R]) -> Result<Self, Error> {
        let raters = columns("answers", rows)?;
        at_least("targets", rows.len(), 2)?;
        at_least("raters", raters, 2)?;
        for row in rows {
            finite("answer", row.as_ref())?;
        }
        let (n, k) = (number(rows.len()), number(raters));
        let targets: Vec<f64> = rows.iter().map(|row| mean(row.as_ref())).collect();
        let judges: Vec<f64> =
            (0..raters).map(|j| rows.iter().map(|row| row.as_ref()[j]).sum::<f64>() / n).collect();
        let grand = mean(&targets);
        let square = |values: &[f64]| values.iter().map(|value| (value - grand).powi(2)).sum::<f64>();
        let (mut within, mut residual) = (0.0, 0.0);
        for (row, target) in rows.iter().zip(&targets) {
            for (value, judge) in row.as_ref().iter().zip(&judges) {
                within += (value - target).powi(2);
                residual += (value - target - judge + grand).powi(2);
            }
        }
        Ok(Self {
            targets: n,
            raters: k,
            between: k * square(&targets) / (n - 1.0),
            within: within / (n * (k - 1.0)),
            judges: n * square(&judges) / (k - 1.0),
            residual: residual / ((n - 1.0) * (k - 1.0)),
        })
    }

    /// A model in which `error` is the mean square that `between` is compared with.
    fn ratio(&self, error: f64, below: f64, tail: f64) -> Icc {
        let (b, k, above) = (self.between, self.raters, self.targets - 1.0);
        let narrow = f_quantile(tail, above, below);
        let wide = f_quantile(tail, below, above);
        let single = |b: f64, error: f64| (b - error) / (b + (k - 1.0) * error);
        let mean = |b: f64, error: f64| (b - error) / b;
        Icc {
            single: single(b, error),
            single_interval: [single(b, narrow * error), single(wide * b, error)],
            mean: mean(b, error),
            mean_interval: [mean(b, narrow * error), mean(wide * b, error)],
            f: b / error,
            degrees: [whole(above), whole(below)],
            p: f_sf(b / error, above, below),
        }
    }

    /// Absolute agreement, with the interval by Satterthwaite's degrees of freedom.
    fn absolute(&self, consistency: &Icc, tail: f64) -> Icc {
        let Self { targets: n, raters: k, between: b, judges: j, residual: e, .. } = *self;
        let single = (b - e) / (b + (k - 1.0) * e + k * (j - e) / n);
        let rest = (n * (1.0 + (k - 1.0) * single) - k * single) * e;
        let judged = k * single * j;
        let spread = (n - 1.0) * judged * judged + rest * rest;
        let all = (k - 1.0) * (n - 1.0);
        let degrees = if spread > 0.0 { all * (judged + rest).powi(2) / spread } else { all };
        let narrow = f_quantile(tail, n - 1.0, degrees);
        let wide = f_quantile(tail, degrees, n - 1.0);
        let others = k * j + (k * n - k - n) * e;
        let interval =
            [n * (b - narrow * e) / (narrow * others + n * b), n * (wide * b - e) / (others + n * wide * b)];
        Icc {
            single,
            single_interval: interval,
            mean: (b - e) / (b + (j - e) / n),
            mean_interval: interval.map(|bound| bound * k / (1.0 + bound * (k - 1.0))),
            ..*consistency
        }
    }
}

/// All six intraclass correlations of `[target][rater]`, with intervals of `level`.
///
/// # Errors
/// Fewer than two targets or raters, rows of different lengths, a number that is not finite, answers that do not vary, or a
/// level outside (0, 1).
pub fn icc<R: AsRef<[f64]>>(rows: &[R], level: f64) -> Result<IccModels, Error> {
    inside_unit("level", level)?;
    let squares = Squares::new(rows)?;
    if squares.between <= 0.0 && squares.residual <= 0.0 {
        return Err(Error::Constant { what: "answers over targets", statistic: "ICC" });
    }
    let (n, k, tail) = (squares.targets, squares.raters, (1.0 - level) / 2.0);
    let consistency = squares.ratio(squares.residual, (n - 1.0) * (k - 1.0), tail);
    Ok(IccModels {
        targets: rows.len(),
        raters: whole(k),
        one_way: squares.ratio(squares.within, n * (k - 1.0), tail),
        agreement: squares.absolute(&consistency, tail),
        consistency,
    })
}

/// Cronbach's alpha.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Cronbach {
    /// Internal consistency of a sum of items, at most 1.
    pub alpha: f64,
    /// Its interval by Feldt.
    pub interval: [f64; 2],
}

/// Cronbach's alpha of `[person][item]`: `k / (k - 1) (1 - sum of item variances / variance of sums)`, which is ICC(3,k).
///
/// # Errors
/// Fewer than two people or items, rows of different lengths, a number that is not finite, sums that do not vary, or a level
/// outside (0, 1).
pub fn cronbach<R: AsRef<[f64]>>(rows: &[R], level: f64) -> Result<Cronbach, Error> {
    inside_unit("level", level)?;
    let squares = Squares::new(rows)?;
    if squares.between <= 0.0 {
        return Err(Error::Constant { what: "sums of items", statistic: "Cronbach's alpha" });
    }
    let (above, tail) = (squares.targets - 1.0, (1.0 - level) / 2.0);
    let below = above * (squares.raters - 1.0);
    let share = squares.residual / squares.between; // 1 - alpha
    let bound = |upper: f64| 1.0 - share * f_quantile(upper, above, below);
    Ok(Cronbach { alpha: 1.0 - share, interval: [bound(tail), bound(1.0 - tail)] })
}

/// Whole degrees of freedom.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a whole number at least 1")]
const fn whole(degrees: f64) -> usize {
    degrees as usize
}
