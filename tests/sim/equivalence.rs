//! Every kernel against its CPU twin on the Vulkan device, bit for bit, and whole crowds over many steps.
//!
//! Without a device the tests say so and pass, unless `GAITWAY_REQUIRE_GPU=1`.

use crate::common::gpu;
use gaitway::gpu::plan::Op;
use gaitway::gpu::{Device, Engine, Error};
use gaitway::kernels::{Access, BufferId, Dispatch, Extent, KernelId, Phase, Store};
use gaitway::scenario::{Scenario, populate};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure, order};
use gaitway::verify::cases::{
    self, animation, between, crossing, feelings, flow, gaits, hidden, journeys, step,
};
use gaitway::verify::{Comparison, compare_dispatches};
use gaitway::{avatar, library, reference};
use std::collections::BTreeSet;
use std::sync::{Arc, Mutex, PoisonError};

/// One test at a time: the messages of the validation layer are common to the process.
static ONE: Mutex<()> = Mutex::new(());

/// Runs a test on the device and asserts that the validation layer has said nothing, leaks included.
fn on_device(test: impl FnOnce(&Arc<Device>)) {
    let _one = ONE.lock().unwrap_or_else(PoisonError::into_inner);
    let Some(device) = gpu::device() else { return };
    test(&device);
    drop(device);
    gpu::assert_silent();
}

fn assert_exact(what: &str, comparisons: &[Comparison]) {
    for c in comparisons {
        let name = c.kernel.kernel().name;
        assert!(
            c.exact == c.compared,
            "{what}: {name}: {} of {} differ, first {:?}",
            c.compared - c.exact,
            c.compared,
            c.first
        );
    }
}

#[test]
fn what_does_not_fit_its_buffer_is_refused_and_the_engine_goes_on() {
    on_device(|device| {
        let store = step::crowd_with(0, 65, 1);
        let mut engine = Engine::new(device, &store, &[KernelId::Integrate]).unwrap();
        let longer = Store { position: vec![[1.0; 2]; 100_100], ..store.clone() };
        let all = [BufferId::Position];
        let is_refused = |error: Error| {
            let Error::Contents { name, bytes, size } = error else { panic!("{error}") };
            assert_eq!((name, bytes), ("position", 800_800), "of {size}");
        };
        is_refused(engine.upload(&longer, &all).unwrap_err());
        is_refused(engine.download(&mut longer.clone(), &all).unwrap_err());
        for bytes in [0, 6, 4096, 70_000] {
            let set = engine.run(&[Op::Set(BufferId::Step)], |_, _| vec![0; bytes], false);
            assert!(matches!(set, Err(Error::Contents { name: "step", .. })), "{bytes}: {set:?}");
        }
        let integrate = |extent| Op::Dispatch(Dispatch::new(Phase::Integrate, extent));
        for (buffer, element) in
            [(BufferId::Unsolved, 0), (BufferId::Position, 200), (BufferId::Step, u32::MAX)]
        {
            let run = engine.run(&[integrate(Extent::Indirect(buffer, element))], |_, _| Vec::new(), false);
            assert!(matches!(run, Err(Error::Arguments { kernel: "integrate", .. })), "{run:?}");
        }
        let mut back = store.clone();
        back.position.fill([f32::NAN; 2]);
        engine.download(&mut back, &all).unwrap();
        assert!(back.bytes(all[0]) == store.bytes(all[0]), "what was refused has changed nothing");
        engine.replace(&longer, &all).unwrap();
        engine.run(&[integrate(Extent::Invocations(65))], |_, _| Vec::new(), false).unwrap();
    });
}

#[test]
fn every_kernel_agrees_with_its_twin_bit_for_bit_at_every_size() {
    on_device(|device| {
        println!("{}: arithmetic {}", device.describe(), device.arithmetic().unwrap());
        let mut seen = BTreeSet::new();
        for case in [cases::arithmetic(20_000), cases::functions(20_000)] {
            let found = compare_dispatches(device, &case.store, &case.dispatches).unwrap();
            assert_exact(&case.name, &found);
            seen.extend(found.iter().map(|c| c.kernel));
        }
        // each draws several seeds from its own
        for (agents, seed) in [(0, 1), (1, 7), (63, 1), (64, 7), (65, 1), (1000, 7)] {
            for case in cases::all(agents, seed) {
                let rounds = std::iter::successors(Some(case), |case| case.clone().next_step());
                for (round, case) in rounds.take(3).enumerate() {
                    let found = compare_dispatches(device, &case.store, &case.dispatches).unwrap();
                    assert_exact(&format!("{}, round {round}", case.name), &found);
                    seen.extend(found.iter().map(|c| c.kernel));
                }
            }
        }
        assert_eq!(seen, KernelId::ALL.into_iter().collect(), "a kernel without a case");
    });
}

