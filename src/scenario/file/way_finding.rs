//! How agents find the way to their goals: keys and defaults.

use serde::{Deserialize, Serialize};

/// Who asks a field for the way.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// None: all walk straight to the next waypoint or goal.
    #[default]
    Straight,
    /// Everyone.
    Field,
    /// Those on the way to a place from which something could be in the way: all of them where there are obstacles or floors
    /// or the bounds are not convex, none elsewhere.
    Auto,
}

/// How agents find the way to their goals.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct WayFinding {
    /// Straight, or along a field round obstacles.
    pub way: Way,
    /// Side of a cell of the flow grid, m; left out: 0.25 m on small grounds, 0.5 m on others.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cell: Option<f32>,
    /// Distance that a person's centre keeps from walls, m: passages narrower than twice this are closed. Left out: the
    /// least radius in the crowd, so that an agent has every way open that it fits through.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub clearance: Option<f32>,
    /// Price of a crowd, m²: a metre of the way costs 1 + this times the people per square metre there, so that some
    /// choose the longer, emptier way. 0: density costs nothing.
    pub density_weight: f32,
    /// Time between two looks at the crowd, s.
    pub every: f32,
}

impl Default for WayFinding {
    fn default() -> Self {
        Self { way: Way::default(), cell: None, clearance: None, density_weight: 0.0, every: 1.0 }
    }
}

impl WayFinding {
    #[allow(clippy::float_cmp, reason = "asks whether anything was set")]
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
