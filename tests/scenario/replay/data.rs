//! Published recordings, where they are at hand: beside the crate in `../shared/data`, or where `GAITWAY_DATA` points.

use super::walking::Stage;
use crate::common::data_set;
use gaitway::replay::{Options, Trajectories, read};
use gaitway::sim::Backend;
use glam::Vec2;

fn show(name: &str, found: &Trajectories) {
    let r = &found.report;
    println!(
        "{name}: {} people, {} positions, {:.1} s, fastest {:.2} m/s, {} gaps, {} absences, {} twice {:?}",
        r.people, r.samples, r.seconds, r.fastest, r.gaps, r.absences, r.duplicates, r.notes
    );
}

/// Replays `seconds` of it and checks that everyone is where they were at every tenth step.
fn walks(name: &str, found: &Trajectories, from: f64, seconds: f64) {
    let stage = Stage::new(found, 0, from);
    let mut simulation = stage.start(Backend::Cpu).unwrap();
    let mut worst = 0_f32;
    let steps = (seconds / stage.time(1)) as u32;
    for _ in 0..steps / 10 {
        stage.replay.step(&mut simulation, 10).unwrap();
        worst = worst.max(stage.drift(&mut simulation));
    }
    println!("{name}: at most {worst:e} m beside the recording over {seconds} s");
    assert!(worst < 1e-3, "{name}: {worst} m");
}

#[test]
fn juelich_walks_again() {
    let Some(folder) = data_set("crowd-juelich") else { return };
    let corridor = folder.join("uni-directional/uo-100-180-180.txt");
    let found = read(&corridor, &Options { frame_rate: Some(16.0), ..Options::default() }).unwrap();
    show("uo-100-180-180", &found);
    assert!(found.report.notes[0].contains("centimetres"), "{:?}", found.report.notes);
    assert!(found.report.fastest < 6.0, "{}", found.report.fastest);
    walks("uo-100-180-180", &found, 20.0, 10.0);
    let door = read(&folder.join("bottleneck/040_c_56_h-.txt"), &Options::default()).unwrap();
    show("040_c_56_h-", &door);
    assert_eq!((door.report.people, door.report.frame_rate_from), (75, "file"));
    assert!((door.frame_rate - 25.0).abs() < 1e-9);
    walks("040_c_56_h-", &door, 10.0, 10.0);
    for (name, people) in [("n34_cam2", 34), ("n56_cam1", 50)] {
        let oval = read(&folder.join(format!("single_file/{name}.csv")), &Options::default()).unwrap();
        show(name, &oval);
        assert_eq!((oval.frame_rate, oval.report.frame_rate_from), (25.0, "velocities"), "{name}");
        assert!(oval.report.people >= people, "{name}: {}", oval.report.people);
    }
}

#[test]
fn ucy_walks_again_and_its_two_files_agree() {
    let Some(folder) = data_set("crowd-ucy") else { return };
    let students = read(&folder.join("students03/obsmat.txt"), &Options::default()).unwrap();
    show("students03", &students);
    assert_eq!((students.frame_rate, students.report.frame_rate_from), (25.0, "velocities"));
    assert_eq!(students.report.people, 428);
    walks("students03", &students, 60.0, 10.0);
    for name in ["students03", "zara01"] {
        let found = read(&folder.join(name).join("annotation.vsp"), &Options::default()).unwrap();
        show(name, &found);
        assert!(found.tracks.iter().all(|t| t.samples.iter().all(|s| s.heading.is_some())));
    }
    // The splines of zara01 and its obsmat are the same people; both reach the same ground by their own ways.
    let splines = read(&folder.join("zara01/annotation.vsp"), &Options::default()).unwrap();
    let rows = read(&folder.join("zara01/obsmat.txt"), &Options::default()).unwrap();
    assert_eq!((splines.tracks.len(), rows.tracks.len()), (148, 148));
    let middle = |track: &gaitway::replay::Track| {
        let length = |two: &[gaitway::replay::Sample]| two[0].position.distance(two[1].position);
        track.samples.windows(2).map(length).sum::<f32>()
    };
    let near = splines.tracks.iter().zip(&rows.tracks).filter(|(a, b)| {
        let (a, b): (&Vec2, &Vec2) = (&a.samples[0].position, &b.samples[0].position);
        a.distance(*b) < 1.0
    });
    let near = near.count();
    let (a, b): (f32, f32) = (splines.tracks.iter().map(middle).sum(), rows.tracks.iter().map(middle).sum());
    println!("zara01: {near} of 148 start within 1 m in both files; {a:.0} m and {b:.0} m walked");
    assert!(near > 100, "{near}");
    assert!((a / b - 1.0).abs() < 0.15, "{a} {b}");
}

