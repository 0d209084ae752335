//! `gaitway gait train`, `predict` and `label` as people use them.

use crate::common::program;
use gaitway::Emotion;
use gaitway::gait::import::import_file;
use gaitway::gait::stride::best;
use gaitway::gait::{Gait, Joint, LabelOrigin};
use gaitway::library::GaitLibrary;
use gaitway::perception::Method as _;
use gaitway::perception::perceiver::PhasePerceiver;
use serde_json::Value;
use std::process::Output;

/// Runs `gaitway gait`.
fn gait_command(arguments: &[&str]) -> Output {
    program().arg("gait").args(arguments).output().unwrap()
}

fn good(arguments: &[&str]) -> String {
    let output = gait_command(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(code: i32, arguments: &[&str], want: &str) {
    let output = gait_command(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.stdout.is_empty() && output.status.code() == Some(code), "{arguments:?}: {error}");
    assert!(error.contains("error: ") && error.contains(want), "{arguments:?}: {error}");
}

#[test]
fn a_model_is_trained_predicts_and_grows_a_library() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walkers, model, grown) = (path("walkers.glb"), path("model.json"), path("grown.glb"));
    GaitLibrary::generated(21, 10).unwrap().save_glb(std::path::Path::new(&walkers)).unwrap();

    let trained =
        good(&["train", "--data", &walkers, "--folds", "stratified", "--k", "4", "--json", "--out", &model]);
    let trained: Value = serde_json::from_str(&trained).unwrap();
    assert_eq!(trained["gaits"], 80);
    assert_eq!(trained["counts"], serde_json::json!([20, 20, 20, 20]));
    assert!(trained["evaluation"]["accuracy_mean"].as_f64().unwrap() > 0.6, "{trained}");
    assert_eq!(trained["evaluation"]["seeds"], serde_json::json!([0, 1, 2, 3, 4]));

    assert_eq!(
        (&trained["method"], &trained["preparation"]),
        (&"phase-perceiver".into(), &"repaired".into())
    );

    // a new walker, known by nothing but where its joints are
    let sad = path("sad.csv");
    good(&["walk", "--emotion", "sad", "--out", &sad]);
    let found: Value = serde_json::from_str(&good(&["predict", &sad, "--json", "--model", &model])).unwrap();
    assert!(
        found["model"].as_str().unwrap().contains("% right on gaits held out (4-fold, stratified"),
        "{found}"
    );
    let row = &found["gaits"][0];
    assert_eq!(
        (&row["name"], &row["emotion"], &row["is_unlike"]),
        (&"sad".into(), &"sad".into(), &false.into())
    );
    let probabilities = row["probabilities"].as_array().unwrap().iter().map(|p| p.as_f64().unwrap());
    assert!((probabilities.clone().sum::<f64>() - 1.0).abs() < 1e-9);
    let mut sorted: Vec<f64> = probabilities.clone().collect();
    sorted.sort_by(f64::total_cmp);
    assert!(
        probabilities.clone().nth(2) == sorted.last().copied(),
        "the emotion told is the most probable one"
    );
    assert!((row["margin"].as_f64().unwrap() - (sorted[3] - sorted[2])).abs() < 1e-12);
    assert!(row["novelty"].as_f64().unwrap() < 1.0, "{row}");
    // the same bits as in memory
    let library = GaitLibrary::load_glb(std::path::Path::new(&walkers)).unwrap();
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        library.gaits().iter().map(|gait| (gait, gait.label.unwrap())).unzip();
    let in_memory = PhasePerceiver::default().train(&gaits, &emotions, 0).unwrap();
    let take = import_file(std::path::Path::new(&sad)).unwrap().remove(0);
    let want = in_memory.probabilities(&best(&take).unwrap());
    assert!(probabilities.zip(want).all(|(found, want)| found.to_bits() == want.to_bits()));

    let table = good(&["predict", &sad]);
    assert!(table.contains("seen as") && table.contains("built in: phase-perceiver"), "{table}");
    assert!(table.contains("232 gaits of 92 people") && table.contains("right on gaits held out"), "{table}");

    good(&["label", &sad, "--library", &walkers, "--model", &model, "--out", &grown]);
    let library = GaitLibrary::load_glb(&grown).unwrap();
    assert_eq!(library.gaits().len(), 81);
    let origins: Vec<_> = library.gaits().iter().map(|gait| gait.provenance.label_origin).collect();
    assert_eq!(origins[80], Some(LabelOrigin::Predicted));
    assert!(origins[..80].iter().all(|origin| *origin == Some(LabelOrigin::Generated)));
}

