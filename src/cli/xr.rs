//! `gaitway xr`: a crowd around the user of a headset.

use super::failed;
#[cfg(feature = "view")]
use super::mirror;
use super::output::{note, say, say_json};
use super::recorded;
use super::render::size;
use super::scene::{SceneArguments, build, check_seconds, library, start, tell_place};
use crate::Error;
use crate::export::AtomicFile;
use crate::kernels::Store;
use crate::render::Quality;
use crate::scenario::User;
use crate::scene::Scene;
use crate::xr::{self, Observer, Outage, Outcome, Plan, RecordedSession, Recorder, Shot, UserState, Way};
use clap::Args;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
#[cfg(feature = "view")]
use std::sync::Arc;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway xr crossing --agents 2000\n  gaitway xr my-place.toml --seconds 600 --wait\n  \
                        gaitway xr garden --seconds 5 --shots out --eye-size 640x640\n  gaitway xr crossing --record visit.csv\n  gaitway xr crossing --replay visit.csv --backend cpu\n\nWalk about in your room; the \
                        left stick walks farther, the right one turns, A points to a place and goes there, the left \
                        stick pressed brings you back to the start. A scene without a user gets one, near its middle.\n`gaitway devices` says what is missing for a headset."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// End after this time [default: when the headset's runtime ends it]
    #[arg(long)]
    seconds: Option<f64>,
    /// Pixels of one eye, always [default: as the runtime recommends, fewer where the device is too slow]
    #[arg(long, value_name = "WxH", value_parser = size)]
    eye_size: Option<(u32, u32)>,
    /// Ask for this refresh rate of the display, Hz, or the nearest there is [default: the runtime's]
    #[arg(long, value_name = "HZ", value_parser = refresh_rate)]
    rate: Option<f32>,
    /// Light and surfaces: low (the fastest), medium or high
    #[arg(long, default_value = "low", value_name = "QUALITY")]
    quality: Quality,
    /// How far the edge of the view is darkened while a stick moves you, 0 (not at all) to 1
    #[arg(long, value_name = "STRENGTH", default_value_t = xr::DEFAULT_VIGNETTE, value_parser = strength)]
    vignette: f32,
    /// Wait for a runtime or headset that is not there yet
    #[arg(long)]
    wait: bool,
    /// Write pictures of both eyes into this folder, and beside each a table of where people look
    #[arg(long, value_name = "FOLDER")]
    shots: Option<PathBuf>,
    /// Every how many frames
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Keep what the user did, to be replayed
    #[arg(long, value_name = "FILE.csv", conflicts_with = "replay")]
    record: Option<PathBuf>,
    /// Replay what a user did, without a headset, and compare the crowd with that of the recording
    #[arg(long, value_name = "FILE.csv")]
    replay: Option<PathBuf>,
    /// Show what the user sees in a window of this machine, too
    #[cfg(feature = "view")]
    #[arg(long, conflicts_with = "replay")]
    mirror: bool,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Whether to list the scenes, and whether in JSON.
    pub(super) const fn lists(&self) -> (bool, bool) {
        (self.scene.list, self.json)
    }
}

/// A rate in Hz that a display may have.
pub(super) fn refresh_rate(text: &str) -> Result<f32, String> {
    let rate: f32 = text.parse().map_err(|error| format!("{error}"))?;
    if (1.0..=1000.0).contains(&rate) { Ok(rate) } else { Err("must be 1 to 1000 Hz".to_owned()) }
}

/// A strength from nothing to all.
fn strength(text: &str) -> Result<f32, String> {
    let strength: f32 = text.parse().map_err(|error| format!("{error}"))?;
    if (0.0..=1.0).contains(&strength) { Ok(strength) } else { Err("must be 0 to 1".to_owned()) }
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    xr::hush_loader();
    let seconds = arguments.seconds.map(|seconds| check_seconds("--seconds", seconds)).transpose()?;
    if let Some(folder) = &arguments.shots {
        std::fs::create_dir_all(folder).map_err(|error| {
            failed(format!("--shots {}: {error}", folder.display()), "choose a folder that can be written to")
        })?;
    }
    let builder = arguments.scene.builder()?.change(|scenario| scenario.put_in(User::default())).gives_way();
    let scene = build(builder, arguments.scene.library.as_deref())?;
    if let Some(path) = &arguments.replay {
        return replay(arguments, &scene, path);
    }
    let plan = Plan {
        seconds,
        eye_size: arguments.eye_size.map(|(width, height)| [width, height]),
        refresh_rate: arguments.rate,
        vignette: arguments.vignette,
        quality: arguments.quality,
        waits: arguments.wait,
        shots: arguments.shots.clone().map(|folder| {
            let write = move |shot: &Shot| write_shot(&folder, shot);
            (arguments.every, Box::new(write) as xr::Shots)
        }),
        #[cfg(feature = "view")]
        mirror: arguments.mirror.then(|| Arc::new(xr::Mirror::new(mirror::ROWS))),
        ..Plan::default()
    };
    #[cfg(feature = "view")]
    let window = plan.mirror.as_ref().map(|mirror| mirror::open(mirror, &scene.scenario.name));
    let (mut simulation, meshes) = scene.start_with_bodies()?;
    tell_place(&simulation);
    let device = simulation.device();
    let mut observer = Keeper { record: None };
    if let Some(path) = &arguments.record {
        let session = session(&arguments.scene, &scene, simulation.state()?)?;
        let Way { file, note: kept } = xr::make_way(path).map_err(recorded::of(path))?;
        if let Some(kept) = kept {
            note(&format!("note: {}: {kept}", path.display()));
        }
        let recorder = Recorder::new(file, &session).map_err(recorded::of(path))?;
        observer.record = Some((path.clone(), recorder));
    }
    let _heed = crate::stop::heed();
    let outcome = xr::run(&mut simulation, meshes, &scene, plan, &mut observer);
    #[cfg(feature = "view")]
    let mirrored = window.map(mirror::close);
    // what the user did is kept even if the session ended in an error
    match observer.record {
        Some((path, recorder)) if recorder.steps() > 0 => {
            recorder.finish(simulation.state()?).map_err(recorded::of(&path))?;
        }
        Some((path, recorder)) => {
            drop(recorder.into_inner());
            let _ = std::fs::remove_file(path); // a header alone is harmless
        }
        None => {}
    }
    let outcome = outcome?;
    #[cfg(feature = "view")]
    let outcome = Outcome { mirrored: mirrored.unwrap_or_default(), ..outcome };
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome, &device);
    }
    Ok(!outcome.hung)
}

