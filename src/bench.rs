//! How fast it is: every kernel by name, and the whole step, on either backend, from seeded crowds.
//!
//! Kernels are timed within their sequence (some of them use up what the one before made): on Vulkan by the device's
//! own timestamps, on the CPU by the clock. A device without timestamps runs each kernel by itself, timed by the clock,
//! submission and wait included. A whole step is timed by the clock, in batches.

use crate::kernels::{KernelId, Phase, Store};
use crate::sim::{Backend, Simulation};
use crate::verify::cases::crossing::{bare_crossing, crossing};
use crate::verify::cases::uneven::{clustered, storeys};
use serde::Serialize;
use std::time::Instant;

mod crowds;
mod field;
mod goals;
#[cfg(feature = "vulkan")]
mod light;
mod measured;
mod models;
#[cfg(feature = "vulkan")]
mod occlusion;
#[cfg(feature = "cli")]
pub(crate) mod peers;
mod runs;
mod sequence;
#[cfg(feature = "vulkan")]
mod stereo;

pub use crowds::Quality;
pub use goals::Goal;
pub use runs::Row;
pub use sequence::Sequence;

use crowds::{SPACING, bare, plain, quality_of};
use runs::{WARM_UP, repeat};
use sequence::EXTRAS;

/// Kernels that only some steps run, each timed in a step that runs it.
const OTHERS: [KernelId; 8] = [
    KernelId::GroupCohesion,
    KernelId::Elevate,
    KernelId::Spawn,
    KernelId::Queue,
    KernelId::React,
    KernelId::Teleport,
    KernelId::PoseFar,
    KernelId::Measure,
];
/// What is timed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Workload {
    /// The kernels of a simulation step of agents without bodies, and the step as a whole.
    #[default]
    Crossing,
    /// The same with half of the people within an eighth of the area.
    Clustered,
    /// The same on two storeys, one above the other.
    Storeys,
    /// The crossing's kernels with bodies, the animation of all agents in that crowd, flow fields over as many cells, the features of as many gaits, and the
    /// arithmetic probe: every kernel.
    All,
    /// Both eyes of a user in front of the crowd, in one pass, in two, and as two frames (see the rows' names).
    Stereo,
    /// Frames with and without occlusion culling, from within the crowd, before and above it.
    Occlusion,
    /// Pictures of the scene `crossing` at low, medium and high quality, from the user's eyes and from above.
    Light,
    /// The flow fields of a goal over squares of as many cells of 0.5 m (see the rows' names).
    Field,
    /// Steps and pictures of 10,000, 100,000 and 1,000,000 people against this project's goals for a large GPU.
    Goals,
    /// Steps of ORCA and of RVO in alternation, at 0.5 to 3.5 people per square metre (see the rows' names).
    Models,
    /// Ten seconds of steps, with and without the measures of `gaitway simulate` (see the rows' names).
    Measured,
}

/// The outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Device.
    pub device: String,
    /// Why the CPU was used although Vulkan was tried.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fallback: Option<String>,
    /// Whether the program was compiled with optimisation; numbers of a debug build mean little on the CPU.
    pub optimised: bool,
    /// The crossing is the same every time; its seed is part of its definition.
    pub seed: u32,
    /// Measurements.
    pub rows: Vec<Row>,
    /// The crowds of the rows that time whole steps.
    pub quality: Vec<Quality>,
    /// The goals of [`Workload::Goals`].
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub goals: Vec<Goal>,
    /// Seconds it took.
    pub wall_seconds: f64,
}

/// Times crowds beside one another: rows, crowds and the device.
type Compared = fn(usize, Backend, Option<&str>) -> Result<(Vec<Row>, Vec<Quality>, String), crate::Error>;

