//! Everything about a study that can be known before the first participant.

mod analysis;
mod balance;
mod head;
mod notes;
mod parts;
mod questions;
mod summary;
mod trials;

pub use notes::{Note, Severity};
pub use summary::{PartSummary, Summary};

use super::error::Error;
use super::load::Study;
use super::materials::Materials;
use super::plan::Plan;
use notes::Notes;
use serde::Serialize;
use std::fmt;

/// What a check finds.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Report {
    /// Errors, what is missing, and warnings, in the order of the file's sections.
    pub notes: Vec<Note>,
    /// What participants will do; none with errors.
    pub summary: Option<Summary>,
}

impl Report {
    /// Whether the study can be planned and simulated: there is no error.
    pub fn is_valid(&self) -> bool {
        !self.has(Severity::Error)
    }

    /// Whether people may take part: besides, nothing is missing.
    pub fn is_ready(&self) -> bool {
        self.is_valid() && !self.has(Severity::Missing)
    }

    fn has(&self, severity: Severity) -> bool {
        self.notes.iter().any(|note| note.severity == severity)
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.notes.iter().try_for_each(|note| writeln!(f, "{note}"))?;
        self.summary.iter().try_for_each(|summary| summary.fmt(f))
    }
}

/// Checks a study against what lies beside it.
pub fn check(study: &Study, materials: &Materials) -> Report {
    let mut notes = Notes::new(study);
    head::check(&mut notes, materials);
    parts::check(&mut notes, materials);
    questions::check(&mut notes);
    analysis::check(&mut notes);
    let mut summary = None;
    if !notes.has_errors() {
        match Plan::of(&study.file, materials) {
            Ok(plan) => {
                let found = Summary::of(&plan, &study.file, materials);
                balance::check(&mut notes, &plan, &found);
                summary = Some(found);
            }
            Err(Error::Value(bad)) => notes.add(Severity::Error, *bad),
            Err(other) => {
                notes.error("study", &study.origin, "a study that can be planned", other.to_string());
            }
        }
    }
    if notes.has_errors() {
        summary = None;
    }
    Report { notes: notes.into_all(), summary }
}
