//! What can be wrong with a study, said so that it can be put right.

use std::fmt;
use std::path::PathBuf;

/// A value that does not do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadValue {
    /// File and line, once known; empty for a study that did not come from a file.
    pub place: String,
    /// Key path, such as `part.walks.design.each` or `study.flow[2]`.
    pub key: String,
    /// The value found.
    pub value: String,
    /// What is allowed.
    pub allowed: String,
    /// The way out.
    pub hint: String,
}

impl fmt::Display for BadValue {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.place.is_empty() {
            write!(f, "{}: ", self.place)?;
        }
        write!(f, "{} = {}: must be {}; {}", self.key, self.value, self.allowed, self.hint)
    }
}

/// A study cannot be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[error("cannot read study {path:?}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The text is not TOML, has an unknown key or a value of the wrong type.
    #[error("{place}: {message}")]
    Syntax {
        /// File and line.
        place: String,
        /// What is wrong, with the key, the value found and what to write instead.
        message: String,
    },
    /// A value does not do.
    #[error("{0}")]
    Value(Box<BadValue>),
    /// There is no built-in study of that name.
    #[error("no built-in study {name:?}; {hint}")]
    UnknownStudy {
        /// What was asked for.
        name: String,
        /// The way out.
        hint: String,
    },
    /// A questionnaire lacks answers that its scores need.
    #[error("{questionnaire}: no answer to {item}; a score needs all of its items")]
    Unanswered {
        /// The questionnaire.
        questionnaire: String,
        /// The item.
        item: String,
    },
    /// An answer lies outside the scale of its questionnaire.
    #[error(
        "{questionnaire}.{item} = {value}: must be {least} to {greatest}; answers of other scales are not scored"
    )]
    OffScale {
        /// The questionnaire.
        questionnaire: String,
        /// The item.
        item: String,
        /// The answer.
        value: i64,
        /// Least of the scale.
        least: i64,
        /// Greatest of the scale.
        greatest: i64,
    },
    /// A questionnaire knows no such way of scoring.
    #[error("{questionnaire}: no way of scoring {variant:?}; {hint}")]
    UnknownVariant {
        /// The questionnaire.
        questionnaire: String,
        /// What was asked for.
        variant: String,
        /// The way out.
        hint: String,
    },
}

impl Error {
    /// A value that does not do, place not yet known.
    pub(super) fn value(
        key: impl Into<String>,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Value(Box::new(BadValue {
            place: String::new(),
            key: key.into(),
            value: value.to_string(),
            allowed: allowed.into(),
            hint: hint.into(),
        }))
    }
}
