//! A session with a moving head, recorded, and replayed without a headset.

use super::service::{GPU_ENV, Live, PATIENCE, Service, is_there, until};
use super::{folder, recorded, steps};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

/// What the sessions are of.
const CROWD: [&str; 4] = ["xr", "crossing", "--agents", "300"];

/// Moves the head until a recording has what it should.
fn walk_until(mut at: impl FnMut(f32), is_there: impl Fn() -> bool) {
    let begin = Instant::now();
    while !is_there() {
        assert!(begin.elapsed() < PATIENCE, "the recording never has what it should");
        at(begin.elapsed().as_secs_f32());
        std::thread::sleep(Duration::from_millis(30));
    }
}

/// Places in a recording's steps from one on.
fn places(path: &Path, from: usize) -> usize {
    let all: BTreeSet<[String; 2]> =
        steps(path).iter().skip(from).map(|step| [step[1].clone(), step[2].clone()]).collect();
    all.len()
}

/// Begins to record a session in which the head walks in circles, until it was in so many places.
fn begin(service: &Service, path: &Path, count: usize) -> Live {
    let kept = ["--eye-size", "160x160", "--record", path.to_str().unwrap(), "--json"];
    let mut head = service.head();
    let mut live = Live::start(service.gaitway(&[&CROWD[..], &kept].concat()));
    live.hear("the headset shows the crowd");
    let circle = |turn: f32| head.set(turn.to_degrees(), -10.0, [0.8 * turn.sin(), 1.6, -0.8 * turn.cos()]);
    walk_until(circle, || places(path, 0) > count);
    live
}

/// Replays it on the CPU.
fn replay_as(path: &Path, more: &[&str]) -> Output {
    let mut command = Command::new(GPU_ENV);
    command
        .arg(env!("CARGO_BIN_EXE_gaitway"))
        .args(CROWD)
        .args(["--backend", "cpu", "--json", "--replay"])
        .arg(path);
    command.args(more).output().unwrap()
}

/// Replays it: what came of it, and whether the program was content.
fn replay(path: &Path) -> (Value, bool) {
    let output = replay_as(path, &[]);
    let out = String::from_utf8_lossy(&output.stdout);
    let found = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {output:?}"));
    (found, output.status.success())
}

/// Replays it as something else: the error.
fn refused(path: &Path, more: &[&str]) -> String {
    let output = replay_as(path, more);
    assert!(!output.status.success() && output.stdout.is_empty(), "{output:?}");
    String::from_utf8_lossy(&output.stderr).into_owned()
}

fn recorded_and_replayed(count: usize, name: &str) {
    let service = Service::start(name);
    let path = folder(name).join("visit.csv");
    let (done, _) = begin(&service, &path, count).end();
    let (replayed, is_good) = replay(&path);
    println!("{replayed}");
    assert!(is_good && replayed["equal"] == true, "{replayed}");
    assert_eq!(replayed["steps"], done["steps"]);
    assert_eq!(replayed["compared_steps"], done["steps"]);
    // a recording of one condition is none of another
    let text = refused(&path, &["--condition", "eva-o"]);
    assert!(text.contains("condition eva-g was recorded, this is eva-o"), "{text}");
    let text = refused(&path, &["--seed", "7"]);
    assert!(text.contains("seed 1 was recorded, this is 7") && text.contains("hint:"), "{text}");

    let text = refused(&path, &["--set", "gaze.mode=paper"]);
    assert!(text.contains("gaze natural was recorded, this is paper"), "{text}");
    let text = refused(&path, &["--set", "navigation.patience=2"]);
    assert!(text.contains("session: scenario "), "{text}");
    let library = path.with_file_name("other.glb");
    gaitway::library::GaitLibrary::generated(3, 1).unwrap().save_glb(&library).unwrap();
    let text = refused(&path, &["--library", library.to_str().unwrap()]);
    assert!(text.contains("library ") && text.contains(" was recorded, this is "), "{text}");

    // a user with a raised head sees another crowd, which walks alike
    let text = std::fs::read_to_string(&path).unwrap();
    let last = done["steps"].as_u64().unwrap();
    let lines = text.lines().map(|line| shifted(line, 7, last / 2) + "\n");
    std::fs::write(&path, lines.collect::<String>()).unwrap();
    let (raised, is_good) = replay(&path);
    assert!(!is_good && raised["equal"] == false, "{raised}");
    assert_eq!(raised["state_hash"], replayed["state_hash"], "{raised}");
    assert!(raised["differs_after"].as_u64().unwrap() > last / 2, "{raised}");

    // another user would have been another crowd: half a metre aside in the steps of the second half
    let lines = text.lines().map(|line| shifted(line, 1, last / 2) + "\n");
    std::fs::write(&path, lines.collect::<String>()).unwrap();
    let (aside, is_good) = replay(&path);
    assert!(!is_good && aside["equal"] == false, "{aside}");
    assert_ne!(aside["state_hash"], replayed["state_hash"], "{aside}");
}

