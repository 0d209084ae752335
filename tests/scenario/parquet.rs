//! Trajectories in Parquet: what is written is read again to the last bit, small, by others, too.

use gaitway::Scene;
use gaitway::export::{AgentInfo, AgentKind, Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
use gaitway::replay::{Format, Options, read};
use gaitway::sim::Backend;
use glam::Vec2;
use std::path::Path;

/// Walks a crowd and writes it as Parquet, with its frames.
fn write(path: &Path, scene: &str, agents: u32, frames: u32) -> Vec<(Vec<Vec2>, Vec<f32>)> {
    let scene = Scene::load(scene).unwrap().agents(agents).backend(Backend::Cpu).build().unwrap();
    let walkable = Walkable::from(&scene.geometry);
    let info = scene.agents_info();
    let mut writer =
        TrajectoryWriter::create(path, TrajectoryFormat::Parquet, 10.0, &walkable, info).unwrap();
    let mut simulation = scene.start().unwrap();
    let mut written = Vec::new();
    for _ in 0..frames {
        let store = simulation.state().unwrap();
        let ground = |all: &[[f32; 2]]| -> Vec<Vec2> { all.iter().copied().map(Vec2::from).collect() };
        let (positions, velocities) = (ground(&store.position), ground(&store.velocity));
        let headings: Vec<f32> = store.heading.clone();
        let frame =
            Frame { positions: &positions, headings: &headings, velocities: &velocities, emotions: &[] };
        writer.frame(&frame).unwrap();
        written.push((positions, headings));
        simulation.step(3).unwrap();
    }
    writer.finish().unwrap();
    written
}

#[test]
fn places_come_back_to_the_last_bit_in_less_than_twelve_bytes_each() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("crowd.parquet");
    let written = write(&path, "crossing", 400, 60);
    let found = read(&path, &Options::default()).unwrap();
    assert_eq!((found.report.format, found.report.frame_rate_from), (Format::Parquet, "file"));
    assert_eq!((found.frame_rate, found.tracks.len(), found.report.samples), (10.0, 400, 24_000));
    assert!(found.area.is_some(), "{:?}", found.report.notes);
    for track in &found.tracks {
        let agent = usize::try_from(track.person).unwrap() - 1;
        for (sample, (positions, headings)) in track.samples.iter().zip(&written) {
            assert_eq!(
                sample.position.to_array().map(f32::to_bits),
                positions[agent].to_array().map(f32::to_bits)
            );
            let off = (sample.heading.unwrap() - headings[agent]).rem_euclid(std::f32::consts::TAU);
            assert!(off.min(std::f32::consts::TAU - off) < 1e-3, "{off}");
        }
    }
    let bytes = std::fs::metadata(&path).unwrap().len() as f64 / 24_000.0;
    println!("{bytes:.2} bytes a sample");
    assert!(bytes < 12.0, "{bytes}");
}

#[test]
fn robots_are_rows_that_are_no_people_and_feelings_stand_in_their_frames() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("trajectories.parquet");
    let robot = AgentInfo { kind: AgentKind::Robot, ..AgentInfo::default() };
    let agents = vec![AgentInfo::default(), robot, AgentInfo::default()];
    let mut writer =
        TrajectoryWriter::create(&path, TrajectoryFormat::Parquet, 5.0, &Walkable::default(), agents)
            .unwrap();
    let absent = Vec2::splat(gaitway::ground::ABSENT);
    for frame in 0..4_u8 {
        let x = f32::from(frame) * 0.2;
        let positions =
            [Vec2::new(x, 1.0), Vec2::new(x, 2.0), if frame < 2 { absent } else { Vec2::new(x, 3.0) }];
        let emotions = [[0.25, 0.25, 0.5, 0.0]; 3];
        let frame =
            Frame { positions: &positions, headings: &[0.0; 3], velocities: &[], emotions: &emotions };
        writer.frame(&frame).unwrap();
    }
    writer.finish().unwrap();
    let found = read(&path, &Options::default()).unwrap();
    let people: Vec<(i64, usize)> =
        found.tracks.iter().map(|track| (track.person, track.samples.len())).collect();
    assert_eq!(people, [(1, 4), (3, 2)]);
    assert_eq!(found.tracks[0].samples[3].position, Vec2::new(0.6, 1.0));
    assert_eq!(found.report.notes, ["no walkable area"]);
    let mut names: Vec<_> =
        std::fs::read_dir(folder.path()).unwrap().map(|entry| entry.unwrap().file_name()).collect();
    names.sort();
    assert_eq!(names, ["agents.parquet", "trajectories.parquet"]);
}

