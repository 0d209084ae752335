//! The program as people use it: help, results, JSON, errors with a way out, the same bits on both backends.
//!
//! GAITWAY_TEST_RUNNER (or GAITWAY_RUNNER) names a program that starts ours, where it cannot start by itself.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stdout,
    clippy::doc_markdown,
    reason = "a test: a failure is a panic that prints, and what must be the same is the same bit for bit"
)]

mod crowds;
mod ending;
#[path = "../common/gpu.rs"]
mod gpu;
mod odd;
mod words;

use gaitway::Emotion;
use gaitway::library::GaitLibrary;
use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

/// The program, not yet started.
fn program() -> Command {
    let program = env!("CARGO_BIN_EXE_gaitway");
    let runner = ["GAITWAY_TEST_RUNNER", "GAITWAY_RUNNER"].into_iter().find_map(std::env::var_os);
    match runner {
        Some(runner) => {
            let mut command = Command::new(runner);
            command.arg(program);
            command
        }
        None => Command::new(program),
    }
}

/// Runs the program.
fn gaitway(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

/// Standard output of a run that must succeed.
fn good(arguments: &[&str]) -> String {
    let output = gaitway(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {:?}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// The one JSON object of a run that must succeed.
fn json(arguments: &[&str]) -> Value {
    let text = good(arguments);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{arguments:?}: {error}\n{text}"))
}

/// Exit code and standard error of a run that must fail with nothing on standard output.
fn bad(arguments: &[&str]) -> (i32, String) {
    let output = gaitway(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?} succeeded");
    assert!(output.stdout.is_empty(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stdout));
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    (output.status.code().unwrap(), error)
}

/// An error in our words: `error: ...` with `want` in it, and a way out.
fn told(code: i32, arguments: &[&str], want: &str, hint: &str) {
    let (found, error) = bad(arguments);
    assert_eq!(found, code, "{arguments:?}: {error}");
    assert_eq!(error.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{arguments:?}: {error}");
    assert!(error.contains(want), "{arguments:?}: {error}");
    assert!(error.contains(hint), "{arguments:?}: {error}");
}

/// A command line that is wrong.
fn refused(arguments: &[&str], want: &str, hint: &str) {
    told(2, arguments, want, hint);
}

/// Something that went wrong while doing.
fn fails(arguments: &[&str], want: &str, hint: &str) {
    told(1, arguments, want, hint);
}

/// Whether there is a Vulkan device; prints why not. With GAITWAY_REQUIRE_GPU=1 there must be one.
fn has_vulkan() -> bool {
    if !cfg!(feature = "vulkan") {
        println!("skipped: built without Vulkan");
        return false;
    }
    let devices = json(&["devices", "--json"]);
    let has_one = devices["best"].is_u64();
    if !has_one {
        assert!(!gpu::is_required(), "{devices}");
        println!("skipped: no Vulkan device ({})", devices["missing"]);
    }
    has_one
}

#[test]
fn help_names_every_subcommand_and_shows_examples() {
    let help = good(&["--help"]);
    let mut commands = vec!["simulate", "gait", "bench", "devices"];
    if cfg!(feature = "vulkan") {
        commands.extend(["render", "verify", "demo"]);
    }
    for command in commands {
        assert!(help.contains(&format!("\n  {command}")), "{help}");
        let own = good(&[command, "--help"]);
        assert!(own.contains("Usage: "), "{own}");
        assert!(command == "gait" || own.contains(&format!("gaitway {command} ")), "{own}");
    }
    assert!(good(&["--version"]).starts_with("gaitway "));
}

#[test]
fn simulating_twice_gives_the_same_hash_and_another_seed_another() {
    let run = |seed: &str| {
        let arguments = [
            "simulate",
            "garden",
            "--agents",
            "40",
            "--seconds",
            "2",
            "--seed",
            seed,
            "--backend",
            "cpu",
            "--json",
        ];
        json(&arguments)
    };
    let (a, b, c) = (run("5"), run("5"), run("6"));
    assert_eq!(a["state_hash"], b["state_hash"]);
    assert_ne!(a["state_hash"], c["state_hash"]);
    // the same on every machine; whatever changes it is told as "results:" in CHANGELOG.md
    assert_eq!(a["state_hash"], "0837ea55c38fb744");
    for key in [
        "device",
        "scene",
        "mean_speed",
        "arrived",
        "min_clearance",
        "agent_steps_per_second",
        "wall_seconds",
        "failure",
    ] {
        assert!(a.get(key).is_some(), "{key} is missing in {a}");
    }
    assert_eq!((&a["agents"], &a["steps"], &a["seed"]), (&40.into(), &60.into(), &5.into()));
    assert_eq!((&a["agents_outside"], &a["overlapping_pairs_max"]), (&0.into(), &0.into()));
    let speed = a["mean_speed"].as_f64().unwrap();
    assert!((0.8..1.8).contains(&speed), "{speed}");
}

#[test]
fn the_cpu_and_vulkan_give_the_same_hash() {
    if !has_vulkan() {
        return;
    }
    for scene in ["crossing", "scifi"] {
        let run = |backend: &str| {
            json(&["simulate", scene, "--agents", "150", "--seconds", "3", "--backend", backend, "--json"])
        };
        let (cpu, gpu) = (run("cpu"), run("vulkan"));
        assert_eq!(cpu["state_hash"], gpu["state_hash"], "{scene}: {cpu} {gpu}");
        assert_ne!(cpu["device"], gpu["device"]);
    }
}

#[test]
fn an_empty_crowd_is_a_crowd() {
    let result =
        json(&["simulate", "crossing", "--agents", "0", "--seconds", "1", "--backend", "cpu", "--json"]);
    assert_eq!((&result["agents"], &result["steps"]), (&0.into(), &30.into()));
    assert!(result["min_clearance"].is_null());
}

#[test]
fn wrong_values_are_refused_with_a_way_out() {
    refused(&["simulate", "croissing"], "did you mean crossing?", "crossing, garden, parking, scifi");
    fails(&["simulate", "no/such.toml"], "no/such.toml", "No such file");
    refused(&["simulate", "crossing", "--seconds", "1e9"], "--seconds = 1000000000", "hint: ");
    refused(&["simulate", "crossing", "--seconds", "NaN"], "--seconds = NaN", "hint: ");
    refused(&["simulate", "crossing", "--agents", "1000001"], "1000001", "0..=1000000");
    refused(&["simulate", "crossing", "--backend", "cpu", "--device", "x"], "--device", "hint: leave");
    refused(&["simulate", "garden", "--out", "x.sqlite", "--fps", "7"], "--fps 7", "hint: use 30");
    refused(&["bench", "--agents", "0"], "--agents 0", "hint: ");
    refused(&["gait", "walk", "--emotion", "sad", "--set", "bouncy=1", "--out", "x.csv"], "bouncy", "bounce");
    refused(
        &["gait", "walk", "--emotion", "sad", "--speed", "9", "--out", "x.csv"],
        "speed = 9",
        "0.1 to 2.6",
    );
    for usage in [&["simulate"][..], &["simulate", "crossing", "--condition", "eva"], &["fly"], &[]] {
        assert_eq!(bad(usage).0, 2, "{usage:?}");
    }
}

#[test]
fn without_a_device_vulkan_is_refused_and_auto_falls_back_with_one_line() {
    if cfg!(feature = "vulkan") && json(&["devices", "--json"])["best"].is_u64() {
        println!("skipped: there is a Vulkan device");
        return;
    }
    fails(&["simulate", "crossing", "--backend", "vulkan"], "Vulkan", "cpu");
    let output = gaitway(&["simulate", "crossing", "--seconds", "1"]);
    assert!(output.status.success());
    let error = String::from_utf8(output.stderr).unwrap();
    let expected = usize::from(cfg!(feature = "vulkan"));
    assert_eq!(error.lines().filter(|line| line.starts_with("note: ")).count(), expected, "{error}");
}

#[test]
fn a_named_device_that_is_missing_is_an_error_and_digits_are_numbers_in_the_list() {
    let with = |name: Option<&str>, arguments: &[&str]| {
        let mut command = program();
        match name {
            Some(name) => command.env("GAITWAY_DEVICE", name),
            None => command.env_remove("GAITWAY_DEVICE"),
        };
        let output = command.args(arguments).output().unwrap();
        (output.status.code(), String::from_utf8(output.stderr).unwrap())
    };
    let crowds = [
        &["simulate", "crossing", "--seconds", "0"][..],
        &["perceive", "crossing", "--seconds", "1", "--warm-up", "0"],
        &["validate", "rimea-1", "--quick"],
        &["bench", "--agents", "10"],
    ];
    // without any driver the message is that there is none
    let there_is_one = has_vulkan();
    // the name of lavapipe has LLVM's version in it; a number is never part of a name
    for missing in ["no such device", "7", "19", "15"] {
        for crowd in crowds {
            let by_option = with(None, &[crowd, &["--device", missing]].concat());
            let by_variable = with(Some(missing), crowd);
            for (code, error) in [by_option, by_variable] {
                assert_eq!(code, Some(1), "{crowd:?} with {missing}: {error}");
                assert!(error.contains("hint: "), "{error}");
                assert!(!there_is_one || error.contains("found: 0: ") && error.contains(missing), "{error}");
            }
        }
    }
    let crowd = crowds[0];
    let on_the_cpu = with(Some("7"), &[crowd, &["--backend", "cpu"]].concat());
    assert_eq!(on_the_cpu.0, Some(0), "the CPU needs no device: {}", on_the_cpu.1);
    if there_is_one {
        assert_eq!(with(Some("7"), &[crowd, &["--device", "0"]].concat()).0, Some(0), "the option counts");
    }
}

/// The hash of a short simulation on the CPU.
fn hash_of(arguments: &[&str]) -> Value {
    json(&[&["simulate"], arguments, &["--seconds", "1", "--backend", "cpu", "--json"]].concat())["state_hash"].clone()
}

#[test]
fn what_is_set_is_as_if_the_scenarios_file_said_so() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("place.toml");
    let file = path.to_str().unwrap();
    let write = |text: &str| std::fs::write(&path, text).unwrap();
    let garden = include_str!("../../assets/scenes/garden.toml");
    let edited = garden
        .replace("agents = 4", "agents = 40")
        .replace("happy = 1.0", "happy = 5")
        .replace("[navigation]", "[navigation]\npatience = 1.0")
        .replace("model = \"orca\"", "model = \"rvo\"");
    let set = [
        &["--set", "population.agents=40", "--set", "population.emotions.happy=5"][..],
        &["--set", "navigation.patience=1.0", "--set", "navigation.model=rvo"],
    ]
    .concat();
    write(&edited);
    let wanted = hash_of(&[file]);
    assert_ne!(wanted, hash_of(&["garden", "--set", "population.agents=40"]));
    assert_eq!(wanted, hash_of(&[&["garden"], set.as_slice()].concat()), "a built-in scene");
    write(garden);
    assert_eq!(wanted, hash_of(&[&[file], set.as_slice()].concat()), "a file");

    let place = "name = \"place\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[population]\nagents = 0\n\
                 [[walkers]]\nposition = [1, 1]\nwaypoints = [[8, 1]]\n[[walkers]]\nposition = [1, 5]\nwaypoints = [[8, 5]]\n\
                 [[obstacles]]\npolygon = [[4, 4], [5, 4], [5, 6], [4, 6]]\n";
    write(&place.replace("[1, 5]\nwaypoints = [[8, 5]]", "[1, 5]\nspeed = 1.6\nwaypoints = [[8, 7]]"));
    let wanted = hash_of(&[file]);
    write(place);
    let elements = ["--set", "walkers.1.speed=1.6", "--set", "walkers[1].waypoints=[[8, 7]]"];
    assert_eq!(wanted, hash_of(&[&[file], &elements[..]].concat()));
    assert_ne!(wanted, hash_of(&[file]));
    write(&place.replace("[[obstacles]]\npolygon = [[4, 4], [5, 4], [5, 6], [4, 6]]\n", ""));
    let wanted = hash_of(&[file]);
    write(place);
    assert_eq!(wanted, hash_of(&[file, "--set", "obstacles=[]"]));

    // the same messages as of a file, with what was set as the place
    write(&garden.replace("[navigation]", "[navigation]\npatiense = 1.0"));
    let (_, of_file) = bad(&["simulate", file]);
    write(garden);
    let set = "navigation.patiense=1.0";
    let (_, of_setting) = bad(&["simulate", file, "--set", set]);
    assert!(of_file.contains("did you mean `patience`?"), "{of_file}");
    let message = |text: &str| text[text.find("navigation.patiense: ").unwrap()..].to_owned();
    assert_eq!(message(&of_file), message(&of_setting));
    assert!(of_setting.contains(&format!("--set {set}: ")), "{of_setting}");
    refused(
        &["simulate", "garden", "--set", "navigation.time_horizon=99"],
        "--set navigation.time_horizon=99: ",
        "0.1 to 20",
    );
    refused(
        &["simulate", "garden", "--set", "population.agents=-1"],
        "--set population.agents=-1: ",
        "population.agents",
    );
    refused(
        &["simulate", file, "--set", "obstacles.0.high=2"],
        "there is no obstacles in the file",
        "obstacles.0.high=2",
    );
    // what is wrong in the file itself keeps its line
    write(&garden.replace("radius = 0.2  ", "radius = 25.0"));
    fails(
        &["simulate", file, "--set", "population.agents=5"],
        "place.toml:23: navigation.radius = 25",
        "0.05 to 2",
    );
    for wrong in ["agents", "a..b=1", "population.agents=[1"] {
        assert_eq!(bad(&["simulate", "garden", "--set", wrong]).0, 2, "{wrong}");
    }
}

#[test]
fn shares_of_the_emotions_are_those_of_the_command_line() {
    let crowd = ["garden", "--agents", "40"];
    let with = |more: &[&str]| hash_of(&[&crowd[..], more].concat());
    let sad = with(&["--emotions", "sad=2,happy=0.5"]);
    assert_eq!(sad, with(&["--set", "population.emotions={ sad = 2, happy = 0.5 }"]));
    assert_ne!(sad, with(&[]));
    for wrong in ["cheerful=1", "sad=-1", "sad=0", "sad=nan"] {
        assert_eq!(bad(&["simulate", "garden", "--emotions", wrong]).0, 2, "{wrong}");
    }
    let commands = [
        ("simulate", true),
        ("render", cfg!(feature = "vulkan")),
        ("perceive", true),
        ("view", cfg!(feature = "view")),
        ("xr", cfg!(feature = "xr")),
        ("replay", true),
    ];
    for (command, _) in commands.into_iter().filter(|(_, is_built)| *is_built) {
        let help = good(&[command, "--help"]);
        assert!(help.contains("--emotions <EMOTION=SHARE,..>"), "{command}: {help}");
        assert!(command == "replay" || help.contains("--set <KEY=VALUE>"), "{command}: {help}");
    }
}

#[test]
fn captures_without_labels_walk_as_the_baseline_and_the_other_conditions_say_what_is_missing() {
    let folder = tempfile::tempdir().unwrap();
    let save = |name: &str, labels: &[Emotion]| {
        let mut gaits = GaitLibrary::generated(3, 1).unwrap().gaits().to_vec();
        for gait in &mut gaits {
            gait.label = gait.label.filter(|label| labels.contains(label));
        }
        let path = folder.path().join(name);
        GaitLibrary::from_gaits(gaits).unwrap().save_glb(&path).unwrap();
        path.to_str().unwrap().to_owned()
    };
    let run = |library: &str, more: &[&str]| {
        let crowd =
            ["simulate", "crossing", "--seconds", "0.5", "--backend", "cpu", "--json", "--library", library];
        let output = gaitway(&[&crowd[..], more].concat());
        let error = String::from_utf8(output.stderr).unwrap();
        let hash = serde_json::from_slice::<Value>(&output.stdout).map(|found| found["state_hash"].clone());
        (output.status.code(), error, hash.unwrap_or_default())
    };
    let mine = save("mine.glb", &[]);
    let (code, error, baseline) = run(&mine, &["--condition", "baseline"]);
    assert_eq!((code, error.as_str()), (Some(0), ""));
    let (code, error, plain) = run(&mine, &[]);
    assert_eq!((code, plain), (Some(0), baseline), "{error}");
    assert!(
        error.starts_with("note: none of the 8 gaits of ") && error.contains("--condition baseline"),
        "{error}"
    );
    assert!(
        error.contains(&format!("gaitway gait label {mine} --out ")) && error.contains("labels.csv"),
        "{error}"
    );
    for asked in [&["--condition", "eva-g"][..], &["--set", "condition=eva-o"]] {
        let (code, error, _) = run(&mine, asked);
        assert_eq!(code, Some(1), "{error}");
        for word in [
            "no happy, no angry, no sad, no neutral gait",
            "8 of its 8 gaits have no label",
            "gaitway gait label",
            "labels.csv",
        ] {
            assert!(error.contains(word), "{word}: {error}");
        }
    }
    let some = save("some.glb", &[Emotion::Happy, Emotion::Neutral]);
    let (code, error, _) = run(&some, &[]);
    assert_eq!(code, Some(1), "{error}");
    assert!(error.contains("no angry, no sad gait (4 of its 8 gaits have no label)"), "{error}");
    assert_eq!(run(&some, &["--emotions", "happy=1,neutral=2"]).0, Some(0));
    assert_eq!(run(&some, &["--condition", "baseline"]).0, Some(0));
}

#[test]
fn a_gait_written_as_csv_comes_back_with_its_speed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("angry.csv");
    let file = path.to_str().unwrap();
    good(&["gait", "walk", "--emotion", "angry", "--sex", "male", "--speed", "1.5", "--out", file]);
    let sheet = folder.path().join("sheet.png");
    let listing = json(&["gait", "show", file, "--out", sheet.to_str().unwrap(), "--json"]);
    let speed = listing["gaits"][0]["v_des"].as_f64().unwrap();
    assert!((speed - 1.5).abs() < 0.02, "{listing}");
    assert!(colors(&sheet) > 4);
}

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

/// Forty people in a hall, who leave by an exit at either end, thirty of them to the east; and a robot that stays.
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
    // the file: when everybody was gone, by their last frame
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
    let Ok(python) = std::env::var("GAITWAY_PEDPY") else {
        println!("skipped: set GAITWAY_PEDPY to a python that has pedpy");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pedpy_leaves.py");
    let run = Command::new(python).arg(script).arg(file).arg(evacuation.to_string()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    print!("{}", String::from_utf8_lossy(&run.stdout));
}

#[test]
fn mean_speed_counts_those_who_are_there() {
    let folder = tempfile::tempdir().unwrap();
    let place = folder.path().join("hall.toml");
    std::fs::write(&place, HALL).unwrap();
    let speed = |seconds: &str| {
        let place = place.to_str().unwrap();
        let report = json(&["simulate", place, "--seconds", seconds, "--backend", "cpu", "--json"]);
        report["mean_speed"].as_f64().unwrap()
    };
    // An empty hall has no speed: minutes after everybody has left change nothing.
    assert_eq!(speed("60"), speed("120"));
}

#[test]
fn recordings_of_others_are_told_how_they_were_read_and_refused_when_nobody_walks_so() {
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

/// Number of different colours in a PNG.
fn colors(path: &Path) -> usize {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    let pixels = &pixels[..frame.buffer_size()];
    let set: std::collections::BTreeSet<&[u8]> =
        pixels.chunks_exact(frame.line_size / frame.width as usize).collect();
    set.len()
}

#[test]
fn pictures_show_something_from_every_camera_whoever_simulates() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("picture.png");
    let file = out.to_str().unwrap();
    for (camera, backend) in [("eyes", "auto"), ("orbit", "cpu"), ("top", "auto"), ("follow:3", "cpu")] {
        let result = json(&[
            "render",
            "crossing",
            "--at",
            "0.5",
            "--size",
            "192x108",
            "--camera",
            camera,
            "--backend",
            backend,
            "--out",
            file,
            "--force",
            "--json",
        ]);
        assert_eq!(result["frames"], 1, "{result}");
        assert!(colors(&out) > 100, "{camera}: {} colours", colors(&out));
    }
    let frames = format!("{}/frames/", folder.path().display());
    good(&["render", "garden", "--size", "64x36", "--seconds", "0.2", "--out", &frames]);
    assert_eq!(std::fs::read_dir(&frames).unwrap().count(), 6);
    let behind = ["render", "crossing", "--camera", "follow:8", "--force", "--out", file];
    refused(&behind, "there are 8 agents", "follow:7");
    refused(&["render", "crossing", "--out", "x.gif"], "x.gif", "hint: use FILE.png");
}

#[test]
fn the_same_moment_looks_the_same_whoever_simulates() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |backend: &str| {
        let out = folder.path().join(format!("{backend}.png"));
        let file = out.to_str().unwrap();
        good(&["render", "garden", "--at", "1", "--size", "192x108", "--backend", backend, "--out", file]);
        std::fs::read(out).unwrap()
    };
    assert!(picture("cpu") == picture("vulkan"));
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
        assert!(kernel["compared"].as_u64().unwrap() > 0, "{kernel}");
    }
    let crowd = &report["crowd"];
    assert_eq!((&crowd["agents"], &crowd["steps"]), (&10_000.into(), &100.into()), "{crowd}");
}

#[test]
fn bench_times_the_step_and_says_what_the_crowd_looked_like() {
    let report = json(&["bench", "--agents", "300", "--backend", "cpu", "--json"]);
    let rows = report["rows"].as_array().unwrap();
    for name in ["step", "grid_count", "grid_scan", "grid_scan.sum", "velocity_orca", "integrate"] {
        let row = rows.iter().find(|row| row["name"] == name).unwrap_or_else(|| panic!("{name}: {report}"));
        assert!(row["ms_median"].as_f64().unwrap() > 0.0);
    }
    assert!(report["quality"][0]["progress"].as_f64().unwrap() > 0.5, "{report}");
}

/// A man whose hands are folded before him and whose joints are called "Bone 0" and so on: nothing tells which is which.
fn nameless_man() -> Vec<u8> {
    use gaitway::gait::Joint;
    let mut avatar = gaitway::avatar::generated(gaitway::avatar::Sex::Male);
    let rest = avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate());
    for hand in [Joint::LeftHand as usize, Joint::RightHand as usize] {
        let place = glam::Vec3::new(0.04 * rest[hand].x.signum(), 1.0, 0.2);
        avatar.joints[hand].translation = place - rest[Joint::PARENT[hand]];
        avatar.joints[hand].joint_from_mesh = glam::Mat4::from_translation(-place);
    }
    let file = gaitway::avatar::glb(&avatar);
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    for (number, node) in json["nodes"].as_array_mut().unwrap().iter_mut().enumerate() {
        node["name"] = format!("Bone {number}").into();
    }
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = file[..8].to_vec();
    out.extend(u32::try_from(text.len() + file.len() - length).unwrap().to_le_bytes());
    out.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
    out.extend(b"JSON");
    out.extend(text);
    out.extend(&file[20 + length..]);
    out
}

