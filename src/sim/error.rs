//! Why a simulation cannot begin or go on.

use glam::Vec2;

/// The simulation refused its input or failed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// The number of avatars is out of range.
    #[error("{found} avatars; a crowd needs 1 to {most}")]
    Avatars {
        /// How many there are.
        found: usize,
        /// How many there may be.
        most: usize,
    },
    /// There is no gait to walk with.
    #[error("the gait library is empty; a crowd needs at least one gait")]
    NoGaits,
    /// A kernel met a value that is not finite, or ran out of room.
    #[error("kernel {kernel} failed first for agent {agent}: a value that is not finite, or a full buffer")]
    Failure {
        /// The kernel.
        kernel: &'static str,
        /// The first agent.
        agent: u32,
    },
    /// The agent to lead walks by itself, or is not in the crowd.
    #[error("agent {agent} cannot be led: set it up with setup::set_led before the simulation begins")]
    NotLed {
        /// The agent.
        agent: u32,
    },
    /// The target or velocity of a led agent is not finite, or too large.
    #[error(
        "agent {agent} cannot be led to {position} m at {velocity} m/s: both must be finite and below 1e8"
    )]
    Lead {
        /// The agent.
        agent: u32,
        /// Where it was to be, m.
        position: Vec2,
        /// How fast, m/s.
        velocity: Vec2,
    },
    /// No agent can stand at a goal.
    #[error(
        "goal {name:?} at ({x:.2}, {z:.2}) m{} lies where nobody can stand (in something solid, too near to a wall, or outside); \
         move it at least a body's radius from walls, make its radius larger, or lower way_finding.clearance",
        high(*.elevation)
    )]
    Goal {
        /// Its name.
        name: String,
        /// Where it is, m.
        x: f32,
        /// Where it is, m.
        z: f32,
        /// Height of the floor that it is on, m.
        elevation: f32,
    },
    /// No way leads from one storey to another.
    #[error(
        "goal {name:?} at ({:.2}, {:.2}) m{} cannot be reached from ({:.2}, {:.2}) m{}: no ramp or stairs lead there; \
         floors and the ground are joined where their edges meet less than 0.6 m above one another, without a railing or \
         obstacle, and wide enough for way_finding.clearance",
        .to.x, .to.y, high(*.to_elevation), .from.x, .from.y, high(*.from_elevation)
    )]
    Unreachable {
        /// Name of the goal.
        name: String,
        /// Where it is, m.
        to: Vec2,
        /// Height of the floor that it is on, m.
        to_elevation: f32,
        /// Where an agent sets out for it, m.
        from: Vec2,
        /// Height of the floor there, m.
        from_elevation: f32,
    },
    /// Too many floors lie above one another.
    #[error(
        "floors: more than {most} lie above one another, which way_finding cannot tell apart; leave it at \"straight\""
    )]
    Sheets {
        /// The most there may be.
        most: usize,
    },
    /// Too many goals have a field of their own.
    #[error(
        "way_finding.way: more than {most} different goals and waypoints; leave it at \"straight\", or let journeys share stages"
    )]
    Fields {
        /// The most there may be.
        most: usize,
    },
    /// The flow grid would have too many cells.
    #[error(
        "way_finding.cell = {size} m: must be at least {least} m for {fields} fields over this area; leave it out"
    )]
    FlowGrid {
        /// Side of a cell, m.
        size: f32,
        /// The least there may be, m.
        least: f32,
        /// Fields.
        fields: usize,
    },
    /// The solver of the flow fields did not converge.
    #[error("the ways to the goals are not found after {turns} turns: please report the scenario")]
    FlowTurns {
        /// Turns done.
        turns: u32,
    },
    /// The program was built without Vulkan.
    #[error("this build has no Vulkan backend")]
    NoVulkan,
}

/// How high something is, if it is not on the ground.
fn high(elevation: f32) -> String {
    if elevation == 0.0 { String::new() } else { format!(" ({elevation:.2} m high)") }
}
