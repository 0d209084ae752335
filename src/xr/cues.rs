//! What a stage asks of the headset's thread, and how far that thread is.

use super::question::{Answered, Question};
use super::surroundings::Surroundings;
use std::sync::Arc;

/// What the headset is to show.
#[derive(Debug, Clone, Default)]
pub(super) struct Cues {
    /// The world to make ready beside the frames.
    pub(super) next: Option<Arc<Surroundings>>,
    /// The world that is to be seen as soon as it is ready.
    pub(super) on_stage: u64,
    /// How far everything is to be covered with grey, 0 to 1; reached within [`FADE_SECONDS`].
    pub(super) fade: f32,
    /// Whether the grey is wanted in the next frame instead.
    pub(super) fades_at_once: bool,
    /// The panel that stands in the room.
    pub(super) question: Option<Arc<Question>>,
}

/// A full fade takes so long, s.
pub(super) const FADE_SECONDS: f32 = 0.3;

/// Longest time between two frames that counts as seen, s: after that the picture is gone, or the runtime hangs.
pub(super) const LONGEST_SEEN: f64 = 1.0;

/// How far the headset's thread is.
#[derive(Debug, Clone, Default)]
pub(super) struct Report {
    /// The world that is ready to be shown next.
    pub(super) ready: u64,
    /// The world that is seen.
    pub(super) on_stage: u64,
    /// How far everything is covered with grey.
    pub(super) fade: f32,
    /// The frames so far.
    pub(super) frames: FrameCount,
    /// The last answer, and to which panel.
    pub(super) answer: Option<(u64, Answered)>,
}

/// Frames that were shown.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FrameCount {
    /// Frames handed over with an image.
    pub drawn: u64,
    /// Periods of the display for which no frame was ready.
    pub missed: u64,
    /// Longest time from one frame to the next, ms.
    pub longest_ms: f32,
    /// Time that they were seen for, s. Of a gap between two frames no more than a second counts.
    pub seconds: f64,
}

impl FrameCount {
    /// Counts a frame, so many periods and ms after the one before.
    pub(super) fn add(&mut self, periods: u64, since_ms: f32) {
        self.drawn += 1;
        self.missed += periods.saturating_sub(1);
        self.longest_ms = self.longest_ms.max(since_ms);
        self.seconds += (f64::from(since_ms) * 1e-3).clamp(0.0, LONGEST_SEEN);
    }

    /// Those after `before`; the longest time is that since it was set to 0.
    pub(super) fn since(self, before: Self) -> Self {
        let (drawn, missed) = (self.drawn - before.drawn, self.missed - before.missed);
        Self { drawn, missed, longest_ms: self.longest_ms, seconds: self.seconds - before.seconds }
    }
}
