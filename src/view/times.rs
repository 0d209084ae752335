//! How long steps and frames take, and their kernels.

use crate::kernels::Phase;
use serde::Serialize;
use std::collections::{BTreeMap, VecDeque};
use std::time::Duration;

/// Moments that the plot of times goes back.
const HISTORY: usize = 240;
/// Moments that means are taken over.
const RECENT: usize = 30;

/// How long the phases of kernels ran: of a step, or of a frame.
#[derive(Debug, Default)]
pub(super) struct Times {
    kernels: BTreeMap<&'static str, VecDeque<f64>>,
    /// By the clock, with everything beside the kernels, ms.
    whole: VecDeque<f64>,
}

/// Mean times over the last steps or frames, ms.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct MeanTimes {
    /// By the clock, with everything beside the kernels.
    pub whole: f64,
    /// Of each kernel, or phase of one (`flow.sweep`).
    pub kernels: BTreeMap<&'static str, f64>,
}

fn push(history: &mut VecDeque<f64>, value: f64) {
    history.push_back(value);
    if history.len() > HISTORY {
        history.pop_front();
    }
}

fn mean(history: &VecDeque<f64>) -> f64 {
    let last: Vec<f64> = history.iter().rev().take(RECENT).copied().collect();
    #[allow(clippy::cast_precision_loss, reason = "at most 30")]
    let count = last.len().max(1) as f64;
    last.iter().sum::<f64>() / count
}

impl Times {
    /// Takes one measurement over `count` steps or frames: the kernels, and how long all of it took.
    pub(super) fn take(&mut self, measured: &[(Phase, f64)], count: u32, whole: Duration) {
        if count == 0 {
            return;
        }
        let mut sums: BTreeMap<&'static str, f64> = BTreeMap::new();
        for (phase, milliseconds) in measured {
            *sums.entry(phase.entry().label).or_default() += milliseconds / f64::from(count);
        }
        for name in sums.keys() {
            let before = self.whole.len();
            self.kernels.entry(name).or_insert_with(|| std::iter::repeat_n(0.0, before).collect());
        }
        for (name, history) in &mut self.kernels {
            push(history, sums.get(name).copied().unwrap_or(0.0));
        }
        push(&mut self.whole, whole.as_secs_f64() * 1e3 / f64::from(count));
    }

    /// The kernels, dearest first by their mean over the last moments, which stands beside, ms.
    pub(super) fn dearest(&self) -> Vec<(&'static str, f64, &VecDeque<f64>)> {
        let mut all: Vec<_> =
            self.kernels.iter().map(|(name, history)| (*name, mean(history), history)).collect();
        all.sort_by(|a, b| b.1.total_cmp(&a.1));
        all
    }

    /// Means over the last moments.
    pub(super) fn means(&self) -> MeanTimes {
        let kernels = self.kernels.iter().map(|(name, history)| (*name, mean(history))).collect();
        MeanTimes { whole: mean(&self.whole), kernels }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "sums of small integers")]
mod tests {
    use super::*;

    #[test]
    fn times_are_means_over_steps_and_begin_at_zero_for_kernels_that_come_later() {
        let mut times = Times::default();
        times.take(&[(Phase::Integrate, 4.0), (Phase::Integrate, 2.0)], 2, Duration::from_millis(16));
        times.take(&[(Phase::Integrate, 1.0), (Phase::EmotionUpdate, 9.0)], 1, Duration::from_millis(12));
        times.take(&[], 0, Duration::from_millis(99));
        let all = times.dearest();
        assert_eq!(all[0].0, "emotion_update");
        assert_eq!(all[0].2, &[0.0, 9.0]);
        assert_eq!(all[1].2, &[3.0, 1.0]);
        let means = times.means();
        assert_eq!(
            (means.whole, means.kernels["integrate"], means.kernels["emotion_update"]),
            (10.0, 2.0, 4.5)
        );
    }
}
