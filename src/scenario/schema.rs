//! The scenario file: every key, its unit, its default. Allowed ranges are in [`super::validate`](Scenario::validate).

use super::environment::Environment;
use super::feelings::{EmotionDynamics, Event};
use super::floors::Floor;
use super::gaze::Gaze;
use super::journeys::{Journey, Source, Stage};
use super::outsiders::Outsider;
use super::population::Population;
use super::walkable::Plane;
use super::walkers::Walker;
use super::way_finding::WayFinding;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// A point on the ground (x, z), m.
pub type Point = [f32; 2];

/// Who walks where, how, and how they feel. Serialises to TOML and back without loss. The default has no name and no place.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Scenario {
    /// Name, 1 to 64 letters, digits, `-` or `_`.
    pub name: String,
    /// One line for people.
    #[serde(default)]
    pub description: String,
    /// Seed of every random draw.
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
    pub walkable_plane: Plane,
    /// A file with it, beside the scenario's: well-known text (`.wkt`, `.txt`), or a model (`.glb`, `.gltf`) whose floor it is.
    /// When the scenario is read it becomes `walkable_wkt`, in the plane `xy`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub walkable_file: String,
    /// Name of the node of the model that is the floor, with all below it; left out: the whole model.
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
    /// Ways through the stages, walked by those who start in spawn regions and sources that name them.
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
    pub outsiders: Vec<Outsider>,
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

/// The navigation model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Model {
    /// Optimal reciprocal collision avoidance, 2011, by linear programming.
    #[default]
    Orca,
    /// Reciprocal velocity obstacles, 2008, the paper's own: the best of some sampled velocities.
    Rvo,
}

/// Disc radius of a body, m, where nothing else is said: that of `JuPedSim` and Vadere, and half of the 40 cm that `RiMEA` 1
/// gives a body. Weidmann's ellipse (1993) has the area of a disc of 0.18 m, alone; with clothes and sway 0.22 m.
pub const BODY_RADIUS: f32 = 0.2;

/// How agents find their way past one another (spec 1.7).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Navigation {
    /// The model.
    pub model: Model,
    /// Length of one simulation step, s.
    pub time_step: f32,
    /// Agents farther apart than this (centre to centre, m) ignore each other.
    pub neighbour_distance: f32,
    /// Most neighbours an agent considers, nearest first.
    pub neighbour_cap: u32,
    /// How long a new velocity must stay free of collisions with agents, s. Larger: earlier, gentler evasion.
    pub time_horizon: f32,
    /// The same for obstacles, s.
    pub time_horizon_obstacles: f32,
    /// The horizon tried when not all neighbours can be avoided for `time_horizon`, s; 0: none, as RVO2 does it.
    pub time_horizon_dense: f32,
    /// The horizon tried after that by an agent that hardly moves, s; 0: none, as RVO2 does it.
    pub time_horizon_jam: f32,
    /// Gap that agents keep from one another while they can, m.
    pub safety_margin: f32,
    /// How much people ahead slow an agent down: 0 not at all (it keeps its speed until it would run into them), 1 as
    /// much as Weidmann's fundamental diagram says for the density that it sees ahead.
    pub crowding: f32,
    /// Disc radius of an agent of scale 1, m.
    pub radius: f32,
    /// Maximum speed over preferred speed.
    pub max_speed_factor: f32,
    /// Maximum speed of anyone, m/s.
    pub max_speed: f32,
    /// Greatest random change of the preferred velocity, m/s; breaks head-on symmetry.
    pub perturbation: f32,
    /// Of `rvo`: what a collision in one second costs against a velocity that differs by 1 m/s from the preferred one, m.
    /// Larger: shyer. (RVO Library 1.1 calls it the safety factor.)
    pub collision_weight: f32,
    /// Of `rvo`: greatest change of velocity, m/s².
    pub max_acceleration: f32,
    /// How long somebody gets nowhere before it takes turns with others and looks for a way along the wall, s; 0: never.
    pub patience: f32,
}

impl Default for Navigation {
    fn default() -> Self {
        Self {
            model: Model::default(),
            time_step: 1.0 / 30.0,
            neighbour_distance: 5.0,
            neighbour_cap: 10,
            time_horizon: 2.0,
            time_horizon_obstacles: 0.3,
            time_horizon_dense: 1.0,
            time_horizon_jam: 0.15,
            safety_margin: 0.01,
            crowding: 1.0,
            radius: BODY_RADIUS,
            max_speed_factor: 1.5,
            max_speed: 2.5,
            perturbation: 0.02,
            collision_weight: 1.0,
            max_acceleration: 10.0,
            patience: 0.0,
        }
    }
}

/// The person in the headset.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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

/// A solid, closed polygon.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
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

/// What follows the last waypoint.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
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
pub(super) fn route_names(routes: &[Route]) -> BTreeMap<&str, usize> {
    routes.iter().enumerate().map(|(index, route)| (route.name.as_str(), index)).collect()
}
