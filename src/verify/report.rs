//! The whole of `gaitway verify`: every kernel against its CPU twin, then a crowd on both sides.

use super::cases::{self, Case};
use super::{CASES, Comparison, Numerics, compare_dispatches, numerics};
use crate::gpu::Device;
use crate::kernels::{KernelId, Store};
use crate::sim::{Backend, FELT, STATE, Simulation, measure::state_hash, order};
use serde::Serialize;
use std::sync::Arc;
use std::time::Instant;

/// Sizes that every kernel is tried at: none, one, about a workgroup, many.
#[doc(hidden)]
pub const SIZES: [usize; 7] = [0, 1, 63, 64, 65, 1_000, 20_000];
/// The same for `--quick`.
#[doc(hidden)]
pub const QUICK_SIZES: [usize; 6] = [0, 1, 63, 64, 65, 1_000];
/// Agents of the crowd.
#[doc(hidden)]
pub const CROWD_AGENTS: usize = 10_000;
/// Steps between two comparisons of the crowd.
const STRIDE: u32 = 20;

/// What to try.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Options {
    /// Sizes for the kernels, agents.
    pub sizes: Vec<usize>,
    /// Agents of the crowd.
    pub crowd_agents: usize,
    /// Steps of the crowd.
    pub crowd_steps: u32,
    /// Seed of all inputs.
    pub seed: u32,
    /// Kernels that are left out, with every case that they are in.
    pub without: Vec<KernelId>,
}

impl Options {
    /// Everything, in a minute or so.
    pub fn full() -> Self {
        Self {
            sizes: SIZES.to_vec(),
            crowd_agents: CROWD_AGENTS,
            crowd_steps: 300,
            seed: 1,
            without: Vec::new(),
        }
    }

    /// Smaller sizes and a third of the steps.
    pub fn quick() -> Self {
        Self { sizes: QUICK_SIZES.to_vec(), crowd_steps: 100, ..Self::full() }
    }
}

/// How far a kernel may be from its twin on a device whose arithmetic is not exact, and why.
///
/// On an exact device it is 0. Integers must be equal everywhere; the unit is that of the kernel's floats.
#[derive(Debug, Clone, Copy, PartialEq)]
#[doc(hidden)]
pub struct Tolerance {
    /// Largest difference.
    pub value: f32,
    /// Its unit.
    pub unit: &'static str,
    /// Where it comes from.
    pub reason: &'static str,
}

/// The tolerance of each kernel on a device that is not exact.
#[doc(hidden)]
pub const fn tolerance(kernel: KernelId) -> Tolerance {
    let (value, unit, reason) = match kernel {
        KernelId::GaitFeatures => {
            // third differences over a step of 1/80 s: a rounding error of 1e-7 m becomes 0.05 m/s3, and its mean less
            (0.1, "m, s, deg", "differences of positions, up to the third, over short steps of time")
        }
        KernelId::Flow => {
            (0.5, "m", "a root per cell, and which neighbour is lower may change along a ridge")
        }
        KernelId::FlowDensity => (1e-4, "m", "one quotient per cell"),
        KernelId::Spawn => (0.0, "m", "copies of places; who is near is a comparison of squares"),
        KernelId::AdvanceJourney => (1e-4, "m", "places in regions of up to a kilometre"),
        KernelId::GridPack => (1e-6, "m", "copies, one sum"),
        KernelId::FollowPaths => (1e-3, "m, m/s", "quotients of times, times metres of a path"),
        KernelId::EmotionGather => (1e-5, "", "sums of rounded shares"),
        KernelId::EmotionUpdate => (1e-5, "", "exponentials"),
        KernelId::EmotionApply => (1e-5, "m, m/s", "sums of four products"),
        KernelId::Numerics => (3.0, "ULP", "Vulkan allows 2.5 ULP for a division"),
        KernelId::Teleport => (1e-5, "m", "one product and one sum"),
        KernelId::LeadAgents => (1e-5, "m, m/s, rad", "one product and one arc tangent"),
        KernelId::Prefer => (1e-5, "m/s", "one division by a distance, times a speed of a few m/s"),
        KernelId::GroupCohesion => {
            (1e-5, "m/s", "a root, an arc tangent and quotients by distances within a group")
        }
        KernelId::VelocityOrca => {
            (1e-4, "m/s", "quotients of a linear programme, amplified where lines are nearly parallel")
        }
        KernelId::VelocityRvo => {
            // the choice is among some velocities a tenth of a m/s apart: a tie may fall either way
            (0.5, "m/s", "a choice among samples: where two cost nearly the same, another one may win")
        }
        KernelId::ClipToWalls => {
            (1e-3, "m/s", "a comparison with a wall: by rounding an agent may be held or not")
        }
        KernelId::Elevate => (1e-4, "m", "a plane at a point up to 100 m away"),
        KernelId::Interpolate => {
            (1e-4, "m, rad", "one product and one sum, world coordinates of up to 100 m")
        }
        KernelId::Stand => (1e-5, "m", "a quotient of a few metres"),
        KernelId::Unjam => (
            3.0,
            "m/s, s, m",
            "a decision (has it waited long enough, is a wall ahead): by rounding it may come a step later",
        ),
        KernelId::Integrate => (1e-5, "m, m/s, rad", "one step of a few centimetres, one arc tangent"),
        KernelId::Pose => (2e-6, "", "normalised quaternions: a root and a division"),
        KernelId::Gaze => (1e-4, "", "three rounds of arc tangents, roots and quotients"),
        KernelId::Palette => (1e-4, "m", "sixteen transforms in a row, world coordinates of up to 100 m"),
        KernelId::Skin => (1e-4, "m", "sums of four transforms, world coordinates of up to 100 m"),
        // a new kernel is exact until its own line says why not
        _ => (0.0, "", "integers and copies"),
    };
    Tolerance { value, unit, reason }
}

