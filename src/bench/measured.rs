//! What it costs that `gaitway simulate` measures every step: the same crowd with and without, beside the crossing of the other rows.
//!
//! Ten seconds from the start, as `simulate` does them. The batches of the three crowds alternate, so that other load on the
//! machine slows all.

use super::crowds::{Quality, SPACING, plain, quality_of};
use super::runs::Row;
use crate::scene::Scene;
use crate::sim::{Backend, Simulation};
use crate::verify::cases::crossing::crossing;
use std::time::Instant;

/// Names of the rows: the crossing of [`Workload::Crossing`](super::Workload::Crossing), whose streams are mixed from the start; the scene
/// `crossing`, whose streams meet; that scene with measures.
const ROWS: [&str; 3] = ["step", "scene", "scene_measured"];
/// Steps timed together, and how often.
const BATCHES: (u32, u32) = (15, 20);

/// Times the steps; rows, crowds after them, and the device.
pub(super) fn measured(
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, Vec<Quality>, String), crate::Error> {
    let store = plain(crossing(agents, SPACING));
    let scene = || -> Result<Simulation, crate::Error> {
        let count = u32::try_from(agents).unwrap_or(u32::MAX);
        Scene::load("crossing")?.agents(count).build()?.on(backend, device).start()
    };
    let mut crowds = [Simulation::from_store(store, backend, device)?, scene()?, scene()?];
    crowds[2].measure_steps()?;
    let mut times = [(); 3].map(|()| Vec::new());
    let (steps, batches) = BATCHES;
    for _batch in 0..batches {
        for (crowd, times) in crowds.iter_mut().zip(&mut times) {
            let begin = Instant::now();
            crowd.step(steps)?;
            crowd.finish()?;
            times.push(begin.elapsed().as_secs_f64() * 1e3 / f64::from(steps));
        }
    }
    let (mut rows, mut qualities, mut name) = (Vec::new(), Vec::new(), String::new());
    for ((row, mut crowd), times) in ROWS.into_iter().zip(crowds).zip(times) {
        rows.push(Row::new(row, agents, times));
        name = crowd.device();
        if row == "step" {
            qualities.push(quality_of(row, agents, &mut crowd)?);
        }
    }
    Ok((rows, qualities, name))
}
