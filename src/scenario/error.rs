//! What can be wrong with a scenario, said so that it can be put right.

use super::setting::SettingError;
use std::fmt;
use std::path::PathBuf;

pub use crate::keys::BadValue;

/// A scenario is wrong.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file could not be read.
    #[error("cannot read scenario {path:?}: {source}")]
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
    /// A value is outside its range.
    #[error("{0}")]
    Value(Box<BadValue>),
    /// A value that is set from outside has no place in the file.
    #[error("--set {setting}: {reason}")]
    Setting {
        /// The key and its value.
        setting: String,
        /// What stands in the way.
        reason: SettingError,
    },
    /// There is no built-in scene of that name.
    #[error(
        "no built-in scene {name:?}{}; use one of {known}, or the path of a TOML file",
        .nearest.map_or_else(String::new, |nearest| format!(" (did you mean {nearest}?)"))
    )]
    UnknownScene {
        /// What was asked for.
        name: String,
        /// The name most like it.
        nearest: Option<&'static str>,
        /// The names there are.
        known: String,
    },
    /// The scenario is valid but cannot be filled with agents.
    #[error("scenario {name:?}: {message}; {hint}")]
    Populate {
        /// The scenario.
        name: String,
        /// What does not fit, with values.
        message: String,
        /// The way out.
        hint: String,
    },
    /// The scenario cannot be written as TOML.
    #[error("scenario {name:?} cannot be written as TOML: {message}")]
    Write {
        /// The scenario.
        name: String,
        /// Why.
        message: String,
    },
}

impl Error {
    /// A value outside its range, place not yet known.
    pub(super) fn value(
        key: impl Into<String>,
        value: impl fmt::Display,
        allowed: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Value(Box::new(BadValue::new(key, value, allowed, hint)))
    }
}
