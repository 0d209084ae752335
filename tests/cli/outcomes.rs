//! What comes of a run: trajectories, evacuations, recordings walked again, times.

use super::{bad, fails, gaitway, good, has_vulkan, json, refused};
use crate::common::pedpy;
use serde_json::Value;
use std::path::Path;

#[test]
fn trajectories_appear_complete_or_not_at_all() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("walk.csv");
    let file = path.to_str().unwrap();
    let arguments =
        ["simulate", "crossing", "--seconds", "1", "--backend", "cpu", "--fps", "15", "--out", file];
    good(&arguments);
    let text = std::fs::read_to_string(&path).unwrap();
    assert_eq!(text.lines().count(), 1 + 8 * 16, "a head, and 8 agents in 16 frames (both ends)");
    let wrong = folder.path().join("walk.doc");
    refused(&["simulate", "crossing", "--out", wrong.to_str().unwrap()], "doc", ".sqlite");
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 1, "no half files");
}

/// Forty people leave a hall by an exit at either end, thirty of them to the east. A robot stays.
const HALL: &str = "name = \"hall\"\nbounds = [[-12, -6], [12, -6], [12, 6], [-12, 6]]\n[population]\nagents = 40\n\
    [[stages]]\nname = \"east\"\nkind = \"exit\"\nposition = [11, 0]\nsize = [2, 10]\n\
    [[stages]]\nname = \"west\"\nkind = \"exit\"\nposition = [-11, 0]\nsize = [2, 10]\n\
    [[journeys]]\nname = \"out\"\nstages = [{ east = 3, west = 1 }]\n\
    [[spawns]]\npolygon = [[-4, -4], [4, -4], [4, 4], [-4, 4]]\n\
    [[outsiders]]\nkind = \"robot\"\npath = [[0, 0, 5.5]]\n";

#[test]
fn an_evacuation_ends_when_the_place_is_empty_and_its_curve_is_that_of_the_file() {
    let folder = tempfile::tempdir().unwrap();
    let (place, out) = (folder.path().join("hall.toml"), folder.path().join("hall.sqlite"));
    std::fs::write(&place, HALL).unwrap();
    let (place, file) = (place.to_str().unwrap(), out.to_str().unwrap());
    let run =
        ["simulate", place, "--until", "empty", "--backend", "cpu", "--json", "--out", file, "--fps", "30"];
    let report = json(&run);
    let evacuation = &report["evacuation"];
    assert_eq!((&report["emptied"], evacuation["left"].as_u64()), (&Value::Bool(true), Some(40)), "{report}");
    let number = |value: &Value| value.as_f64().unwrap_or_else(|| panic!("{report}"));
    assert!(number(&report["seconds"]) < 60.0 && number(&report["mean_speed"]) > 0.7, "{report}");
    // the file: when the last person was gone, by their last frame
    let database = rusqlite::Connection::open(&out).unwrap();
    let gone: Vec<f64> = database
        .prepare("SELECT (max(frame) + 1) / 30.0 FROM trajectory_data GROUP BY id ORDER BY 1")
        .unwrap()
        .query_map([], |row| row.get(0))
        .unwrap()
        .collect::<Result<_, _>>()
        .unwrap();
    assert_eq!(gone.len(), 40, "the robot is no pedestrian");
    let curve: Vec<(f64, u64)> = evacuation["n_t"]
        .as_array()
        .unwrap()
        .iter()
        .map(|p| (number(&p[0]), p[1].as_u64().unwrap()))
        .collect();
    for (time, count) in &curve {
        let by_file = gone.iter().filter(|gone| **gone <= time + 1e-6).count() as u64;
        assert_eq!(by_file, *count, "{time} s: {curve:?} {gone:?}");
    }
    for (key, at) in [("time_50", 19), ("time_95", 37), ("time_100", 39)] {
        assert!((number(&evacuation[key]) - gone[at]).abs() < 1e-6, "{key}: {evacuation} {gone:?}");
    }
    let exits = evacuation["exits"].as_array().unwrap();
    assert_eq!((exits[0]["exit"].as_str(), exits[1]["exit"].as_str()), (Some("east"), Some("west")));
    let [east, west] = [0, 1].map(|i| exits[i]["left"].as_u64().unwrap());
    assert!(east + west == 40 && east > west, "{evacuation}");
    assert_eq!(
        number(&exits[0]["time_100"]).max(number(&exits[1]["time_100"])),
        number(&evacuation["time_100"])
    );
    // cut short, it says so; and where there is no way out it does not begin
    let short = gaitway(&["simulate", place, "--until", "empty", "--seconds", "2", "--backend", "cpu"]);
    let (said, noted) = (String::from_utf8_lossy(&short.stdout), String::from_utf8_lossy(&short.stderr));
    assert!(short.status.success() && said.contains("100 % not yet"), "{said}");
    assert!(noted.contains("not empty after 2.0 s"), "{noted}");
    refused(&["simulate", "crossing", "--until", "empty"], "no exit", "--seconds");
    with_pedpy(&out, evacuation);
}

