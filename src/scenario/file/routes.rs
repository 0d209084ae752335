//! Routes: where agents walk.

use super::regions::Point;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// What follows the last waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum RouteMode {
    /// The same way back, over and over.
    #[default]
    Patrol,
    /// On to the first waypoint: a closed loop, walked in both directions.
    Loop,
    /// Stay there.
    Once,
}

/// A way through the scene, walked on several parallel lanes.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Route {
    /// Unique name.
    pub name: String,
    /// Centre line, at least 2 points (3 for a loop).
    pub waypoints: Vec<Point>,
    /// Width over which the lanes are spread, m; 0 is a single lane.
    #[serde(default)]
    pub width: f32,
    /// Greatest distance at which a waypoint counts as reached, m.
    #[serde(default = "default_waypoint_radius")]
    pub radius: f32,
    /// What follows the last waypoint.
    #[serde(default)]
    pub mode: RouteMode,
    /// Share of the agents relative to length times lanes: with 1 everywhere all routes are equally dense.
    #[serde(default = "default_weight")]
    pub weight: f32,
}

const fn default_waypoint_radius() -> f32 {
    2.5
}

const fn default_weight() -> f32 {
    1.0
}

/// Names in use, for duplicates and references: name to index.
pub(crate) fn route_names(routes: &[Route]) -> BTreeMap<&str, usize> {
    routes.iter().enumerate().map(|(index, route)| (route.name.as_str(), index)).collect()
}
