//! Agents that a scenario names one by one, each with a start and a way of its own.

use super::regions::Point;
use super::routes::RouteMode;
use super::way_finding::Way;
use serde::{Deserialize, Serialize};

/// One agent, in addition to those of `population`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Walker {
    /// Start (x, z), m.
    pub position: Point,
    /// Places it walks to, one after another; none: it stands.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waypoints: Vec<Point>,
    /// What follows the last one: stay (`once`), the same way back (`patrol`), on to the first (`loop`).
    #[serde(default = "once", skip_serializing_if = "is_once")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = once())))]
    pub mode: RouteMode,
    /// Distance at which a waypoint counts as reached, m.
    #[serde(default = "arrival")]
    pub arrival: f32,
    /// The same for the last one, m; left out: `arrival`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_arrival: Option<f32>,
    /// Disc radius, m; left out: `navigation.radius` times its size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Preferred speed, m/s; left out: that of its gait. Its gait is one near that speed, walked at another cadence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<f32>,
    /// How it finds the way to its waypoints; left out: as `way_finding.way` says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way: Option<Way>,
    /// A place where it is taken away, and where it is put; left out: none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub teleport: Option<Teleport>,
}

/// Two boxes, each by its least and greatest corner (x, z), m: a walker that enters the first is put at random into the second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Teleport {
    /// Where it is taken away.
    pub from: [Point; 2],
    /// Where it is put.
    pub to: [Point; 2],
}

const fn once() -> RouteMode {
    RouteMode::Once
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_once(mode: &RouteMode) -> bool {
    *mode == RouteMode::Once
}

const fn arrival() -> f32 {
    0.5
}

impl Default for Walker {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            waypoints: Vec::new(),
            mode: once(),
            arrival: arrival(),
            goal_arrival: None,
            radius: None,
            speed: None,
            way: None,
            teleport: None,
        }
    }
}

impl Walker {
    /// Whether its way ends somewhere.
    pub fn ends(&self) -> bool {
        self.mode == RouteMode::Once && !self.waypoints.is_empty() && self.teleport.is_none()
    }
}
