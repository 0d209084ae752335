//! Simulations: the same crowd for the same arguments, on both backends, and what is refused.

use super::{bad, fails, gaitway, good, has_vulkan, json, program, refused};
use gaitway::Emotion;
use gaitway::library::GaitLibrary;
use serde_json::Value;

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
    let strides_of = |expression: &str| {
        let more = ["--set", expression, "--agents", "20", "--seconds", "1", "--json"];
        json(&[&["simulate", "garden", "--condition", "eva-o"][..], &more].concat())["state_hash"].clone()
    };
    let [usual, as_usual, faint] =
        ["seed=1", "population.expression=2", "population.expression=1"].map(strides_of);
    assert!(usual == as_usual && usual != faint, "{usual} {faint}");
    // the same on every machine; CHANGELOG.md lists each change of it as "results:"
    assert_eq!(a["state_hash"], "181176a1ef2e177a");
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
#[cfg(feature = "vulkan")]
fn a_device_that_is_wrong_gives_the_hash_of_the_cpu_unless_its_own_arithmetic_is_demanded() {
    if !has_vulkan() {
        return;
    }
    let crowd =
        ["simulate", "crossing", "--agents", "300", "--seconds", "4", "--condition", "eva-g", "--json"];
    let on_cpu = json(&[&crowd[..], &["--backend", "cpu"]].concat());
    let on = |faults: &str, options: &[&str]| -> Value {
        let mut command = program();
        command.args(crowd).args(["--backend", "vulkan"]).args(options);
        let output = command.env("GAITWAY_WRONG_ARITHMETIC", faults).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice(&output.stdout).unwrap()
    };
    assert_eq!((&on_cpu["arithmetic"], on_cpu["state_hash"].is_string()), (&"native".into(), true));
    let careful = on("by-3", &[]);
    assert_eq!(careful["arithmetic"], "careful (division, square root)");
    assert_eq!(careful["state_hash"], on_cpu["state_hash"]);
    assert!(careful["device"].as_str().unwrap().ends_with("arithmetic careful (division, square root)"));
    let native = on("by-3", &["--arithmetic", "native"]);
    assert_eq!(native["arithmetic"], "native");
    assert_ne!(native["state_hash"], on_cpu["state_hash"]);
    let forced = on("", &["--arithmetic", "careful"]);
    assert_eq!(forced["arithmetic"], "careful (division, square root, minimum and maximum)");
    assert_eq!(forced["state_hash"], on_cpu["state_hash"]);
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
    refused(
        &["simulate", "crossing", "--set", "population.expression=-1"],
        "population.expression = -1",
        "0 to 3",
    );
    refused(
        &["simulate", "crossing", "--set", "population.individuals=1.5"],
        "population.individuals = 1.5",
        "0 walks every gait as it is",
    );
    refused(&["simulate", "crossing", "--seconds", "1e9"], "--seconds = 1000000000", "hint: ");
    refused(&["simulate", "crossing", "--seconds", "NaN"], "--seconds = NaN", "hint: ");
    refused(&["simulate", "crossing", "--agents", "1000001"], "1000001", "0..=1000000");
    refused(&["simulate", "crossing", "--backend", "cpu", "--device", "x"], "--device", "hint: leave");
    refused(&["simulate", "garden", "--out", "x.sqlite", "--fps", "7"], "--fps 7", "hint: use 30");
    refused(&["simulate", "crossing", "--expression", "3.1"], "3.1", "must be 0 to 3");
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
fn without_a_gpu_auto_takes_the_cpu_with_one_line_and_without_any_device_vulkan_is_refused() {
    let devices = json(&["devices", "--json"]);
    if devices["crowds"].is_u64() {
        println!("skipped: there is a GPU");
        return;
    }
    if !devices["best"].is_u64() {
        fails(&["simulate", "crossing", "--backend", "vulkan"], "Vulkan", "cpu");
    }
    let output = program()
        .env_remove("GAITWAY_DEVICE")
        .args(["simulate", "crossing", "--seconds", "1"])
        .output()
        .unwrap();
    assert!(output.status.success());
    let error = String::from_utf8(output.stderr).unwrap();
    let expected = usize::from(cfg!(feature = "vulkan"));
    assert_eq!(error.lines().filter(|line| line.starts_with("note: ")).count(), expected, "{error}");
    let said = String::from_utf8(output.stdout).unwrap();
    assert!(said.lines().any(|line| line.starts_with("device") && line.contains(" CPU")), "{said}");
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
