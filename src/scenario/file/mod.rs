//! What a scenario file says: types for serde, their units and defaults. Depends on nothing else in `scenario`.

mod bodies;
mod external;
mod feelings;
mod floors;
mod gaze;
mod journeys;
mod limits;
mod navigation;
mod people;
mod population;
mod props;
mod regions;
mod routes;
mod scenario;
mod user;
mod walkable;
mod walkers;
mod way_finding;

pub use bodies::{Bodies, Sizes};
pub(crate) use bodies::{LEAST_SCALE, MOST_SCALE};
pub use external::{ExternalAgent, ExternalKind};
pub use feelings::{EmotionDynamics, Event};
pub use floors::{Floor, MAX_FLOORS};
pub use gaze::{Budget, DEFAULT_BUDGET, Gaze, GazeMode};
pub use journeys::{Arrivals, Journey, Leg, Source, Stage, StageKind};
pub(crate) use journeys::{MOST_WAYS, SPACING, journey_names, stage_names};
pub use limits::MAX_COORDINATE;
pub(crate) use limits::{DAY, Limits, limits};
pub use navigation::{BODY_RADIUS, MAX_NEIGHBOURS, Model, Navigation};
pub use people::{Class, Normal, Spread};
pub use population::{
    Affect, Clothes, EmotionMode, GaitChoice, GenderChoice, Groups, MAX_AGENTS, MAX_GROUP, Population,
    Prefer, Shares, SharesError,
};
pub use props::{Environment, Ground, Prop, PropKind};
pub use regions::{Obstacle, Point, Spawn};
pub(crate) use routes::route_names;
pub use routes::{Route, RouteMode};
pub use scenario::{Condition, Layout, Scenario};
pub use user::User;
pub use walkable::Plane;
pub use walkers::{Teleport, Walker};
pub use way_finding::{Way, WayFinding};
