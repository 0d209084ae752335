//! Agents that are led from outside: robots, vehicles, tracked people.

#[cfg(feature = "schema")]
use super::limits::{DAY, MAX_COORDINATE};
use glam::Vec2;
use serde::{Deserialize, Serialize};

/// What an external agent is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum ExternalKind {
    /// Radius 0.4 m unless said otherwise; a cart.
    Robot,
    /// Radius 1 m unless said otherwise; a small car.
    Vehicle,
    /// A person, tracked or played: the crowd's radius, walks with a neutral gait.
    Person,
}

/// An agent that is led from outside, whatever the crowd does. All others take the whole of the avoidance.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct ExternalAgent {
    /// What it is.
    pub kind: ExternalKind,
    /// Disc radius, m; left out: as its kind has it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// How much farther away than the radius the crowd stays if it can, m.
    #[serde(default)]
    pub comfort: f32,
    /// What a robot or vehicle looks like: a glTF model beside the scenario, in metres, its front towards +z, standing on
    /// y = 0 about the origin. Left out: as its kind has it, as large as its radius.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
    /// Width (x), height (y), length (z) that the model is scaled to, and put on the ground about its middle, m; left out:
    /// as it is in its file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub size: Option<[f32; 3]>,
    /// Where it is when: `[time, x, z]`, s and m, times rising; straight in between, at rest before the first and after the
    /// last. Left out: it is not there until the program that uses the library leads it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    #[cfg_attr(feature = "schema", schemars(schema_with = "path", extend("unit" = "s, m, m")))]
    pub path: Vec<[f32; 3]>,
}

/// The schema of a path, whose numbers differ in their range.
#[cfg(feature = "schema")]
fn path(_: &mut schemars::SchemaGenerator) -> schemars::Schema {
    let number = |least: f32, greatest: f32| schemars::json_schema!({ "type": "number", "minimum": least, "maximum": greatest });
    let along = || number(-MAX_COORDINATE, MAX_COORDINATE);
    let keyframe = [number(0.0, DAY), along(), along()];
    let item =
        schemars::json_schema!({ "type": "array", "prefixItems": keyframe, "minItems": 3, "maxItems": 3 });
    schemars::json_schema!({ "type": "array", "items": item })
}

impl ExternalAgent {
    /// Where it starts, if it has a path.
    pub fn start(&self) -> Option<Vec2> {
        self.path.first().map(|[_, x, z]| Vec2::new(*x, *z))
    }
}
