//! What is asked of a store, and what comes of it.

use super::super::Error;
use super::super::protocol::{Page, Refusal, State};
use crate::study::file::Front;

/// A new participant, or one who comes again.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Arrival {
    /// Where the participant takes part.
    pub front: Front,
    /// Language of the texts (BCP 47).
    pub language: String,
    /// Who the participant is on a platform; the same one is the same participant.
    pub platform: Option<PlatformId>,
}

/// Who a participant is on a platform.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PlatformId {
    /// The participant, such as `PROLIFIC_PID` or `workerId`.
    pub participant: String,
    /// The submission, such as `SESSION_ID` or `assignmentId`; empty where there is none.
    pub submission: String,
}

/// A participant was let in.
#[derive(Debug, Clone, PartialEq)]
pub struct Arrived {
    /// The secret by which the participant's browser is known from now on. The store keeps a hash of it alone.
    pub token: String,
    /// Where the participant is.
    pub turn: Turn,
}

/// Where a participant is.
#[derive(Debug, Clone, PartialEq)]
pub struct Turn {
    /// Number within this store.
    pub participant: i64,
    /// The participant's code, 26 digits and letters: with it they come back, or ask for deletion.
    pub code: String,
    /// Language of the texts.
    pub language: String,
    /// The version of the study that they take part in.
    pub version: u32,
    /// Where the participation stands.
    pub state: State,
    /// The current page.
    pub page: Page,
}

/// Why a request was not met. Nothing was stored.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum Trouble {
    /// There is no such participant.
    #[error("there is no such participant")]
    Unknown,
    /// The operator has closed admission.
    #[error("the study takes no new participants")]
    Closed,
    /// The participant began on another front, and goes on there.
    #[error("this participant takes part {0}")]
    Elsewhere(&'static str),
    /// The participant withdrew before, and left nothing that leads to them.
    #[error("this participant has withdrawn")]
    Gone,
    /// The protocol refuses it.
    #[error("{0}")]
    Refused(#[from] Refusal),
    /// It could not be stored, and may be sent again.
    #[error("it could not be stored ({0}); it may be sent again")]
    Unavailable(String),
}

impl From<Failure> for Trouble {
    fn from(Failure(reason): Failure) -> Self {
        Self::Unavailable(reason)
    }
}

impl From<rusqlite::Error> for Trouble {
    fn from(error: rusqlite::Error) -> Self {
        Failure::from(error).into()
    }
}

/// Why nothing could be written.
#[derive(Debug)]
pub(super) struct Failure(pub(super) String);

impl From<rusqlite::Error> for Failure {
    fn from(error: rusqlite::Error) -> Self {
        Self(error.to_string())
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        Self(error.to_string())
    }
}
