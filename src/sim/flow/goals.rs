//! Which stages of a scenario's crowd have a field, and how the flow grid is laid for it.

use super::{Goal, Settings, lay};
use crate::kernels::Store;
use crate::reference::stages::STAGE_STRIDE;
use crate::scenario::{Crowd, Geometry, Raised, Scenario, Stop, StopKind, Way};
use crate::sim::Error;
use glam::Vec2;

/// Most fields of one scenario.
pub const MOST_FIELDS: usize = 256;

/// The goals that have a field each, and what the fields are laid by: kept for when obstacles move.
#[derive(Debug, Clone, Default)]
pub struct Ways {
    /// Goals by field.
    pub goals: Vec<Goal>,
    /// How the grid is laid.
    pub settings: Settings,
    /// Solids that stand at some heights only: they are not on the grid, but stay where they are.
    pub raised: Vec<Raised>,
}

/// Gives the stages of a crowd their fields as `scenario.way_finding` says: lays the flow grid into a store in which the
/// crowd is already. The fields are solved by [`crate::sim::Simulation::from_store`].
///
/// Solids that stand at some heights only, ramps and bridges are not on the grid: it is that of the ground.
///
/// # Errors
/// As [`lay`]; [`Error::Fields`] when there are too many goals.
pub fn equip(
    store: &mut Store,
    scenario: &Scenario,
    geometry: &Geometry,
    crowd: &Crowd,
) -> Result<Ways, Error> {
    let wanted = &scenario.way_finding;
    let raised = geometry.floors.raised.clone();
    let could_be_blocked = !geometry.obstacles.is_empty() || !is_convex(&geometry.bounds);
    let is_asked = |stop: &Stop| match stop.way.unwrap_or(wanted.way) {
        Way::Straight => false,
        Way::Field => true,
        Way::Auto => could_be_blocked,
    };
    let radii = store.body.iter().map(|body| body[0]);
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
        let known = goals.iter().position(|g| g.center == goal.center && g.region == goal.region);
        fields.push(Some(known.unwrap_or(goals.len())));
        if known.is_none() {
            if goals.len() == MOST_FIELDS {
                return Err(Error::Fields { most: MOST_FIELDS });
            }
            goals.push(goal);
        }
    }
    if goals.is_empty() {
        return Ok(Ways { goals, settings, raised });
    }
    let outlines: Vec<Vec<[f32; 2]>> =
        geometry.outlines().map(|outline| outline.iter().map(Vec2::to_array).collect()).collect();
    lay(store, &outlines, &goals, &settings)?;
    for (stage, field) in store.stages.chunks_exact_mut(STAGE_STRIDE).zip(fields) {
        stage[2][0] = field.map_or(-1.0, |field| field as f32);
    }
    Ok(Ways { goals, settings, raised })
}

/// What a stage asks the way to.
fn goal(stop: &Stop, scenario: &Scenario) -> Goal {
    let [along, across] = stop.half_axes;
    let c = stop.position;
    if stop.kind == StopKind::Waypoint {
        let name = format!("waypoint ({:.1}, {:.1})", c.x, c.y);
        return Goal { name, center: c, radius: stop.radius, region: Vec::new() };
    }
    let name = scenario.stages.get(stop.number as usize).map_or_else(String::new, |stage| stage.name.clone());
    let region = vec![c - along - across, c + along - across, c + along + across, c - along + across];
    Goal { name, center: c, radius: stop.radius, region }
}

fn is_convex(outline: &[Vec2]) -> bool {
    let corner = |i: usize| outline[i % outline.len()];
    let turn = |i: usize| (corner(i + 1) - corner(i)).perp_dot(corner(i + 2) - corner(i + 1));
    (0..outline.len()).all(|i| turn(i) <= 0.0) || (0..outline.len()).all(|i| turn(i) >= 0.0)
}
