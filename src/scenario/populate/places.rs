//! A free place for one agent after the other.

use super::groups;
use super::lanes::{Lane, Lanes};
use super::people::largest_radius;
use super::shares::{cumulate, weighted};
use crate::scenario::error::Error;
use crate::scenario::file::{Scenario, Spawn, journey_names, route_names};
use crate::scenario::place::{Clearance, Floors, Geometry};
use crate::scenario::polygon;
use crate::scenario::random::{Purpose, unit};
use glam::{IVec2, Vec2};
use std::ops::Range;

/// Draws before a place is given up as full.
const ATTEMPTS: u32 = 2000;
/// Gap between two agents at the start, m.
const GAP: f32 = 0.1;
/// Gap to the user at the start, m.
const USER_GAP: f32 = 0.8;

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
    /// Of an agent that never enters.
    pub(super) const NOWHERE: Self = Self {
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
pub(super) enum Walked {
    /// One of these routes.
    Routes(Vec<usize>),
    /// One of these journeys.
    Journeys(Vec<usize>),
}

/// Finds a place for one agent after the other.
pub(super) struct Places<'a> {
    scenario: &'a Scenario,
    free: &'a Clearance,
    floors: &'a Floors,
    lanes: &'a Lanes,
    geometry: &'a Geometry,
    /// Corners of each spawn region, what is walked from it, and the height of its floor, m.
    regions: Vec<(Vec<Vec2>, Walked, f32)>,
    region_ends: Vec<f32>,
    route_ends: Vec<f32>,
    /// The largest radius, m.
    pub(super) body: f32,
    pub(super) taken: Taken,
}

impl<'a> Places<'a> {
    pub(super) fn new(
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
            let corners: Vec<Vec2> = spawn.polygon.iter().copied().map(Vec2::from).collect();
            made.regions.push((corners, ways, spawn.elevation.unwrap_or(0.0)));
        }
        #[allow(clippy::cast_possible_truncation, reason = "an area in m² as a share")]
        let share = |(spawn, (corners, ..)): (&Spawn, &(Vec<Vec2>, Walked, f32))| {
            spawn.weight.unwrap_or(polygon::signed_area(corners).abs() as f32)
        };
        made.region_ends = cumulate(geometry.spawns.iter().zip(&made.regions).map(share));
        Ok(made)
    }

    /// What may be walked, by the names that a region gives; without any: every route or every journey, whichever
    /// there are, routes first if `routes_first`.
    pub(super) fn ways(
        &self,
        key: &str,
        routes: &[String],
        journeys: &[String],
        routes_first: bool,
    ) -> Result<Walked, Error> {
        let numbers = journey_names(&self.scenario.journeys);
        let named: Vec<usize> =
            journeys.iter().filter_map(|name| numbers.get(name.as_str()).copied()).collect();
        if !named.is_empty() {
            return Ok(Walked::Journeys(named));
        }
        let names = route_names(&self.geometry.routes);
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
    pub(super) fn place(&mut self, members: &Range<u32>) -> Result<Vec<Place>, Error> {
        let agent = members.start;
        let mut unseen = 0;
        for attempt in 0..ATTEMPTS {
            let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Start, attempt * 8 + k);
            let found = if self.regions.is_empty() {
                Some(self.on_a_lane(&draw))
            } else {
                let position = self.in_a_region(&draw);
                let seen = position.map(|(region, position)| {
                    let (_, ways, elevation) = &self.regions[region];
                    self.set_out(agent, ways, position, *elevation, &draw)
                });
                unseen += u32::from(matches!(seen, Some(None)));
                seen.flatten()
            };
            if let Some(place) = found
                && self.apart_from_user(place.position)
                && self.apart_from_external(place.position)
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
        for position in groups::places(first.position, first.direction, 1.01 * self.taken.apart) {
            if all.len() == members {
                return;
            }
            if self.free.passes(first.position, position, self.body + 0.05)
                && self.apart_from_user(position)
                && self.apart_from_external(position)
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

    /// Height of an agent that has walked a lane from its first waypoint, which is on the ground, to a point before
    /// waypoint `next`.
    fn elevation(&self, lane: Lane, next: u32, on: Vec2) -> f32 {
        let points = self.lanes.points(lane);
        let before = (next as usize + points.len() - 1) % points.len();
        let way = points[..=before].iter().map(|point| point.position).chain([on]);
        let walk = |(at, height): (Vec2, f32), to: Vec2| (to, self.floors.walk(at, to, height));
        way.fold((points[0].position, 0.0), walk).1
    }

    fn lane_of(&self, route: usize, u: f32) -> Lane {
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
        let (corners, _, elevation) = self.regions.get(region)?;
        let low = corners.iter().copied().reduce(Vec2::min)?;
        let high = corners.iter().copied().reduce(Vec2::max)?;
        let position = low + (high - low) * Vec2::new(draw(1), draw(2));
        let body = self.body + 0.05;
        let is_free = polygon::contains(corners, position) && self.free.admits(position, body);
        (is_free && self.floors.footing(position, *elevation).is_some()).then_some((region, position))
    }

    /// Where those of a source set out for once they are in, near `inside` on the floor at `elevation`, m.
    pub(super) fn entrance(&self, agent: u32, inside: Vec2, elevation: f32, ways: &Walked) -> Option<Place> {
        let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Start, k);
        self.set_out(agent, ways, inside, elevation, &draw)
    }

    /// On a route or a journey of those that may be walked, from a place and the height of its floor, m.
    fn set_out(
        &self,
        agent: u32,
        ways: &Walked,
        position: Vec2,
        elevation: f32,
        draw: &impl Fn(u32) -> f32,
    ) -> Option<Place> {
        let place = match ways {
            Walked::Routes(routes) => self.to_a_lane(routes, position, draw),
            Walked::Journeys(journeys) => self.on_a_journey(agent, journeys, position),
        };
        place.map(|place| Place { elevation: self.floors.height(position, elevation), ..place })
    }

    /// At the first stage of a journey; which journey and which way through it depends on the number for which a place is drawn.
    fn on_a_journey(&self, agent: u32, journeys: &[usize], position: Vec2) -> Option<Place> {
        let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Journey, k);
        let ends = cumulate(journeys.iter().map(|&journey| self.lanes.journeys[journey].weight));
        let ways = self.lanes.journeys.get(*journeys.get(weighted(&ends, draw(0)))?)?;
        let lane = ways.lanes.get(weighted(&ways.ends, draw(1)))?;
        let first = self.lanes.points(*lane).first()?.position;
        Some(Place {
            position,
            elevation: 0.0,
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
            elevation: 0.0,
            direction,
            route_start: lane.start,
            route_length: lane.count,
            waypoint: u32::try_from(nearest).unwrap_or(0),
            loops: lane.loops,
        })
    }

    fn apart_from_user(&self, position: Vec2) -> bool {
        let Some((user, at)) = self.scenario.user.zip(self.geometry.user) else { return true };
        !user.avoided || position.distance(at) >= user.radius + self.body + USER_GAP
    }

    fn apart_from_external(&self, position: Vec2) -> bool {
        self.scenario.outsiders.iter().all(|outsider| {
            let room = outsider.radius(self.scenario) + outsider.comfort + self.body + GAP;
            outsider.start().is_none_or(|start| position.distance(start) >= room)
        })
    }

    pub(super) fn full(&self, agent: u32, unseen: u32) -> Error {
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
pub(super) struct Taken {
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

    /// Takes the place unless another agent is nearer than two must be apart.
    pub(super) fn insert(&mut self, position: Vec2) -> bool {
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
