//! The desktop window: a crowd to look at, to stop, to ask and to film.
//!
//! [`run`] opens the window and gives it the crowd of a scene. Every frame the crowd is stepped by the clock,
//! drawn by the one renderer into an image of the window's size, the panel drawn over it, and the whole copied to the window.
//!
//! ```no_run
//! use gaitway::scene::Scene;
//! use gaitway::view::{self, Plan};
//!
//! # fn main() -> gaitway::Result<()> {
//! let plan = Plan { has_markers: true, seconds: Some(60.0), ..Plan::default() };
//! let outcome = view::run(plan, Scene::load("garden")?.agents(200))?;
//! println!("{} frames on {}", outcome.frames, outcome.device);
//! # Ok(())
//! # }
//! ```
//!
//! A machine without a window says so; `gaitway render` draws the same images into files.

mod camera;
mod canvas;
mod crowd;
mod mirror;
mod panel;
pub mod pick;
mod shares;
mod surface;
mod times;
mod window;

pub use camera::{CameraMode, Rig};
pub use crowd::Picked;
pub use mirror::{Mirrored, Source, mirror};
pub use times::MeanTimes;
pub use window::run;

use crate::scenario::{Condition, GazeMode};
use serde::Serialize;
use std::path::PathBuf;

/// There is no window, or not any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no display to open a window on.
    #[error("no window can be opened: {0}")]
    NoDisplay(String),
    /// No Vulkan device can show frames in the window.
    #[error("no Vulkan device can show pictures in a window here; found: {0}")]
    NoPresenter(String),
    /// The window's pixels are of no kind that frames can be shown in.
    #[error("the window takes none of the colour formats of pictures (8 bits, sRGB); it takes {0}")]
    NoFormat(String),
    /// The panel could not be drawn.
    #[error("the panel cannot be drawn: {0}")]
    Panel(String),
}

impl Error {
    /// What the user can do about it.
    pub const fn hint(&self) -> Option<&'static str> {
        match self {
            Self::NoDisplay(_) | Self::NoPresenter(_) | Self::NoFormat(_) => {
                Some("`gaitway render` draws the same pictures into files, without a window")
            }
            Self::Panel(_) => None,
        }
    }
}

/// What the panel can change about the crowd itself.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Which of the paper's three algorithms moves the agents.
    pub condition: Condition,
    /// Share of each emotion, any scale, in the order of [`crate::Emotion::ALL`].
    pub shares: [f32; 4],
}

/// What the window shows and how.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Pixels of the window at the beginning.
    pub size: (u32, u32),
    /// Rings on the ground in the colours of the emotions.
    pub has_markers: bool,
    /// Whether agents look at the camera, and not at the scene's user.
    pub eyes_follow_camera: bool,
    /// Close the window after this time, s.
    pub seconds: Option<f64>,
    /// The window as it was last, with its panel, goes into this file.
    pub shot: Option<PathBuf>,
    /// What is seen goes into this video from the beginning.
    pub record: Option<PathBuf>,
    /// Point of the window (pixels from the top left) that is clicked at after the first frames.
    pub click: Option<(u32, u32)>,
    /// Whether the crowd stands still at the beginning.
    pub is_paused: bool,
    /// Takes lines for the user, besides those in the panel.
    pub note: fn(&str),
}

impl Default for Plan {
    /// A window of 1280 by 720 pixels until it is closed.
    fn default() -> Self {
        Self {
            size: (1280, 720),
            has_markers: false,
            eyes_follow_camera: false,
            seconds: None,
            shot: None,
            record: None,
            click: None,
            is_paused: false,
            note: |_| {},
        }
    }
}

/// What came of a window.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// The device that draws.
    pub device: String,
    /// Where the crowd is simulated.
    pub simulated_on: String,
    /// Frames shown.
    pub frames: u64,
    /// Steps of the crowd.
    pub steps: u32,
    /// How often the window's images were made (at the beginning, and when its size changed).
    pub swapchains: u32,
    /// Mean time of the last steps.
    pub step_ms: MeanTimes,
    /// Mean time of the last frames.
    pub picture_ms: MeanTimes,
    /// Pixels of the window at the end.
    pub size: [u32; 2],
    /// Who was picked last.
    pub picked: Option<Picked>,
    /// Frames that were written.
    pub shots: Vec<PathBuf>,
    /// Videos that were written.
    pub videos: Vec<PathBuf>,
}

/// Names of the choices, in the order of the panel.
const CONDITIONS: [(Condition, &str); 3] =
    [(Condition::Baseline, "baseline"), (Condition::EvaO, "eva-o"), (Condition::EvaG, "eva-g")];
const GAZE_MODES: [(GazeMode, &str); 2] = [(GazeMode::Natural, "natural"), (GazeMode::Paper, "paper")];
