//! What lives as long as a session.

use super::miniature::Miniature;
use super::next::{Next, Venue};
use super::pace::FrameTimes;
use super::session::{Frame, Session};
use super::shown::Shown;
use crate::gpu::FRAMES_IN_FLIGHT;
use crate::render::Show;
use std::time::{Duration, Instant};

/// Longest time from frame to frame, s. A runtime that hung gives display times of long ago.
const LONGEST_FRAME: f32 = 0.1;

/// The host's part of a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct HostWork {
    /// From acquiring its image to handing it over.
    pub(super) handed_over: Duration,
    /// From the wake-up on, without waits for the device and for images.
    pub(super) host: Duration,
}

/// What lives as long as a session, in the order in which it is dropped.
pub(super) struct Running {
    pub(super) clock: Clock,
    /// The world that comes next, on the session's device.
    pub(super) next: Next,
    pub(super) venue: Venue,
    /// Waits for the frames that the device still draws.
    pub(super) show: Show,
    pub(super) miniature: Miniature,
    /// The host's part of the frames that the device may still draw, by slot.
    pub(super) in_flight: [Option<HostWork>; FRAMES_IN_FLIGHT],
    pub(super) session: Session,
}

impl Running {
    pub(super) fn new(show: Show, session: Session, venue: Venue) -> Self {
        Self {
            clock: Clock::default(),
            next: Next::default(),
            venue,
            show,
            miniature: Miniature::default(),
            in_flight: [None; FRAMES_IN_FLIGHT],
            session,
        }
    }
}

/// The time from frame to frame.
#[derive(Debug, Default)]
pub(super) struct Clock {
    display: Option<i64>,
    woke: Option<Instant>,
    pub(super) shown: Shown,
}

/// From one frame to the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Step {
    /// For motion: bounded.
    pub(super) seconds: f32,
    /// Periods of the display.
    pub(super) periods: u64,
    /// By the display's times, ms.
    pub(super) since_ms: f32,
}

impl Clock {
    /// The time since the frame before.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        reason = "short times in nanoseconds"
    )]
    pub(super) fn step(&mut self, frame: &Frame, times: &mut FrameTimes) -> Step {
        let now = Instant::now();
        if let Some(before) = self.woke.replace(now) {
            times.woke(now - before);
        }
        let display = frame.display.as_nanos();
        let since = self.display.replace(display).map_or(0, |before| display - before);
        let period = i64::try_from(frame.period.as_nanos()).unwrap_or(0).max(1);
        let periods = u64::try_from((since + period / 2) / period).unwrap_or(0).min(1_000);
        let seconds = (since as f32 * 1e-9).clamp(0.0, LONGEST_FRAME);
        Step { seconds, periods, since_ms: since as f32 * 1e-6 }
    }
}

#[cfg(test)]
#[allow(clippy::float_cmp, reason = "limits are exact")]
mod tests {
    use super::*;
    use openxr as xr;

    #[test]
    fn display_times_that_cannot_be_are_bounded() {
        let mut clock = Clock::default();
        let mut times = FrameTimes::default();
        let mut at = |display: i64| {
            let period = Duration::from_millis(20);
            let frame = Frame { display: xr::Time::from_nanos(display), period, wants_image: true };
            let Step { seconds, periods, .. } = clock.step(&frame, &mut times);
            (seconds, periods)
        };
        assert_eq!(at(1_000_000_000), (0.0, 0));
        let (seconds, periods) = at(1_020_000_000);
        assert!((seconds - 0.02).abs() < 1e-6 && periods == 1);
        // the service hung: into the past, then three seconds on
        assert_eq!(at(500_000_000).0, 0.0);
        assert_eq!(at(3_500_000_000), (LONGEST_FRAME, 150));
    }
}