/// `PedPy` counts the same people across lines before the exits, as they come to them.
fn with_pedpy(file: &Path, evacuation: &Value) {
    let Some(mut command) = pedpy("pedpy_leaves.py") else { return };
    let run = command.arg(file).arg(evacuation.to_string()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    print!("{}", String::from_utf8_lossy(&run.stdout));
}

#[test]
fn mean_speed_counts_present_people() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("hall.toml");
    std::fs::write(&place, HALL).unwrap();
    let speed = |seconds: &str| {
        let place = place.to_str().unwrap();
        let report = json(&["simulate", place, "--seconds", seconds, "--backend", "cpu", "--json"]);
        report["mean_speed"].as_f64().unwrap()
    };
    // An empty hall has no speed: minutes after the last person has left change nothing.
    assert_eq!(speed("60"), speed("120"));
}

#[test]
fn replay_says_how_it_read_a_recording_and_refuses_speeds_at_which_people_do_not_walk() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("biwi_eth.txt");
    let mut text = String::new();
    for sample in 0..12 {
        for id in 1..=4 {
            let (x, y) = (0.5 * f64::from(sample) + 0.1 * f64::from(id), 3.0 * f64::from(id));
            text += &format!("{}.0\t{id}.0\t{x}\t{y}\n", 780 + 10 * sample);
        }
    }
    std::fs::write(&path, text).unwrap();
    let file = path.to_str().unwrap();
    let said = good(&["replay", file, "--seconds", "1", "--backend", "cpu"]);
    let line = said.lines().find(|line| line.starts_with("read as")).unwrap_or_else(|| panic!("{said}"));
    assert!(
        line.contains("frame, id, x, y (inferred); 25 frames a second (steps); metres (speeds)"),
        "{line}"
    );
    fails(
        &["replay", file, "--columns", "id,frame,x,y", "--fps", "25"],
        "people walk at less than 4",
        "--columns",
    );
    let forced = ["replay", file, "--fps", "250", "--accept-speed", "--seconds", "0.1", "--backend", "cpu"];
    fails(&["replay", file, "--fps", "250"], "faster than 12.5 m/s", "--accept-speed");
    assert!(good(&forced).contains("250 frames a second (asked for)"));
    let (code, error) = bad(&["replay", file, "--columns", "id,frame,x"]);
    assert!(code == 2 && error.contains("y is missing"), "{code}: {error}");
}

#[test]
fn verify_passes_and_names_every_kernel() {
    if !has_vulkan() {
        return;
    }
    let report = json(&["verify", "--agents", "0,1,65", "--quick", "--seed", "300", "--json"]);
    assert_eq!(report["pass"], true, "{report}");
    let kernels = report["kernels"].as_array().unwrap();
    assert_eq!(kernels.len(), gaitway::kernels::KernelId::ALL.len());
    for kernel in kernels {
        let sides = kernel["sides"].as_array().unwrap();
        assert_eq!(sides[0]["side"], "device", "{kernel}");
        assert!(sides.iter().all(|side| side["compared"].as_u64().unwrap() > 0), "{kernel}");
    }
    let crowd = &report["crowd"];
    assert_eq!((&crowd["agents"], &crowd["steps"]), (&10_000.into(), &100.into()), "{crowd}");
}

