//! `gaitway xr`: a crowd around the user of a headset.

use super::output::{note, say, say_json};
use super::scene::{Scene, SceneArguments, check_seconds, start};
use super::stage::{atmosphere, size};
use super::usage;
use crate::Error;
use crate::picture::Image;
use crate::render::Settings;
use crate::scenario::Clearance;
use crate::sim::bodies;
use crate::xr::{self, Outcome, Plan, World};
use clap::Args;
use std::path::PathBuf;

/// Texels a side of the shadow map: a headset draws twice.
const SHADOW_SIZE: u32 = 1024;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway xr crossing --agents 2000\n  gaitway xr my-place.toml --seconds 600 --wait\n  \
                        gaitway xr garden --seconds 5 --shots out --eye-size 640x640\n\nWalk about in your room; the \
                        left stick walks farther, the right one turns, A points to a place and goes there, the left \
                        stick pressed brings you back to the start.\n`gaitway devices` says what is missing for a headset."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// End after this time [default: when the headset's runtime ends it]
    #[arg(long)]
    seconds: Option<f64>,
    /// Pixels of one eye [default: as the runtime recommends]
    #[arg(long, value_name = "WxH", value_parser = size)]
    eye_size: Option<(u32, u32)>,
    /// Wait for a runtime or headset that is not there yet
    #[arg(long)]
    wait: bool,
    /// Write pictures of both eyes into this folder
    #[arg(long, value_name = "FOLDER")]
    shots: Option<PathBuf>,
    /// Every how many frames
    #[arg(long, value_name = "N", default_value_t = 30, value_parser = clap::value_parser!(u64).range(1..))]
    every: u64,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let seconds = arguments.seconds.map(|seconds| check_seconds("--seconds", seconds)).transpose()?;
    if let Some(folder) = &arguments.shots {
        std::fs::create_dir_all(folder).map_err(|error| {
            usage(format!("--shots {}: {error}", folder.display()), "choose a folder that can be written to")
        })?;
    }
    let scene = Scene::load(&arguments.scene)?;
    let mut store = scene.store();
    let meshes = bodies::fill(&mut store, &scene.cast, bodies::SMALLEST_STORAGE_RANGE);
    let geometry = &scene.geometry;
    let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let user = &scene.scenario.user;
    let radius = user.radius;
    let full = store.frame.level_distance;
    let world = World {
        meshes,
        scenery: geometry.environment.mesh(&geometry.bounds, geometry.user),
        settings: Settings {
            atmosphere: atmosphere(scene.scenario.layout),
            shadow_size: SHADOW_SIZE,
            ..Settings::default()
        },
        gaze_mode: scene.scenario.gaze.mode,
        level_distances: [full[0], full[1], full[2]],
        start: (geometry.user, user.heading_deg.to_radians()),
        is_free: Box::new(move |place| free.admits(place, radius)),
        store: store.clone(),
    };
    let plan = Plan {
        seconds,
        eye_size: arguments.eye_size.map(|(width, height)| [width, height]),
        waits: arguments.wait,
        shots: arguments.shots.clone().map(|folder| {
            let write = move |frame: u64, image: &Image| {
                Ok(crate::export::image::write_png(&folder.join(format!("frame-{frame:06}.png")), image)
                    .map_err(crate::export::Error::from)?)
            };
            (arguments.every, Box::new(write) as xr::Shots)
        }),
        ..Plan::default()
    };
    let mut simulation = start(store, &arguments.scene.place)?;
    let device = simulation.device();
    let outcome = xr::run(&mut simulation, world, plan, &mut |line| note(&format!("note: {line}")))?;
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome, &device);
    }
    Ok(!outcome.hung)
}

fn print(outcome: &Outcome, device: &str) {
    if let Some(runtime) = &outcome.runtime {
        say(&format!("headset    {} through {}", runtime.headset, runtime.runtime));
    }
    say(&format!("drawn on   {}", outcome.device));
    say(&format!("simulated  {device}: {} steps, {:.2} s let pass", outcome.steps, outcome.time_lost));
    let frames = &outcome.frames;
    say(&format!(
        "frames     {} drawn, {} empty, {} periods of the display missed",
        frames.drawn, frames.empty, frames.missed
    ));
    let line = |name: &str, p: &xr::Percentiles| {
        say(&format!("{name}  p50 {:.2}  p95 {:.2}  p99 {:.2} ms", p.p50, p.p95, p.p99));
    };
    line("drawing  ", &frames.work_ms);
    line("wake-ups ", &frames.wake_ms);
    say(&format!("quality    {:.0} % at least", outcome.least_quality * 100.0));
    say(&format!("sessions   {} ({})", outcome.sessions, outcome.states.join(", ")));
    for loss in &outcome.losses {
        say(&format!("lost       {loss}"));
    }
    if outcome.hung {
        say("the OpenXR runtime did not answer any more at the end");
    }
}
