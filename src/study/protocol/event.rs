//! What happens in a participation.

use crate::study::file::Front;
use crate::study::plan::{Swap, Trial};
use serde::{Deserialize, Serialize};

/// An event with its time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// When it was stored, UTC ms.
    pub at: i64,
    /// What happened.
    #[serde(flatten)]
    pub event: Event,
}

/// What happens in a participation. `page` is always the id of the page that it belongs to.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "event", rename_all = "kebab-case")]
pub enum Event {
    /// The store has made a participant.
    Arrived {
        /// Random bits by which the plan draws for this participant, 0 to 2^63 - 1. They never reach the participant.
        person: u64,
        /// Where the participant takes part.
        front: Front,
        /// Language of the texts.
        language: String,
    },
    /// The participant agrees.
    Consented {
        /// Hash of the text that was agreed to.
        text: String,
    },
    /// The participant does not agree.
    Declined,
    /// The page is done.
    Next {
        /// The page.
        page: String,
    },
    /// A question is answered; the last answer to a question counts.
    Answer(Answer),
    /// A stimulus was shown to its end.
    Shown {
        /// The page.
        page: String,
        /// How it went.
        exposure: Exposure,
    },
    /// A stimulus cannot be shown.
    Fault {
        /// The page.
        page: String,
        /// Why, in the front's words.
        reason: String,
    },
    /// A sign of life that changes no page: a hidden tab, a slow picture, a key.
    Sign {
        /// The page.
        page: String,
        /// What it was.
        kind: String,
    },
    /// The participant withdraws.
    Withdrawn,
    /// The store has given a place.
    Placed {
        /// How many places were given before.
        place: u64,
        /// The trials of all counted parts.
        trials: Vec<Trial>,
    },
    /// The store has no place.
    Full,
    /// The participant was silent for longer than the lease.
    Lapsed,
    /// The participant is back after a lapse.
    Returned {
        /// Trials whose place was given away meanwhile.
        swaps: Vec<Swap>,
    },
    /// The store has another stimulus for a trial that cannot be shown.
    Replaced(Swap),
    /// The operator pauses the participation.
    Paused,
    /// The operator lets it go on.
    Resumed,
    /// The operator excludes the participant. Answers stay.
    Excluded {
        /// Why.
        reason: String,
    },
}

impl Event {
    /// Whether a front may send it: all others are the store's or the operator's.
    pub const fn is_open_to_fronts(&self) -> bool {
        self.is_sign_of_life() && !matches!(self, Self::Arrived { .. })
    }

    /// Whether it comes from the participant: a sign of life that renews the lease.
    pub const fn is_sign_of_life(&self) -> bool {
        matches!(
            self,
            Self::Arrived { .. }
                | Self::Consented { .. }
                | Self::Declined
                | Self::Next { .. }
                | Self::Answer(_)
                | Self::Shown { .. }
                | Self::Fault { .. }
                | Self::Sign { .. }
                | Self::Withdrawn
        )
    }
}

/// An answer to one question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Answer {
    /// The page.
    pub page: String,
    /// The question: `emotions.happy`.
    pub question: String,
    /// The number that was chosen or written; none for free text, or to take an answer back.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<i64>,
    /// Free text.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub text: Option<String>,
    /// From the moment the question was seen to the first answer, ms.
    pub first_ms: u32,
    /// From the moment the question was seen to this answer, ms.
    pub ms: u32,
    /// Made by the client, new for every answer: sent twice, it counts once.
    pub key: String,
}

/// How a stimulus was shown.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Exposure {
    /// When it began, UTC ms.
    pub started: i64,
    /// How long it could be seen, s.
    pub seconds_visible: f64,
    /// How often it was played.
    pub plays: u32,
    /// Frames shown.
    pub frames: u32,
    /// Frames shown late.
    pub late_frames: u32,
    /// Longest time between two frames, ms.
    pub longest_ms: f64,
}
