//! Does it move like people? Small scenes with known outcomes (`RiMEA`, NIST), and recorded crowds.
//!
//! Each test builds a scene of the people that users get, runs it, measures it and judges every value by a criterion stated
//! beforehand. It does so twenty times, with other places and draws. Every third scene is turned by 37 degrees, every third
//! moved by half a cell (after Zhou 2015). Nine draws in ten must pass. The report also shows 1.5 and 2 times as many people.
//! None of that makes gaitway a certified evacuation tool.
//!
//! ```
//! use gaitway::sim::Backend;
//! use gaitway::validate::scene::Equipment;
//! use gaitway::validate::{Options, run};
//!
//! # fn main() -> gaitway::Result<()> {
//! let stage = Equipment::new(Backend::Cpu, None)?;
//! let options = Options { tests: vec!["rimea-1".to_owned()], is_quick: true, draws: 1, data: None };
//! for outcome in run(&stage, &options, &mut |_, _| ())?.outcomes {
//!     println!("{}: {:.2} {} ({})", outcome.name, outcome.value, outcome.unit, outcome.pass);
//! }
//! # Ok(())
//! # }
//! ```

#[doc(hidden)]
pub mod diagram;
pub mod files;
pub mod judge;
#[doc(hidden)]
pub mod measure;
pub mod report;
#[doc(hidden)]
pub mod rooms;
#[doc(hidden)]
pub mod scene;
pub mod tests;
#[doc(hidden)]
pub mod tracks;

use crate::Error;
use crate::export::chart::Plot;
use crate::spelling::suggestion;
use files::unusable;
use judge::{Bench, Finding, Outcome, SIZES, Test};
use rayon::prelude::*;
use scene::{Equipment, Variant};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// How often a test in which chance plays a part is drawn, unless something else is said.
pub const DRAWS: usize = 20;

/// What is run.
#[derive(Debug, Clone)]
pub struct Options {
    /// Names of tests; none: all.
    pub tests: Vec<String>,
    /// Fewer people, shorter runs, one draw, one size.
    pub is_quick: bool,
    /// Draws of a test, at least 1.
    pub draws: usize,
    /// The folder with recorded crowds, if there is one.
    pub data: Option<PathBuf>,
}

impl Default for Options {
    fn default() -> Self {
        Self { tests: Vec::new(), is_quick: false, draws: DRAWS, data: None }
    }
}

/// What came out.
#[derive(Debug, Clone, Default)]
pub struct Validation {
    /// Every value, in the order of the tests.
    pub outcomes: Vec<Outcome>,
    /// What it ran on.
    pub device: String,
    /// Figures by name.
    pub figures: Vec<(String, Plot)>,
    /// What was left out, and why.
    pub skipped: Vec<String>,
}

impl Validation {
    /// Whether every judged value passes.
    pub fn pass(&self) -> bool {
        self.failed().next().is_none()
    }

    /// What misses its criterion.
    pub fn failed(&self) -> impl Iterator<Item = &Outcome> {
        self.outcomes.iter().filter(|outcome| !outcome.pass)
    }

    /// How many values are judged.
    pub fn judged(&self) -> usize {
        self.outcomes.iter().filter(|outcome| outcome.is_judged()).count()
    }
}

/// The tests of that name; all for none.
///
/// # Errors
/// [`Error::Usage`] for a name that no test has.
pub fn chosen(names: &[String]) -> Result<Vec<&'static Test>, Error> {
    if let Some(wrong) = names.iter().find(|name| !tests::ALL.iter().any(|test| test.name == **name)) {
        let known: Vec<&str> = tests::ALL.iter().map(|test| test.name).collect();
        let message = format!("there is no validation test {wrong:?}");
        return Err(Error::Usage { message, hint: suggestion(wrong, &known, "the tests are") });
    }
    let wanted = |test: &&Test| names.is_empty() || names.iter().any(|name| name == test.name);
    Ok(tests::ALL.iter().filter(wanted).collect())
}

