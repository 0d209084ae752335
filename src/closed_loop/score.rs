//! Wanted against perceived emotions: counts, fractions, and their intervals.

use crate::emotion::Emotion;
use crate::statistics::share_interval;
use serde::Serialize;

/// What people saw in the paper's own agents: `[shown][perceived]`, 48 answers a row (24 participants, 2 agents each), in
/// the order of [`Emotion::ALL`]. The paper has percentages, which are these counts; A-18.
#[doc(hidden)]
pub const HUMANS: [[u64; 4]; 4] = [[29, 2, 2, 15], [9, 25, 0, 14], [0, 0, 48, 0], [4, 2, 8, 34]];

/// A confusion matrix and what follows from it.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Score {
    /// Counts `[wanted][perceived]`, in the order of [`Emotion::ALL`].
    pub confusion: [[u64; 4]; 4],
    /// Number of answers.
    pub n: u64,
    /// Share of wanted emotions that were perceived, 0 to 1; 0 of none.
    pub accuracy: f64,
    /// 95 % Wilson interval of the accuracy.
    pub interval: [f64; 2],
    /// Share of each wanted emotion that was perceived as such; null where none was wanted.
    pub recall: [Option<f64>; 4],
    /// 95 % Wilson intervals of the recalls.
    pub recall_intervals: [[f64; 2]; 4],
}

impl Score {
    /// The score of pairs (wanted, perceived).
    pub fn of(answers: impl IntoIterator<Item = (Emotion, Emotion)>) -> Self {
        let mut confusion = [[0; 4]; 4];
        for (wanted, perceived) in answers {
            confusion[wanted.index()][perceived.index()] += 1;
        }
        Self::from_counts(confusion)
    }

    /// The score of counts `[wanted][perceived]`.
    pub fn from_counts(confusion: [[u64; 4]; 4]) -> Self {
        let row = |i: usize| confusion[i].iter().sum::<u64>();
        let n = (0..4).map(row).sum();
        let right = (0..4).map(|i| confusion[i][i]).sum();
        Self {
            confusion,
            n,
            accuracy: share(right, n),
            interval: wilson(right, n),
            recall: std::array::from_fn(|i| (row(i) > 0).then(|| share(confusion[i][i], row(i)))),
            recall_intervals: std::array::from_fn(|i| wilson(confusion[i][i], row(i))),
        }
    }
}

/// The 95 % interval of `right` of `n` by Wilson (1927); of nothing, anything is possible.
#[doc(hidden)]
pub fn wilson(right: u64, n: u64) -> [f64; 2] {
    share_interval(share(right, n), n)
}

fn share(part: u64, whole: u64) -> f64 {
    if whole == 0 { 0.0 } else { real(part) / real(whole) }
}

#[allow(clippy::cast_precision_loss, reason = "counts of agents are far below 2^53")]
fn real(count: u64) -> f64 {
    count as f64
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "shares of nothing and of all are exact")]
mod tests {
    use super::*;

    #[test]
    fn the_papers_people_saw_136_of_192() {
        let humans = Score::from_counts(HUMANS);
        assert_eq!((humans.n, humans.confusion.iter().flatten().sum::<u64>()), (192, 192));
        assert!((humans.accuracy - 136.0 / 192.0).abs() < 1e-12);
        assert_eq!(humans.recall[2], Some(1.0));
    }

    #[test]
    fn intervals_are_wilsons() {
        // Newcombe (1998), table I: 81 of 263, 15 of 148, 0 of 20, 1 of 29
        for (right, n, want) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            let found = wilson(right, n);
            assert!((found[0] - want[0]).abs() < 6e-5 && (found[1] - want[1]).abs() < 6e-5, "{found:?}");
        }
        assert_eq!(wilson(0, 0), [0.0, 1.0]);
        let none = Score::of([]);
        assert_eq!((none.accuracy, none.recall), (0.0, [None; 4]));
    }
}
