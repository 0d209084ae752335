//! The validation tests themselves: what they say of the crowd as it is, that they notice when it is broken, and the report.

use crate::common;
use gaitway::sim::Backend;
use gaitway::validate::diagram::{RING_RADIUS, Ring, speed_round, weidmann};
use gaitway::validate::judge::Criterion;
use gaitway::validate::scene::{Equipment, Experiment, Fault, Variant};
use gaitway::validate::{Options, Validation, chosen, report, run, tests};
use std::path::{Path, PathBuf};

fn data() -> Option<PathBuf> {
    common::data_set("crowd-juelich")?.parent().map(Path::to_owned)
}

fn quick(names: &[&str], fault: Fault) -> Validation {
    let mut stage = Equipment::new(Backend::Cpu, None).unwrap();
    stage.fault = fault;
    let tests = names.iter().map(|&name| name.to_owned()).collect();
    run(&stage, &Options { tests, is_quick: true, data: data(), ..Options::default() }, &mut |_, _| ())
        .unwrap()
}

/// A ring 3 m wide.
fn ring(density: f32, seconds: f32) -> Experiment {
    Ring { middle: RING_RADIUS, width: 3.0, density, lane: 0 }.scene(seconds).unwrap()
}

#[test]
fn people_in_a_ring_slow_down_as_weidmann_says_and_not_at_all_without_crowding() {
    let stage = Equipment::new(Backend::Cpu, None).unwrap();
    for density in [0.5, 1.5, 3.0] {
        let expected = weidmann(f64::from(density));
        for (crowding, share) in [(1.0, 1.0), (0.0, 1.34 / expected)] {
            let mut scene = ring(density, 12.0);
            scene.scenario.navigation.crowding = crowding;
            let run = scene.run(&stage, Variant::AsIs).unwrap();
            let found = speed_round(&run.tracks, 6.0) / expected;
            assert!((found / share - 1.0).abs() < 0.15, "{density}/m², crowding {crowding}: {found}");
            assert_eq!((run.outside, run.overlapping), (0, 0), "{density}/m², crowding {crowding}");
        }
    }
}

#[test]
fn the_crowd_as_it_is_passes_a_quick_run() {
    let validation = quick(&[], Fault::None);
    let failed: Vec<_> = validation.failed().collect();
    assert!(failed.is_empty(), "{failed:#?}");
    assert!(validation.judged() > 30 && validation.device.contains("CPU"));
    for skipped in &validation.skipped {
        println!("skipped: {skipped}");
    }
}

#[test]
fn draws_and_larger_crowds_stand_beside_what_is_shown() {
    let stage = Equipment::new(Backend::Cpu, None).unwrap();
    let options = Options { tests: vec!["rimea-6".into(), "rimea-1".into()], draws: 6, ..Options::default() };
    let validation = run(&stage, &options, &mut |_, _| ()).unwrap();
    let of = |name: &str| validation.outcomes.iter().find(|outcome| outcome.name == name).unwrap();
    let time = of("rimea-6.time");
    assert!(!time.is_judged() && time.draws == 6 && time.range[0] < time.range[1], "{time:?}");
    assert!(
        time.larger.len() == 2 && time.larger[0] > time.value && time.larger[1] > time.larger[0],
        "{time:?}"
    );
    // chance plays no part where one person walks: three layouts are all there is
    let alone = of("rimea-1.time");
    assert!(
        alone.is_judged() && alone.draws == 3 && alone.passes == 3 && alone.larger.is_empty(),
        "{alone:?}"
    );
    let again = run(&stage, &options, &mut |_, _| ()).unwrap();
    assert_eq!(again.outcomes, validation.outcomes, "draws side by side give the same page");
}

