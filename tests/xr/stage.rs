//! One session for many worlds and panels.
//!
//! The stage is a library: what acts on it is this test program, started a second time as [`actor`], beside a service of its
//! own and with its head and hands moved from here. What it does and finds it tells on standard error.

pub(super) mod act;
pub(super) mod asks;

use super::folder;
use super::service::{Live, Service, Stick, is_there};
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::time::Duration;

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
        // a software driver beside other work draws few pictures a second: then a change takes some of them
        let frame = change["frame_s"].as_f64().unwrap();
        assert!(change["seconds"].as_f64().unwrap() <= 1.0_f64.max(5.0 * frame), "{change}");
        assert!(change["longest_ms"].as_f64().unwrap() <= 400.0_f64.max(5e3 * frame), "{change}");
        assert!(change["frames_meanwhile"].as_u64().unwrap() >= 3, "{change}");
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
    // by stick: where the panel stands depends on where the head was when the runtime was back
    let mut head = service.head();
    let rest = Stick::default();
    for (left, right) in [
        (rest, rest),
        (Stick { stick: [1.0, 0.0], ..rest }, rest),
        (rest, rest),
        (Stick { stick: [1.0, 0.0], ..rest }, rest),
        (rest, rest),
        (rest, Stick { a: true, ..rest }),
    ] {
        head.set_hand(0, [-3.0, 1.2, -0.3], 0.0, left);
        head.set_hand(1, [3.0, 1.2, -0.3], 0.0, right);
        head.set(0.0, 0.0, [0.0, 1.6, 0.0]);
        std::thread::sleep(Duration::from_millis(700));
    }
    let (_, notes) = live.over();
    let outcome = &told(&notes, "outcome")[0];
    assert_eq!(
        (&outcome["sessions"], outcome["losses"].as_array().unwrap().len()),
        (&3.into(), 2),
        "{outcome}"
    );
    assert_eq!(told(&notes, "answer")[0]["choice"], "Cell(1)", "{notes:#?}");
}
