//! Fills a scenario with agents: where each starts, how it feels, how it walks, how it looks.
//!
//! All draws are counter-based ([`super::random`]): what agent i is like depends on the seed and i alone; where it
//! starts depends, besides, on the agents before it, because no two may overlap.

use super::casting::Cast;
use super::clearance::Clearance;
use super::companions;
use super::crowd::{AgentStart, Crowd, Entry, SourceStart};
use super::error::Error;
use super::floors::Floors;
use super::lanes::Lanes;
use super::layout::Geometry;
use super::people::largest_radius;
use super::polygon;
use super::random::{Purpose, unit};
use super::schema::{Scenario, Spawn};
use super::sources;
use crate::emotion::Emotion;
use crate::library::GaitLibrary;
use crate::library::choose::{Chooser, Clarity, margins};
use crate::perception::Perceiver;
use glam::{IVec2, Vec2};
use std::ops::Range;

/// Draws before a place is given up as full.
const ATTEMPTS: u32 = 2000;
/// Gap between two agents at the start, m.
const GAP: f32 = 0.1;
/// Gap to the user at the start, m.
const USER_GAP: f32 = 0.8;

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

/// [`populate_from`] with somebody who tells how clearly gaits that nobody rated show their emotion.
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

/// Who chooses the gaits of a scenario out of a library.
pub(super) fn chooser(
    scenario: &Scenario,
    library: &GaitLibrary,
    perceiver: Option<&dyn Perceiver>,
) -> Result<Chooser, Error> {
    let prefer = &scenario.population.prefer;
    let clarity = prefer
        .margin_temperature
        .map(|temperature| Clarity { margins: margins(library, perceiver), temperature });
    Chooser::new(library, prefer.speed_tolerance, clarity.as_ref()).map_err(|error| {
        let hint = "or leave population.prefer.margin_temperature out".to_owned();
        Error::Populate { name: scenario.name.clone(), message: error.to_string(), hint }
    })
}

/// Fills a valid scenario.
fn fill(scenario: &Scenario, chooser: &Chooser) -> Result<Crowd, Error> {
    let geometry = scenario.geometry();
    let cast = Cast::new(scenario, chooser)?;
    if scenario.population.agents == 0 {
        let mut crowd = Crowd { outsiders: super::outsiders::cast(scenario, &cast)?, ..Crowd::default() };
        super::walkers::join(scenario, chooser, &mut crowd)?;
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
    while let Some(members) = next_group(scenario, &agents, split.start) {
        for (agent, place) in members.clone().zip(places.place(&members)?) {
            let companions = companions::others(&members, agent);
            agents.push(AgentStart { companions, ..cast.agent(agent, place, Entry::Start)? });
        }
    }
    let mut starts = Vec::with_capacity(split.sources.len());
    for (index, (source, count)) in scenario.sources.iter().zip(split.sources).enumerate() {
        let key = format!("sources[{index}]");
        let inside = sources::places(&key, source, &free, places.body + 0.05)?;
        let ways = places.ways(&format!("{key}.routes"), &source.routes, &source.journeys, false)?;
        let first_agent = next_id(&agents);
        while let Some(members) = next_group(scenario, &agents, first_agent + count) {
            let first = members.start;
            let place =
                places.entrance(first, inside[0], &ways).ok_or_else(|| places.full(first, u32::MAX))?;
            for agent in members.clone() {
                let companions = companions::others(&members, agent);
                let step = sources::entry_step(source, agent - first_agent, scenario.navigation.time_step);
                agents.push(AgentStart { companions, ..cast.agent(agent, place, Entry::Step(step))? });
            }
        }
        starts.push(SourceStart { first_agent, agents: count, places: inside });
    }
    for agent in next_id(&agents)..scenario.population.agents {
        agents.push(cast.agent(agent, Place::NOWHERE, Entry::Never)?);
    }
    let outsiders = super::outsiders::cast(scenario, &cast)?;
    let mut crowd = Crowd { agents, outsiders, sources: starts, stages: lanes.stages };
    super::walkers::join(scenario, chooser, &mut crowd)?;
    Ok(crowd)
}

/// The number of the next agent.
fn next_id(agents: &[AgentStart]) -> u32 {
    u32::try_from(agents.len()).unwrap_or(u32::MAX)
}

/// Who follows the agents that there are, below number `end`: one who walks alone, or a group.
fn next_group(scenario: &Scenario, agents: &[AgentStart], end: u32) -> Option<Range<u32>> {
    let first = next_id(agents);
    (first < end).then(|| first..companions::members(scenario, first).end.min(end))
}

/// Index of the share that `u` in [0, 1) falls into; shares need not be normalised.
pub(super) fn weighted(cumulative: &[f32], u: f32) -> usize {
    let total = cumulative.last().copied().unwrap_or(0.0);
    cumulative.partition_point(|&end| end <= u * total).min(cumulative.len().saturating_sub(1))
}

pub(super) fn cumulate(shares: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let add = |sum: &mut f32, share: f32| {
        *sum += share;
        Some(*sum)
    };
    shares.into_iter().scan(0.0, add).collect()
}

/// Where an agent starts and what it walks to.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) position: Vec2,
    /// Height of the floor stood on, m.
    pub(super) elevation: f32,
    pub(super) direction: Vec2,
    pub(super) route_start: u32,
    pub(super) route_length: u32,
    pub(super) waypoint: u32,
    pub(super) loops: bool,
}