#[test]
fn what_the_model_has_not_seen_the_like_of_is_called_unlike_and_not_labelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walk, odd, out) = (path("walk.csv"), path("odd.glb"), path("out.glb"));
    good(&["walk", "--emotion", "neutral", "--out", &walk]);
    let take = import_file(std::path::Path::new(&walk)).unwrap().remove(0);
    let mut gait = Gait { name: "odd".into(), label: None, ..best(&take).unwrap() };
    for pose in &mut gait.poses {
        // both arms straight up
        for joint in [Joint::LeftElbow, Joint::LeftHand, Joint::RightElbow, Joint::RightHand] {
            pose[joint as usize].y = 2.0 * pose[Joint::Neck as usize].y - pose[joint as usize].y;
        }
    }
    GaitLibrary::from_gaits(vec![gait]).unwrap().save_glb(std::path::Path::new(&odd)).unwrap();
    let found: Value = serde_json::from_str(&good(&["predict", &odd, &walk, "--json"])).unwrap();
    let (unlike, like) = (&found["gaits"][0], &found["gaits"][1]);
    assert!(
        unlike["is_unlike"] == true
            && unlike["emotion"].is_null()
            && unlike["novelty"].as_f64().unwrap() > 1.0
    );
    assert!(like["is_unlike"] == false && like["emotion"] == "neutral", "{found}");
    assert_eq!(found["unlike"], 1);
    let output = gait_command(&["predict", &odd]);
    let (table, told) =
        (String::from_utf8(output.stdout).unwrap(), String::from_utf8(output.stderr).unwrap());
    assert!(table.contains("unlike") && told.contains("unlike what the model has seen"), "{table}{told}");
    assert!(good(&["predict", &odd, "--even-unlike", "--json"]).contains("\"emotion\": \""));

    refused(1, &["label", &odd, "--out", &out], "1 unlike what the model has seen");
    assert!(!std::path::Path::new(&out).exists());
    good(&["label", &odd, "--even-unlike", "--out", &out]);
    let library = GaitLibrary::load_glb(std::path::Path::new(&out)).unwrap();
    assert_eq!(library.gaits().last().unwrap().provenance.label_origin, Some(LabelOrigin::Predicted));
}

#[test]
fn a_model_of_gaits_as_published_is_asked_about_no_others() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walk, walkers, model) = (path("walk.csv"), path("walkers.glb"), path("model.json"));
    good(&["walk", "--emotion", "happy", "--out", &walk]);
    GaitLibrary::generated(21, 10).unwrap().save_glb(std::path::Path::new(&walkers)).unwrap();
    refused(
        1,
        &["train", "--as-published", "--data", &walkers, "--out", &model],
        "not E-Gait as it was published",
    );
    good(&["train", "--data", &walkers, "--folds", "none", "--out", &model]);
    let text = std::fs::read_to_string(&model).unwrap();
    assert!(text.contains("\"preparation\":\"repaired\""));
    std::fs::write(&model, text.replacen("\"repaired\"", "\"as-published\"", 1)).unwrap();
    for file in [&walk, &walkers] {
        refused(1, &["predict", file, "--model", &model], "not E-Gait as it was published");
    }
}

#[test]
fn a_model_remembers_that_its_gaits_were_as_published() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    // walkers in the dress of E-Gait: one cycle each, the root pinned
    let library = GaitLibrary::generated(21, 10).unwrap();
    let names = Joint::ALL.map(|joint| joint.name().replace("left_", "l_").replace("right_", "r_"));
    let columns: Vec<String> = names.iter().map(|name| format!("{name}_x,{name}_y,{name}_z")).collect();
    let (mut walks, mut labels) = (format!("key,frame,{}\n", columns.join(",")), "key,label\n".to_owned());
    for gait in library.gaits() {
        for (frame, pose) in gait.poses.iter().enumerate() {
            let places =
                pose.map(|point| (point - pose[0]).to_array().map(|part| part.to_string()).join(","));
            walks += &format!("{},{frame},{}\n", gait.name, places.join(","));
        }
        labels += &format!("{},{}\n", gait.name, gait.label.unwrap());
    }
    std::fs::write(path("walks.csv"), walks).unwrap();
    std::fs::write(path("labels.csv"), labels).unwrap();
    let model = path("model.json");
    let train = [
        "train",
        "--as-published",
        "--folds",
        "none",
        "--json",
        "--data",
        &path("walks.csv"),
        "--out",
        &model,
    ];
    let trained: Value = serde_json::from_str(&good(&train)).unwrap();
    assert_eq!((&trained["preparation"], &trained["gaits"]), (&"as-published".into(), &80.into()));

    let found = good(&["predict", &path("walks.csv"), "--model", &model, "--json"]);
    let found: Value = serde_json::from_str(&found).unwrap();
    assert!(found["model"].as_str().unwrap().contains("as published"), "{found}");
    let right =
        found["gaits"].as_array().unwrap().iter().filter(|row| row["emotion"] == row["label"]).count();
    assert!(right > 60, "{right} of 80 that it learned from: {found}");
    // others are not like those, whatever is done with them
    good(&["walk", "--emotion", "happy", "--out", &path("walk.csv")]);
    let want = "not E-Gait as it was published";
    refused(1, &["predict", &path("walk.csv"), "--model", &model], want);
    refused(1, &["label", &path("walk.csv"), "--model", &model, "--out", &path("out.glb")], want);
}

