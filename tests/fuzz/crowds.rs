//! Readers of scenes and recorded crowds.

use crate::mutate::Form;
use crate::targets::{Target, text, with_files};
use gaitway::replay::{self, Replay, ReplayOptions};
use gaitway::scenario::{Area, Scenario, Setting, SettingError, menge};
use gaitway::validate::files;
use std::path::Path;

pub(crate) static TARGETS: [Target; 17] = [
    Target {
        name: "scenario",
        form: Form::Text,
        seeds: scenario_seeds,
        read: |bytes| {
            let scenario = Scenario::parse(&text(bytes), "x").map_err(|error| error.to_string())?;
            let again = Scenario::parse(&scenario.to_toml().map_err(|error| error.to_string())?, "again");
            assert_eq!(again.unwrap(), scenario, "written and read again");
            Ok((scenario.population.agents > 0).to_string())
        },
    },
    Target {
        name: "setting",
        form: Form::Text,
        seeds: || {
            lines(&["population.agents=20", "population.emotions = { sad = 1.0, happy = 0.5 }", "walkers=[]"])
        },
        read: |bytes| {
            let setting: Setting = text(bytes).parse().map_err(|error: SettingError| error.to_string())?;
            let scenario = Scenario::builtin_with("garden", &[setting]).map_err(|error| error.to_string())?;
            Ok(scenario.name)
        },
    },
    Target {
        name: "wkt",
        form: Form::Text,
        seeds: || {
            lines(&[
                "POLYGON ((0 0, 9 0, 9 9, 0 9, 0 0), (1 1, 2 1, 2 2, 1 1))",
                "MULTIPOLYGON Z (((0 0 1,1e0 0 1,1 1 1)), ((0.5 0 1,3 0 1,3 -1.5E-1 1)))",
                "GEOMETRYCOLLECTION (POLYGON EMPTY, POLYGON ((0 0, 2 0, 2 2)), POLYGON ((1 1, 3 1, 3 3)))",
            ])
        },
        read: |bytes| {
            let area = Area::from_wkt(&text(bytes)).map_err(|error| error.to_string())?;
            assert!(area.bounds.iter().chain(area.holes.iter().flatten()).all(|at| at.is_finite()));
            Ok(area.holes.len().to_string())
        },
    },
    Target {
        name: "menge-project",
        form: Form::Text,
        seeds: || lines(&[PROJECT]),
        read: |bytes| menge(&[("p.xml", bytes), SCENE_FILE, BEHAVIOUR_FILE, FIELD_FILE]),
    },
    Target {
        name: "menge-scene",
        form: Form::Text,
        seeds: || lines(&[SCENE, LATTICE]),
        read: |bytes| menge(&[PROJECT_FILE, ("s.xml", bytes), BEHAVIOUR_FILE, FIELD_FILE]),
    },
    Target {
        name: "menge-behaviour",
        form: Form::Text,
        seeds: || lines(&[BEHAVIOUR, STATES, ROADS_TO]),
        read: |bytes| menge(&[PROJECT_FILE, SCENE_FILE, ("b.xml", bytes), FIELD_FILE, ROADS_FILE]),
    },
    Target {
        name: "menge-field",
        form: Form::Text,
        seeds: || lines(&[FIELD]),
        read: |bytes| menge(&[PROJECT_FILE, SCENE_FILE, BEHAVIOUR_FILE, ("field.txt", bytes)]),
    },
    Target {
        name: "menge-roads",
        form: Form::Text,
        seeds: || lines(&[ROADS]),
        read: |bytes| {
            menge(&[PROJECT_FILE, SCENE_FILE, ("b.xml", ROADS_TO.as_bytes()), ("roads.txt", bytes)])
        },
    },
    Target {
        name: "menge-mesh",
        form: Form::Text,
        seeds: || lines(&[MESH]),
        read: |bytes| {
            let scene = SCENE.replace(
                "</Experiment>",
                "<ObstacleSet type=\"nav_mesh\" file_name=\"rooms.nav\" class=\"1\"/></Experiment>",
            );
            let behaviour = BEHAVIOUR.replace(
                "type=\"vel_field\" file_name=\"field.txt\"",
                "type=\"nav_mesh\" file_name=\"rooms.nav\"",
            );
            menge(&[
                PROJECT_FILE,
                ("s.xml", scene.as_bytes()),
                ("b.xml", behaviour.as_bytes()),
                ("rooms.nav", bytes),
            ])
        },
    },
    Target {
        name: "crowd-text",
        form: Form::Text,
        seeds: || lines(&[ARCHIVE, BARE, OBSMAT, CSV, OURS, VISWALK]),
        read: |bytes| with_files(&[("a.txt", bytes)], |folder| walks(&folder.join("a.txt"))),
    },
    Target {
        name: "crowd-splines",
        form: Form::Text,
        seeds: || lines(&[SPLINES]),
        read: |bytes| {
            let files = [("a.vsp", bytes), ("H.txt", HOMOGRAPHY.as_bytes())];
            with_files(&files, |folder| walks(&folder.join("a.vsp")))
        },
    },
    Target {
        name: "crowd-homography",
        form: Form::Text,
        seeds: || lines(&[HOMOGRAPHY]),
        read: |bytes| {
            let files = [("a.vsp", SPLINES.as_bytes()), ("H.txt", bytes)];
            with_files(&files, |folder| walks(&folder.join("a.vsp")))
        },
    },
    Target {
        name: "crowd-database",
        form: Form::Binary,
        seeds: database_seeds,
        read: |bytes| with_files(&[("a.sqlite", bytes)], |folder| walks(&folder.join("a.sqlite"))),
    },
    Target {
        name: "crowd-parquet",
        form: Form::Binary,
        seeds: parquet_seeds,
        read: |bytes| with_files(&[("a.parquet", bytes)], |folder| walks(&folder.join("a.parquet"))),
    },
    Target {
        name: "crowd-area",
        form: Form::Text,
        seeds: || lines(&["POLYGON ((0 0, 8 0, 8 6, 0 6, 0 0), (3 3, 4 3, 4 4, 3 3))"]),
        read: |bytes| {
            let text = text(bytes);
            with_files(&[], |folder| {
                let path = folder.join("a.sqlite");
                database(&path, &text);
                let answer = walks(&path);
                let _ = std::fs::remove_file(path);
                answer
            })
        },
    },
    Target {
        name: "recorded",
        form: Form::Text,
        seeds: || lines(&[ARCHIVE, OBSMAT]),
        read: |bytes| {
            with_files(&[("a.txt", bytes)], |folder| {
                let path = folder.join("a.txt");
                let juelich = files::juelich(&path, 0.01, 16.0).map_err(|error| error.to_string());
                let ucy = files::ucy(&path).map_err(|error| error.to_string());
                juelich.or(ucy).map(|tracks| tracks.frames.len().min(9).to_string())
            })
        },
    },
    Target { name: "session", form: Form::Text, seeds: || lines(&[SESSION]), read: session },
];

