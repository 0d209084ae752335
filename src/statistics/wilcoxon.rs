//! Wilcoxon's signed-rank test of paired answers, with its effect sizes.
//!
//! Based on: Wilcoxon 1945, Biometrics Bulletin 1; Pratt 1959, JASA 54, and Cureton 1967, JASA 62 (zeros kept); Kerby 2014
//! (matched rank-biserial correlation); Rosenthal 1991 (r).

mod shift;

pub use shift::{Shift, shift};

use super::Alternative;
use super::distribution::{normal_cdf, normal_sf};
use super::error::{Error, finite};
use super::ranks::ranks;
use serde::{Deserialize, Serialize};

/// Most ranked differences for which the exact test runs.
pub const MOST_EXACT: usize = 200;

/// What becomes of differences of 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Zeros {
    /// Dropped before ranking.
    #[default]
    Wilcoxon,
    /// Ranked, then dropped.
    Pratt,
    /// Ranked; half of their ranks goes to each side.
    ZSplit,
}

/// How p is computed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Method {
    /// Exact up to [`MOST_EXACT`] ranked differences, normal beyond.
    #[default]
    Auto,
    /// Over all signs of the ranks as they are, ties included.
    Exact,
    /// By the normal distribution, corrected for ties.
    Normal,
}

/// What [`wilcoxon`] is asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Options {
    /// What becomes of differences of 0.
    pub zeros: Zeros,
    /// The alternative.
    pub alternative: Alternative,
    /// How p is computed.
    pub method: Method,
    /// Continuity correction: the normal method moves W+ by 1/2 towards its mean.
    pub continuity: bool,
}

/// Result of the signed-rank test.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Wilcoxon {
    /// Number of pairs given.
    pub pairs: usize,
    /// Number of differences of 0.
    pub zeros: usize,
    /// Number of differences ranked: without zeros under [`Zeros::Wilcoxon`], all otherwise.
    pub ranked: usize,
    /// Sum of the ranks of positive differences.
    pub w_plus: f64,
    /// Sum of the ranks of negative differences.
    pub w_minus: f64,
    /// W+ in standard deviations from its mean, by the normal approximation without continuity correction; 0 where no
    /// difference is left.
    pub z: f64,
    /// p; 1 where no difference is left.
    pub p: f64,
    /// Whether p is exact.
    pub exact: bool,
    /// `r = z / sqrt(ranked)`; 0 where no difference is left.
    pub r: f64,
    /// Matched rank-biserial correlation `(W+ - W-) / (W+ + W-)`; 0 where no difference is left.
    pub rank_biserial: f64,
}

/// Ranks of the absolute differences, ready for both methods.
struct Signed {
    /// Doubled ranks of the nonzero differences.
    doubled: Vec<u64>,
    /// Doubled sums of the ranks of either sign, without zeros.
    plus: u64,
    minus: u64,
    /// Doubled ranks of zeros that go to each side (whole: the ranks of m zeros sum to m(m+1)/2).
    zero_half: f64,
    zeros: usize,
    ranked: usize,
    mean: f64,
    deviation: f64,
}

impl Signed {
    fn new(differences: &[f64], zeros: Zeros) -> Result<Self, Error> {
        let is_zero = |value: f64| value.abs() <= 0.0;
        let kept: Vec<f64> =
            differences.iter().copied().filter(|&d| zeros != Zeros::Wilcoxon || !is_zero(d)).collect();
        let magnitudes: Vec<f64> = kept.iter().map(|d| d.abs()).collect();
        let ranked = ranks(&magnitudes)?;
        let (mut doubled, mut plus, mut minus) = (Vec::new(), 0, 0);
        for (&d, &rank) in kept.iter().zip(&ranked.doubled).filter(|&(&d, _)| !is_zero(d)) {
            doubled.push(rank);
            *(if d > 0.0 { &mut plus } else { &mut minus }) += rank;
        }
        let (n, m) = (kept.len() as u64, (kept.len() - doubled.len()) as u64);
        let (mut sum, mut square, mut ties) = (n * (n + 1), n * (n + 1) * (2 * n + 1), ranked.ties);
        if zeros == Zeros::Pratt {
            sum -= m * (m + 1);
            square -= m * (m + 1) * (2 * m + 1);
            ties -= m * m * m - m;
        }
        let zero_half = if zeros == Zeros::ZSplit { real(m * (m + 1)) / 2.0 } else { 0.0 };
        Ok(Self {
            zeros: differences.iter().filter(|&&d| is_zero(d)).count(),
            ranked: kept.len(),
            doubled,
            plus,
            minus,
            zero_half,
            mean: real(sum) / 4.0,
            deviation: ((real(square) - real(ties) / 2.0) / 24.0).sqrt(),
        })
    }

