//! Entries: the population divided among the sources, times, places.

use super::journeys::steps;
use crate::scenario::error::Error;
use crate::scenario::file::{Scenario, Source};
use crate::scenario::place::Clearance;
use crate::scenario::{polygon, random};
use glam::Vec2;

/// Places of a source, a square metre.
const DENSITY: f64 = 16.0;
/// Fewest and most places of a source.
const PLACES: [f64; 2] = [64.0, 4096.0];
/// Points tried while looking for places.
const ATTEMPTS: u32 = 65_536;

/// How many agents start where.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Split {
    /// Agents that are there from the start.
    pub(super) start: u32,
    /// Agents of each source.
    pub(super) sources: Vec<u32>,
}

/// Divides the population: first those that start in the scene, then the sources that say their share, then those
/// that need a certain number (in proportion, if there are not enough), and the rest evenly to those that never end.
pub(super) fn split(scenario: &Scenario) -> Split {
    let agents = scenario.population.agents;
    if scenario.sources.is_empty() {
        return Split { start: agents, sources: Vec::new() };
    }
    let start = part(agents, scenario.population.present.unwrap_or(0.0));
    let mut left = agents - start;
    let mut counts = vec![0; scenario.sources.len()];
    for (count, source) in counts.iter_mut().zip(&scenario.sources) {
        if let Some(share) = source.share {
            *count = part(agents, share).min(left).min(demand(source).unwrap_or(u32::MAX));
            left -= *count;
        }
    }
    let demands: Vec<Option<u32>> =
        scenario.sources.iter().map(|s| if s.share.is_some() { Some(0) } else { demand(s) }).collect();
    let wanted: u64 = demands.iter().flatten().map(|demand| u64::from(*demand)).sum();
    let given = wanted.min(u64::from(left));
    let (mut sum, mut done) = (0_u64, 0_u64);
    for (count, demand) in counts.iter_mut().zip(&demands) {
        if let Some(demand) = demand.filter(|demand| *demand > 0) {
            sum += u64::from(demand);
            let end = sum * given / wanted;
            *count = u32::try_from(end - done).unwrap_or(0);
            done = end;
        }
    }
    left -= u32::try_from(given).unwrap_or(left);
    let endless: Vec<usize> = (0..counts.len()).filter(|&i| demands[i].is_none()).collect();
    for (k, &source) in (0_u64..).zip(&endless) {
        let many = endless.len() as u64;
        let end = |k: u64| u64::from(left) * k / many;
        counts[source] = u32::try_from(end(k + 1) - end(k)).unwrap_or(0);
    }
    Split { start, sources: counts }
}

/// A share of a number, rounded.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a share of a u32")]
fn part(whole: u32, share: f32) -> u32 {
    ((f64::from(whole) * f64::from(share)).round() as u32).min(whole)
}

/// How many agents a source has times for; `None`: no end.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a rate times at most a day")]
fn demand(source: &Source) -> Option<u32> {
    match (source.rate, source.end) {
        (Some(rate), Some(end)) => {
            let long = f64::from(end) - f64::from(source.begin);
            Some((long * f64::from(rate) - 1e-6).ceil().max(0.0) as u32)
        }
        (Some(_), None) => None,
        _ => Some(source.schedule.iter().fold(0, |sum, arrivals| sum.saturating_add(arrivals.count))),
    }
}

/// The step from which on agent number `k` of a source may come in.
pub(super) fn entry_step(source: &Source, k: u32, time_step: f32) -> u32 {
    let time = match source.rate {
        Some(rate) => f64::from(source.begin) + f64::from(k) / f64::from(rate),
        None => {
            let mut before = 0_u32;
            let due = source.schedule.iter().find(|arrivals| {
                before = before.saturating_add(arrivals.count);
                k < before
            });
            due.map_or(0.0, |arrivals| f64::from(arrivals.time))
        }
    };
    steps(time, time_step)
}

/// Places of a source in which a disc of `body` fits and that bear people at its height, spread evenly over it; neighbours
/// in the list are far apart.
///
/// # Errors
/// [`Error::Value`] when there is none.
pub(super) fn places(
    key: &str,
    source: &Source,
    free: &Clearance,
    body: f32,
    bears: impl Fn(Vec2) -> bool,
) -> Result<Vec<Vec2>, Error> {
    let corners: Vec<Vec2> = source.polygon.iter().copied().map(Vec2::from).collect();
    let low = corners.iter().copied().fold(Vec2::MAX, Vec2::min);
    let high = corners.iter().copied().fold(Vec2::MIN, Vec2::max);
    let wanted = (polygon::signed_area(&corners).abs() * DENSITY).clamp(PLACES[0], PLACES[1]);
    let edge = |place: Vec2| {
        polygon::edges(&corners)
            .map(|(a, b)| polygon::point_segment_distance(place, a, b))
            .fold(f32::MAX, f32::min)
    };
    let mut found = Vec::new();
    for i in 0..ATTEMPTS {
        // Roberts' sequence R2 in 32 bits, as in shaders/shared/stages.wgsl.
        let unit = |factor: u32| random::fraction(i.wrapping_mul(factor).wrapping_add(1 << 31));
        let place = low + (high - low) * Vec2::new(unit(3_242_174_889), unit(2_447_445_414));
        let is_inside = polygon::contains(&corners, place) && edge(place) >= body;
        if is_inside && free.admits(place, body) && bears(place) {
            found.push(place);
        }
        #[allow(clippy::cast_precision_loss, reason = "at most 65,536")]
        if found.len() as f64 >= wanted {
            break;
        }
    }
    if found.is_empty() {
        let allowed = format!("a region with a place for a disc of {body:.2} m on walkable ground");
        let hint = "make it wider, or move it into the bounds and off the obstacles";
        return Err(Error::value(format!("{key}.polygon"), "[..]", allowed, hint));
    }
    Ok(found)
}
