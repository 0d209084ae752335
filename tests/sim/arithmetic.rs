//! Careful division and root, and devices whose own are wrong.
//!
//! `cargo test --test sim arithmetic:: -- --ignored` runs the whole proof.

use crate::common::gpu;
use gaitway::gpu::arithmetic::{Fault, Part, Setting, Wanted};
use gaitway::gpu::{Device, Probe, Validation};
use gaitway::kernels::layout::Stance;
use gaitway::kernels::probe::Primitive;
use gaitway::kernels::{BufferId, KernelId, Store};
use gaitway::scenario::{Scenario, populate};
use gaitway::sim::{AvatarSet, Backend, Simulation, measure, setup};
use gaitway::verify::careful::{MOST_OFF, is_quotient_wrong, is_root_wrong, wrong_quotients, wrong_roots};
use gaitway::verify::cases::crossing::crossing;
use gaitway::verify::{Options, cases, compare_dispatches, verify};
use gaitway::{avatar, library};
use std::sync::Arc;

/// Zeros, infinities, NaN, ones, the ends of the subnormal and the normal numbers, of both signs.
fn special() -> Vec<f32> {
    let sizes =
        [0, 1, 2, 0x7f_ffff, 0x80_0000, 0x80_0001, 0x3f80_0000, 0x3f80_0001, 0x3f7f_ffff, 0x4000_0000];
    let more = [0x7f7f_ffff, 0x7f00_0000, 0x0100_0000, 0x7f80_0000, 0x7f80_0001, 0x7fc0_0000];
    sizes.into_iter().chain(more).flat_map(|bits| [bits, bits | 0x8000_0000]).map(f32::from_bits).collect()
}

#[test]
fn careful_division_and_root_are_correctly_rounded_whatever_the_guess() {
    for a in special() {
        for b in special() {
            for number in 0..=2 * MOST_OFF as u64 {
                assert!(!is_quotient_wrong([a, b], number), "{a:e} / {b:e}, guess {number}");
            }
        }
        assert!(!is_root_wrong(a), "root of {a:e}");
    }
    assert_eq!(wrong_quotients(0..2_000_000), 0);
    for first in (0..0x8000_0000).step_by(0x10_0000) {
        assert_eq!(wrong_roots(first..first + 500), 0, "from the bits {first:#x}");
    }
}

#[test]
#[ignore = "takes a minute"]
fn the_whole_proof_finds_no_wrong_root_and_no_wrong_quotient() {
    assert_eq!(wrong_roots(0..0x8000_0000), 0, "roots of all non-negative floats");
    assert_eq!(wrong_quotients(0..100_000_000), 0, "quotients");
    for mantissa in [0x80_0000, 0x80_0001, 0xff_ffff, 0xff_fffe, 0xb5_04f3, 0xc0_ffee] {
        let b = f32::from_bits(mantissa + 0x3f00_0000);
        let wrong = |bits: &u32| is_quotient_wrong([f32::from_bits(*bits), b], u64::from(*bits));
        assert_eq!((0x3f80_0000..0x4000_0000).filter(wrong).count(), 0, "all mantissas over {b}");
    }
}

/// A device with these faults.
fn device(wanted: Wanted, faults: &[Fault]) -> Option<Arc<Device>> {
    let validation = Validation::from_environment().unwrap();
    let setting = Setting { wanted, faults: faults.to_vec() };
    gpu::on_device(Device::open_with(None, validation, setting).map_err(gaitway::Error::from))
}

