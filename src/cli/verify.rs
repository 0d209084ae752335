//! `gaitway verify`: every kernel against its twin on this machine's own device.

use super::output::{say, say_json, table, thousands};
use super::progress::Progress;
use super::scene::size_of_crowd;
use super::usage;
use crate::Error;
use crate::gpu::{Device, Validation};
use crate::kernels::KernelId;
use crate::spelling::suggestion;
use crate::verify::report::CROWD_AGENTS;
use crate::verify::{Options, Report, verify};
use clap::Args;

/// Most agents of a size: inputs and outputs of the animation fit every device's buffers.
const MOST: usize = 100_000;

/// Arguments of `gaitway verify`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway verify\n  gaitway verify --quick --device llvmpipe\n  gaitway verify \
                        --agents 0,1,5000 --json\n\nExit code 1 when any bit of a kernel's results, or of the \
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
    #[arg(long, value_name = "NAME")]
    device: Option<String>,
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
    let device = Device::open(arguments.device.as_deref(), Validation::from_environment()?)?;
    let mut progress = Progress::new("verifying");
    let report = verify(&device, &options, &mut |what, share| progress.at(what, share))?;
    drop(progress);
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(report.pass)
}

fn print(report: &Report) {
    say(&format!("device      {}", report.device));
    say(&format!(
        "arithmetic  {}; the device's own is {}",
        report.arithmetic.taken, report.arithmetic.native
    ));
    if !report.arithmetic.host_is_exact {
        say(
            "            this computer's own arithmetic is not that of IEEE 754: there is nothing to compare with",
        );
    }
    say(&format!("seed        {}\n", report.seed));
    let rows: Vec<Vec<String>> = report
        .kernels
        .iter()
        .map(|kernel| {
            vec![
                kernel.name.to_owned(),
                thousands(kernel.compared as u64),
                thousands((kernel.compared - kernel.exact) as u64),
                if kernel.pass { "exact".to_owned() } else { format!("{:.3e}", kernel.max_error) },
                if kernel.pass { "pass" } else { "FAIL" }.to_owned(),
            ]
        })
        .collect();
    table(&["kernel", "words compared", "different", "largest error", ""], &rows);
    let crowd = &report.crowd;
    let outcome = crowd
        .differs_by_step
        .map_or_else(|| "equal bit for bit".to_owned(), |step| format!("DIFFERENT by step {step}"));
    say(&format!(
        "\ncrowd       {} agents, {} steps on both sides: {outcome} (hash {})",
        thousands(crowd.agents as u64),
        crowd.steps,
        crowd.state_hash
    ));
    for kernel in report.kernels.iter().filter(|kernel| !kernel.pass) {
        say(&format!("{}: {}", kernel.name, kernel.first.as_deref().unwrap_or("no difference recorded")));
    }
    say(&format!("result      {}", if report.pass { "pass" } else { "FAIL" }));
    say(&format!("wall time   {:.1} s", report.wall_seconds));
}
