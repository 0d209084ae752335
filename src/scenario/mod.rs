//! Who walks where, how, and how they feel: scenario files, the paper's four scenes, their geometry and scenery,
//! and the start of every agent.
//!
//! A [`Scenario`] is read from TOML ([`Scenario::load`]) or built in ([`Scenario::builtin`]); [`Scenario::geometry`]
//! says where everything is; [`populate()`] fills it with agents as a [`crowd::Crowd`]; and
//! [`Environment::mesh`] draws it. Paper: sections 5.3 (conditions, scenes) and 4.3 (choice of gaits).

mod casting;
mod clearance;
mod companions;
mod crossing;
pub mod crowd;
mod environment;
mod error;
mod feelings;
mod floors;
mod garden;
mod gaze;
mod journeys;
mod lanes;
mod layout;
mod led;
mod load;
pub mod menge;
mod mesh;
mod outsider_bodies;
mod outsiders;
mod parking;
pub mod people;
pub mod polygon;
mod populate;
mod population;
mod props;
pub mod random;
mod schema;
mod scifi;
mod setting;
mod sources;
mod validate;
mod walkable;
mod walkers;
mod walls;
mod way_finding;

pub use clearance::Clearance;
pub use crowd::{AgentStart, Crowd, Entry, SourceStart, Stop, StopKind};
pub use environment::{Environment, Ground, MAX_TRIANGLES, Prop, PropKind};
pub use error::{BadValue, Error};
pub use feelings::{EmotionDynamics, Event};
pub use floors::{Floor, Floors, MAX_FLOORS, RAILING, Raised};
pub use gaze::{Budget, DEFAULT_BUDGET, Gaze, GazeMode};
pub use journeys::{Arrivals, Journey, Leg, Source, Stage, StageKind};
pub use lanes::ROUTE_CLEARANCE;
pub use layout::Geometry;
pub use led::{Person, populate_people};
pub use mesh::EnvironmentMesh;
pub use outsider_bodies::{OutsiderBodies, outsider_bodies};
pub use outsiders::{Outsider, OutsiderKind};
pub use people::{Class, Manners, Spread};
pub use populate::{populate, populate_from, populate_with};
pub use population::{Affect, EmotionMode, GaitChoice, GenderChoice, Groups, Population, Prefer, Shares};
pub use schema::{
    BODY_RADIUS, Condition, Layout, Model, Navigation, Obstacle, Point, Route, RouteMode, Scenario, Spawn,
    User,
};
pub use setting::Setting;
pub use validate::{MAX_AGENTS, MAX_COORDINATE, MAX_GROUP, MAX_NEIGHBOURS};
pub use walkable::{Area, Plane};
pub use walkers::{Teleport, Walker};
pub use way_finding::{Way, WayFinding};
