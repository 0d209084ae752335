//! A crowd whose device is lost takes the same steps on a device that is opened again.

use crate::common::{gpu, repository};
use gaitway::scenario::WayFinding;
use gaitway::scene::{Scene, SceneBuilder};
use gaitway::sim::{Backend, measure};

const STEPS: u32 = 75;

/// Hash of the crowd after every step. Before each step of `losses` the device is lost: with a step under way that never ends,
/// or between two steps.
fn walk(scene: &Scene, losses: &[(u32, bool)]) -> Option<Vec<u64>> {
    let mut simulation = gpu::on_device(scene.start())?;
    simulation.make_renewable().unwrap();
    let mut hashes = Vec::new();
    for step in 0..STEPS {
        for (_, is_under_way) in losses.iter().filter(|(at, _)| *at == step) {
            if *is_under_way {
                simulation.step(1).unwrap();
            }
            simulation.renew().unwrap();
            assert_eq!(simulation.steps_done(), step);
        }
        simulation.step(1).unwrap();
        hashes.push(measure::state_hash(simulation.state().unwrap()));
    }
    Some(hashes)
}

fn unbroken(scene: SceneBuilder) {
    let scene = scene.backend(Backend::Vulkan).build().unwrap();
    let Some(without) = walk(&scene, &[]) else { return };
    // the fields of the ways are solved again at steps 15, 30, ...: before, at, and after that
    let with = walk(&scene, &[(14, true), (15, true), (37, false), (60, false)]).unwrap();
    let differs = without.iter().zip(&with).position(|(without, with)| without != with);
    assert_eq!(differs, None, "{}: the first step that differs", scene.scenario.name);
    gpu::assert_silent();
}

#[test]
fn a_crowd_with_a_new_device_takes_the_same_steps() {
    unbroken(Scene::load("crossing").unwrap().agents(150).seed(3));
}

#[test]
fn journeys_and_feelings_survive_a_lost_device() {
    let station = repository().join("assets/scenes/station.toml");
    unbroken(Scene::load(station.to_str().unwrap()).unwrap().agents(120));
}

#[test]
fn ways_by_the_density_survive_a_lost_device() {
    let by_density = |scenario: &mut gaitway::scenario::Scenario| {
        let (density_weight, every) = (1.0, 0.5);
        scenario.way_finding =
            WayFinding { way: gaitway::scenario::Way::Field, density_weight, every, ..WayFinding::default() };
    };
    unbroken(Scene::load("parking").unwrap().agents(150).change(by_density));
}