fn lines(texts: &[&str]) -> Vec<Vec<u8>> {
    texts.iter().map(|text| text.as_bytes().to_vec()).collect()
}

fn scenario_seeds() -> Vec<Vec<u8>> {
    let name = |name: &&str| Scenario::builtin(name).unwrap().to_toml().unwrap().into_bytes();
    let mut seeds: Vec<Vec<u8>> = Scenario::builtin_names().iter().map(name).collect();
    seeds.extend(lines(&[SMALL, ROOM]));
    seeds
}

const SMALL: &str = r#"name = "small"
bounds = [[-5, -5], [5, -5], [5, 5], [-5, 5]]
[population]
agents = 3
[[routes]]
name = "a"
waypoints = [[-4, 0], [4, 0]]
"#;
const ROOM: &str = r#"name = "room"
seed = 3
walkable_wkt = "POLYGON ((0 0, 9 0, 9 9, 0 9))"
[population]
agents = 2
[way_finding]
way = "auto"
[navigation]
model = "rvo"
patience = 1.0
[[stages]]
name = "out"
kind = "exit"
position = [8.0, -8.0]
size = [1, 1]
[[journeys]]
name = "leave"
stages = ["out"]
[[walkers]]
position = [2.0, -2.0]
waypoints = [[7.0, -7.0]]
[[obstacles]]
polygon = [[4, -4], [5, -4], [5, -5]]
[[sources]]
polygon = [[1, -1], [3, -1], [3, -3], [1, -3]]
rate = 1.0
"#;

/// Imports the project of these files.
fn menge(files: &[(&str, &[u8])]) -> Result<String, String> {
    with_files(files, |folder| {
        let found = menge::import(&folder.join("p.xml"), 1).map_err(|error| error.to_string())?;
        found.scenario.validate().unwrap();
        Ok(format!(
            "{} {} {}",
            found.report.agents > 0,
            found.report.obstacles > 0,
            found.report.with_an_end > 0
        ))
    })
}

