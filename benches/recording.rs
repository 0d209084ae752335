//! Steps of a large crowd with a frame in a Parquet file every third, and without: what recording costs the step.
//!
//! `cargo bench --bench recording -- --agents 100000 --pairs 5 --folder runs` runs another one. Windows of steps with and without
//! frames take turns in one process. A window begins with a frame, so that the thread that writes is done before it ends.
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    missing_docs,
    reason = "a benchmark stops at the first fault"
)]

use clap::Parser;
use gaitway::export::{AgentInfo, Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
use gaitway::sim::{Backend, Simulation};
use gaitway::verify::cases::crossing::crossing;
use std::path::PathBuf;
use std::time::Instant;

/// Steps between two frames: 10 a second.
const EVERY: u32 = 3;
/// Frames of a window: the thread writes four of a million agents at once.
const FRAMES: u32 = 8;

#[derive(Debug, Parser)]
struct Options {
    #[arg(long, default_value_t = 1_000_000)]
    agents: usize,
    #[arg(long, default_value_t = 9)]
    pairs: u32,
    /// Where the file is written; a temporary folder of the system unless given.
    #[arg(long)]
    folder: Option<PathBuf>,
    /// What `cargo bench` adds.
    #[arg(long, hide = true)]
    bench: bool,
}

/// Milliseconds.
fn since(begin: Instant) -> f64 {
    begin.elapsed().as_secs_f64() * 1e3
}

/// What a window took, ms a step, and what of it was the handing over of frames.
#[derive(Debug, Clone, Copy, Default)]
struct Window {
    step: f64,
    handing: f64,
}

fn plain(simulation: &mut Simulation) -> Window {
    let begin = Instant::now();
    for _ in 0..FRAMES {
        simulation.step(EVERY).unwrap();
    }
    Window { step: since(begin) / f64::from(FRAMES * EVERY), handing: 0.0 }
}

fn recorded(simulation: &mut Simulation, writer: &mut TrajectoryWriter) -> Window {
    let mut handing = 0.0;
    let begin = Instant::now();
    for _ in 0..FRAMES {
        let start = Instant::now();
        let store = simulation.state().unwrap();
        let agents = store.step.agent_count as usize;
        let frame = Frame {
            positions: bytemuck::cast_slice(&store.position[..agents]),
            headings: &store.heading[..agents],
            velocities: bytemuck::cast_slice(&store.velocity[..agents]),
            emotions: &[],
        };
        writer.frame(&frame).unwrap();
        handing += since(start);
        simulation.step(EVERY).unwrap();
    }
    let step = since(begin) / f64::from(FRAMES * EVERY);
    Window { step, handing: handing / f64::from(FRAMES) }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn main() {
    let options = Options::parse();
    let temporary = tempfile::tempdir().unwrap();
    let folder = options.folder.as_deref().unwrap_or(temporary.path());
    let file = folder.join("recording.parquet");
    let mut simulation = Simulation::from_store(crossing(options.agents, 1.0), Backend::Cpu, None).unwrap();
    let agents = vec![AgentInfo::default(); options.agents];
    let format = TrajectoryFormat::Parquet;
    let mut writer = TrajectoryWriter::create(&file, format, 10.0, &Walkable::default(), agents).unwrap();
    // without counting: memory is new, and the threads have to find their places
    plain(&mut simulation);
    recorded(&mut simulation, &mut writer);
    let mut ratios = Vec::new();
    for pair in 0..options.pairs {
        let (one, other) = if pair % 2 == 0 {
            let one = plain(&mut simulation);
            (one, recorded(&mut simulation, &mut writer))
        } else {
            let other = recorded(&mut simulation, &mut writer);
            (plain(&mut simulation), other)
        };
        println!(
            "step {:.1} ms, recorded {:.1} ms ({:.1} ms to hand a frame over), ratio {:.3}",
            one.step,
            other.step,
            other.handing,
            other.step / one.step
        );
        ratios.push(other.step / one.step);
    }
    let rows = options.agents as f64 * f64::from(writer.frames());
    writer.finish().unwrap();
    println!("bytes a sample {:.2}", std::fs::metadata(&file).unwrap().len() as f64 / rows);
    println!("median ratio {:.3}", median(ratios));
}
