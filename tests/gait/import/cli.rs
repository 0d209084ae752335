//! `gaitway gait import` as a program: folders, reasons, JSON, the same library however many threads.

use super::containers;
use super::legs;
use super::movements::OTHERS;
use super::walker::{self, Walker};
use crate::common::program;
use gaitway::gait::Recording;
use std::path::Path;
use std::process::Output;

fn gaitway(arguments: &[&str], folder: &Path, threads: &str) -> Output {
    let mut command = program();
    command.current_dir(folder).env("RAYON_NUM_THREADS", threads).args(["gait", "import"]).args(arguments);
    command.output().unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn a_folder_becomes_one_library_with_a_reason_for_what_is_left_out() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| {
        let path = folder.path().join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, bytes).unwrap();
    };
    let walk = |speed: f32| Walker { speed, ..Walker::default() }.take(4.0, 60.0);
    write("takes/anna/walk.bvh", walker::bvh(&walk(1.0), 100.0).as_bytes());
    write("takes/ben/walk.bvh", walker::bvh(&walk(1.2), 100.0).as_bytes());
    write("takes/ben/fast.c3d", &containers::c3d(&walk(1.5), 84, true, "mm"));
    write(
        "takes/ben/still.csv",
        walker::csv(&[&Walker { speed: 0.0, ..Walker::default() }.take(0.1, 30.0)], 1.0).as_bytes(),
    );
    write("takes/broken.bvh", b"HIERARCHY\nROOT hips\n{\n");
    write("takes/notes.md", b"no motion");
    write("takes/ben/labels.csv", b"file,subject,label\nfast.c3d,ben,angry\n");

    let output = gaitway(&["takes", "--all", "--json", "--out", "one.glb"], folder.path(), "1");
    assert!(output.status.success(), "{}", text(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let names: Vec<&str> =
        json["gaits"].as_array().unwrap().iter().map(|g| g["name"].as_str().unwrap()).collect();
    assert_eq!(
        names,
        [
            "anna/walk#1",
            "anna/walk#2",
            "anna/walk#3",
            "fast#1",
            "fast#2",
            "fast#3",
            "ben/walk#1",
            "ben/walk#2",
            "ben/walk#3"
        ]
    );
    assert_eq!(json["gaits"][3]["label"], "angry");
    let left: Vec<String> =
        json["left_out"].as_array().unwrap().iter().map(|l| l["reason"].to_string()).collect();
    assert_eq!(left.len(), 2, "{left:?}");
    assert!(
        left[0].contains("broken.bvh:3") && left[1].contains("still.csv") | left[1].contains("at least 12"),
        "{left:?}"
    );
    assert!(json["takes"][0]["report"].to_string().contains("centimetres"));
    let unread = &json["unread"];
    assert!(unread[0]["file"].as_str().unwrap().ends_with("notes.md") && unread[1].is_null(), "{unread}");
    assert_eq!(unread[0]["reason"], "unknown ending .md");

    let again = gaitway(&["takes", "--all", "--json", "--out", "two.glb"], folder.path(), "4");
    assert!(again.status.success());
    let [one, two] = ["one.glb", "two.glb"].map(|name| std::fs::read(folder.path().join(name)).unwrap());
    assert!(one == two, "the library must not depend on the number of threads");

    let output = gaitway(&["takes/ben", "--resample", "30"], folder.path(), "2");
    let table = text(&output.stdout);
    assert!(
        output.status.success() && table.contains("30.0") && table.contains("2 gaits of 3 takes"),
        "{table}"
    );
    assert!(text(&output.stderr).contains("left out: "), "{}", text(&output.stderr));
    let output = gaitway(&["takes"], folder.path(), "2");
    assert!(text(&output.stdout).contains("1 files not read"), "{}", text(&output.stdout));
    assert!(
        text(&output.stderr).contains("not read: takes/notes.md: unknown ending .md"),
        "{}",
        text(&output.stderr)
    );
}

#[test]
fn a_capture_of_the_legs_walks_in_crowds_and_is_refused_by_what_judges_gaits() {
    let folder = tempfile::tempdir().unwrap();
    let (names, frames) = legs::lower_body(&Walker::default().take(4.0, 60.0));
    let bytes = containers::c3d_points(&names, &frames, 60.0, 84, true, "mm");
    std::fs::write(folder.path().join("legs.c3d"), bytes).unwrap();
    std::fs::write(folder.path().join("labels.csv"), "file,label\nlegs.c3d,neutral\n").unwrap();
    let output = gaitway(&["legs.c3d", "--out", "legs.glb"], folder.path(), "1");
    assert!(output.status.success() && text(&output.stdout).contains("9 joints missing"), "{output:?}");

    let run = |arguments: &[&str]| program().current_dir(folder.path()).args(arguments).output().unwrap();
    let crowd = ["--agents", "2", "--seconds", "0.2", "--condition", "baseline", "--library", "legs.glb"];
    let output = run(&[&["simulate", "crossing", "--backend", "cpu"], &crowd[..]].concat());
    assert!(output.status.success(), "{output:?}");
    for arguments in [
        &["gait", "predict", "legs.c3d"][..],
        &["gait", "predict", "legs.glb"],
        &["gait", "label", "legs.glb", "--relabel", "--out", "l.glb"],
        &["gait", "train", "--data", "legs.glb", "--out", "m.json"],
        &["gait", "fit", "legs.glb", "--out", "f.gwh"],
        &["perceive", "crossing", "--backend", "cpu", "--agents", "2", "--library", "legs.glb"],
    ] {
        let output = run(arguments);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {output:?}");
        let said = text(&output.stderr);
        assert!(said.contains("not captured: spine, neck, head"), "{arguments:?}: {said}");
    }
    for file in ["l.glb", "m.json", "f.gwh"] {
        assert!(!folder.path().join(file).exists(), "{file}");
    }
}

#[test]
fn what_was_asked_for_by_name_and_failed_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("a.bvh"), "HIERARCHY").unwrap();
    std::fs::write(folder.path().join("walk.bvh"), walker::bvh(&Walker::default().take(4.0, 60.0), 1.0))
        .unwrap();
    std::fs::write(folder.path().join("map.toml"), "like = \"gaitway\"\nheads = \"head\"\n").unwrap();
    for (arguments, expected) in [
        (&["a.bvh", "walk.bvh"][..], "left out: a.bvh:1"),
        (&["nowhere.bvh"], "nowhere.bvh"),
        (&["walk.bvh", "--joint-map", "map.toml"], "map.toml:2: unknown key"),
        (&["walk.bvh", "--joint-map", "Mixmo"], "Bandai-Namco"),
        (&["walk.bvh", "--resample", "5000"], "5000"),
        (&["walk.bvh", "--joint-map", "Mixamo"], "joints not found"),
    ] {
        let output = gaitway(arguments, folder.path(), "2");
        let code = if arguments.contains(&"Mixmo") { 2 } else { 1 };
        assert_eq!(output.status.code(), Some(code), "{arguments:?}");
        let said = text(&output.stderr);
        assert!(said.contains(expected) && said.contains("error: "), "{arguments:?}: {said}");
    }
    let empty = folder.path().join("empty");
    std::fs::create_dir(&empty).unwrap();
    let output = gaitway(&["empty"], folder.path(), "1");
    assert!(!output.status.success() && text(&output.stderr).contains("no motion file"));
}

