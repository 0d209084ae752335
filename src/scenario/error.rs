//! What can be wrong with a scenario, said so that it can be put right.

use super::setting::SettingError;
use std::fmt;
use std::path::PathBuf;

/// A value outside its allowed range.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct BadValue {
    /// File and line, once known; empty for a scenario that did not come from a file.
    pub place: String,
    /// Key path, such as `population.scale` or `routes[2].waypoints[0]`.
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
        Self::Value(Box::new(BadValue {
            place: String::new(),
            key: key.into(),
            value: value.to_string(),
            allowed: allowed.into(),
            hint: hint.into(),
        }))
    }
}
