//! Journeys in scenario files: stages with names, journeys through them, sources of people; and their allowed ranges.

mod check;

pub(super) use check::validate;

use super::crowd::{Stop, StopKind};
use super::polygon;
use super::schema::Point;
use glam::Vec2;
use serde::ser::SerializeMap;
use serde::{Deserialize, Deserializer, Serialize, Serializer, de};
use std::collections::BTreeMap;

/// Most ways through one journey.
const MOST_WAYS: usize = 256;
/// Radius of a waypoint that says none, m.
const WAYPOINT_RADIUS: f32 = 1.0;
/// Distance between two places of a queue that says none, m.
const SPACING: f32 = 0.8;

/// What a stage is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
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
    /// Width and depth of the region (along x and z before it is turned), m; not for waypoints.
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
    /// Time of the simulation before which nobody leaves a waiting area, s.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub until: f32,
    /// Places in a queue.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub places: Option<u32>,
    /// Distance from one place of a queue to the next, m; left out: 0.8.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spacing: Option<f32>,
    /// How long the first in a queue is served once it stands at its place, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub service_time: Option<f32>,
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_zero(value: &f32) -> bool {
    *value == 0.0
}

/// One step of a journey: a stage, or one of several by shares.
#[derive(Debug, Clone, PartialEq)]
pub enum Leg {
    /// Everyone goes to this stage.
    All(String),
    /// Everyone goes to one of these stages, drawn at the start by shares (any scale).
    OneOf(BTreeMap<String, f32>),
}

impl Leg {
    /// The stages it may lead to, with their shares.
    fn choices(&self) -> Vec<(&str, f32)> {
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
#[serde(deny_unknown_fields)]
pub struct Arrivals {
    /// Time of the simulation, s.
    pub time: f32,
    /// How many.
    pub count: u32,
}

/// Where people come in while the simulation runs: by rate, or by schedule.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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
    /// Agents a second, at even distances of time.
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

impl Stage {
    /// Half axes of the region along its width and its depth, m; 0 for a waypoint.
    pub fn half_axes(&self) -> [Vec2; 2] {
        let Some(size) = self.size else { return [Vec2::ZERO; 2] };
        let corners = polygon::rectangle(Vec2::ZERO, Vec2::from(size), self.heading_deg.to_radians());
        [(corners[1] - corners[0]) * 0.5, (corners[2] - corners[1]) * 0.5]
    }

    /// From one place of a queue to the next, m.
    pub(super) fn to_next_place(&self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.heading_deg.to_radians());
        Vec2::new(sin, cos) * self.spacing.unwrap_or(SPACING)
    }

    /// The stage as agents meet it; `queue` is the number of queues before it.
    pub(super) fn stop(&self, number: u32, queue: u32, time_step: f32) -> Stop {
        let is_queue = self.kind == StageKind::Queue;
        let time = if is_queue { self.service_time.unwrap_or(0.0) } else { self.wait };
        Stop {
            kind: match self.kind {
                StageKind::Waypoint => StopKind::Waypoint,
                StageKind::Goal => StopKind::Goal,
                StageKind::Waiting => StopKind::Waiting,
                StageKind::Queue => StopKind::Queue { number: queue, places: self.places.unwrap_or(1) },
                StageKind::Exit => StopKind::Exit,
            },
            position: Vec2::from(self.position),
            radius: self.radius.unwrap_or(WAYPOINT_RADIUS),
            half_axes: if is_queue { [self.to_next_place(), Vec2::ZERO] } else { self.half_axes() },
            wait: steps(f64::from(time), time_step),
            until: steps(f64::from(self.until), time_step),
            number,
            field: None,
            elevation: self.elevation,
            way: None,
        }
    }
}

/// The first step that does not begin before a time, s.
#[allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "clamped: times are at most some days"
)]
pub(super) fn steps(time: f64, time_step: f32) -> u32 {
    // A thousandth of a step less, so that 2 s are 60 steps of 1/30 s although 1/30 is rounded.
    (time / f64::from(time_step) - 1e-3).ceil().clamp(0.0, 1e9) as u32
}

impl Journey {
    /// Every way through the journey: numbers of its stages, and its share of the agents.
    pub(super) fn ways(&self, names: &BTreeMap<&str, usize>) -> Vec<(Vec<usize>, f32)> {
        let mut ways: Vec<(Vec<usize>, f32)> = vec![(Vec::new(), 1.0)];
        for leg in &self.stages {
            let choices = leg.choices();
            let total: f32 = choices.iter().map(|(_, share)| share).sum();
            let longer = ways.iter().flat_map(|(way, share)| {
                choices.iter().filter(|(_, part)| *part > 0.0).filter_map(move |(name, part)| {
                    let stage = *names.get(name)?;
                    Some(([way.as_slice(), &[stage]].concat(), share * part / total))
                })
            });
            ways = longer.take(MOST_WAYS).collect();
        }
        ways
    }
}

/// Names of stages: name to number.
pub(super) fn stage_names(stages: &[Stage]) -> BTreeMap<&str, usize> {
    stages.iter().enumerate().map(|(index, stage)| (stage.name.as_str(), index)).collect()
}

/// Names of journeys: name to number.
pub(super) fn journey_names(journeys: &[Journey]) -> BTreeMap<&str, usize> {
    journeys.iter().enumerate().map(|(index, journey)| (journey.name.as_str(), index)).collect()
}
