//! `gaitway gait train`, `predict` and `label` as people use them.
#![allow(clippy::unwrap_used, reason = "a test: a failure is a panic that prints")]

use gaitway::gait::{Gait, LabelOrigin};
use gaitway::library::GaitLibrary;
use serde_json::Value;
use std::process::{Command, Output};

/// Runs `gaitway gait`, through the program that `GAITWAY_TEST_RUNNER` or `GAITWAY_RUNNER` names, if any.
fn gait(arguments: &[&str]) -> Output {
    let program = env!("CARGO_BIN_EXE_gaitway");
    let runner = ["GAITWAY_TEST_RUNNER", "GAITWAY_RUNNER"].into_iter().find_map(std::env::var_os);
    let mut command = Command::new(runner.clone().unwrap_or_else(|| program.into()));
    if runner.is_some() {
        command.arg(program);
    }
    command.arg("gait").args(arguments).output().unwrap()
}

fn good(arguments: &[&str]) -> String {
    let output = gait(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

fn refused(code: i32, arguments: &[&str], want: &str) {
    let output = gait(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.stdout.is_empty() && output.status.code() == Some(code), "{arguments:?}: {error}");
    assert!(error.contains("error: ") && error.contains(want), "{arguments:?}: {error}");
}

#[test]
fn a_model_is_trained_predicts_and_grows_a_library() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let (walkers, model, grown) = (path("walkers.glb"), path("model.json"), path("grown.glb"));
    GaitLibrary::generated(21, 3).unwrap().save_glb(&walkers).unwrap();

    let trained =
        good(&["train", "--data", &walkers, "--folds", "stratified", "--k", "4", "--json", "--out", &model]);
    let trained: Value = serde_json::from_str(&trained).unwrap();
    assert_eq!(trained["gaits"], 24);
    assert_eq!(trained["counts"], serde_json::json!([6, 6, 6, 6]));
    assert!(trained["evaluation"]["accuracy_mean"].as_f64().unwrap() > 0.6, "{trained}");
    assert_eq!(trained["evaluation"]["seeds"], serde_json::json!([0, 1, 2, 3, 4]));

    // a new walker, known by nothing but where its joints are
    let sad = path("sad.csv");
    good(&["walk", "--emotion", "sad", "--seed", "77", "--out", &sad]);
    for model in [Some(&model), None] {
        let mut arguments = vec!["predict", &sad, "--json"];
        arguments.extend(model.iter().flat_map(|path| ["--model", path.as_str()]));
        let found: Value = serde_json::from_str(&good(&arguments)).unwrap();
        let row = &found["gaits"][0];
        assert_eq!((&row["name"], &row["emotion"]), (&"sad".into(), &"sad".into()), "{found}");
        let sum: f64 = row["probabilities"].as_array().unwrap().iter().map(|p| p.as_f64().unwrap()).sum();
        assert!((sum - 1.0).abs() < 1e-9 && row["margin"].is_number());
        let words = found["model"].as_str().unwrap();
        assert_eq!(model.is_none(), words.contains("built-in walkers"), "{words}");
    }
    let table = good(&["predict", &sad]);
    assert!(
        table.contains("seen as") && table.contains("built-in walkers (generated, not rated)"),
        "{table}"
    );

    good(&["label", &sad, "--library", &walkers, "--model", &model, "--out", &grown]);
    let library = GaitLibrary::load_glb(&grown).unwrap();
    assert_eq!(library.gaits().len(), 25);
    let origins: Vec<_> = library.gaits().iter().map(Gait::label_origin).collect();
    assert_eq!(origins[24], Some(LabelOrigin::Predicted));
    assert!(origins[..24].iter().all(|origin| *origin == Some(LabelOrigin::Generated)));
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
