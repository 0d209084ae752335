//! What can be wrong with a recording of a crowd.

use std::path::PathBuf;

/// A recording could not be read or replayed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The file system refused.
    #[error("cannot read {path:?}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// The trajectory database refused.
    #[error("cannot read {path:?}: {source}")]
    Sqlite {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The Parquet file is broken, or has what is not read.
    #[error("cannot read {path:?}: {source}")]
    Parquet {
        /// The file.
        path: PathBuf,
        /// Why.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// A line is not what the format says.
    #[error("{path:?}, line {line}: {message}")]
    Syntax {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// The file as a whole cannot be used.
    #[error("{path:?}: {message}")]
    Unusable {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        message: String,
        /// The way out.
        hint: String,
    },
    /// More people than a crowd can hold.
    #[error("{found} agents; a crowd holds at most {most}")]
    TooMany {
        /// How many there would be.
        found: usize,
        /// How many there may be.
        most: u32,
    },
}

impl Error {
    /// What the user can do about it.
    pub fn hint(&self) -> Option<&str> {
        match self {
            Self::Unusable { hint, .. } => Some(hint),
            _ => None,
        }
    }
}