/// A peer that stands still, written for a shell: it answers as docs/speed.md says.
#[cfg(unix)]
fn standing_peer(folder: &Path, state: &str) -> String {
    use std::os::unix::fs::PermissionsExt;
    let path = folder.join("peer.sh");
    let text = format!(
        "#!/bin/sh\nread -r crowd\necho 'still 1.0'\nwhile read -r order count; do\n\
         if [ \"$order\" = step ]; then echo \"$((count * 2))\"; else echo '{state}'; fi\ndone\n"
    );
    std::fs::write(&path, text).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
    path.to_string_lossy().into_owned()
}

#[cfg(unix)]
#[test]
fn bench_runs_a_peer_beside_the_same_crowd_and_says_what_its_crowd_looked_like() {
    let folder = tempfile::tempdir().unwrap();
    let [x, v] = ["[7.0,7.0],[7.3,7.0]", "[1.3,0.0],[1.3,0.0]"];
    let more = |point: &str| format!("{point},{}", vec!["[1.0,1.0]"; 398].join(","));
    let state = format!("{{\"position\":[{}],\"velocity\":[{}]}}", more(x), more(v));
    let peer = standing_peer(folder.path(), &state);
    let report = json(&["bench", "--peers", "--peer", &peer, "--agents", "400", "--json"]);
    let rows = report["rows"].as_array().unwrap();
    assert_eq!(rows.len(), 2, "{report}");
    assert!(rows[0]["name"].as_str().unwrap().starts_with("gaitway, CPU"), "{report}");
    assert_eq!((&rows[1]["name"], &rows[1]["agents"]), (&"still 1.0".into(), &400.into()));
    assert_eq!((&rows[0]["times_median"], &rows[1]["ms_median"]), (&1.0.into(), &2.0.into()), "2 ms a step");
    let ratio = rows[1]["times_median"].as_f64().unwrap() * rows[0]["ms_median"].as_f64().unwrap();
    assert!((ratio - 2.0).abs() < 1e-9, "{report}");
    assert!(rows[0]["min_distance"].as_f64().unwrap() > 0.49, "{report}");
    let nearest = rows[1]["min_distance"].as_f64().unwrap();
    assert!((nearest - 0.3).abs() < 1e-6, "two stand 0.3 m apart: {report}");
    for (bad, fault) in
        [("{}", "missing field"), ("{\"position\":[],\"velocity\":[]}", "0 places for 400 agents")]
    {
        let peer = standing_peer(folder.path(), bad);
        refused(&["bench", "--peers", "--peer", &peer, "--agents", "400"], fault, "docs/speed.md");
    }
    let missing = ["bench", "--peers", "--python", "no-such-python", "--agents", "400"];
    refused(&missing, "no-such-python", "pip install pyrvo");
}

#[test]
fn bench_times_the_step_and_says_what_the_crowd_looked_like() {
    let report = json(&["bench", "--agents", "300", "--backend", "cpu", "--json"]);
    let rows = report["rows"].as_array().unwrap();
    for name in ["step", "grid_scan", "velocity_orca", "velocity_orca.again", "integrate"] {
        let row = rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("{name}: {report}"));
        assert!(row["ms_median"].as_f64().unwrap() > 0.0);
    }
    assert!(report["quality"][0]["progress"].as_f64().unwrap() > 0.5, "{report}");
}

#[test]
fn bench_times_crowds_that_are_not_even() {
    let nearest = |workload| {
        let report =
            json(&["bench", "--workload", workload, "--agents", "900", "--backend", "cpu", "--json"]);
        let rows = report["rows"].as_array().unwrap();
        assert!(rows.iter().any(|row| row["name"] == "velocity_orca.again"), "{report}");
        let quality = &report["quality"][0];
        assert!(quality["progress"].as_f64().unwrap() > 0.5, "{report}");
        assert!(quality["overlapping"].as_f64().unwrap() < 0.01, "people of two storeys count: {report}");
        quality["min_distance"].as_f64().unwrap()
    };
    assert!(nearest("clustered") > 0.45 && nearest("storeys") > 0.45);
}
