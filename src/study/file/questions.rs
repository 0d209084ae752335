//! Questions.

use crate::emotion::Emotion;
use crate::study::words::Words;
use serde::de::{MapAccess, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;
use std::fmt;

/// A question, or several on one scale. Answers are whole numbers but for `text`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(tag = "kind", rename_all = "kebab-case", deny_unknown_fields)]
pub enum Question {
    /// Statements, each on the same scale; answers are the numbers of points.
    Likert {
        /// What stands above the statements.
        #[serde(default, skip_serializing_if = "Words::is_empty")]
        text: Words,
        /// Order of the statements.
        #[serde(default)]
        order: ItemOrder,
        /// The scale.
        points: Points,
        /// The statements.
        items: Vec<LikertItem>,
        /// Whether it may be left out.
        #[serde(default, skip_serializing_if = "is_false")]
        optional: bool,
    },
    /// One of several; answers are indices from 0 in the order of the file.
    Choice {
        /// The question.
        #[serde(default, skip_serializing_if = "Words::is_empty")]
        text: Words,
        /// What to choose from.
        options: Vec<Words>,
        /// Order of the options.
        #[serde(default)]
        order: ItemOrder,
        /// Whether it may be left out.
        #[serde(default, skip_serializing_if = "is_false")]
        optional: bool,
    },
    /// A whole number.
    Number {
        /// The question.
        text: Words,
        /// Least.
        least: i64,
        /// Greatest.
        greatest: i64,
        /// Whether it may be left out.
        #[serde(default, skip_serializing_if = "is_false")]
        optional: bool,
    },
    /// Free text; may always be left out.
    Text {
        /// The question.
        text: Words,
        /// Most characters, 1 to 10,000.
        #[serde(default = "a_page")]
        most: u32,
    },
}

/// Points of the scale by which emotions are rated, from 1.
pub(in crate::study) const RATING_POINTS: i64 = 5;

impl Question {
    /// Whether it asks how happy, angry, sad and neutral something looks, by which gaits get their labels.
    pub(in crate::study) fn rates_emotions(&self) -> bool {
        let Self::Likert { items, points, .. } = self else { return false };
        let has = |emotion: Emotion| items.iter().any(|item| item.id == emotion.name());
        points.ends() == Some((1, RATING_POINTS)) && Emotion::ALL.into_iter().all(has)
    }
}

const fn a_page() -> u32 {
    2000
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde wants it so")]
const fn is_false(value: &bool) -> bool {
    !*value
}

/// A statement of a Likert question.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LikertItem {
    /// Name in tables: letters, digits, '-' or '_'.
    pub id: String,
    /// The statement.
    pub text: Words,
}

/// In which order items are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ItemOrder {
    /// That of the file.
    #[default]
    Fixed,
    /// Drawn once for each participant.
    PerParticipant,
    /// Drawn for each trial.
    PerTrial,
}

/// The points of a scale: a list of words for 1, 2, ..., or words for some of the numbers.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Points {
    /// Words for 1 to the length of the list.
    List(Vec<Words>),
    /// Words for some; the scale runs from the least to the greatest of these numbers.
    Some(BTreeMap<i64, Words>),
}

impl Points {
    /// Least and greatest point; none of an empty scale.
    pub fn ends(&self) -> Option<(i64, i64)> {
        match self {
            Self::List(words) => i64::try_from(words.len()).ok().filter(|&n| n > 0).map(|n| (1, n)),
            Self::Some(words) => Some((*words.first_key_value()?.0, *words.last_key_value()?.0)),
        }
    }

    /// Words for points, by number.
    pub fn labels(&self) -> Vec<(i64, &Words)> {
        match self {
            Self::List(words) => (1..).zip(words).collect(),
            Self::Some(words) => words.iter().map(|(&point, text)| (point, text)).collect(),
        }
    }
}

impl Serialize for Points {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::List(words) => words.serialize(serializer),
            Self::Some(words) => {
                let texts: BTreeMap<String, &Words> =
                    words.iter().map(|(point, text)| (point.to_string(), text)).collect();
                texts.serialize(serializer)
            }
        }
    }
}

impl<'de> Deserialize<'de> for Points {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Scale;

        impl<'de> Visitor<'de> for Scale {
            type Value = Points;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a list of texts, or a table such as { 1 = \"no\", 7 = \"yes\" }")
            }
            fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Points, A::Error> {
                let mut words = Vec::new();
                while let Some(text) = list.next_element()? {
                    words.push(text);
                }
                Ok(Points::List(words))
            }
            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Points, A::Error> {
                let mut words = BTreeMap::new();
                while let Some((point, text)) = map.next_entry::<String, Words>()? {
                    let wrong = |_| {
                        de::Error::invalid_value(de::Unexpected::Str(&point), &"a whole number as the point")
                    };
                    words.insert(point.parse().map_err(wrong)?, text);
                }
                Ok(Points::Some(words))
            }
        }
        deserializer.deserialize_any(Scale)
    }
}
