//! What came of a window.

use super::crowd::Picked;
use super::times::MeanTimes;
use serde::Serialize;
use std::path::PathBuf;

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
