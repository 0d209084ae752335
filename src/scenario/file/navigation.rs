//! How agents find their way past one another: keys and defaults.

use serde::{Deserialize, Serialize};

/// Most neighbours an agent may consider: the length of the kernels' neighbour list.
pub const MAX_NEIGHBOURS: u32 = 10;

/// The navigation model.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Time without progress after which an agent takes turns with others and follows the wall in its way, s; 0: never.
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
