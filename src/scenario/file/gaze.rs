//! How agents gaze, and how many at once.

use serde::{Deserialize, Deserializer, Serialize, Serializer, de};

/// Agents that look at the user at a time, unless a scenario says otherwise.
pub const DEFAULT_BUDGET: u32 = 12;

/// How gaze angles are found (paper section 4.5; departures ).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum GazeMode {
    /// Signed angles by atan2, anatomical limits, a field of regard, smoothing.
    #[default]
    Natural,
    /// The paper's formulas to the letter.
    Paper,
}

/// How many agents look at the user at a time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Budget {
    /// All that would.
    All,
    /// At most so many: they take turns.
    Most(u32),
}

impl Serialize for Budget {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All => serializer.serialize_str("all"),
            Self::Most(count) => serializer.serialize_u32(*count),
        }
    }
}

#[cfg(feature = "schema")]
impl schemars::JsonSchema for Budget {
    fn schema_name() -> std::borrow::Cow<'static, str> {
        "Budget".into()
    }

    fn json_schema(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
        schemars::json_schema!({ "anyOf": [{ "type": "integer" }, { "const": "all" }] })
    }
}

impl<'de> Deserialize<'de> for Budget {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Text;

        impl de::Visitor<'_> for Text {
            type Value = Budget;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str("a number of agents or \"all\"")
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Budget, E> {
                let wrong = |_| E::invalid_value(de::Unexpected::Signed(value), &self);
                u32::try_from(value).map(Budget::Most).map_err(wrong)
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Budget, E> {
                let wrong = |_| E::invalid_value(de::Unexpected::Unsigned(value), &self);
                u32::try_from(value).map(Budget::Most).map_err(wrong)
            }
            fn visit_str<E: de::Error>(self, value: &str) -> Result<Budget, E> {
                if value == "all" {
                    return Ok(Budget::All);
                }
                Err(E::invalid_value(de::Unexpected::Str(value), &self))
            }
        }
        deserializer.deserialize_any(Text)
    }
}

/// How agents gaze.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Gaze {
    /// The formulas.
    pub mode: GazeMode,
    /// Most agents that look at the user at a time, or `"all"`; being stared at by a crowd is unpleasant. Left out: 12, and
    /// in paper mode all, since the paper has no such limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub budget: Option<Budget>,
    /// Shortest and longest turn to look at the user where the budget makes agents take turns, s.
    pub turn: [f32; 2],
}

impl Default for Gaze {
    fn default() -> Self {
        Self { mode: GazeMode::default(), budget: None, turn: [1.0, 4.0] }
    }
}

impl Gaze {
    /// The budget that holds.
    pub const fn effective_budget(&self) -> Budget {
        match (self.budget, self.mode) {
            (Some(budget), _) => budget,
            (None, GazeMode::Natural) => Budget::Most(DEFAULT_BUDGET),
            (None, GazeMode::Paper) => Budget::All,
        }
    }
}
