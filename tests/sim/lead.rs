//! Claims about agents that are led from outside.

use crate::common::gpu;
use gaitway::ground::is_absent;
use gaitway::kernels::Store;
use gaitway::sim::{Backend, Simulation, setup};
use gaitway::verify::cases::crossing::crossing;
use glam::Vec2;

/// A hundred walkers, the first two led.
fn crowd() -> Store {
    let mut store = crossing(100, 1.5);
    store.step.wrap = 0.0;
    for agent in 0..2 {
        setup::set_led(&mut store, agent);
    }
    store
}

fn start(backend: Backend) -> Option<Simulation> {
    gpu::on_device(Simulation::from_store(crowd(), backend, None))
}

fn path(step: u32) -> Vec2 {
    let angle = 0.02 * step as f32;
    Vec2::new(7.0 + 4.0 * angle.cos(), 7.0 + 4.0 * angle.sin())
}

#[test]
fn the_led_are_where_they_were_led_and_the_same_bits_on_both_backends() {
    let mut hashes = Vec::new();
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let Some(mut simulation) = start(backend) else { continue };
        for step in 1..200 {
            let there = (20..150).contains(&step);
            let velocity = (path(step) - path(step - 1)) * 30.0;
            simulation.lead(0, there.then(|| (path(step), velocity))).unwrap();
            simulation.step(1).unwrap();
            let store = simulation.state().unwrap();
            let at = Vec2::from_array(store.position[0]);
            assert_eq!(is_absent(at.to_array()), !there, "step {step}");
            assert!(is_absent(store.position[1]), "never told to be anywhere");
            if there {
                assert!(at.distance(path(step)) < 1e-5, "step {step}: {at} {}", path(step));
                let heading = gaitway::ground::heading_from_ground(velocity);
                let off = (store.heading[0] - heading).rem_euclid(std::f32::consts::TAU);
                assert!(!(0.4..=5.9).contains(&off), "step {step}: faces {off} rad beside its way");
                assert!(
                    (store.stance[0].walk_weight - 1.0).abs() < 0.2,
                    "in mid-stride from its first step on"
                );
            }
        }
        hashes.push(gaitway::sim::measure::state_hash(simulation.state().unwrap()));
    }
    assert!(hashes.windows(2).all(|two| two[0] == two[1]));
}

#[test]
fn a_led_agent_without_a_new_place_stands() {
    let mut simulation = start(Backend::Cpu).unwrap();
    simulation.lead(0, Some((Vec2::new(3.0, 4.0), Vec2::ZERO))).unwrap();
    simulation.step(40).unwrap();
    let store = simulation.state().unwrap();
    assert!(Vec2::from_array(store.position[0]).distance(Vec2::new(3.0, 4.0)) < 1e-6);
    assert!(store.stance[0].walk_weight < 1e-6, "and not in mid-stride");
}

#[test]
fn only_the_led_are_led_and_only_to_places() {
    let mut simulation = start(Backend::Cpu).unwrap();
    let here = Some((Vec2::ZERO, Vec2::ZERO));
    for agent in [2, 99, 100, u32::MAX] {
        assert!(simulation.lead(agent, here).unwrap_err().to_string().contains("set_led"), "{agent}");
    }
    for bad in [Vec2::NAN, Vec2::splat(f32::INFINITY), Vec2::splat(1e9)] {
        assert!(simulation.lead(0, Some((bad, Vec2::ZERO))).is_err());
        assert!(simulation.lead(0, Some((Vec2::ZERO, bad))).is_err());
    }
}

#[test]
fn walkers_make_way_for_the_led_who_make_none() {
    let mut simulation = start(Backend::Cpu).unwrap();
    let mut nearest = f32::INFINITY;
    for step in 0..240 {
        let at = Vec2::new(2.0, 1.0) + Vec2::new(0.9, 0.7) * (step as f32 / 30.0);
        simulation.lead(0, Some((at, Vec2::ZERO))).unwrap();
        simulation.step(1).unwrap();
        if step < 60 {
            continue; // the crowd has seen it come
        }
        let store = simulation.state().unwrap();
        let all = store.position[2..100].iter().map(|p| Vec2::from_array(*p).distance(at));
        nearest = all.fold(nearest, f32::min);
    }
    assert!(nearest > 0.45, "{nearest} m between centres of discs of 0.25 m");
}
