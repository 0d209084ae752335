//! Sweeps: plans, runs that are whole or not there, and what a second start does.

use super::{fails, good, json, program, refused};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Stdio;
use std::time::{Duration, Instant};

const SWEEP: &str = "scenario = \"garden\"\nseconds = 1\nseeds = [3, 4]\ntrajectories = true\n[vary]\n\"population.agents\" = [6, 9]\n";

/// Plans a sweep in a folder; the paths of plan and runs.
fn plan(folder: &Path, sweep: &str) -> [String; 2] {
    std::fs::write(folder.join("sweep.toml"), sweep).unwrap();
    let path = |name: &str| folder.join(name).to_str().unwrap().to_owned();
    let planned = json(&["plan", &path("sweep.toml"), "--out", &path("plan.jsonl"), "--json"]);
    assert_eq!(planned["runs"], 4);
    [path("plan.jsonl"), path("runs")]
}

/// State hashes by key of all runs in a folder; each must be whole.
fn hashes(runs: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for entry in std::fs::read_dir(runs).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_str().unwrap().to_owned();
        let Some(key) = name.strip_prefix("run=") else { continue };
        let record: Value = serde_json::from_slice(&std::fs::read(path.join("run.json")).unwrap()).unwrap();
        assert_eq!(record["key"], key);
        let mut files: Vec<_> =
            std::fs::read_dir(&path).unwrap().map(|file| file.unwrap().file_name()).collect();
        files.sort();
        assert_eq!(files, ["agents.parquet", "run.json", "trajectories.parquet"]);
        found.insert(key.to_owned(), record["state_hash"].as_str().unwrap().to_owned());
    }
    found
}

#[test]
fn a_sweep_is_what_simulate_does_one_by_one_and_a_second_start_does_nothing() {
    let folder = tempfile::tempdir().unwrap();
    let [plan, runs] = plan(folder.path(), SWEEP);
    let run =
        |more: &[&str]| json(&[&["run", &plan, "--out", &runs, "--backend", "cpu", "--json"], more].concat());
    let two = run(&["--index", "1..3"]);
    assert_eq!([&two["runs"], &two["done"], &two["skipped"]], [2, 2, 0]);
    let status = json(&["plan", &plan, "--status", "--out", &runs, "--json"]);
    assert_eq!(status["missing_runs"], serde_json::json!([[0, 1], [3, 4]]));
    let all = run(&[]);
    assert_eq!([&all["runs"], &all["done"], &all["skipped"]], [4, 2, 2]);
    let again = run(&[]);
    assert_eq!([&again["done"], &again["skipped"]], [0, 4]);
    let found = hashes(&runs);
    assert_eq!(found.len(), 4);
    for record in found.keys().map(|key| Path::new(&runs).join(format!("run={key}"))) {
        let text = std::fs::read_to_string(record.join("run.json")).unwrap();
        let own: Value = serde_json::from_str(&text).unwrap();
        let (agents, seed) = (own["values"]["population.agents"].to_string(), own["seed"].to_string());
        let set = format!("population.agents={agents}");
        let alone = json(&[
            "simulate",
            "garden",
            "--set",
            &set,
            "--seed",
            &seed,
            "--seconds",
            "1",
            "--backend",
            "cpu",
            "--json",
        ]);
        assert_eq!(own["state_hash"], alone["state_hash"], "{agents} {seed}");
        assert_eq!(text.lines().count(), 1, "a line each, for readers of many");
        let walked = record.join("trajectories.parquet");
        let replayed = json(&["replay", walked.to_str().unwrap(), "--backend", "cpu", "--json"]);
        assert!(replayed["drift"].as_f64().unwrap() < 1e-6, "{}", replayed["drift"]);
        assert_eq!(replayed["recording"]["people"].to_string(), agents);
    }
}

#[test]
fn the_environment_of_a_scheduler_says_which_run_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let [plan, runs] = plan(folder.path(), SWEEP);
    for (name, index) in [("SLURM_ARRAY_TASK_ID", "0"), ("JOB_COMPLETION_INDEX", "3")] {
        let mut command = program();
        command.args(["run", &plan, "--out", &runs, "--backend", "cpu"]).env(name, index);
        assert!(command.output().unwrap().status.success());
    }
    let status = json(&["plan", &plan, "--status", "--out", &runs, "--json"]);
    assert_eq!(status["missing_runs"], serde_json::json!([[1, 3]]));
    let mut wrong = program();
    wrong.args(["run", &plan, "--out", &runs]).env("SLURM_ARRAY_TASK_ID", "first");
    let output = wrong.output().unwrap();
    assert_eq!(output.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&output.stderr).contains("SLURM_ARRAY_TASK_ID=first"));
}