#[test]
fn a_rig_map_is_printed_filled_in_and_taken_from_the_command_line_or_the_scenario() {
    let folder = std::env::temp_dir().join(format!("gaitway-rig-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    std::fs::write(file("hero.glb"), nameless_man()).unwrap();
    let scene = |name: &str, rig_maps: &str| {
        let text = format!(
            "name = \"place\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[[routes]]\nname = \"a\"\nwaypoints = [[2, 2], [7, 7]]\n\
             [population]\nagents = 2\navatars = [\"hero.glb\", \"female\"]\navatar_genders = [\"male\", \"female\"]\n{rig_maps}\n"
        );
        std::fs::write(file(name), text).unwrap();
        file(name)
    };
    let simulate = |scene: &str, more: &[&str]| {
        gaitway(&[&["simulate", scene, "--seconds", "0.5", "--backend", "cpu"], more].concat())
    };
    let plain = scene("plain.toml", "");
    let output = simulate(&plain, &[]);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("no humanoid") && error.contains("--rig-map"), "{error}");
    let mut map = String::from_utf8(output.stdout).unwrap();
    for joint in gaitway::gait::Joint::ALL {
        let filled = format!("\n{} = \"Bone {}\"", joint.name(), joint as usize);
        map = map.replace(&format!("\n{} = \"\"", joint.name()), &filled);
    }
    std::fs::write(file("hero.rig.toml"), &map).unwrap();
    let output = simulate(&plain, &["--rig-map", &file("hero.rig.toml")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let own = scene("own.toml", "rig_maps = [\"hero.rig.toml\"]");
    assert!(simulate(&own, &[]).status.success());
    // a map for somebody else
    std::fs::write(file("other.toml"), map.replace("avatar = \"hero\"", "avatar = \"heroine\"")).unwrap();
    let error = simulate(&plain, &["--rig-map", &file("other.toml")]).stderr;
    let error = String::from_utf8(error).unwrap();
    assert!(error.contains("heroine") && error.contains("hero, female"), "{error}");
    // the map of one is not that of another
    std::fs::copy(file("hero.glb"), file("villain.glb")).unwrap();
    let two =
        std::fs::read_to_string(&plain).unwrap().replace("\"female\"]\navatar", "\"villain.glb\"]\navatar");
    std::fs::write(file("two.toml"), two).unwrap();
    let output = simulate(&file("two.toml"), &["--rig-map", &file("hero.rig.toml")]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.code() == Some(1) && printed.contains("avatar = \"villain\""), "{printed}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_robot_looks_like_a_model_of_the_scenes_and_a_wrong_one_is_named() {
    let folder = std::env::temp_dir().join(format!("gaitway-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    let cart = gaitway::avatar::glb(&gaitway::avatar::generated(gaitway::avatar::Sex::Male));
    std::fs::write(file("cart.glb"), &cart).unwrap();
    std::fs::write(file("broken.glb"), &cart[..cart.len() / 2]).unwrap();
    let simulate = |outsider: &str| {
        let text = format!(
            "name = \"place\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[population]\nagents = 0\n\
             [[outsiders]]\n{outsider}\npath = [[0, 1, 1], [9, 8, 8]]\n"
        );
        std::fs::write(file("scene.toml"), text).unwrap();
        gaitway(&["simulate", &file("scene.toml"), "--seconds", "0.5", "--backend", "cpu"])
    };
    for good in [
        "kind = \"robot\"",
        "kind = \"robot\"\nmodel = \"cart.glb\"",
        "kind = \"vehicle\"\nmodel = \"cart.glb\"\nsize = [1, 1, 2]",
    ] {
        let output = simulate(good);
        assert!(output.status.success(), "{good}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for (wrong, words) in [
        ("kind = \"robot\"\nmodel = \"lost.glb\"", ["outsiders[0].model", "lost.glb", "cannot read"]),
        (
            "kind = \"robot\"\nmodel = \"broken.glb\"",
            ["outsiders[0].model", "broken.glb", "not a usable glTF"],
        ),
        ("kind = \"robot\"\nmodel = \"\"", ["scene.toml:", "outsiders[0].model", "a .glb or .gltf"]),
        (
            "kind = \"person\"\nmodel = \"cart.glb\"",
            ["scene.toml:", "outsiders[0].model", "population.avatars"],
        ),
        ("kind = \"robot\"\nsize = [1, 1, 1]", ["outsiders[0].size", "without a model", "radius"]),
        ("kind = \"robot\"\nmodel = \"cart.glb\"\nsize = [1, 0, 1]", ["outsiders[0].size", "0.05", "height"]),
    ] {
        let output = simulate(wrong);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{wrong}: {error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