#[test]
fn code_for_one_crowd_gives_way_where_the_crowd_changes() {
    on_device(|device| {
        let mut plain = step::crowd_with(0, 1000, 7);
        let kernels = KernelId::ALL.map(|kernel| (kernel, order::step_dispatches(&plain.step)));
        let is_due = |(kernel, all): (KernelId, Vec<Dispatch>)| {
            all.iter().any(|dispatch| dispatch.kernel() == kernel).then_some(kernel)
        };
        let kernels: Vec<KernelId> = kernels.into_iter().filter_map(is_due).collect();
        // an engine for people who do not look at how crowded it is, and then they do
        plain.step.crowding = 0.0;
        let mut engine = Engine::new(device, &plain, &kernels).unwrap();
        let mut crowded = plain.clone();
        (crowded.step.crowding, crowded.step.crowding_reach) = (1.0, 3.0);
        assert_ne!(plain.step.contents(), crowded.step.contents());
        let mut walked = Vec::new();
        for store in [&crowded, &plain] {
            let dispatches = order::step_dispatches(&store.step);
            engine.upload(store, &BufferId::ALL).unwrap();
            let ops: Vec<Op> = dispatches.iter().copied().map(Op::Dispatch).collect();
            engine.run(&ops, |_, _| Vec::new(), false).unwrap();
            let (mut device, mut host) = (store.clone(), store.clone());
            engine.download(&mut device, &[BufferId::NewVelocity, BufferId::StepCount]).unwrap();
            dispatches.iter().for_each(|d| reference::run(d.phase, &mut host, d.immediate));
            let velocities = BufferId::NewVelocity;
            assert!(device.bytes(velocities) == host.bytes(velocities), "{:?}", store.step.crowding);
            assert_eq!(device.step_count, [store.step.step_index + 1]);
            walked.push(device.new_velocity);
        }
        assert!(walked[0] != walked[1], "the crowd changes what they do");
    });
}

#[test]
fn steps_submitted_together_are_counted_where_kernels_read_the_number() {
    on_device(|device| {
        let mut store = step::crowd_with(0, 65, 1);
        store.step.step_index = 41;
        let mut engine = Engine::new(device, &store, &[KernelId::Integrate]).unwrap();
        let ops = [Op::CountStep, Op::Dispatch(Dispatch::of(Phase::Integrate, 65))];
        engine.repeat(&[], &ops, 3).unwrap();
        engine.finish().unwrap();
        engine.download(&mut store, &[BufferId::Step, BufferId::StepCount]).unwrap();
        assert_eq!((store.step.step_index, store.step_count[0]), (44, 44));
    });
}

#[test]
fn the_comparison_notices_one_bit() {
    on_device(|device| {
        let (crowd, bodies, walks) =
            (journeys::journeys(65, 3), animation::animation(65, 3), gaits::gaits(65, 3));
        let of_model = |model| step::crowd_with(model, 65, 3);
        let afar = animation::animation(65, 1);
        let ways = flow::fields(300, 3);
        let behind = hidden::hidden(300, 3);
        let (moved, snapshots) = (feelings::feelings(65, 1), between::between(65, 1));
        let stages = vec![
            (order::step_dispatches(&moved.step), moved),
            (order::step_dispatches(&crowd.step), crowd),
            (order::step_dispatches(&of_model(1).step), of_model(1)),
            (order::frame_dispatches(&bodies.frame), bodies),
            (order::frame_dispatches(&afar.frame), afar), // pose_far
            (gaits::dispatches(&walks), walks),           // gait_features
            (hidden::dispatches(&behind), behind),
            (flow::dispatches(&ways), ways),
            (between::dispatches(&snapshots), snapshots),
        ];
        for (dispatches, mut store) in stages {
            for dispatch in &dispatches {
                reference::run(dispatch.phase, &mut store, dispatch.immediate);
            }
            for kernel in KernelId::ALL.into_iter().filter(|k| dispatches.iter().any(|p| p.kernel() == *k)) {
                let group: Vec<_> = dispatches.iter().copied().filter(|p| p.kernel() == kernel).collect();
                let found = gaitway::verify::compare_tampered(device, &store, &group).unwrap();
                let caught = found.iter().any(|c| c.exact < c.compared);
                assert!(caught, "{}: one bit changed unnoticed", kernel.kernel().name);
            }
        }
    });
}

