//! A test, what it found, and whether that is good enough.

use super::scene::{Equipment, Experiment, Run, Variant};
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
}

impl Criterion {
    /// Whether a value passes; one that is no number never does.
    pub fn judge(self, value: f64) -> bool {
        match self {
            Self::Within(low, high) => value >= low && value <= high,
            Self::AtMost(high) => value <= high,
            Self::AtLeast(low) => value >= low,
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
        }
    }
}

/// The origin of a criterion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// The document or publication, with version and number.
    Source(&'static str),
    /// The project's own.
    Ours,
}

impl fmt::Display for Origin {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Source(name) => name,
            Self::Ours => "ours",
        })
    }
}

impl Serialize for Origin {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
    }
}

/// How many draws of a value must meet its criterion.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Need {
    /// Nine in ten.
    Most,
    /// Every one.
    All,
}

/// One number that a draw of a test found.
#[derive(Debug, Clone)]
pub(super) struct Finding {
    what: String,
    value: f64,
    unit: &'static str,
    /// None for what is shown only.
    judged: Option<(Criterion, Origin, Need)>,
}

/// One number that a test found, over all its draws.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Outcome {
    /// The test and, after a point, what was measured.
    pub name: String,
    /// The value of the first draw: the scene as described. Null if it is no number.
    pub value: f64,
    /// Its unit.
    pub unit: &'static str,
    /// What it must be; nothing for what is shown and not judged.
    pub criterion: Option<String>,
    /// The origin of that criterion.
    pub origin: Option<Origin>,
    /// Whether enough draws meet it; true for what is not judged.
    pub pass: bool,
    /// How often the test was drawn.
    pub draws: usize,
    /// How many of the draws meet the criterion.
    pub passes: usize,
    /// Least and greatest value of the draws; null if one is no number.
    pub range: [f64; 2],
    /// With half as many people more, and with twice as many; empty where a scene has one size.
    pub larger: Vec<f64>,
}

impl Outcome {
    /// What all draws found of one value; `draws` has at least one.
    pub(super) fn of(name: String, draws: &[Finding], larger: Vec<f64>) -> Option<Self> {
        let first = draws.first()?;
        let rounded = |value: f64| (value * 1e4).round() / 1e4;
        let passes = draws.iter().filter(|f| f.judged.is_none_or(|judged| judged.0.judge(f.value))).count();
        let enough = match first.judged.map(|judged| judged.2) {
            Some(Need::All) => draws.len(),
            Some(Need::Most) => (draws.len() * 9).div_ceil(10),
            None => 0,
        };
        let is_known = draws.iter().all(|f| !f.value.is_nan());
        let end = |better: fn(f64, f64) -> f64| {
            let ends = draws.iter().map(|f| f.value).reduce(better);
            ends.filter(|_| is_known).unwrap_or(f64::NAN)
        };
        Some(Self {
            name,
            value: rounded(first.value),
            unit: first.unit,
            criterion: first.judged.map(|judged| judged.0.to_string()),
            origin: first.judged.map(|judged| judged.1),
            pass: passes >= enough,
            draws: draws.len(),
            passes,
            range: [end(f64::min), end(f64::max)].map(rounded),
            larger: larger.into_iter().map(rounded).collect(),
        })
    }

    /// Whether it has a criterion.
    pub const fn is_judged(&self) -> bool {
        self.criterion.is_some()
    }
}

/// What may differ from one draw of a test to the next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Draws {
    /// Nothing: the scene has no random draws, or the walkers are recorded.
    One,
    /// The orientation and place of the scene on the grid.
    Turned,
    /// Seed of start places and random draws.
    Seeds,
    /// Both.
    TurnedSeeds,
}

impl Draws {
    /// Seed and layout of the draws, `most` of them at most.
    pub(super) fn all(self, most: usize) -> Vec<(u32, Variant)> {
        let turned = |number: usize| Variant::ALL[number % Variant::ALL.len()];
        let seeds = (1_u32..).take(most.max(1));
        match self {
            Self::One => vec![(1, Variant::AsIs)],
            Self::Turned => (0..most.clamp(1, Variant::ALL.len())).map(|n| (1, turned(n))).collect(),
            Self::Seeds => seeds.map(|seed| (seed, Variant::AsIs)).collect(),
            Self::TurnedSeeds => seeds.enumerate().map(|(n, seed)| (seed, turned(n))).collect(),
        }
    }
}

/// One test.
#[derive(Debug, Clone, Copy)]
pub struct Test {
    /// Short name, for the command line.
    pub name: &'static str,
    /// What it is, in a line.
    pub title: &'static str,
    /// Its source, with version and number; "after ..." where scene or measure are not quite the source's.
    pub source: &'static str,
    /// The scene and the question.
    pub about: &'static str,
    pub(super) run: fn(&Bench<'_>) -> Result<(), Error>,
    /// What differs from draw to draw.
    pub draws: Draws,
    /// Whether it also runs with more people.
    pub grows: bool,
}

/// Factors of the number of people, by size.
pub(super) const SIZES: [f32; 3] = [1.0, 1.5, 2.0];

/// What a draw of a test runs on, and where it puts its findings.
#[derive(Debug)]
pub struct Bench<'a> {
    /// Bodies, backend, and what is broken on purpose.
    pub stage: &'a Equipment,
    /// How scenes lie.
    pub variant: Variant,
    /// Seed of start places and random draws; 1 is the first.
    pub seed: u32,
    /// Index into [`SIZES`].
    pub(super) size: usize,
    /// Fewer people and shorter runs.
    pub is_quick: bool,
    /// The folder with recorded crowds, if there is one.
    pub data: Option<PathBuf>,
    pub(super) test: &'static str,
    pub(super) found: RefCell<Vec<Finding>>,
    pub(super) figures: RefCell<Vec<(String, Plot)>>,
    pub(super) skipped: RefCell<Vec<String>>,
    pub(super) device: RefCell<String>,
}

