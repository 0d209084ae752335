//! The shaders as code for the lanes of a CPU: every kernel against its twin, bit for bit, with every set of instructions that this
//! machine has, and whole crowds. No device is needed.

use gaitway::kernels::KernelId;
use gaitway::scene::Scene;
use gaitway::sim::{Backend, measure};
use gaitway::verify::cases::{self, Case};
use gaitway::verify::{Expected, Options, verify};
use std::collections::BTreeMap;

#[test]
fn every_kernel_by_lanes_agrees_with_its_twin_at_every_size() {
    let mut sets: BTreeMap<KernelId, usize> = BTreeMap::new();
    let mut judge = |case: &Case| {
        for expected in Expected::of(&case.store, &case.dispatches) {
            let found = expected.by_lanes();
            for (isa, c) in &found {
                let name = c.kernel.kernel().name;
                let off = c.compared - c.exact;
                assert_eq!(off, 0, "{}: {name} by {isa:?}: of {} {:?}", case.name, c.compared, c.first);
            }
            sets.insert(expected.kernel, found.len());
        }
    };
    judge(&cases::arithmetic(20_000));
    judge(&cases::functions(20_000));
    for (agents, seed) in [(0, 1), (1, 7), (15, 1), (16, 7), (17, 1), (65, 1), (1000, 7)] {
        for case in cases::all(agents, seed) {
            let rounds = std::iter::successors(Some(case), |case| case.clone().next_step());
            rounds.take(2).for_each(|case| judge(&case));
        }
    }
    assert_eq!(sets.len(), KernelId::ALL.len(), "a kernel without a case");
    let by_lanes: Vec<KernelId> =
        sets.iter().filter(|(_, count)| **count > 0).map(|(kernel, _)| *kernel).collect();
    for kernel in [KernelId::VelocityOrca, KernelId::VelocityRvo, KernelId::Integrate, KernelId::Palette] {
        assert!(by_lanes.contains(&kernel), "{} has no lanes", kernel.kernel().name);
    }
    assert!(by_lanes.len() >= 30, "{by_lanes:?}");
}

#[test]
fn crowds_have_the_same_hash_by_lanes_and_by_twins() {
    for (scene, people) in [("crossing", 300), ("parking", 120), ("garden", 60)] {
        let hash = |backend| {
            let scene = Scene::load(scene).unwrap().agents(people).seed(11).backend(backend);
            let mut crowd = scene.start().unwrap();
            crowd.step(120).unwrap();
            measure::state_hash(crowd.state().unwrap())
        };
        assert_eq!(hash(Backend::Cpu), hash(Backend::Reference), "{scene}");
    }
}

#[test]
fn a_verification_without_a_device_compares_lanes_with_twins() {
    let options = Options { sizes: vec![0, 65], crowd_agents: 500, crowd_steps: 40, ..Options::quick() };
    let report = verify(None, &options, &mut |_, _| ()).unwrap();
    assert!(report.pass && report.device.is_none() && report.arithmetic.is_none());
    for kernel in &report.kernels {
        assert!(kernel.sides.iter().any(|side| side.side == "lanes (portable)"), "{}", kernel.name);
        assert!(kernel.sides.iter().all(|side| side.compared > 0 && side.exact == side.compared));
    }
    let all = report.kernels.len() + report.not_compared.len();
    assert_eq!(all, KernelId::ALL.len());
    assert!(report.not_compared.contains(&"grid_scan"), "{:?}", report.not_compared);
}