#[test]
fn a_session_that_is_killed_leaves_its_steps_and_the_next_start_completes_it() {
    if !is_there() {
        return;
    }
    let service = Service::start("killed");
    let path = folder("killed").join("visit.csv");
    let live = begin(&service, &path, 8);
    recorded(&path, 70, |step| !step[7].is_empty());
    live.kill();
    let kept = steps(&path).len();
    // as if it had been killed in the middle of a line
    let mut text = std::fs::read_to_string(&path).unwrap();
    text += &format!("{kept},0.25");
    std::fs::write(&path, &text).unwrap();
    let output = replay_as(&path, &[]);
    let notes = String::from_utf8_lossy(&output.stderr);
    let found: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(output.status.success() && notes.contains("cut at its last whole one"), "{notes}");
    assert_eq!(
        (found["steps"].as_u64(), found["equal"].as_bool()),
        (Some(kept as u64), Some(true)),
        "{found}"
    );
    assert!(found["compared_steps"].as_u64().unwrap() >= 60 && found["recorded_hash"].is_null(), "{found}");
    assert_eq!(steps(&path).len(), kept);
    // one that broke off is compared, too: by the hash of every second
    let whole = std::fs::read_to_string(&path).unwrap();
    let raised = whole.lines().map(|line| shifted(line, 7, 20) + "\n");
    std::fs::write(&path, raised.collect::<String>()).unwrap();
    // the first steps may have no head: the crowd walks while the headset's pictures are prepared
    let raised = 21 + steps(&path).iter().skip(21).position(|step| !step[7].is_empty()).unwrap();
    let (found, is_good) = replay(&path);
    assert!(!is_good && found["equal"] == false, "{found}");
    assert_eq!(found["differs_after"], (raised + 1).next_multiple_of(30), "{found}");
    std::fs::write(&path, whole).unwrap();

    // a new recording at the same place keeps the old one
    let (done, notes) = begin(&service, &path, 2).end();
    assert!(notes.iter().any(|line| line.contains("visit.broken-off.csv")), "{notes:#?}");
    assert_eq!(steps(&path.with_file_name("visit.broken-off.csv")).len(), kept);
    assert_eq!(steps(&path).len() as u64, done["steps"].as_u64().unwrap());
    // a complete one is not written over
    let again = ["--eye-size", "160x160", "--seconds", "1", "--record", path.to_str().unwrap()];
    let output = service.gaitway(&[&CROWD[..], &again].concat()).output().unwrap();
    let text = String::from_utf8_lossy(&output.stderr);
    assert!(!output.status.success() && text.contains("there is a complete recording"), "{text}");
    assert_eq!(steps(&path).len() as u64, done["steps"].as_u64().unwrap());
}

/// A line with half a metre more in one field, if it is of a step after `from` and has that field.
fn shifted(line: &str, field: usize, from: u64) -> String {
    let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
    if fields[0].parse::<u64>().is_ok_and(|step| step > from) && !fields[field].is_empty() {
        fields[field] = (fields[field].parse::<f32>().unwrap() + 0.5).to_string();
    }
    fields.join(",")
}

#[test]
fn a_recorded_session_replays_bit_for_bit_on_the_cpu() {
    if is_there() {
        recorded_and_replayed(20, "record");
    }
}

#[test]
#[ignore = "takes a minute"]
fn a_minute_replays_bit_for_bit_on_the_cpu() {
    if is_there() {
        recorded_and_replayed(500, "minute");
    }
}

#[test]
fn a_user_whose_headset_hangs_stands_until_it_goes_on() {
    if !is_there() {
        return;
    }
    let service = Service::start("stands");
    let path = folder("stands").join("visit.csv");
    let text = path.to_str().unwrap();
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--record", text, "--json"];
    let mut head = service.head();
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd");
    // w walks, s stands without a head, . neither
    let sign = |fields: &[String]| {
        let speed = fields[4].parse::<f32>().unwrap().hypot(fields[5].parse().unwrap());
        match (speed > 0.2, fields[6].is_empty()) {
            (true, false) => 'w',
            (false, true) if speed == 0.0 => 's',
            _ => '.',
        }
    };
    let story = |from: usize| -> String { steps(&path).iter().skip(from).map(|step| sign(step)).collect() };
    let mut x = 0.0;
    let mut walk = |from: usize| {
        let ahead = |_| {
            x += 0.02;
            head.set(0.0, 0.0, [x, 1.6, 0.0]);
        };
        walk_until(ahead, || story(from).matches('w').count() > 5);
    };
    walk(0);
    service.signal("STOP");
    // two seconds of steps, but for the first half of one in which it might have been a slow frame
    let stood = "s".repeat(40);
    until(|| if story(0).contains(&stood) { Ok(()) } else { Err(format!("never stood: {}", story(0))) });
    service.signal("CONT");
    walk(steps(&path).len());
    live.end();
    println!("{}", story(0));
}
