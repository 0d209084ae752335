//! `gaitway render`: pictures and videos of a crowd.

use super::course::steps_per_frame;
use super::output::{say, say_json, thousands};
use super::outputs::make_folder;
use super::progress::Progress;
use super::scene::{SceneArguments, check_seconds, tell_place};
use super::usage;
use crate::export::image::write_png;
use crate::export::video::Video;
use crate::render::{Markers, Quality, Settings};
use crate::scene::{CameraChoice, Scene, Stage, atmosphere};
use crate::{Error, stop};
use clap::Args;
use clap::builder::ArgPredicate;
use serde::Serialize;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Steps done at once on the way to the first picture, so that progress shows.
const LEAP: u32 = 30;

/// Arguments of `gaitway render`.
#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway render crossing --agents 500 --camera eyes --out eyes.png\n  gaitway \
                        render garden --camera orbit --seconds 5 --out garden.mp4\n  gaitway render parking --camera \
                        follow:3 --seconds 2 --out frames/\n\nAn .mp4 is H.264, which \
                        browsers and players open; a .y4m is uncompressed, for other encoders."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// eyes (the user's; without one: from near the middle), orbit, top (a map), `follow` or `follow:AGENT`
    #[arg(long, default_value = "orbit", value_name = "CAMERA")]
    camera: CameraChoice,
    /// Pixels
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WIDTHxHEIGHT")]
    size: (u32, u32),
    /// FILE.png, FILE.mp4, FILE.y4m, or FOLDER/ for a PNG per frame
    #[arg(
        long,
        value_name = "FILE",
        required = false,
        required_unless_present = "list",
        default_value_if("list", ArgPredicate::IsPresent, "-")
    )]
    out: PathBuf,
    /// Simulated time before the (first) picture [default: 3, videos: 0]
    #[arg(long, value_name = "SECONDS")]
    at: Option<f64>,
    /// Length of a video, s
    #[arg(long, default_value_t = 10.0)]
    seconds: f64,
    /// Frames per second of a video; a divisor of the step rate (30)
    #[arg(long, default_value_t = 30.0)]
    fps: f64,
    /// Rings on the ground in the colours of the emotions
    #[arg(long)]
    markers: bool,
    /// Light and surfaces: low (the fastest), medium or high
    #[arg(long, default_value = "low", value_name = "QUALITY")]
    quality: Quality,
    /// Time of day, 6 to 18: where the sun stands, its colour, and whether lamps are lit; 12 is the light of the place itself
    #[arg(long, default_value_t = 12.0, value_name = "HOUR", value_parser = hour)]
    hour: f32,
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

/// What was written.
#[derive(Debug, Serialize)]
struct Outcome {
    device: String,
    scene: String,
    agents: u32,
    seed: u64,
    file: PathBuf,
    frames: u64,
    width: u32,
    height: u32,
    simulated_seconds: f64,
    wall_seconds: f64,
}

/// Where pictures go.
enum Target {
    Still(PathBuf),
    Folder(PathBuf),
    Video(PathBuf),
}

impl Target {
    fn of(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().and_then(|ending| ending.to_str()).map(str::to_ascii_lowercase);
        let text = path.to_string_lossy();
        let own = path.to_owned();
        match ending.as_deref() {
            _ if text.ends_with(std::path::MAIN_SEPARATOR) || path.is_dir() => Ok(Self::Folder(own)),
            Some("png") => Ok(Self::Still(own)),
            Some("mp4" | "y4m") => Ok(Self::Video(own)),
            _ => Err(usage(
                format!("--out {text}: neither a picture, a video nor a folder"),
                "use FILE.png, FILE.mp4, FILE.y4m, or FOLDER/ with the slash",
            )),
        }
    }
}

/// What is drawn of a scene.
pub(super) struct Film<'a> {
    pub(super) out: &'a Path,
    pub(super) camera: CameraChoice,
    pub(super) size: (u32, u32),
    pub(super) at: Option<f64>,
    pub(super) seconds: f64,
    /// Frames per second; `None`: one each step.
    pub(super) fps: Option<f64>,
    pub(super) markers: bool,
    pub(super) quality: Quality,
    /// Time of day.
    pub(super) hour: f32,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let begin = Instant::now();
    let picture = Film {
        out: &arguments.out,
        camera: arguments.camera,
        size: arguments.size,
        at: arguments.at,
        seconds: check_seconds("--seconds", arguments.seconds)?,
        fps: Some(arguments.fps),
        markers: arguments.markers,
        quality: arguments.quality,
        hour: arguments.hour,
    };
    Target::of(picture.out)?; // before anything takes time
    draw(arguments.scene.load()?, &picture, arguments.json, begin)
}

/// Draws images of a scene and prints the files written.
pub(super) fn draw(scene: Scene, picture: &Film<'_>, json: bool, begin: Instant) -> Result<bool, Error> {
    let target = Target::of(picture.out)?;
    let is_still = matches!(target, Target::Still(_));
    let at = check_seconds("--at", picture.at.unwrap_or(if is_still { 3.0 } else { 0.0 }))?;
    let rate = picture.fps.unwrap_or(1.0 / f64::from(scene.scenario.navigation.time_step));
    let every = steps_per_frame(rate, &scene)?;
    let (lead, steps) = (scene.steps(at), scene.steps(picture.seconds));
    let looks = Looks { has_markers: picture.markers, quality: picture.quality, hour: picture.hour };
    let mut stage = stage(scene, picture.size, looks)?;
    let heed = stop::heed();
    advance(&mut stage, lead)?;
    if stop::asked() {
        return Ok(true); // nothing was drawn yet
    }
    let (file, frames) = match target {
        Target::Still(path) => {
            let camera = stage.camera(picture.camera, 0.0)?;
            let image = stage.picture(&camera)?;
            write_png(&path, &image).map_err(crate::export::Error::from)?;
            (path, 1)
        }
        Target::Folder(path) => {
            make_folder(&path)?;
            let frames = film(&mut stage, picture.camera, (steps, every), &mut |number, image| {
                let name = path.join(format!("frame_{number:05}.png"));
                Ok(write_png(&name, image).map_err(crate::export::Error::from)?)
            })?;
            (path, frames)
        }
        Target::Video(path) => video(&mut stage, picture.camera, (steps, every), &path, rate)?,
    };
    drop(heed);
    let outcome = Outcome {
        device: stage.devices(),
        scene: stage.scene.scenario.name.clone(),
        agents: stage.scene.agents(),
        seed: stage.scene.scenario.seed,
        file,
        frames,
        width: picture.size.0,
        height: picture.size.1,
        simulated_seconds: stage.simulation.time(),
        wall_seconds: begin.elapsed().as_secs_f64(),
    };
    if json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
}