impl Place {
    /// Of somebody who never comes in.
    const NOWHERE: Self = Self {
        position: Vec2::ZERO,
        elevation: 0.0,
        direction: Vec2::Y,
        route_start: 0,
        route_length: 1,
        waypoint: 0,
        loops: false,
    };
}

/// What is walked from a spawn region or source.
#[derive(Debug)]
enum Walked {
    /// One of these routes.
    Routes(Vec<usize>),
    /// One of these journeys.
    Journeys(Vec<usize>),
}

/// Finds a place for one agent after the other.
struct Places<'a> {
    scenario: &'a Scenario,
    free: &'a Clearance,
    floors: &'a Floors,
    lanes: &'a Lanes,
    geometry: &'a Geometry,
    /// Corners of each spawn region, and what is walked from it.
    regions: Vec<(Vec<Vec2>, Walked)>,
    region_ends: Vec<f32>,
    route_ends: Vec<f32>,
    /// The largest radius, m.
    body: f32,
    taken: Taken,
}

impl<'a> Places<'a> {
    fn new(
        scenario: &'a Scenario,
        geometry: &'a Geometry,
        free: &'a Clearance,
        lanes: &'a Lanes,
    ) -> Result<Self, Error> {
        let body = largest_radius(scenario);
        let mut made = Self {
            scenario,
            geometry,
            free,
            floors: &geometry.floors,
            lanes,
            body,
            regions: Vec::new(),
            region_ends: Vec::new(),
            route_ends: cumulate(lanes.shares.iter().copied()),
            taken: Taken::new(scenario.population.agents, 2.0 * body + GAP),
        };
        for (i, spawn) in geometry.spawns.iter().enumerate() {
            let ways = made.ways(&format!("spawns[{i}].routes"), &spawn.routes, &spawn.journeys, true)?;
            made.regions.push((spawn.polygon.iter().copied().map(Vec2::from).collect::<Vec<_>>(), ways));
        }
        #[allow(clippy::cast_possible_truncation, reason = "an area in m² as a share")]
        let share = |(spawn, (corners, _)): (&Spawn, &(Vec<Vec2>, Walked))| {
            spawn.weight.unwrap_or(polygon::signed_area(corners).abs() as f32)
        };
        made.region_ends = cumulate(geometry.spawns.iter().zip(&made.regions).map(share));
        Ok(made)
    }

