//! Laws of the simulation, on the CPU backend: what holds there holds bit for bit on an exact device.

use gaitway::avatar::{Sex, generated};
use gaitway::kernels::layout::{Route, Stage};
use gaitway::kernels::{KernelId, Phase, Store};
use gaitway::library::GaitLibrary;
use gaitway::scenario::{Clearance, Scenario, populate};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure};
use gaitway::verify::cases::crossing::{crossing, crossing_quality};
use gaitway::{reference, sim};
use glam::Vec2;

#[test]
fn the_crossing_flows_and_no_agent_leaves_it_overlaps_or_stands_still_for_long() {
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(1500);
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let geometry = scenario.geometry();
    let walkable = Clearance::new(&geometry.bounds, &geometry.obstacles);
    let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let mut still = vec![0_u32; 1500];
    for second in 0..20 {
        simulation.step(30).unwrap();
        let store = simulation.state().unwrap();
        let moment = measure::measures(store);
        assert!(moment.overlapping_pairs <= 1, "second {second}: {moment:?}");
        assert_eq!(measure::outside(store, |p| walkable.walkable(p)), 0, "second {second}");
        for (count, v) in still.iter_mut().zip(&store.velocity) {
            *count = if v[0].hypot(v[1]) < 0.05 { *count + 1 } else { 0 };
            assert!(*count < 10, "second {second}: an agent has stood for ten seconds");
        }
        for (v, body) in store.velocity.iter().zip(&store.body) {
            assert!(v[0].hypot(v[1]) <= body.max_speed * 1.0001, "faster than the maximum");
        }
    }
    assert!(measure::measures(simulation.state().unwrap()).mean_speed > 0.9);
}

fn steps(store: &mut Store, count: u32) {
    let dispatches = sim::order::step_dispatches(&store.step);
    for _ in 0..count {
        for dispatch in &dispatches {
            reference::run(dispatch.phase, store, dispatch.immediate);
        }
        store.step.step_index += 1;
    }
}

#[test]
fn the_dense_crossing_is_no_worse_than_rvo2_at_any_density() {
    // overlaps, smallest distance and progress of RVO2 after the same 10 s, 10,000 agents (see docs/speed.md); at 1/m² both
    // are nearly as quick as they want, and 0.5 % is the tie
    for (spacing, time_step, count, overlapping, distance, progress) in [
        (1.0, 1.0 / 30.0, 300, 2e-5, 0.494, 0.995 * 1.287),
        (0.7, 1.0 / 30.0, 300, 0.0044, 0.485, 1.115),
        (0.7, 0.1, 100, 0.209, 0.425, 0.975),
    ] {
        let mut store = crossing(3600, spacing);
        (store.step.time_step, store.step.inverse_time_step) = (time_step, 1.0 / time_step);
        steps(&mut store, count);
        let found = crossing_quality(&store);
        assert!(
            found.overlapping <= overlapping && found.min_distance >= distance,
            "{spacing} m, {time_step} s: {found:?}"
        );
        assert!(found.progress >= progress, "{spacing} m, {time_step} s: {found:?}");
    }
}

/// Two agents, alone on a wide plane, each walking to where the other starts.
fn duel(second: [f32; 2], perturbation: f32) -> Store {
    let mut store = crossing(4, 10.0);
    store.step.agent_count = 2;
    store.step.wrap = 0.0;
    store.step.perturbation = perturbation;
    for array in [&mut store.position, &mut store.velocity] {
        array.truncate(2);
    }
    store.position = vec![[5.0, 10.0], second];
    store.velocity = vec![[0.0; 2]; 2];
    store.stages = vec![Stage::waypoint(second, 0.2), Stage::waypoint([5.0, 10.0], 0.2)];
    store.route = vec![Route::new(0, 1, false, 0), Route::new(1, 1, false, 0)];
    store
}

#[test]
fn two_people_exactly_head_on_pass_each_other() {
    let mut store = duel([15.0, 10.0], 0.02);
    steps(&mut store, 30 * 30);
    assert!(store.route.iter().all(|route| route.arrivals == 1), "{:?}", store.position);
}

