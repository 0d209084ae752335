//! Crowds of scenes, measured on the way and by the host.
#![allow(clippy::unwrap_used, reason = "tests")]

use crate::kernels::Store;
use crate::scenario::{Clearance, Geometry};
use crate::scene::Scene;
use crate::sim::departures::Departures;
use crate::sim::measured::Extremes;
use crate::sim::{Backend, measure};
use glam::Vec2;

/// Steps a scene, and compares what is measured with what the host finds in every step.
fn compare(name: &str, agents: Option<u32>, disturb: impl Fn(&Geometry, &mut Store)) -> Extremes {
    let builder = Scene::load(name).unwrap();
    let scene = match agents {
        Some(agents) => builder.agents(agents),
        None => builder,
    };
    let scene = scene.seed(5).backend(Backend::Cpu).build().unwrap();
    let free = Clearance::new(&scene.geometry.bounds, &scene.geometry.obstacles);
    let mut start = scene.buffers().unwrap();
    disturb(&scene.geometry, &mut start.store);
    let mut simulation = scene.simulate(start).unwrap();
    simulation.measure_steps().unwrap();
    let mut departures = Departures::new(&scene.scenario, &scene.crowd);
    let mut by_kernel = departures.clone();
    departures.observe(simulation.state().unwrap(), 0);
    by_kernel.observe(simulation.state().unwrap(), 0);
    let (mut found, mut speeds) = (Extremes::NONE, (0.0, 0));
    for done in 1..=600 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        let own = measure::measures(store);
        let now = Extremes {
            min_clearance: own.min_clearance,
            overlapping_pairs: own.overlapping_pairs,
            outside: measure::outside(store, |place: Vec2| free.walkable(place)),
        };
        found = found.or(now);
        let (sum, count) = measure::speeds(store, |_| true);
        speeds = (speeds.0 + sum, speeds.1 + count);
        departures.observe(store, done);
    }
    let measured = simulation.extremes().unwrap();
    assert!((measured.min_clearance - found.min_clearance).abs() < 1e-5, "{measured:?} {found:?}");
    assert_eq!(measured.overlapping_pairs, found.overlapping_pairs);
    assert_eq!(measured.outside, found.outside);
    assert_eq!(simulation.extremes().unwrap(), Extremes::NONE, "what was found is forgotten");
    let seen = simulation.seen().unwrap().to_vec();
    assert_eq!(seen.iter().map(|own| own.steps).sum::<u32>(), speeds.1);
    let sum: f64 = seen.iter().map(|own| f64::from(own.speed_sum)).sum();
    assert!((sum - speeds.0).abs() < 1e-4 * speeds.0, "{sum} {}", speeds.0);
    by_kernel.see(&seen, simulation.state().unwrap());
    assert_eq!(by_kernel.evacuation(), departures.evacuation());
    found
}

#[test]
fn what_is_measured_on_the_way_is_what_the_host_finds_in_every_step() {
    let usual = compare("crossing", Some(300), |_, _| ());
    assert_eq!((usual.overlapping_pairs, usual.outside), (0, 0));
    compare("assets/scenes/station.toml", None, |_, _| ());
}

#[test]
fn overlaps_and_agents_in_walls_are_found() {
    let disturbed = compare("garden", Some(120), |place, store| {
        store.position[7] = store.position[8];
        let solid = &place.obstacles[0];
        store.position[9] = (solid.iter().sum::<Vec2>() / solid.len() as f32).to_array();
        store.position[12] = store.step.grid_origin.map(|low| low - 3.0);
        let [x, z] = store.position[10];
        store.position[11] = [x + 0.1, z];
    });
    assert!(
        disturbed.outside == 2 && disturbed.overlapping_pairs >= 2 && disturbed.min_clearance < -0.2,
        "{disturbed:?}"
    );
}