    /// What may be walked, by the names that a region gives; without any: every route or every journey, whichever
    /// there are, routes first if `routes_first`.
    fn ways(
        &self,
        key: &str,
        routes: &[String],
        journeys: &[String],
        routes_first: bool,
    ) -> Result<Walked, Error> {
        let numbers = super::journeys::journey_names(&self.scenario.journeys);
        let named: Vec<usize> =
            journeys.iter().filter_map(|name| numbers.get(name.as_str()).copied()).collect();
        if !named.is_empty() {
            return Ok(Walked::Journeys(named));
        }
        let names = super::schema::route_names(&self.geometry.routes);
        let mut found = Vec::new();
        for (k, name) in routes.iter().enumerate() {
            let Some(&route) = names.get(name.as_str()) else {
                let known: Vec<&str> = names.keys().copied().take(12).collect();
                let hint = format!("the routes are {}", known.join(", "));
                return Err(Error::value(
                    format!("{key}[{k}]"),
                    format!("{name:?}"),
                    "the name of a route",
                    hint,
                ));
            };
            found.push(route);
        }
        let any_journey = if routes_first { names.is_empty() } else { !numbers.is_empty() };
        if found.is_empty() && any_journey {
            return Ok(Walked::Journeys((0..self.scenario.journeys.len()).collect()));
        }
        if found.is_empty() {
            found = (0..self.geometry.routes.len()).collect();
        }
        Ok(Walked::Routes(found))
    }

