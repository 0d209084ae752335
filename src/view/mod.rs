//! The desktop window: a crowd to look at, to stop, to ask and to film.
//!
//! [`run`] opens the window and gives it a crowd that a [`Director`] casts. Every frame the crowd is stepped by the clock,
//! drawn by the one renderer into an image of the window's size, the panel drawn over it, and the whole copied to the window.
//! A machine without a window says so; `gaitway render` draws the same pictures into files.

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
pub use crowd::Person;
pub use mirror::{Mirrored, Source, mirror};
pub use times::MeanTimes;
pub use window::run;

use crate::kernels::Store;
use crate::scenario::{Condition, EnvironmentMesh, Gaze, GazeMode};
use crate::sim::Backend;
use crate::sim::bodies::MeshBuffers;
use glam::Vec3;
use serde::Serialize;
use std::path::PathBuf;

/// There is no window, or not any more.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// There is no display to open a window on.
    #[error("no window can be opened: {0}")]
    NoDisplay(String),
    /// No Vulkan device can show pictures in the window.
    #[error("no Vulkan device can show pictures in a window here; found: {0}")]
    NoPresenter(String),
    /// The window's pixels are of no kind that pictures can be shown in.
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

/// A crowd at its start.
#[derive(Debug)]
pub struct Start {
    /// The buffers, with bodies filled in.
    pub store: Store,
    /// The bodies' meshes.
    pub meshes: MeshBuffers,
    /// Emotion weights of each agent.
    pub emotions: Vec<[f32; 4]>,
}

/// Who casts crowds.
pub trait Director {
    /// The crowd of a choice; always the same people in number and places, with other feelings.
    ///
    /// # Errors
    /// When the choice cannot be cast.
    fn cast(&mut self, choice: &Choice) -> Result<Start, crate::Error>;

    /// Does steps: recorded people among the crowd are led.
    ///
    /// # Errors
    /// When the simulation fails.
    fn step(&mut self, simulation: &mut crate::sim::Simulation, count: u32) -> Result<(), crate::Error>;

    /// Keeps a picture under a name of its own or the given one; the file's name.
    ///
    /// # Errors
    /// When it cannot be written.
    fn keep(
        &mut self,
        image: &crate::picture::Image,
        file: Option<&std::path::Path>,
    ) -> Result<PathBuf, crate::Error>;

    /// A file for a video that the user asks for.
    fn film(&mut self) -> PathBuf;

    /// Tells the user one line.
    fn note(&mut self, line: &str);
}

/// What the window shows and how.
#[derive(Debug, Clone)]
pub struct Plan {
    /// Name in the title.
    pub title: String,
    /// Pixels of the window at the beginning.
    pub size: (u32, u32),
    /// Where to simulate.
    pub backend: Backend,
    /// Vulkan device, by name or number.
    pub device: Option<String>,
    /// The scenery.
    pub scenery: EnvironmentMesh,
    /// Light and quality; the size follows the window.
    pub settings: crate::render::Settings,
    /// How agents gaze.
    pub gaze: Gaze,
    /// The crowd at the beginning.
    pub choice: Choice,
    /// The camera at the beginning: eye, and what it looks at, m.
    pub overview: (Vec3, Vec3),
    /// The eyes that agents look at, m; none: the camera's.
    pub user_eyes: Option<Vec3>,
    /// Close the window after this time, s.
    pub seconds: Option<f64>,
    /// The window as it was last, with its panel, goes into this file.
    pub shot: Option<PathBuf>,
    /// What is seen goes into this video from the beginning.
    pub record: Option<PathBuf>,
    /// Point of the window (pixels from the top left) that is clicked at after the first pictures.
    pub click: Option<(u32, u32)>,
    /// Whether the crowd stands still at the beginning.
    pub is_paused: bool,
}

/// What came of it.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// The device that draws.
    pub device: String,
    /// Where the crowd is simulated.
    pub simulated_on: String,
    /// Pictures shown.
    pub frames: u64,
    /// Steps of the crowd.
    pub steps: u32,
    /// How often the window's images were made anew (at the beginning, and when its size changed).
    pub swapchains: u32,
    /// How long steps took lately.
    pub step_ms: MeanTimes,
    /// How long pictures took lately.
    pub picture_ms: MeanTimes,
    /// Pixels of the window at the end.
    pub size: [u32; 2],
    /// Who was picked last.
    pub picked: Option<Person>,
    /// Pictures that were written.
    pub shots: Vec<PathBuf>,
    /// Videos that were written.
    pub videos: Vec<PathBuf>,
}

/// Names of the choices, in the order of the panel.
const CONDITIONS: [(Condition, &str); 3] =
    [(Condition::Baseline, "baseline"), (Condition::EvaO, "eva-o"), (Condition::EvaG, "eva-g")];
const GAZE_MODES: [(GazeMode, &str); 2] = [(GazeMode::Natural, "natural"), (GazeMode::Paper, "paper")];
