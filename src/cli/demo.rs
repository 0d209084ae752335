//! `gaitway demo`: a crowd in the Crossing and everything it leaves behind, in one folder.

use super::course::{Length, Recording, simulate, steps_per_frame};
use super::output::{note, say, say_json, table, thousands, warn};
use super::outputs::make_folder;
use super::progress::Progress;
use super::render::{Looks, stage, video};
use super::scene::{PlaceArguments, build, check_seconds, people, seed};
use super::sheet;
use crate::Error;
use crate::export::image::write_png;
use crate::picture::Image;
use crate::render::{Markers, Quality};
use crate::scene::{CameraChoice, Scene, Stage};
use clap::Args;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Pixels of the pictures.
const SIZE: (u32, u32) = (1280, 720);
/// Pixels of the video.
const VIDEO_SIZE: (u32, u32) = (640, 360);
/// Frames per second of the trajectories and of the video.
const RATES: (f64, f64) = (10.0, 15.0);
/// Length of the video, s, and the longest it may take to draw, s.
const VIDEO: (f64, f64) = (4.0, 60.0);

/// Arguments of `gaitway demo`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway demo --out demo\n  gaitway demo --out demo --agents 500 --seconds 5"
)]
pub(super) struct Arguments {
    /// Folder for the files
    #[arg(long, value_name = "DIR")]
    out: PathBuf,
    /// How many agents
    #[arg(long, default_value_t = 2000, value_parser = people(1))]
    agents: u32,
    /// Simulated time
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Seed of every random draw
    #[arg(long, default_value_t = 1, value_parser = seed)]
    seed: u64,
    /// Light and surfaces: low (the fastest), medium or high
    #[arg(long, default_value = "low", value_name = "QUALITY")]
    quality: Quality,
    #[command(flatten)]
    place: PlaceArguments,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Serialize)]
struct Written {
    file: PathBuf,
    what: &'static str,
    bytes: u64,
    seconds: f64,
}

#[derive(Debug, Serialize)]
struct Outcome {
    device: String,
    seed: u64,
    crowd: super::course::Outcome,
    files: Vec<Written>,
    wall_seconds: f64,
}

/// Files written so far.
struct Files<'a> {
    folder: &'a Path,
    written: Vec<Written>,
}

impl Files<'_> {
    fn add(&mut self, file: &Path, what: &'static str, begin: Instant) {
        let bytes = std::fs::metadata(file).map_or(0, |data| data.len());
        self.written.push(Written {
            file: file.to_owned(),
            what,
            bytes,
            seconds: begin.elapsed().as_secs_f64(),
        });
    }

    fn picture(
        &mut self,
        name: &str,
        what: &'static str,
        begin: Instant,
        image: &Image,
    ) -> Result<(), Error> {
        let path = self.folder.join(name);
        write_png(&path, image).map_err(crate::export::Error::from)?;
        self.add(&path, what, begin);
        Ok(())
    }
}

/// Runs the subcommand; false when a kernel failed.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let seconds = check_seconds("--seconds", arguments.seconds)?;
    make_folder(&arguments.out)?;
    let mut files = Files { folder: &arguments.out, written: Vec::new() };
    let builder = Scene::load("crossing")?.agents(arguments.agents).seed(arguments.seed);
    let scene = build(arguments.place.choose(builder)?, None)?;
    let length = Length { steps: scene.steps(seconds), until_empty: false };
    let path = arguments.out.join("trajectories.sqlite");
    let started = Instant::now();
    let recording = Recording::create(&path, RATES.0, &scene)?;
    let looks = Looks { quality: arguments.quality, ..Looks::default() };
    let mut stage = stage(scene, SIZE, looks)?;
    let crowd = simulate(&stage.scene, &mut stage.simulation, length, Some(recording))?;
    files.add(&path, "trajectories (JuPedSim, PedPy)", started);
    if let Some(failure) = &crowd.failure {
        warn(&format!("error: {failure}"));
        return Ok(false);
    }
    pictures(&mut stage, &mut files)?;
    let started = Instant::now();
    let mut progress = Progress::new("drawing the contact sheet");
    let (image, _) = sheet::sheet(&arguments.place, &mut |share| progress.at("", share))?;
    drop(progress);
    files.picture("emotions.png", "the four emotions walking", started, &image)?;
    let outcome = Outcome {
        device: stage.devices(),
        seed: arguments.seed,
        crowd,
        files: files.written,
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
}

/// The crowd through the user's eyes and from above, and a video if that is cheap.
fn pictures(stage: &mut Stage, files: &mut Files<'_>) -> Result<(), Error> {
    let views = [
        (CameraChoice::Eyes, "eyes.png", "through the user's eyes", false),
        (CameraChoice::Orbit, "overview.png", "from above", false),
        (CameraChoice::Top, "map.png", "map with the emotions marked", true),
    ];
    for (camera, name, what, has_markers) in views {
        let started = Instant::now();
        stage.show().renderer().set_markers(has_markers.then(Markers::default));
        let camera = stage.camera(camera, 0.0)?;
        let image = stage.picture(&camera)?;
        files.picture(name, what, started, &image)?;
    }
    stage.show().renderer().set_markers(None);
    let (seconds, budget) = VIDEO;
    stage.resize(VIDEO_SIZE)?;
    let (started, camera) = (Instant::now(), stage.camera(CameraChoice::Orbit, 0.0)?);
    stage.picture(&camera)?;
    if started.elapsed().as_secs_f64() * seconds * RATES.1 > budget {
        note("note: no video, since it would take more than a minute here; `gaitway render` makes one");
        return Ok(());
    }
    let steps = (stage.scene.steps(seconds), steps_per_frame(RATES.1, &stage.scene)?);
    let name = if cfg!(feature = "video") { "crowd.mp4" } else { "crowd.y4m" };
    let (path, _) = video(stage, CameraChoice::Orbit, steps, &files.folder.join(name), RATES.1)?;
    files.add(&path, "video", started);
    Ok(())
}

fn print(outcome: &Outcome) {
    let crowd = &outcome.crowd;
    say(&format!(
        "scene      crossing, {} agents, {} steps",
        thousands(u64::from(crowd.agents)),
        crowd.steps
    ));
    say(&format!("seed       {}", outcome.seed));
    say(&format!("device     {}", outcome.device));
    say(&format!(
        "speed      {} agent steps a second; mean walking speed {:.2} m/s, {} overlapping pairs at most",
        super::output::rate(crowd.agent_steps_per_second),
        crowd.mean_speed,
        crowd.overlapping_pairs_max
    ));
    say(&format!("state hash {}\n", crowd.state_hash));
    let rows: Vec<Vec<String>> = outcome
        .files
        .iter()
        .map(|file| {
            vec![
                file.file.display().to_string(),
                file.what.to_owned(),
                thousands(file.bytes),
                format!("{:.1}", file.seconds),
            ]
        })
        .collect();
    table(&["file", "what", "bytes", "seconds"], &rows);
    say(&format!("\nwall time  {:.1} s", outcome.wall_seconds));
}
