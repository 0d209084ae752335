//! Studies, by the program: from an empty folder to the gaits that a crowd walks with.

use super::{bad, good, json};

/// Standard error of a run that must fail with this exit code.
fn fails(arguments: &[&str], code: i32) -> String {
    let (found, error) = bad(arguments);
    assert_eq!(found, code, "{arguments:?}: {error}");
    error
}

#[test]
fn a_study_goes_from_an_empty_folder_to_a_library_that_raters_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let mine = at("mine");
    let made = json(&["study", "new", "eva-gaits", "--out", &mine, "--json"]);
    assert_eq!(made["missing"], serde_json::json!(["study.contact", "consent.text"]));
    assert_eq!(made["files"].as_array().unwrap().len(), 4);
    let message = fails(&["study", "new", "eva-gaits", "--out", &mine], 1);
    assert!(message.contains("--force"), "{message}");

    // filled in, people may take part
    let file = folder.path().join("mine/study.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    std::fs::write(&file, text.replacen("TO FILL IN: name and address of the lab", "A lab, A street 1", 1))
        .unwrap();
    let consent = folder.path().join("mine/consent.en.md");
    let text = std::fs::read_to_string(&consent).unwrap();
    std::fs::write(&consent, text.replace("TO FILL IN", "said")).unwrap();
    let checked = json(&["study", "check", &mine, "--json"]);
    assert_eq!(checked["summary"]["least"], 48, "48 gaits, 10 answers each, 10 a participant");

    let run = at("run");
    let found = json(&["study", "simulate", &mine, "--drop", "0.3", "--out", &run, "--json"]);
    assert!(found["filled"]["walks"]["fewest"].as_u64().unwrap() >= 10, "{found}");
    assert!(found["states"]["lapsed"].as_u64().unwrap() > 5 && found["files"].as_array().unwrap().len() == 4);
    let analysed = json(&["study", "analyse", &run, "--json"]);
    assert_eq!(
        (&analysed["participants"]["is_simulated"], &analysed["is_short"]),
        (&true.into(), &false.into())
    );
    let (library, rated) = (at("mine/library.glb"), at("rated.glb"));
    let ratings = at("run/ratings.csv");
    // the loop closes in one command, too: the same library to the last byte
    let looped = at("looped.glb");
    good(&["study", "analyse", &run, "--library", &library, "--rated", &looped]);
    let labels = json(&["gait", "ratings", &ratings, "--library", &library, "--out", &rated, "--json"]);
    assert_eq!(labels["videos"].as_array().unwrap().len(), 48);
    assert_eq!(std::fs::read(&looped).unwrap(), std::fs::read(&rated).unwrap());
    assert_eq!(analysed["ratings"]["kept"]["analysis"]["videos"], labels["videos"]);
    good(&[
        "simulate",
        "crossing",
        "--agents",
        "20",
        "--seconds",
        "1",
        "--backend",
        "cpu",
        "--library",
        &rated,
    ]);
}

#[test]
fn an_effect_of_a_condition_is_simulated_tested_and_told() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (run, page) = (at("run"), at("results.md"));
    let of =
        ["study", "simulate", "eva-agents", "--effect", "eva-g=1.5", "--participants", "24", "--out", &run];
    good(&of);
    good(&["study", "analyse", &run, "--out", &page]);
    let text = std::fs::read_to_string(&page).unwrap();
    assert!(
        text.starts_with("# Walking among people\n") && text.contains("All participants are simulated"),
        "{text}"
    );
    assert!(text.contains("## `scenes.presence.*`") && text.contains("## `identify.which`"), "{text}");
    let message = fails(&["study", "simulate", "eva-agents", "--effect", "evag=1"], 2);
    assert!(message.contains("it has baseline, eva-g, eva-o"), "{message}");
    let message = fails(&["study", "simulate", "eva-agents", "--drop", "1"], 2);
    assert!(message.contains("--drop 1: must be 0 to 0.9"), "{message}");
    let message = fails(&["study", "analyse", &at("none")], 1);
    assert!(message.contains("no answers.csv in it"), "{message}");
    std::fs::write(folder.path().join("run/answers.csv"), "participant\n").unwrap();
    let message = fails(&["study", "analyse", &run], 1);
    assert!(message.contains("answers.csv:1: no column \"front\"; found: participant"), "{message}");
}

