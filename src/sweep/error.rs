//! What can be wrong with a sweep, a plan, or the folder of its runs.

use std::path::PathBuf;

/// A sweep could not be read, planned or done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// A file could not be read.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A file or folder could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file or folder.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The sweep is no TOML, or has a key that there is not.
    #[error("{place}: {message}")]
    Syntax {
        /// File and line.
        place: String,
        /// What is wrong, with the nearest name for a misspelt one.
        message: String,
    },
    /// A value of the sweep is not allowed.
    #[error("{0}")]
    Value(crate::keys::BadValue),
    /// The scenario does not take a value of the sweep.
    #[error("{place}: {setting}: {message}")]
    Setting {
        /// The file.
        place: String,
        /// The key and its value.
        setting: String,
        /// What is wrong with it.
        message: String,
    },
    /// The plan is none, or was changed after it was made.
    #[error("{path:?}: {message}")]
    Plan {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
        /// The way out.
        hint: String,
    },
}

impl Error {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Plan { hint, .. } => Some(hint),
            _ => None,
        }
    }
}