const PROJECT: &str = "<?xml version=\"1.0\"?><Project scene=\"s.xml\" behavior=\"b.xml\" model=\"orca\"/>";
const SCENE: &str = "<Experiment version=\"2.0\"><AgentProfile name=\"a\"><Common r=\"0.2\" pref_speed=\"1.2\" max_speed=\"2\" \
    neighbor_dist=\"6\" max_neighbors=\"8\" obstacleSet=\"1\"/><ORCA tau=\"3.0\" tauObst=\"0.15\"/></AgentProfile>\
    <AgentProfile name=\"b\" inherits=\"a\"><Common><Property name=\"pref_speed\" dist=\"u\" min=\"0.6\" max=\"0.8\"/></Common></AgentProfile>\
    <AgentGroup><ProfileSelector type=\"const\" name=\"b\"/><StateSelector type=\"const\" name=\"Walk\"/>\
    <Generator type=\"explicit\"><Agent p_x=\"-3\" p_y=\"1\"/><Agent p_x=\"-3\" p_y=\"-1\"/></Generator></AgentGroup>\
    <ObstacleSet type=\"explicit\" class=\"1\"><Obstacle closed=\"1\"><Vertex p_x=\"0\" p_y=\"0\"/><Vertex p_x=\"1\" p_y=\"0\"/>\
    <Vertex p_x=\"1\" p_y=\"1\"/></Obstacle></ObstacleSet></Experiment>";
const LATTICE: &str = "<Experiment><AgentProfile name=\"a\"><Common r=\"0.2\"/></AgentProfile>\
    <AgentGroup><ProfileSelector type=\"weighted\"><Profile name=\"a\" weight=\"2\"/></ProfileSelector>\
    <StateSelector type=\"const\" name=\"Walk\"/><Generator type=\"hex_lattice\" anchor_x=\"1.5\" anchor_y=\"0\" alignment=\"center\" \
    row_direction=\"x\" density=\"1.8\" width=\"4.0\" population=\"9\" rotation=\"-90\"/></AgentGroup>\
    <AgentGroup><ProfileSelector type=\"const\" name=\"a\"/><StateSelector type=\"const\" name=\"Walk\"/><Generator type=\"rect_grid\" \
    anchor_x=\"1\" anchor_y=\"2\" offset_x=\"1\" offset_y=\"-0.5\" count_x=\"2\" count_y=\"3\" rotation=\"90\"/></AgentGroup></Experiment>";
const BEHAVIOUR: &str = "<BFSM><GoalSet id=\"2\"><Goal type=\"AABB\" id=\"5\" min_x=\"4\" min_y=\"-1\" max_x=\"6\" max_y=\"1\"/></GoalSet>\
    <State name=\"Walk\" final=\"0\"><GoalSelector type=\"explicit\" goal_set=\"2\" goal=\"5\"/>\
    <VelComponent type=\"vel_field\" file_name=\"field.txt\" use_nearest=\"1\"/></State><State name=\"Stop\" final=\"1\"/>\
    <Transition from=\"Walk\" to=\"Stop\"><Condition type=\"goal_reached\" distance=\"0.25\"/></Transition></BFSM>";
const STATES: &str = "<BFSM><State name=\"Walk\" final=\"0\"><GoalSelector type=\"nearest\" goal_set=\"7\"/><VelComponent type=\"goal\"/>\
    <Action type=\"offset_property\" property=\"r\" dist=\"c\" value=\"0.1\"/></State>\
    <State name=\"B\" final=\"0\"><GoalSelector type=\"mirror\" mirror_x=\"1\" mirror_y=\"0\"/><VelComponent type=\"goal\"/></State>\
    <State name=\"C\" final=\"0\"><GoalSelector type=\"shared\" state_name=\"B\"/><VelComponent type=\"const\" x=\"1\" y=\"0\"/></State>\
    <GoalSet id=\"7\"><Goal type=\"point\" id=\"0\" x=\"-2\" y=\"0\"/><Goal type=\"circle\" id=\"4\" x=\"0\" y=\"0\" radius=\"1\"/>\
    <Goal type=\"OBB\" id=\"3\" x=\"8\" y=\"0\" width=\"2\" height=\"2\" angle=\"90\"/></GoalSet>\
    <Transition from=\"Walk\" to=\"B\"><Condition type=\"and\"><Condition type=\"timer\" dist=\"c\" value=\"1\"/>\
    <Condition type=\"goal_reached\" distance=\"0.2\"/></Condition></Transition>\
    <Transition from=\"B\" to=\"C\"><Condition type=\"AABB\" inside=\"1\" min_x=\"4\" min_y=\"-1\" max_x=\"6\" max_y=\"1\"/></Transition></BFSM>";
