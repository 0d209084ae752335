//! What the analyses of a study have in common.

use crate::study::error::Error as StudyError;
use crate::study::file::{self, StudyFile};

/// Draws of every bootstrap.
pub const DRAWS: usize = 2000;
/// Level of every interval.
pub const CONFIDENCE: f64 = 0.95;

/// An analysis is impossible.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// Simulated participants and people are in one table.
    #[error(
        "{people} people and {simulated} simulated participants in one analysis: must be one of them; rehearse and simulate with folders of data of their own"
    )]
    Mixed {
        /// Participants that are people.
        people: usize,
        /// Simulated ones.
        simulated: usize,
    },
    /// The study file or the tables hold a value that does not do.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// The ratings of gaits cannot be read.
    #[error(transparent)]
    Ratings(#[from] crate::perception::Error),
    /// A statistic cannot be computed.
    #[error("{test}: {source}")]
    Statistics {
        /// Which test of the study file.
        test: String,
        /// Why.
        source: crate::statistics::Error,
    },
}

/// A value of the study file or the tables that does not do.
pub(super) fn bad(key: &str, value: &str, allowed: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Study(StudyError::value(key, format!("{value:?}"), allowed, hint))
}

/// The counted trials of a part.
pub(super) fn trials<'s>(study: &'s StudyFile, key: &str, part: &str) -> Result<&'s file::Trials, Error> {
    let trials = study.parts.get(part).and_then(file::Part::trials).filter(|trials| trials.counted);
    trials
        .ok_or_else(|| bad(&format!("{key}.of"), part, "a part with counted trials", "check the study file"))
}

#[allow(clippy::cast_precision_loss, reason = "counts are far below 2^53")]
pub(super) const fn real(count: usize) -> f64 {
    count as f64
}