/// Times `workload` at every size. Calls `progress` with the current row and the fraction done.
///
/// # Errors
/// When a Vulkan device is demanded but cannot be used, fails, or a size does not fit it.
pub fn bench(
    workload: Workload,
    sizes: &[usize],
    backend: Backend,
    device: Option<&str>,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Report, crate::Error> {
    let begin = Instant::now();
    let (mut rows, mut quality, mut goals) = (Vec::new(), Vec::new(), Vec::new());
    let (mut name, mut fallback) = (String::new(), None);
    for (number, &agents) in sizes.iter().enumerate() {
        #[allow(clippy::cast_precision_loss, reason = "a handful of sizes")]
        let share = |part: f64| (number as f64 + part) / sizes.len() as f64;
        if matches!(workload, Workload::Stereo | Workload::Occlusion | Workload::Light) {
            progress(&format!("pictures, {agents} agents"), share(0.0));
            let (timed, device) = pictures(workload, agents, backend, device)?;
            name = device;
            rows.extend(timed);
            continue;
        }
        if workload == Workload::Field {
            progress(&format!("ways, {agents} cells"), share(0.0));
            let (timed, device) = field::field(agents, backend, device)?;
            name = device;
            rows.extend(timed);
            continue;
        }
        if matches!(workload, Workload::Models | Workload::Measured) {
            let (title, time): (_, Compared) = match workload {
                Workload::Models => ("models", models::models),
                _ => ("measures", measured::measured),
            };
            progress(&format!("{title}, {agents} agents"), share(0.0));
            let (timed, crowds, device) = time(agents, backend, device)?;
            name = device;
            rows.extend(timed);
            quality.extend(crowds);
            continue;
        }
        if workload == Workload::Goals {
            progress(&format!("goals, {agents} agents"), share(0.0));
            let measured = goals::goals(agents, backend, device)?;
            name = measured.device;
            rows.extend(measured.rows);
            quality.push(measured.quality);
            goals.extend(measured.goals);
            continue;
        }
        progress(&format!("step, {agents} agents"), share(0.0));
        let (row, seen, simulation) = whole_step(workload, agents, backend, device)?;
        name = simulation.device();
        fallback = simulation.fallback().map(str::to_owned);
        drop(simulation);
        rows.push(row);
        quality.push(seen);
        progress(&format!("kernels of a step, {agents} agents"), share(0.4));
        rows.extend(kernels(&mut Sequence::walk(walking(workload, agents), agents, backend, device)?)?);
        if workload == Workload::All {
            progress(&format!("kernels of a picture, {agents} agents"), share(0.7));
            for kernel in Sequence::ALTERNATIVES {
                let mut sequence = Sequence::with(kernel, agents, backend, device)?;
                let rows_of_it = kernels(&mut sequence)?;
                rows.extend(rows_of_it.into_iter().filter(|row| row.name == kernel.kernel().name));
            }
            rows.extend(kernels(&mut Sequence::picture(agents, backend, device)?)?);
            rows.extend(kernels(&mut Sequence::flow(agents, backend, device)?)?);
            let extras = kernels(&mut Sequence::extras(agents, backend, device)?)?;
            let is_new = |row: &Row| EXTRAS.iter().any(|kernel| kernel.kernel().name == row.name);
            rows.extend(extras.into_iter().filter(is_new));
            for kernel in OTHERS {
                let timed = kernels(&mut Sequence::with(kernel, agents, backend, device)?)?;
                rows.extend(timed.into_iter().filter(|row| row.name == kernel.kernel().name));
            }
            rows.extend(kernels(&mut Sequence::between(agents, backend, device)?)?);
            rows.extend(kernels(&mut Sequence::hidden(agents, backend, device)?)?);
            rows.extend(kernels(&mut Sequence::features(agents, backend, device)?)?);
            for kernel in [KernelId::Arithmetic, KernelId::Numerics] {
                rows.extend(kernels(&mut Sequence::probe(kernel, agents, backend, device)?)?);
            }
        }
    }
    let wall_seconds = begin.elapsed().as_secs_f64();
    let optimised = !cfg!(debug_assertions);
    goals.sort_by_key(|goal: &Goal| goal.name);
    Ok(Report { device: name, fallback, optimised, seed: 0, rows, quality, goals, wall_seconds })
}

/// Times pictures.
#[cfg(feature = "vulkan")]
fn pictures(
    workload: Workload,
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    match workload {
        Workload::Occlusion => occlusion::occlusion(agents, backend, device),
        Workload::Light => light::light(agents, backend, device),
        _ => stereo::stereo(agents, backend, device),
    }
}

/// Pictures need Vulkan.
#[cfg(not(feature = "vulkan"))]
fn pictures(
    _workload: Workload,
    _agents: usize,
    _backend: Backend,
    _device: Option<&str>,
) -> Result<(Vec<Row>, String), crate::Error> {
    Err(crate::Error::Usage {
        message: "pictures need Vulkan, which this program was built without".to_owned(),
        hint: "build with the feature `vulkan`".to_owned(),
    })
}

/// The crowd whose steps are timed.
fn walking(workload: Workload, agents: usize) -> Store {
    match workload {
        Workload::Clustered => bare(clustered(agents)),
        Workload::Storeys => bare(storeys(agents)),
        Workload::Crossing => bare(bare_crossing(agents, SPACING)),
        _ => plain(crossing(agents, SPACING)),
    }
}

/// Times whole steps of a workload's crowd.
fn whole_step(
    workload: Workload,
    agents: usize,
    backend: Backend,
    device: Option<&str>,
) -> Result<(Row, Quality, Simulation), crate::Error> {
    let mut simulation = Simulation::from_store(walking(workload, agents), backend, device)?;
    simulation.step(1)?;
    simulation.finish()?;
    let begin = Instant::now();
    simulation.step(1)?;
    simulation.finish()?;
    // a batch of about 50 ms
    let batch = (0.05 / begin.elapsed().as_secs_f64().max(1e-6)).clamp(1.0, 64.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 1 and 64")]
    let batch = batch as u32;
    simulation.step(batch)?;
    simulation.finish()?;
    let times = repeat(|| {
        let begin = Instant::now();
        simulation.step(batch)?;
        simulation.finish()?;
        Ok(begin.elapsed().as_secs_f64() * 1e3 / f64::from(batch))
    })?;
    let quality = quality_of("step", agents, &mut simulation)?;
    Ok((Row::new("step", agents, times), quality, simulation))
}

/// Times every kernel of a sequence, and the sequence as a whole where it has a name.
fn kernels(sequence: &mut Sequence) -> Result<Vec<Row>, crate::Error> {
    for _ in 0..WARM_UP {
        sequence.run()?;
    }
    let mut all: Vec<(&'static str, Vec<f64>)> = Vec::new();
    let totals = repeat(|| {
        let times = sequence.run()?;
        for (name, time) in by_name(&times) {
            match all.iter_mut().find(|(known, _)| *known == name) {
                Some((_, list)) => list.push(time),
                None => all.push((name, vec![time])),
            }
        }
        Ok(times.iter().map(|(_, time)| time).sum())
    })?;
    let agents = sequence.agents;
    let mut rows: Vec<Row> = all.into_iter().map(|(name, times)| Row::new(name, agents, times)).collect();
    if let Some(name) = sequence.name {
        rows.push(Row::new(name, agents, totals));
    }
    Ok(rows)
}

/// The time of each kernel, and behind it those of its phases if it has several, ms.
fn by_name(times: &[(Phase, f64)]) -> Vec<(&'static str, f64)> {
    let mut kernels: Vec<KernelId> = Vec::new();
    for (phase, _) in times {
        if !kernels.contains(&phase.kernel()) {
            kernels.push(phase.kernel());
        }
    }
    let mut rows = Vec::new();
    for kernel in kernels {
        let own = times.iter().filter(|(phase, _)| phase.kernel() == kernel);
        rows.push((kernel.kernel().name, own.clone().map(|(_, time)| time).sum()));
        if kernel.kernel().phases.len() > 1 {
            // the phase that is named as its kernel has no row of its own: what the others leave of the sum is its time
            let named = own.filter(|(phase, _)| phase.entry().label != kernel.kernel().name);
            rows.extend(named.map(|(phase, time)| (phase.entry().label, *time)));
        }
    }
    rows
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "numbers are copied")]
mod tests {
    use super::runs::RUNS;
    use super::*;

    #[test]
    fn every_kernel_is_timed_on_the_cpu() {
        let report = bench(Workload::All, &[200], Backend::Cpu, None, &mut |_, _| ()).unwrap();
        for kernel in KernelId::ALL {
            let name = kernel.kernel().name;
            let row = report.rows.iter().find(|row| row.name == name);
            let row = row.unwrap_or_else(|| panic!("{name} is not timed"));
            assert!(row.ms_min <= row.ms_median && row.ms_median <= row.ms_max && row.runs >= RUNS.0);
        }
        assert!(report.rows.iter().any(|row| row.name == "step" && row.agent_steps_per_second > 0.0));
        assert!(report.quality[0].progress > 0.5, "{:?}", report.quality);
    }

    #[test]
    fn the_median_of_no_runs_is_zero_and_of_three_the_middle() {
        assert_eq!(Row::new("x", 10, Vec::new()).ms_median, 0.0);
        let row = Row::new("x", 10, vec![3.0, 1.0, 2.0]);
        assert_eq!(
            (row.ms_min, row.ms_median, row.ms_max, row.agent_steps_per_second),
            (1.0, 2.0, 3.0, 5000.0)
        );
    }
}
