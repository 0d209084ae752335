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
    /// A file could not be written.
    #[error("cannot write {path:?}: {source}")]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// There is no data of a study.
    #[error(
        "{path:?} is not there: the folder holds no data of a study; `gaitway study serve --data` makes it"
    )]
    NoStore {
        /// The store that is missing.
        path: PathBuf,
    },
    /// Another program writes to the data.
    #[error("{path:?} is in use by another gaitway; stop it first, or use its admin page")]
    InUse {
        /// The folder of data.
        path: PathBuf,
    },
    /// The data are of another study.
    #[error(
        "{path:?} holds data of {wanted:?}, and the study is {found:?}; give each study a folder of its own"
    )]
    OtherStudy {
        /// The folder of data.
        path: PathBuf,
        /// The study that was opened.
        found: String,
        /// The study of the data.
        wanted: String,
    },
    /// The study differs from the one that participants have seen.
    #[error(
        "the study has changed since its version {version} began; raise study.version to go on with the change, or open \
         {path:?} with the files of version {version}, which lie in its materials"
    )]
    Changed {
        /// The folder of data.
        path: PathBuf,
        /// The newest version of the data.
        version: u32,
    },
    /// The data were written by a newer program.
    #[error("{path:?} has format {found}; this program knows formats up to {known}: take a newer one")]
    NewerStore {
        /// The store.
        path: PathBuf,
        /// Its format.
        found: i64,
        /// The newest format that is known.
        known: i64,
    },
    /// Folders hold data of different studies.
    #[error("{first:?} and {second:?} hold data of different studies or versions, which cannot become one")]
    Differs {
        /// A folder of data.
        first: PathBuf,
        /// Another one.
        second: PathBuf,
    },
    /// There is data already.
    #[error("{path:?} exists; name a new folder")]
    Exists {
        /// What is there.
        path: PathBuf,
    },
    /// The store failed.
    #[error("cannot {doing} {path:?}: {source}")]
    Store {
        /// What was tried.
        doing: &'static str,
        /// The store.
        path: PathBuf,
        /// Why it failed.
        source: Box<dyn std::error::Error + Send + Sync>,
    },
    /// The system has no random bits.
    #[error("the system gives no random bits ({reason}); codes of participants cannot be made without")]
    NoRandomness {
        /// Why.
        reason: String,
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
    /// People took part on two fronts, and which of them count was not said.
    #[error("{web} people took part in a browser and {headset} in a headset; what they saw differs")]
    SeveralFronts {
        /// Participants in a browser.
        web: usize,
        /// Participants in a headset.
        headset: usize,
    },
    /// No participant took part on the front that was chosen.
    #[error("no participant took part on the front {wanted:?}; there are {}", found.join(", "))]
    NoFront {
        /// What was chosen.
        wanted: String,
        /// The fronts there are.
        found: Vec<String>,
    },
}

impl Error {
    /// A store failed.
    #[cfg(feature = "study")]
    pub(super) fn store(
        doing: &'static str,
        path: &std::path::Path,
        source: impl Into<Box<dyn std::error::Error + Send + Sync>>,
    ) -> Self {
        Self::Store { doing, path: path.to_owned(), source: source.into() }
    }

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
