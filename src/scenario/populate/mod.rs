//! Fills a scenario with agents: where each starts, how it feels, how it walks, how it looks.
//!
//! All draws are counter-based ([`crate::scenario::random`]): what agent i is like depends on the seed and i alone; where it
//! starts depends, besides, on the agents before it, because no two may overlap. In a large crowd the people at the start are
//! numbered by their places, so it depends on all of them.

mod bodies;
mod crowd;
mod external;
mod feelings;
mod groups;
mod journeys;
mod lanes;
mod people;
mod places;
mod shares;
mod sources;
mod traits;
mod walkers;

pub use crowd::{AgentStart, Avoidance, Crowd, Entry, SourceStart, Stop, StopKind};
pub use external::{ExternalPerson, populate_people};
pub use lanes::ROUTE_CLEARANCE;

use crate::emotion::Emotion;
use crate::library::GaitLibrary;
use crate::library::choose::Chooser;
use crate::perception::Perceiver;
use crate::scenario::error::Error;
use crate::scenario::file::Scenario;
use crate::scenario::place::Clearance;
use glam::Vec2;
use lanes::Lanes;
use places::{Place, Places};
use std::cmp::Ordering;
use std::collections::BTreeMap;
use std::ops::Range;
use traits::{TraitSampler, chooser};

/// The most people who are numbered as their places are drawn. The state of more does not fit into the cache of a core: their
/// numbers follow their places, so that what is read together lies together.
pub(crate) const MOST_BY_CHANCE: u32 = 16_384;
/// How deep a row of places is, m.
const ROW: f32 = 1.0;

/// Fills a scenario with its agents, knowing of the gaits no more than which look like an emotion.
///
/// `gaits_for` is GEA(e): the gaits of a library that look like an emotion, as indices into it.
///
/// # Errors
/// [`Error::Value`] for an invalid scenario; [`Error::Populate`] when an emotion in use has no gait, a route is
/// blocked, there is no room, or the scenario prefers gaits by what only [`populate_from`] knows: what, where, and the
/// way out.
pub fn populate<'a>(scenario: &Scenario, gaits_for: impl Fn(Emotion) -> &'a [u32]) -> Result<Crowd, Error> {
    scenario.validate()?;
    if !scenario.population.prefer.is_nothing() {
        return Err(Error::Populate {
            name: scenario.name.clone(),
            message: "population.prefer needs the gaits themselves, not only their numbers".to_owned(),
            hint: "populate it from a library (populate_from), or leave population.prefer out".to_owned(),
        });
    }
    fill(scenario, &Chooser::of_ids(gaits_for))
}

/// Fills a scenario with its agents, who choose their gaits out of a library as the scenario says.
///
/// # Errors
/// As [`populate`]; also when `population.prefer.margin_temperature` is given and a gait has no ratings.
pub fn populate_from(scenario: &Scenario, library: &GaitLibrary) -> Result<Crowd, Error> {
    populate_with(scenario, library, None)
}

/// [`populate_from`] with a perceiver that judges how clearly unrated gaits show their emotion.
///
/// # Errors
/// As [`populate_from`].
pub fn populate_with(
    scenario: &Scenario,
    library: &GaitLibrary,
    perceiver: Option<&dyn Perceiver>,
) -> Result<Crowd, Error> {
    scenario.validate()?;
    fill(scenario, &chooser(scenario, library, perceiver)?)
}

