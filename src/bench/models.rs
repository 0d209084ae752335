//! What the models of avoidance cost beside each other: steps of the crossing at several densities.
//!
//! Both models walk the same crowd. Their batches of steps alternate, so that other load on the machine slows both. The
//! bench times a batch after the crowd has mixed. The crowd's quality is measured at that moment too, since slower machines
//! do fewer steps after it.

use super::crowds::{Quality, bare, quality_of};
use super::runs::{RUNS, Row};
use crate::sim::{Backend, Simulation};
use crate::verify::cases::crossing::bare_crossing;
use std::time::Instant;

/// Names of the rows of ORCA and of RVO, and people per square metre.
const ROWS: [([&str; 2], f32); 5] = [
    (["orca_0.5", "rvo_0.5"], 0.5),
    (["orca_1", "rvo_1"], 1.0),
    (["orca_2", "rvo_2"], 2.0),
    (["orca_3", "rvo_3"], 3.0),
    (["orca_3.5", "rvo_3.5"], 3.5),
];
/// Steps before the first that counts: 5 s, in which the two streams mix.
const MIXING: u32 = 150;
/// Steps timed together.
const BATCH: u32 = 5;

/// Times steps of both models at all densities; rows, crowds after [`MIXING`] steps, and the device.
pub(super) fn models(
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, Vec<Quality>, String), crate::Error> {
    let (mut rows, mut qualities, mut name) = (Vec::new(), Vec::new(), String::new());
    for (names, density) in ROWS {
        let walking = |model: u32| -> Result<Simulation, crate::Error> {
            let mut store = bare(bare_crossing(agents, density.recip().sqrt()));
            store.step.model = model;
            let mut simulation = Simulation::from_store(store, backend, device)?;
            simulation.step(MIXING)?;
            Ok(simulation)
        };
        let mut walked = [walking(0)?, walking(1)?];
        for (row, simulation) in names.into_iter().zip(&mut walked) {
            qualities.push(quality_of(row, agents, simulation)?);
        }
        let mut times = [Vec::new(), Vec::new()];
        let begin = Instant::now();
        while times[0].len() < RUNS.0 || (times[0].len() < RUNS.1 && begin.elapsed() < RUNS.2) {
            for (simulation, times) in walked.iter_mut().zip(&mut times) {
                let begin = Instant::now();
                simulation.step(BATCH)?;
                simulation.finish()?;
                times.push(begin.elapsed().as_secs_f64() * 1e3 / f64::from(BATCH));
            }
        }
        for ((row, simulation), times) in names.into_iter().zip(&mut walked).zip(times) {
            rows.push(Row::new(row, agents, times));
            name = simulation.device();
        }
    }
    Ok((rows, qualities, name))
}