/// One kernel against its twin.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct KernelRow {
    /// Kernel.
    pub name: &'static str,
    /// Words compared.
    pub compared: usize,
    /// Words with equal bits.
    pub exact: usize,
    /// Largest difference; `null` in JSON where one side is not finite or an integer differs.
    pub max_error: f32,
    /// Largest difference allowed.
    pub tolerance: f32,
    /// Unit of both.
    pub unit: &'static str,
    /// Whether it is within the tolerance.
    pub pass: bool,
    /// The first difference: case, buffer, element, both values.
    pub first: Option<String>,
}

/// A crowd on both sides.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct CrowdRow {
    /// Agents.
    pub agents: usize,
    /// Steps.
    pub steps: u32,
    /// Whether the whole state is equal bit for bit after all of them.
    pub exact: bool,
    /// How it was compared: `trajectory` on an exact device, `single steps` elsewhere.
    pub method: &'static str,
    /// The first step after which the two were found to differ.
    pub differs_by_step: Option<u32>,
    /// Hash of the CPU's state at the end.
    pub state_hash: String,
    /// Whether it is as it must be on this device.
    pub pass: bool,
}

/// The outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Device.
    pub device: String,
    /// What its arithmetic does, in words.
    pub numerics: String,
    /// Seed of all inputs.
    pub seed: u32,
    /// Every kernel.
    pub kernels: Vec<KernelRow>,
    /// The crowd.
    pub crowd: CrowdRow,
    /// Whether everything is as it must be.
    pub pass: bool,
    /// Seconds it took.
    pub wall_seconds: f64,
}