#[test]
fn every_test_notices_a_broken_crowd() {
    let broken = [
        (Fault::HalfSpeed, &["rimea-1", "nist-corridor", "rimea-4", "rimea-7", "juelich-corridor"][..]),
        (
            Fault::Frozen,
            &[
                "rimea-6",
                "nist-corner",
                "rimea-8",
                "rimea-15",
                "nist-counter-flow",
                "nist-congestion",
                "rimea-12b",
            ],
        ),
        (Fault::NoWalls, &["rimea-9", "rimea-12"]),
        (Fault::Alone, &["groups", "nist-groups"]),
        (Fault::Blind, &["lanes", "nist-maximum-flow", "juelich-bottleneck"]),
    ];
    // one judges nothing
    let mut seen: Vec<&str> = vec!["ucy"];
    for (fault, names) in broken {
        for &name in names {
            seen.push(name);
            let validation = quick(&[name], fault);
            let left_out = !validation.skipped.is_empty() && validation.outcomes.is_empty();
            let is_seen = validation.failed().next().is_some();
            assert!(left_out || is_seen, "{name} passes with {fault:?}: {:#?}", validation.outcomes);
        }
    }
    for test in tests::ALL {
        assert!(seen.contains(&test.name), "{} was not seen to fail", test.name);
    }
}

#[test]
fn a_scene_turned_or_moved_gives_the_same_crowd_on_the_same_grid() {
    let stage = Equipment::new(Backend::Cpu, None).unwrap();
    let scene = ring(1.0, 3.0);
    let runs = Variant::ALL.map(|variant| scene.run(&stage, variant).unwrap());
    let last = runs[0].tracks.frames.len() - 1;
    for run in &runs[1..] {
        for (a, b) in runs[0].tracks.frames[0].iter().zip(&run.tracks.frames[0]) {
            assert!(a.1.distance(b.1) < 1e-4, "{a:?} {b:?}");
        }
        let far = runs[0].tracks.frames[last].iter().zip(&run.tracks.frames[last]);
        let mean = far.map(|(a, b)| a.1.distance(b.1)).sum::<f32>() / 226.0;
        assert!(mean > 0.0 && mean < 0.1, "not the same, since rounding differs, but near: {mean} m");
    }
    assert_ne!(runs[0].hash, runs[1].hash);
}

#[test]
fn criteria_judge_and_nothing_is_never_good_enough() {
    let all = [Criterion::Within(1.0, 2.0), Criterion::AtMost(2.0), Criterion::AtLeast(1.0)];
    assert!(all.iter().all(|criterion| criterion.judge(1.5) && !criterion.judge(f64::NAN)));
    assert!(!all[0].judge(2.1) && !all[0].judge(0.9) && !all[1].judge(2.1) && !all[2].judge(0.9));
    assert_eq!(all.map(|criterion| criterion.to_string()), ["1 to 2", "at most 2", "at least 1"]);
    let error = chosen(&["rimea-99".to_owned()]).unwrap_err();
    assert!(error.hint().unwrap().contains("rimea-9"));
}

#[test]
fn the_report_says_what_fails_and_that_nothing_is_certified() {
    let folder = tempfile::tempdir().unwrap();
    let options = |names: &[&str]| Options {
        tests: names.iter().map(|&name| name.to_owned()).collect(),
        is_quick: true,
        ..Options::default()
    };
    let good = quick(&["rimea-1", "rimea-4"], Fault::None);
    let options_good = options(&["rimea-1", "rimea-4"]);
    let page = std::fs::read_to_string(report::write(folder.path(), &good, &options_good).unwrap()).unwrap();
    assert!(page.contains("no certified evacuation tool") && page.contains("judged values meet"), "{page}");
    assert!(page.contains("rimea-4.svg") && folder.path().join("rimea-4.svg").is_file(), "{page}");
    let bad = quick(&["rimea-1"], Fault::HalfSpeed);
    let page = report::page(&bad, &options(&["rimea-1"])).unwrap();
    assert!(page.contains("FAIL") && page.contains("rimea-1-quick.time"), "{page}");
}
