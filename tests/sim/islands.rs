//! Crowds that step together are, bit for bit, what each is alone.

use crate::common::gpu;
use gaitway::scenario::Scenario;
use gaitway::sim::measure::state_hash;
use gaitway::sim::{Backend, Islands, Simulation};
use gaitway::{Result, Scene};
use glam::Vec2;

/// Crowds that differ in what a step does: routes, sources, queues, feelings, prices of density, a robot, patience, groups. One
/// avoids by the paper's model, and one is empty.
fn scenes(backend: Backend) -> Vec<Scene> {
    let of = |scenario: Scenario| Scene::of(scenario).backend(backend).build().unwrap();
    let load = |path: &str| Scenario::load(path.as_ref()).unwrap();
    let builtin = |name: &str, agents: u32, seed: u64| {
        of(Scenario::builtin(name).unwrap().with_agents(agents).with_seed(seed))
    };
    let mut paper = Scenario::builtin("parking").unwrap().with_agents(50);
    paper.navigation.model = gaitway::scenario::Model::Rvo;
    vec![
        builtin("crossing", 70, 1),
        builtin("crossing", 70, 2),
        of(load("assets/scenes/station.toml")),
        builtin("garden", 33, 3),
        of(load("assets/starters/museum.toml").with_seed(4)),
        of(load("assets/starters/corridor.toml")),
        of(load("assets/starters/corridor.toml").with_seed(9)),
        of(paper),
        builtin("crossing", 0, 1),
        of(load("assets/starters/hall.toml").with_agents(20)),
    ]
}

/// The crowds of the scenes together, and each by itself.
fn start(scenes: &[Scene]) -> Result<(Islands, Vec<Simulation>)> {
    let mut alone = vec![scenes[0].start()?];
    for scene in &scenes[1..] {
        alone.push(scene.start_beside(&alone[0])?);
    }
    let mut islands = Islands::default();
    for scene in scenes {
        scene.start_in(&mut islands)?;
    }
    Ok((islands, alone))
}

fn assert_alike(islands: &mut Islands, alone: &mut [Simulation], when: &str) {
    for (number, (crowd, alone)) in islands.crowds_mut().iter_mut().zip(alone).enumerate() {
        assert_eq!(crowd.steps_done(), alone.steps_done());
        let [together, alone] = [crowd, alone].map(|crowd| state_hash(crowd.state().unwrap()));
        assert_eq!(together, alone, "crowd {number} {when}");
    }
}

fn each_is_what_it_is_alone(backend: Backend) {
    let scenes = scenes(backend);
    let Some((mut islands, mut alone)) = gpu::on_device(start(&scenes)) else { return };
    for (steps, when) in
        [(1, "after a step"), (40, "after more than a batch"), (0, "after nothing"), (75, "later")]
    {
        islands.step(steps).unwrap();
        alone.iter_mut().for_each(|crowd| crowd.step(steps).unwrap());
        assert_alike(&mut islands, &mut alone, when);
    }
    // what changes one of them: a robot that is led, other walls, the user, steps of its own
    let change = |crowds: &mut [Simulation]| {
        let robot = crowds[2].store().step.agent_count - 1;
        crowds[2].lead(robot, Some((Vec2::new(30.0, 30.0), Vec2::X))).unwrap();
        let wall = vec![[10.0, 1.2], [10.0, 2.8]];
        let outlines = scenes[5].geometry.outlines().map(|one| one.iter().map(Vec2::to_array).collect());
        crowds[5].set_obstacles(&outlines.chain([wall]).collect::<Vec<_>>()).unwrap();
        crowds[3].set_user(Vec2::new(1.0, 0.0), 0.0, Vec2::ZERO);
        crowds[0].step(7).unwrap();
    };
    change(islands.crowds_mut());
    change(&mut alone);
    islands.step(50).unwrap();
    alone.iter_mut().for_each(|crowd| crowd.step(50).unwrap());
    assert_alike(&mut islands, &mut alone, "after changes");
}

#[test]
fn on_the_cpu_each_is_what_it_is_alone() {
    each_is_what_it_is_alone(Backend::Cpu);
}

#[cfg(feature = "vulkan")]
#[test]
fn on_a_device_each_is_what_it_is_alone() {
    each_is_what_it_is_alone(Backend::Vulkan);
    gpu::assert_silent();
}

/// Crowds that come after all others have gone are on a device of their own.
#[cfg(feature = "vulkan")]
#[test]
fn crowds_come_and_go() {
    let scene = Scene::load("garden").unwrap().agents(12).backend(Backend::Vulkan).build().unwrap();
    let mut islands = Islands::default();
    let mut hashes = Vec::new();
    for _ in 0..3 {
        if gpu::on_device(scene.start_in(&mut islands).map(|_| ())).is_none() {
            return;
        }
        islands.step(20).unwrap();
        hashes.push(state_hash(islands.remove(0).state().unwrap()));
    }
    assert!(hashes.windows(2).all(|pair| pair[0] == pair[1]), "{hashes:x?}");
    gpu::assert_silent();
}

#[test]
fn no_crowds_are_no_error() {
    let mut none = Islands::default();
    none.step(10).unwrap();
    assert!(none.crowds().is_empty());
}