#[test]
fn a_refused_take_is_reported_like_the_others() {
    let folder = tempfile::tempdir().unwrap();
    let boxer = OTHERS.iter().find(|other| other.name.starts_with("boxing forwards")).unwrap();
    std::fs::write(folder.path().join("boxer.bvh"), walker::bvh(&boxer.take(6.0, 30.0, 0.002), 100.0))
        .unwrap();
    for arguments in [&["boxer.bvh", "--report"][..], &["boxer.bvh", "--report", "--out", "b.glb"]] {
        let output = gaitway(arguments, folder.path(), "1");
        assert_eq!(output.status.code(), Some(1), "{arguments:?}");
        let said = text(&output.stderr) + &text(&output.stdout);
        for line in [
            "centimetres",
            "up axis: +y",
            "frame rate: 30.00 Hz, as the file states",
            "joint map: gaitway",
            "heading: ",
            "strikes: ",
            "because: not walking: the feet do not pass each other",
        ] {
            assert!(said.contains(line), "{arguments:?} should say {line}: {said}");
        }
        assert!(!folder.path().join("b.glb").exists());
    }
    let output = gaitway(&["boxer.bvh", "--json", "--out", "b.glb"], folder.path(), "1");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["takes"][0]["reason"].as_str().unwrap().contains("not walking"), "{json}");
}

