//! `gaitway xr`: a crowd around the user of a headset.

use super::failed;
#[cfg(feature = "view")]
use super::mirror;
use super::output::{note, say, say_json};
use super::progress::Progress;
use super::render::size;
use super::scene::{SceneArguments, build, check_seconds, library, start, tell_place};
use crate::Error;
use crate::export::AtomicFile;
use crate::file;
use crate::kernels::Store;
use crate::scenario::User;
use crate::scene::Scene;
use crate::sim::measure;
use crate::xr::{
    self, Observer, Outage, Outcome, Plan, RecordedSession, Recorder, Recording, RecordingError, SessionHash,
    Shot, UserState, Way,
};
use clap::Args;
use serde::Serialize;
use std::fmt::Write as _;
use std::fs::File;
use std::io::Write as _;
use std::path::{Path, PathBuf};
#[cfg(feature = "view")]
use std::sync::Arc;

/// Longest recording that is replayed, bytes: some days.
const MOST_RECORDED: u64 = 1 << 30;

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
fn refresh_rate(text: &str) -> Result<f32, String> {
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
        let Way { file, note: kept } = xr::make_way(path).map_err(recording(path))?;
        if let Some(kept) = kept {
            note(&format!("note: {}: {kept}", path.display()));
        }
        let recorder = Recorder::new(file, &session).map_err(recording(path))?;
        observer.record = Some((path.clone(), recorder));
    }
    let _heed = crate::stop::heed();
    let outcome = xr::run(&mut simulation, meshes, &scene, plan, &mut observer);
    #[cfg(feature = "view")]
    let mirrored = window.map(mirror::close);
    // what the user did is kept even if the session ended in an error
    match observer.record {
        Some((path, recorder)) if recorder.steps() > 0 => {
            recorder.finish(simulation.state()?).map_err(recording(&path))?;
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
fn write_shot(folder: &Path, shot: &Shot) -> Result<(), Error> {
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

fn recording(path: &Path) -> impl Fn(RecordingError) -> Error + '_ {
    move |error| {
        let hint = match error {
            RecordingError::Taken(_) => "choose another name, or move the file away",
            _ => {
                "a recording is written by `gaitway xr --record`; replay it with the same scene, condition, agents, seed \
                 and library, by the same version"
            }
        };
        failed(format!("{}: {error}", path.display()), hint)
    }
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
            Some((path, recorder)) => recorder.step(user, crowd).map_err(recording(path)),
            None => Ok(()),
        }
    }
}

/// What a replay came to.
#[derive(Debug, Serialize)]
struct Replayed {
    device: String,
    /// Version of the recording's format.
    format: u32,
    /// The trial of a study that it names.
    #[serde(skip_serializing_if = "Option::is_none")]
    trial: Option<String>,
    steps: usize,
    /// Of the crowd after the last step.
    state_hash: String,
    /// Of the session: [`SessionHash`].
    session_hash: String,
    recorded_hash: Option<String>,
    /// Steps up to which the recording has hashes to compare with.
    compared_steps: usize,
    /// Whether all of these are equal; null if there is none.
    equal: Option<bool>,
    /// Steps after which the first hash differs.
    differs_after: Option<usize>,
}

/// Reads a recording; one that broke off is repaired first.
fn read(path: &Path) -> Result<Recording, Error> {
    let wrong = recording(path);
    file::regular(path).map_err(|error| wrong(error.into()))?;
    match xr::repair(path) {
        Ok(0) => {}
        Ok(_) => note(&format!("note: {} broke off in a step: cut at its last whole one", path.display())),
        // one that cannot be written is still read
        Err(error) if error.kind() == std::io::ErrorKind::PermissionDenied => {}
        Err(error) => return Err(wrong(error.into())),
    }
    let bytes = file::read(path, MOST_RECORDED).map_err(|error| wrong(error.into()))?;
    Recording::read(bytes.as_slice()).map_err(wrong)
}