#[test]
fn a_study_that_is_wrong_is_told_with_its_line_and_the_nearest_word() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("study.toml");
    good(&["study", "new", "eva-agents", "--out", folder.path().join("a").to_str().unwrap()]);
    let text = std::fs::read_to_string(folder.path().join("a/study.toml")).unwrap();
    std::fs::write(&file, text.replacen("minutes = 20", "minuets = 20", 1)).unwrap();
    let message = fails(&["study", "check", file.to_str().unwrap()], 1);
    assert!(message.contains("study.toml:10: ") && message.contains("did you mean `minutes`?"), "{message}");
    let message = fails(&["study", "check", "eva-gait"], 2);
    assert!(message.contains("did you mean \"eva-gaits\"?"), "{message}");
    let power = json(&["study", "power", "--w", "0.16", "--json"]);
    assert_eq!(power["people"], 31);
    assert!(fails(&["study", "power", "--w", "2"], 2).contains("W 2 lies outside [0, 1]"));
}

#[test]
fn a_report_is_a_folder_and_a_dataset_says_what_it_keeps_back() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (run, report, data) = (at("run"), at("report"), at("data"));
    good(&["study", "simulate", "eva-agents", "--participants", "24", "--out", &run]);
    good(&["study", "analyse", &run, &run, "--out", &report]);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).unwrap();
    let json: serde_json::Value = serde_json::from_str(&read("report/results.json")).unwrap();
    assert_eq!(json.as_array().unwrap().len(), 2);
    assert_eq!(read("report/results.md").matches("# Walking among people\n").count(), 2);
    assert!(read("report/index.html").matches("<figure>").count() > 12);
    let message = fails(&["study", "analyse", &run, "--out", &report], 1);
    assert!(message.contains("--force"), "{message}");
    let message =
        fails(&["study", "analyse", &run, "--library", &at("none.glb"), "--rated", &at("rated.glb")], 2);
    assert!(message.contains("asks for no ratings"), "{message}");
    let found = super::json(&["study", "export", &run, "--out", &data, "--json"]);
    let notes: Vec<&str> =
        found["notes"].as_array().unwrap().iter().map(|one| one["note"].as_str().unwrap()).collect();
    assert_eq!(notes, ["withheld", "simulated"]);
    for name in [
        "dataset_description.json",
        "data/study-evaagents_task-scenes_data.csv",
        "analysis/models.R",
        "materials/study.toml",
    ] {
        assert!(folder.path().join("data").join(name).is_file(), "{name}");
    }
}

#[test]
fn a_library_of_so_many_generated_gaits_has_all_emotions_alike() {
    let folder = tempfile::tempdir().unwrap();
    let mine = folder.path().join("mine");
    good(&["study", "new", "eva-gaits", "--gaits", "21", "--out", mine.to_str().unwrap()]);
    let listed = json(&["gait", "show", mine.join("library.glb").to_str().unwrap(), "--json"]);
    let gaits = listed["gaits"].as_array().unwrap();
    let count = |emotion: &str| gaits.iter().filter(|gait| gait["label"] == emotion).count();
    assert_eq!(gaits.len(), 21);
    assert_eq!(["happy", "angry", "sad", "neutral"].map(count), [6, 6, 5, 4]);
}

#[test]
#[cfg(unix)]
fn the_papers_whole_evaluation_runs_from_gaits_to_one_report() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("paper");
    let script = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("scripts/paper");
    let ran = std::process::Command::new(script)
        .arg(&out)
        .env("GAITWAY", env!("CARGO_BIN_EXE_gaitway"))
        .output()
        .unwrap();
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
    let page = std::fs::read_to_string(out.join("report/results.md")).unwrap();
    for part in [
        "## Beside the paper",
        "### Labels of gaits",
        "### Friedman tests of `scenes.presence.*`",
        "of 192 (",
        "of 342 gaits keep theirs",
    ] {
        assert!(page.contains(part), "{part}\n{page}");
    }
    let json: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(out.join("report/results.json")).unwrap()).unwrap();
    assert_eq!(json[0]["parts"][0]["gaits"]["count"], 342);
    assert_eq!(json[1]["participants"]["analysed"], 30);
    assert_eq!(json[2]["tests"][1]["kept"]["statistics"]["answers"], 192);
    assert!(out.join("data-gaits/analysis/ratings.csv").is_file());
}

