//! What can be wrong with a study, said so that it can be put right.

use std::fmt;
use std::path::PathBuf;

pub use crate::keys::BadValue;

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
        Self::Value(Box::new(BadValue::new(key, value, allowed, hint)))
    }
}
