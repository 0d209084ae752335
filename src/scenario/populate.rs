//! Fills a scenario with agents: where each starts, how it feels, how it walks, how it looks.
//!
//! All draws are counter-based ([`super::random`]): what agent i is like depends on the seed and i alone; where it
//! starts depends, besides, on the agents before it, because no two may overlap.

use super::clearance::Clearance;
use super::crowd::{AgentStart, Crowd};
use super::error::Error;
use super::lanes::Lanes;
use super::layout::Geometry;
use super::polygon;
use super::random::{Purpose, bits, index, range, unit};
use super::schema::{Condition, EmotionMode, GaitChoice, Scenario, Spawn};
use crate::emotion::Emotion;
use crate::ground::heading_from_ground;
use glam::{IVec2, Vec2};

/// Draws before a place is given up as full.
const ATTEMPTS: u32 = 2000;
/// Gap between two agents at the start, m.
const GAP: f32 = 0.1;
/// Gap to the user at the start, m.
const USER_GAP: f32 = 0.8;
/// Speed at the start, m/s: an ordinary walk; the simulation goes on from there.
const START_SPEED: f32 = 1.2;

/// Fills a scenario with its agents.
///
/// `gaits_for` is GEA(e): the gaits of a library that look like an emotion, as indices into it.
///
/// # Errors
/// [`Error::Value`] for an invalid scenario; [`Error::Populate`] when an emotion in use has no gait, a route is
/// blocked, or there is no room: what, where, and the way out.
pub fn populate<'a>(scenario: &Scenario, gaits_for: impl Fn(Emotion) -> &'a [u32]) -> Result<Crowd, Error> {
    scenario.validate()?;
    let geometry = scenario.geometry();
    let cast = Cast::new(scenario, gaits_for)?;
    if scenario.population.agents == 0 {
        return Ok(Crowd::default());
    }
    let free = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let lanes = Lanes::new(scenario, &geometry, &free)?;
    let mut places = Places::new(scenario, &geometry, &free, &lanes)?;
    let agents = (0..scenario.population.agents)
        .map(|agent| Ok(cast.agent(agent, places.place(agent)?)))
        .collect::<Result<Vec<AgentStart>, Error>>()?;
    Ok(Crowd { agents, waypoints: lanes.waypoints })
}

/// Index of the share that `u` in [0, 1) falls into; shares need not be normalised.
fn weighted(cumulative: &[f32], u: f32) -> usize {
    let total = cumulative.last().copied().unwrap_or(0.0);
    cumulative.partition_point(|&end| end <= u * total).min(cumulative.len().saturating_sub(1))
}

fn cumulate(shares: impl IntoIterator<Item = f32>) -> Vec<f32> {
    let add = |sum: &mut f32, share: f32| {
        *sum += share;
        Some(*sum)
    };
    shares.into_iter().scan(0.0, add).collect()
}

/// Emotions, gaits, bodies.
struct Cast<'a> {
    scenario: &'a Scenario,
    gaits: [&'a [u32]; 4],
    shares: [f32; 4],
    cumulative: Vec<f32>,
}

impl<'a> Cast<'a> {
    fn new<'g: 'a>(scenario: &'a Scenario, gaits_for: impl Fn(Emotion) -> &'g [u32]) -> Result<Self, Error> {
        let baseline = scenario.condition == Condition::Baseline;
        let shares =
            if baseline { Emotion::Neutral.weights() } else { scenario.population.emotions.normalised() };
        let gaits = Emotion::ALL.map(gaits_for);
        if let Some(missing) =
            Emotion::ALL.into_iter().find(|e| shares[e.index()] > 0.0 && gaits[e.index()].is_empty())
        {
            let why = if baseline { "the baseline needs one" } else { "its share is above 0" };
            return Err(Error::Populate {
                name: scenario.name.clone(),
                message: format!("the gait library has no {missing} gait, and {why}"),
                hint: format!("use a library with {missing} gaits, or set population.emotions.{missing} = 0"),
            });
        }
        Ok(Self { scenario, gaits, shares, cumulative: cumulate(shares) })
    }

    /// One gait out of GEA(e).
    fn gait(&self, agent: u32, emotion: usize) -> u32 {
        let gaits = self.gaits[emotion];
        let draw = u32::try_from(emotion).unwrap_or(0);
        // The baseline is one gait for all (S-26), so all draw as agent 0 does.
        let who = if self.scenario.condition == Condition::Baseline { 0 } else { agent };
        let chosen = match self.scenario.population.gaits {
            GaitChoice::Random => index(self.scenario.seed, who, Purpose::Gait, draw, gaits.len()),
            GaitChoice::Cycle => usize::try_from(who).unwrap_or(0) % gaits.len().max(1),
            GaitChoice::First => 0,
        };
        gaits.get(chosen).copied().unwrap_or(0)
    }