#[test]
#[cfg(all(feature = "study", feature = "xr"))]
fn what_keeps_a_study_from_a_headset_is_said_before_anything_is_made() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    for study in ["eva-gaits", "eva-agents"] {
        good(&["study", "new", study, "--out", &at(study)]);
    }
    let (mine, data) = (at("eva-agents"), at("data"));
    let message = fails(&["study", "run", &mine, "--data", &data], 1);
    assert!(message.contains("study.contact"), "{message}");
    let message = fails(&["study", "run", &at("eva-gaits"), "--data", &data], 1);
    assert!(message.contains("study.where of eva-gaits has no \"headset\""), "{message}");
    for (option, value, wanted) in [
        ("--rows", "3", "0..12"),
        ("--language", "tlh", "the study is in en"),
        ("--rate", "0", "1 to 1000 Hz"),
    ] {
        let message = fails(&["study", "run", &mine, "--data", &data, option, value], 2);
        assert!(message.contains(wanted), "{message}");
    }
    assert!(!folder.path().join("data").exists());
    for name in ["study.toml", "consent-vr.en.md"] {
        let file = folder.path().join("eva-agents").join(name);
        let text = std::fs::read_to_string(&file).unwrap();
        std::fs::write(&file, text.replace("TO FILL IN", "Lab of Gaits")).unwrap();
    }
    let message = fails(&["study", "run", &mine, "--data", &data, "--rows", "0..25"], 1);
    assert!(message.contains("0..24"), "{message}");
    let message = fails(&["study", "run", &mine, "--data", &data, "--code", "K7Q01"], 1);
    assert!(message.contains("there is no such participant"), "{message}");
    let message = fails(&["study", "replay", &at("nothing")], 1);
    assert!(message.contains("nothing"), "{message}");
    assert!(good(&["study", "replay", &data]).contains("there are no recordings"));
}

#[test]
fn people_and_simulated_participants_are_analysed_apart_and_the_command_says_so() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    let at = run.to_str().unwrap();
    good(&["study", "simulate", "eva-agents", "--participants", "24", "--out", at]);
    // half of them are people
    for name in ["answers.csv", "participants.csv"] {
        let text = std::fs::read_to_string(run.join(name)).unwrap();
        let of = |line: &str| line.split(',').next().and_then(|number| number.parse::<u32>().ok());
        let line = |line: &str| match of(line) {
            Some(number) if number % 2 == 0 => line.replacen(",simulated,", ",web,", 1),
            Some(1) => line.replacen(",simulated,", ",headset,", 1),
            _ => line.to_owned(),
        };
        std::fs::write(run.join(name), text.lines().map(|one| line(one) + "\n").collect::<String>()).unwrap();
    }
    let message = fails(&["study", "analyse", at], 1);
    assert!(message.contains("12 people took part in a browser and 1 in a headset"), "{message}");
    assert!(message.contains("--front"), "{message}");
    let analyse = |front: &str| {
        let output = super::gaitway(&["study", "analyse", at, "--front", front, "--json"]);
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        (found["participants"].clone(), String::from_utf8(output.stderr).unwrap())
    };
    let (found, notes) = analyse("web");
    assert_eq!(found["fronts"], serde_json::json!({ "web": 12 }));
    assert_eq!(found["left_out"], serde_json::json!({ "headset": 1, "simulated": 11 }));
    assert!(notes.contains("left out: 11 participants of the front simulated"), "{notes}");
    assert_eq!(analyse("people").0["fronts"], serde_json::json!({ "web": 12, "headset": 1 }));
    assert_eq!(analyse("simulated").0["is_simulated"], true);
    let data = folder.path().join("data");
    let message = fails(&["study", "export", at, "--out", data.to_str().unwrap()], 1);
    assert!(message.contains("1 in a headset") && !data.exists(), "{message}");
}

#[test]
#[cfg(all(feature = "study", feature = "video", feature = "vulkan"))]
fn films_of_a_study_are_made_once_and_a_missing_device_is_noted_once() {
    if !super::has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (mine, run) = (at("mine"), at("run"));
    good(&["study", "new", "eva-agents", "--out", &mine]);
    let file = folder.path().join("mine/study.toml");
    let text = std::fs::read_to_string(&file).unwrap();
    // two scenes, no agents, nothing left to fill in: three conditions and the practice, each with three seeds
    let flow = text.lines().find(|line| line.starts_with("flow = ")).unwrap();
    let short = text
        .replace(flow, "flow = [\"consent\", \"practice\", \"scenes\"]")
        .replace("\"crossing\", \"garden\", \"parking\", \"scifi\"", "\"crossing\", \"garden\"")
        .replace("seconds = 45", "seconds = 0.5")
        .replace("seconds = 20,", "seconds = 0.5,")
        .replace("TO FILL IN", "A lab");
    std::fs::write(&file, short.split("\n[[analysis.test]]").next().unwrap()).unwrap();
    let consent = folder.path().join("mine/consent-vr.en.md");
    std::fs::write(&consent, "# Consent").unwrap();
    let clips = || super::gaitway(&["study", "clips", &mine, "--data", &run, "--size", "64x36"]);
    let first = clips();
    let notes = String::from_utf8(first.stderr).unwrap();
    assert!(first.status.success(), "{notes}");
    let made = notes.matches("note: clip ").count();
    assert!(made > 3, "{notes}");
    assert!(notes.matches("simulating on the CPU").count() <= 1, "{notes}");
    let again = String::from_utf8(clips().stderr).unwrap();
    assert!(again.contains(&format!("{made} clips, 0 to be made")), "{again}");
}