#[test]
fn processes_that_are_killed_and_that_race_leave_the_runs_of_a_quiet_one() {
    let folder = tempfile::tempdir().unwrap();
    let [plan, runs] = plan(folder.path(), SWEEP);
    let quiet = folder.path().join("quiet");
    let quiet = quiet.to_str().unwrap();
    let took = Instant::now();
    good(&["run", &plan, "--out", quiet, "--backend", "cpu"]);
    let took = took.elapsed();
    let start = || {
        let mut command = program();
        command
            .args(["run", &plan, "--out", &runs, "--backend", "cpu"])
            .stdout(Stdio::null())
            .stderr(Stdio::null());
        command.spawn().unwrap()
    };
    for part in 1..=4_u32 {
        let mut process = start();
        std::thread::sleep(took * part / 9);
        process.kill().unwrap();
        process.wait().unwrap();
        if Path::new(&runs).exists() {
            hashes(&runs); // whatever has its name is whole
        }
    }
    let racing: Vec<_> = (0..2).map(|_| start()).collect();
    for mut process in racing {
        assert!(process.wait().unwrap().success());
    }
    assert_eq!(hashes(&runs), hashes(quiet));
    // what the killed ones left is young, and stays
    let left =
        json(&["plan", &plan, "--status", "--out", &runs, "--json"])["unfinished"].as_array().unwrap().len();
    assert!(good(&["plan", "--clean", "--out", &runs]).contains("nothing was left behind"));
    let old = std::time::SystemTime::now() - Duration::from_secs(90_000);
    for entry in std::fs::read_dir(&runs).unwrap().map(|entry| entry.unwrap().path()) {
        for file in std::fs::read_dir(&entry).unwrap().map(|file| file.unwrap().path()).chain([entry.clone()])
        {
            std::fs::File::open(file).unwrap().set_modified(old).unwrap();
        }
    }
    let removed = json(&["plan", "--clean", "--out", &runs, "--json"])["removed"].as_array().unwrap().len();
    assert_eq!(removed, left);
    assert_eq!(hashes(&runs), hashes(quiet));
}

#[test]
fn what_is_wrong_with_a_sweep_is_said_before_anything_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let [made, runs] = plan(folder.path(), SWEEP);
    refused(&["run", &made, "--out", &runs, "--index", "4"], "the plan has 4 runs", "use 0 to 3");
    refused(&["run", &made, "--out", &runs, "--index", "2..1"], "0..100", "");
    assert!(!Path::new(&runs).exists());
    let sweep = folder.path().join("sweep.toml");
    let sweep = sweep.to_str().unwrap();
    fails(&["plan", sweep, "--out", &made], "exists already", "--force");
    fails(&["run", sweep, "--out", &runs], "not that of a plan", "plan the sweep");
    std::fs::write(sweep, "scenario = \"garden\"\n[vary]\npopulation.agent = [1]\n").unwrap();
    fails(&["plan", sweep, "--out", &made, "--force"], "population.agent=1", "");
    std::fs::write(sweep, "scenario = \"garden\"\nuntil_empty = true\n").unwrap();
    good(&["plan", sweep, "--out", &made, "--force"]);
    let output = super::gaitway(&["run", &made, "--out", &runs]);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(
        output.status.code() == Some(1) && error.contains("run 0 (") && error.contains("no exit"),
        "{error}"
    );
    assert!(hashes(&runs).is_empty());
}

#[test]
fn a_file_that_a_scenario_names_is_part_of_its_plan() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("room.wkt", "POLYGON ((0 0, 20 0, 20 10, 0 10, 0 0))");
    write(
        "hall.toml",
        "name = \"hall\"\nwalkable_file = \"room.wkt\"\n[population]\nagents = 3\n[[routes]]\nname = \"a\"\nwaypoints = [[2, -5], [18, -5]]\n",
    );
    let sweep = "scenario = \"hall.toml\"\nseconds = 0.5\nseeds = 4\nagents = false\n";
    let [plan, runs] = plan(folder.path(), sweep);
    let run =
        |index: &str| json(&["run", &plan, "--out", &runs, "--index", index, "--backend", "cpu", "--json"]);
    assert_eq!(run("0")["done"], 1);
    write("room.wkt", "POLYGON ((0 0, 20 0, 20 11, 0 11, 0 0))");
    fails(&["run", &plan, "--out", &runs, "--index", "1"], "room.wkt", "plan the sweep again");
}

