//! Routes become lanes: parallel closed polylines, each checked to be clear of everything solid.
//!
//! One goal shared by many makes a jam (field notes U-08), so every route is walked on many lanes, there and back
//! on different ones, and the ends of the lanes are staggered.

use super::crowd::Stop;
use super::people::largest_radius;
use super::shares::cumulate;
use crate::scenario::error::Error;
use crate::scenario::file::{Journey, Route, RouteMode, Scenario, Stage, StageKind, stage_names};
use crate::scenario::place::{Clearance, Geometry};
use crate::scenario::random::{Purpose, index, unit};
use glam::Vec2;
use std::collections::BTreeMap;
use std::ops::Range;

/// Least distance of every lane to obstacles and bounds, m.
pub const ROUTE_CLEARANCE: f32 = 0.6;
/// Distance between lanes, m; more when the route is wider than the most lanes.
const SPACING: f32 = 0.75;
/// Most lanes of a route.
const MAX_LANES: u32 = 128;
/// Most lanes between the way there and the way back.
const RETURN_SPREAD: usize = 12;
/// Greatest shortening of a lane's end, m.
const STAGGER: f32 = 12.0;

/// One way to walk a route.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane {
    /// First stage.
    pub(super) start: u32,
    /// Number of stages.
    pub(super) count: u32,
    /// On from the last waypoint to the first.
    pub(super) loops: bool,
    /// Length of one round, m.
    pub(super) length: f32,
}

/// All ways through one journey.
#[derive(Debug)]
pub(super) struct Ways {
    pub(super) lanes: Vec<Lane>,
    /// Cumulated shares.
    pub(super) ends: Vec<f32>,
    /// Share of the journey among others.
    pub(super) weight: f32,
}

/// All lanes of a scenario.
#[derive(Debug, Default)]
pub(super) struct Lanes {
    pub(super) stages: Vec<Stop>,
    pub(super) lanes: Vec<Lane>,
    /// Lanes of each route.
    pub(super) by_route: Vec<Range<usize>>,
    /// Share of the agents of each route, not normalised: weight times the length of its lanes.
    pub(super) shares: Vec<f32>,
    /// The ways through each journey.
    pub(super) journeys: Vec<Ways>,
    /// Distance every lane keeps from anything solid, m.
    pub(super) clearance: f32,
}

impl Lanes {
    /// Lanes of every route.
    ///
    /// # Errors
    /// [`Error::Populate`] for a route without a single clear lane: which, where and how near to what.
    pub(super) fn new(scenario: &Scenario, geometry: &Geometry, free: &Clearance) -> Result<Self, Error> {
        let body = largest_radius(scenario);
        let mut lanes = Self { clearance: ROUTE_CLEARANCE.max(body + 0.1) + 0.05, ..Self::default() };
        for (id, route) in (0_u32..).zip(&geometry.routes) {
            let first = lanes.lanes.len();
            lanes.add(route, id, free);
            if lanes.lanes.len() == first {
                return Err(blocked(scenario, route, lanes.clearance, free));
            }
            lanes.by_route.push(first..lanes.lanes.len());
            let length: f32 = lanes.lanes[first..].iter().map(|lane| lane.length).sum();
            lanes.shares.push(route.weight * length);
        }
        for (index, stage) in scenario.stages.iter().enumerate() {
            standable(index, stage, free)?;
        }
        let names = stage_names(&scenario.stages);
        for journey in &scenario.journeys {
            lanes.add_journey(journey, scenario, &names);
        }
        Ok(lanes)
    }

    /// Adds every way through a journey.
    fn add_journey(&mut self, journey: &Journey, scenario: &Scenario, names: &BTreeMap<&str, usize>) {
        let mut ways = Ways { lanes: Vec::new(), ends: Vec::new(), weight: journey.weight };
        let mut shares = Vec::new();
        for (way, share) in journey.ways(names) {
            let start = u32::try_from(self.stages.len()).unwrap_or(u32::MAX);
            for &stage in &way {
                let number = |count: usize| u32::try_from(count).unwrap_or(0);
                let before = scenario.stages[..stage].iter().filter(|s| s.kind == StageKind::Queue);
                let (number, queue) = (number(stage), number(before.count()));
                let stage = &scenario.stages[stage];
                self.stages.push(stage.stop(number, queue, scenario.navigation.time_step));
            }
            let count = u32::try_from(way.len()).unwrap_or(u32::MAX);
            ways.lanes.push(Lane { start, count, loops: journey.repeat, length: 0.0 });
            shares.push(share);
        }
        ways.ends = cumulate(shares);
        self.journeys.push(ways);
    }

