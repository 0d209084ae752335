//! Agents that a scenario names one by one, each with a start and a way of its own; and their allowed ranges.

use super::casting::Cast;
use super::crowd::{Crowd, Entry, Stop};
use super::error::Error;
use super::populate::Place;
use super::schema::{Point, RouteMode, Scenario};
use super::validate::{MAX_AGENTS, point, within};
use super::way_finding::Way;
use crate::library::choose::Chooser;
use glam::Vec2;
use serde::{Deserialize, Serialize};

/// Most waypoints of one walker.
const MAX_WAYPOINTS: usize = 4096;

/// One agent, in addition to those of `population`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Walker {
    /// Start (x, z), m.
    pub position: Point,
    /// Places it walks to, one after another; none: it stands.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub waypoints: Vec<Point>,
    /// What follows the last one: stay (`once`), the same way back (`patrol`), on to the first (`loop`).
    #[serde(default = "once", skip_serializing_if = "is_once")]
    pub mode: RouteMode,
    /// Distance at which a waypoint counts as reached, m.
    #[serde(default = "arrival")]
    pub arrival: f32,
    /// The same for the last one, m; left out: `arrival`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub goal_arrival: Option<f32>,
    /// Disc radius, m; left out: `navigation.radius` times its size.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<f32>,
    /// Preferred speed, m/s; left out: that of its gait. Its gait is one near that speed, walked at another cadence.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub speed: Option<f32>,
    /// How it finds the way to its waypoints; left out: as `way_finding.way` says.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub way: Option<Way>,
    /// A place where it is taken away, and where it is put.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub teleport: Option<Teleport>,
}

/// Two boxes, each by its least and greatest corner (x, z), m: who comes into the first is put at random into the second.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Teleport {
    /// Where it is taken away.
    pub from: [Point; 2],
    /// Where it is put.
    pub to: [Point; 2],
}

const fn once() -> RouteMode {
    RouteMode::Once
}

#[allow(clippy::trivially_copy_pass_by_ref, reason = "as serde calls it")]
fn is_once(mode: &RouteMode) -> bool {
    *mode == RouteMode::Once
}

const fn arrival() -> f32 {
    0.5
}

impl Default for Walker {
    fn default() -> Self {
        Self {
            position: [0.0; 2],
            waypoints: Vec::new(),
            mode: once(),
            arrival: arrival(),
            goal_arrival: None,
            radius: None,
            speed: None,
            way: None,
            teleport: None,
        }
    }
}

impl Walker {
    /// Whether its way ends somewhere.
    pub fn ends(&self) -> bool {
        self.mode == RouteMode::Once && !self.waypoints.is_empty() && self.teleport.is_none()
    }

    /// The places of its way, there and back where it patrols, each with the distance at which it counts as reached.
    pub(super) fn way(&self) -> Vec<(Point, f32)> {
        let last = self.goal_arrival.unwrap_or(self.arrival);
        let mut way: Vec<(Point, f32)> = self.waypoints.iter().map(|place| (*place, self.arrival)).collect();
        if let Some(end) = way.last_mut() {
            end.1 = last;
        }
        if self.mode == RouteMode::Patrol {
            let back: Vec<_> = way.iter().rev().skip(1).copied().collect();
            way.extend(back);
            if self.waypoints.len() < 2 {
                way.push((self.position, last));
            }
        }
        way
    }
}

/// Checks the walkers of a scenario.
pub(super) fn validate(scenario: &Scenario) -> Result<(), Error> {
    let walkers = &scenario.walkers;
    let total = walkers.len() + scenario.population.agents as usize;
    if total > MAX_AGENTS as usize {
        let allowed = format!("at most {MAX_AGENTS} together with population.agents");
        return Err(Error::value("walkers", walkers.len(), allowed, "split the crowd over several runs"));
    }
    for (index, walker) in walkers.iter().enumerate() {
        let key = |name: &str| format!("walkers[{index}].{name}");
        point(&key("position"), walker.position)?;
        if walker.waypoints.len() > MAX_WAYPOINTS {
            let found = walker.waypoints.len();
            return Err(Error::value(
                key("waypoints"),
                found,
                format!("at most {MAX_WAYPOINTS}"),
                "leave some out",
            ));
        }
        for (k, place) in walker.waypoints.iter().enumerate() {
            point(&format!("walkers[{index}].waypoints[{k}]"), *place)?;
        }
        let reach = "metres; 0.5 is usual, a metre or more where many share a place";
        within(&key("arrival"), walker.arrival, 0.01, 100.0, reach)?;
        for (name, value, low, high, hint) in [
            ("goal_arrival", walker.goal_arrival, 0.01, 100.0, reach),
            ("radius", walker.radius, 0.05, 2.0, "metres; 0.2 is usual"),
            ("speed", walker.speed, 0.05, 5.0, "metres per second; 1.3 is usual"),
        ] {
            if let Some(value) = value {
                within(&key(name), value, low, high, hint)?;
            }
        }
        for (name, [low, high]) in walker.teleport.iter().flat_map(|t| [("from", t.from), ("to", t.to)]) {
            let key = key(&format!("teleport.{name}"));
            point(&key, low)?;
            point(&key, high)?;
            if low[0] > high[0] || low[1] > high[1] {
                let found = format!("{low:?}, {high:?}");
                return Err(Error::value(key, found, "the least corner, then the greatest", "swap them"));
            }
        }
    }
    Ok(())
}

/// Adds the walkers to a crowd: cast like everyone else, with a gait near their own speed.
pub(super) fn join(scenario: &Scenario, chooser: &Chooser, crowd: &mut Crowd) -> Result<(), Error> {
    let mut own = scenario.clone();
    own.walkers = Vec::new();
    for walker in &scenario.walkers {
        let agent = u32::try_from(crowd.agents.len()).unwrap_or(u32::MAX);
        let position = Vec2::from(walker.position);
        let way = walker.way();
        let ahead =
            way.iter().map(|(place, _)| Vec2::from(*place)).find(|place| place.distance(position) > 0.01);
        let place = Place {
            position,
            direction: (ahead.unwrap_or(position + Vec2::Y) - position).normalize_or(Vec2::Y),
            route_start: u32::try_from(crowd.stages.len()).unwrap_or(u32::MAX),
            route_length: u32::try_from(way.len().max(1)).unwrap_or(1),
            waypoint: 0,
            elevation: 0.0,
            loops: walker.mode != RouteMode::Once && !way.is_empty(),
        };
        own.population.prefer.speed =
            walker.speed.map(|speed| [speed; 2]).or(scenario.population.prefer.speed);
        let mut start = Cast::new(&own, chooser)?.agent(agent, place, Entry::Start)?;
        start.radius = walker.radius.unwrap_or(start.radius);
        start.speed = walker.speed.or(start.speed);
        start.teleport = walker.teleport;
        // Who stands has been where it goes.
        let stands = || (walker.position, walker.arrival);
        let way = if way.is_empty() { vec![stands()] } else { way };
        let stop =
            |(place, radius): (Point, f32)| Stop { way: walker.way, ..Stop::waypoint(place.into(), radius) };
        crowd.stages.extend(way.into_iter().map(stop));
        crowd.agents.push(start);
    }
    Ok(())
}
