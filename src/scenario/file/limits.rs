//! Every number of a scenario file: its key, its unit, the least and the greatest that it may be, and what is usual.
//! [`Scenario::validate`](super::Scenario::validate) and the JSON Schema read the same rows.

use super::navigation::MAX_NEIGHBOURS;
use super::population::MAX_AGENTS;
use crate::gait::walker::MOST_EXPRESSION;

/// Farthest coordinate, m: beyond it an f32 no longer resolves a centimetre.
pub const MAX_COORDINATE: f32 = 50_000.0;
/// A day, s.
pub(crate) const DAY: f32 = 86_400.0;

/// What a number may be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Limits {
    /// The key from the root, without indices: `routes.waypoints`. A last part `*` is any name that the file gives.
    pub(crate) key: &'static str,
    /// Its unit; `1` where it has none.
    pub(crate) unit: &'static str,
    pub(crate) least: f32,
    pub(crate) greatest: f32,
    /// What is usual, or what it means, for one who wrote something else.
    pub(crate) hint: &'static str,
}

/// The limits of a key with or without indices: those of `routes[2].waypoints[0]` are those of `routes.waypoints`.
pub(crate) fn limits(key: &str) -> Option<&'static Limits> {
    let plain: String =
        key.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect();
    LIMITS.iter().find(|limits| match limits.key.strip_suffix(".*") {
        Some(table) => plain.strip_prefix(table).is_some_and(|rest| rest.is_empty() || rest.starts_with('.')),
        None => limits.key == plain,
    })
}

const fn number(
    key: &'static str,
    unit: &'static str,
    least: f32,
    greatest: f32,
    hint: &'static str,
) -> Limits {
    Limits { key, unit, least, greatest, hint }
}

/// A point on the ground.
const fn place(key: &'static str) -> Limits {
    number(key, "m", -MAX_COORDINATE, MAX_COORDINATE, "shift the scene towards the origin")
}

/// An angle about +y.
const fn turn(key: &'static str, hint: &'static str) -> Limits {
    number(key, "deg", -360.0, 360.0, hint)
}

/// A number relative to its neighbours.
const fn share(key: &'static str, hint: &'static str) -> Limits {
    number(key, "1", 0.0, 1e6, hint)
}

/// Height of a floor.
const fn height(key: &'static str) -> Limits {
    number(key, "m", -100.0, 100.0, "metres above the ground; 0 is the ground")
}

/// A trait of `[emotion_dynamics]`.
const fn dynamics(key: &'static str) -> Limits {
    number(key, "1", 0.0, 1.0, "try [0.3, 0.9]")
}

const RELATIVE: &str = "shares are relative: 1 and 1 is half each";
const REACH: &str = "metres; 0.5 is usual, a metre or more where many share a place";

