//! Agents that a scenario names one by one.

use super::crowd::{Crowd, Entry, Stop};
use super::places::Place;
use super::traits::TraitSampler;
use crate::library::choose::Chooser;
use crate::scenario::error::Error;
use crate::scenario::file::{Point, RouteMode, Scenario, Walker};
use glam::Vec2;

impl Walker {
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

/// Adds the walkers to a crowd: with sampled traits as all others, and a gait near their own speed.
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
        let mut start = TraitSampler::new(&own, chooser)?.agent(agent, place, Entry::Start)?;
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
