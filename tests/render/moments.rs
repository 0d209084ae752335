//! Pictures between the steps: what they show lies between two moments of the crowd, and the crowd is none the worse for it.

use crate::common::gpu;
use gaitway::avatar::{self, Sex};
use gaitway::kernels::{BufferId, Store};
use gaitway::library::GaitLibrary;
use gaitway::scenario::{Scenario, populate_from};
use gaitway::sim::snapshots::{Snapshots, make_room};
use gaitway::sim::{AvatarSet, Backend, Simulation, bodies, measure, setup};
use glam::Vec2;

/// The crossing with bodies and room for two moments.
fn crowd() -> Store {
    let library = GaitLibrary::built_in().unwrap();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(200);
    let crowd = populate_from(&scenario, &library).unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(avatar::generated).to_vec()).unwrap();
    let mut store = setup::store(&scenario, &scenario.geometry(), &crowd, &cast);
    bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    make_room(&mut store);
    store.frame.planes = [[0.0, 0.0, 0.0, 1.0]; 12]; // everyone is in view
    store
}

#[test]
fn pictures_between_steps_show_what_lies_between_and_change_nothing() {
    let made = Simulation::from_store(crowd(), Backend::Vulkan, None);
    let Some(mut drawn) = gpu::on_device(made) else { return };
    let mut plain = Simulation::from_store(crowd(), Backend::Cpu, None).unwrap();
    let agents = plain.store().step.agent_count;
    let (mut moments, mut before) = (Snapshots::default(), plain.state().unwrap().clone());
    let mut keep = Some(moments.keep(0.0));
    let mut between = moments.at(0.0, agents);
    drawn.animate_between(before.frame, between, keep.take()).unwrap();
    drawn.restore(between).unwrap();
    for step in 1..=40 {
        plain.step(1).unwrap();
        drawn.step(1).unwrap();
        let after = plain.state().unwrap().clone();
        let (then, now) = (moments.newest().unwrap(), drawn.time());
        keep = Some(moments.keep(now));
        for share in [0.25, 0.5, 0.75_f32] {
            between = moments.at(then + (now - then) * f64::from(share), agents);
            assert!((between.share - share).abs() < 1e-4);
            drawn.animate_between(after.frame, between, keep.take()).unwrap();
            let shown = drawn.read(&[BufferId::Position, BufferId::Heading, BufferId::Stance]).unwrap();
            for agent in 0..agents as usize {
                let at = |store: &Store| Vec2::from_array(store.position[agent]);
                let want = at(&before).lerp(at(&after), share);
                assert!(at(shown).distance(want) < 1e-4, "step {step}, {agent}: {} not {want}", at(shown));
                let way = after.stance[agent].phase.wrapping_sub(before.stance[agent].phase) as f32;
                let gone = shown.stance[agent].phase.wrapping_sub(before.stance[agent].phase) as f32;
                assert!((gone - share * way).abs() <= 0.001 * way + 512.0, "step {step}, {agent}");
                let turned = |store: &Store| store.heading[agent] - before.heading[agent];
                let wrap = |turn: f32| (turn + 3.0).rem_euclid(std::f32::consts::TAU) - 3.0;
                assert!((wrap(turned(shown)) - share * wrap(turned(&after))).abs() < 1e-4, "step {step}");
            }
            drawn.restore(between).unwrap();
        }
        before = after;
    }
    let hash = |simulation: &mut Simulation| measure::state_hash(simulation.state().unwrap());
    assert_eq!(hash(&mut drawn), hash(&mut plain));
    drop(drawn);
    gpu::assert_silent();
}
