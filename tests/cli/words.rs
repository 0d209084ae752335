//! The words of the command line: what is refused and how, what is kept, how much is said.

use super::{bad, fails, gaitway, good, json, program, refused};
use std::collections::BTreeSet;

#[test]
fn negative_numbers_are_values_and_errors_name_their_range() {
    refused(&["simulate", "crossing", "--agents", "-1"], "-1", "0..=1000000");
    refused(&["simulate", "crossing", "--seed", "-1"], "--seed", "a seed is a whole number");
    refused(
        &["simulate", "crossing", "--gait-speed", "90", "--backend", "cpu"],
        "population.prefer.speed = [90, 90]",
        "hint: ",
    );
    refused(&["simulate", "crossing", "--seconds", "-1"], "--seconds = -1", "0 to 86400");
    refused(&["bench", "--agents", "10,-5"], "-5", "0 to 1000000");
    refused(&["simulate", "crossing", "--fps", "-5", "--out", "x.csv"], "--fps -5", "hint: use 30");
    let scale = ["gait", "walk", "--emotion", "sad", "--speed", "-1", "--out", "x.csv"];
    refused(&scale, "speed = -1", "0.1 to 2.6");
}

#[test]
fn the_environment_is_checked_whatever_is_done() {
    if !cfg!(feature = "vulkan") {
        return;
    }
    for (variable, names) in [
        ("GAITWAY_VALIDATION", "off, core, sync, gpu-av"),
        ("GAITWAY_ARITHMETIC", "auto, native or careful"),
        ("GAITWAY_DRAWS", "auto, indirect or direct"),
        ("GAITWAY_WRONG_ARITHMETIC", "by-1, by-3, slip, zeros or flush"),
    ] {
        let output = program().arg("devices").env(variable, "nosuch").output().unwrap();
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains(&format!("{variable}=nosuch")) && error.contains(names), "{error}");
    }
}

/// Options (`--word`) in a text.
fn options(text: &str) -> BTreeSet<&str> {
    let words = text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '-'));
    words.filter(|word| word.strip_prefix("--").is_some_and(|name| !name.is_empty())).collect()
}

#[test]
fn hints_name_only_options_that_the_command_has() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("x.png");
    let out = out.to_str().unwrap();
    let missing = ["--device", "no such device"];
    for command in [
        &["simulate", "garden", "--backend", "vulkan"][..],
        &["bench", "--agents", "10", "--backend", "vulkan"],
        &["perceive", "garden", "--backend", "vulkan"],
        &["validate", "single-file", "--backend", "vulkan"],
        &["render", "garden", "--out", out],
        &["verify", "--quick"],
    ] {
        if !cfg!(feature = "vulkan") && ["render", "verify"].contains(&command[0]) {
            continue;
        }
        let (_, error) = bad(&[command, &missing].concat());
        let help = good(&[command[0], "--help"]);
        let hint = error.lines().find(|line| line.starts_with("hint: ")).unwrap_or_default();
        for option in options(hint) {
            assert!(help.contains(option), "{command:?}: {option} in {error}");
        }
    }
}

#[test]
fn what_exists_is_kept_unless_forced() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("kept.csv");
    std::fs::write(&path, "mine").unwrap();
    let file = path.to_str().unwrap();
    let walk = ["gait", "walk", "--emotion", "sad", "--out", file];
    let simulate = ["simulate", "garden", "--seconds", "0.1", "--backend", "cpu", "--out", file];
    let inside = folder.path().to_str().unwrap();
    fails(&walk, "exists already", "hint: choose another name, or add --force");
    fails(&simulate, "exists already", "--force");
    fails(
        &["validate", "single-file", "--quick", "--backend", "cpu", "--out", inside],
        "something in it",
        "--force",
    );
    fails(&["man", "--out", inside], "something in it", "--force");
    // whatever the option is called, and before anything is read
    let outputs = [
        &["replay", "nowhere.csv", "--out", file][..],
        &["gait", "show", "nowhere.glb", "--videos", inside],
        &["gait", "ratings", "nowhere.csv", "--csv", file],
        &["gait", "ratings", "nowhere.csv", "--figures", inside],
        #[cfg(feature = "vulkan")]
        &["replay", "nowhere.csv", "--render", file],
        #[cfg(feature = "view")]
        &["view", "nowhere.toml", "--seconds", "1", "--shot", file],
        #[cfg(feature = "xr")]
        &["xr", "nowhere.toml", "--shots", inside],
    ];
    for command in outputs {
        fails(
            command,
            if command.contains(&inside) { "something in it" } else { "exists already" },
            "--force",
        );
    }
    assert_eq!(std::fs::read_to_string(&path).unwrap(), "mine");
    good(&[&walk[..], &["--force"]].concat());
    assert_ne!(std::fs::read_to_string(&path).unwrap(), "mine");
    good(&[&["--force"], &simulate[..]].concat());
}

#[test]
fn scenes_and_tests_are_listed_for_people_and_machines() {
    assert!(good(&["simulate", "--list"]).contains("crossing"));
    assert!(good(&["scene", "list"]).contains("fountain"));
    let scenes = json(&["perceive", "--list", "--json"]);
    assert_eq!((&scenes["scenes"][1]["name"], &scenes["scenes"][1]["agents"]), (&"garden".into(), &4.into()));
    let tests = json(&["validate", "--list", "--json"]);
    assert!(tests["tests"].as_array().unwrap().len() > 5, "{tests}");
    assert_eq!(bad(&["simulate", "--agents", "3"]).0, 2, "a scene is needed otherwise");
}

#[test]
fn quiet_says_results_only_and_verbose_says_more() {
    let said = |manner: &[&str]| {
        let run = ["simulate", "garden", "--seconds", "0.1", "--backend", "cpu", "--json"];
        let output = gaitway(&[&run[..], manner].concat());
        assert!(output.status.success() && output.stdout.starts_with(b"{"));
        String::from_utf8(output.stderr).unwrap()
    };
    assert_eq!(said(&["-q"]), "");
    // not even what is noted
    let folder = tempfile::tempdir().unwrap();
    let walk = folder.path().join("walk.csv");
    let walk = walk.to_str().unwrap();
    good(&["gait", "walk", "--emotion", "sad", "--out", walk]);
    let noted = |manner: &[&str]| gaitway(&[&["gait", "show", walk], manner].concat()).stderr;
    assert!(!noted(&[]).is_empty() && noted(&["-q"]).is_empty());
    let more = said(&["-v"]);
    assert!(more.contains("scene garden: 4 agents, seed") && more.contains("threads"), "{more}");
    assert_eq!(bad(&["-q", "-v", "devices"]).0, 2);
    // errors are printed all the same
    refused(&["-q", "simulate", "nowhere"], "nowhere", "crossing, garden");
}

#[test]
fn shells_and_man_learn_every_command() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = good(&["completions", shell]);
        assert!(script.contains("simulate") && script.contains("force"), "{shell}");
    }
    assert!(good(&["man"]).contains(".TH gaitway 1"));
    let folder = tempfile::tempdir().unwrap();
    good(&["man", "--out", folder.path().to_str().unwrap()]);
    for page in ["gaitway", "gaitway-simulate", "gaitway-gait-import"] {
        let text = std::fs::read_to_string(folder.path().join(format!("{page}.1"))).unwrap();
        assert!(
            text.contains("EXTRA") || text.contains("Exit codes") || text.contains("Examples"),
            "{page}: {text}"
        );
    }
    assert!(!folder.path().join("gaitway-mirror.1").exists());
}