    /// Emotion weights, gaits and their weights.
    fn feeling(&self, agent: u32) -> ([f32; 4], [u32; 4], [f32; 4]) {
        let blend = self.scenario.population.emotion_mode == EmotionMode::Blend
            && self.scenario.condition != Condition::Baseline;
        if blend {
            let spare = self.shares.iter().position(|&share| share > 0.0).unwrap_or(3);
            let of = |e: usize| self.gait(agent, if self.shares[e] > 0.0 { e } else { spare });
            return (self.shares, [of(0), of(1), of(2), of(3)], self.shares);
        }
        let drawn = weighted(&self.cumulative, unit(self.scenario.seed, agent, Purpose::Emotion, 0));
        let gait = self.gait(agent, drawn);
        (Emotion::ALL[drawn.min(3)].weights(), [gait; 4], [1.0, 0.0, 0.0, 0.0])
    }

    fn scale(&self, agent: u32) -> f32 {
        let [low, high] = self.scenario.population.scale;
        range(self.scenario.seed, agent, Purpose::Scale, 0, low, high)
    }

    fn agent(&self, agent: u32, place: Place) -> AgentStart {
        let (seed, scale) = (self.scenario.seed, self.scale(agent));
        let (emotion, gaits, gait_weights) = self.feeling(agent);
        // Every run of as many agents as there are avatars has each of them once: as many women as men.
        let avatars = u32::try_from(self.scenario.population.avatars.len()).unwrap_or(1).max(1);
        let shift = bits(seed, agent / avatars, Purpose::Avatar, 0) % avatars;
        AgentStart {
            position: place.position,
            velocity: place.direction * START_SPEED.min(self.scenario.navigation.max_speed),
            heading: heading_from_ground(place.direction),
            radius: self.scenario.navigation.radius * scale,
            emotion,
            gaits,
            gait_weights,
            gazes: self.scenario.condition == Condition::EvaG,
            avatar: (agent % avatars + shift) % avatars,
            scale,
            colors: colors(seed, agent),
            phase: bits(seed, agent, Purpose::Phase, 0),
            route_start: place.route_start,
            route_length: place.route_length,
            waypoint: place.waypoint,
            loops: place.loops,
        }
    }
}

/// Skin, hair, top and bottom, drawn apart from the emotion, which must show in gait and gaze alone.
fn colors(seed: u64, agent: u32) -> [u32; 4] {
    const SKIN: [u32; 7] = [0xf3d3bc, 0xe6b899, 0xd29f7b, 0xb47d57, 0x8d5a3b, 0x6b4128, 0x4a2c1b];
    const HAIR: [u32; 7] = [0x1c1714, 0x33241b, 0x5a3b24, 0x8a5f35, 0xc49a58, 0x8f8b86, 0x7a2f1d];
    const TOP: [u32; 14] = [
        0x2f4b6e, 0x9a3b3b, 0x4d6b46, 0xd9d4c7, 0x33363c, 0xc78b3c, 0x6a4c7d, 0x3f8a8c, 0xb9b2a7, 0x7d5a43,
        0xcf6a57, 0x8aa5bf, 0xe3c565, 0x56606b,
    ];
    const BOTTOM: [u32; 8] = [0x2a3b55, 0x1f2226, 0x5b5348, 0x7c7465, 0x3c4a3c, 0x474c57, 0x8d8675, 0x5a3a33];
    let pick = |draw: u32, list: &[u32]| list[index(seed, agent, Purpose::Colors, draw, list.len())];
    [pick(0, &SKIN), pick(1, &HAIR), pick(2, &TOP), pick(3, &BOTTOM)]
}

/// Where an agent starts and what it walks to.
#[derive(Debug, Clone, Copy)]
struct Place {
    position: Vec2,
    direction: Vec2,
    route_start: u32,
    route_length: u32,
    waypoint: u32,
    loops: bool,
}

/// Finds a place for one agent after the other.
struct Places<'a> {
    scenario: &'a Scenario,
    free: &'a Clearance,
    lanes: &'a Lanes,
    spawns: &'a [Spawn],
    /// Corners, cumulated share and allowed routes of each spawn region.
    regions: Vec<(Vec<Vec2>, Vec<usize>)>,
    region_ends: Vec<f32>,
    route_ends: Vec<f32>,
    user: Vec2,
    taken: Taken,
}

