//! How four questions go together and how far raters agree, each video by its own raters.
//!
//! Based on: Pearson's r with Fisher's z interval; Shrout and Fleiss 1979, "Intraclass correlations: uses in assessing
//! rater reliability", Psychological Bulletin 86, ICC(1,1) and ICC(1,k), the one-way model, since every video has its
//! own raters; Krippendorff 2011, "Computing Krippendorff's alpha-reliability", which copes with missing answers.

use super::describe::number;
use serde::Serialize;

/// Answers are 1 to this.
const SCALE: usize = 5;

/// Pearson correlations between the four questions.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Correlation {
    /// Number of rows correlated.
    pub rows: usize,
    /// r of question i with question j, in the order of the columns; NaN where one never varies.
    pub r: [[f64; 4]; 4],
    /// 95 % interval of each r by Fisher's z; NaN for fewer than 4 rows. Responses of one rater are not independent, so
    /// over responses the intervals are too narrow.
    pub interval: [[[f64; 2]; 4]; 4],
}

/// Correlates the columns of `rows`.
pub fn correlation(rows: &[[f64; 4]]) -> Correlation {
    let count = number(rows.len());
    let mean: [f64; 4] = std::array::from_fn(|q| rows.iter().map(|row| row[q]).sum::<f64>() / count);
    let product =
        |a: usize, b: usize| -> f64 { rows.iter().map(|row| (row[a] - mean[a]) * (row[b] - mean[b])).sum() };
    let r: [[f64; 4]; 4] = std::array::from_fn(|a| {
        std::array::from_fn(|b| {
            let scale = (product(a, a) * product(b, b)).sqrt();
            if scale > 1e-12 * count { (product(a, b) / scale).clamp(-1.0, 1.0) } else { f64::NAN }
        })
    });
    let half = 1.959_963_984_540_054 / (count - 3.0).sqrt(); // NaN up to 3 rows
    let interval = r.map(|row| {
        row.map(|r| {
            // r = 1 (the diagonal) stays 1: the hyperbolic tangent of infinity.
            let bound =
                |side: f64| if half.is_finite() { (r.atanh() + side * half).tanh() } else { f64::NAN };
            [bound(-1.0), bound(1.0)]
        })
    });
    Correlation { rows: rows.len(), r, interval }
}

/// How far raters agree on one question.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Agreement {
    /// ICC(1,1): reliability of a single rater's answer, at most 1; NaN if it does not exist.
    pub icc_single: f64,
    /// ICC(1,k): reliability of the mean of `raters` answers, which is what labels are made from.
    pub icc_mean: f64,
    /// The k of ICC(1,k): mean number of raters per video, corrected for unequal numbers.
    pub raters: f64,
    /// Krippendorff's alpha with the ordinal metric, which suits a Likert scale.
    pub alpha_ordinal: f64,
    /// Krippendorff's alpha with the interval metric, which suits means.
    pub alpha_interval: f64,
}

/// Agreement over videos; `units` are the answers to one question, `[video][rater]`, 1 to 5.
pub fn agreement(units: &[Vec<u8>]) -> Agreement {
    let [icc_single, icc_mean, raters] = icc(units);
    Agreement {
        icc_single,
        icc_mean,
        raters,
        alpha_ordinal: krippendorff_alpha(units, Metric::Ordinal),
        alpha_interval: krippendorff_alpha(units, Metric::Interval),
    }
}

/// ICC(1,1), ICC(1,k) and k.
///
/// With B and W the mean squares between and within videos: `(B - W) / (B + (k - 1) W)` and `(B - W) / B`. For unequal
/// numbers `n_i` of raters, `k = (N - sum n_i^2 / N) / (videos - 1)`.
fn icc(units: &[Vec<u8>]) -> [f64; 3] {
    let units: Vec<&Vec<u8>> = units.iter().filter(|unit| !unit.is_empty()).collect();
    let total = number(units.iter().map(|unit| unit.len()).sum());
    let videos = number(units.len());
    let sum = |unit: &[u8]| unit.iter().map(|&score| f64::from(score)).sum::<f64>();
    let grand = units.iter().map(|unit| sum(unit)).sum::<f64>() / total;
    let (mut between, mut within, mut squares) = (0.0, 0.0, 0.0);
    for unit in units {
        let count = number(unit.len());
        let mean = sum(unit) / count;
        between += count * (mean - grand).powi(2);
        within += unit.iter().map(|&score| (f64::from(score) - mean).powi(2)).sum::<f64>();
        squares += count * count;
    }
    let (between, within) = (between / (videos - 1.0), within / (total - videos));
    let k = (total - squares / total) / (videos - 1.0);
    [(between - within) / (between + (k - 1.0) * within), (between - within) / between, k]
}

