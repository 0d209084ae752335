//! What a check notes.

use crate::spelling::suggestion;
use crate::study::error::BadValue;
use crate::study::file::StudyFile;
use crate::study::load::Study;
use crate::study::words::Words;
use serde::Serialize;
use std::fmt;

/// How bad it is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Severity {
    /// The study cannot be planned.
    Error,
    /// The lab has to fill something in before people take part; simulated participants do without.
    Missing,
    /// The study runs, but not as well as it could.
    Warning,
}

/// Something that a check noted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Note {
    /// How bad it is.
    pub severity: Severity,
    /// File and line.
    pub place: String,
    /// Key path.
    pub key: String,
    /// The value found.
    pub value: String,
    /// What is allowed or wanted.
    pub allowed: String,
    /// The way out.
    pub hint: String,
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { place, key, value, allowed, hint, .. } = self;
        let (word, must) = match self.severity {
            Severity::Error => ("error", "must be"),
            Severity::Missing => ("missing", "must be"),
            Severity::Warning => ("warning", "should be"),
        };
        write!(f, "{word}: {place}: {key} = {value}: {must} {allowed}; {hint}")
    }
}

/// The notes on a study, while they are taken.
pub(super) struct Notes<'s> {
    study: &'s Study,
    notes: Vec<Note>,
}

impl<'s> Notes<'s> {
    pub(super) const fn new(study: &'s Study) -> Self {
        Self { study, notes: Vec::new() }
    }

    pub(super) const fn file(&self) -> &'s StudyFile {
        &self.study.file
    }

    pub(super) fn into_all(self) -> Vec<Note> {
        self.notes
    }

    pub(super) fn has_errors(&self) -> bool {
        self.notes.iter().any(|note| note.severity == Severity::Error)
    }

    /// Notes a value of a key.
    pub(super) fn add(&mut self, severity: Severity, bad: BadValue) {
        let BadValue { key, value, allowed, hint, .. } = bad;
        self.notes.push(Note { severity, place: self.study.place(&key), key, value, allowed, hint });
    }

    fn note(
        &mut self,
        severity: Severity,
        key: &str,
        value: impl fmt::Display,
        [allowed, hint]: [String; 2],
    ) {
        self.add(severity, BadValue::new(key, value, allowed, hint));
    }

    pub(super) fn error(
        &mut self,
        key: &str,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) {
        self.note(Severity::Error, key, value, [allowed.into(), hint.into()]);
    }

    pub(super) fn missing(
        &mut self,
        key: &str,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) {
        self.note(Severity::Missing, key, value, [allowed.into(), hint.into()]);
    }

    pub(super) fn warn(
        &mut self,
        key: &str,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) {
        self.note(Severity::Warning, key, value, [allowed.into(), hint.into()]);
    }

    /// A number within `low..=high`; NaN fails.
    pub(super) fn within<T>(&mut self, key: &str, value: T, [low, high]: [T; 2], hint: &str)
    where
        T: PartialOrd + fmt::Display + Copy,
    {
        if !(value >= low && value <= high) {
            self.error(key, value, format!("{low} to {high}"), hint);
        }
    }

    /// A name out of those that are known.
    pub(super) fn known(&mut self, key: &str, name: &str, known: &[&str], allowed: &str) -> bool {
        let is_known = known.contains(&name);
        if !is_known {
            self.error(key, format!("{name:?}"), allowed, suggestion(name, known, "there are"));
        }
        is_known
    }

    /// A name that may stand in tables and addresses.
    pub(super) fn id(&mut self, key: &str, name: &str) {
        let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
        if name.is_empty() || name.len() > 32 || !name.chars().all(is_plain) {
            let hint = "it names columns, files and addresses";
            self.error(key, format!("{name:?}"), "1 to 32 letters, digits, '-' or '_'", hint);
        }
    }

    /// A text that participants read.
    pub(super) fn words(&mut self, key: &str, words: &Words) {
        if words.is_empty() {
            self.error(key, "\"\"", "a text", "participants read it");
            return;
        }
        let lacking = words.lacking(&self.study.file.study.languages);
        if !lacking.is_empty() {
            let hint = format!("participants of {} read the text of another language", lacking.join(", "));
            self.warn(key, "{..}", "there in all of study.languages", hint);
        }
    }
}
