//! Floors above the ground: bridges, ramps, storeys.

use super::regions::Point;
use serde::{Deserialize, Serialize};

/// Most floors: every agent looks at all of them in every step.
pub const MAX_FLOORS: usize = 1024;

/// A convex piece of a plane above the ground that people walk on: a bridge, a ramp, a storey.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Floor {
    /// Corners in order, 3 to 8, convex.
    pub polygon: Vec<Point>,
    /// Height above the ground, m: one number for a level floor, or that of each of the first three corners.
    pub heights: Vec<f32>,
    /// Edges with a railing: edge 0 leads from the first corner to the second.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub railings: Vec<u32>,
}