#[test]
fn a_device_is_probed_and_what_is_wrong_with_it_is_computed_carefully() {
    let Some(own) = device(Wanted::Auto, &[]) else { return };
    // a device may be wrong without our help
    let own_parts = own.arithmetic().unwrap().careful();
    let own_probe = Probe::of_native(&own).unwrap();
    let expected: [(&[Fault], &[Part]); 5] = [
        (&[], &[]),
        (&[Fault::By1], &[Part::Division, Part::SquareRoot]),
        (&[Fault::By3], &[Part::Division, Part::SquareRoot]),
        (&[Fault::Zeros], &[Part::Order]),
        (&[Fault::Flush], &[]),
    ];
    for (faults, careful) in expected {
        let Some(device) = device(Wanted::Auto, faults) else { return };
        let with_own = |part: &Part| careful.contains(part) || own_parts.contains(part);
        let careful: Vec<_> = Part::ALL.iter().copied().filter(with_own).collect();
        assert_eq!(device.arithmetic().unwrap().careful(), careful, "{faults:?}");
        let native = Probe::of_native(&device).unwrap();
        let flushes = own_probe.flushes_subnormals || faults == [Fault::Flush];
        assert_eq!(native.flushes_subnormals, flushes, "{faults:?}: {native}");
        let taken = Probe::of(&device, device.arithmetic().unwrap(), 65_536).unwrap();
        assert!(taken.is_exact(), "{faults:?}: {taken}");
    }
    let by = |fault| device(Wanted::Auto, &[fault]).map(|device| Probe::of_native(&device).unwrap());
    let Some((one, three)) = by(Fault::By1).zip(by(Fault::By3)) else { return };
    assert_eq!(one.inexact.get(&Primitive::Division), Some(&1));
    assert_eq!(three.inexact.get(&Primitive::Division), Some(&3));
    gpu::assert_silent();
}

#[test]
fn careful_code_gives_the_bits_of_an_exact_device_to_every_case_of_the_probe() {
    let Some(device) = device(Wanted::Careful, &[Fault::By3]) else { return };
    assert_eq!(device.arithmetic().unwrap().careful(), Part::ALL);
    let probe = Probe::of(&device, device.arithmetic().unwrap(), 1 << 18).unwrap();
    assert!(probe.is_exact(), "{probe}");
    gpu::assert_silent();
}

#[test]
fn verification_passes_on_a_device_that_is_wrong_and_says_how_it_was_computed() {
    let Some(device) = device(Wanted::Auto, &[Fault::By3, Fault::Zeros]) else { return };
    // few kernels by themselves; the crowd's steps have most of the others
    let alone = [KernelId::Arithmetic, KernelId::Numerics, KernelId::GaitFeatures];
    let without = KernelId::ALL.into_iter().filter(|kernel| !alone.contains(kernel)).collect();
    let options =
        Options { sizes: vec![65], crowd_agents: 300, crowd_steps: 40, without, ..Options::quick() };
    let report = verify(Some(&device), &options, &mut |_, _| ()).unwrap();
    let failed: Vec<_> = report.kernels.iter().filter(|kernel| !kernel.pass).collect();
    assert!(report.pass, "{failed:#?}, {:?}", report.crowd);
    let arithmetic = report.arithmetic.unwrap();
    assert_eq!(arithmetic.taken, "careful (division, square root, minimum and maximum)");
    assert!(!arithmetic.native_is_exact && arithmetic.native.contains("division by 3 ULP"), "{arithmetic:?}");
}

#[test]
fn a_verification_names_the_step_and_the_word_in_which_a_crowd_first_differs() {
    let Some(device) = device(Wanted::Native, &[Fault::By3]) else { return };
    let alone = [KernelId::Arithmetic, KernelId::Numerics, KernelId::GaitFeatures];
    let without = KernelId::ALL.into_iter().filter(|kernel| !alone.contains(kernel)).collect();
    let options =
        Options { sizes: vec![65], crowd_agents: 300, crowd_steps: 40, without, ..Options::quick() };
    let crowd = verify(Some(&device), &options, &mut |_, _| ()).unwrap().crowd;
    assert_eq!((crowd.pass, crowd.differs_by_step, crowd.steps), (false, Some(1), 20), "{crowd:?}");
    assert_eq!(crowd.differs, ["device"]);
    let [first] = &crowd.first[..] else { panic!("{crowd:?}") };
    assert!(first.starts_with("device: ") && first.contains(": twin ") && first.contains("here "), "{first}");
}

#[test]
fn one_unit_in_few_careful_results_is_caught() {
    let differing = |wanted, fault| {
        let device = device(wanted, &[fault])?;
        let mut found = Vec::new();
        for case in [cases::arithmetic(8_000), cases::crowd(300, 1, 0)] {
            let compared = compare_dispatches(&device, &case.store, &case.dispatches).unwrap();
            found.extend(compared.iter().filter(|c| c.exact < c.compared).map(|c| c.kernel.kernel().name));
        }
        Some(found)
    };
    for (wanted, fault) in [(Wanted::Native, Fault::By1), (Wanted::Careful, Fault::Slip)] {
        let Some(differing) = differing(wanted, fault) else { return };
        assert!(["arithmetic", "velocity_orca"].iter().all(|name| differing.contains(name)), "{differing:?}");
    }
    assert_eq!(differing(Wanted::Auto, Fault::By1), Some(Vec::new()));
}

