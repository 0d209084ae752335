//! A session with a moving head, recorded, and replayed without a headset.

use super::folder;
use super::service::{GPU_ENV, Live, Service, is_there};
use serde_json::Value;
use std::path::Path;
use std::process::Command;
use std::time::{Duration, Instant};

/// Records a session in which the head walks in circles.
fn record(service: &Service, path: &Path, seconds: f32) -> Value {
    let path = path.to_str().unwrap();
    let run = ["xr", "crossing", "--agents", "300", "--eye-size", "160x160", "--record", path, "--json"];
    let mut head = service.head();
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd", Duration::from_secs(30));
    let begin = Instant::now();
    while begin.elapsed().as_secs_f32() < seconds {
        let turn = begin.elapsed().as_secs_f32();
        head.set(turn.to_degrees(), -10.0, [0.8 * turn.sin(), 1.6, -0.8 * turn.cos()]);
        std::thread::sleep(Duration::from_millis(30));
    }
    live.end().0
}

/// Replays it on the CPU: what came of it, and whether the program was content. With the same mathematics library as the
/// session, since the places where people start come from its sines.
fn replay(path: &Path) -> (Value, bool) {
    let output = Command::new(GPU_ENV)
        .arg(env!("CARGO_BIN_EXE_gaitway"))
        .args(["xr", "crossing", "--agents", "300", "--backend", "cpu", "--json", "--replay"])
        .arg(path)
        .output();
    let output = output.unwrap();
    let out = String::from_utf8_lossy(&output.stdout);
    let found = serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {output:?}"));
    (found, output.status.success())
}

fn recorded_and_replayed(seconds: f32, name: &str, port: u16) {
    let service = Service::start(name, port);
    let path = folder(name).join("visit.csv");
    let recorded = record(&service, &path, seconds);
    let (replayed, is_good) = replay(&path);
    println!("{replayed}");
    assert!(is_good && replayed["equal"] == true, "{replayed}");
    assert_eq!(replayed["steps"], recorded["steps"]);
    // the user did move, and in steps that a recording can tell from one another
    let text = std::fs::read_to_string(&path).unwrap();
    let places: std::collections::BTreeSet<(&str, &str)> = text
        .lines()
        .filter(|line| line.starts_with(|c: char| c.is_ascii_digit()))
        .map(|line| {
            let mut fields = line.split(',').skip(1);
            (fields.next().unwrap(), fields.next().unwrap())
        })
        .collect();
    assert!(places.len() as f32 > 2.0 * seconds, "{} places", places.len());
    // another user would have been another crowd: half a metre aside in the steps of the second half
    let last = recorded["steps"].as_u64().unwrap();
    let moved: Vec<String> = text.lines().map(|line| aside(line, last / 2)).collect();
    std::fs::write(&path, moved.join("\n") + "\n").unwrap();
    let (replayed, is_good) = replay(&path);
    assert!(!is_good && replayed["equal"] == false, "{replayed}");
}

/// A line with the user half a metre aside, if it is of a step after `from`.
fn aside(line: &str, from: u64) -> String {
    let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
    if fields[0].parse::<u64>().is_ok_and(|step| step > from) {
        fields[1] = (fields[1].parse::<f32>().unwrap() + 0.5).to_string();
    }
    fields.join(",")
}

#[test]
fn a_recorded_session_replays_bit_for_bit_on_the_cpu() {
    if is_there() {
        recorded_and_replayed(4.0, "record", 4271);
    }
}

#[test]
#[ignore = "takes a minute"]
fn a_minute_replays_bit_for_bit_on_the_cpu() {
    if is_there() {
        recorded_and_replayed(60.0, "minute", 4272);
    }
}

#[test]
fn a_user_whose_headset_hangs_stands_until_it_goes_on() {
    if !is_there() {
        return;
    }
    let service = Service::start("stands", 4275);
    let path = folder("stands").join("visit.csv");
    let text = path.to_str().unwrap();
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--record", text, "--json"];
    let mut head = service.head();
    let mut live = Live::start(service.gaitway(&run));
    live.hear("the headset shows the crowd", Duration::from_secs(30));
    let mut x = 0.0;
    let mut walk = |seconds: f32| {
        let begin = Instant::now();
        while begin.elapsed().as_secs_f32() < seconds {
            x += 0.02;
            head.set(0.0, 0.0, [x, 1.6, 0.0]);
            std::thread::sleep(Duration::from_millis(25));
        }
    };
    walk(1.0);
    service.signal("STOP");
    std::thread::sleep(Duration::from_millis(2300));
    service.signal("CONT");
    live.hear("answers again", Duration::from_secs(30));
    walk(1.0);
    live.end();
    let table = std::fs::read_to_string(&path).unwrap();
    let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    // velocity and head of every step: w walks, s stands without a head, . neither
    let story: String = rows
        .map(|row| {
            let fields: Vec<&str> = row.split(',').collect();
            let speed = fields[3].parse::<f32>().unwrap().hypot(fields[4].parse().unwrap());
            match (speed > 0.2, fields[5].is_empty()) {
                (true, false) => 'w',
                (false, true) if speed == 0.0 => 's',
                _ => '.',
            }
        })
        .collect();
    println!("{story}");
    // two seconds, but for the first half of one in which it might have been a slow frame
    let stood = "s".repeat(40);
    let (before, after) = story.split_once(&stood).unwrap_or_else(|| panic!("never stood: {story}"));
    assert!(before.contains('w') && after.contains('w'), "{story}");
}