    /// Adds the clear lanes of one route.
    fn add(&mut self, route: &Route, id: u32, free: &Clearance) {
        let closed = route.mode == RouteMode::Loop;
        let center: Vec<Vec2> = route.waypoints.iter().copied().map(Vec2::from).collect();
        let clear = |line: &[Vec2], closed: bool| {
            segments(line, closed).all(|(a, b)| free.passes(a, b, self.clearance))
        };
        let lines: Vec<Vec<Vec2>> = offsets(route.width)
            .map(|offset| parallel(&center, offset, closed))
            .filter(|line| clear(line, closed))
            .collect();
        let mut rounds: Vec<Vec<Vec2>> = Vec::with_capacity(lines.len());
        for (j, line) in lines.iter().enumerate() {
            let draw = u32::try_from(j).unwrap_or(0) * 8;
            rounds.push(match route.mode {
                RouteMode::Once => line.clone(),
                RouteMode::Loop if j % 2 == 1 => line.iter().rev().copied().collect(),
                RouteMode::Loop => line.clone(),
                RouteMode::Patrol => {
                    let shift = index(0, id, Purpose::Lane, draw, 2 * RETURN_SPREAD + 1);
                    let k = (j + shift).saturating_sub(RETURN_SPREAD).min(lines.len() - 1);
                    let round = there_and_back(line, &lines[k], id, draw);
                    if k != j && clear(&round, true) { round } else { same_way_back(line) }
                }
            });
        }
        for round in rounds {
            self.push(&round, route, free);
        }
    }

    /// Stores a lane, with as large a radius at each waypoint as the walls leave room for.
    fn push(&mut self, points: &[Vec2], route: &Route, free: &Clearance) {
        let loops = route.mode != RouteMode::Once;
        // An agent that turns early, anywhere within the radius, still passes the walls at the width of a body.
        const BODY: f32 = 0.35;
        let room: Vec<f32> =
            segments(points, true).map(|(a, b)| free.distance(a, b, route.radius + BODY) - BODY).collect();
        let Ok(start) = u32::try_from(self.stages.len()) else { return };
        for (i, &position) in points.iter().enumerate() {
            let before = room[(i + points.len() - 1) % points.len()];
            let radius = before.min(room[i]).max(0.8).min(route.radius);
            self.stages.push(Stop::waypoint(position, radius));
        }
        let length = segments(points, loops).map(|(a, b)| a.distance(b)).sum();
        let count = u32::try_from(points.len()).unwrap_or(u32::MAX);
        self.lanes.push(Lane { start, count, loops, length });
    }

    /// The stages of a lane.
    pub(super) fn points(&self, lane: Lane) -> &[Stop] {
        &self.stages[lane.start as usize..(lane.start + lane.count) as usize]
    }

    /// The place at a distance along the lane: position, direction, and the waypoint it leads to.
    pub(super) fn at(&self, lane: Lane, mut along: f32) -> (Vec2, Vec2, u32) {
        let points = self.points(lane);
        let steps = if lane.loops { points.len() } else { points.len() - 1 };
        let mut last = (points[0].position, Vec2::Y, 0);
        for i in 0..steps {
            let (a, b) = (points[i].position, points[(i + 1) % points.len()].position);
            let length = a.distance(b);
            let direction = (b - a).normalize_or(last.1);
            let next = u32::try_from((i + 1) % points.len()).unwrap_or(0);
            if along <= length {
                return (a + direction * along, direction, next);
            }
            along -= length;
            last = (b, direction, next);
        }
        last
    }
}

/// Whether people can come to a stage: its middle, or of an exit some part, is walkable.
fn standable(index: usize, stage: &Stage, free: &Clearance) -> Result<(), Error> {
    let (middle, [along, across]) = (Vec2::from(stage.position), stage.half_axes());
    let reach = if stage.kind == StageKind::Exit { 0.9 } else { 0.0 };
    let somewhere = [-1.0, -0.5, 0.0, 0.5, 1.0].map(|share| share * reach);
    let mut places = somewhere.iter().flat_map(|u| somewhere.map(|v| middle + along * *u + across * v));
    let line = (0..stage.places.unwrap_or(0)).map(|k| middle + stage.to_next_place() * count(k));
    let blocked = line.enumerate().find(|(_, place)| !free.walkable(*place));
    if let Some((place, at)) = blocked {
        let found = format!("place {place} of the queue at {at}, inside an obstacle or outside the bounds");
        let hint = "turn it with heading_deg, or give it fewer places";
        return Err(Error::value(format!("stages[{index}].places"), found, "on walkable ground", hint));
    }
    if places.any(|place| free.walkable(place)) {
        return Ok(());
    }
    let key = format!("stages[{index}].position");
    let found = format!("{middle}, inside an obstacle or outside the bounds");
    Err(Error::value(key, found, "on walkable ground", "move the stage, or the obstacle"))
}

/// A small number as f32.
#[allow(clippy::cast_precision_loss, reason = "places of a queue")]
const fn count(k: u32) -> f32 {
    k as f32
}

