//! `gaitway bench`: how fast every kernel and the whole step are here.

use super::output::{note, rate, say, say_json, table, thousands};
use super::progress::Progress;
use super::scene::{PlaceArguments, size_of_crowd};
use super::usage;
use crate::Error;
use crate::bench::peers::{PYRVO, Peer, peers};
use crate::bench::{Report, Workload, bench};
use crate::scenario::MAX_AGENTS;
use crate::sim::Backend;
use clap::{Args, ValueEnum};

/// Arguments of `gaitway bench`.
#[derive(Debug, Args)]
#[command(after_help = "Examples:\n  gaitway bench --agents 10000\n  gaitway bench --workload all --agents \
                        1000,10000 --json\n  gaitway bench --backend cpu\n  gaitway bench --peers --agents 10000,100000\n\nThe crossing: one agent per square metre, \
                        two streams at right angles over a square whose opposite sides are joined. Clustered, there is one per two square metres. \
                        On two storeys there is one per square metre of each.")]
pub(super) struct Arguments {
    /// crossing: the kernels of a step, of agents without bodies; clustered: these with half of the people within an eighth of the area; storeys: on two
    /// storeys, one above the other; all: those of the crossing with bodies, of the animation and the probe; stereo: pictures for both eyes of
    /// a headset, in one pass, in two, and one after the other; occlusion: with and without hidden people; light: pictures
    /// of the scene `crossing` at low, medium and high quality; field: the
    /// ways over squares of as many cells of 0.5 m; models: steps of ORCA and of RVO in alternation, at several densities;
    /// measured: steps of the scene `crossing` with and without the measures of `simulate`;
    /// goals: what this project wants of a large GPU, with --agents 10000,100000,1000000
    #[arg(long, value_enum, default_value_t)]
    workload: WorkloadName,
    /// Sizes, comma-separated
    #[arg(
        long,
        value_delimiter = ',',
        value_name = "LIST",
        default_value = "1000,10000,100000",
        value_parser = size_of_crowd
    )]
    agents: Vec<usize>,
    /// Time other libraries as well, in turns over the same steps of the crossing: pyrvo, and what --peer names
    #[arg(long, conflicts_with = "workload")]
    peers: bool,
    /// The Python that has pyrvo [default: python3, without --peer]
    #[arg(long, value_name = "PROGRAM", requires = "peers")]
    python: Option<String>,
    /// Another peer: a program that answers as docs/speed.md says; may be repeated
    #[arg(long, value_name = "PROGRAM", requires = "peers")]
    peer: Vec<String>,
    #[command(flatten)]
    place: PlaceArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
enum WorkloadName {
    #[default]
    Crossing,
    Clustered,
    Storeys,
    All,
    Stereo,
    Occlusion,
    Light,
    Field,
    Models,
    Measured,
    Goals,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    if let Some(size) = arguments.agents.iter().find(|size| **size < 1 || **size > MAX_AGENTS as usize) {
        return Err(usage(
            format!("--agents {size}: a size is 1 to {MAX_AGENTS}"),
            "such as --agents 1000,10000",
        ));
    }
    if arguments.peers {
        return beside_peers(arguments);
    }
    let workload = match arguments.workload {
        WorkloadName::Crossing => Workload::Crossing,
        WorkloadName::Clustered => Workload::Clustered,
        WorkloadName::Storeys => Workload::Storeys,
        WorkloadName::All => Workload::All,
        WorkloadName::Occlusion => Workload::Occlusion,
        WorkloadName::Light => Workload::Light,
        WorkloadName::Stereo => Workload::Stereo,
        WorkloadName::Field => Workload::Field,
        WorkloadName::Models => Workload::Models,
        WorkloadName::Measured => Workload::Measured,
        WorkloadName::Goals => Workload::Goals,
    };
    let (backend, device) = arguments.place.get()?;
    let mut progress = Progress::new("timing");
    let report =
        bench(workload, &arguments.agents, backend, device, &mut |what, share| progress.at(what, share))?;
    drop(progress);
    if let Some(reason) = &report.fallback {
        note(&format!("note: timing the CPU, since {reason}"));
    }
    if arguments.json {
        say_json(&report)?;
    } else {
        print(&report);
    }
    Ok(true)
}

