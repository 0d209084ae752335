//! The whole of `gaitway verify`: every kernel on all sides, then a crowd.

use super::Expected;
use super::cases::{self, Case};
pub use super::crowd::CrowdRow;
use super::crowd::trajectory;
use super::numerics::is_host_exact;
use super::sides::{Found, Side, merge};
pub use super::sides::{KernelRow, SideRow};
#[cfg(feature = "vulkan")]
use crate::gpu::{Engine, Probe};
use crate::kernels::KernelId;
use crate::lanes;
use serde::Serialize;
use std::time::Instant;

/// What a device is: none in a build without Vulkan.
#[cfg(feature = "vulkan")]
#[doc(hidden)]
pub type Device = std::sync::Arc<crate::gpu::Device>;
/// What a device is: none in a build without Vulkan.
#[cfg(not(feature = "vulkan"))]
#[doc(hidden)]
#[derive(Debug)]
pub enum Device {}

/// Sizes that every kernel is tried at: none, one, about a workgroup, many.
#[doc(hidden)]
pub const SIZES: [usize; 7] = [0, 1, 63, 64, 65, 1_000, 20_000];
/// The same for `--quick`.
#[doc(hidden)]
pub const QUICK_SIZES: [usize; 6] = [0, 1, 63, 64, 65, 1_000];
/// Agents of the crowd.
#[doc(hidden)]
pub const CROWD_AGENTS: usize = 10_000;

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
    /// What the probe of the device's arithmetic took, seconds.
    pub probe_seconds: f64,
}

/// The outcome.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Device, if there is one.
    pub device: Option<String>,
    /// How it computed the kernels.
    pub arithmetic: Option<ArithmeticRow>,
    /// The widest vectors of this computer.
    pub lanes: &'static str,
    /// Whether this computer's own arithmetic, which lanes and twins run on, is that of IEEE 754.
    pub host_is_exact: bool,
    /// Seed of all inputs.
    pub seed: u32,
    /// Every kernel that more than the twin computes.
    pub kernels: Vec<KernelRow>,
    /// The others: without a device, those that lanes do not run.
    pub not_compared: Vec<&'static str>,
    /// The crowd.
    pub crowd: CrowdRow,
    /// Whether everything is as it must be.
    pub pass: bool,
    /// Seconds it took.
    pub wall_seconds: f64,
}

/// Compares everything: a device, if one is given, and lanes with the twins. Calls `progress` with the current comparison and
/// the fraction done.
///
/// # Errors
/// When the device fails, or a kernel has no case ([`crate::Error::Usage`]): nothing may go unverified.
pub fn verify(
    device: Option<&Device>,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Report, crate::Error> {
    let begin = Instant::now();
    progress("arithmetic", 0.0);
    let arithmetic = device.map(arithmetic).transpose()?;
    let mut found = Vec::new();
    for case in [cases::arithmetic(cases::PROBED), cases::functions(cases::PROBED)] {
        compare(device, &case, &mut found)?;
    }
    for (number, &size) in options.sizes.iter().enumerate() {
        let is_wanted = |case: &Case| {
            !case.dispatches.iter().any(|dispatch| options.without.contains(&dispatch.kernel()))
        };
        for case in cases::all(size, options.seed).into_iter().filter(is_wanted) {
            #[allow(clippy::cast_precision_loss, reason = "a handful of sizes")]
            progress(&format!("kernels, {size} agents"), 0.5 * number as f64 / options.sizes.len() as f64);
            compare(device, &case, &mut found)?;
        }
    }
    let crowd = trajectory(device, options, progress)?;
    let is_found = |id: &KernelId| found.iter().any(|one| one.kernel == *id);
    let wanted = KernelId::ALL.into_iter().filter(|id| !options.without.contains(id));
    let left: Vec<KernelId> = wanted.filter(|id| !is_found(id)).collect();
    if let Some(missing) = left.iter().find(|id| device.is_some() || lanes::has(**id)) {
        return Err(crate::Error::Usage {
            message: format!("kernel {} has no case: it was not verified", missing.kernel().name),
            hint: "add it to verify::cases; every kernel must be compared with its twin".to_owned(),
        });
    }
    found.sort_by_key(|one| one.kernel);
    let kernels: Vec<KernelRow> = found.into_iter().map(KernelRow::from).collect();
    let host_is_exact = is_host_exact();
    let pass = host_is_exact && kernels.iter().all(|kernel| kernel.pass) && crowd.pass;
    Ok(Report {
        #[cfg(feature = "vulkan")]
        device: device.map(|device| device.describe()),
        #[cfg(not(feature = "vulkan"))]
        device: None,
        arithmetic,
        lanes: lanes::OnCpu::Lanes.name(),
        host_is_exact,
        seed: options.seed,
        kernels,
        not_compared: left.into_iter().map(|id| id.kernel().name).collect(),
        crowd,
        pass,
        wall_seconds: begin.elapsed().as_secs_f64(),
    })
}

/// Compares the kernels of a case on all sides; each starts from the twins' state.
#[cfg_attr(
    not(feature = "vulkan"),
    allow(unused_variables, clippy::unnecessary_wraps, reason = "no device fails")
)]
fn compare(device: Option<&Device>, case: &Case, found: &mut Vec<Found>) -> Result<(), crate::Error> {
    #[cfg(feature = "vulkan")]
    let mut engine = match device {
        Some(device) => Some(Engine::new(device, &case.store, &super::device::kernels_of(&case.dispatches))?),
        None => None,
    };
    for expected in Expected::of(&case.store, &case.dispatches) {
        #[cfg(feature = "vulkan")]
        if let Some(engine) = &mut engine {
            merge(found, Side::Device, expected.compare(engine, |_, _| ())?, &case.name);
        }
        for (isa, comparison) in expected.by_lanes() {
            merge(found, Side::Lanes(isa), comparison, &case.name);
        }
    }
    Ok(())
}

#[cfg(feature = "vulkan")]
fn arithmetic(device: &Device) -> Result<ArithmeticRow, crate::Error> {
    let begin = Instant::now();
    let native = Probe::of_native(device)?;
    Ok(ArithmeticRow {
        taken: device.arithmetic()?.to_string(),
        native: native.to_string(),
        native_is_exact: native.is_exact(),
        flushes_subnormals: native.flushes_subnormals,
        probe_seconds: begin.elapsed().as_secs_f64(),
    })
}

#[cfg(not(feature = "vulkan"))]
fn arithmetic(device: &Device) -> Result<ArithmeticRow, crate::Error> {
    match *device {}
}

#[cfg(test)]
mod tests {
    use super::*;

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
