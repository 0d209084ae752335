//! Points and regions on the ground: obstacles, and where agents start.

use serde::{Deserialize, Serialize};

/// A point on the ground (x, z), m.
pub type Point = [f32; 2];

/// A solid, closed polygon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Obstacle {
    /// Corners in order, at least 3, not crossing itself.
    pub polygon: Vec<Point>,
    /// Its lowest point, m above the ground; left out: it reaches below everything. Only with floors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub low: Option<f32>,
    /// Its highest point, m above the ground; left out: it reaches above everything. Only with floors.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub high: Option<f32>,
}

impl Obstacle {
    /// Whether it stands at some heights only.
    pub fn is_raised(&self) -> bool {
        self.low.is_some() || self.high.is_some()
    }
}

/// A region in which agents start.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Spawn {
    /// Corners in order, at least 3.
    pub polygon: Vec<Point>,
    /// Height of the floor that people start on, m; left out: the ground.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub elevation: Option<f32>,
    /// Share of the agents, relative to the other regions; left out: the region's area in m².
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weight: Option<f32>,
    /// Names of the routes walked from here; none here and in `journeys`: any route, or any journey if there is no route.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub routes: Vec<String>,
    /// Names of the journeys that begin here.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub journeys: Vec<String>,
}
