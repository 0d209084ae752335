//! `gaitway view`: a crowd in a window.

use super::output::{note, say, say_json};
use super::scene::{Scene, SceneArguments, check_seconds};
use super::stage::{atmosphere, size};
use super::usage;
use crate::Error;
use crate::export::image::write_png;
use crate::picture::Image;
use crate::render::{Markers, Settings};
use crate::scenario::Shares;
use crate::sim::{Simulation, bodies};
use crate::view::{self, Choice, Director, Outcome, Plan, Start};
use clap::Args;
use std::path::{Path, PathBuf};

/// Most files that are tried for a free name.
const MOST_FILES: u32 = 10_000;

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway view crossing --agents 500\n  gaitway view garden --eyes camera\n  gaitway view \
                  crossing --seconds 5 --shot window.png --json\n\nDrag to turn, right drag or W A S D Q E to move, \
                  wheel to come nearer, click to pick somebody.\nSpace pauses, `.` does one step, F follows who is \
                  picked, Tab hides the panel, F12 keeps a picture, F9 a video."
)]
pub(super) struct Arguments {
    #[command(flatten)]
    scene: SceneArguments,
    /// Pixels of the window
    #[arg(long, default_value = "1280x800", value_parser = size, value_name = "WxH")]
    size: (u32, u32),
    /// Close the window after this time
    #[arg(long, value_name = "SECONDS")]
    seconds: Option<f64>,
    /// Whom agents look at: the user where the scenario has them (without one: the middle), or the camera
    #[arg(long, value_enum, default_value_t)]
    eyes: Eyes,
    /// Rings on the ground in the colours of the emotions
    #[arg(long)]
    markers: bool,
    /// Begin with a crowd that stands still
    #[arg(long)]
    pause: bool,
    /// Write the window, with its panel, when it closes after --seconds
    #[arg(long, value_name = "FILE.png", requires = "seconds")]
    shot: Option<PathBuf>,
    /// Write what is seen, without the panel, from the beginning
    #[arg(long, value_name = "FILE.mp4|FILE.y4m")]
    record: Option<PathBuf>,
    /// Click at this pixel of the window after the first pictures
    #[arg(long, value_name = "X,Y", value_parser = pixel)]
    click: Option<(u32, u32)>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Whether the scenes are asked for, and whether in JSON.
    pub(super) const fn lists(&self) -> (bool, bool) {
        (self.scene.list, self.json)
    }
}

/// Whom agents look at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
enum Eyes {
    #[default]
    User,
    Camera,
}

/// A pixel, written `640,400`.
fn pixel(text: &str) -> Result<(u32, u32), String> {
    let parts =
        text.split_once(',').and_then(|(x, y)| Some((x.trim().parse().ok()?, y.trim().parse().ok()?)));
    parts.ok_or_else(|| "use X,Y in pixels from the top left, such as 640,400".to_owned())
}

/// Runs the subcommand.
pub(super) fn run(arguments: &Arguments) -> Result<bool, Error> {
    let seconds = arguments.seconds.map(|seconds| check_seconds("--seconds", seconds)).transpose()?;
    let png = |path: &Path| path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    if let Some(shot) = arguments.shot.as_deref().filter(|shot| !png(shot)) {
        return Err(usage(format!("--shot {}: a picture ends in .png", shot.display()), "use FILE.png"));
    }
    let (backend, device) = arguments.scene.place.get()?;
    let mut scene = Scene::load(&arguments.scene)?;
    let (eyes, _) = scene.onlooker();
    let (scenario, geometry) = (&scene.scenario, &scene.geometry);
    let scenery = geometry.scenery();
    let Shares { happy, angry, sad, neutral } = scenario.population.emotions;
    let plan = Plan {
        title: scenario.name.clone(),
        size: arguments.size,
        backend,
        device: device.map(str::to_owned),
        scenery,
        settings: Settings {
            atmosphere: atmosphere(scenario.layout),
            markers: arguments.markers.then(Markers::default),
            ..Settings::default()
        },
        gaze: scenario.gaze,
        choice: Choice { condition: scenario.condition, shares: [happy, angry, sad, neutral] },
        overview: geometry.overview,
        user_eyes: (arguments.eyes == Eyes::User).then_some(eyes),
        seconds,
        shot: arguments.shot.clone(),
        record: arguments.record.clone(),
        click: arguments.click,
        is_paused: arguments.pause,
    };
    let mut hall = Hall { arguments: &arguments.scene, scene, is_cast: false };
    let _heed = crate::stop::heed();
    let outcome = view::run(plan, &mut hall)?;
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
}

/// Where crowds are cast.
struct Hall<'a> {
    arguments: &'a SceneArguments,
    scene: Scene,
    /// Whether the scene as it was loaded is on already.
    is_cast: bool,
}

/// A file in the working folder that is not there yet.
fn free_name(ending: &str) -> PathBuf {
    let name = |number: u32| PathBuf::from(format!("gaitway-{number:04}.{ending}"));
    (1..MOST_FILES).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(MOST_FILES))
}

impl Director for Hall<'_> {
    fn cast(&mut self, choice: &Choice) -> Result<Start, Error> {
        if self.is_cast {
            let [happy, angry, sad, neutral] = choice.shares;
            let shares = Shares { happy, angry, sad, neutral };
            self.scene = Scene::load_with(self.arguments, |scenario| {
                scenario.condition = choice.condition;
                scenario.population.emotions = shares;
            })?;
        }
        self.is_cast = true;
        let mut store = self.scene.store()?;
        let meshes = bodies::fill(&mut store, &self.scene.cast, bodies::SMALLEST_STORAGE_RANGE);
        let crowd = &self.scene.crowd;
        let emotions = crowd.agents.iter().chain(&crowd.outsiders).map(|agent| agent.emotion).collect();
        Ok(Start { store, meshes, emotions })
    }

    fn step(&mut self, simulation: &mut Simulation, count: u32) -> Result<(), Error> {
        self.scene.step(simulation, count)
    }

    fn keep(&mut self, image: &Image, file: Option<&Path>) -> Result<PathBuf, Error> {
        let path = file.map_or_else(|| free_name("png"), Path::to_owned);
        write_png(&path, image).map_err(crate::export::Error::from)?;
        Ok(path)
    }

    fn film(&mut self) -> PathBuf {
        free_name("mp4")
    }

    fn note(&mut self, line: &str) {
        note(line);
    }
}

fn print(outcome: &Outcome) {
    let [width, height] = outcome.size;
    say(&format!("drawn on   {}", outcome.device));
    say(&format!("simulated  {}: {} steps", outcome.simulated_on, outcome.steps));
    say(&format!("pictures   {}, {width}x{height}", outcome.frames));
    if let Some(person) = &outcome.picked {
        let [x, z] = person.position;
        say(&format!(
            "picked     agent {}, {}, {:.2} m/s at ({x:.2}, {z:.2}) m",
            person.id, person.emotion, person.speed
        ));
    }
    for file in outcome.shots.iter().chain(&outcome.videos) {
        say(&format!("written    {}", file.display()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_read_and_wrong_ones_refused() {
        assert_eq!(pixel("640, 400"), Ok((640, 400)));
        for wrong in ["640", "-1,2", "a,b", ""] {
            assert!(pixel(wrong).unwrap_err().contains("640,400"), "{wrong}");
        }
    }
}
