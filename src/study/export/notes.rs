//! What a person has to know before a dataset is handed on.

use crate::study::file::Front;
use crate::study::tables::name;
use std::fmt;

/// Fewest people of one gender and age, or band of age, for which both are given away.
pub const SMALLEST_CELL: usize = 5;

/// What a person has to know before a dataset is handed on.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize)]
#[serde(tag = "note", rename_all = "kebab-case")]
pub enum Note {
    /// Ages are given in bands.
    Banded {
        /// Fewest people that share gender and exact age.
        smallest: usize,
    },
    /// Age, or gender and age, are left out.
    Withheld {
        /// Questions left out.
        questions: Vec<String>,
        /// Fewest people that share gender and age.
        smallest: usize,
    },
    /// Gender and age are there although few people share both.
    SmallCells {
        /// Fewest people that share gender and age.
        smallest: usize,
    },
    /// Free texts may tell who wrote them.
    FreeTexts {
        /// How many there are.
        count: usize,
    },
    /// No participant is a person.
    Simulated,
    /// Participants of another front are not in the dataset.
    LeftOut {
        /// Their front.
        front: Front,
        /// How many there are.
        count: usize,
    },
}

impl fmt::Display for Note {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Banded { smallest } => write!(
                f,
                "ages are given in bands: {smallest} of the participants share the rarest combination of gender and exact age, fewer \
                 than {SMALLEST_CELL}; --small-cells exports ages"
            ),
            Self::Withheld { questions, smallest } => write!(
                f,
                "{} left out: {smallest} of the participants share the rarest combination, fewer than {SMALLEST_CELL}, and bands of age do \
                 not change that; --small-cells exports them",
                questions.join(" and ")
            ),
            Self::SmallCells { smallest } => write!(
                f,
                "gender and age are in the data, though only {smallest} of the participants share the rarest combination; who knows \
                 them may find a participant by it"
            ),
            Self::FreeTexts { count } => {
                write!(
                    f,
                    "free texts: {count}; read them before you share the data, since they may tell who wrote them"
                )
            }
            Self::LeftOut { front, count } => {
                let s = if *count == 1 { "" } else { "s" };
                write!(
                    f,
                    "left out: {count} participant{s} of the front {}; a dataset of their own takes them",
                    name(front)
                )
            }
            Self::Simulated => {
                f.write_str("all participants are simulated; the data describe a model, not people")
            }
        }
    }
}