#[test]
fn labels_of_people_stay_unless_relabelled() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walkers, model, sad) = (path("walkers.glb"), path("model.json"), path("sad.csv"));
    GaitLibrary::generated(21, 10).unwrap().save_glb(std::path::Path::new(&walkers)).unwrap();
    good(&["train", "--data", &walkers, "--folds", "none", "--out", &model]);
    good(&["walk", "--emotion", "sad", "--out", &sad]);
    std::fs::write(path("labels.csv"), "file,label\nsad.csv,angry\n").unwrap();
    let label = |out: &str, more: &[&str]| {
        let run = [&["label", &sad, "--model", &model, "--json", "--out", out], more].concat();
        let row = serde_json::from_str::<Value>(&good(&run)).unwrap()["gaits"][0].clone();
        let grown = GaitLibrary::load_glb(std::path::Path::new(out)).unwrap();
        (row, grown.gaits().last().unwrap().label)
    };
    let (row, kept) = label(&path("kept.glb"), &[]);
    assert_eq!((kept, &row["label"]), (Some(Emotion::Angry), &"angry".into()), "{row}");
    assert!(row["probability"].is_null() && row["origin"] != "predicted", "{row}");
    let (row, told) = label(&path("told.glb"), &["--relabel"]);
    assert_eq!((told, &row["label"]), (Some(Emotion::Sad), &"sad".into()), "{row}");
    assert_eq!(row["origin"], "predicted");
}

#[test]
fn settings_of_one_method_are_refused_by_the_other_and_ask_for_it_where_none_is_named() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walkers, model) = (path("walkers.glb"), path("model.json"));
    GaitLibrary::generated(21, 10).unwrap().save_glb(std::path::Path::new(&walkers)).unwrap();
    let train = |more: &[&'static str]| {
        let plain =
            ["train", "--data", walkers.as_str(), "--folds", "none", "--json", "--out", model.as_str()];
        [&plain[..], more].concat()
    };
    refused(2, &train(&["--method", "phase-perceiver", "--c", "10"]), "--c is a setting of affective-svm");
    let found: Value = serde_json::from_str(&good(&train(&["--c", "10"]))).unwrap();
    assert_eq!((&found["method"], found["support_vectors"].is_u64()), (&"affective-svm".into(), true));
    let balanced = good(&train(&["--balanced", "--force"]));
    assert!(balanced.contains(", balanced"), "{balanced}");
    assert!(!found.to_string().contains("balanced"), "{found}");
    let words = good(&["predict", &walkers, "--model", &model]);
    assert!(words.contains("affective-svm, trained on 80 gaits"), "{words}");
}

#[test]
fn what_cannot_be_used_is_refused_with_the_reason_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("out").to_str().unwrap().to_owned();
    let csv = folder.path().join("walk.csv").to_str().unwrap().to_owned();
    good(&["walk", "--emotion", "happy", "--out", &csv]);
    refused(1, &["train", "--data", &csv, "--out", &out], "no gait with a label");
    refused(1, &["predict", &csv, "--model", &csv], "not a model in JSON");
    refused(2, &["label", &csv, "--least-probability", "2", "--out", &out], "must be 0 to 1");
    refused(1, &["label", &csv, "--least-probability", "1", "--out", &out], "no gait to add");
    assert!(!std::path::Path::new(&out).exists());
}