/// Whether a crowd begins as one of format 1 says: by the hash of its state.
fn check_start(found: &Recording, store: &Store) -> Result<(), RecordingError> {
    let (recorded, now) = (found.session.start, measure::state_hash(store));
    if recorded == now {
        return Ok(());
    }
    Err(RecordingError::Other {
        differences: vec![format!("start {recorded:016x} was recorded, this is {now:016x}")],
    })
}

/// Does the steps of a recording again, with the user as they were.
fn replay(arguments: &Arguments, scene: &Scene, path: &Path) -> Result<bool, Error> {
    let found = read(path)?;
    let mut simulation = start(scene)?;
    let session = session(&arguments.scene, scene, simulation.state()?)?;
    found.must_be_of(&session).map_err(recording(path))?;
    if found.is_silent() {
        note(&format!(
            "note: {}: format 1 says neither condition nor gaze: whether this is the condition it was recorded under cannot be \
             told; the crowd is compared alone",
            path.display()
        ));
        check_start(&found, simulation.state()?).map_err(recording(path))?;
    }
    let mut progress = Progress::new("replaying".to_owned());
    let mut hash = SessionHash::new(&session);
    let steps = found.steps.len();
    let mut recorded = found.hashes.iter().peekable();
    let (mut compared_steps, mut differs_after) = (0, None);
    for (step, user) in found.steps.iter().enumerate() {
        simulation.set_user(user.place, user.elevation, user.velocity);
        simulation.step(1)?;
        let crowd = simulation.state()?;
        hash.step(user, crowd);
        if let Some((after, is)) = recorded.next_if(|(after, _)| *after as usize == step + 1) {
            compared_steps = *after as usize;
            if hash.with(crowd) != *is {
                differs_after.get_or_insert(compared_steps);
            }
        }
        #[allow(clippy::cast_precision_loss, reason = "a share of a few million")]
        let share = step as f64 / steps as f64;
        progress.at(&format!("step {step} of {steps}"), share);
    }
    let device = simulation.device();
    let crowd = simulation.state()?;
    let session_hash = hash.with(crowd);
    let now = if found.is_silent() { measure::state_hash(crowd) } else { session_hash };
    if let Some(end) = found.end {
        compared_steps = steps;
        if end != now {
            differs_after.get_or_insert(steps);
        }
    }
    let hex = |hash: u64| format!("{hash:016x}");
    let is_compared = found.end.is_some() || compared_steps > 0;
    let trial = found.session.trial.map(|of| {
        let xr::TrialLabel { study, participant, trial } = of;
        format!("{study}, participant {participant}, trial {trial}")
    });
    let replayed = Replayed {
        device,
        format: found.format,
        trial,
        steps,
        state_hash: hex(measure::state_hash(crowd)),
        session_hash: hex(session_hash),
        recorded_hash: found.end.map(hex),
        compared_steps,
        equal: is_compared.then_some(differs_after.is_none()),
        differs_after,
    };
    if arguments.json {
        say_json(&replayed)?;
    } else {
        print_replayed(&replayed);
    }
    Ok(replayed.equal != Some(false))
}

fn print_replayed(replayed: &Replayed) {
    if let Some(trial) = &replayed.trial {
        say(&format!("trial      {trial}"));
    }
    say(&format!("replayed   {} steps on {}", replayed.steps, replayed.device));
    say(&format!("state hash {}", replayed.state_hash));
    say(&format!("session    {}", replayed.session_hash));
    if replayed.recorded_hash.is_none() {
        say(&format!("the recording broke off; it can be compared up to step {}", replayed.compared_steps));
    }
    match (replayed.equal, replayed.differs_after) {
        (Some(true), _) => say("the session is that of the recording, bit for bit"),
        (_, Some(after)) => {
            say(&format!("the session is NOT that of the recording: it differs after {after} steps"));
        }
        _ => say("there is nothing to compare with"),
    }
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
