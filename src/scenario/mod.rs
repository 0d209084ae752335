//! Scenarios: what a crowd is, where it walks and how it feels. Scenario files, the paper's four scenes, their geometry
//! and scenery, and the start of every agent.
//!
//! A [`Scenario`] is read from TOML ([`Scenario::load`]) or built in ([`Scenario::builtin`]); [`Scenario::geometry`]
//! says where everything is; [`populate()`] fills it with agents as a [`Crowd`]; and
//! [`Geometry::scenery`] draws it. Paper: sections 5.3 (conditions, scenes) and 4.3 (choice of gaits).
//!
//! ```
//! use gaitway::{Scenario, Scene};
//!
//! # fn main() -> gaitway::Result<()> {
//! let hall = Scenario::parse(
//!     r#"
//!         name = "hall"
//!         bounds = [[0, 0], [20, 0], [20, 10], [0, 10]]
//!         [population]
//!         agents = 30
//!         emotions = { happy = 2, sad = 1 }
//!         [[routes]]
//!         name = "along"
//!         waypoints = [[2, 5], [18, 5]]
//!         mode = "patrol"
//!     "#,
//!     "hall.toml", // named in errors, with the line
//! )?;
//! assert_eq!(hall.geometry().walkable_area().round(), 200.0);
//! let crowd = Scene::of(hall).build()?.crowd;
//! assert_eq!(crowd.agents.len(), 30);
//! # Ok(())
//! # }
//! ```
//!
//! The rooms, from left to right; each uses only those before it (`tests/layers/imports.rs`):
//! `file` (what a scenario file says), `schema` (the same for editors), `polygon`, `random` and `personality` (used by all that follow), `builtin` and `menge`
//! (other origins of scenarios), `place` (geometry and scenery), `check` (ranges), `populate` (the agents), `load` (TOML).

mod builtin;
mod check;
mod error;
mod file;
mod load;
#[cfg(feature = "import")]
pub mod menge;
#[doc(hidden)]
pub mod personality;
mod place;
#[doc(hidden)]
pub mod polygon;
mod populate;
#[doc(hidden)]
pub mod random;
#[cfg(feature = "schema")]
mod schema;
mod setting;

pub use crate::wkt::Error as WktError;
#[doc(hidden)]
pub(crate) use check::external::MAX_EXTERNAL_SPEED;
pub use error::{BadValue, Error};
pub use file::{
    Affect, Arrivals, BODY_RADIUS, Budget, Class, Condition, DEFAULT_BUDGET, EmotionDynamics, EmotionMode,
    Environment, Event, ExternalAgent, ExternalKind, Floor, GaitChoice, Gaze, GazeMode, GenderChoice, Ground,
    Groups, Journey, Layout, Leg, MAX_AGENTS, MAX_FLOORS, MAX_GROUP, MAX_NEIGHBOURS, Model, Navigation,
    Normal, Obstacle, Plane, Point, Population, Prefer, Prop, PropKind, Route, RouteMode, Scenario, Shares,
    SharesError, Source, Spawn, Spread, Stage, StageKind, Teleport, User, Walker, Way, WayFinding,
};
#[doc(hidden)]
pub use file::{Bodies, Clothes, MAX_COORDINATE, Sizes};
#[doc(hidden)]
pub use place::Distant;
pub(crate) use place::place_model;
pub use place::{Area, AreaError, EnvironmentMesh, Floors, Geometry};
pub use place::{Clearance, ExternalBodies, Finish, RAILING, Raised, SurfaceMaterial, external_bodies};
#[doc(hidden)]
pub use polygon::UnionError;
pub(crate) use populate::MOST_BY_CHANCE;
pub use populate::{AgentStart, Avoidance, Crowd, Entry, Stop, StopKind, populate};
#[doc(hidden)]
pub use populate::{
    ExternalPerson, ROUTE_CLEARANCE, SourceStart, populate_from, populate_people, populate_with,
};
#[cfg(feature = "schema")]
pub use schema::json_schema;
#[cfg(feature = "cli")]
pub(crate) use schema::reference;
pub use setting::{Setting, SettingError};
