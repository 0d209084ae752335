//! One session for many worlds and panels.
//!
//! The stage is a library: what acts on it is this test program, started a second time as [`actor`], beside a service of its
//! own and with its head and hands moved from here. What it does and finds it tells on standard error.

pub(super) mod act;
pub(super) mod asks;

use super::folder;
use super::service::{Live, Service, is_there};
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Which act the actor plays, and where it leaves what it makes.
const ACT: &str = "GAITWAY_STAGE_ACT";
const FOLDER: &str = "GAITWAY_STAGE_FOLDER";

/// Begins an act beside a service.
pub(super) fn play(service: &Service, act: &str, folder: &Path) -> Live {
    let program = std::env::args().next().unwrap();
    let mut command = service.program(&program, &["--ignored", "--exact", "--nocapture", "stage::actor"]);
    command.env(ACT, act).env(FOLDER, folder);
    Live::start(command)
}

/// The JSON objects that an act told, of which each has one key.
pub(super) fn told(notes: &[String], key: &str) -> Vec<Value> {
    let object = |line: &String| serde_json::from_str::<Value>(line).ok()?.get(key).cloned();
    notes.iter().filter_map(object).collect()
}

/// Only when it is started by another test.
#[test]
#[ignore = "acts for the other tests"]
fn actor() {
    let Some(act) = std::env::var_os(ACT) else { return };
    let folder = PathBuf::from(std::env::var_os(FOLDER).unwrap());
    match act.to_str().unwrap() {
        "worlds" => act::worlds(&folder, 6),
        "trials" => act::worlds(&folder, 16),
        "lost" => act::lost(&folder),
        "asks" => asks::asks(&folder),
        "asked-on" => asks::asked_on(&folder),
        "stands" => asks::stands(&folder),
        "study" => super::study::act(&folder),
        act => panic!("{act}?"),
    }
}

/// Shows so many worlds: what was told, and that nothing but one session was needed.
fn worlds(name: &str, act: &str, count: usize) {
    let service = Service::start(name);
    let folder = folder(name);
    service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let (_, notes) = play(&service, act, &folder).over();
    let changes = told(&notes, "change");
    println!("{changes:#?}");
    assert_eq!(changes.len(), count, "{notes:#?}");
    for change in &changes {
        // Monado's null compositor shows 20 pictures a second; the machine has other work
        assert!(change["seconds"].as_f64().unwrap() <= 1.0, "{change}");
        assert!(change["longest_ms"].as_f64().unwrap() <= 400.0, "{change}");
        assert!(change["frames_meanwhile"].as_u64().unwrap() >= 1, "{change}");
    }
    let outcome = &told(&notes, "outcome")[0];
    assert_eq!(outcome["sessions"], 1, "{outcome}");
    assert_eq!(outcome["ended"], "the time was up");
    // what was recorded is what a session of that scene alone would have been
    for change in changes.iter().take(3) {
        let [scene, recording] = ["scene", "recording"].map(|key| change[key].as_str().unwrap());
        let run = ["xr", scene, "--agents", "40", "--backend", "cpu", "--json", "--replay", recording];
        let output = service.gaitway(&run).output().unwrap();
        let found: Value =
            serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"));
        assert!(found["equal"] == true && found["steps"].as_u64().unwrap() >= 5, "{found}");
        assert!(found["trial"].as_str().unwrap().starts_with("test, participant k7, trial "), "{found}");
    }
}

#[test]
fn one_session_shows_many_worlds_and_frames_never_stop() {
    if is_there() {
        worlds("worlds", "worlds", 6);
    }
}

#[test]
#[ignore = "takes minutes"]
fn sixteen_trials_are_one_session() {
    if is_there() {
        worlds("trials", "trials", 16);
    }
}

#[test]
fn a_runtime_that_is_killed_twice_is_found_again_and_the_same_is_shown() {
    if !is_there() {
        return;
    }
    let mut service = Service::start("stage-lost");
    let folder = folder("stage-lost");
    service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let mut live = play(&service, "lost", &folder);
    for words in ["walking in the second world", "asking"] {
        live.hear(words);
        service.kill();
        live.hear("lost the headset");
        service.restart();
        service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
        live.hear("the headset is back");
    }
    let mut head = service.head();
    asks::point(&mut head, asks::cell(1), true);
    let (_, notes) = live.over();
    let outcome = &told(&notes, "outcome")[0];
    assert_eq!(
        (&outcome["sessions"], outcome["losses"].as_array().unwrap().len()),
        (&3.into(), 2),
        "{outcome}"
    );
    assert_eq!(told(&notes, "answer")[0]["choice"], "Cell(1)", "{notes:#?}");
}
