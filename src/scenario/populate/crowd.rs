//! The start state of every agent: what [`crate::sim`] needs to begin, the same on every machine.

use crate::avatar::anthropometry::Build;
use crate::emotion::Emotion;
use crate::scenario::file::{Navigation, Teleport, Way};
use glam::Vec2;

/// What a stage of a journey asks of an agent that comes to it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum StopKind {
    /// To pass within its radius.
    #[default]
    Waypoint,
    /// To enter the region.
    Goal,
    /// To stay in the region for a time, everyone at a place of their own.
    Waiting,
    /// To line up.
    Queue {
        /// Number of the queue.
        number: u32,
        /// How many can stand in it, at least 1.
        places: u32,
    },
    /// To leave the scene in the region.
    Exit,
}

/// A stage of a route or journey as an agent meets it.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Stop {
    /// What it is.
    pub kind: StopKind,
    /// Ground position (x, z) of the waypoint or of the middle of the region, m.
    pub position: Vec2,
    /// A waypoint is reached, or a queue joined, once the agent is closer than this, m.
    pub radius: f32,
    /// Half axes of the region, along it and across it, m; of a queue: the first leads from one place to the next.
    pub half_axes: [Vec2; 2],
    /// Least time spent waiting, or time of being served, steps.
    pub wait: u32,
    /// Step before which no waiting agent goes on.
    pub until: u32,
    /// Number of the stage among the scenario's stages; 0 for waypoints of routes. Places in a region depend on it.
    pub number: u32,
    /// Number of the flow field that leads there; none: straight.
    pub field: Option<u32>,
    /// Height of the floor that it lies on, m; none: whichever floor an agent comes to it on.
    pub elevation: Option<f32>,
    /// How the way there is found; none: as the scenario's `way_finding.way` says.
    pub way: Option<Way>,
}

impl Stop {
    /// A point on a route.
    pub fn waypoint(position: Vec2, radius: f32) -> Self {
        Self { position, radius, ..Self::default() }
    }
}

/// When an agent is there.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Entry {
    /// From the start.
    #[default]
    Start,
    /// It comes in from a source in this step or, where there is no room, later.
    Step(u32),
    /// Never: no source has a time for it.
    Never,
}

/// Where people come in.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SourceStart {
    /// First of its agents; they come in one by one, by number.
    pub first_agent: u32,
    /// How many.
    pub agents: u32,
    /// Places (x, z) at which they may appear, m.
    pub places: Vec<Vec2>,
}

/// How an agent avoids others.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Avoidance {
    /// Horizon, s.
    pub time_horizon: f32,
    /// Neighbours are considered up to this distance, m.
    pub neighbour_distance: f32,
    /// Most neighbours considered.
    pub neighbour_cap: u32,
    /// Priority, 0 to 1.
    pub priority: f32,
}

impl Avoidance {
    /// What the scenario says of everyone.
    pub fn of(navigation: &Navigation) -> Self {
        Self {
            time_horizon: navigation.time_horizon,
            neighbour_distance: navigation.neighbour_distance,
            neighbour_cap: navigation.neighbour_cap,
            priority: 0.0,
        }
    }
}

/// One agent at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentStart {
    /// When it is there; before that it stands at [`crate::ground::ABSENT`].
    pub entry: Entry,
    /// Ground position (x, z), m.
    pub position: Vec2,
    /// Height of the floor stood on, m.
    pub elevation: f32,
    /// Ground velocity, m/s.
    pub velocity: Vec2,
    /// Heading about +y in radians, 0 faces +z.
    pub heading: f32,
    /// Disc radius, m.
    pub radius: f32,
    /// Emotion weights, sum 1, in the order of [`crate::Emotion::ALL`]. The gaze follows the largest.
    pub emotion: [f32; 4],
    /// Up to four gaits as indices into the library.
    pub gaits: [u32; 4],
    /// Weights of the four gaits, sum 1.
    pub gait_weights: [f32; 4],
    /// Whether the agent gazes as its emotion says (condition `eva-g`).
    pub gazes: bool,
    /// Index into the scenario's avatars.
    pub avatar: u32,
    /// Uniform size of this person relative to the avatar, about 0.93 to 1.07.
    pub scale: f32,
    /// How the body is built beside the avatar's at that scale.
    #[doc(hidden)]
    pub build: Build,
    /// Colours of skin, hair, top and bottom, sRGB `0xRRGGBB`.
    pub colors: [u32; 4],
    /// Phase of the walk cycle, the whole u32 range is one stride.
    pub phase: u32,
    /// Where it is taken away and where it is put.
    pub teleport: Option<Teleport>,
    /// First stage of the agent's route in [`Crowd::stages`].
    pub route_start: u32,
    /// Number of stages of the route, at least 1.
    pub route_length: u32,
    /// The stage walked to first, counted from `route_start`.
    pub waypoint: u32,
    /// The others of the group that the agent walks with, by index; `u32::MAX` for none.
    pub companions: [u32; 4],
    /// How it avoids others; none: as the scenario's `[navigation]` says.
    pub avoidance: Option<Avoidance>,
    /// Preferred speed, m/s; none: that of its gaits. Its gaits are walked at another cadence.
    pub speed: Option<f32>,
    /// By what the preferred speed is multiplied.
    pub speed_factor: f32,
    /// Time from the start until it begins to walk, s.
    pub reaction: f32,
    /// After the last stage: walk the route again from its first one (true) or stay there (false).
    pub loops: bool,
}

impl AgentStart {
    /// A neutral person who stands at `position` (x, z; m), faces +z and has no way to go: its route is the stage of its
    /// number 0, which is behind it. Its body is that of the default navigation, its gait the first of the library.
    ///
    /// ```
    /// use gaitway::Emotion;
    /// use gaitway::scenario::AgentStart;
    /// use glam::Vec2;
    ///
    /// let start = AgentStart {
    ///     emotion: Emotion::Sad.weights(),
    ///     route_length: 2,
    ///     waypoint: 0,
    ///     ..AgentStart::at(Vec2::new(3.0, -1.0))
    /// };
    /// assert_eq!((start.scale, start.companions), (1.0, [u32::MAX; 4]));
    /// ```
    pub fn at(position: Vec2) -> Self {
        Self {
            entry: Entry::Start,
            position,
            elevation: 0.0,
            velocity: Vec2::ZERO,
            heading: 0.0,
            radius: Navigation::default().radius,
            emotion: Emotion::Neutral.weights(),
            gaits: [0; 4],
            gait_weights: [1.0, 0.0, 0.0, 0.0],
            gazes: false,
            avatar: 0,
            scale: 1.0,
            build: Build::default(),
            colors: [0; 4],
            phase: 0,
            teleport: None,
            route_start: 0,
            route_length: 1,
            waypoint: 1,
            companions: [u32::MAX; 4],
            avoidance: None,
            speed: None,
            speed_factor: 1.0,
            reaction: 0.0,
            loops: false,
        }
    }
}

/// All agents of a scenario, the routes they share, and where some of them come in.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Crowd {
    /// Agents by index (their stable id).
    pub agents: Vec<AgentStart>,
    /// External agents ([`crate::Scenario::outsiders`]); their ids follow.
    pub external: Vec<AgentStart>,
    /// Stages of all routes and journeys, one after another.
    pub stages: Vec<Stop>,
    /// Sources.
    pub sources: Vec<SourceStart>,
}
