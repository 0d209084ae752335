//! `gaitway view`: a crowd in a window.

use super::output::{note, say, say_json};
use super::render::size;
use super::scene::{SceneArguments, check_seconds};
use super::usage;
use crate::Error;
use crate::render::Quality;
use crate::view::{self, Outcome, Plan};
use clap::Args;
use std::path::{Path, PathBuf};

#[derive(Debug, Args)]
#[command(
    after_help = "Examples:\n  gaitway view crossing --agents 500\n  gaitway view garden --eyes camera\n  gaitway view \
                  crossing --seconds 5 --shot window.png --json\n\nDrag to turn, right drag or W A S D Q E to move, \
                  wheel to come nearer, click to pick a person.\nSpace pauses, `.` does one step, F follows the \
                  picked person, Tab hides the panel, F12 keeps a picture, F9 a video."
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
    /// Target of the agents' gaze: the scenario's user (without one: the middle), or the camera
    #[arg(long, value_enum, default_value_t)]
    eyes: Eyes,
    /// Rings on the ground in the colours of the emotions
    #[arg(long)]
    markers: bool,
    /// Light and surfaces: low (the fastest), medium or high
    #[arg(long, default_value = "low", value_name = "QUALITY")]
    quality: Quality,
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
    /// Whether to list the scenes, and whether in JSON.
    pub(super) const fn lists(&self) -> (bool, bool) {
        (self.scene.list, self.json)
    }
}

/// Target of the agents' gaze.
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
    let plan = Plan {
        size: arguments.size,
        has_markers: arguments.markers,
        quality: arguments.quality,
        eyes_follow_camera: arguments.eyes == Eyes::Camera,
        seconds,
        shot: arguments.shot.clone(),
        record: arguments.record.clone(),
        click: arguments.click,
        is_paused: arguments.pause,
        note,
    };
    let _heed = crate::stop::heed();
    let outcome = view::run(plan, arguments.scene.builder()?)?;
    if arguments.json {
        say_json(&outcome)?;
    } else {
        print(&outcome);
    }
    Ok(true)
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
