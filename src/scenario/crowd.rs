//! The start state of every agent: what [`crate::sim`] needs to begin, the same on every machine.

use super::people::Manners;
use glam::Vec2;

/// A point on a route and how near an agent must come for it to count as reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Waypoint {
    /// Ground position (x, z), m.
    pub position: Vec2,
    /// The agent turns to the next waypoint once it is closer than this, m.
    pub radius: f32,
}

/// One agent at the start.
#[derive(Debug, Clone, PartialEq)]
pub struct AgentStart {
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
    /// Colours of skin, hair, top and bottom, sRGB `0xRRGGBB`.
    pub colors: [u32; 4],
    /// Phase of the walk cycle, the whole u32 range is one stride.
    pub phase: u32,
    /// First waypoint of the agent's route in [`Crowd::waypoints`].
    pub route_start: u32,
    /// Number of waypoints of the route, at least 1.
    pub route_length: u32,
    /// The waypoint walked to first, counted from `route_start`.
    pub waypoint: u32,
    /// The others of the group that the agent walks with, by index; `u32::MAX` for none.
    pub companions: [u32; 4],
    /// How it deals with others; none: as the scenario's `[navigation]` says.
    pub manners: Option<Manners>,
    /// Preferred speed, m/s; none: that of its gaits. Its gaits are walked at another cadence.
    pub speed: Option<f32>,
    /// By what the preferred speed is multiplied.
    pub speed_factor: f32,
    /// Time from the start until it begins to walk, s.
    pub reaction: f32,
    /// After the last waypoint: walk the route again from its first one (true) or stay there (false).
    pub loops: bool,
}

/// All agents of a scenario and the routes they share.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Crowd {
    /// Agents by index (their stable id).
    pub agents: Vec<AgentStart>,
    /// Waypoints of all routes, one after another.
    pub waypoints: Vec<Waypoint>,
}
