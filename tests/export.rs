//! Claims about trajectory files.
#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "a failing unwrap fails the test; values are copied, not computed"
)]

use gaitway::export::{Error, TrajectoryFormat, TrajectoryWriter, Walkable};
use gaitway::scenario::{Crowd, Geometry, Scenario, populate};
use glam::Vec2;
use rusqlite::Connection;
use std::path::Path;

const RATE: f64 = 30.0;

fn scene(name: &str, agents: u32) -> (Geometry, Crowd) {
    let scenario = Scenario::builtin(name).unwrap().with_agents(agents);
    (scenario.geometry(), populate(&scenario, |_| &[0]).unwrap())
}

/// Everybody walks on at the start velocity.
fn write(path: &Path, format: TrajectoryFormat, (geometry, crowd): &(Geometry, Crowd), frames: u8) {
    let mut writer = TrajectoryWriter::create(path, format, RATE, &Walkable::from(geometry)).unwrap();
    let headings: Vec<f32> = crowd.agents.iter().map(|a| a.heading).collect();
    for frame in 0..frames {
        let time = f32::from(frame) / 30.0;
        let positions: Vec<Vec2> = crowd.agents.iter().map(|a| a.position + a.velocity * time).collect();
        writer.frame(&positions, &headings).unwrap();
    }
    assert!(!path.exists(), "nothing appears before it is complete");
    writer.finish().unwrap();
}

fn names(folder: &Path) -> Vec<String> {
    std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect()
}

#[test]
fn the_database_is_jupedsims_version_two() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.sqlite");
    let scene = scene("parking", 8);
    write(&path, TrajectoryFormat::Sqlite, &scene, 5);
    assert_eq!(names(folder.path()), ["run.sqlite"]);
    let database = Connection::open(&path).unwrap();
    let text = |sql: &str| database.query_row(sql, [], |row| row.get::<_, String>(0)).unwrap();
    let number = |sql: &str| database.query_row(sql, [], |row| row.get::<_, f64>(0)).unwrap();
    assert_eq!(text("SELECT value FROM metadata WHERE key = 'version'"), "2");
    assert_eq!(text("SELECT value FROM metadata WHERE key = 'fps'"), "30");
    assert!((number("SELECT count(*) FROM trajectory_data") - 40.0).abs() < 0.5);
    assert!(
        (number("SELECT count(*) FROM frame_data JOIN geometry ON geometry_hash = hash") - 5.0).abs() < 0.5
    );
    assert!(text("SELECT wkt FROM geometry").starts_with("POLYGON (("));
    assert!(
        text("SELECT sql FROM sqlite_master WHERE type = 'index' AND sql NOT NULL").contains("(frame, id)")
    );
    for (key, column) in
        [("xmin", "min(pos_x)"), ("xmax", "max(pos_x)"), ("ymin", "min(pos_y)"), ("ymax", "max(pos_y)")]
    {
        let written: f64 = text(&format!("SELECT value FROM metadata WHERE key = '{key}'")).parse().unwrap();
        assert!((written - number(&format!("SELECT {column} FROM trajectory_data"))).abs() < 1e-9, "{key}");
    }
    let agent = &scene.1.agents[2];
    let row: [f64; 4] = database
        .query_row(
            "SELECT pos_x, pos_y, ori_x, ori_y FROM trajectory_data WHERE frame = 0 AND id = 3",
            [],
            |row| Ok([row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?]),
        )
        .unwrap();
    let facing = agent.velocity.normalize();
    let expected = [agent.position.x, -agent.position.y, facing.x, -facing.y].map(f64::from);
    assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-5), "{row:?} {expected:?}");
}

#[test]
fn a_left_turn_stays_a_left_turn_seen_from_above() {
    // Walking north (-z), then turning to the left of a viewer from above: west (-x).
    let (north, west) = (Vec2::new(0.0, -1.0), Vec2::new(-1.0, 0.0));
    let plane = gaitway::export::trajectory::plane_from_ground;
    assert!(plane(north).perp_dot(plane(west)) > 0.0, "counter-clockwise in their plane");
    let heading = |d| gaitway::ground::heading_from_ground(d);
    let turn = (heading(west) - heading(north)).rem_euclid(std::f32::consts::TAU);
    assert!((turn - std::f32::consts::FRAC_PI_2).abs() < 1e-6, "and a positive turn about +y");
}

