//! Journeys in scenario files: stages with names, journeys through them, sources of people.

use super::regions::Point;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;

/// Most ways through one journey.
pub(crate) const MOST_WAYS: usize = 256;
/// Distance between two places of a queue that says none, m.
pub(crate) const SPACING: f32 = 0.8;

/// What a stage is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum StageKind {
    /// A point to pass within `radius`.
    Waypoint,
    /// A region: everyone walks to a place of their own in it; passed on entering it. As the last stage, people stay there.
    Goal,
    /// A region in which everyone goes to a place of their own and stays for `wait` seconds and at least to the time `until`.
    Waiting,
    /// A line of places: people stand in it one behind the other in the order in which they came to its end; the first is served for
    /// `service_time`, then goes on to the next stage, and the others move up. Who finds it full waits behind it.
    Queue,
    /// A region in which people leave the scene; only as the last stage.
    Exit,
}

/// A place on a journey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// Unique name.
    pub name: String,
    /// What it is.
    pub kind: StageKind,
    /// The waypoint, the middle of the region, or the first place of the queue, m.
    pub position: Point,
    /// Height of the floor that it lies on, m; left out: whichever floor people come to it on.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elevation: Option<f32>,
    /// Width and depth of the region (along x and z before it is turned), m; left out for waypoints and queues, which have none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<Point>,
    /// Turn of the region about +y, degrees; of a queue: where its end is, 0 towards +z, 90 towards +x.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub heading_deg: f32,
    /// Distance at which a waypoint counts as reached, or from the end of a queue at which people join it, m; left out: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Least time in a waiting area, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub wait: f32,
    /// Time of the simulation before which no agent leaves a waiting area, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub until: f32,
    /// Places in a queue; left out for all others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<u32>,
    /// Distance from one place of a queue to the next, m; left out: 0.8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f32>,
    /// How long the first in a queue is served once it stands at its place, s; left out for all others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub service_time: Option<f32>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

/// One step of a journey: a stage, or one of several by shares.
#[derive(Debug, Clone, PartialEq)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(untagged))]
pub enum Leg {
    /// Everyone goes to this stage.
    All(String),
    /// Everyone goes to one of these stages, drawn at the start by shares (any scale).
    OneOf(BTreeMap<String, f32>),
}

impl Leg {
    /// The stages it may lead to, with their shares.
    pub(crate) fn choices(&self) -> Vec<(&str, f32)> {
        match self {
            Self::All(name) => vec![(name, 1.0)],
            Self::OneOf(shares) => shares.iter().map(|(name, share)| (name.as_str(), *share)).collect(),
        }
    }
}

impl Serialize for Leg {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::All(name) => serializer.serialize_str(name),
            Self::OneOf(shares) => {
                let mut map = serializer.serialize_map(Some(shares.len()))?;
                for (name, share) in shares {
                    map.serialize_entry(name, share)?;
                }
                map.end()
            }
        }
    }
}

impl<'de> Deserialize<'de> for Leg {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Choice;

        impl<'de> de::Visitor<'de> for Choice {
            type Value = Leg;

            fn expecting(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
                f.write_str(
                    "the name of a stage, or a table of names and shares such as { left = 2, right = 1 }",
                )
            }
            fn visit_str<E>(self, name: &str) -> Result<Leg, E> {
                Ok(Leg::All(name.to_owned()))
            }
            fn visit_map<A: de::MapAccess<'de>>(self, mut map: A) -> Result<Leg, A::Error> {
                let mut shares = BTreeMap::new();
                while let Some((name, share)) = map.next_entry()? {
                    shares.insert(name, share);
                }
                Ok(Leg::OneOf(shares))
            }
        }
        deserializer.deserialize_any(Choice)
    }
}

/// A way through stages.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Journey {
    /// Unique name.
    pub name: String,
    /// The stages in order; a table of names and shares where people part ways.
    pub stages: Vec<Leg>,
    /// From the last stage on to the first again.
    #[serde(default, skip_serializing_if = "is_false")]
    pub repeat: bool,
    /// Share of the agents, relative to the other journeys that start at the same spawn region or source.
    #[serde(default = "one")]
    pub weight: f32,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_false(value: &bool) -> bool {
    !*value
}

const fn one() -> f32 {
    1.0
}

/// People who come in together.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Arrivals {
    /// Time of the simulation, s.
    pub time: f32,
    /// How many.
    pub count: u32,
}

/// Where people come in while the simulation runs: by rate, or by schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Source {
    /// Corners in order, at least 3: they appear somewhere in it, where there is room.
    pub polygon: Vec<Point>,
    /// Height of the floor that people appear on, m; left out: the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elevation: Option<f32>,
    /// Names of the journeys that begin here; none here and in `routes`: any journey, or any route if there is no journey.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub journeys: Vec<String>,
    /// Names of the routes walked from here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub routes: Vec<String>,
    /// Agents a second, at even distances of time; left out where there is a `schedule`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rate: Option<f32>,
    /// Time of the first agent of `rate`, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub begin: f32,
    /// Time at which `rate` ends, s; left out: never.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub end: Option<f32>,
    /// How many come in when, in order of time.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub schedule: Vec<Arrivals>,
    /// Share of `population.agents` kept for this source, 0 to 1; left out: what it needs of those that are left.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub share: Option<f32>,
}

/// Names of stages: name to number.
pub(crate) fn stage_names(stages: &[Stage]) -> BTreeMap<&str, usize> {
    stages.iter().enumerate().map(|(index, stage)| (stage.name.as_str(), index)).collect()
}

/// Names of journeys: name to number.
pub(crate) fn journey_names(journeys: &[Journey]) -> BTreeMap<&str, usize> {
    journeys.iter().enumerate().map(|(index, journey)| (journey.name.as_str(), index)).collect()
}