#[test]
fn a_crowd_is_the_same_on_a_wrong_device_and_on_the_cpu() {
    let library = library::GaitLibrary::built_in().unwrap();
    let avatars = avatar::Sex::ALL.map(avatar::generated).to_vec();
    let cast = AvatarSet::new(library.gaits(), avatars).unwrap();
    let scenario = Scenario::builtin("crossing").unwrap().with_agents(500);
    let crowd = populate(&scenario, |emotion| library.gaits_for(emotion)).unwrap();
    let mut cpu = Simulation::new(&scenario, &crowd, &cast, Backend::Cpu, None).unwrap();
    let start = setup::store(&scenario, &scenario.geometry(), &crowd, &cast);
    cpu.step(100).unwrap();
    let want = measure::state_hash(cpu.state().unwrap());
    for faults in [&[Fault::By1][..], &[Fault::By3, Fault::Zeros, Fault::Flush]] {
        let Some(device) = device(Wanted::Auto, faults) else { return };
        let mut gpu = Simulation::on_device(start.clone(), &device).unwrap();
        gpu.step(100).unwrap();
        assert_eq!(measure::state_hash(gpu.state().unwrap()), want, "{faults:?}");
    }
}

/// The words of a state that are neither 0 nor normal numbers, by buffer.
fn subnormal(store: &Store) -> Vec<String> {
    const PHASE: usize = std::mem::offset_of!(Stance, phase) / 4; // a whole number
    let state = [
        BufferId::Position,
        BufferId::Velocity,
        BufferId::Heading,
        BufferId::Elevation,
        BufferId::Stance,
        BufferId::Feeling,
    ];
    let of = |buffer: BufferId| {
        let words = bytemuck::cast_slice::<u8, u32>(store.bytes(buffer));
        let is_subnormal = |bits: u32| f32::from_bits(bits).is_subnormal();
        let stride = buffer.stride() / 4;
        let is_phase = move |at: usize| buffer == BufferId::Stance && at % stride == PHASE;
        let found = words.iter().enumerate().filter(move |(at, bits)| !is_phase(*at) && is_subnormal(**bits));
        found
            .map(move |(at, bits)| format!("{}[{}].{} is {bits:#x}", buffer.name(), at / stride, at % stride))
    };
    state.into_iter().flat_map(of).collect()
}

#[test]
fn nothing_fades_into_numbers_that_devices_take_for_zero() {
    let mut store = cases::everything(1_000, 1);
    store.step.model = 0;
    let mut crowd = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    for step in 0..60 {
        crowd.step(1).unwrap();
        assert_eq!(subnormal(crowd.state().unwrap()), Vec::<String>::new(), "step {step}");
    }
    // what is left of a lean halves in a quarter of a second: people who stand have 126 halvings behind them
    let mut crowd = Simulation::from_store(crossing(100, 2.0), Backend::Cpu, None).unwrap();
    crowd.step(60).unwrap();
    let mut store = crowd.state().unwrap().clone();
    store.body.iter_mut().for_each(|body| body.preferred_speed = 0.0);
    let mut crowd = Simulation::from_store(store, Backend::Cpu, None).unwrap();
    for second in 0..40 {
        crowd.step(30).unwrap();
        assert_eq!(subnormal(crowd.state().unwrap()), Vec::<String>::new(), "second {second}");
    }
}

#[test]
fn a_crowd_of_everything_is_the_same_where_subnormal_numbers_are_flushed() {
    let Some(device) = device(Wanted::Auto, &[Fault::Flush]) else { return };
    let store = cases::everything(1_000, 1);
    let mut cpu = Simulation::from_store(store.clone(), Backend::Cpu, None).unwrap();
    let mut gpu = Simulation::on_device(store, &device).unwrap();
    for step in 0..60 {
        cpu.step(1).unwrap();
        gpu.step(1).unwrap();
        let [want, found] = [&mut cpu, &mut gpu].map(|crowd| measure::state_hash(crowd.state().unwrap()));
        assert_eq!(found, want, "step {step}");
    }
}
