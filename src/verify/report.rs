//! The whole of `gaitway verify`: every kernel against its CPU twin, then a crowd on both sides.

use super::cases::{self, Case};
use super::numerics::is_host_exact;
use super::{Comparison, compare_dispatches};
use crate::gpu::{Device, Probe};
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
    /// Whether all are equal.
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
    /// The first step after which the two were found to differ.
    pub differs_by_step: Option<u32>,
    /// Hash of the CPU's state at the end.
    pub state_hash: String,
    /// Whether the whole state is equal bit for bit after all of them.
    pub pass: bool,
}

/// How the kernels were computed, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ArithmeticRow {
    /// `native`: the device's own. `careful (division, ...)`: careful code for what stands behind.
    pub taken: String,
    /// What the device's own arithmetic does, in words.
    pub native: String,
    /// Whether all of the device's own operations give the bits of IEEE 754, subnormal numbers apart.
    pub native_is_exact: bool,
    /// Whether the device takes subnormal numbers for zero.
    pub flushes_subnormals: bool,
    /// Whether this computer's own arithmetic, which the twins run on, is that of IEEE 754.
    pub host_is_exact: bool,
    /// What the probe of the device's arithmetic took, seconds.
    pub probe_seconds: f64,
}

/// The outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Device.
    pub device: String,
    /// How the kernels were computed.
    pub arithmetic: ArithmeticRow,
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
    let arithmetic = arithmetic(device)?;
    let mut found = Vec::new();
    for case in [cases::arithmetic(cases::PROBED), cases::functions(cases::PROBED)] {
        merge(&mut found, compare_dispatches(device, &case.store, &case.dispatches)?, &case.name);
    }
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
    let crowd = trajectory(device, options, progress)?;
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
    let kernels: Vec<KernelRow> = found.into_iter().map(row).collect();
    let pass = arithmetic.host_is_exact && kernels.iter().all(|kernel| kernel.pass) && crowd.pass;
    Ok(Report {
        device: device.describe(),
        arithmetic,
        seed: options.seed,
        kernels,
        crowd,
        pass,
        wall_seconds: begin.elapsed().as_secs_f64(),
    })
}

fn arithmetic(device: &Arc<Device>) -> Result<ArithmeticRow, crate::Error> {
    let begin = Instant::now();
    let native = Probe::of_native(device)?;
    Ok(ArithmeticRow {
        taken: device.arithmetic()?.to_string(),
        native: native.to_string(),
        native_is_exact: native.is_exact(),
        flushes_subnormals: native.flushes_subnormals,
        host_is_exact: is_host_exact(),
        probe_seconds: begin.elapsed().as_secs_f64(),
    })
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

fn row(comparison: Comparison) -> KernelRow {
    let Comparison { kernel, compared, exact, max_error, first } = comparison;
    KernelRow { name: kernel.kernel().name, compared, exact, max_error, pass: exact == compared, first }
}

/// Steps the same crowd on both sides and compares whole states: with every model of avoidance for its share of the steps.
fn trajectory(
    device: &Arc<Device>,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<CrowdRow, crate::Error> {
    let mut walk = Walk::new(options);
    let mut differs_by_step = None;
    for model in order::MODELS {
        let start = walk.start(model);
        let mut gpu = Simulation::on_device(start.clone(), device)?;
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
        agents: options.crowd_agents,
        steps: walk.done,
        differs_by_step,
        state_hash: format!("{:016x}", state_hash(&walk.store)),
        pass: differs_by_step.is_none(),
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
}

/// Whether everything that a step carries on has equal bits.
fn same_state(cpu: &Store, gpu: &Store) -> bool {
    STATE.into_iter().chain(FELT).all(|buffer| cpu.bytes(buffer) == gpu.bytes(buffer))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn comparison(exact: usize, max_error: f32) -> Comparison {
        Comparison { kernel: KernelId::Integrate, compared: 100, exact, max_error, first: None }
    }

    #[test]
    fn no_kernel_is_allowed_any_difference() {
        assert!(row(comparison(100, 0.0)).pass);
        assert!(!row(comparison(99, 1e-9)).pass);
        assert!(!row(comparison(99, f32::INFINITY)).pass, "an integer that differs");
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
    fn the_cases_of_a_size_reach_every_kernel_but_the_probes() {
        let reached: Vec<KernelId> = cases::all(65, 1)
            .iter()
            .flat_map(|case| case.dispatches.iter().map(crate::kernels::Dispatch::kernel))
            .collect();
        for kernel in
            KernelId::ALL.into_iter().filter(|id| !matches!(id, KernelId::Arithmetic | KernelId::Numerics))
        {
            assert!(reached.contains(&kernel), "{}", kernel.kernel().name);
        }
    }
}
