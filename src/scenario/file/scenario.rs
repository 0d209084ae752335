//! The scenario file: every key, its unit, its default. [`Scenario::validate`] checks them.

use super::external::ExternalAgent;
use super::feelings::{EmotionDynamics, Event};
use super::floors::Floor;
use super::gaze::Gaze;
use super::journeys::{Journey, Source, Stage};
use super::navigation::Navigation;
use super::population::Population;
use super::props::Environment;
use super::regions::{Obstacle, Point, Spawn};
use super::routes::Route;
use super::user::User;
use super::walkable::Plane;
use super::walkers::Walker;
use super::way_finding::WayFinding;
use serde::{Deserialize, Serialize};

/// Who walks where, how, and how they feel. Serialises to TOML and back without loss. The default has no name and no place.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name, 1 to 64 letters, digits, `-` or `_`.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub description: String,
    /// Seed of every random draw, 0 to 2^63 - 1: what TOML can write.
    #[serde(default = "default_seed")]
    pub seed: u64,
    /// Which of the paper's three algorithms moves the agents (S-26).
    #[serde(default)]
    pub condition: Condition,
    /// Where the geometry comes from: a built-in generator that grows with the number of agents, or this file.
    #[serde(default)]
    pub layout: Layout,
    /// Outer outline of the walkable area (either orientation). With a generated layout: leave it out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bounds: Vec<Point>,
    /// The walkable area as well-known text (POLYGON, MULTIPOLYGON or GEOMETRYCOLLECTION, m) instead of `bounds`: outline
    /// and holes, to which `obstacles` add. Its plane is (x, y = -z), as in PedPy's plans and in trajectories, while all other
    /// coordinates of this file are (x, z): see `walkable_plane`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub walkable_wkt: String,
    /// The plane of `walkable_wkt` or of the text in `walkable_file`: `xy` has y = -z, `xz` has z as it is.
    #[serde(default, skip_serializing_if = "Plane::is_default")]
    #[cfg_attr(feature = "schema", schemars(extend("default" = Plane::default())))]
    pub walkable_plane: Plane,
    /// A file with it, beside the scenario's: well-known text (`.wkt`, `.txt`), or a model (`.glb`, `.gltf`) whose floor it is.
    /// When the scenario is read it becomes `walkable_wkt`, in the plane `xy`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub walkable_file: String,
    /// Name of the node of the model (of `walkable_file`, or else of `environment.glb`) that is the floor, with all below it; left out: the whole model.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub walkable_node: Option<String>,
    /// How agents find the way to their goals.
    #[serde(default, skip_serializing_if = "WayFinding::is_default")]
    pub way_finding: WayFinding,
    /// How agents gaze in condition `eva-g`.
    #[serde(default)]
    pub gaze: Gaze,
    /// The crowd.
    #[serde(default)]
    pub population: Population,
    /// How agents find their way past one another.
    #[serde(default)]
    pub navigation: Navigation,
    /// The person in the headset; left out: there is no user, so agents neither avoid nor look at one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub user: Option<User>,
    /// Solid polygons (either orientation), in addition to those of the layout and of solid props.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacles: Vec<Obstacle>,
    /// Where agents start; none: spread along their routes.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub spawns: Vec<Spawn>,
    /// Where agents walk, in addition to the routes of the layout.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub routes: Vec<Route>,
    /// Floors above the ground: bridges, ramps, storeys.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub floors: Vec<Floor>,
    /// Places that journeys lead through.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stages: Vec<Stage>,
    /// Ways through the stages, walked from the spawn regions and sources that name them.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub journeys: Vec<Journey>,
    /// Where people come in while the simulation runs.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sources: Vec<Source>,
    /// How feelings change in time; left out: they do not, as in the paper.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub emotion_dynamics: Option<EmotionDynamics>,
    /// What happens and rouses emotions; needs `emotion_dynamics`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
    /// Robots, vehicles and tracked people: agents that are led from outside. Their ids follow those of the population.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub outsiders: Vec<ExternalAgent>,
    /// Agents one by one, each with a start and a way of its own, in addition to those of `population`.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub walkers: Vec<Walker>,
    /// What the place looks like. Solid props are obstacles too.
    #[serde(default)]
    pub environment: Environment,
}

const fn default_seed() -> u64 {
    1
}

/// The paper's three algorithms (S-26).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Condition {
    /// One neutral gait for all, no gaze.
    Baseline,
    /// Gaits by emotion, no gaze.
    EvaO,
    /// Gaits and gaze by emotion.
    #[default]
    EvaG,
}

/// Where bounds, obstacles, routes and scenery come from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// From the file.
    #[default]
    Custom,
    /// Generated city intersection.
    Crossing,
    /// Generated leisure garden.
    Garden,
    /// Generated car park in front of stores.
    Parking,
    /// Generated residential pods.
    Scifi,
}