#[test]
fn the_archive_text_and_the_csv_say_what_their_columns_are() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("garden", 4);
    let (text, csv) = (folder.path().join("a.txt"), folder.path().join("a.csv"));
    write(&text, TrajectoryFormat::from_path(&text).unwrap(), &scene, 2);
    write(&csv, TrajectoryFormat::from_path(&csv).unwrap(), &scene, 2);
    let text = std::fs::read_to_string(text).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines[..2], ["# framerate: 30.000000", "# id frame x/m y/m z/m"]);
    assert_eq!(lines.len(), 2 + 8);
    assert!(lines[2].starts_with("1 0 ") && lines[9].starts_with("4 1 "), "{text}");
    let csv = std::fs::read_to_string(csv).unwrap();
    let row: Vec<f32> = csv.lines().nth(1).unwrap().split(',').map(|cell| cell.parse().unwrap()).collect();
    let agent = &scene.1.agents[0];
    assert_eq!(row, [0.0, 0.0, 0.0, agent.position.x, agent.position.y, agent.heading]);
    assert_eq!(csv.lines().next().unwrap(), "frame,time_s,id,x_m,z_m,heading_rad");
}

#[test]
fn an_abandoned_file_leaves_nothing_and_the_old_one_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("garden", 4);
    for name in ["a.sqlite", "a.txt", "a.csv"] {
        let path = folder.path().join(name);
        std::fs::write(&path, "old").unwrap();
        let format = TrajectoryFormat::from_path(&path).unwrap();
        let mut writer = TrajectoryWriter::create(&path, format, RATE, &Walkable::from(&scene.0)).unwrap();
        writer.frame(&[Vec2::ZERO], &[0.0]).unwrap();
        assert_eq!(names(folder.path()).len(), 2);
        drop(writer);
        assert_eq!(names(folder.path()), [name]);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "old");
        std::fs::remove_file(&path).unwrap();
    }
}

#[test]
fn what_does_not_fit_is_refused_with_the_agent_and_the_way_out() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.csv");
    let create = |rate| TrajectoryWriter::create(&path, TrajectoryFormat::Csv, rate, &Walkable::default());
    let mut writer = create(RATE).unwrap();
    let error = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert!(error(writer.frame(&[Vec2::ZERO], &[])).contains("1 positions but 0 headings"));
    let nan = error(writer.frame(&[Vec2::ZERO, Vec2::NAN], &[0.0, 0.0]));
    assert!(nan.contains("frame 0: agent 1"), "{nan}");
    assert!(create(0.0).unwrap_err().to_string().contains("0.001 to 1000"));
    assert!(create(f64::NAN).is_err());
    let ending = TrajectoryFormat::from_path(Path::new("a.h5")).unwrap_err().to_string();
    assert!(ending.contains(".sqlite") && ending.contains("\"h5\""), "{ending}");
    let missing = folder.path().join("no/such/folder.csv");
    let missing = TrajectoryWriter::create(&missing, TrajectoryFormat::Csv, RATE, &Walkable::default());
    assert!(matches!(missing, Err(Error::Write { .. })));
    let no_area = TrajectoryWriter::create(
        &folder.path().join("a.db"),
        TrajectoryFormat::Sqlite,
        RATE,
        &Walkable::default(),
    );
    assert!(no_area.unwrap_err().to_string().contains("3 or more"));
}

#[test]
fn pedpy_loads_our_files() {
    let Ok(python) = std::env::var("GAITWAY_PEDPY") else {
        println!("skipped: set GAITWAY_PEDPY to a python that has pedpy");
        return;
    };
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/pedpy_loads.py");
    let folder = tempfile::tempdir().unwrap();
    for (name, agents) in [("crossing", 200), ("garden", 40), ("parking", 60), ("scifi", 40)] {
        let scene = scene(name, agents);
        for ending in ["sqlite", "txt"] {
            let path = folder.path().join(format!("{name}.{ending}"));
            write(&path, TrajectoryFormat::from_path(&path).unwrap(), &scene, 6);
            let area = if ending == "sqlite" { scene.0.walkable_area() } else { 0.0 };
            let run = std::process::Command::new(&python)
                .arg(&script)
                .arg(&path)
                .args([f64::from(agents), 6.0, RATE, area].map(|number| number.to_string()))
                .output()
                .unwrap();
            let said = String::from_utf8_lossy(&run.stderr).into_owned();
            assert!(run.status.success(), "{name}.{ending}: {said}");
            print!("{}", String::from_utf8_lossy(&run.stdout));
        }
    }
}