/// Times the crossing beside other libraries; on the CPU unless a device is asked for.
fn beside_peers(arguments: &Arguments) -> Result<bool, Error> {
    let (backend, device) = arguments.place.get()?;
    let backend = if backend == Backend::Auto && device.is_none() { Backend::Cpu } else { backend };
    let python = arguments.python.clone().or_else(|| arguments.peer.is_empty().then(|| "python3".to_owned()));
    let pyrvo = python.map(|python| vec![python, "-c".to_owned(), PYRVO.to_owned()]);
    let others = arguments.peer.iter().map(|program| vec![program.clone()]);
    let commands: Vec<Vec<String>> = pyrvo.into_iter().chain(others).collect();
    let mut progress = Progress::new("timing");
    let report =
        peers(&arguments.agents, &commands, backend, device, &mut |what, share| progress.at(what, share))?;
    drop(progress);
    if arguments.json {
        say_json(&report)?;
        return Ok(true);
    }
    say(&format!("machine    {}", report.machine));
    say(&format!("threads    {} each", report.threads));
    if !report.optimised {
        say("build      debug: use cargo build --release");
    }
    say("");
    let rows: Vec<Vec<String>> = report.rows.iter().map(peer_row).collect();
    let head =
        ["", "agents", "step ms", "(min)", "times", "(min)", "overlaps/agent", "nearest m", "progress m/s"];
    table(&head, &rows);
    Ok(true)
}

fn peer_row(peer: &Peer) -> Vec<String> {
    vec![
        peer.name.clone(),
        thousands(peer.agents as u64),
        format!("{:.3}", peer.ms_median),
        format!("({:.3})", peer.ms_min),
        format!("{:.2}", peer.times_median),
        format!("({:.2})", peer.times_min),
        format!("{:.4}", peer.overlapping),
        format!("{:.3}", peer.min_distance),
        format!("{:.3}", peer.progress),
    ]
}

fn print(report: &Report) {
    say(&format!("device     {}", report.device));
    say(&format!("seed       {}", report.seed));
    if !report.optimised {
        say("build      debug: numbers of the CPU side mean little; use cargo build --release");
    }
    say("");
    let rows: Vec<Vec<String>> = report
        .rows
        .iter()
        .map(|row| {
            vec![
                row.name.to_owned(),
                thousands(row.agents as u64),
                format!("{:.4}", row.ms_median),
                format!("{:.4}", row.ms_min),
                format!("{:.4}", row.ms_max),
                rate(row.agent_steps_per_second),
                row.runs.to_string(),
            ]
        })
        .collect();
    table(&["name", "agents", "median ms", "min ms", "max ms", "agents/s", "runs"], &rows);
    for agents in report.rows.iter().filter(|row| row.name == "stereo_one_pass").map(|row| row.agents) {
        let ms = |name| {
            report.rows.iter().find(|row| row.agents == agents && row.name == name).map(|row| row.ms_median)
        };
        if let (Some(one), Some(two), Some(pictures)) =
            (ms("stereo_one_pass"), ms("stereo_two_passes"), ms("stereo_two_pictures"))
        {
            let agents = thousands(agents as u64);
            say(&format!(
                "{agents} agents: one pass takes {:.2} of two passes, {:.2} of two pictures",
                one / two,
                one / pictures
            ));
        }
    }
    if !report.goals.is_empty() {
        print_goals(report);
    }
    if !report.quality.is_empty() {
        print_quality(report);
    }
    say(&format!("wall time  {:.1} s", report.wall_seconds));
}

fn print_goals(report: &Report) {
    say("\nGoals for a large GPU:");
    let rows: Vec<Vec<String>> = report
        .goals
        .iter()
        .map(|goal| {
            let bound = if goal.unit == "ms" { "at most" } else { "at least" };
            let met = if goal.is_met { "met" } else { "missed" };
            vec![
                goal.name.to_owned(),
                goal.what.clone(),
                format!("{:.3} {}", goal.value, goal.unit),
                format!("{bound} {}", goal.goal),
                met.to_owned(),
            ]
        })
        .collect();
    table(&["", "what", "median", "goal", ""], &rows);
}

fn print_quality(report: &Report) {
    say("\nThe crowds of whole steps at their end:");
    let rows: Vec<Vec<String>> = report
        .quality
        .iter()
        .map(|row| {
            vec![
                row.name.to_owned(),
                thousands(row.agents as u64),
                row.steps.to_string(),
                format!("{:.4}", row.overlapping),
                format!("{:.4}", row.deep),
                format!("{:.3}", row.min_distance),
                format!("{:.3}", row.progress),
                format!("{:.0}", row.bytes_per_agent),
            ]
        })
        .collect();
    let head = [
        "crowd",
        "agents",
        "steps",
        "overlaps/agent",
        "deep/agent",
        "nearest m",
        "progress m/s",
        "bytes/agent",
    ];
    table(&head, &rows);
}