/// Compares everything. Calls `progress` with the current comparison and the fraction done.
///
/// # Errors
/// When the device fails, or a kernel has no case ([`crate::Error::Usage`]): nothing may go unverified.
pub fn verify(
    device: &Arc<Device>,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Report, crate::Error> {
    let begin = Instant::now();
    progress("arithmetic", 0.0);
    let arithmetic = numerics(device)?;
    let mut found = vec![numerics_row(&arithmetic)];
    for (number, &size) in options.sizes.iter().enumerate() {
        let is_wanted = |case: &Case| {
            !case.dispatches.iter().any(|dispatch| options.without.contains(&dispatch.kernel()))
        };
        for case in cases::all(size, options.seed).into_iter().filter(is_wanted) {
            #[allow(clippy::cast_precision_loss, reason = "a handful of sizes")]
            progress(&format!("kernels, {size} agents"), 0.5 * number as f64 / options.sizes.len() as f64);
            let compared = compare_dispatches(device, &case.store, &case.dispatches)?;
            merge(&mut found, compared, &case.name);
        }
    }
    let crowd = if arithmetic.exact {
        trajectory(device, options, progress)?
    } else {
        single_steps(device, options, &mut found, progress)?
    };
    if let Some(missing) = KernelId::ALL
        .into_iter()
        .find(|id| !options.without.contains(id) && !found.iter().any(|c| c.kernel == *id))
    {
        return Err(crate::Error::Usage {
            message: format!("kernel {} has no case: it was not verified", missing.kernel().name),
            hint: "add it to verify::cases; every kernel must be compared with its twin".to_owned(),
        });
    }
    found.sort_by_key(|comparison| comparison.kernel);
    let kernels: Vec<KernelRow> =
        found.into_iter().map(|comparison| row(comparison, arithmetic.exact)).collect();
    let pass = arithmetic.is_host_exact && kernels.iter().all(|kernel| kernel.pass) && crowd.pass;
    Ok(Report {
        device: device.describe(),
        numerics: arithmetic.to_string(),
        seed: options.seed,
        kernels,
        crowd,
        pass,
        wall_seconds: begin.elapsed().as_secs_f64(),
    })
}

fn numerics_row(numerics: &Numerics) -> Comparison {
    let compared = CASES as usize * 16;
    #[allow(clippy::cast_precision_loss, reason = "units in the last place, for people")]
    let max_error = numerics.division_ulp.max(numerics.square_root_ulp) as f32;
    Comparison {
        kernel: KernelId::Numerics,
        compared,
        exact: compared.saturating_sub(numerics.different as usize),
        max_error,
        first: (numerics.different > 0).then(|| numerics.to_string()),
    }
}

/// Adds the outcome of a case.
fn merge(found: &mut Vec<Comparison>, case: Vec<Comparison>, name: &str) {
    for mut new in case {
        new.first = new.first.map(|first| format!("{name}: {first}"));
        match found.iter_mut().find(|old| old.kernel == new.kernel) {
            Some(old) => old.merge(new),
            None => found.push(new),
        }
    }
}

fn row(comparison: Comparison, is_exact: bool) -> KernelRow {
    let tolerance = tolerance(comparison.kernel);
    let value = if is_exact { 0.0 } else { tolerance.value };
    let pass = comparison.exact == comparison.compared || (!is_exact && comparison.max_error <= value);
    KernelRow {
        name: comparison.kernel.kernel().name,
        compared: comparison.compared,
        exact: comparison.exact,
        max_error: comparison.max_error,
        tolerance: value,
        unit: tolerance.unit,
        pass,
        first: comparison.first,
    }
}

/// Steps the same crowd on both sides and compares whole states: with every model of avoidance for its share of the steps.
fn trajectory(
    device: &Arc<Device>,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<CrowdRow, crate::Error> {
    let index = device.info().index.to_string();
    let mut walk = Walk::new(options);
    let mut differs_by_step = None;
    for model in order::MODELS {
        let start = walk.start(model);
        let mut gpu = Simulation::from_store(start.clone(), Backend::Vulkan, Some(&index))?;
        let mut cpu = Simulation::from_store(start, Backend::Cpu, None)?;
        while let Some(count) = walk.stride(differs_by_step, progress) {
            gpu.step(count)?;
            cpu.step(count)?;
            walk.done += count;
            if !same_state(cpu.state()?, gpu.state()?) {
                differs_by_step = Some(walk.done);
            }
        }
        walk.store = cpu.state()?.clone();
    }
    Ok(CrowdRow {
        exact: differs_by_step.is_none(),
        method: "trajectory",
        differs_by_step,
        pass: differs_by_step.is_none(),
        ..walk.row()
    })
}

/// How far the crowd of a verification has come.
struct Walk<'a> {
    options: &'a Options,
    store: Store,
    /// Steps done, and of those to be done with the present model.
    done: u32,
    until: u32,
}

impl<'a> Walk<'a> {
    fn new(options: &'a Options) -> Self {
        Self { options, store: cases::everything(options.crowd_agents, options.seed), done: 0, until: 0 }
    }

    /// Goes on with a model of avoidance, and says from where.
    fn start(&mut self, model: u32) -> Store {
        self.store.step.model = model;
        self.until = self.options.crowd_steps * (model + 1) / order::MODELS.end;
        self.store.clone()
    }

    /// Steps to the next comparison, if there is one with this model and nothing has differed yet.
    fn stride(&self, differs: Option<u32>, progress: &mut dyn FnMut(&str, f64)) -> Option<u32> {
        let Options { crowd_agents, crowd_steps, .. } = self.options;
        let share = f64::from(self.done) / f64::from((*crowd_steps).max(1));
        progress(&format!("crowd of {crowd_agents} agents, step {}", self.done), 0.5 + 0.5 * share);
        let count = STRIDE.min(self.until.saturating_sub(self.done));
        (count > 0 && differs.is_none()).then_some(count)
    }

    /// What is to be said of it, whether all is well apart.
    fn row(&self) -> CrowdRow {
        CrowdRow {
            agents: self.options.crowd_agents,
            steps: self.done,
            exact: false,
            method: "",
            differs_by_step: None,
            state_hash: format!("{:016x}", state_hash(&self.store)),
            pass: false,
        }
    }
}

/// Whether everything that a step carries on has equal bits.
fn same_state(cpu: &Store, gpu: &Store) -> bool {
    STATE.into_iter().chain(FELT).all(|buffer| cpu.bytes(buffer) == gpu.bytes(buffer))
}

/// Compares single steps from states along the CPU's trajectory: rounding differs, so trajectories part.
fn single_steps(
    device: &Arc<Device>,
    options: &Options,
    found: &mut Vec<Comparison>,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<CrowdRow, crate::Error> {
    let mut walk = Walk::new(options);
    let mut crowd: Vec<Comparison> = Vec::new();
    for model in order::MODELS {
        let mut cpu = Simulation::from_store(walk.start(model), Backend::Cpu, None)?;
        while let Some(count) = walk.stride(None, progress) {
            let state = cpu.state()?;
            let compared = compare_dispatches(device, state, &order::step_dispatches(&state.step))?;
            merge(&mut crowd, compared, &format!("crowd, step {}", walk.done));
            cpu.step(count)?;
            walk.done += count;
        }
        walk.store = cpu.state()?.clone();
    }
    let pass = crowd.iter().all(|comparison| row(comparison.clone(), false).pass);
    merge(found, crowd, "single steps");
    Ok(CrowdRow { method: "single steps", pass, ..walk.row() })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(exact: usize, max_error: f32) -> Comparison {
        Comparison { kernel: KernelId::Integrate, compared: 100, exact, max_error, first: None }
    }

    #[test]
    fn an_exact_device_is_allowed_no_difference_and_another_no_more_than_the_tolerance() {
        let allowed = tolerance(KernelId::Integrate).value;
        assert!(row(comparison(100, 0.0), true).pass);
        assert!(!row(comparison(99, 1e-9), true).pass);
        assert!(row(comparison(99, allowed), false).pass);
        assert!(!row(comparison(99, allowed * 2.0), false).pass);
        assert!(!row(comparison(99, f32::INFINITY), false).pass, "an integer that differs");
    }

    #[test]
    fn cases_add_up_and_the_first_difference_is_kept_with_its_case() {
        let mut found = vec![comparison(100, 0.0)];
        let with = |first: &str| Comparison { first: Some(first.to_owned()), ..comparison(98, 0.5) };
        merge(&mut found, vec![with("a")], "one");
        merge(&mut found, vec![with("b")], "two");
        assert_eq!((found[0].compared, found[0].exact, found[0].max_error), (300, 296, 0.5));
        assert_eq!(found[0].first.as_deref(), Some("one: a"));
    }

    #[test]
    fn the_cases_of_a_size_reach_every_kernel_but_the_probe() {
        let reached: Vec<KernelId> = cases::all(65, 1)
            .iter()
            .flat_map(|case| case.dispatches.iter().map(crate::kernels::Dispatch::kernel))
            .collect();
        for kernel in KernelId::ALL.into_iter().filter(|id| *id != KernelId::Numerics) {
            assert!(reached.contains(&kernel), "{}", kernel.kernel().name);
        }
    }
}