/// Real crowds as TrajNet and SGAN pass them on, `frame id x y`, and as ETH's `seq_eth` was filmed, at 15 frames a second.
#[test]
fn crowds_of_others_are_read_the_right_way_round_and_at_their_own_rate() {
    let folder = tempfile::tempdir().unwrap();
    for (set, path) in [("crowd-ucy", "students03/obsmat.txt"), ("crowd-ucy", "zara01/obsmat.txt")] {
        let Some(data) = data_set(set) else { return };
        let plain = read(&data.join(path), &Options::default()).unwrap();
        let text = std::fs::read_to_string(data.join(path)).unwrap();
        let rows: Vec<Vec<f64>> = text
            .lines()
            .map(|row| row.split_whitespace().map(|cell| cell.parse().unwrap()).collect())
            .collect();
        let rewrite = |name: &str, row: &dyn Fn(&[f64]) -> String| {
            let text: String = rows.iter().map(|cells| row(cells)).collect();
            let file = super::reading::file(folder.path(), name, &text);
            read(&file, &Options::default()).unwrap()
        };
        let trajnet =
            rewrite("trajnet.txt", &|r| format!("{} {} {:.2} {:.2}\n", r[0] - 1.0, r[1], r[2], r[4]));
        show(path, &trajnet);
        assert_eq!(trajnet.report.columns.as_ref().unwrap().to_string(), "frame, id, x, y");
        let archive =
            rewrite("archive.txt", &|r| format!("{} {} {:.2} {:.2}\n", r[1], r[0] - 1.0, r[2], r[4]));
        assert_eq!(archive.report.columns.as_ref().unwrap().to_string(), "id, frame, x, y");
        for found in [&trajnet, &archive] {
            assert_eq!((found.tracks.len(), found.frame_rate), (plain.tracks.len(), 25.0), "{path}");
            assert!((found.report.seconds - plain.report.seconds).abs() < 1e-9);
            assert!(found.report.median_speed.unwrap() < 2.0, "{:?}", found.report);
        }
        let eth = rewrite("eth.txt", &|r| {
            let frame = (r[0] - 1.0) * 0.6;
            format!("{frame} {} {} 0 {} {} 0 {}\n", r[1], r[2], r[4], r[5], r[7])
        });
        assert_eq!((eth.frame_rate, eth.report.frame_rate_from), (15.0, "velocities"));
        assert!((eth.report.seconds - plain.report.seconds).abs() < 1e-9);
    }
}

/// The densest crowds at hand, with columns exchanged: what is inferred must not depend on the order of columns.
#[test]
fn dense_crowds_are_read_the_same_with_person_and_frame_exchanged() {
    let Some(folder) = data_set("crowd-juelich") else { return };
    let scratch = tempfile::tempdir().unwrap();
    let options = Options { frame_rate: Some(16.0), ..Options::default() };
    for name in ["uo-050-180-180", "uo-180-180-095"] {
        let path = folder.join(format!("uni-directional/{name}.txt"));
        let text = std::fs::read_to_string(&path).unwrap();
        let exchanged: String = text
            .lines()
            .map(|row| {
                let cells: Vec<&str> = row.split_whitespace().collect();
                format!("{} {} {}\n", cells[1], cells[0], cells[2..].join(" "))
            })
            .collect();
        let exchanged = read(&super::reading::file(scratch.path(), "x.txt", &exchanged), &options).unwrap();
        let plain = read(&path, &options).unwrap();
        assert_eq!(exchanged.report.columns.as_ref().unwrap().to_string(), "frame, id, x, y, z");
        assert_eq!(exchanged.tracks, plain.tracks, "{name}");
    }
}