/// Segments of a polyline, closed or not.
fn segments(points: &[Vec2], closed: bool) -> impl Iterator<Item = (Vec2, Vec2)> + '_ {
    let count = if closed { points.len() } else { points.len().saturating_sub(1) };
    (0..count).map(move |i| (points[i], points[(i + 1) % points.len()]))
}

/// Lateral offsets of the lanes of a route `width` wide, m.
#[allow(
    clippy::cast_precision_loss,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "at most 128 lanes; the quotient is clamped first"
)]
fn offsets(width: f32) -> impl Iterator<Item = f32> {
    let count = ((width / SPACING).floor().clamp(0.0, 1000.0) as u32 + 1).min(MAX_LANES);
    let step = if count > 1 { width / (count - 1) as f32 } else { 0.0 };
    (0..count).map(move |i| i as f32 * step - if count > 1 { width * 0.5 } else { 0.0 })
}

/// The polyline moved sideways, mitred at its corners.
fn parallel(center: &[Vec2], offset: f32, closed: bool) -> Vec<Vec2> {
    let n = center.len();
    let side = |a: Vec2, b: Vec2| (b - a).normalize_or_zero().perp();
    (0..n)
        .map(|i| {
            let before = (i > 0 || closed).then(|| side(center[(i + n - 1) % n], center[i]));
            let after = (i + 1 < n || closed).then(|| side(center[i], center[(i + 1) % n]));
            let shift = match (before, after) {
                // A mitre is 1 / cos(half the turn) long; sharp turns are cut at three times the offset.
                (Some(a), Some(b)) => (a + b) / (1.0 + a.dot(b)).max(0.2),
                (one, other) => one.or(other).unwrap_or(Vec2::ZERO),
            };
            center[i] + shift * offset
        })
        .collect()
}

/// There on one lane and back on another, each end shortened by its own amount.
fn there_and_back(there: &[Vec2], back: &[Vec2], id: u32, draw: u32) -> Vec<Vec2> {
    let shorten = |end: Vec2, next: Vec2, k: u32| {
        let most = STAGGER.min(0.35 * end.distance(next));
        end + (next - end).normalize_or_zero() * most * unit(0, id, Purpose::Lane, draw + k)
    };
    let n = there.len();
    let mut round: Vec<Vec2> = there.to_vec();
    round[0] = shorten(there[0], there[1], 1);
    round[n - 1] = shorten(there[n - 1], there[n - 2], 2);
    let mut rest: Vec<Vec2> = back.iter().rev().copied().collect();
    rest[0] = shorten(back[n - 1], back[n - 2], 3);
    rest[n - 1] = shorten(back[0], back[1], 4);
    round.extend(rest);
    round
}

/// There and back on the same lane.
fn same_way_back(line: &[Vec2]) -> Vec<Vec2> {
    let inner = line.iter().rev().skip(1).take(line.len().saturating_sub(2));
    line.iter().chain(inner).copied().collect()
}

/// Why a route has no lane: the tightest place of its centre line.
fn blocked(scenario: &Scenario, route: &Route, needed: f32, free: &Clearance) -> Error {
    let center: Vec<Vec2> = route.waypoints.iter().copied().map(Vec2::from).collect();
    let closed = route.mode == RouteMode::Loop;
    let mut message =
        format!("route {:?} has no lane that is clear of obstacles and bounds by {needed:.2} m", route.name);
    let tight = segments(&center, closed).enumerate().find(|(_, (a, b))| !free.passes(*a, *b, needed));
    if let Some((i, (a, b))) = tight {
        let found = if free.walkable(a) {
            format!("comes as near as {:.2} m", free.distance(a, b, needed))
        } else {
            "starts inside an obstacle or outside the bounds".to_owned()
        };
        message = format!("{message}: from waypoint {i} at {a} on to {b} it {found}");
    }
    let hint = "move the waypoints or the obstacle, or make the passage wider".to_owned();
    Error::Populate { name: scenario.name.clone(), message, hint }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lanes_keep_their_distance_round_a_corner() {
        let corner = [Vec2::new(0.0, 0.0), Vec2::new(10.0, 0.0), Vec2::new(10.0, 10.0)];
        let line = parallel(&corner, 2.0, false);
        assert!(line[1].distance(Vec2::new(8.0, 2.0)) < 1e-5, "{line:?}");
        assert!(line[0].distance(Vec2::new(0.0, 2.0)) < 1e-5);
        assert!(line[2].distance(Vec2::new(8.0, 10.0)) < 1e-5);
    }

    #[test]
    fn offsets_fill_the_width_and_no_width_is_one_lane() {
        assert_eq!(offsets(0.0).collect::<Vec<_>>(), [0.0]);
        let wide: Vec<f32> = offsets(3.0).collect();
        assert_eq!((wide.len(), wide[0], wide[4]), (5, -1.5, 1.5));
        assert_eq!(offsets(1e4).count(), 128);
    }
}
