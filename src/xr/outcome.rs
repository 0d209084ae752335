//! What came of a session.

use super::pace::FrameSummary;
use super::runtime::RuntimeInfo;
use serde::Serialize;

/// A time without frames.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outage {
    /// Why the session was lost, in one line.
    pub reason: String,
    /// Until the user saw the crowd again, or the next loss, or the end, s.
    pub seconds: f64,
    /// Steps of the crowd meanwhile.
    pub steps: u64,
}

/// What came of a session.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct Outcome {
    /// Runtime and headset, of the last session.
    pub runtime: Option<RuntimeInfo>,
    /// The device that drew.
    pub device: String,
    /// Refresh rate of the display, Hz, where the runtime reports it.
    pub refresh_rate: Option<f32>,
    /// Refresh rates on offer, Hz.
    pub refresh_rates: Vec<f32>,
    /// How the display blends frames with the room: `opaque`, `additive` or `alpha-blend`.
    pub blend_mode: &'static str,
    /// Whether the runtime takes the depth of frames.
    pub takes_depth: bool,
    /// Triangles of the images that the lenses hide and nothing is drawn in, left and right.
    pub hidden_triangles: [usize; 2],
    /// Frames of all sessions.
    pub frames: FrameSummary,
    /// Sessions that were begun.
    pub sessions: u32,
    /// The sessions that were lost.
    pub losses: Vec<Outage>,
    /// States that sessions went through, in order.
    pub states: Vec<&'static str>,
    /// Least quality that the governor chose, 0 to 1.
    pub least_quality: f32,
    /// Least share of the width and height of the images that it had drawn, 0 to 1.
    pub least_resolution: f32,
    /// Steps of the crowd.
    pub steps: u32,
    /// How often the crowd's device was lost and opened again.
    pub device_losses: u32,
    /// When the last step began, s after the first.
    pub seconds: f64,
    /// Time that the crowd was not stepped for because its steps took too long, s.
    pub time_lost: f64,
    /// Images that a mirror showed.
    pub mirrored: u64,
    /// Why it ended, in one line.
    pub ended: String,
    /// Whether the runtime, or the graphics device, had stopped answering at the end.
    pub hung: bool,
}
