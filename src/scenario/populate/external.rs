//! People whose movement comes from elsewhere (a recording): they get an emotion, a gait near their own speed, a body
//! and clothes like everyone else.

use super::crowd::{AgentStart, Entry};
use super::places::Place;
use super::traits::{TraitSampler, chooser};
use crate::emotion::Emotion;
use crate::ground::heading_from_ground;
use crate::library::GaitLibrary;
use crate::scenario::error::Error;
use crate::scenario::file::{ExternalAgent, ExternalKind, GaitChoice, Scenario};
use glam::Vec2;

/// Slowest and fastest gait that is asked for, m/s.
const SPEEDS: [f32; 2] = [0.3, 3.0];

/// A person who is led along a recording.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ExternalPerson {
    /// Where they appear first (x, z), m.
    pub position: Vec2,
    /// Heading about +y, rad.
    pub heading: f32,
    /// Mean walking speed, m/s; `None`: they never walk.
    pub speed: Option<f32>,
}

/// Makes people agents number `first` and on, with sampled traits. They have no route of their own.
///
/// # Errors
/// As [`super::populate_from`], but for places.
pub fn populate_people(
    scenario: &Scenario,
    library: &GaitLibrary,
    first: u32,
    people: &[ExternalPerson],
) -> Result<Vec<AgentStart>, Error> {
    let chooser = chooser(scenario, library, None)?;
    let mut own = scenario.clone();
    own.population.gaits = GaitChoice::Random;
    let mut agents = Vec::with_capacity(people.len());
    for (agent, person) in (first..).zip(people) {
        let [slowest, fastest] = SPEEDS;
        let speed = person.speed.map(|speed| [speed.clamp(slowest, fastest); 2]);
        own.population.prefer.speed = speed.or(scenario.population.prefer.speed);
        let place = Place {
            elevation: 0.0,
            position: person.position,
            direction: Vec2::from_angle(std::f32::consts::FRAC_PI_2 - person.heading),
            route_start: 0,
            route_length: 1,
            waypoint: 1, // there already: nothing to arrive at
            loops: false,
        };
        agents.push(TraitSampler::new(&own, &chooser)?.agent(agent, place, Entry::Start)?);
    }
    Ok(agents)
}

/// The starts of external agents; their ids follow those of the crowd.
pub(super) fn starts(scenario: &Scenario, sampler: &TraitSampler<'_>) -> Result<Vec<AgentStart>, Error> {
    let first = scenario.population.agents;
    let one = |(index, outsider): (u32, &ExternalAgent)| {
        let way = match outsider.path.as_slice() {
            [[_, x, z], [_, to_x, to_z], ..] => Vec2::new(to_x - x, to_z - z),
            _ => Vec2::Y,
        };
        let mut start =
            sampler.body(first + index, Emotion::Neutral, outsider.kind == ExternalKind::Person)?;
        start.position = outsider.start().unwrap_or_default();
        start.heading = heading_from_ground(way.normalize_or(Vec2::Y));
        start.radius = outsider.radius(scenario);
        Ok(start)
    };
    (0..).zip(&scenario.outsiders).map(one).collect()
}
