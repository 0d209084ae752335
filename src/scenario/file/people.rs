//! Classes of the population, and how numbers are spread over people.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A number, or how it is spread over people.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum Spread {
    /// The same for all.
    Exactly(f32),
    /// Evenly between least and greatest.
    Between([f32; 2]),
    /// Normally, cut off.
    Normal(Normal),
}

/// A normal distribution, cut off.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Normal {
    /// Mean.
    pub mean: f32,
    /// Standard deviation.
    pub deviation: f32,
    /// Least; left out: three deviations below the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub least: Option<f32>,
    /// Greatest; left out: three deviations above the mean.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub greatest: Option<f32>,
}

impl Spread {
    /// Least and greatest that can be drawn.
    pub fn ends(&self) -> [f32; 2] {
        match *self {
            Self::Exactly(value) => [value; 2],
            Self::Between(ends) => ends,
            Self::Normal(n) => [
                n.least.unwrap_or(n.mean - 3.0 * n.deviation),
                n.greatest.unwrap_or(n.mean + 3.0 * n.deviation),
            ],
        }
    }
}

/// Some of the people, and how they differ from what `[navigation]` says and from one another.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Class {
    /// Name, for people.
    pub name: String,
    /// Share of the agents, relative to the other classes; 0: none.
    pub share: f32,
    /// Age, years: gives the speed after Weidmann (1993) and, with `population.bodies.sizes = "nhanes"`, the body. Left out: the
    /// speed is that of the gait, or `speed`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub age: Option<Spread>,
    /// Walks with difficulty: 0.46 to 0.76 m/s (Weidmann 1993, in test 7 of `RiMEA`).
    #[serde(skip_serializing_if = "is_false")]
    pub limited_mobility: bool,
    /// Preferred speed, m/s; left out: that of the age or else of the gait. The gait is walked at another cadence.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub speed: Option<Spread>,
    /// Disc radius, m; left out: `navigation.radius` times the size of the body.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub radius: Option<Spread>,
    /// Horizon, s; left out: `navigation.time_horizon`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_horizon: Option<Spread>,
    /// Neighbours are considered up to this distance, m; left out: `navigation.neighbour_distance`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbour_distance: Option<Spread>,
    /// Most neighbours considered; left out: `navigation.neighbour_cap`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub neighbour_cap: Option<u32>,
    /// Priority, 0 to 1: of two people the one of higher priority takes clamp(0.5 - half the difference) of the avoidance. Where people
    /// press the same way (`navigation.crowding`), a difference of 0.1 counts like 0.2 m further ahead. Left out: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub priority: Option<Spread>,
    /// Time from the start until the person begins to walk, s; left out: 0.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reaction: Option<Spread>,
    /// Traits, -1 to 1, 0 is average: `psychoticism`, `extraversion`, `neuroticism`, `aggressive`, `assertive`, `shy`, `active`,
    /// `tense`, `impulsive` (Guy et al. 2011), or names of `population.traits`.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub personality: BTreeMap<String, Spread>,
    /// Names of the avatars of this class, out of `population.avatars`; empty: any.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub avatars: Vec<String>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "serde wants it so")]
fn is_false(value: &bool) -> bool {
    !value
}
