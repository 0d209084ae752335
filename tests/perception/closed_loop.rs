//! The closed loop: what a classifier sees in the crowd as drawn.

use crate::common::built::Built;
use crate::common::program;
use gaitway::Emotion;
use gaitway::avatar::{self, Sex};
use gaitway::closed_loop::{
    Recorder, Score, Seen, Track, features, practice_alone, practice_in_crowd, record,
};
use gaitway::gait::{Gait, JOINT_COUNT};
use gaitway::kernels::BufferId;
use gaitway::library::GaitLibrary;
use gaitway::perception::affective_svm::AffectiveSvm;
use gaitway::scenario::{Condition, Scenario, populate_from};
use gaitway::sim::{AvatarSet, Backend, Simulation, bodies, setup};
use serde_json::Value;
use std::process::Output;

/// Runs `gaitway perceive`.
fn perceive(arguments: &[&str]) -> Output {
    program().arg("perceive").args(arguments).output().unwrap()
}

fn json(arguments: &[&str]) -> Value {
    let output = perceive(arguments);
    assert!(output.status.success(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
    serde_json::from_slice(&output.stdout).unwrap()
}

/// The built-in library; with `is_swapped`, its happy gaits are called sad and its sad ones happy.
fn library(is_swapped: bool) -> GaitLibrary {
    let mut gaits = GaitLibrary::built_in().unwrap().gaits().to_vec();
    for gait in gaits.iter_mut().filter(|_| is_swapped) {
        gait.label = gait.label.map(|label| match label {
            Emotion::Happy => Emotion::Sad,
            Emotion::Sad => Emotion::Happy,
            other => other,
        });
    }
    GaitLibrary::from_gaits(gaits).unwrap()
}

/// The crossing under `eva-g`.
fn crossing(agents: u32, library: &GaitLibrary) -> (Scenario, AvatarSet, Simulation) {
    let mut scenario = Scenario::builtin("crossing").unwrap().with_agents(agents);
    scenario.condition = Condition::EvaG;
    let crowd = populate_from(&scenario, library).unwrap();
    let cast = AvatarSet::new(library.gaits(), Sex::ALL.map(avatar::generated).to_vec()).unwrap();
    let mut store = setup::store(&scenario, &scenario.geometry(), &crowd, &cast);
    bodies::fill(&mut store, &cast, bodies::SMALLEST_STORAGE_RANGE);
    (scenario, cast, Simulation::from_store(store, Backend::Cpu, None).unwrap())
}

fn watched(agents: u32, library: &GaitLibrary) -> (Scenario, Simulation, Vec<Track>) {
    let (scenario, cast, mut simulation) = crossing(agents, library);
    let how = Recorder::of(&scenario, 120, 120);
    let tracks = record(&mut simulation, &cast, &how, &mut |_| ()).unwrap();
    (scenario, simulation, tracks)
}

fn score(simulation: &Simulation, tracks: &[Track], learned_from: &[Gait]) -> Score {
    let (gaits, emotions): (Vec<&Gait>, Vec<Emotion>) =
        learned_from.iter().map(|gait| (gait, gait.label.unwrap())).unzip();
    let model = AffectiveSvm::default().model(&gaits, &emotions, 0).unwrap();
    let seen: Vec<(Emotion, Gait)> = tracks
        .iter()
        .filter_map(|track| match track.stride() {
            Seen::Walk(gait) => Some((track.wanted, *gait)),
            Seen::Nothing(_) => None,
        })
        .collect();
    let strides: Vec<&Gait> = seen.iter().map(|(_, gait)| gait).collect();
    let rows = features(&strides, simulation).unwrap();
    Score::of(
        seen.iter()
            .zip(&rows)
            .map(|((wanted, _), row)| (*wanted, model.predict_features(row).unwrap().emotion)),
    )
}

#[test]
fn the_joints_are_those_of_the_bodies_as_posed_with_the_gaze() {
    let (scenario, cast, mut simulation) = crossing(40, &library(false));
    let how = Recorder::of(&scenario, 45, 1);
    let tracks = record(&mut simulation, &cast, &how, &mut |_| ()).unwrap();
    // what the kernels `pose` and `gaze` left, put together by plain matrices
    let store = simulation.read(&[BufferId::Visible, BufferId::LocalRotations]).unwrap();
    let mut checked = 0;
    for (slot, &agent) in store.visible.iter().enumerate().take_while(|(_, agent)| **agent != u32::MAX) {
        let agent = agent as usize;
        let avatar = &cast.avatars()[store.appearance[agent].avatar() as usize];
        for (joint, world_from_joint) in Built::new(store, slot, avatar).joints().iter().enumerate() {
            let want = world_from_joint.w_axis.truncate();
            let found = tracks[agent].recording.poses[0][joint];
            assert!(found.distance(want) < 2e-5, "agent {agent} joint {joint}: {found} {want}");
            checked += 1;
        }
    }
    assert_eq!(checked, 40 * JOINT_COUNT);
}

#[test]
fn a_crowd_shows_what_its_gaits_show_whatever_they_are_called() {
    let walkers = GaitLibrary::generated(31, 8).unwrap();
    let avatars = Sex::ALL.map(avatar::generated).to_vec();
    let (scenario, simulation, tracks) = watched(120, &library(false));
    let others =
        practice_in_crowd(walkers.gaits(), avatars, &scenario, (Backend::Cpu, None), &mut |_| ()).unwrap();
    let found = score(&simulation, &tracks, &others);
    // individuals of one emotion differ as people do, so that some look like another
    assert!(found.n >= 110 && found.accuracy >= 0.75, "{found:?}");

    // the classifier sees the walk alone, not the wanted emotion
    let (_, simulation, tracks) = watched(120, &library(true));
    let found = score(&simulation, &tracks, &others);
    let [happy, _, sad, _] = found.confusion;
    assert!(happy[2] * 10 > 9 * happy.iter().sum::<u64>(), "{found:?}");
    // the gaze is that of the wanted emotion: a happy walk with a lowered head is not sad, and less happy
    assert!(sad[0] * 2 > sad.iter().sum() && sad[2] == 0, "{found:?}");
}

#[test]
fn each_gait_walked_alone_is_one_labelled_stride_on_each_avatar() {
    let walkers = GaitLibrary::generated(5, 1).unwrap();
    let avatars = Sex::ALL.map(avatar::generated).to_vec();
    let scenario = Scenario::builtin("crossing").unwrap();
    let seen =
        practice_alone(walkers.gaits(), avatars, &scenario, (Backend::Cpu, None), &mut |_| ()).unwrap();
    assert_eq!(seen.len(), 16);
    for (index, gait) in seen.iter().enumerate() {
        let played = &walkers.gaits()[index / 2];
        assert_eq!((gait.label, &gait.provenance), (played.label, &played.provenance));
        assert!(gait.name.starts_with(&played.name));
        // alone and straight, nothing but the body's size changes the walk
        assert!((gait.cycle_time() / played.cycle_time() - 1.0).abs() < 0.02, "{}", gait.name);
        assert!((gait.speed / played.speed - 1.0).abs() < 0.2, "{}", gait.name);
    }
}

#[test]
fn both_backends_see_the_same() {
    let see = |backend: &str| {
        let mut found = json(&[
            "crossing",
            "--agents",
            "70",
            "--warm-up",
            "2",
            "--seconds",
            "3",
            "--condition",
            "eva-g",
            "--backend",
            backend,
            "--json",
        ]);
        let object = found.as_object_mut().unwrap();
        object.remove("device");
        object.remove("wall_seconds");
        found
    };
    let on_cpu = see("cpu");
    let counted: u64 = on_cpu["walking"].as_u64().unwrap() + on_cpu["not_walking"]["all"].as_u64().unwrap();
    assert_eq!(counted, 70);
    assert_eq!(on_cpu["perceivers"].as_array().unwrap().len(), 3);
    assert_eq!(on_cpu["humans"]["confusion"][2], serde_json::json!([0, 0, 48, 0]));
    assert_eq!(see("cpu"), on_cpu, "run to run");
    #[cfg(feature = "vulkan")]
    if crate::common::gpu::device().is_some() {
        assert_eq!(see("vulkan"), on_cpu, "CPU and Vulkan");
    }
}

#[test]
fn those_without_a_stride_are_counted_and_figures_and_models_are_files() {
    let folder = tempfile::tempdir().unwrap();
    let path = |name: &str| folder.path().join(name).to_str().unwrap().to_owned();
    let walkers = GaitLibrary::generated(9, 2).unwrap();
    let gaits: Vec<&Gait> = walkers.gaits().iter().collect();
    let emotions: Vec<Emotion> = gaits.iter().map(|gait| gait.label.unwrap()).collect();
    let model = AffectiveSvm::default().model(&gaits, &emotions, 0).unwrap();
    model.save(path("model.json").as_ref()).unwrap();

    let short = ["garden", "--agents", "20", "--warm-up", "0", "--seconds", "0.2", "--backend", "cpu"];
    let found = json(
        &[&short[..], &["--model", &path("model.json"), "--figures", &path("figures"), "--json"]].concat(),
    );
    assert_eq!((&found["walking"], &found["not_walking"]["no_whole_stride"]), (&0.into(), &20.into()));
    assert_eq!(found["perceivers"].as_array().unwrap().len(), 1, "a model is asked alone");
    assert_eq!(found["perceivers"][0]["n"], 0);
    let files = found["files"].as_array().unwrap();
    assert_eq!(files.len(), 4);
    assert!(files.iter().all(|file| std::path::Path::new(file.as_str().unwrap()).exists()));

    let output = perceive(&[&short[..], &["--model", &path("none.json")]].concat());
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(1) && error.contains("none.json"), "{error}");
}
