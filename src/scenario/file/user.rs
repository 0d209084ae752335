//! The person in the headset.

use super::regions::Point;
use serde::{Deserialize, Serialize};

/// The person in the headset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct User {
    /// Start on the ground, m; left out: where the layout puts the user (custom layouts: the origin).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub position: Option<Point>,
    /// Which floor the user stands on, by its height at their position, m: that of the nearest, no farther than a step
    /// (0.6 m). Left out: 0, the ground.
    #[serde(skip_serializing_if = "is_ground")]
    pub elevation: f32,
    /// Heading about +y, degrees: 0 looks along +z, 90 along +x.
    pub heading_deg: f32,
    /// Height of the eyes above that floor, m.
    pub eye_height: f32,
    /// Disc radius, m.
    pub radius: f32,
    /// How much farther away than the radius agents stay if they can, m.
    pub comfort: f32,
    /// Whether agents walk around the user.
    pub avoided: bool,
}

impl Default for User {
    fn default() -> Self {
        Self {
            position: None,
            elevation: 0.0,
            heading_deg: 180.0,
            eye_height: 1.65,
            radius: 0.3,
            comfort: 0.0,
            avoided: true,
        }
    }
}

#[allow(
    clippy::trivially_copy_pass_by_ref,
    clippy::float_cmp,
    reason = "as serde calls it; left out is exactly 0"
)]
fn is_ground(elevation: &f32) -> bool {
    *elevation == 0.0
}