impl<'a> Places<'a> {
    fn new(
        scenario: &'a Scenario,
        geometry: &'a Geometry,
        free: &'a Clearance,
        lanes: &'a Lanes,
    ) -> Result<Self, Error> {
        let names = super::schema::route_names(&geometry.routes);
        let mut regions = Vec::new();
        for (i, spawn) in geometry.spawns.iter().enumerate() {
            let mut routes = Vec::new();
            for (k, name) in spawn.routes.iter().enumerate() {
                let Some(&route) = names.get(name.as_str()) else {
                    let key = format!("spawns[{i}].routes[{k}]");
                    let known: Vec<&str> = names.keys().copied().take(12).collect();
                    let hint = format!("the routes are {}", known.join(", "));
                    return Err(Error::value(key, format!("{name:?}"), "the name of a route", hint));
                };
                routes.push(route);
            }
            if routes.is_empty() {
                routes = (0..geometry.routes.len()).collect();
            }
            regions.push((spawn.polygon.iter().copied().map(Vec2::from).collect::<Vec<_>>(), routes));
        }
        #[allow(clippy::cast_possible_truncation, reason = "an area in m² as a share")]
        let share = |(spawn, (corners, _)): (&Spawn, &(Vec<Vec2>, Vec<usize>))| {
            spawn.weight.unwrap_or(polygon::signed_area(corners).abs() as f32)
        };
        let region_ends = cumulate(geometry.spawns.iter().zip(&regions).map(share));
        let widest = 2.0 * scenario.navigation.radius * scenario.population.scale[1] + GAP;
        let taken = Taken::new(scenario.population.agents, widest);
        let route_ends = cumulate(lanes.shares.iter().copied());
        Ok(Self {
            scenario,
            free,
            lanes,
            spawns: &geometry.spawns,
            regions,
            region_ends,
            route_ends,
            user: geometry.user,
            taken,
        })
    }

    /// The first free place among the agent's draws.
    fn place(&mut self, agent: u32) -> Result<Place, Error> {
        let mut unseen = 0;
        for attempt in 0..ATTEMPTS {
            let draw = |k: u32| unit(self.scenario.seed, agent, Purpose::Start, attempt * 8 + k);
            let found = if self.regions.is_empty() {
                Some(self.on_a_lane(&draw))
            } else {
                let position = self.in_a_region(&draw);
                let seen = position.map(|(region, position)| self.to_a_lane(region, position, &draw));
                unseen += u32::from(matches!(seen, Some(None)));
                seen.flatten()
            };
            if let Some(place) = found
                && self.apart_from_user(place.position)
                && self.taken.insert(place.position)
            {
                return Ok(place);
            }
        }
        Err(self.full(agent, unseen))
    }

    /// Somewhere along a route: lanes are equally dense, so that the scene is busy from the first frame.
    fn on_a_lane(&self, draw: &impl Fn(u32) -> f32) -> Place {
        let route = weighted(&self.route_ends, draw(0));
        let lane = self.lane_of(route, draw(1));
        let (on, direction, waypoint) = self.lanes.at(lane, draw(2) * lane.length);
        let body = self.scenario.navigation.radius * self.scenario.population.scale[1];
        let jitter = (self.lanes.clearance - body - 0.05).clamp(0.0, 0.4);
        let position = on + direction.perp() * jitter * (2.0 * draw(3) - 1.0);
        Place {
            position,
            direction,
            route_start: lane.start,
            route_length: lane.count,
            waypoint,
            loops: lane.loops,
        }
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
        let body = self.scenario.navigation.radius * self.scenario.population.scale[1] + 0.05;
        (polygon::contains(corners, position) && self.free.admits(position, body))
            .then_some((region, position))
    }

    /// The nearest waypoint in sight of a lane of the region's routes.
    fn to_a_lane(&self, region: usize, position: Vec2, draw: &impl Fn(u32) -> f32) -> Option<Place> {
        /// Nearest waypoints tried.
        const SIGHTED: usize = 8;
        let routes = &self.regions[region].1;
        let ends = cumulate(routes.iter().map(|&route| self.lanes.shares[route]));
        let lane = self.lane_of(*routes.get(weighted(&ends, draw(3)))?, draw(4));
        let points = self.lanes.points(lane);
        let mut order: Vec<(f32, usize)> =
            points.iter().enumerate().map(|(i, w)| (w.position.distance_squared(position), i)).collect();
        order.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let body = self.scenario.navigation.radius * self.scenario.population.scale[1] + 0.05;
        let (_, nearest) = order
            .into_iter()
            .take(SIGHTED)
            .find(|&(_, i)| self.free.passes(position, points[i].position, body))?;
        let direction = (points[nearest].position - position).normalize_or(Vec2::Y);
        Some(Place {
            position,
            direction,
            route_start: lane.start,
            route_length: lane.count,
            waypoint: u32::try_from(nearest).unwrap_or(0),
            loops: lane.loops,
        })
    }

    fn apart_from_user(&self, position: Vec2) -> bool {
        let user = &self.scenario.user;
        let body = self.scenario.navigation.radius * self.scenario.population.scale[1];
        !user.avoided || position.distance(self.user) >= user.radius + body + USER_GAP
    }

    fn full(&self, agent: u32, unseen: u32) -> Error {
        let wanted = self.scenario.population.agents;
        let (message, hint) = if unseen > ATTEMPTS / 2 {
            let count = self.spawns.len();
            (
                format!(
                    "agent {agent} of {wanted} sees no waypoint of its routes from any of the {count} spawn regions"
                ),
                "let a route begin in each spawn region, or clear the way between them",
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
    }
}
