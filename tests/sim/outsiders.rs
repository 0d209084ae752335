//! Claims about robots, vehicles, tracked people and the user among a crowd.

use crate::common::gpu;
use gaitway::scenario::{Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Error, Simulation, measure};
use gaitway::{avatar, library};
use glam::Vec2;

const PLACE: &str = "name = \"place\"\nbounds = [[0, 0], [34, 0], [34, 34], [0, 34]]\n\
    [[routes]]\nname = \"a\"\nwaypoints = [[2, 17], [32, 17]]\nwidth = 28\n\
    [[routes]]\nname = \"b\"\nwaypoints = [[17, 2], [17, 32]]\nwidth = 28\n";

fn scene(text: &str, backend: Backend) -> Result<Simulation, gaitway::Error> {
    let scenario = Scenario::parse(&format!("{PLACE}{text}"), "place")?;
    let library = library::GaitLibrary::built_in()?;
    let crowd = populate_from(&scenario, &library)?;
    let cast = AvatarSet::new(library.gaits(), avatar::Sex::ALL.map(avatar::generated).to_vec())?;
    Simulation::new(&scenario, &crowd, &cast, backend, None)
}

/// Where a vehicle is on a straight way from (2, 17) to (32, 17) in 20 s.
fn on_the_way(time: f32) -> Vec2 {
    Vec2::new(2.0 + 30.0 * (time / 20.0).clamp(0.0, 1.0), 17.0)
}

/// Smallest gap between agent 300 and the others over 21 s, m, and its greatest deviation from its way, m.
fn drive(comfort: f32) -> (f32, f32, f32) {
    let text = format!(
        "[population]\nagents = 300\n[[outsiders]]\nkind = \"vehicle\"\nradius = 0.9\n\
         comfort = {comfort}\npath = [[0, 2, 17], [20, 32, 17]]\n"
    );
    let mut simulation = scene(&text, Backend::Cpu).unwrap();
    let (mut gap, mut off, mut near) = (f32::INFINITY, 0.0_f32, 0.0);
    for step in 1..=630_u16 {
        simulation.step(1).unwrap();
        let store = simulation.state().unwrap();
        assert_eq!(store.position.len(), 301);
        let at = Vec2::from_array(store.position[300]);
        off = off.max(at.distance(on_the_way(f32::from(step) / 30.0)));
        for (position, body) in store.position[..300].iter().zip(&store.body) {
            let between = at.distance(Vec2::from_array(*position)) - 0.9 - body.radius;
            gap = gap.min(between);
            near += f32::from(u8::from(between < 0.3));
        }
    }
    (gap, off, near)
}

#[test]
fn no_agent_is_run_over_by_a_vehicle_in_a_crowd_of_three_hundred() {
    let (gap, off, near) = drive(0.0);
    let (comfortable, _, nearer) = drive(0.5);
    println!(
        "smallest gap {gap} m, with comfort {comfortable} m; nearer than 0.3 m {near} and {nearer} times"
    );
    assert!(gap > 0.0, "smallest gap {gap} m");
    assert!(off < 2e-5, "{off} m off its way");
    assert!(nearer < 0.5 * near, "comfort keeps them farther away: {near} {nearer}");
}

