//! `gaitway replay`: other people's crowds, recorded or simulated, with bodies, gaits and emotions.

use super::course::{Length, Outcome, Recording, simulate};
#[cfg(feature = "vulkan")]
use super::output::note;
use super::output::{say, say_json, thousands, warn};
use super::preference::PreferenceArguments;
#[cfg(feature = "vulkan")]
use super::render::{hour, size};
use super::scene::{
    ConditionName, PlaceArguments, RigArguments, build, check_changed, check_seconds, people, seed, start,
    with_library,
};
use super::usage;
use crate::Error;
#[cfg(feature = "vulkan")]
use crate::render::Quality;
use crate::replay::{Columns, Format, Options, Pixels, Replay, ReplayOptions, Report, name_of_unit, read};
#[cfg(feature = "vulkan")]
use crate::scene::CameraChoice;
use crate::scene::Scene;
use clap::{Args, ValueEnum};
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Arguments of `gaitway replay`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway replay uo-050-180-180.txt --fps 16 --emotions happy=1\n  gaitway replay \
                  students03/obsmat.txt --render students.png --camera eyes --at 60\n  gaitway replay crowd.sqlite \
                  --agents 20 --out both.sqlite\n  gaitway replay biwi_eth.txt --columns frame,id,x,y --fps \
                  25\n\nColumns, frame rates, units and formats are inferred where the file does not say them, and reported \
                  (`read as`)."
)]
pub(super) struct Arguments {
    /// A recording: .sqlite (JuPedSim), .parquet (ours, or with named columns), .txt (Pedestrian Dynamics Data Archive, obsmat of ETH/UCY, TrajNet, SGAN), .vsp
    /// (UCY), or named columns (.csv, Vadere's .traj, Pathfinder, Viswalk, Crowd:it)
    #[arg(value_name = "FILE")]
    file: PathBuf,
    #[command(flatten)]
    reading: ReadingArguments,
    /// A place to replay in, with its own walkers: a scene or a scenario file [default: the recording's ground]
    #[arg(long, value_name = "SCENE|FILE.toml")]
    scene: Option<String>,
    /// Simulated walkers, which make way for the recorded people [default: 0, or the scene's]
    #[arg(long, value_name = "N", value_parser = people(0))]
    agents: Option<u32>,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// baseline: one neutral gait, no gaze; eva-o: gaits by emotion; eva-g: gaits and gaze [default: as in the scene]
    #[arg(long, value_enum)]
    condition: Option<ConditionName>,
    /// Gaits to walk with [default: the built-in library]
    #[arg(long, value_name = "LIB.glb")]
    library: Option<PathBuf>,
    #[command(flatten)]
    rigs: RigArguments,
    #[command(flatten)]
    preference: PreferenceArguments,
    #[command(flatten)]
    place: PlaceArguments,
    /// Where in the recording to begin, s
    #[arg(long, default_value_t = 0.0, value_name = "SECONDS")]
    from: f64,
    /// How much of it [default: to its end; of a video, 10 s]
    #[arg(long)]
    seconds: Option<f64>,
    /// Trajectories: .sqlite (JuPedSim, PedPy), .parquet (polars, pandas, duckdb; the table of agents beside it), .txt
    /// (Pedestrian Dynamics Data Archive) or .csv
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Frames per second of --out and of videos; a divisor of the step rate [default: as in the recording; videos: the
    /// step rate]
    #[arg(long, value_name = "RATE")]
    out_fps: Option<f64>,
    #[cfg(feature = "vulkan")]
    #[command(flatten)]
    picture: PictureArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Whether pictures are made of it, rather than trajectories.
    pub(super) const fn draws(&self) -> bool {
        #[cfg(feature = "vulkan")]
        return self.picture.render.is_some();
        #[cfg(not(feature = "vulkan"))]
        false
    }
}

/// How to read the file.
#[derive(Debug, Args)]
struct ReadingArguments {
    /// The file's format [default: by its name and first lines]
    #[arg(long, value_enum, help_heading = "Reading")]
    format: Option<FormatName>,
    /// The file's columns, from the left: id, frame (or time, s), x, y, z, vx, vy, or - for a column to skip
    /// [default: by their names, or inferred]
    #[arg(long, value_name = "id,frame,x,y", help_heading = "Reading")]
    columns: Option<Columns>,
    /// The file's frames per second [default: as the file says, or inferred from its velocities or steps]
    #[arg(long, value_name = "RATE", help_heading = "Reading")]
    fps: Option<f64>,
    /// Take the file as it is read although half of its steps are faster than 4 m/s
    #[arg(long, help_heading = "Reading")]
    accept_speed: bool,
    /// Metres per unit of the file: 1 for metres, 0.01 for centimetres [default: as the file says, or inferred]
    #[arg(long, value_name = "METRES", help_heading = "Reading")]
    unit: Option<f64>,
    /// Homography from pixels to metres, for .vsp [default: H.txt beside it]
    #[arg(long, value_name = "FILE", help_heading = "Reading")]
    homography: Option<PathBuf>,
    /// How the homography's pixels are counted [default: inferred]
    #[arg(long, value_enum, help_heading = "Reading")]
    pixels: Option<PixelsName>,
    /// The file's y goes down the page as seen from above (zara of UCY's obsmat): keep left and right
    #[arg(long, help_heading = "Reading")]
    mirror: bool,
    /// A gap between two samples that is longer than this is an absence, s
    #[arg(long, default_value_t = 2.0, value_name = "SECONDS", help_heading = "Reading")]
    gap: f64,
    /// Smooth paths with a Gaussian of this standard deviation, against tracking jitter, s; 0: through every sample
    #[arg(long, default_value_t = 0.0, value_name = "SECONDS", help_heading = "Reading")]
    smooth: f64,
}

#[cfg(feature = "vulkan")]
#[derive(Debug, Args)]
struct PictureArguments {
    /// FILE.png, FILE.mp4, FILE.y4m, or FOLDER/ for a PNG per frame
    #[arg(long, value_name = "FILE", help_heading = "Pictures")]
    render: Option<PathBuf>,
    /// eyes (the scene's user's, or from near the middle), orbit, top (a map), `follow` or `follow:AGENT`
    #[arg(long, default_value = "orbit", value_name = "CAMERA", help_heading = "Pictures")]
    camera: CameraChoice,
    /// Pixels
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WIDTHxHEIGHT", help_heading = "Pictures")]
    size: (u32, u32),
    /// Time before the (first) picture, s [default: 3, videos: 0]
    #[arg(long, value_name = "SECONDS", help_heading = "Pictures")]
    at: Option<f64>,
    /// Rings on the ground in the colours of the emotions
    #[arg(long, help_heading = "Pictures")]
    markers: bool,
    /// Light and surfaces: low (the fastest), medium or high
    #[arg(long, default_value = "low", value_name = "QUALITY", help_heading = "Pictures")]
    quality: Quality,
    /// Time of day, 6 to 18: where the sun stands, its colour, and whether lamps are lit; 12 is the light of the place itself
    #[arg(long, default_value_t = 12.0, value_name = "HOUR", value_parser = hour, help_heading = "Pictures")]
    hour: f32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum FormatName {
    Sqlite,
    Parquet,
    Archive,
    Obsmat,
    Vsp,
    Csv,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PixelsName {
    Centre,
    RowColumn,
}

/// What was read and what came out.
#[derive(Debug, Serialize)]
struct Replayed {
    recording: Report,
    /// Agents that replay people, from this index on.
    first_agent: u32,
    people: usize,
    /// Greatest distance of a person from the recorded place, at the end, m.
    drift: f32,
    #[serde(flatten)]
    outcome: Outcome,
}

/// Runs the subcommand; false when a kernel failed.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let seconds = arguments.seconds.map(|seconds| check_seconds("--seconds", seconds)).transpose()?;
    let from = check_seconds("--from", arguments.from)?;
    if !(0.0..=10.0).contains(&arguments.reading.smooth) {
        let message = format!("--smooth {}: must be 0 to 10 seconds", arguments.reading.smooth);
        return Err(usage(message, "0.1 to 0.3 is usual"));
    }
    let (scene, recording) = scene(arguments, from)?;
    let left = (recording.seconds - from).max(0.0);
    #[cfg(feature = "vulkan")]
    if let Some(out) = &arguments.picture.render {
        if arguments.out.is_some() {
            note("note: --render draws; --out is left for a run without it");
        }
        let picture = super::render::Film {
            out,
            camera: arguments.picture.camera,
            size: arguments.picture.size,
            at: arguments.picture.at,
            seconds: seconds.unwrap_or(10.0).min(left),
            fps: arguments.out_fps,
            markers: arguments.picture.markers,
            quality: arguments.picture.quality,
            hour: arguments.picture.hour,
        };
        if !arguments.json {
            print_report(&recording);
        }
        return super::render::draw(scene, &picture, arguments.json, begin);
    }
    let mut simulation = start(&scene)?;
    let length = Length { steps: scene.steps(seconds.unwrap_or(left).min(left)), until_empty: false };
    let rate = arguments.out_fps.unwrap_or(recording.frame_rate);
    let sink = arguments.out.as_ref().map(|path| Recording::create(path, rate, &scene)).transpose()?;
    let mut outcome = simulate(&scene, &mut simulation, length, sink)?;
    outcome.wall_seconds = begin.elapsed().as_secs_f64();
    let replay = scene.replay.as_ref();
    let time = Replay::time_of(outcome.steps, scene.scenario.navigation.time_step);
    let state = simulation.state()?;
    let drift = replay.map_or(0.0, |replay| {
        let first = replay.first_agent() as usize;
        let off = |person: usize| {
            let there = glam::Vec2::from_array(*state.position.get(first + person)?);
            Some(replay.at(person, time)?.position.distance(there))
        };
        (0..replay.len()).filter_map(off).fold(0.0, f32::max)
    });
    let replayed = Replayed {
        recording,
        first_agent: replay.map_or(0, Replay::first_agent),
        people: replay.map_or(0, Replay::len),
        drift,
        outcome,
    };
    if arguments.json {
        say_json(&replayed)?;
    } else {
        print_report(&replayed.recording);
        say(&format!("drift              {:.6} m", replayed.drift));
        super::simulate::print(&replayed.outcome);
    }
    if let Some(failure) = &replayed.outcome.failure {
        warn(&format!("error: {failure}"));
    }
    Ok(replayed.outcome.failure.is_none())
}

/// Reads the recording and builds its scene.
fn scene(arguments: &Arguments, from: f64) -> Result<(Scene, Report), Error> {
    let reading = &arguments.reading;
    let options = Options {
        format: reading.format.map(|format| match format {
            FormatName::Sqlite => Format::Sqlite,
            FormatName::Parquet => Format::Parquet,
            FormatName::Archive => Format::Archive,
            FormatName::Obsmat => Format::Obsmat,
            FormatName::Vsp => Format::Vsp,
            FormatName::Csv => Format::Csv,
        }),
        columns: reading.columns.clone(),
        frame_rate: reading.fps,
        accept_speed: reading.accept_speed,
        metres_per_unit: reading.unit,
        homography: reading.homography.clone(),
        pixels: reading.pixels.map(|pixels| match pixels {
            PixelsName::Centre => Pixels::Centre,
            PixelsName::RowColumn => Pixels::RowColumn,
        }),
        mirror: reading.mirror,
        longest_gap: Some(reading.gap),
    };
    let recording = read(&arguments.file, &options)?;
    let mut scenario = match &arguments.scene {
        Some(scene) => Scene::load(scene)?.scenario().clone(),
        None => {
            let name =
                arguments.file.file_stem().map_or_else(String::new, |s| s.to_string_lossy().into_owned());
            recording.scene(&name, arguments.agents.unwrap_or(0), arguments.seed)
        }
    };
    scenario.seed = arguments.seed;
    if let Some(agents) = arguments.agents {
        scenario.population.agents = agents;
    }
    arguments.preference.apply(&mut scenario);
    check_changed(&scenario)?;
    let replay = Replay::new(&recording, ReplayOptions { smooth: reading.smooth, from });
    let base = arguments.scene.as_ref().and_then(|scene| Path::new(scene).parent());
    let mut builder = Scene::of(scenario).folder(base).rig_maps(&arguments.rigs.rig_map).replay(replay);
    if let Some(condition) = arguments.condition {
        builder = builder.condition(condition.get());
    }
    let library = arguments.library.as_deref();
    let builder = with_library(arguments.place.choose(builder)?, library)?;
    Ok((build(builder, library)?, recording.report))
}

fn print_report(report: &Report) {
    say(&format!(
        "recording          {} people, {} positions, {:.1} s",
        thousands(report.people as u64),
        thousands(report.samples as u64),
        report.seconds
    ));
    let columns = match (&report.columns, report.columns_from) {
        (Some(columns), Some(from)) => format!("{columns} ({from}); "),
        _ => String::new(),
    };
    say(&format!(
        "read as            {columns}{} frames a second ({}); {} ({})",
        report.frame_rate,
        report.frame_rate_from,
        name_of_unit(report.metres_per_unit),
        report.metres_per_unit_from
    ));
    let mut faults = Vec::new();
    for (count, what) in [
        (report.duplicates, "rows twice"),
        (report.contradictions, "of them with another place"),
        (report.absences, "absences"),
        (report.gaps, "gaps bridged"),
    ] {
        if count > 0 {
            faults.push(format!("{} {what}", thousands(count as u64)));
        }
    }
    if report.unsorted {
        faults.push("rows not in order".to_owned());
    }
    if report.longest_gap > 0.0 && report.gaps > 0 {
        faults.push(format!("longest gap {:.2} s", report.longest_gap));
    }
    if let Some(median) = report.median_speed {
        faults.push(format!("median speed {median:.2} m/s, fastest {:.2}", report.fastest));
    }
    say(&format!("found              {}", faults.join(", ")));
    for note in &report.notes {
        say(&format!("                   {note}"));
    }
}
