//! The four emotions of the paper and weights over them (S-32: other emotions are mixtures of these).

use crate::spelling::{UnknownName, by_name};
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// One of the four emotions; the order is the paper's and is the index used in every table and buffer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
#[repr(u32)]
pub enum Emotion {
    /// Pleasant and excited, index 0.
    Happy = 0,
    /// Unpleasant and excited, index 1.
    Angry = 1,
    /// Unpleasant and calm, index 2.
    Sad = 2,
    /// None of these, index 3.
    Neutral = 3,
}

impl Emotion {
    /// All four, in index order.
    pub const ALL: [Self; 4] = [Self::Happy, Self::Angry, Self::Sad, Self::Neutral];

    /// Index in tables and buffers, 0 to 3.
    pub const fn index(self) -> usize {
        self as usize
    }

    /// Lower-case name, as written in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Happy => "happy",
            Self::Angry => "angry",
            Self::Sad => "sad",
            Self::Neutral => "neutral",
        }
    }

    /// Weights that are 1 for this emotion and 0 for the others.
    pub fn weights(self) -> [f32; 4] {
        let mut weights = [0.0; 4];
        weights[self.index()] = 1.0;
        weights
    }

    /// The emotion of the largest weight; of two alike the first.
    pub fn strongest(weights: [f32; 4]) -> Self {
        let of = |emotion: Self| weights[emotion.index()];
        Self::ALL
            .into_iter()
            .reduce(|best, other| if of(other) > of(best) { other } else { best })
            .unwrap_or(Self::Neutral)
    }
}

impl fmt::Display for Emotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for Emotion {
    type Err = UnknownName;

    fn from_str(text: &str) -> Result<Self, UnknownName> {
        by_name("emotion", &Self::ALL, Self::name, text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_unknown_ones_are_refused() {
        for emotion in Emotion::ALL {
            assert_eq!(emotion.name().to_uppercase().parse(), Ok(emotion));
        }
        let refused = "joyful".parse::<Emotion>().unwrap_err();
        assert_eq!(refused.to_string(), "unknown emotion \"joyful\"; use happy, angry, sad or neutral");
        assert_eq!((refused.kind, refused.found.as_str()), ("emotion", "joyful"));
    }
}
