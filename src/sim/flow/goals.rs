//! Which stages of a scenario's crowd have a field, and how the flow grid is laid for it.

use super::{Goal, Settings, Sheets, lay_on};
use crate::kernels::Store;
use crate::kernels::shared::climb::STEP;
use crate::scenario::{AgentStart, Crowd, Entry, Floors, Geometry, Scenario, Stop, StopKind, Way};
use crate::sim::Error;
use glam::Vec2;
use std::collections::BTreeMap;

/// Most fields of one scenario.
pub const MOST_FIELDS: usize = 256;

/// The goals that have a field each, and what the fields are laid by: kept for when obstacles move.
#[derive(Debug, Clone, Default)]
pub struct Ways {
    /// Goals by field.
    pub goals: Vec<Goal>,
    /// How the grid is laid.
    pub settings: Settings,
    /// Floors, and solids that stand at some heights only: they stay where they are.
    pub floors: Floors,
}

/// Gives the stages of a crowd their flow fields by `scenario.way_finding`: lays the flow grid into a store that holds the
/// crowd already. [`crate::sim::Simulation::from_store`] solves the fields.
///
/// # Errors
/// As [`lay_on`]; [`Error::Fields`] when there are too many goals; [`Error::Unreachable`] when no way leads an agent to its
/// goal on another storey.
pub fn equip(
    store: &mut Store,
    scenario: &Scenario,
    geometry: &Geometry,
    crowd: &Crowd,
) -> Result<Ways, Error> {
    let wanted = &scenario.way_finding;
    let floors = geometry.floors.clone();
    let could_be_blocked =
        !geometry.obstacles.is_empty() || floors.count() > 0 || !is_convex(&geometry.bounds);
    let is_asked = |stop: &Stop| match stop.way.unwrap_or(wanted.way) {
        Way::Straight => false,
        Way::Field => true,
        Way::Auto => could_be_blocked,
    };
    let radii = store.body.iter().map(|body| body.radius);
    let settings = Settings {
        cell: wanted.cell,
        clearance: wanted.clearance.unwrap_or_else(|| radii.reduce(f32::min).unwrap_or(0.25)),
        density_weight: wanted.density_weight,
        every: (wanted.every / scenario.navigation.time_step).round().max(1.0) as u32,
    };
    let mut goals: Vec<Goal> = Vec::new();
    let mut fields = Vec::with_capacity(crowd.stages.len());
    for stop in &crowd.stages {
        if !is_asked(stop) {
            fields.push(None);
            continue;
        }
        let goal = goal(stop, scenario);
        let is_same =
            |g: &Goal| (g.center, g.elevation) == (goal.center, goal.elevation) && g.region == goal.region;
        let known = goals.iter().position(is_same);
        fields.push(Some(known.unwrap_or(goals.len())));
        if known.is_none() {
            if goals.len() == MOST_FIELDS {
                return Err(Error::Fields { most: MOST_FIELDS });
            }
            goals.push(goal);
        }
    }
    if goals.is_empty() {
        return Ok(Ways { goals, settings, floors });
    }
    let outlines: Vec<Vec<[f32; 2]>> =
        geometry.outlines().map(|outline| outline.iter().map(Vec2::to_array).collect()).collect();
    if let Some(sheets) = lay_on(store, &outlines, &floors, &goals, &settings)?.filter(|_| floors.count() > 0)
    {
        check_reach(&sheets, store, crowd, &goals, &fields)?;
    }
    for (stage, field) in store.stages.iter_mut().zip(fields) {
        stage.field = field.map_or(-1.0, |field| field as f32);
    }
    Ok(Ways { goals, settings, floors })
}

/// What a stage asks the way to.
fn goal(stop: &Stop, scenario: &Scenario) -> Goal {
    let [along, across] = stop.half_axes;
    let c = stop.position;
    if stop.kind == StopKind::Waypoint {
        let name = format!("waypoint ({:.1}, {:.1})", c.x, c.y);
        return Goal { name, center: c, radius: stop.radius, region: Vec::new(), elevation: stop.elevation };
    }
    let name = scenario.stages.get(stop.number as usize).map_or_else(String::new, |stage| stage.name.clone());
    let region = vec![c - along - across, c + along - across, c + along + across, c - along + across];
    Goal { name, center: c, radius: stop.radius, region, elevation: stop.elevation }
}

/// Whether every agent can come to each of its goals on another storey, from where it sets out for it.
fn check_reach(
    sheets: &Sheets,
    store: &Store,
    crowd: &Crowd,
    goals: &[Goal],
    fields: &[Option<usize>],
) -> Result<(), Error> {
    // by field and cell: a place from which an agent sets out
    let mut legs: BTreeMap<(usize, usize), (Vec2, f32)> = BTreeMap::new();
    for agent in crowd.agents.iter().filter(|agent| agent.entry != Entry::Never) {
        for (stop, at, elevation) in places(agent, &crowd.stages) {
            if let (Some(field), Some(cell)) = (fields[stop], sheets.cell(at, elevation)) {
                legs.entry((field, cell)).or_insert((at, elevation));
            }
        }
    }
    let seeds = &store.flow_seeds[..store.flow_grid.seed_count as usize];
    for (field, goal) in goals.iter().enumerate() {
        let mut own = legs.range((field, 0)..(field + 1, 0)).peekable();
        if own.peek().is_none() {
            continue;
        }
        let of = seeds.iter().filter(|seed| seed.field as usize == field).map(|seed| seed.cell as usize);
        let reached = sheets.reached_from(of);
        let to_elevation = goal.elevation.unwrap_or(0.0);
        for ((_, cell), &(from, from_elevation)) in own {
            if !reached[*cell] && (from_elevation - to_elevation).abs() >= STEP {
                let (name, to) = (goal.name.clone(), goal.center);
                return Err(Error::Unreachable { name, to, to_elevation, from, from_elevation });
            }
        }
    }
    Ok(())
}

/// The stages that an agent goes to, each with where it sets out for it and how high that is, m, as far as that is known.
fn places<'a>(agent: &'a AgentStart, stages: &'a [Stop]) -> impl Iterator<Item = (usize, Vec2, f32)> + 'a {
    let first = agent.route_start as usize;
    let end = (first + agent.route_length as usize).min(stages.len());
    let mut from = Some((agent.position, agent.elevation));
    (first + agent.waypoint as usize..end).filter_map(move |stop| {
        let before = from;
        from = stages[stop].elevation.map(|elevation| (stages[stop].position, elevation));
        before.map(|(at, elevation)| (stop, at, elevation))
    })
}

fn is_convex(outline: &[Vec2]) -> bool {
    let corner = |i: usize| outline[i % outline.len()];
    let turn = |i: usize| (corner(i + 1) - corner(i)).perp_dot(corner(i + 2) - corner(i + 1));
    (0..outline.len()).all(|i| turn(i) <= 0.0) || (0..outline.len()).all(|i| turn(i) >= 0.0)
}