fn print(outcome: &Outcome) {
    let Outcome { scene, agents, seed, device, file, frames, width, height, .. } = outcome;
    say(&format!(
        "scene      {scene}, {} agents, {:.2} s",
        thousands(u64::from(*agents)),
        outcome.simulated_seconds
    ));
    say(&format!("seed       {seed}"));
    say(&format!("device     {device}"));
    say(&format!(
        "written    {} ({frames} frame{}, {width}x{height})",
        file.display(),
        if *frames == 1 { "" } else { "s" }
    ));
    say(&format!("wall time  {:.2} s", outcome.wall_seconds));
}

/// Width and height of a picture in pixels, written `1280x720`.
pub(super) fn size(text: &str) -> Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match parts {
        Some((w, h)) if (1..=16_384).contains(&w) && (1..=16_384).contains(&h) => Ok((w, h)),
        _ => Err("use WIDTHxHEIGHT in pixels, 1 to 16384 each, such as 1280x720".to_owned()),
    }
}

/// How a scene is drawn.
#[derive(Debug, Clone, Copy)]
pub(super) struct Looks {
    pub(super) has_markers: bool,
    pub(super) quality: Quality,
    /// Time of day, 6 to 18.
    pub(super) hour: f32,
}

impl Default for Looks {
    fn default() -> Self {
        Self { has_markers: false, quality: Quality::Low, hour: 12.0 }
    }
}

/// A time of day at which the sun is up.
pub(super) fn hour(text: &str) -> Result<f32, String> {
    let hour: f32 = text.parse().map_err(|error| format!("{error}"))?;
    if (6.0..=18.0).contains(&hour) { Ok(hour) } else { Err("must be 6 to 18".to_owned()) }
}

/// A scene on stage for pictures of `size`, in the light of its place.
pub(super) fn stage(scene: Scene, (width, height): (u32, u32), looks: Looks) -> Result<Stage, Error> {
    let settings = Settings {
        atmosphere: atmosphere(scene.scenario.layout).at_hour(looks.hour),
        quality: looks.quality,
        markers: looks.has_markers.then(Markers::default),
        ..Settings::sized(width, height)
    };
    let stage = Stage::new(scene, settings)?;
    tell_place(&stage.simulation);
    Ok(stage)
}

/// Simulates without drawing.
fn advance(stage: &mut Stage, steps: u32) -> Result<(), Error> {
    let mut progress = Progress::new("simulating");
    let mut done = 0;
    while done < steps && !stop::asked() {
        let count = LEAP.min(steps - done);
        stage.step(count)?;
        done += count;
        progress.at("", f64::from(done) / f64::from(steps));
    }
    Ok(())
}

/// Draws a picture every `every` of `steps` steps and hands it on with its number; how many there were.
pub(super) fn film(
    stage: &mut Stage,
    camera: CameraChoice,
    (steps, every): (u32, u32),
    take: &mut dyn FnMut(u64, &crate::picture::Image) -> Result<(), Error>,
) -> Result<u64, Error> {
    let mut progress = Progress::new("drawing");
    let frames = u64::from(steps / every).max(1);
    let begin = stage.simulation.time();
    for number in 0..frames {
        if number > 0 {
            if stop::asked() {
                return Ok(number);
            }
            stage.step(every)?;
        }
        let camera = stage.camera(camera, stage.simulation.time() - begin)?;
        take(number, &stage.picture(&camera)?)?;
        #[allow(clippy::cast_precision_loss, reason = "a count of frames")]
        progress.at(&format!("frame {} of {frames}", number + 1), (number + 1) as f64 / frames as f64);
    }
    Ok(frames)
}

/// Films into a video file; its name and number of frames.
pub(super) fn video(
    stage: &mut Stage,
    camera: CameraChoice,
    steps: (u32, u32),
    path: &Path,
    rate: f64,
) -> Result<(PathBuf, u64), Error> {
    let (width, height) = stage.size();
    let mut video = Video::create(path, width, height, rate).map_err(crate::export::Error::from)?;
    let frames = film(stage, camera, steps, &mut |_, image| {
        Ok(video.push(image).map_err(crate::export::Error::from)?)
    })?;
    Ok((video.finish().map_err(crate::export::Error::from)?, frames))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hours_are_those_of_daylight() {
        assert_eq!(hour("17.5"), Ok(17.5));
        for wrong in ["5", "18.1", "NaN", "noon"] {
            assert!(hour(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_read_and_wrong_ones_refused_with_the_way_out() {
        assert_eq!(size("640x360"), Ok((640, 360)));
        for wrong in ["640", "0x10", "99999x1", "ax2", ""] {
            assert!(size(wrong).unwrap_err().contains("1280x720"), "{wrong}");
        }
    }
}