#[test]
fn a_given_rate_corrects_what_the_header_states() {
    let folder = tempfile::tempdir().unwrap();
    let walk = Walker::default().take(4.0, 60.0);
    let bvh = walker::bvh(&walk, 100.0);
    std::fs::write(
        folder.path().join("slow.bvh"),
        bvh.replace("Frame Time: 0.016666668", "Frame Time: 0.0416667"),
    )
    .unwrap();
    std::fs::write(folder.path().join("none.bvh"), bvh.replace("Frame Time: 0.016666668", "Frame Time: 0"))
        .unwrap();
    let wrong = Recording { frame_rate: 24.0, ..walk };
    std::fs::write(folder.path().join("slow.c3d"), containers::c3d(&wrong, 84, true, "mm")).unwrap();
    for name in ["slow.bvh", "none.bvh", "slow.c3d"] {
        let output = gaitway(&[name, "--rate", "60", "--json"], folder.path(), "1");
        assert!(output.status.success(), "{name}: {}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        let speed = json["gaits"][0]["v_des"].as_f64().unwrap();
        assert!((speed - 1.2).abs() < 0.02, "{name}: {speed} m/s");
        assert!(
            json["takes"][0]["report"].to_string().contains("60 Hz, as given (the file states"),
            "{json}"
        );
    }
    let output = gaitway(&["slow.bvh", "--json"], folder.path(), "1");
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert!(json["gaits"][0]["v_des"].as_f64().unwrap() < 0.6, "the header is believed otherwise");
    let output = gaitway(&["none.bvh"], folder.path(), "1");
    assert!(text(&output.stderr).contains("1 to 2000 Hz") && text(&output.stderr).contains("none.bvh:"));
}

#[test]
fn labels_are_read_in_any_form_and_unknown_words_are_errors() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).unwrap();
    write("walk1.bvh", &walker::bvh(&Walker::default().take(4.0, 60.0), 100.0));
    let import = || gaitway(&[".", "--json", "--out", "lib.glb"], folder.path(), "1");
    for table in [
        "File,Label\nwalk1.bvh,Happy\n",
        "\u{feff}file;label\r\nwalk1;HAPPY\r\n",
        "name\tEmotion\nwalk1\thappy\n",
    ] {
        write("Labels.CSV", table);
        let output = import();
        assert!(output.status.success(), "{table:?}: {}", text(&output.stderr));
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
        assert_eq!(json["gaits"][0]["label"], "happy", "{table:?}");
        std::fs::remove_file(folder.path().join("lib.glb")).unwrap();
    }
    write("Labels.CSV", "File,Label\nwalk1.bvh,hapy\n");
    let output = import();
    let told = text(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{told}");
    assert!(
        told.contains("Labels.CSV:2: ")
            && told.contains("\"hapy\"")
            && told.contains("did you mean \"happy\"?"),
        "{told}"
    );
    assert!(output.stdout.is_empty() && !folder.path().join("lib.glb").exists());
    write("Labels.CSV", "file,label\nwalk7.bvh,happy\n");
    let output = import();
    let told = text(&output.stderr);
    assert!(
        output.status.success() && told.contains("Labels.CSV: none of its 1 rows names a take"),
        "{told}"
    );
}