/// Writes a picture, and beside it where everyone in it looks.
pub(super) fn write_shot(folder: &Path, shot: &Shot) -> Result<(), Error> {
    let name = folder.join(format!("frame-{:06}", shot.frame));
    crate::export::image::write_png(&name.with_extension("png"), &shot.image)
        .map_err(crate::export::Error::from)?;
    let mut table = String::from(
        "agent,emotion,eyes_x,eyes_y,eyes_z,face_x,face_y,face_z,turn_deg,rise_deg,distance_m,off_user_deg\n",
    );
    for face in &shot.faces {
        let ([x, y, z], [fx, fy, fz]) = (face.eyes.to_array(), face.forward.to_array());
        let (turn, rise) = (face.turn.to_degrees(), face.rise.to_degrees());
        let (away, off) = (face.eyes.distance(shot.user_eyes), face.off(shot.user_eyes).to_degrees());
        let _ = writeln!(
            table,
            "{},{},{x:.4},{y:.4},{z:.4},{fx:.5},{fy:.5},{fz:.5},{turn:.3},{rise:.3},{away:.4},{off:.3}",
            face.agent,
            face.emotion.name(),
        );
    }
    let mut file = AtomicFile::create(&name.with_extension("csv"))?;
    file.write_all(table.as_bytes()).map_err(|error| {
        failed(format!("{}.csv: {error}", name.display()), "choose a folder that can be written to")
    })?;
    Ok(file.finish()?)
}

/// The header of this session's recording.
fn session(arguments: &SceneArguments, scene: &Scene, store: &Store) -> Result<RecordedSession, Error> {
    Ok(RecordedSession::of(scene, &library(arguments.library.as_deref())?, store))
}

/// Prints notes and keeps what the user did.
struct Keeper {
    record: Option<(PathBuf, Recorder<File>)>,
}

impl Observer for Keeper {
    fn note(&mut self, line: &str) {
        note(&format!("note: {line}"));
    }

    fn step(&mut self, user: &UserState, crowd: &Store) -> Result<(), Error> {
        match &mut self.record {
            Some((path, recorder)) => recorder.step(user, crowd).map_err(recorded::of(path)),
            None => Ok(()),
        }
    }
}

/// Does the steps of a recording again, with the user as they were.
fn replay(arguments: &Arguments, scene: &Scene, path: &Path) -> Result<bool, Error> {
    let found = recorded::read(path)?;
    let mut simulation = start(scene)?;
    let session = session(&arguments.scene, scene, simulation.state()?)?;
    let replayed = recorded::replay(path, found, &session, &mut simulation)?;
    if arguments.json {
        say_json(&replayed)?;
    } else {
        recorded::print(&replayed);
    }
    Ok(replayed.is_good())
}

fn print(outcome: &Outcome, device: &str) {
    if let Some(runtime) = &outcome.runtime {
        say(&format!("headset    {} through {}", runtime.headset, runtime.runtime));
    }
    say(&format!("drawn on   {}", outcome.device));
    say(&format!("simulated  {device}: {} steps, {:.2} s let pass", outcome.steps, outcome.time_lost));
    if let Some(rate) = outcome.refresh_rate {
        let offered: Vec<String> = outcome.refresh_rates.iter().map(ToString::to_string).collect();
        say(&format!("display    {rate} Hz, of {}", offered.join(", ")));
    }
    let [left, right] = outcome.hidden_triangles;
    let depth = if outcome.takes_depth { "depth handed over" } else { "no depth wanted" };
    say(&format!("pictures   {depth}; {left} and {right} triangles hidden by the lenses"));
    let frames = &outcome.frames;
    say(&format!(
        "frames     {} drawn, {} empty, {} periods of the display missed",
        frames.drawn, frames.empty, frames.missed
    ));
    let line = |name: &str, p: &xr::Percentiles| {
        say(&format!("{name}  p50 {:.2}  p95 {:.2}  p99 {:.2} ms", p.p50, p.p95, p.p99));
    };
    line("drawing  ", &frames.work_ms);
    line("device   ", &frames.device_ms);
    line("host     ", &frames.host_ms);
    line("its CPU  ", &frames.host_cpu_ms);
    line("wake-ups ", &frames.wake_ms);
    let [quality, resolution] = [outcome.least_quality, outcome.least_resolution].map(|share| share * 100.0);
    say(&format!("quality    {quality:.0} % at least, in {resolution:.0} % of the width and height"));
    say(&format!("sessions   {} ({})", outcome.sessions, outcome.states.join(", ")));
    for loss in &outcome.losses {
        let Outage { reason, seconds, steps } = loss;
        say(&format!("lost       {reason}; for {seconds:.1} s, in which the crowd did {steps} steps"));
    }
    say(&format!("ended      {}", outcome.ended));
}
