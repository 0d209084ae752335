//! What this project wants of a large GPU, and how near the device comes: rows H1 to H8.

use super::{Quality, Row, Sequence, kernels, whole_step};
use crate::sim::Backend;
use crate::sim::bodies::LEVEL_DISTANCES;
use serde::Serialize;

/// Sizes that the goals are stated for.
const HEADSET: usize = 10_000;
const STADIUM: usize = 100_000;
const CITY: usize = 1_000_000;

/// A goal, and what was measured.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Goal {
    /// H1 to H8.
    pub name: &'static str,
    /// What is measured.
    pub what: String,
    /// The measurement: a median.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// What it should be: at most so many milliseconds, at least so many a second.
    pub goal: f64,
    /// Whether it is.
    pub is_met: bool,
}

impl Goal {
    fn at_most(name: &'static str, what: String, ms: f64, goal: f64) -> Self {
        Self { name, what, value: ms, unit: "ms", goal, is_met: ms <= goal }
    }

    fn at_least(name: &'static str, what: &str, count: usize, ms: f64, goal: f64) -> Self {
        #[allow(clippy::cast_precision_loss, reason = "far below 2^53")]
        let rate = if ms > 0.0 { count as f64 / ms * 1e-6 } else { 0.0 };
        Self { name, what: what.to_owned(), value: rate, unit: "10^9/s", goal, is_met: rate >= goal }
    }
}

/// What was measured at one size.
pub(super) struct Measured {
    pub(super) device: String,
    pub(super) rows: Vec<Row>,
    pub(super) quality: Quality,
    pub(super) goals: Vec<Goal>,
}

/// Measures what the goals of one size need; a size of none has its rows.
pub(super) fn goals(agents: usize, backend: Backend, device: Option<&str>) -> Result<Measured, crate::Error> {
    let (step, quality, simulation) = whole_step(super::Workload::Goals, agents, backend, device)?;
    let name = simulation.device();
    drop(simulation);
    let step_ms = step.ms_median;
    let mut rows = vec![step];
    rows.extend(kernels(&mut Sequence::step(agents, backend, device)?)?);
    // of a million most are far bodies, as in a picture
    let far = (agents > STADIUM).then_some(LEVEL_DISTANCES[1]);
    let mut sequence = Sequence::picture_from(agents, far, backend, device)?;
    let shown = kernels(&mut sequence)?;
    let ms = |name: &str| shown.iter().find(|row| row.name == name).map_or(0.0, |row| row.ms_median);
    let step_of = |name, goal| Goal::at_most(name, format!("a step of {agents} people"), step_ms, goal);
    let all_of = |name, how: &str, goal| {
        let what = format!("a step of {agents} people and all their bodies{how}");
        Goal::at_most(name, what, step_ms + ms("picture"), goal)
    };
    let goals = match agents {
        HEADSET => vec![step_of("H3", 0.05), all_of("H6", "", 0.5)],
        STADIUM => {
            let posing = ms("pose") + ms("stand") + ms("gaze") + ms("palette") + ms("eyes");
            let vertices = sequence.skinned_vertices()?;
            vec![
                step_of("H2", 0.12),
                Goal::at_least("H4", "people posed, with their gaze", agents, posing, 2.0),
                Goal::at_least("H5", "vertices skinned", vertices, ms("skin"), 90.0),
                all_of("H7", "", 2.0),
            ]
        }
        CITY => vec![step_of("H1", 0.8), all_of("H8", ", most of them seen from afar", 5.0)],
        _ => Vec::new(),
    };
    rows.extend(shown);
    Ok(Measured { device: name, rows, quality, goals })
}
