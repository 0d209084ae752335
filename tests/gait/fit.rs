//! Gaits as a mean pose and harmonics, and the walker's classes against E-Gait's.

use crate::common::{data_set, program};
use gaitway::Emotion;
use gaitway::gait::fit::contrast::{Verdict, compare};
use gaitway::gait::fit::{self, FRAMES, HARMONICS, HarmonicGait, fit};
use gaitway::gait::{Gait, Joint, import, stride};
use gaitway::library::GaitLibrary;
use gaitway::scenario::{Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, setup};

fn built_in() -> Vec<Gait> {
    GaitLibrary::built_in().unwrap().gaits().to_vec()
}

#[test]
fn four_harmonics_hold_a_walk_to_half_a_centimetre_in_less_than_1000_bytes() {
    let mut previous = f32::MAX;
    for harmonics in 0..=8 {
        let errors: Vec<_> =
            built_in().iter().map(|gait| fit(gait, harmonics).unwrap().error(gait)).collect();
        let worst = errors.iter().map(|error| error.rms).fold(0.0, f32::max);
        let largest = errors.iter().map(|error| error.largest).fold(0.0, f32::max);
        println!(
            "{harmonics} harmonics: RMS at most {:.2} cm, any joint {:.2} cm",
            100.0 * worst,
            100.0 * largest
        );
        assert!(worst < previous, "more harmonics fit better");
        previous = worst;
        if harmonics == HARMONICS {
            assert!(worst < 0.005 && largest < 0.04);
        }
    }
    let fitted = fit(&built_in()[0], HARMONICS).unwrap();
    assert_eq!(fitted.bytes(), 9 * 48 * 2 + 12);
    assert!(fit::to_bytes(std::slice::from_ref(&fitted)).len() < 1000);
}

#[test]
fn as_many_harmonics_as_frames_determine_give_the_gait_back() {
    let gait = &built_in()[3];
    let fitted = fit(gait, 31).unwrap();
    // 64 frames have one number more than 31 harmonics, the fastest wiggle; a walk hardly has it.
    assert!(fitted.error(gait).largest < 5e-4, "{:?}", fitted.error(gait));
    let back = fitted.to_gait(64);
    assert_eq!(back.label, gait.label);
    assert!((back.cycle_time() - gait.cycle_time()).abs() < 1e-5 && (back.speed - gait.speed).abs() < 1e-6);
}

#[test]
fn a_fitted_library_is_read_back_and_walks() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).display().to_string();
    let run = |arguments: &[&str]| {
        let output = program().args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8_lossy(&output.stdout).into_owned()
    };
    for name in ["fitted.json", "fitted.gwh"] {
        let said = run(&["gait", "fit", "--harmonics", "3", "--out", &path(name)]);
        assert!(said.contains("684") && said.contains("written") && said.contains("cm"), "{said}");
        run(&["gait", "fit", &path(name), "--force", "--out", &path("back.glb")]);
        let library = GaitLibrary::load_glb(path("back.glb")).unwrap();
        assert_eq!(library.counts(), GaitLibrary::built_in().unwrap().counts());
        assert!(library.gaits().iter().all(|gait| gait.poses.len() == FRAMES));
        let lowest = |gait: &Gait| {
            let feet = [Joint::LeftFoot as usize, Joint::RightFoot as usize];
            gait.poses.iter().flat_map(|pose| feet.map(|foot| pose[foot].y)).fold(f32::MAX, f32::min)
        };
        assert!(library.gaits().iter().all(|gait| lowest(gait).abs() < 1e-6), "feet touch the ground");
        let scenario = Scenario::builtin("garden").unwrap().with_agents(12);
        let crowd = populate_from(&scenario, &library).unwrap();
        let bodies = gaitway::avatar::Sex::ALL.map(gaitway::avatar::generated).to_vec();
        let cast = AvatarSet::new(library.gaits(), bodies).unwrap();
        let store = setup::store(&scenario, &scenario.geometry(), &crowd, &cast);
        let mut simulation = Simulation::from_store(store, Backend::Cpu, None).unwrap();
        let start = simulation.state().unwrap().position.clone();
        simulation.step(30).unwrap();
        let moved = simulation.state().unwrap().position.iter().zip(&start);
        let moved = moved.filter(|(a, b)| (a[0] - b[0]).hypot(a[1] - b[1]) > 0.2).count();
        assert!(moved >= 10, "{moved} of 12 walked");
    }
    let refused = program().args(["gait", "fit", "--out", &path("a.bvh")]).output();
    assert!(String::from_utf8_lossy(&refused.unwrap().stderr).contains(".gwh"));
}

fn egait() -> Option<Vec<Vec<Gait>>> {
    let folder = data_set("egait")?;
    let gaits = |name: &str| {
        let takes = import::import_file(&folder.join(name)).unwrap();
        takes.iter().filter_map(|take| stride::best(take).ok()).collect()
    };
    Some(["bml.csv", "cmu.csv", "ewalk.csv", "ict.csv", "sig.csv"].map(gaits).to_vec())
}

#[test]
fn no_class_of_the_walker_differs_from_neutral_against_e_gait() {
    let Some(sources) = egait() else { return };
    let found = compare(&sources).unwrap();
    for contrast in &found {
        println!(
            "{:18} {:8} E-Gait {:7.3} +- {:.3} ({}), walker {:7.3}: {:?}",
            contrast.measure,
            contrast.emotion,
            contrast.recorded,
            contrast.error,
            contrast.gaits,
            contrast.walker,
            contrast.verdict
        );
        assert_ne!(contrast.verdict, Verdict::Opposite, "{contrast:?}");
    }
    // Clear in the data, and the walker differs in the same direction.
    for (measure, emotion) in [
        ("hand speed", Emotion::Happy),
        ("hand speed", Emotion::Angry),
        ("hand speed", Emotion::Sad),
        ("cycle time", Emotion::Happy),
        ("cycle time", Emotion::Angry),
        ("cycle time", Emotion::Sad),
        ("stride length", Emotion::Angry),
        ("head angle, deg", Emotion::Sad),
    ] {
        let contrast = found.iter().find(|c| c.measure == measure && c.emotion == emotion).unwrap();
        let none = f64::from(u8::from(contrast.is_ratio));
        let (people, walker) = (contrast.recorded - none, contrast.walker - none);
        assert!(people.abs() >= 2.0 * contrast.error && people * walker > 0.0, "{contrast:?}");
    }
    // As much as in people: half of them yet; the others are too strong.
    let within = found.iter().filter(|contrast| contrast.verdict == Verdict::Within).count();
    assert!(within >= 12, "{within} of {} within two standard errors", found.len());
}

#[test]
fn recorded_gaits_fit_within_a_centimetre() {
    let Some(sources) = egait() else { return };
    let gaits: Vec<&Gait> = sources.iter().flatten().collect();
    let fits: Vec<(HarmonicGait, &Gait)> =
        gaits.iter().map(|gait| (fit(gait, HARMONICS).unwrap(), *gait)).collect();
    let mut errors: Vec<f32> = fits.iter().map(|(fitted, gait)| fitted.error(gait).rms).collect();
    errors.sort_by(f32::total_cmp);
    let (middle, most) = (errors[errors.len() / 2], errors[errors.len() - 1]);
    println!("{} gaits: RMS median {:.2} cm, at most {:.2} cm", errors.len(), 100.0 * middle, 100.0 * most);
    assert!(middle < 0.006 && errors[errors.len() * 95 / 100] < 0.012);
}