    /// The first place among the draws of the first member that is free for all members of a group.
    fn place(&mut self, members: &Range<u32>) -> Result<Vec<Place>, Error> {
        let agent = members.start;
        let mut unseen = 0;
        for attempt in 0..ATTEMPTS {
            let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Start, attempt * 8 + k);
            let found = if self.regions.is_empty() {
                Some(self.on_a_lane(&draw))
            } else {
                let position = self.in_a_region(&draw);
                let seen = position
                    .map(|(region, position)| self.set_out(agent, &self.regions[region].1, position, &draw));
                unseen += u32::from(matches!(seen, Some(None)));
                seen.flatten()
            };
            if let Some(place) = found
                && self.apart_from_user(place.position)
                && self.apart_from_outsiders(place.position)
                && self.taken.insert(place.position)
            {
                let mut all = vec![place];
                self.beside(place, members.len(), &mut all);
                if all.len() == members.len() {
                    return Ok(all);
                }
                all.iter().for_each(|_| self.taken.remove_last());
            }
        }
        Err(self.full(agent, unseen))
    }

    /// Takes places beside and behind the first member for the others of its group, as far as there are any.
    fn beside(&mut self, first: Place, members: usize, all: &mut Vec<Place>) {
        for position in companions::places(first.position, first.direction, 1.01 * self.taken.apart) {
            if all.len() == members {
                return;
            }
            if self.free.passes(first.position, position, self.body + 0.05)
                && self.apart_from_user(position)
                && self.apart_from_outsiders(position)
                && self.taken.insert(position)
            {
                let elevation = self.floors.walk(first.position, position, first.elevation);
                all.push(Place { position, elevation, ..first });
            }
        }
    }

    /// Somewhere along a route: lanes are equally dense, so that the scene is busy from the first frame.
    fn on_a_lane(&self, draw: &impl Fn(u32) -> f32) -> Place {
        let route = weighted(&self.route_ends, draw(0));
        let lane = self.lane_of(route, draw(1));
        let (on, direction, waypoint) = self.lanes.at(lane, draw(2) * lane.length);
        let jitter = (self.lanes.clearance - self.body - 0.05).clamp(0.0, 0.4);
        let position = on + direction.perp() * jitter * (2.0 * draw(3) - 1.0);
        let elevation = self.elevation(lane, waypoint, on);
        Place {
            position,
            elevation: self.floors.walk(on, position, elevation),
            direction,
            route_start: lane.start,
            route_length: lane.count,
            waypoint,
            loops: lane.loops,
        }
    }

    /// How high somebody stands who has walked a lane from its first waypoint, which is on the ground, to a point before
    /// waypoint `next`.
    fn elevation(&self, lane: super::lanes::Lane, next: u32, on: Vec2) -> f32 {
        let points = self.lanes.points(lane);
        let before = (next as usize + points.len() - 1) % points.len();
        let way = points[..=before].iter().map(|point| point.position).chain([on]);
        let walk = |(at, height): (Vec2, f32), to: Vec2| (to, self.floors.walk(at, to, height));
        way.fold((points[0].position, 0.0), walk).1
    }

    fn lane_of(&self, route: usize, u: f32) -> super::lanes::Lane {
        let lanes = &self.lanes.lanes[self.lanes.by_route[route].clone()];
        #[allow(
            clippy::cast_precision_loss,
            clippy::cast_possible_truncation,
            clippy::cast_sign_loss,
            reason = "at most 128 lanes"
        )]
        let lane = ((lanes.len() as f32 * u) as usize).min(lanes.len() - 1);
        lanes[lane]
    }

    /// A point in a spawn region where the agent fits.
    fn in_a_region(&self, draw: &impl Fn(u32) -> f32) -> Option<(usize, Vec2)> {
        let region = weighted(&self.region_ends, draw(0));
        let corners = &self.regions.get(region)?.0;
        let low = corners.iter().copied().reduce(Vec2::min)?;
        let high = corners.iter().copied().reduce(Vec2::max)?;
        let position = low + (high - low) * Vec2::new(draw(1), draw(2));
        let body = self.body + 0.05;
        (polygon::contains(corners, position) && self.free.admits(position, body))
            .then_some((region, position))
    }

    /// Where those of a source set out for once they are in, near `inside`.
    fn entrance(&self, agent: u32, inside: Vec2, ways: &Walked) -> Option<Place> {
        let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Start, k);
        self.set_out(agent, ways, inside, &draw)
    }

    /// On a route or a journey of those that may be walked.
    fn set_out(
        &self,
        agent: u32,
        ways: &Walked,
        position: Vec2,
        draw: &impl Fn(u32) -> f32,
    ) -> Option<Place> {
        match ways {
            Walked::Routes(routes) => self.to_a_lane(routes, position, draw),
            Walked::Journeys(journeys) => self.on_a_journey(agent, journeys, position),
        }
    }

    /// At the first stage of a journey; which journey and which way through it depends on the agent alone.
    fn on_a_journey(&self, agent: u32, journeys: &[usize], position: Vec2) -> Option<Place> {
        let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Journey, k);
        let ends = cumulate(journeys.iter().map(|&journey| self.lanes.journeys[journey].weight));
        let ways = self.lanes.journeys.get(*journeys.get(weighted(&ends, draw(0)))?)?;
        let lane = ways.lanes.get(weighted(&ways.ends, draw(1)))?;
        let first = self.lanes.points(*lane).first()?.position;
        Some(Place {
            position,
            elevation: self.floors.height(position, 0.0),
            direction: (first - position).normalize_or(Vec2::Y),
            route_start: lane.start,
            route_length: lane.count,
            waypoint: 0,
            loops: lane.loops,
        })
    }

    /// The nearest waypoint in sight of a lane of the routes.
    fn to_a_lane(&self, routes: &[usize], position: Vec2, draw: &impl Fn(u32) -> f32) -> Option<Place> {
        /// Nearest waypoints tried.
        const SIGHTED: usize = 8;
        let ends = cumulate(routes.iter().map(|&route| self.lanes.shares[route]));
        let lane = self.lane_of(*routes.get(weighted(&ends, draw(3)))?, draw(4));
        let points = self.lanes.points(lane);
        let mut order: Vec<(f32, usize)> =
            points.iter().enumerate().map(|(i, w)| (w.position.distance_squared(position), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let body = self.body + 0.05;
        let (_, nearest) = order
            .into_iter()
            .take(SIGHTED)
            .find(|&(_, i)| self.free.passes(position, points[i].position, body))?;
        let direction = (points[nearest].position - position).normalize_or(Vec2::Y);
        Some(Place {
            position,
            elevation: self.floors.height(position, 0.0),
            direction,
            route_start: lane.start,
            route_length: lane.count,
            waypoint: u32::try_from(nearest).unwrap_or(0),
            loops: lane.loops,
        })
    }

    fn apart_from_user(&self, position: Vec2) -> bool {
        let user = &self.scenario.user;
        !user.avoided || position.distance(self.geometry.user) >= user.radius + self.body + USER_GAP
    }

    fn apart_from_outsiders(&self, position: Vec2) -> bool {
        self.scenario.outsiders.iter().all(|outsider| {
            let room = outsider.radius(self.scenario) + outsider.comfort + self.body + GAP;
            outsider.start().is_none_or(|start| position.distance(start) >= room)
        })
    }

    fn full(&self, agent: u32, unseen: u32) -> Error {
        let wanted = self.scenario.population.agents;
        let (message, hint) = if unseen > ATTEMPTS / 2 {
            (
                format!("agent {agent} of {wanted} sees no waypoint of its routes from where it starts"),
                "let a route begin in each spawn region and source, or clear the way between them",
            )
        } else {
            (
                format!("no free place for agent {agent} of {wanted} after {ATTEMPTS} draws"),
                "lower population.agents, enlarge bounds or spawn regions, or widen the routes",
            )
        };
        Error::Populate { name: self.scenario.name.clone(), message, hint: hint.to_owned() }
    }
}

/// Places already taken, in hashed cells as wide as two agents are apart.
struct Taken {
    apart: f32,
    /// First agent of each bucket plus 1; 0 is none.
    heads: Vec<u32>,
    /// The next agent of the same bucket plus 1, beside each position.
    places: Vec<(Vec2, u32)>,
}

impl Taken {
    fn new(agents: u32, apart: f32) -> Self {
        let buckets = (agents as usize * 2).next_power_of_two();
        Self { apart, heads: vec![0; buckets], places: Vec::with_capacity(agents as usize) }
    }

    fn bucket(&self, cell: IVec2) -> usize {
        let key = cell.x.cast_unsigned().wrapping_mul(0x9e37_79b1)
            ^ cell.y.cast_unsigned().wrapping_mul(0x85eb_ca77);
        (key ^ (key >> 15)) as usize & (self.heads.len() - 1)
    }

    /// Takes the place unless somebody is nearer than two agents must be apart.
    fn insert(&mut self, position: Vec2) -> bool {
        let cell = (position / self.apart).floor().as_ivec2();
        for dz in -1..=1 {
            for dx in -1..=1 {
                let mut next = self.heads[self.bucket(cell + IVec2::new(dx, dz))];
                while next > 0 {
                    let (other, link) = self.places[next as usize - 1];
                    if other.distance_squared(position) < self.apart * self.apart {
                        return false;
                    }
                    next = link;
                }
            }
        }
        let bucket = self.bucket(cell);
        self.places.push((position, self.heads[bucket]));
        self.heads[bucket] = u32::try_from(self.places.len()).unwrap_or(0);
        true
    }

    /// Frees the place that was taken last.
    fn remove_last(&mut self) {
        if let Some((position, next)) = self.places.pop() {
            let bucket = self.bucket((position / self.apart).floor().as_ivec2());
            self.heads[bucket] = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_are_drawn_in_proportion_and_empty_ones_never() {
        let ends = cumulate([1.0, 0.0, 3.0, 0.0]);
        assert_eq!(weighted(&ends, 0.0), 0);
        assert_eq!(weighted(&ends, 0.2499), 0);
        assert_eq!(weighted(&ends, 0.25), 2);
        assert_eq!(weighted(&ends, 0.999_999), 2);
        assert_eq!(weighted(&[], 0.5), 0);
    }

    #[test]
    fn a_taken_place_is_taken_across_cell_borders() {
        let mut taken = Taken::new(4, 0.6);
        assert!(taken.insert(Vec2::new(0.59, -0.01)));
        assert!(!taken.insert(Vec2::new(0.61, 0.01)));
        assert!(taken.insert(Vec2::new(1.3, 0.01)));
        taken.remove_last();
        assert!(taken.insert(Vec2::new(1.25, 0.01)));
        assert!(!taken.insert(Vec2::new(0.61, 0.01)));
    }
}