#[allow(clippy::cast_possible_truncation, clippy::cast_precision_loss, reason = "small whole numbers")]
const LIMITS: [Limits; 117] = [
    place("bounds"),
    number("way_finding.cell", "m", 0.05, 5.0, "metres; leave it out for 0.25 or 0.5"),
    number("way_finding.clearance", "m", 0.0, 5.0, "metres; a body's radius is usual"),
    number("way_finding.density_weight", "m²", 0.0, 100.0, "0.5 to 2 is usual; 0 is none"),
    number("way_finding.every", "s", 0.05, 3600.0, "seconds; 1 is usual"),
    number("gaze.budget", "agents", 0.0, MAX_AGENTS as f32, "12 is usual"),
    number("gaze.turn", "s", 0.1, 60.0, "try [1, 4]"),
    number("population.agents", "agents", 0.0, MAX_AGENTS as f32, "split the crowd over several runs"),
    number("population.present", "1", 0.0, 1.0, "share of the agents that are there from the start"),
    number(
        "population.expression",
        "1",
        0.0,
        MOST_EXPRESSION as f32,
        "crowds walk with 2; people differ by 1",
    ),
    number("population.individuals", "1", 0.0, 1.0, "0 walks every gait as it is, 1 differs as people do"),
    number("population.scale", "1", 0.5, 2.0, "try [0.93, 1.07]"),
    number("population.bodies.ages", "years", 2.0, 120.0, "years; try [20, 79]"),
    number("population.bodies.body_mass_index", "kg/m²", 12.0, 60.0, "kg/m²; 25 is usual"),
    number(
        "population.bodies.variety",
        "1",
        0.0,
        1.0,
        "0 is one shape for each stature and weight, 1 as people differ",
    ),
    share("population.emotions.happy", RELATIVE),
    share("population.emotions.angry", RELATIVE),
    share("population.emotions.sad", RELATIVE),
    share("population.emotions.neutral", RELATIVE),
    number("population.affect.valence", "1", -1.0, 1.0, "0 is neither; try [-0.5, 0.5]"),
    number("population.affect.arousal", "1", -1.0, 1.0, "0 is neither; try [-0.5, 0.5]"),
    number("population.prefer.speed", "m/s", 0.1, 5.0, "people walk at 0.8 to 1.8"),
    number("population.prefer.speed_tolerance", "m/s", 0.0, 5.0, "m/s; 0.1 is usual"),
    number(
        "population.prefer.margin_temperature",
        "1",
        0.0,
        100.0,
        "rating points; 0.5 is a clear preference, 0 takes the clearest gait always",
    ),
    share("population.groups.sizes", RELATIVE),
    number("population.traits.*", "1", 0.0, 100.0, "times the value of an average person; 1 changes nothing"),
    share("population.classes.share", RELATIVE),
    number("population.classes.age", "years", 3.0, 120.0, "years"),
    number("population.classes.speed", "m/s", 0.1, 5.0, "people walk at 0.5 to 1.8 m/s"),
    number("population.classes.radius", "m", 0.05, 2.0, "metres; 0.2 is usual"),
    number("population.classes.time_horizon", "s", 0.1, 20.0, "seconds; 2 is usual"),
    number("population.classes.neighbour_distance", "m", 0.5, 50.0, "metres; 5 is usual"),
    number("population.classes.neighbour_cap", "agents", 1.0, MAX_NEIGHBOURS as f32, "10 is usual"),
    number("population.classes.priority", "1", 0.0, 1.0, "0 is usual"),
    number("population.classes.reaction", "s", 0.0, 3600.0, "seconds; [0, 60] is a slow start"),
    number("population.classes.personality.*", "1", -1.0, 1.0, "0 is average"),
    number("navigation.time_step", "s", 0.001, 0.2, "1/30 s = 0.0333 is usual"),
    number("navigation.neighbour_distance", "m", 0.5, 50.0, "metres; 5 is usual"),
    number("navigation.neighbour_cap", "agents", 1.0, MAX_NEIGHBOURS as f32, "10 is usual"),
    number("navigation.time_horizon", "s", 0.1, 20.0, "seconds; 2 is usual"),
    number("navigation.time_horizon_obstacles", "s", 0.1, 20.0, "seconds; 0.5 to 1 is usual"),
    number("navigation.time_horizon_dense", "s", 0.0, 60.0, "seconds; 1 is usual, 0 is none"),
    number("navigation.time_horizon_jam", "s", 0.0, 60.0, "seconds; 0.15 is usual, 0 is none"),
    number("navigation.safety_margin", "m", 0.0, 1.0, "metres; 0.01 is usual"),
    number("navigation.crowding", "1", 0.0, 1.0, "0 is off, 1 is Weidmann's fundamental diagram"),
    number("navigation.radius", "m", 0.05, 2.0, "metres; 0.2 is usual"),
    number("navigation.max_speed_factor", "1", 1.0, 10.0, "times the preferred speed; 1.5 is usual"),
    number("navigation.max_speed", "m/s", 0.1, 10.0, "metres a second; 2.5 is usual"),
    number("navigation.perturbation", "m/s", 0.0, 0.5, "m/s; 0.02 is usual"),
    number("navigation.collision_weight", "m", 0.0, 100.0, "metres; 1 is usual"),
    number("navigation.max_acceleration", "m/s²", 0.1, 100.0, "m/s2; 10 is usual"),
    number("navigation.patience", "s", 0.0, 600.0, "seconds; 1 is usual, 0 is never"),
    place("user.position"),
    height("user.elevation"),
    turn("user.heading_deg", "degrees; 0 looks along +z"),
    number("user.eye_height", "m", 0.3, 2.5, "metres; 1.65 is usual"),
    number("user.radius", "m", 0.05, 5.0, "metres; 0.3 is usual"),
    number("user.comfort", "m", 0.0, 5.0, "metres; 0.5 is usual"),
    place("obstacles.polygon"),
    number("obstacles.low", "m", -1000.0, 1000.0, "metres above the ground"),
    number("obstacles.high", "m", -1000.0, 1000.0, "metres, above its low"),
    place("spawns.polygon"),
    height("spawns.elevation"),
    number("spawns.weight", "1", 0.0, 1e9, "relative to the other regions"),
    place("routes.waypoints"),
    number("routes.width", "m", 0.0, 10_000.0, "metres; 0 is a single lane"),
    number("routes.radius", "m", 0.3, 50.0, "metres; 1 to 3 is usual"),
    share("routes.weight", "1 is as busy as the other routes"),
    place("floors.polygon"),
    height("floors.heights"),
    number("floors.railings", "1", 0.0, 7.0, "edge 0 leads from the first corner to the second"),
    place("stages.position"),
    height("stages.elevation"),
    number("stages.size", "m", 0.2, 10_000.0, "metres"),
    turn("stages.heading_deg", "degrees about +y"),
    number("stages.radius", "m", 0.1, 50.0, "metres; 1 to 3 is usual"),
    number("stages.wait", "s", 0.0, DAY, "seconds; a day is the most"),
    number("stages.until", "s", 0.0, DAY, "seconds since the start; a day is the most"),
    number("stages.places", "people", 1.0, 1000.0, "how many people can stand in it"),
    number("stages.spacing", "m", 0.3, 10.0, "metres; 0.8 is usual"),
    number("stages.service_time", "s", 0.0, DAY, "seconds; a day is the most"),
    share("journeys.stages.*", RELATIVE),
    share("journeys.weight", "1 is as many as of the other journeys"),
    place("sources.polygon"),
    height("sources.elevation"),
    number("sources.rate", "1/s", 1e-4, 1000.0, "agents a second"),
    number("sources.begin", "s", 0.0, DAY, "seconds since the start"),
    number("sources.end", "s", 0.0, DAY, "seconds since the start, after begin"),
    number("sources.schedule.time", "s", 0.0, DAY, "seconds since the start, in order"),
    number("sources.schedule.count", "people", 0.0, MAX_AGENTS as f32, "how many come in then"),
    number("sources.share", "1", 0.0, 1.0, "of population.agents"),
    number("emotion_dynamics.radius", "m", 0.0, 10.0, "metres; 3 is usual, 0 is no contagion"),
    number("emotion_dynamics.contagion", "1/s", 0.0, 100.0, "1/s; 0.2 is usual"),
    number("emotion_dynamics.decay", "1/s", 0.0, 100.0, "1/s; 0.05 is usual, 0 is never"),
    dynamics("emotion_dynamics.expressiveness"),
    dynamics("emotion_dynamics.openness"),
    dynamics("emotion_dynamics.amplification"),
    dynamics("emotion_dynamics.bias"),
    number("events.time", "s", 0.0, DAY, "seconds since the start"),
    number("events.duration", "s", 0.0, DAY, "seconds; 1 to 5 is usual"),
    place("events.place"),
    number("events.radius", "m", 0.1, 10_000.0, "metres; 10 is usual"),
    number("events.strength", "1", 0.0, 1.0, "the weight that the emotion gets"),
    number("outsiders.radius", "m", 0.05, 5.0, "metres; a car is 1 wide each side"),
    number("outsiders.comfort", "m", 0.0, 5.0, "metres; 0.5 is usual"),
    number("outsiders.size", "m", 0.05, 50.0, "metres: width, height, length"),
    place("walkers.position"),
    place("walkers.waypoints"),
    number("walkers.arrival", "m", 0.01, 100.0, REACH),
    number("walkers.goal_arrival", "m", 0.01, 100.0, REACH),
    number("walkers.radius", "m", 0.05, 2.0, "metres; 0.2 is usual"),
    number("walkers.speed", "m/s", 0.05, 5.0, "metres per second; 1.3 is usual"),
    place("walkers.teleport.from"),
    place("walkers.teleport.to"),
    place("environment.props.position"),
    turn("environment.props.heading_deg", "degrees about +y"),
    number("environment.props.size", "m", 0.01, 20_000.0, "metres: [width, height, depth]"),
];