#[test]
fn outsiders_on_paths_and_by_hand_are_the_same_on_both_backends() {
    let text = "[population]\nagents = 60\n[[outsiders]]\nkind = \"robot\"\ncomfort = 0.3\n\
                path = [[0, 5, 5], [4, 9, 5], [6, 9, 5], [9, 9, 12]]\n[[outsiders]]\nkind = \"person\"\n\
                path = [[1, 20, 20], [9, 12, 20]]\n[[outsiders]]\nkind = \"person\"\n";
    let mut hashes = Vec::new();
    for backend in [Backend::Cpu, Backend::Vulkan] {
        let Some(mut simulation) = gpu::on_device(scene(text, backend)) else { continue };
        simulation.step(150).unwrap();
        let store = simulation.state().unwrap();
        assert!(Vec2::from_array(store.position[60]).distance(Vec2::new(9.0, 5.0)) < 1e-4);
        assert!(Vec2::from_array(store.velocity[60]).length() < 1e-2, "it waits");
        assert!(gaitway::ground::is_absent(store.position[62]), "its place was never set");
        assert!(store.appearance[60].is_bodiless(), "robots have no body");
        assert!(!store.appearance[61].is_bodiless(), "people have one");
        // now the robot is led by hand, off its path
        simulation.lead(60, Some((Vec2::new(9.05, 5.0), Vec2::ZERO))).unwrap();
        simulation.lead(62, Some((Vec2::new(25.0, 9.0), Vec2::ZERO))).unwrap();
        simulation.step(60).unwrap();
        let store = simulation.state().unwrap();
        assert!(Vec2::from_array(store.position[60]).distance(Vec2::new(9.05, 5.0)) < 1e-5);
        assert!(Vec2::from_array(store.position[62]).distance(Vec2::new(25.0, 9.0)) < 1e-5);
        hashes.push(measure::state_hash(simulation.state().unwrap()));
    }
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:?}");
}

#[test]
fn who_cannot_be_led_is_named() {
    let mut simulation =
        scene("[population]\nagents = 5\n[[outsiders]]\nkind = \"person\"\n", Backend::Cpu).unwrap();
    for agent in [0, 4, 6, u32::MAX] {
        let error = simulation.lead(agent, Some((Vec2::ZERO, Vec2::ZERO))).unwrap_err();
        assert!(matches!(error, gaitway::Error::Sim(Error::NotLed { agent: a }) if a == agent), "{error}");
    }
    let error = simulation.lead(5, Some((Vec2::new(f32::NAN, 0.0), Vec2::ZERO))).unwrap_err();
    assert!(matches!(error, gaitway::Error::Sim(Error::Lead { agent: 5, .. })), "{error}");
    simulation.lead(5, Some((Vec2::ONE, Vec2::ZERO))).unwrap();
}

#[test]
fn people_keep_the_users_comfort_distance() {
    let nearest = |comfort: f32| {
        let text = format!("[user]\nposition = [17, 17]\ncomfort = {comfort}\n[population]\nagents = 100\n");
        let mut simulation = scene(&text, Backend::Cpu).unwrap();
        let mut nearest = f32::INFINITY;
        for _ in 0..600 {
            simulation.step(1).unwrap();
            let store = simulation.state().unwrap();
            for (position, body) in store.position.iter().zip(&store.body) {
                let away = Vec2::from_array(*position).distance(Vec2::splat(17.0));
                nearest = nearest.min(away - body.radius - 0.3);
            }
        }
        nearest
    };
    let (without, with) = (nearest(0.0), nearest(0.8));
    println!("nearest {without} m, with comfort {with} m");
    assert!(without > 0.0 && without < 0.5 && with > 0.75, "{without} {with}");
}

#[test]
fn wrong_outsiders_are_refused() {
    for (text, word) in [
        ("kind = \"robot\"\nradius = 9\n", "outsiders[0].radius"),
        ("kind = \"robot\"\ncomfort = -1\n", "outsiders[0].comfort"),
        ("kind = \"robot\"\npath = [[0, 1, 1], [0, 2, 2]]\n", "outsiders[0].path[1]"),
        ("kind = \"robot\"\npath = [[0, 1, 1], [1, 200, 2]]\n", "60 m/s"),
        ("kind = \"robot\"\npath = [[0, nan, 1]]\n", "outsiders[0].path[0]"),
        ("kind = \"dog\"\n", "dog"),
    ] {
        let error =
            scene(&format!("[population]\nagents = 1\n[[outsiders]]\n{text}"), Backend::Cpu).unwrap_err();
        assert!(error.to_string().contains(word), "{text}: {error}");
    }
}
