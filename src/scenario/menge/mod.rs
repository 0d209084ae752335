//! Menge's scenes (Curtis, Best, Manocha 2016, "Menge: A Modular Framework for Simulating Crowd Movement") as scenarios.
//!
//! A project names a scene (agents, obstacles) and a behaviour (a finite state machine: goals, how they are reached, what
//! follows). The machine is walked once for every agent, from its first state until a state that ends or comes again,
//! which gives the agent's waypoints: straight ones, along a road map, or through a navigation mesh. A vector field
//! becomes way-finding to its goal. What is not taken over or only approximated stands in the [`Report`] with its file
//! and line; nothing is dropped silently.
//!
//! Menge's plane is (x, y) with y up the page; ours is (x, z), so z = -y.

mod agents;
mod behaviour;
mod field;
mod goals;
mod nav;
mod obstacles;
mod report;
mod roads;
mod xml;

pub use report::{Approximation, Report};

use crate::scenario::error::Error;
use crate::scenario::file::{MAX_AGENTS, MAX_NEIGHBOURS, Obstacle, Scenario, Walker};
use crate::scenario::polygon;
use behaviour::ground;
use glam::Vec2;
use std::path::{Path, PathBuf};
use xml::{Source, wrong};

/// Ground about everything that is walked on, m.
const MARGIN: f32 = 5.0;
/// Random part of the preferred velocity, m/s.
const PERTURBATION: f32 = 0.1;

/// A scene that was taken over.
#[derive(Debug, Clone, PartialEq)]
pub struct Imported {
    /// The scenario.
    pub scenario: Scenario,
    /// What was found.
    pub report: Report,
}

/// Reads a Menge project: the file that names scene and behaviour.
///
/// # Errors
/// [`Error::Read`] when a file cannot be read, [`Error::Syntax`] with file and line of what is wrong in it,
/// [`Error::Value`] when what comes out is no valid scenario (too many agents, coordinates out of range).
pub fn import(project: &Path, seed: u64) -> Result<Imported, Error> {
    let source = Source::read(project)?;
    let document = source.parse()?;
    let root = document.root_element();
    if root.tag_name().name() != "Project" {
        let found = root.tag_name().name();
        let message = format!("<{found}>; a Menge project begins with <Project scene=.. behavior=..>");
        return Err(wrong(&source, &root, message));
    }
    let folder = project.parent().unwrap_or(Path::new(""));
    let file = |name: &str| -> Result<PathBuf, Error> {
        root.attribute(name)
            .map(|path| folder.join(path))
            .ok_or_else(|| wrong(&source, &root, format!("the project names no {name}")))
    };
    let mut report = Report::default();
    let scene = Source::read(&file("scene")?)?;
    let behaviour = Source::read(&file("behavior")?)?;
    let name = project.file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    let mut scenario = assemble(&scene, &behaviour, seed, &mut report)?;
    let word = |c: char| if c.is_ascii_alphanumeric() || c == '-' || c == '_' { c } else { '_' };
    scenario.name = name.chars().take(64).map(word).collect();
    if scenario.name.is_empty() {
        "menge".clone_into(&mut scenario.name);
    }
    scenario.description = format!("Menge's scene {}", scenario.name);
    scenario.validate()?;
    Ok(Imported { scenario, report })
}

fn assemble(scene: &Source, behaviour: &Source, seed: u64, report: &mut Report) -> Result<Scenario, Error> {
    let document = scene.parse()?;
    let mut scenario = Scenario { seed, ..Scenario::default() };
    scenario.population.agents = 0;
    let placed = agents::read(scene, &document, seed, report)?;
    if placed.len() > MAX_AGENTS as usize {
        let hint = "split the scene";
        return Err(Error::value("walkers", placed.len(), format!("at most {MAX_AGENTS}"), hint));
    }
    let solids = obstacles::read(scene, &document, &placed, report)?;
    let walls: Vec<Vec<Vec2>> = solids.polygons.clone();
    let machine_document = behaviour.parse()?;
    let machine = behaviour::Machine::read(behaviour, &machine_document, report)?;
    let walkers = machine.walk(&placed, &walls, seed, report);
    navigation(&mut scenario, &placed, report);
    report.agents = walkers.len();
    report.obstacles = walls.len();
    report.with_an_end = walkers.iter().filter(|walker| walker.ends()).count();
    scenario.bounds = match solids.bounds {
        Some(bounds) => bounds.iter().map(|corner| ground(*corner)).collect(),
        None => around(&walkers, &walls),
    };
    let polygon = |corners: &Vec<Vec2>| corners.iter().map(|corner| ground(*corner)).collect();
    scenario.obstacles =
        walls.iter().map(|corners| Obstacle { polygon: polygon(corners), low: None, high: None }).collect();
    scenario.walkers = walkers;
    Ok(scenario)
}

/// What all agents share, from the first of them.
fn navigation(scenario: &mut Scenario, placed: &[agents::Placed], report: &mut Report) {
    let Some(first) = placed.first() else { return };
    let own = &mut scenario.navigation;
    // Menge's agents do not slow down because it is crowded; and a model without chance would leave its symmetric scenes
    // as they are for ever.
    (own.crowding, own.perturbation) = (0.0, PERTURBATION);
    own.neighbour_distance = first.profile.neighbour_distance.clamp(0.5, 50.0);
    own.neighbour_cap = first.profile.neighbour_cap.min(MAX_NEIGHBOURS);
    own.time_horizon = first.profile.horizon.clamp(0.1, 30.0);
    own.time_horizon_obstacles = first.profile.horizon_obstacles.clamp(0.1, 30.0);
    let key = |agent: &agents::Placed| agent.profile.shared();
    if placed.iter().any(|agent| key(agent) != key(first)) {
        report.note(
            "neighbour distance, neighbour cap and horizons differ between agents; the first one's are taken",
        );
    }
    if first.profile.neighbour_cap > MAX_NEIGHBOURS {
        report.note(format!("max_neighbors {} became {}", first.profile.neighbour_cap, own.neighbour_cap));
    }
}

/// A rectangle about all that is walked on; where ways are found, with room to walk round every obstacle.
fn around(walkers: &[Walker], walls: &[Vec<Vec2>]) -> Vec<[f32; 2]> {
    let finds = walkers.iter().any(|walker| walker.way.is_some());
    let corners = walls.iter().filter(|_| finds).flatten().map(|corner| Vec2::from(ground(*corner)));
    let corners: Vec<Vec2> = corners.collect();
    let points = || {
        let of = |walker: &Walker| {
            std::iter::once(walker.position)
                .chain(walker.waypoints.clone())
                .map(Vec2::from)
                .collect::<Vec<_>>()
        };
        walkers.iter().flat_map(of).chain(corners.iter().copied())
    };
    if walkers.is_empty() {
        return polygon::rectangle(Vec2::ZERO, Vec2::splat(2.0 * MARGIN), 0.0)
            .iter()
            .map(Vec2::to_array)
            .collect();
    }
    let low = points().fold(Vec2::MAX, Vec2::min) - MARGIN;
    let high = points().fold(Vec2::MIN, Vec2::max) + MARGIN;
    polygon::rectangle((low + high) * 0.5, high - low, 0.0).iter().map(Vec2::to_array).collect()
}