fn cast() -> (library::GaitLibrary, AvatarSet) {
    let library = library::GaitLibrary::built_in().unwrap();
    let avatars = avatar::Sex::ALL.map(avatar::generated).to_vec();
    let cast = AvatarSet::new(library.gaits(), avatars).unwrap();
    (library, cast)
}

fn crowd_hash(agents: u32, steps: u32, backend: Backend) -> u64 {
    let (library, cast) = cast();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let mut simulation = Simulation::new(&scenario, &crowd, &cast, backend, None).unwrap();
    simulation.step(steps).unwrap();
    measure::state_hash(simulation.state().unwrap())
}

#[test]
fn a_crowd_of_the_crossing_is_the_same_on_both_backends_and_from_run_to_run() {
    on_device(|_| {
        let on_vulkan = crowd_hash(2000, 100, Backend::Vulkan);
        assert_eq!(on_vulkan, crowd_hash(2000, 100, Backend::Vulkan), "run to run");
        assert_eq!(on_vulkan, crowd_hash(2000, 100, Backend::Cpu), "Vulkan and CPU");
    });
}

#[test]
fn one_thread_gives_the_crowd_of_many() {
    let run = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| crowd_hash(500, 60, Backend::Cpu))
    };
    assert_eq!(run(1), run(3));
}

#[test]
fn a_dense_crowd_of_ten_thousand_is_the_same_on_both_backends() {
    on_device(|_| {
        let hash = |backend| {
            let mut simulation =
                Simulation::from_store(crossing::crossing(10_000, 0.8), backend, None).unwrap();
            simulation.step(60).unwrap();
            measure::state_hash(simulation.state().unwrap())
        };
        assert_eq!(hash(Backend::Vulkan), hash(Backend::Cpu));
    });
}

#[test]
fn crowds_that_are_not_even_are_the_same_on_all_backends() {
    on_device(|_| {
        let is_uneven =
            |case: &cases::Case| ["clustered", "storeys"].iter().any(|w| case.name.starts_with(w));
        let uneven: Vec<_> = cases::all(1_000, 1).into_iter().filter(is_uneven).collect();
        assert_eq!(uneven.len(), 4, "two crowds, two models");
        for case in uneven {
            let [vulkan, lanes, twins] = [Backend::Vulkan, Backend::Cpu, Backend::Reference].map(|backend| {
                let mut simulation = Simulation::from_store(case.store.clone(), backend, None).unwrap();
                simulation.step(60).unwrap();
                measure::state_hash(simulation.state().unwrap())
            });
            assert_eq!((vulkan, lanes), (twins, twins), "{}", case.name);
        }
    });
}

#[test]
fn agents_without_bodies_go_where_those_with_bodies_go() {
    on_device(|_| {
        let with_bodies = crossing::crossing(1_000, 1.0);
        let bare = crossing::bare_crossing(1_000, 1.0);
        let walked = |store: &Store, backend| {
            let mut simulation = Simulation::from_store(store.clone(), backend, None).unwrap();
            simulation.step(60).unwrap();
            let state = simulation.state().unwrap();
            assert!(state.stance.len() == store.stance.len() && state.heading.len() == store.heading.len());
            bytemuck::cast_slice::<_, u32>(&[&state.position[..], &state.velocity].concat()).to_vec()
        };
        let want = walked(&with_bodies, Backend::Reference);
        for backend in [Backend::Vulkan, Backend::Cpu, Backend::Reference] {
            assert_eq!(walked(&bare, backend), want, "{backend:?}");
        }
    });
}

#[test]
fn every_buffer_a_kernel_writes_is_compared() {
    // what compare_dispatches looks at is derived from the reflected access: a kernel that writes nothing would be blind
    for kernel in KernelId::ALL {
        let writes = kernel.kernel().bindings.iter().filter(|b| b.access == Access::Write).count();
        assert!(writes > 0, "{} writes nothing", kernel.kernel().name);
    }
}
