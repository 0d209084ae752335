//! `gaitway verify`: every kernel on this machine's own device and by its lanes against the twin.

use super::output::{say, say_json, table, thousands};
use super::progress::Progress;
use super::scene::size_of_crowd;
use super::usage;
use crate::Error;
use crate::kernels::KernelId;
use crate::spelling::suggestion;
use crate::verify::report::KernelRow;
use crate::verify::report::{CROWD_AGENTS, Device};
use crate::verify::{Options, Report, verify};
use clap::Args;

/// Most agents of a size: inputs and outputs of the animation fit every device's buffers.
const MOST: usize = 100_000;

/// Arguments of `gaitway verify`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway verify\n  gaitway verify --quick --device llvmpipe\n  gaitway verify \
                        --agents 0,1,5000 --json\n  gaitway verify --cpu\n\nEvery kernel is computed by the device, by the \
                        CPU's lanes and by its plain twin; which of them is wrong is said by the other two. Without a device \
                        lanes and twins are compared. Exit code 1 when any bit of a kernel's results, or of the \
                        crowd, differs from the CPU's."
)]
pub(super) struct Arguments {
    /// Sizes for the kernels, comma-separated [default: 0,1,63,64,65,1000,20000]
    #[arg(long, value_delimiter = ',', value_name = "LIST", value_parser = size_of_crowd)]
    agents: Vec<usize>,
    /// Agents of the crowd
    #[arg(long, default_value_t = CROWD_AGENTS, value_name = "N", value_parser = size_of_crowd)]
    crowd: usize,
    /// Without the largest size, and a third of the crowd's steps
    #[arg(long)]
    quick: bool,
    /// Leave out a kernel, with every case that it is in; may be repeated
    #[arg(long, value_name = "KERNEL", value_parser = kernel)]
    without: Vec<KernelId>,
    /// Seed of all inputs
    #[arg(long, default_value_t = 1)]
    seed: u32,
    /// Vulkan device: a part of its name, or its number in `gaitway devices`
    #[arg(long, value_name = "NAME", conflicts_with = "cpu")]
    device: Option<String>,
    /// Without a Vulkan device
    #[arg(long)]
    cpu: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

fn kernel(name: &str) -> Result<KernelId, String> {
    KernelId::ALL.into_iter().find(|id| id.kernel().name == name).ok_or_else(|| {
        let names: Vec<&str> = KernelId::ALL.iter().map(|id| id.kernel().name).collect();
        format!("no kernel has this name; {}", suggestion(name, &names, "they are"))
    })
}

/// Runs the subcommand; false when something differs that must not.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let mut options = if arguments.quick { Options::quick() } else { Options::full() };
    (options.seed, options.crowd_agents) = (arguments.seed, arguments.crowd);
    options.without.clone_from(&arguments.without);
    if !arguments.agents.is_empty() {
        options.sizes.clone_from(&arguments.agents);
    }
    let sizes = options.sizes.iter().map(|size| ("--agents", *size)).chain([("--crowd", arguments.crowd)]);
    if let Some((option, size)) = sizes.into_iter().find(|(_, size)| *size > MOST) {
        return Err(usage(
            format!("{option} {size}: a size is 0 to {MOST}"),
            "kernels differ, if at all, at small sizes",
        ));
    }
    let device = if arguments.cpu { None } else { open(arguments.device.as_deref())? };
    let mut progress = Progress::new("verifying");
    let report = verify(device.as_ref(), &options, &mut |what, share| progress.at(what, share))?;
    drop(progress);
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(report.pass)
}

/// The device, or none where this machine has no Vulkan and none is named.
#[cfg(feature = "vulkan")]
fn open(name: Option<&str>) -> Result<Option<Device>, Error> {
    use crate::gpu::{Validation, Wanted};
    match crate::gpu::Device::open(name, Validation::from_environment()?) {
        Ok(device) => Ok(Some(device)),
        Err(error) if Wanted::of(name) == Wanted::Best => {
            super::output::note(&format!("without a Vulkan device ({error}): lanes and twins are compared"));
            Ok(None)
        }
        Err(error) => Err(error.into()),
    }
}

#[cfg(not(feature = "vulkan"))]
fn open(name: Option<&str>) -> Result<Option<Device>, Error> {
    match name {
        None => Ok(None),
        Some(_) => Err(crate::sim::Error::NoVulkan.into()),
    }
}

fn print(report: &Report) {
    say(&format!("device      {}", report.device.as_deref().unwrap_or("none")));
    if let Some(arithmetic) = &report.arithmetic {
        say(&format!("arithmetic  {}; the device's own is {}", arithmetic.taken, arithmetic.native));
    }
    say(&format!("lanes       {}", report.lanes));
    if !report.host_is_exact {
        say(
            "            this computer's own arithmetic is not that of IEEE 754: there is nothing to compare with",
        );
    }
    say(&format!("seed        {}\n", report.seed));
    let rows: Vec<Vec<String>> = report.kernels.iter().map(row).collect();
    table(&["kernel", "beside the twin", "words compared", "different", "largest error", ""], &rows);
    if !report.not_compared.is_empty() {
        say(&format!("\nnot compared, since lanes do not run them: {}", report.not_compared.join(", ")));
    }
    let crowd = &report.crowd;
    let outcome = crowd.differs_by_step.map_or_else(
        || "equal bit for bit".to_owned(),
        |step| format!("DIFFERENT by step {step}: {}", crowd.differs.join(", ")),
    );
    say(&format!(
        "\ncrowd       {} agents, {} steps on all sides: {outcome} (hash {})",
        thousands(crowd.agents as u64),
        crowd.steps,
        crowd.state_hash
    ));
    crowd.first.iter().for_each(|first| say(&format!("  {first}")));
    for kernel in report.kernels.iter().filter(|kernel| !kernel.pass) {
        say(&format!("{}: wrong is {}", kernel.name, kernel.differs.join(", or ")));
        for side in kernel.sides.iter().filter(|side| side.exact < side.compared) {
            say(&format!("  {}: {}", side.side, side.first.as_deref().unwrap_or("no difference recorded")));
        }
    }
    say(&format!("result      {}", if report.pass { "pass" } else { "FAIL" }));
    say(&format!("wall time   {:.1} s", report.wall_seconds));
}

fn row(kernel: &KernelRow) -> Vec<String> {
    let lanes = kernel.sides.iter().filter(|side| side.side != "device").count();
    let device = kernel.sides.len() - lanes;
    let beside = match (device, lanes) {
        (0, lanes) => format!("{lanes} lanes"),
        (_, 0) => "device".to_owned(),
        (_, lanes) => format!("device, {lanes} lanes"),
    };
    let compared: usize = kernel.sides.iter().map(|side| side.compared).sum();
    let exact: usize = kernel.sides.iter().map(|side| side.exact).sum();
    let error = kernel.sides.iter().map(|side| side.max_error).fold(0.0, f32::max);
    vec![
        kernel.name.to_owned(),
        beside,
        thousands(compared as u64),
        thousands((compared - exact) as u64),
        if kernel.pass { "exact".to_owned() } else { format!("{error:.3e}") },
        if kernel.pass { "pass" } else { "FAIL" }.to_owned(),
    ]
}