const ROADS_TO: &str = "<BFSM><GoalSet id=\"2\"><Goal type=\"point\" id=\"5\" x=\"5\" y=\"1\"/></GoalSet><State name=\"Walk\" final=\"0\">\
    <GoalSelector type=\"explicit\" goal_set=\"2\" goal=\"5\"/><VelComponent type=\"road_map\" file_name=\"roads.txt\"/></State></BFSM>";
const FIELD: &str = "2 3\n1.0\n-4 -2\n1 0\n1 0\n0 1\n1 0\n1 0\n0 0\n";
const ROADS: &str = "4\n2 -3 3\n2 0 4\n2 5 3\n1 6 -2\n4\n0 1\n1 2\n2 3\n0 2\n";
const MESH: &str = "10\n 0 0\n 4 0\n 4 1\n 4 3\n 4 4\n 0 4\n 8 0\n 8 4\n 6 1\n 6 2\n1\n 2 3 0 1\n9\n 0 1 0 1\n 1 6 1 2\n 6 7 1 3\n \
    7 4 1 4\n 4 5 0 5\n 5 0 0 0\n 1 2 0 -1\n 3 4 0 -1\n 8 9 1 -1\nrooms\n2\n 2 2\n 6 0 1 2 3 4 5\n 0 0 0\n 1 0\n 1 0\n 6 2\n \
    6 1 6 7 4 3 2\n 0 0 0\n 1 0\n 1 1\n";
const PROJECT_FILE: (&str, &[u8]) = ("p.xml", PROJECT.as_bytes());
const SCENE_FILE: (&str, &[u8]) = ("s.xml", SCENE.as_bytes());
const BEHAVIOUR_FILE: (&str, &[u8]) = ("b.xml", BEHAVIOUR.as_bytes());
const FIELD_FILE: (&str, &[u8]) = ("field.txt", FIELD.as_bytes());
const ROADS_FILE: (&str, &[u8]) = ("roads.txt", ROADS.as_bytes());

/// Reads a recording of a crowd, at 25 frames a second where it does not tell, and asks where everyone is.
fn walks(path: &Path) -> Result<String, String> {
    let told = replay::Options { frame_rate: Some(25.0), ..replay::Options::default() };
    let read = replay::read(path, &replay::Options::default()).or_else(|_| replay::read(path, &told));
    let recording = read.map_err(|error| format!("{error} {:?}", error.hint()))?;
    let replay = Replay::new(&recording, ReplayOptions { smooth: 0.1, from: 0.0 });
    let middle = 0.5 * recording.seconds();
    for person in 0..recording.tracks.len().min(16) {
        if let Some(at) = replay.at(person, middle) {
            assert!(at.position.is_finite(), "{at:?}");
        }
    }
    Ok(recording.tracks.len().min(9).to_string())
}

const ARCHIVE: &str =
    "# framerate: 25 fps\n# id frame x/m y/m z/m\n1\t0\t1.0\t2.0\t1.76\n1\t1\t1.05\t2.0\t1.76\n2 1 0 0 1.6\n";
const BARE: &str = "1 43 79.0 774.0 183.0\n1 44 79.1 764.5 183.0\n1 45 79.4 754.1 183.0\n";
const OBSMAT: &str =
    " 1.0e+00 1.0e+00 1.5 0 2.5 1 0 0\n 1.1e+01 1.0e+00 1.9 0 2.5 1 0 0\n 1.1e+01 2.0e+00 0 0 0 0 0 0\n";
const CSV: &str = "ID,Frame,x,y,v_x,v_y\n21,1010,0.2,-0.1,0.4,0.09\n21,1020,0.4,-0.1,0.4,0.09\n";
const OURS: &str =
    "frame,time_s,id,x_m,z_m,heading_rad\n0,0.000000,0,1.5,-2.5,0.5\n3,0.300000,0,1.6,-2.4,0.6\n";
