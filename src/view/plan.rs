//! What a window is opened for.

use crate::render::Quality;
use crate::scenario::{Condition, GazeMode};
use std::path::PathBuf;

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
    /// How much is spent on light and surfaces.
    pub quality: Quality,
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
            quality: Quality::Low,
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

/// Names of the choices, in the order of the panel.
pub(super) const CONDITIONS: [(Condition, &str); 3] =
    [(Condition::Baseline, "baseline"), (Condition::EvaO, "eva-o"), (Condition::EvaG, "eva-g")];
pub(super) const GAZE_MODES: [(GazeMode, &str); 2] =
    [(GazeMode::Natural, "natural"), (GazeMode::Paper, "paper")];
