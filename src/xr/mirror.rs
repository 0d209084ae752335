//! Small copies of the left eye's image, now and then, for a window.
//!
//! The headset's thread puts copies here and never waits. The window takes the newest. The session goes on when the window
//! fails.

use super::shared::lock;
use crate::picture::Image;
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// Shortest time between two copies: the window must not cost the user frames.
const PAUSE: Duration = Duration::from_millis(33);

/// The place where copies are handed over.
#[derive(Debug)]
pub struct Mirror {
    rows: u32,
    pause: Duration,
    is_closed: AtomicBool,
    latest: Mutex<Latest>,
}

#[derive(Debug, Default)]
struct Latest {
    image: Option<Image>,
    /// When a copy was wanted last.
    wanted: Option<Instant>,
    message: Option<String>,
}

impl Mirror {
    /// A place for copies of that many rows of pixels, or fewer where the eye has fewer.
    pub fn new(rows: u32) -> Self {
        let is_closed = AtomicBool::new(false);
        Self { rows: rows.max(1), pause: PAUSE, is_closed, latest: Mutex::default() }
    }

    /// The same with at least so much time between two copies.
    #[must_use]
    pub fn every(self, pause: Duration) -> Self {
        Self { pause: pause.max(PAUSE), ..self }
    }

    /// Whether copies are still wanted.
    pub fn is_open(&self) -> bool {
        !self.is_closed.load(Ordering::Relaxed)
    }

    /// Ends the copies; with a reason if not by intention.
    pub fn close(&self, why: Option<String>) {
        self.is_closed.store(true, Ordering::Relaxed);
        let mut latest = lock(&self.latest);
        latest.image = None;
        latest.message = why;
    }

    /// The newest copy, unless it was taken already.
    pub fn take(&self) -> Option<Image> {
        lock(&self.latest).image.take()
    }

    /// Why it was closed, if not by intention; given once.
    pub(super) fn take_message(&self) -> Option<String> {
        lock(&self.latest).message.take()
    }

    /// Pixels of the copy that is due at `now` of an eye's image of this size, if one is. The next is due a while later.
    pub(super) fn wants(&self, [width, height]: [u32; 2], now: Instant) -> Option<[u32; 2]> {
        let mut latest = lock(&self.latest);
        let is_due = latest.wanted.is_none_or(|wanted| now.saturating_duration_since(wanted) >= self.pause);
        if !self.is_open() || !is_due || height == 0 {
            return None;
        }
        latest.wanted = Some(now);
        let rows = self.rows.min(height);
        Some([(width * rows).div_ceil(height).max(1), rows])
    }

    /// Puts a copy here.
    pub(super) fn keep(&self, image: Image) {
        if self.is_open() {
            lock(&self.latest).image = Some(image);
        }
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test")]
mod tests {
    use super::*;

    #[test]
    fn copies_are_small_not_too_many_and_end_with_the_window() {
        let mirror = Mirror::new(600);
        let now = Instant::now();
        assert_eq!(mirror.wants([2064, 2208], now), Some([561, 600]));
        assert_eq!(mirror.wants([320, 240], now + PAUSE / 2), None);
        assert_eq!(mirror.wants([320, 240], now + PAUSE), Some([320, 240]));
        mirror.keep(Image::filled(2, 2, [1; 4]));
        assert_eq!(mirror.take().unwrap().width, 2);
        assert!(mirror.take().is_none());
        mirror.close(Some("the window is gone".to_owned()));
        mirror.keep(Image::filled(2, 2, [1; 4]));
        assert!(mirror.take().is_none() && mirror.wants([320, 240], now + 9 * PAUSE).is_none());
        assert_eq!(
            (mirror.take_message(), mirror.take_message()),
            (Some("the window is gone".to_owned()), None)
        );
    }
}