#[test]
fn a_walker_through_the_origin_of_a_custom_scene_stays_on_its_line() {
    let library = GaitLibrary::built_in().unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(generated).to_vec()).unwrap();
    let farthest = |user: &str| {
        let text = format!(
            "name = \"line\"\nbounds = [[-12, -5], [12, -5], [12, 5], [-12, 5]]\n{user}[population]\nagents = 0\n\
             [[walkers]]\nposition = [-10, 0]\nwaypoints = [[10, 0]]\nspeed = 1.3\n"
        );
        let scenario = Scenario::parse(&text, "line").unwrap();
        let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
        let mut simulation = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
        let mut farthest = 0.0_f32;
        for _ in 0..16 * 30 {
            simulation.step(1).unwrap();
            farthest = farthest.max(simulation.state().unwrap().position[0][1].abs());
        }
        let [x, _] = simulation.state().unwrap().position[0];
        assert!(x > 9.0, "it came to x = {x} m");
        farthest
    };
    assert!(farthest("") < 0.01, "it swerves by {} m without a cause", farthest(""));
    let around = farthest("[user]\nposition = [0, 0]\n");
    assert!(around > 0.4, "it passes the user at {around} m");
}

#[test]
fn an_agent_walks_around_the_user_who_gives_no_way() {
    let mut store = duel([15.0, 10.0], 0.02);
    store.step.agent_count = 1;
    store.step.user_position = [10.0, 10.0];
    store.step.user_radius = 0.4;
    let mut closest = f32::MAX;
    for _ in 0..30 * 20 {
        steps(&mut store, 1);
        let [x, z] = store.position[0];
        closest = closest.min((x - 10.0).hypot(z - 10.0));
    }
    assert_eq!(store.route[0].arrivals, 1, "it did not arrive: {:?}", store.position[0]);
    assert!(closest >= 0.649, "it came as near as {closest} m to the user");
}

/// Distance at which an agent begins to walk round a user who walks straight at it, m. `told` is the user's velocity as
/// given to the crowd.
fn gives_way_at(model: u32, told: Vec2) -> f32 {
    let mut store = duel([15.0, 10.0], 0.02);
    store.step.agent_count = 1;
    store.step.model = model;
    store.step.user_radius = 0.4;
    let mut simulation = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    for number in 0..30 * 8_u8 {
        let user = Vec2::new(15.0 - 1.3 * f32::from(number) / 30.0, 10.0);
        simulation.set_user(user, 0.0, told);
        simulation.step(1).unwrap();
        let agent = Vec2::from(simulation.state().unwrap().position[0]);
        if (agent.y - 10.0).abs() > 0.1 {
            return agent.distance(user);
        }
    }
    panic!("no agent gave way");
}

#[test]
fn a_user_who_walks_is_avoided_by_where_they_will_be() {
    for model in sim::order::MODELS {
        let [told, untold] = [Vec2::new(-1.3, 0.0), Vec2::ZERO].map(|told| gives_way_at(model, told));
        assert!(told > 1.1 * untold, "model {model}: {told} m away, and {untold} m if untold");
    }
}

#[test]
fn people_at_one_point_come_apart_with_finite_velocities() {
    let mut store = duel([5.0, 10.0], 0.0);
    steps(&mut store, 30);
    let (a, b) = (store.position[0], store.position[1]);
    assert!((a[0] - b[0]).hypot(a[1] - b[1]) >= 0.49, "{a:?} {b:?}");
    assert!(store.failure.iter().all(|word| *word == u32::MAX));
}

#[test]
fn a_velocity_that_is_not_finite_is_reported_with_kernel_and_agent_and_not_taken() {
    let mut store = crossing(9, 1.0);
    steps(&mut store, 1);
    let (before, slot) = (store.position[4], store.agent_slot[4] as usize);
    store.new_velocity[slot] = [f32::NAN, 0.0];
    reference::run(Phase::Integrate, &mut store, 0);
    assert_eq!(store.position[4], before);
    assert_eq!(store.failure[KernelId::Integrate as usize], 4);
}
