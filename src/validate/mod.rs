//! Does it move like people? Small scenes with known outcomes (`RiMEA`, NIST), and what real crowds did.
//!
//! Each test builds a scene, runs it as described, turned by 37 degrees and moved by half a cell (after Zhou 2015), measures it
//! and judges every value by a criterion stated beforehand. None of that makes gaitway a certified evacuation tool.

pub mod diagram;
pub mod files;
pub mod judge;
pub mod measure;
pub mod report;
pub mod rooms;
pub mod scene;
pub mod tests;
pub mod tracks;

use crate::Error;
use crate::export::chart::Plot;
use judge::{Bench, Outcome, Test};
use scene::{Stage, Variant};
use std::path::PathBuf;

/// What is run.
#[derive(Debug, Clone, Default)]
pub struct Options {
    /// Names of tests; none: all.
    pub tests: Vec<String>,
    /// Fewer people, shorter runs, and scenes only as they are.
    pub is_quick: bool,
    /// The folder with recorded crowds, if there is one.
    pub data: Option<PathBuf>,
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
    /// Whether every value passes.
    pub fn pass(&self) -> bool {
        self.outcomes.iter().all(|outcome| outcome.pass)
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
        return Err(Error::Usage { message, hint: format!("the tests are {}", known.join(", ")) });
    }
    let wanted = |test: &&Test| names.is_empty() || names.iter().any(|name| name == test.name);
    Ok(tests::ALL.iter().filter(wanted).collect())
}

/// Runs the tests; `progress` hears which, and what share is done.
///
/// # Errors
/// When the device fails, a name is unknown, or a recorded crowd is there but unreadable.
#[allow(clippy::cast_precision_loss, reason = "a few dozen tests")]
pub fn run(
    stage: &Stage,
    options: &Options,
    progress: &mut dyn FnMut(&str, f64),
) -> Result<Validation, Error> {
    let mut runs = Vec::new();
    for test in chosen(&options.tests)? {
        let variants =
            if test.has_variants && !options.is_quick { &Variant::ALL[..] } else { &[Variant::AsIs] };
        runs.extend(variants.iter().map(|variant| (test, *variant)));
    }
    let mut validation = Validation::default();
    for (index, (test, variant)) in runs.iter().enumerate() {
        progress(&format!("{}, {}", test.name, variant.name()), index as f64 / runs.len() as f64);
        let bench = Bench {
            stage,
            variant: *variant,
            is_quick: options.is_quick,
            data: options.data.clone(),
            test: test.name,
            found: Vec::new().into(),
            figures: Vec::new().into(),
            skipped: Vec::new().into(),
            device: String::new().into(),
        };
        (test.run)(&bench)?;
        validation.outcomes.extend(bench.found.into_inner());
        validation.figures.extend(bench.figures.into_inner());
        validation.skipped.extend(bench.skipped.into_inner());
        let device = bench.device.into_inner();
        if !device.is_empty() {
            validation.device = device;
        }
    }
    Ok(validation)
}

/// A recorded crowd that is there but cannot be used.
#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
fn unusable(error: files::Error) -> Error {
    let hint = "leave the file out, or name another folder with --data";
    Error::Failed { message: error.to_string(), hint: hint.to_owned() }
}