    fn w_plus(&self) -> f64 {
        (real(self.plus) + self.zero_half) / 2.0
    }

    /// p by the normal distribution.
    fn normal(&self, alternative: Alternative, continuity: bool) -> f64 {
        if self.deviation <= 0.0 {
            return 1.0;
        }
        let distance = self.w_plus() - self.mean;
        let towards = match alternative {
            _ if !continuity || (alternative == Alternative::TwoSided && distance.abs() <= 0.0) => 0.0,
            Alternative::TwoSided => 0.5_f64.copysign(distance),
            Alternative::Less => -0.5,
            Alternative::Greater => 0.5,
        };
        let z = (distance - towards) / self.deviation;
        match alternative {
            Alternative::TwoSided => 2.0 * normal_sf(z.abs()),
            Alternative::Less => normal_cdf(z),
            Alternative::Greater => normal_sf(z),
        }
    }

    /// p over all signs of the ranks.
    fn exact(&self, alternative: Alternative) -> f64 {
        let chances = sign_sums(&self.doubled);
        let tail = |sum: u64| -> f64 { chances.iter().skip(index(sum)).sum() };
        // the distribution is symmetric: P(W+ <= w) = P(W+ >= total - w), and total - w = W-
        match alternative {
            Alternative::TwoSided => (2.0 * tail(self.plus.max(self.minus))).min(1.0),
            Alternative::Less => tail(self.minus).min(1.0),
            Alternative::Greater => tail(self.plus).min(1.0),
        }
    }
}

/// Chances of each sum of a random half of the ranks, by adding one rank after the other.
fn sign_sums(ranks: &[u64]) -> Vec<f64> {
    let total: u64 = ranks.iter().sum();
    let mut chances = vec![0.0; index(total) + 1];
    chances[0] = 1.0;
    let mut reached = 0;
    for &rank in ranks {
        let rank = index(rank);
        reached += rank;
        for sum in (0..=reached).rev() {
            let with = if sum >= rank { chances[sum - rank] } else { 0.0 };
            chances[sum] = 0.5 * (chances[sum] + with);
        }
    }
    chances
}

/// Tests whether paired differences are symmetric about 0.
///
/// Exact p and the normal p under [`Zeros::Pratt`] and [`Zeros::ZSplit`] follow the same convention as `scipy.stats.wilcoxon`:
/// W+ is the statistic and two-sided p is twice the smaller tail.
///
/// Equal magnitudes are ties, to the last bit. Differences of whole numbers are exact; others need rounding first.
///
/// # Errors
/// A difference that is not finite; [`Method::Exact`] with more than [`MOST_EXACT`] differences other than 0.
pub fn wilcoxon(differences: &[f64], options: Options) -> Result<Wilcoxon, Error> {
    finite("difference", differences)?;
    let signed = Signed::new(differences, options.zeros)?;
    let nonzero = signed.doubled.len();
    if options.method == Method::Exact && nonzero > MOST_EXACT {
        return Err(Error::TooMany {
            what: "differences of the exact test",
            found: nonzero,
            most: MOST_EXACT,
        });
    }
    let exact = options.method != Method::Normal && nonzero <= MOST_EXACT;
    let p = if nonzero == 0 {
        1.0
    } else if exact {
        signed.exact(options.alternative)
    } else {
        signed.normal(options.alternative, options.continuity)
    };
    let (plus, minus) = (signed.w_plus(), (real(signed.minus) + signed.zero_half) / 2.0);
    let z = if nonzero == 0 { 0.0 } else { (plus - signed.mean) / signed.deviation };
    Ok(Wilcoxon {
        pairs: differences.len(),
        zeros: signed.zeros,
        ranked: signed.ranked,
        w_plus: plus,
        w_minus: minus,
        z,
        p,
        exact,
        r: if nonzero == 0 { 0.0 } else { z / real(signed.ranked as u64).sqrt() },
        rank_biserial: if nonzero == 0 { 0.0 } else { (plus - minus) / (plus + minus) },
    })
}

#[allow(
    clippy::cast_possible_truncation,
    reason = "a sum of at most 200 doubled ranks, none far beyond 10^6"
)]
const fn index(sum: u64) -> usize {
    sum as usize
}

#[allow(clippy::cast_precision_loss, reason = "sums of ranks are far below 2^53")]
const fn real(count: u64) -> f64 {
    count as f64
}