/// What the distance between two answers is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Metric {
    /// Equal or not.
    Nominal,
    /// How many answers lie between them.
    Ordinal,
    /// Their difference.
    Interval,
}

/// Krippendorff's alpha of answers `[video][rater]`, 1 to 5: 1 is perfect agreement, 0 is chance. Videos with fewer than
/// two answers do not count; NaN if all answers are equal or none can be paired.
///
/// `alpha = 1 - (n - 1) sum o_ck d_ck / sum n_c n_k d_ck` with o the coincidences, `n_c` their sums and d the squared
/// difference of `metric`.
pub fn krippendorff_alpha(units: &[Vec<u8>], metric: Metric) -> f64 {
    let mut pairs = [[0.0; SCALE]; SCALE];
    for unit in units.iter().filter(|unit| unit.len() > 1) {
        let mut counts = [0.0; SCALE];
        for &score in unit {
            if let Some(count) = counts.get_mut(usize::from(score).wrapping_sub(1)) {
                *count += 1.0;
            }
        }
        for c in 0..SCALE {
            for k in 0..SCALE {
                let same = if c == k { 1.0 } else { 0.0 };
                pairs[c][k] += counts[c] * (counts[k] - same) / (number(unit.len()) - 1.0);
            }
        }
    }
    let sums = pairs.map(|row| row.iter().sum::<f64>());
    let total: f64 = sums.iter().sum();
    let squared = |c: usize, k: usize| -> f64 {
        match metric {
            Metric::Nominal => f64::from(u8::from(c != k)),
            Metric::Interval => number(c.abs_diff(k)).powi(2),
            Metric::Ordinal => {
                let between: f64 = sums[c.min(k)..=c.max(k)].iter().sum();
                (between - 0.5 * (sums[c] + sums[k])).powi(2)
            }
        }
    };
    let (mut observed, mut expected) = (0.0, 0.0);
    for c in 0..SCALE {
        for k in 0..SCALE {
            observed += pairs[c][k] * squared(c, k);
            expected += sums[c] * sums[k] * squared(c, k);
        }
    }
    if expected > 0.0 { 1.0 - (total - 1.0) * observed / expected } else { f64::NAN }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn alpha_is_that_of_krippendorffs_own_example() {
        // Krippendorff 2011, section C: four observers, twelve units, missing answers.
        let rows: [[u8; 12]; 4] = [
            [1, 2, 3, 3, 2, 1, 4, 1, 2, 0, 0, 0],
            [1, 2, 3, 3, 2, 2, 4, 1, 2, 5, 0, 3],
            [0, 3, 3, 3, 2, 3, 4, 2, 2, 5, 1, 0],
            [1, 2, 3, 3, 2, 4, 4, 1, 2, 5, 1, 0],
        ];
        let units: Vec<Vec<u8>> = (0..12)
            .map(|unit| rows.iter().map(|row| row[unit]).filter(|&score| score > 0).collect())
            .collect();
        for (metric, published) in
            [(Metric::Nominal, 0.743), (Metric::Ordinal, 0.815), (Metric::Interval, 0.849)]
        {
            let found = krippendorff_alpha(&units, metric);
            assert!((found - published).abs() < 5e-4, "{metric:?}: {found}");
        }
    }

    #[test]
    fn icc_is_that_of_shrout_and_fleiss() {
        // Shrout and Fleiss 1979, table 2: six targets, four judges; ICC(1,1) 0.17 and ICC(1,4) 0.44.
        let units: Vec<Vec<u8>> =
            [[9, 2, 5, 8], [6, 1, 3, 2], [8, 4, 6, 8], [7, 1, 2, 6], [10, 5, 6, 9], [6, 2, 4, 7]]
                .map(Vec::from)
                .to_vec();
        let [single, mean, k] = icc(&units);
        assert!((single - 0.1657).abs() < 1e-3 && (mean - 0.4428).abs() < 1e-3, "{single} {mean}");
        assert!((k - 4.0).abs() < 1e-12);
    }

    #[test]
    fn correlations_are_those_of_a_hand_worked_table_and_absent_without_variance() {
        let rows = [[1.0, 2.0, 5.0, 3.0], [2.0, 4.0, 4.0, 3.0], [3.0, 6.0, 3.0, 3.0], [4.0, 9.0, 1.0, 3.0]];
        let found = correlation(&rows);
        assert!((found.r[0][1] - 11.5 / (5.0_f64 * 26.75).sqrt()).abs() < 1e-12);
        assert!((found.r[0][2] + 6.5 / (5.0_f64 * 8.75).sqrt()).abs() < 1e-12);
        assert!(found.r[0][3].is_nan() && found.interval[0][3][0].is_nan());
        assert!((found.r[1][1] - 1.0).abs() < 1e-12);
        let [low, high] = found.interval[0][2];
        assert!(low < found.r[0][2] && found.r[0][2] < high && high < 1.0);
    }
}
