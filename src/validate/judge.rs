//! A test, what it found, and whether that is good enough.

use super::scene::{Stage, Variant};
use crate::Error;
use crate::export::chart::Plot;
use serde::Serialize;
use std::cell::RefCell;
use std::fmt;
use std::path::PathBuf;

/// What a value must be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Criterion {
    /// Between two numbers, both included.
    Within(f64, f64),
    /// No more.
    AtMost(f64),
    /// No less.
    AtLeast(f64),
    /// Anything: it is said for the reader.
    Report,
}

impl Criterion {
    /// Whether a value passes; one that is no number never does.
    pub fn judge(self, value: f64) -> bool {
        match self {
            Self::Within(low, high) => value >= low && value <= high,
            Self::AtMost(high) => value <= high,
            Self::AtLeast(low) => value >= low,
            Self::Report => value.is_finite(),
        }
    }
}

impl fmt::Display for Criterion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let short = |value: f64| {
            let text = format!("{value:.3}");
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        };
        match *self {
            Self::Within(low, high) => write!(f, "{} to {}", short(low), short(high)),
            Self::AtMost(high) => write!(f, "at most {}", short(high)),
            Self::AtLeast(low) => write!(f, "at least {}", short(low)),
            Self::Report => f.write_str("none, reported only"),
        }
    }
}

/// One number that a test found.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The test and, after a point, what was measured.
    pub name: String,
    /// How the scene lay.
    pub variant: &'static str,
    /// What was measured; null if it is no number.
    pub value: f64,
    /// What it must be, with its unit.
    pub criterion: String,
    /// Whether it is.
    pub pass: bool,
}

/// One test.
#[derive(Debug, Clone, Copy)]
pub struct Test {
    /// Short name, for the command line.
    pub name: &'static str,
    /// What it is, in a line.
    pub title: &'static str,
    /// Where it comes from, and what is asked.
    pub about: &'static str,
    pub(super) run: fn(&Bench<'_>) -> Result<(), Error>,
    /// Whether it is also run turned and shifted.
    pub has_variants: bool,
}

/// What a test runs on, and where it says what it found.
#[derive(Debug)]
pub struct Bench<'a> {
    /// Bodies, backend, and what is broken on purpose.
    pub stage: &'a Stage,
    /// How scenes lie.
    pub variant: Variant,
    /// Fewer people and shorter runs.
    pub is_quick: bool,
    /// The folder with recorded crowds, if there is one.
    pub data: Option<PathBuf>,
    pub(super) test: &'static str,
    pub(super) found: RefCell<Vec<Outcome>>,
    pub(super) figures: RefCell<Vec<(String, Plot)>>,
    pub(super) skipped: RefCell<Vec<String>>,
    pub(super) device: RefCell<String>,
}

impl Bench<'_> {
    /// Judges a value. `unit` stands behind the criterion; it may be empty.
    pub(super) fn say(&self, what: &str, value: f64, criterion: Criterion, unit: &str) {
        let unit = if unit.is_empty() || criterion == Criterion::Report {
            String::new()
        } else {
            format!(" {unit}")
        };
        self.found.borrow_mut().push(Outcome {
            name: format!("{}.{what}", self.test),
            variant: self.variant.name(),
            value: (value * 1e4).round() / 1e4,
            criterion: format!("{criterion}{unit}"),
            pass: criterion.judge(value),
        });
    }

    /// Keeps a figure of the scene as it is.
    pub(super) fn draw(&self, name: &str, figure: impl FnOnce() -> Plot) {
        if self.variant == Variant::AsIs {
            self.figures.borrow_mut().push((name.to_owned(), figure()));
        }
    }

    /// A recorded crowd, or a word that it is not there.
    pub(super) fn file(&self, path: &str) -> Option<PathBuf> {
        let found = self.data.as_ref().map(|data| data.join(path)).filter(|path| path.is_file());
        if found.is_none() {
            let message = format!("{}: {path} is not there", self.test);
            let mut skipped = self.skipped.borrow_mut();
            if !skipped.contains(&message) {
                skipped.push(message);
            }
        }
        found
    }

    /// Runs a scene.
    pub(super) fn run(&self, scene: &super::scene::Scene) -> Result<super::scene::Run, Error> {
        let run = scene.run(self.stage, self.variant)?;
        self.device.borrow_mut().clone_from(&run.device);
        Ok(run)
    }
}