#[test]
fn runs_that_are_done_together_are_those_that_are_done_one_by_one() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    // halls that are empty at different times, and one whose people have no place
    let sweep = format!(
        "scenario = {:?}\nuntil_empty = true\nseconds = 40\nseeds = [1, 2]\n[vary]\n\"population.agents\" = [3, 25, 9999]\n",
        super::common::repository().join("assets/starters/hall.toml")
    );
    std::fs::write(path("sweep.toml"), sweep).unwrap();
    good(&["plan", &path("sweep.toml"), "--out", &path("plan.jsonl")]);
    let with_vulkan = cfg!(feature = "vulkan") && super::common::gpu::is_required();
    let backends = if with_vulkan { &["cpu", "vulkan"][..] } else { &["cpu"] };
    let hashes = |backend: &str, together: &str| {
        let runs = path(&format!("{backend}-{together}"));
        let plan = path("plan.jsonl");
        let output = super::gaitway(&[
            "run",
            &plan,
            "--out",
            &runs,
            "--backend",
            backend,
            "--together",
            together,
            "--json",
        ]);
        assert_eq!(output.status.code(), Some(1));
        let told: Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!((&told["done"], told["failed"].as_array().unwrap().len()), (&4.into(), 2), "{told}");
        let entries = std::fs::read_dir(&runs).unwrap().map(|entry| entry.unwrap().file_name());
        assert_eq!(entries.filter(|name| name.to_str().unwrap().starts_with("run=")).count(), 4);
        told["hashes"].clone()
    };
    let one_by_one = hashes("cpu", "1");
    for backend in backends {
        assert_eq!(hashes(backend, "3"), one_by_one, "{backend}");
    }
}

/// The first block of a language in a document.
fn block<'a>(document: &'a str, language: &str) -> &'a str {
    let (_, rest) = document.split_once(&format!("```{language}\n")).unwrap();
    rest.split("```").next().unwrap_or_default()
}

/// Replaces what the guide says by what a test has time for; the guide must say it.
fn smaller(text: &str, changes: &[(&str, &str)]) -> String {
    changes.iter().fold(text.to_owned(), |text, (long, short)| {
        assert!(text.contains(long), "the guide no longer says `{long}`");
        text.replace(long, short)
    })
}

#[test]
fn every_command_of_the_guide_runs_in_its_order() {
    let guide = Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/sweeps.md");
    let guide = std::fs::read_to_string(guide).unwrap();
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    good(&["scene", "new", "--like", "hall", "--out", &path("hall.toml")]);
    // 12 short runs of few people
    let changes = [
        ("seconds = 60", "seconds = 0.1"),
        ("seeds = 6", "seeds = 3"),
        ("[200, 400]", "[3, 4]"),
        ("--index 0..100", "--index 0..12"),
        ("--index 70..80", "--index 7..9"),
    ];
    let guide = smaller(&guide, &changes);
    std::fs::write(path("sweep.toml"), block(&guide, "toml")).unwrap();
    let blocks = guide.split("```sh\n").skip(1).filter_map(|rest| rest.split("```").next());
    let lines: Vec<&str> = blocks.flat_map(str::lines).filter(|line| !line.trim().is_empty()).collect();
    assert!(lines.len() >= 8, "{lines:?}");
    for line in lines {
        let command = line.split(" #").next().unwrap_or_default().replace("/shared/runs", &path("shared"));
        let mut words = command.split_whitespace();
        assert_eq!(words.next(), Some("gaitway"), "{line}: a command that this test cannot run");
        let words: Vec<&str> = words.collect();
        let is_planning = words.first() == Some(&"plan") && words.contains(&"sweep.toml");
        let force =
            if is_planning && folder.path().join("plan.jsonl").exists() { &["--force"][..] } else { &[] };
        let output = program().args(&words).args(force).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {said}");
    }
    let done = |name: &str| std::fs::read_dir(path(name)).unwrap().count();
    assert_eq!((done("runs"), done("shared")), (12, 2));
}
