//! How far it is: a bar on a terminal, a line now and then elsewhere. On standard error, and only for what takes long.

use super::output::note;
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
        if self.begin.elapsed() < PATIENCE {
            return;
        }
        let text = if detail.is_empty() { self.what.clone() } else { format!("{}: {detail}", self.what) };
        if self.is_terminal {
            let bar = self.bar.get_or_insert_with(|| {
                let style = ProgressStyle::with_template("{msg} [{bar:30}] {percent}% {elapsed}");
                let bar = ProgressBar::new(1000);
                bar.set_style(style.unwrap_or_else(|_| ProgressStyle::default_bar()).progress_chars("=> "));
                bar
            });
            bar.set_message(text);
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a share of a thousand"
            )]
            bar.set_position((share.clamp(0.0, 1.0) * 1000.0) as u64);
        } else if self.said.elapsed() >= INTERVAL || self.said == self.begin {
            self.said = Instant::now();
            note(&format!("{text} ({:.0} %, {:.0} s)", share * 100.0, self.begin.elapsed().as_secs_f64()));
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}
