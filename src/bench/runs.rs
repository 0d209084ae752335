//! One measurement, and how often something is run for it.

use serde::Serialize;
use std::time::{Duration, Instant};

/// Runs before the first that counts.
pub(super) const WARM_UP: usize = 3;
/// Fewest and most runs that count, and how long they may take together.
pub(super) const RUNS: (usize, usize, Duration) = (5, 60, Duration::from_secs(2));

/// One measurement.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Row {
    /// Kernel, `step` for a whole step, or `picture` for all of its animation.
    pub name: &'static str,
    /// Agents (cells of `flow`, `flow_density` and `field_...`, gaits of `gait_features`, cases of the probe).
    pub agents: usize,
    /// Median, ms.
    pub ms_median: f64,
    /// Fastest, ms.
    pub ms_min: f64,
    /// Slowest, ms.
    pub ms_max: f64,
    /// Agents over the median.
    pub agent_steps_per_second: f64,
    /// How many runs the median is of.
    pub runs: usize,
}

impl Row {
    /// Of the times of all runs, ms.
    pub(super) fn new(name: &'static str, agents: usize, mut times: Vec<f64>) -> Self {
        times.sort_by(f64::total_cmp);
        let runs = times.len();
        let at = |place: usize| times.get(place).copied().unwrap_or(0.0);
        let ms_median = at(runs / 2);
        #[allow(clippy::cast_precision_loss, reason = "up to millions")]
        let agent_steps_per_second = if ms_median > 0.0 { agents as f64 / ms_median * 1e3 } else { 0.0 };
        let (ms_min, ms_max) = (at(0), at(runs.saturating_sub(1)));
        Self { name, agents, ms_median, ms_min, ms_max, agent_steps_per_second, runs }
    }
}

/// Runs something as often as [`RUNS`] says; every run returns its time in ms.
pub(super) fn repeat(mut run: impl FnMut() -> Result<f64, crate::Error>) -> Result<Vec<f64>, crate::Error> {
    let (fewest, most, budget) = RUNS;
    let begin = Instant::now();
    let mut times = Vec::new();
    while times.len() < fewest || (times.len() < most && begin.elapsed() < budget) {
        times.push(run()?);
    }
    Ok(times)
}
