//! How the generated bodies are built: the table `population.bodies`.

use super::people::Spread;
use serde::{Deserialize, Serialize};

/// Builds of the generated bodies, by the regressions of ANSUR II (Gordon et al. 2014): each girth, breadth and length follows from
/// stature and weight, and differs from person to person as among the people who were measured.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, default)]
pub struct Bodies {
    /// Where statures and weights come from.
    pub sizes: Sizes,
    /// Ages of those whose class has none, years: for `sizes = "nhanes"`, and not for how fast they walk. Left out: 20 to 79.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ages: Option<Spread>,
    /// Weight over the square of the stature, kg/m²; left out: as `sizes` has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub body_mass_index: Option<Spread>,
    /// How much people of the same stature and weight differ in shape: 0 not at all, 1 as people do.
    pub variety: f32,
}

impl Bodies {
    pub(super) fn is_default(&self) -> bool {
        *self == Self::default()
    }
}

impl Default for Bodies {
    fn default() -> Self {
        Self { sizes: Sizes::default(), ages: None, body_mass_index: None, variety: 1.0 }
    }
}

/// Where statures and weights come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Sizes {
    /// All have the shape of the avatar, at a size out of `population.scale`.
    Avatar,
    /// Legs are those of the avatar at a size out of `population.scale`, and statures go with them; weights as in ANSUR II.
    #[default]
    Scale,
    /// Adults as in ANSUR II: soldiers of 17 to 58 years. `population.scale` does not count.
    Ansur,
    /// By age: adults as in the United States from 2021 to 2023 (NHANES), children from 2 years on as in the CDC's growth charts.
    /// `population.scale` does not count.
    Nhanes,
}

/// Least and greatest size of a body out of tables, over the avatar's.
pub(crate) const LEAST_SCALE: f32 = 0.3;
pub(crate) const MOST_SCALE: f32 = 1.3;