#[test]
fn a_file_that_was_taken_away_while_it_was_written_is_an_error_and_leaves_nothing() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.parquet");
    let create = || {
        TrajectoryWriter::create(&path, TrajectoryFormat::Parquet, 10.0, &Walkable::default(), Vec::new())
            .unwrap()
    };
    let mut writer = create();
    let hidden = folder.path().join(".run.parquet.partial");
    assert!(hidden.exists());
    drop(create()); // a second one beside it
    writer.frame(&Frame { positions: &[Vec2::ONE], headings: &[0.0], ..Frame::default() }).unwrap();
    std::fs::remove_file(&hidden).unwrap(); // what is written has no name to take any more
    let error = writer.finish().unwrap_err().to_string();
    assert!(error.contains("cannot write"), "{error}");
    assert!(!path.exists(), "whole or not at all");
}

/// Writes 80,000 agents of ten frames, so many that they are written fast, and the last two frames small. Some come later, some
/// stand, some are faster than the dictionary of speeds has words for. Python expects the same of every row.
fn write_mixed(path: &Path) {
    let mut writer =
        TrajectoryWriter::create(path, TrajectoryFormat::Parquet, 10.0, &Walkable::default(), Vec::new())
            .unwrap();
    for frame in 0..10_u16 {
        let agents = || 0..80_000_u32;
        let number = |of: u32| f32::from(u16::try_from(of).unwrap());
        let place = |agent: u32| match agent % 7 == 3 && u32::from(frame) < agent % 10 {
            true => Vec2::splat(gaitway::ground::ABSENT),
            false => Vec2::new(number(agent % 50_000) * 0.25, f32::from(frame) * -0.125),
        };
        let speed = |agent: u32| match agent % 5 {
            0 => 0.0,
            1 if agent > 60_000 => 40.0 + number(agent % 3),
            own => number(own) * 0.25 + f32::from(frame % 4) * 0.125,
        };
        let positions: Vec<Vec2> = agents().map(place).collect();
        let headings: Vec<f32> = agents().map(|agent| number(agent % 48) * 0.125 - 3.0).collect();
        let velocities: Vec<Vec2> = agents().map(|agent| Vec2::new(speed(agent), 0.5)).collect();
        let emotions: Vec<[f32; 4]> =
            agents().filter(|_| frame >= 5).map(|agent| [0.5, 0.25, number(agent % 2), 0.0]).collect();
        let frame = Frame {
            positions: &positions,
            headings: &headings,
            velocities: &velocities,
            emotions: &emotions,
        };
        writer.frame(&frame).unwrap();
    }
    writer.finish().unwrap();
}

#[test]
fn others_read_a_folder_of_runs_as_one_table() {
    let folder = tempfile::tempdir().unwrap();
    for run in ["run=a", "run=b"] {
        let path = folder.path().join(run);
        std::fs::create_dir(&path).unwrap();
        write(&path.join("trajectories.parquet"), "garden", 12, 20);
    }
    write_mixed(&folder.path().join("mixed.parquet"));
    let Some(mut python) = crate::common::pedpy("tables.py") else { return };
    let output = python.arg(folder.path()).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(output.status.success(), "{said}{}", String::from_utf8_lossy(&output.stderr));
    println!("{said}");
}