const VISWALK: &str =
    "pedestrianId;simTime;endTime;startX-PID1;startY-PID1;endX-PID1;endY-PID1\n1;0,4;0,8;1,0;2,0;1,5;2,0\n";
const SPLINES: &str = "1 - the number of splines\n2 - Num of control points\n\
    -100.0 50.0 0 -90.0 - (2D point, m_id)\n100.0 50.0 100 0.0 - (2D point, m_id)\n";
const HOMOGRAPHY: &str = "0.02 0 7\n0 0.024 6\n0 0 1\n";

/// Three people and a robot, ours.
fn parquet_seeds() -> Vec<Vec<u8>> {
    use gaitway::export::{AgentInfo, AgentKind, Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
    use glam::Vec2;
    let robot = AgentInfo { kind: AgentKind::Robot, ..AgentInfo::default() };
    let room = [[0.0, 0.0], [9.0, 0.0], [9.0, 9.0], [0.0, 9.0]].map(Vec2::from).to_vec();
    let write = |feels: bool, bounds: Vec<Vec2>| {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.parquet");
        let walkable = Walkable { bounds, obstacles: Vec::new() };
        let agents = vec![AgentInfo::default(), robot.clone()];
        let mut writer =
            TrajectoryWriter::create(&path, TrajectoryFormat::Parquet, 10.0, &walkable, agents).unwrap();
        for frame in 0..12_u8 {
            let x = 0.1 * f32::from(frame);
            let positions = [Vec2::new(x, 1.0), Vec2::new(2.0, x), Vec2::new(x, 3.0), Vec2::new(4.0, 4.0)];
            let feelings = [[0.5, 0.25, 0.25, 0.0]; 4];
            let emotions = if feels { &feelings[..] } else { &[] };
            let velocities = [Vec2::X; 4];
            let velocities = if feels { &[] } else { &velocities[..] };
            let headings = [x; 4];
            writer
                .frame(&Frame { positions: &positions, headings: &headings, velocities, emotions })
                .unwrap();
        }
        writer.finish().unwrap();
        std::fs::read(path).unwrap()
    };
    vec![write(false, room), write(true, Vec::new())]
}

fn database(path: &Path, area: &str) {
    let connection = rusqlite::Connection::open(path).unwrap();
    connection
        .execute_batch(
            "PRAGMA journal_mode = OFF; PRAGMA synchronous = OFF; PRAGMA page_size = 512; BEGIN;
             CREATE TABLE trajectory_data(frame INTEGER, id INTEGER, pos_x REAL, pos_y REAL, ori_x REAL, ori_y REAL);
             CREATE TABLE metadata(key TEXT, value TEXT); CREATE TABLE geometry(wkt TEXT);
             INSERT INTO metadata VALUES('version', '2'), ('fps', '10.0');
             INSERT INTO trajectory_data VALUES(1, 5, 1.2, 2.0, 0.0, 1.0), (0, 5, 1.0, 2.0, 1.0, 0.0);",
        )
        .unwrap();
    connection.execute("INSERT INTO geometry VALUES(?1)", [area]).unwrap();
    connection.execute_batch("COMMIT").unwrap();
}

fn database_seeds() -> Vec<Vec<u8>> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.sqlite");
    database(&path, "POLYGON ((0 0, 8 0, 8 6))");
    vec![std::fs::read(path).unwrap()]
}

const SESSION: &str = "# gaitway recording 2\n# version 0.1.0\n# scene crossing\n# condition eva-g\n# gaze natural\n# agents 7\n\
    # seed 1\n# time_step 0.033333335\n# scenario 3c1f\n# library 90ab\n# avatars 77de\n# start 5f0c2a9bd1e37744\n\
    step,x_m,z_m,y_m,vx,vz\n0,0.1,-2,0,0,0,0,1.6,0,0,0,0,1,,,,,,,,,,,,,,,0,0.5,-1\n# hash 1 81c4\n# end 9c0d\n";

#[cfg(feature = "xr")]
fn session(bytes: &[u8]) -> Result<String, String> {
    let read = gaitway::xr::Recording::read(bytes).map_err(|error| error.to_string())?;
    assert!(read.session.hash_every() > 0);
    Ok(format!("{} {}", read.steps.len().min(9), read.end.is_some()))
}

#[cfg(not(feature = "xr"))]
fn session(_: &[u8]) -> Result<String, String> {
    Ok("without xr".to_owned())
}