impl Bench<'_> {
    /// Judges a value: nine in ten draws must meet the criterion.
    pub(super) fn judge(
        &self,
        what: &str,
        value: f64,
        criterion: Criterion,
        unit: &'static str,
        origin: Origin,
    ) {
        self.find(what, value, unit, Some((criterion, origin, Need::Most)));
    }

    /// Judges a count that must be 0 in every draw.
    pub(super) fn never(&self, what: &str, count: usize, unit: &'static str, origin: Origin) {
        #[allow(clippy::cast_precision_loss, reason = "thousands of people")]
        let count = count as f64;
        self.find(what, count, unit, Some((Criterion::AtMost(0.0), origin, Need::All)));
    }

    /// Shows a value that is not judged.
    pub(super) fn report(&self, what: &str, value: f64, unit: &'static str) {
        self.find(what, value, unit, None);
    }

    fn find(&self, what: &str, value: f64, unit: &'static str, judged: Option<(Criterion, Origin, Need)>) {
        self.found.borrow_mut().push(Finding { what: what.to_owned(), value, unit, judged });
    }

    /// As many people as a scene of this size has, with `count` in the first size.
    #[allow(
        clippy::cast_precision_loss,
        clippy::cast_possible_truncation,
        clippy::cast_sign_loss,
        reason = "thousands of people"
    )]
    pub(super) fn people(&self, count: usize) -> usize {
        (count as f32 * SIZES[self.size]).round() as usize
    }

    /// The length that gives the people of this size the density of `people` in `length` m.
    pub(super) fn along(&self, length: f32) -> f32 {
        length * SIZES[self.size]
    }

    /// A stream of places for this draw's seed.
    pub(super) const fn lane(&self, lane: u32) -> u32 {
        lane + 1000 * (self.seed - 1)
    }

    /// Keeps a figure of the scene as it is.
    pub(super) fn draw(&self, name: &str, figure: impl FnOnce() -> Plot) {
        self.figures.borrow_mut().push((name.to_owned(), figure()));
    }

    /// A recorded crowd; a note where it is absent.
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

    /// Runs a scene with this draw's seed.
    pub(super) fn run(&self, scene: &Experiment) -> Result<Run, Error> {
        let mut seeded = scene.clone();
        seeded.scenario.seed = u64::from(self.seed);
        let run = seeded.run(self.stage, self.variant)?;
        self.device.borrow_mut().clone_from(&run.device);
        Ok(run)
    }
}

impl Finding {
    /// What was measured.
    pub(super) fn what(&self) -> &str {
        &self.what
    }

    /// What came out.
    pub(super) const fn value(&self) -> f64 {
        self.value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SPEED: (Criterion, Origin, Need) = (Criterion::AtLeast(1.0), Origin::Ours, Need::Most);

    fn outcome(values: &[f64], judged: Option<(Criterion, Origin, Need)>) -> Outcome {
        let found: Vec<Finding> = values
            .iter()
            .map(|&value| Finding { what: "speed".into(), value, unit: "m/s", judged })
            .collect();
        Outcome::of("walk.speed".into(), &found, Vec::new()).unwrap()
    }

    #[test]
    fn nine_draws_in_ten_must_pass_and_where_none_may_fail_all() {
        let mut values = [1.5; 20];
        (values[3], values[7]) = (0.9, f64::NAN);
        assert_eq!((outcome(&values, Some(SPEED)).passes, outcome(&values, Some(SPEED)).pass), (18, true));
        values[0] = 0.99;
        assert!(!outcome(&values, Some(SPEED)).pass);
        let all = Some((SPEED.0, SPEED.1, Need::All));
        assert!(outcome(&[1.0; 20], all).pass && !outcome(&[1.0, 0.9, 1.0], all).pass);
        assert!(!outcome(&[f64::NAN], Some(SPEED)).pass, "one draw, and it is no number");
    }

    #[test]
    fn what_is_shown_only_has_no_criterion_and_the_range_knows_of_nothing() {
        let shown = outcome(&[3.0, 1.0, 2.0], None);
        assert!(shown.pass && !shown.is_judged());
        assert_eq!((shown.value, shown.range), (3.0, [1.0, 3.0]));
        assert!(outcome(&[3.0, f64::NAN, 2.0], None).range.iter().all(|end| end.is_nan()));
    }

    #[test]
    fn draws_differ_in_what_may_differ() {
        assert_eq!(Draws::One.all(20), [(1, Variant::AsIs)]);
        assert_eq!(Draws::Turned.all(20).len(), 3);
        assert_eq!(Draws::Turned.all(1), [(1, Variant::AsIs)]);
        assert!(Draws::Seeds.all(20).iter().all(|draw| draw.1 == Variant::AsIs));
        let all = Draws::TurnedSeeds.all(20);
        assert_eq!((all.len(), all[0], all[4]), (20, (1, Variant::AsIs), (5, Variant::Rotated)));
    }
}
