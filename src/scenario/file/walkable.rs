//! The plane of a walkable area given as text.

use serde::{Deserialize, Serialize};

/// What the second coordinate of well-known text is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Plane {
    /// y = -z, as JuPedSim, PedPy and this program's trajectories have it.
    #[default]
    Xy,
    /// z, as all other coordinates of a scenario.
    Xz,
}

impl Plane {
    #[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}