/// One run of a test: its number in the list, the seed and layout of the draw, and how many people.
#[derive(Debug, Clone, Copy)]
struct Task {
    test: usize,
    draw: (u32, Variant),
    size: usize,
}

/// What one run of a test said.
struct Said {
    task: Task,
    found: Vec<Finding>,
    figures: Vec<(String, Plot)>,
    skipped: Vec<String>,
    device: String,
}

/// Every run of the tests: each draw of the first size, then the first draw of the others.
fn tasks(tests: &[&Test], options: &Options) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (number, test) in tests.iter().enumerate() {
        let draws = test.draws.all(if options.is_quick { 1 } else { options.draws });
        tasks.extend(draws.iter().map(|&draw| Task { test: number, draw, size: 0 }));
        if test.grows && !options.is_quick {
            let larger = (1..SIZES.len()).map(|size| Task { test: number, draw: draws[0], size });
            tasks.extend(larger);
        }
    }
    tasks
}

/// Runs the tests. `progress` receives the name of each and the fraction done. On the CPU draws run in parallel.
///
/// # Errors
/// When the device fails, a name is unknown, or a recorded crowd is there but unreadable.
#[allow(clippy::cast_precision_loss, reason = "some hundred runs")]
pub fn run(
    stage: &Equipment,
    options: &Options,
    progress: &mut (dyn FnMut(&str, f64) + Send),
) -> Result<Validation, Error> {
    let tests = chosen(&options.tests)?;
    let tasks = tasks(&tests, options);
    let (done, progress) = (AtomicUsize::new(0), Mutex::new(progress));
    let one = |&task: &Task| -> Result<Said, Error> {
        let test = tests[task.test];
        let bench = Bench {
            stage,
            variant: task.draw.1,
            seed: task.draw.0,
            size: task.size,
            is_quick: options.is_quick,
            data: options.data.clone(),
            test: test.name,
            found: Vec::new().into(),
            figures: Vec::new().into(),
            skipped: Vec::new().into(),
            device: String::new().into(),
        };
        (test.run)(&bench)?;
        let share = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / tasks.len() as f64;
        if let Ok(mut progress) = progress.lock() {
            progress(test.name, share);
        }
        Ok(Said {
            task,
            found: bench.found.into_inner(),
            figures: bench.figures.into_inner(),
            skipped: bench.skipped.into_inner(),
            device: bench.device.into_inner(),
        })
    };
    let said: Result<Vec<Said>, Error> = if stage.is_on_device() {
        tasks.iter().map(one).collect()
    } else {
        tasks.par_iter().map(one).collect()
    };
    Ok(gathered(&tests, &said?, options.is_quick))
}

/// What all runs say together.
fn gathered(tests: &[&Test], said: &[Said], is_quick: bool) -> Validation {
    let mut validation = Validation::default();
    for (number, test) in tests.iter().enumerate() {
        let of_size = |size: usize| -> Vec<&Said> {
            said.iter().filter(|said| said.task.test == number && said.task.size == size).collect()
        };
        let (draws, larger) = (of_size(0), [of_size(1), of_size(2)].concat());
        let Some(first) = draws.first() else { continue };
        let label = if is_quick { "-quick" } else { "" };
        for finding in &first.found {
            let same = |said: &&Said| said.found.iter().find(|other| other.what() == finding.what()).cloned();
            let all: Vec<Finding> = draws.iter().filter_map(same).collect();
            let more = larger.iter().filter_map(same).map(|other| other.value()).collect();
            let name = format!("{}{label}.{}", test.name, finding.what());
            validation.outcomes.extend(Outcome::of(name, &all, more));
        }
        validation.figures.extend(first.figures.iter().cloned());
        validation.skipped.extend(first.skipped.iter().cloned());
        if !first.device.is_empty() {
            validation.device.clone_from(&first.device);
        }
    }
    validation
}