/// Fills a valid scenario.
fn fill(scenario: &Scenario, chooser: &Chooser) -> Result<Crowd, Error> {
    let geometry = scenario.geometry();
    let sampler = TraitSampler::new(scenario, chooser)?;
    if scenario.population.agents == 0 {
        let mut crowd = Crowd { external: external::starts(scenario, &sampler)?, ..Crowd::default() };
        walkers::join(scenario, chooser, &mut crowd)?;
        return Ok(crowd);
    }
    let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let lanes = Lanes::new(scenario, &geometry, &free)?;
    let mut places = Places::new(scenario, &geometry, &free, &lanes)?;
    let split = sources::split(scenario);
    for walker in &scenario.walkers {
        places.taken.insert(Vec2::from(walker.position));
    }
    let mut agents: Vec<AgentStart> = Vec::with_capacity(scenario.population.agents as usize);
    let mut groups = Vec::new();
    while let Some(members) = next_group(scenario, groups.last().map_or(0, end_of), split.start) {
        groups.push((members.clone(), places.place(&members)?));
    }
    if split.start > MOST_BY_CHANCE {
        number_by_place(&mut groups);
    }
    for (members, places) in groups {
        for (agent, place) in members.clone().zip(places) {
            let companions = groups::others(&members, agent);
            agents.push(AgentStart { companions, ..sampler.agent(agent, place, Entry::Start)? });
        }
    }
    let mut starts = Vec::with_capacity(split.sources.len());
    for (index, (source, count)) in scenario.sources.iter().zip(split.sources).enumerate() {
        let key = format!("sources[{index}]");
        let elevation = source.elevation.unwrap_or(0.0);
        let bears = |at: Vec2| geometry.floors.footing(at, elevation).is_some();
        let inside = sources::places(&key, source, &free, places.body + 0.05, bears)?;
        let ways = places.ways(&format!("{key}.routes"), &source.routes, &source.journeys, false)?;
        let first_agent = next_id(&agents);
        while let Some(members) = next_group(scenario, next_id(&agents), first_agent + count) {
            let first = members.start;
            let place = places
                .entrance(first, inside[0], elevation, &ways)
                .ok_or_else(|| places.full(first, u32::MAX))?;
            for agent in members.clone() {
                let companions = groups::others(&members, agent);
                let step = sources::entry_step(source, agent - first_agent, scenario.navigation.time_step);
                agents.push(AgentStart { companions, ..sampler.agent(agent, place, Entry::Step(step))? });
            }
        }
        starts.push(SourceStart { first_agent, agents: count, places: inside });
    }
    for agent in next_id(&agents)..scenario.population.agents {
        agents.push(sampler.agent(agent, Place::NOWHERE, Entry::Never)?);
    }
    let external = external::starts(scenario, &sampler)?;
    let mut crowd = Crowd { agents, external, sources: starts, stages: lanes.stages };
    walkers::join(scenario, chooser, &mut crowd)?;
    Ok(crowd)
}

/// The number of the next agent.
fn next_id(agents: &[AgentStart]) -> u32 {
    u32::try_from(agents.len()).unwrap_or(u32::MAX)
}

/// People who start together, and where.
type Placed = (Range<u32>, Vec<Place>);

fn end_of((members, _): &Placed) -> u32 {
    members.end
}

/// Exchanges places between groups of the same size, so that people of near numbers are near each other: floor by floor, row by
/// row. What people are like depends on their numbers, and stays.
fn number_by_place(groups: &mut [Placed]) {
    let mut of_size: BTreeMap<usize, Vec<usize>> = BTreeMap::new();
    for (number, (_, places)) in groups.iter().enumerate() {
        of_size.entry(places.len()).or_default().push(number);
    }
    for numbers in of_size.values() {
        let mut sorted: Vec<Vec<Place>> =
            numbers.iter().map(|number| std::mem::take(&mut groups[*number].1)).collect();
        let key = |places: &Vec<Place>| {
            places.first().map(|place| (place.elevation, (place.position.y / ROW).floor(), place.position.x))
        };
        sorted.sort_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(Ordering::Equal));
        for (number, places) in numbers.iter().zip(sorted) {
            groups[*number].1 = places;
        }
    }
}

/// The agents from number `first` on, below number `end`: one that walks alone, or a group.
fn next_group(scenario: &Scenario, first: u32, end: u32) -> Option<Range<u32>> {
    (first < end).then(|| first..groups::members(scenario, first).end.min(end))
}
