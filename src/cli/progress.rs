//! How far it is: a bar on a terminal, a line now and then elsewhere. On standard error, and only for what takes long.

use super::output::{detail, is_talkative, note};
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

/// Nothing is shown for what takes less time.
const PATIENCE: Duration = Duration::from_secs(1);
/// Seconds between two plain lines.
const INTERVAL: Duration = Duration::from_secs(5);

/// Progress of one thing.
#[derive(Debug)]
pub(super) struct Progress {
    what: String,
    begin: Instant,
    said: Instant,
    bar: Option<ProgressBar>,
    is_terminal: bool,
}

impl Progress {
    /// Begins; nothing is shown yet.
    pub(super) fn new(what: impl Into<String>) -> Self {
        let (begin, is_terminal) = (Instant::now(), std::io::stderr().is_terminal());
        Self { what: what.into(), begin, said: begin, bar: None, is_terminal }
    }

    /// Says which share (0 to 1) is done, and of what in particular (may be empty).
    pub(super) fn at(&mut self, detail: &str, share: f64) {
        let since = self.begin.elapsed();
        if since < PATIENCE || !is_talkative() {
            return;
        }
        let left = left(since, share);
        let text = if detail.is_empty() { self.what.clone() } else { format!("{}: {detail}", self.what) };
        if self.is_terminal {
            let bar = self.bar.get_or_insert_with(|| {
                let style = ProgressStyle::with_template("{msg} [{bar:30}] {percent}% {prefix}");
                let bar = ProgressBar::new(1000);
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
                bar
            });
            bar.set_message(text);
            bar.set_prefix(left);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a share of a thousand"
            )]
            bar.set_position((share.clamp(0.0, 1.0) * 1000.0) as u64);
        } else if self.said.elapsed() >= INTERVAL || self.said == self.begin {
            self.said = Instant::now();
            note(&format!("{text} ({:.0} %, {left})", share * 100.0));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
        detail(&format!("{}: {:.2} s", self.what, self.begin.elapsed().as_secs_f64()));
    }
}

/// The time taken and the time left, by linear extrapolation.
fn left(since: Duration, share: f64) -> String {
    let seconds = since.as_secs_f64();
    let share = share.clamp(0.0, 1.0);
    if share < 0.01 {
        return clock(seconds);
    }
    format!("{}, {} left", clock(seconds), clock(seconds / share - seconds))
}

/// Seconds as people say them: 42 s, 3 min 5 s, 2 h 10 min.
fn clock(seconds: f64) -> String {
    #[allow(
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "not negative, and saturating"
    )]
    let whole = seconds.round() as u64;
    match whole {
        0..60 => format!("{whole} s"),
        60..3600 => format!("{} min {} s", whole / 60, whole % 60),
        _ => format!("{} h {} min", whole / 3600, whole / 60 % 60),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_that_of_the_rest() {
        let after = |seconds, share| left(Duration::from_secs(seconds), share);
        assert_eq!(after(30, 0.25), "30 s, 1 min 30 s left");
        assert_eq!(after(5, 0.001), "5 s", "too early to tell");
        assert_eq!(after(3600, 0.5), "1 h 0 min, 1 h 0 min left");
        assert_eq!(after(10, 1.0), "10 s, 0 s left");
    }
}
