//! Claims about trajectory files.

use crate::common::pedpy;
use gaitway::export::{AgentInfo, AgentKind, Error, Frame, TrajectoryFormat, TrajectoryWriter, Walkable};
use gaitway::scenario::{Crowd, Geometry, Scenario, populate};
use glam::Vec2;
use rusqlite::Connection;
use std::path::Path;

const RATE: f64 = 30.0;

fn scene(name: &str, agents: u32) -> (Geometry, Crowd) {
    let scenario = Scenario::builtin(name).unwrap().with_agents(agents);
    (scenario.geometry(), populate(&scenario, |_| &[0]).unwrap())
}

/// Every agent walks on at its start velocity.
fn write(path: &Path, format: TrajectoryFormat, (geometry, crowd): &(Geometry, Crowd), frames: u8) {
    let mut writer =
        TrajectoryWriter::create(path, format, RATE, &Walkable::from(geometry), Vec::new()).unwrap();
    let headings: Vec<f32> = crowd.agents.iter().map(|a| a.heading).collect();
    for frame in 0..frames {
        let time = f32::from(frame) / 30.0;
        let positions: Vec<Vec2> = crowd.agents.iter().map(|a| a.position + a.velocity * time).collect();
        let velocities: Vec<Vec2> = crowd.agents.iter().map(|a| a.velocity).collect();
        let (positions, headings, velocities) = (&positions[..], &headings[..], &velocities[..]);
        writer.frame(&Frame { positions, headings, velocities, ..Frame::default() }).unwrap();
    }
    assert!(!path.exists(), "nothing appears before it is complete");
    writer.finish().unwrap();
}

fn frame<'a>(positions: &'a [Vec2], headings: &'a [f32]) -> Frame<'a> {
    Frame { positions, headings, ..Frame::default() }
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
    let row: Vec<f32> =
        csv.lines().nth(1).unwrap().split(',').take(8).map(|cell| cell.parse().unwrap()).collect();
    let agent = &scene.1.agents[0];
    let [position, velocity] = [agent.position, agent.velocity];
    assert_eq!(row, [0.0, 0.0, 0.0, position.x, position.y, agent.heading, velocity.x, velocity.y]);
    assert_eq!(csv.lines().next().unwrap(), "frame,time_s,id,x_m,z_m,heading_rad,vx_m_s,vz_m_s,emotion,kind");
    assert!(csv.lines().nth(1).unwrap().ends_with(",,person"), "{csv}");
}

#[test]
fn an_abandoned_file_leaves_nothing_and_the_old_one_in_place() {
    let folder = tempfile::tempdir().unwrap();
    let scene = scene("garden", 4);
    for name in ["a.sqlite", "a.parquet", "a.txt", "a.csv"] {
        let path = folder.path().join(name);
        std::fs::write(&path, "old").unwrap();
        let format = TrajectoryFormat::from_path(&path).unwrap();
        let mut writer =
            TrajectoryWriter::create(&path, format, RATE, &Walkable::from(&scene.0), Vec::new()).unwrap();
        writer.frame(&frame(&[Vec2::ZERO], &[0.0])).unwrap();
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
    let create =
        |rate| TrajectoryWriter::create(&path, TrajectoryFormat::Csv, rate, &Walkable::default(), Vec::new());
    let mut writer = create(RATE).unwrap();
    let error = |result: Result<(), Error>| result.unwrap_err().to_string();
    assert!(error(writer.frame(&frame(&[Vec2::ZERO], &[]))).contains("1 positions but 0 headings"));
    let nan = error(writer.frame(&frame(&[Vec2::ZERO, Vec2::NAN], &[0.0, 0.0])));
    assert!(nan.contains("frame 0: agent 1"), "{nan}");
    assert!(create(0.0).unwrap_err().to_string().contains("0.001 to 1000"));
    assert!(create(f64::NAN).is_err());
    let ending = TrajectoryFormat::from_path(Path::new("a.h5")).unwrap_err().to_string();
    assert!(ending.contains(".sqlite") && ending.contains("\"h5\""), "{ending}");
    let missing = folder.path().join("no/such/folder.csv");
    let missing =
        TrajectoryWriter::create(&missing, TrajectoryFormat::Csv, RATE, &Walkable::default(), Vec::new());
    assert!(matches!(missing, Err(Error::Write { .. })));
    let no_area = TrajectoryWriter::create(
        &folder.path().join("a.db"),
        TrajectoryFormat::Sqlite,
        RATE,
        &Walkable::default(),
        Vec::new(),
    );
    assert!(no_area.unwrap_err().to_string().contains("3 or more"));
}

/// Six people in a scene of classes, groups and feelings, and a robot.
#[test]
fn the_table_of_agents_says_who_felt_what_and_robots_are_no_pedestrians() {
    let text = "name = \"hall\"\nseed = 3\nbounds = [[0, 0], [30, 0], [30, 30], [0, 30]]\n[population]\nagents = 600\n\
        emotions = { happy = 3.0, sad = 1.0 }\ngroups.sizes = [0.5, 0.5]\n[[population.classes]]\nname = \"old\"\nage = [65, 80]\n\
        share = 1\n[[routes]]\nname = \"way\"\nwaypoints = [[2, 15], [28, 15]]\nwidth = 26\n\
        [[outsiders]]\nkind = \"robot\"\npath = [[0, 5, 5], [10, 25, 25]]\n";
    let scenario = Scenario::parse(text, "hall").unwrap();
    let library = gaitway::library::GaitLibrary::built_in().unwrap();
    let crowd = gaitway::scenario::populate_from(&scenario, &library).unwrap();
    let avatars = gaitway::avatar::Sex::ALL.map(gaitway::avatar::generated).to_vec();
    let cast = gaitway::sim::AvatarSet::new(library.gaits(), avatars).unwrap();
    let agents = AgentInfo::of_crowd(&scenario, &crowd, &cast, None);
    assert_eq!((agents.len(), agents[600].kind), (601, AgentKind::Robot));
    let folder = tempfile::tempdir().unwrap();
    let walkable = Walkable::from(&scenario.geometry());
    // Frame 0: all but agent 0, which enters in frame 1 and is gone in frame 2.
    let mut frames = vec![crowd.agents.iter().map(|a| a.position).collect::<Vec<_>>(); 3];
    for (number, positions) in frames.iter_mut().enumerate() {
        positions.push(Vec2::splat(5.0));
        if number != 1 {
            positions[0] = Vec2::splat(gaitway::ground::ABSENT);
        }
    }
    let headings = vec![0.0; 601];
    for name in ["run.sqlite", "run.parquet", "run.txt", "run.csv"] {
        let path = folder.path().join(name);
        let format = TrajectoryFormat::from_path(&path).unwrap();
        let mut writer = TrajectoryWriter::create(&path, format, 2.0, &walkable, agents.clone()).unwrap();
        for positions in &frames {
            writer.frame(&frame(positions, &headings)).unwrap();
        }
        writer.finish().unwrap();
    }
    let database = Connection::open(folder.path().join("run.sqlite")).unwrap();
    let number = |sql: &str| database.query_row(sql, [], |row| row.get::<_, f64>(0)).unwrap();
    let share = number("SELECT avg(emotion = 'happy') FROM agents WHERE kind = 'person'");
    assert!((share - 0.75).abs() < 0.05, "{share}: three of four, of 600");
    assert_eq!(number("SELECT count(*) FROM agents WHERE emotion IN ('happy', 'sad')"), 600.0);
    assert_eq!(number("SELECT count(*) FROM agents WHERE kind = 'robot' AND led AND emotion IS NULL"), 1.0);
    assert_eq!(number("SELECT count(*) FROM trajectory_data"), 599.0 + 600.0 + 599.0);
    assert_eq!(number("SELECT count(DISTINCT id) FROM outsider_data WHERE id = 601"), 1.0);
    assert_eq!(number("SELECT max(id) FROM trajectory_data"), 600.0);
    assert_eq!(number("SELECT entered FROM agents WHERE id = 1"), 0.5);
    assert_eq!(number("SELECT \"left\" FROM agents WHERE id = 1"), 1.0);
    assert_eq!(number("SELECT count(*) FROM agents WHERE \"left\" IS NULL"), 600.0);
    assert_eq!(number("SELECT count(*) FROM agents WHERE class = 'old'"), 600.0);
    let built =
        "kind = 'person' AND stature BETWEEN 1.3 AND 2.1 AND weight BETWEEN 40 AND 150 AND age IS NULL";
    assert_eq!(number(&format!("SELECT count(*) FROM agents WHERE {built}")), 600.0);
    let weights = number("SELECT sum(happy + angry + sad + neutral) FROM agents");
    assert!((weights - 600.0).abs() < 1e-6, "{weights}");
    let row = |id: usize| {
        let sql = format!(
            "SELECT gait, avatar, group_id, radius, preferred_speed FROM agents WHERE id = {}",
            id + 1
        );
        database
            .query_row(&sql, [], |row| {
                Ok((
                    row.get::<_, String>(0)?,
                    row.get::<_, String>(1)?,
                    row.get::<_, Option<u32>>(2)?,
                    row.get::<_, f64>(3)?,
                    row.get::<_, f64>(4)?,
                ))
            })
            .unwrap()
    };
    for (id, agent) in crowd.agents.iter().enumerate() {
        let (gait, avatar, group, radius, speed) = row(id);
        assert_eq!(gait, library.gaits()[agent.gaits[0] as usize].name);
        assert_eq!(avatar, scenario.population.avatars[agent.avatar as usize]);
        let company = agent.companions.iter().filter(|other| **other != u32::MAX).min();
        assert_eq!(group, company.map(|other| (*other).min(u32::try_from(id).unwrap()) + 1));
        assert_eq!(radius, f64::from(agent.radius));
        assert!((0.3..1.7).contains(&speed), "an old person's speed: {speed}");
    }
    let text = std::fs::read_to_string(folder.path().join("run.txt")).unwrap();
    assert!(!text.contains("\n601 "), "the archive's text holds people only");
    let csv = std::fs::read_to_string(folder.path().join("run.csv")).unwrap();
    assert_eq!(csv.lines().filter(|line| line.ends_with(",,robot")).count(), 3);
    assert_eq!(
        csv.lines().filter(|line| line.ends_with("y,person") || line.ends_with("d,person")).count(),
        1798
    );
    for name in ["run.sqlite", "run.csv"] {
        let options = gaitway::replay::Options { accept_speed: true, ..Default::default() };
        let read = gaitway::replay::read(&folder.path().join(name), &options).unwrap();
        assert_eq!(read.report.people, 600, "{name}");
    }
}

/// xorshift: the same places every time.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        f32::from(u16::try_from(self.0 >> 24 & 0xffff).unwrap()) / 65536.0
    }

    fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.next()
    }

    fn below(&mut self, count: u8) -> u8 {
        (0..count).rev().find(|i| self.next() * f32::from(i + 1) < 1.0).unwrap_or(0)
    }

    /// A place with obstacles that overlap, touch each other and the bounds, stick out, lie in one another, repeat, cut.
    fn place(&mut self) -> Walkable {
        use gaitway::scenario::polygon::{rectangle, regular};
        let v = Vec2::new;
        let bounds = match self.below(3) {
            0 => vec![v(0., 0.), v(12., 0.), v(12., 10.), v(0., 10.)],
            1 => vec![v(0., 0.), v(12., 0.), v(12., 6.), v(6., 6.), v(6., 10.), v(0., 10.)],
            _ => vec![v(0.37, 0.), v(11.3, 1.1), v(12., 9.), v(5.5, 7.3), v(-1., 10.)],
        };
        let mut obstacles: Vec<Vec<Vec2>> = Vec::new();
        for _ in 0..self.below(9) {
            let grid = |random: &mut Self| (random.between(-1.0, 13.0) * 2.0).round() * 0.5;
            let (x, z) = (grid(self), grid(self));
            let (w, h) = (0.5 * f32::from(1 + self.below(6)), 0.5 * f32::from(1 + self.below(6)));
            let made = match self.below(8) {
                0..=2 => vec![v(x, z), v(x + w, z), v(x + w, z + h), v(x, z + h)],
                3 => {
                    rectangle(v(self.between(0., 12.), self.between(0., 10.)), v(w, h), self.between(0., 3.))
                }
                4 => regular(v(x, z), w, 3 + u32::from(self.below(6)), self.between(0., 3.)),
                5 => rectangle(v(x, 5.0), v(0.3, 40.0), self.between(-0.5, 0.5)), // a wall right through
                6 => obstacles.last().cloned().unwrap_or_else(|| regular(v(x, z), w, 5, 0.0)),
                _ => match obstacles.last() {
                    // inside the one before, or beside it with a common corner
                    Some(last) if self.next() < 0.5 => {
                        last.iter().map(|p| last[0] + (*p - last[0]) * 0.5).collect()
                    }
                    Some(last) => last.iter().map(|p| last[0] * 2.0 - *p).collect(),
                    None => vec![v(x, z), v(x + w, z), v(x, z + h)],
                },
            };
            obstacles.push(made);
        }
        Walkable { bounds, obstacles }
    }
}

/// Whether a place is walkable, by its definition.
fn is_free(place: &Walkable, at: Vec2) -> bool {
    use gaitway::scenario::polygon::contains;
    contains(&place.bounds, at) && !place.obstacles.iter().any(|obstacle| contains(obstacle, at))
}

/// Whether a POLYGON or MULTIPOLYGON holds a ground point, by the even-odd rule over its rings.
fn holds(wkt: &str, at: Vec2) -> bool {
    let ring = |text: &str| -> Vec<Vec2> {
        let corner = |text: &str| {
            let (x, y) = text.trim().split_once(' ').unwrap();
            Vec2::new(x.parse().unwrap(), -y.parse::<f32>().unwrap())
        };
        text.split(',').map(corner).collect()
    };
    let rings = wkt.split('(').filter(|text| text.starts_with(|c: char| c == '-' || c.is_ascii_digit()));
    let inside =
        rings.filter(|text| gaitway::scenario::polygon::contains(&ring(text.split(')').next().unwrap()), at));
    inside.count() % 2 == 1
}

fn distance_to_edges(place: &Walkable, at: Vec2) -> f32 {
    use gaitway::scenario::polygon::{edges, point_segment_distance};
    let all = std::iter::once(&place.bounds).chain(&place.obstacles);
    all.flat_map(|ring| edges(ring)).map(|(a, b)| point_segment_distance(at, a, b)).fold(f32::MAX, f32::min)
}

#[test]
fn the_walkable_area_of_a_thousand_random_places_is_the_bounds_less_all_obstacles() {
    let mut random = Random(0x2545_f491_4f6c_dd1d);
    for number in 0..1000 {
        let place = random.place();
        let wkt = place.wkt();
        for _ in 0..40 {
            let at = Vec2::new(random.between(-2., 14.), random.between(-2., 12.));
            if distance_to_edges(&place, at) > 1e-3 {
                assert_eq!(holds(&wkt, at), is_free(&place, at), "place {number}, {at}: {place:?}\n{wkt}");
            }
        }
    }
}

#[test]
fn one_polygon_has_the_parts_that_places_are_in() {
    let corners = |[x, z]: [f32; 2], [to_x, to_z]: [f32; 2]| {
        vec![Vec2::new(x, z), Vec2::new(to_x, z), Vec2::new(to_x, to_z), Vec2::new(x, to_z)]
    };
    // a wall cuts a room into a large and a small part
    let place = Walkable {
        bounds: corners([0.0, 0.0], [10.0, 4.0]),
        obstacles: vec![corners([7.0, -1.0], [7.5, 5.0])],
    };
    let (large, small) = (Vec2::new(2.0, 2.0), Vec2::new(9.0, 2.0));
    for (places, holds_both, peopled) in
        [(vec![], [true, false], 0), (vec![small], [false, true], 1), (vec![large, small], [true, true], 2)]
    {
        let (wkt, ground) = place.polygon(places);
        assert!(wkt.starts_with("POLYGON"), "{wkt}");
        assert_eq!([large, small].map(|at| holds(&wkt, at)), holds_both, "{wkt}");
        assert_eq!((ground.parts, ground.peopled), (2, peopled));
    }
}

#[test]
fn all_scenes_and_a_thousand_random_places_load_in_pedpy_with_everyone_inside() {
    let Some(mut command) = pedpy("pedpy_areas.py") else { return };
    let folder = tempfile::tempdir().unwrap();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut places: Vec<(String, Walkable)> =
        (0..1000).map(|i| (format!("{i:04}"), random.place())).collect();
    for name in ["crossing", "garden", "parking", "scifi"] {
        places.push((
            name.to_owned(),
            Walkable::from(&Scenario::builtin(name).unwrap().with_agents(60).geometry()),
        ));
    }
    for entry in std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/scenes")).unwrap() {
        let path = entry.unwrap().path();
        let name = format!("file-{}", path.file_stem().unwrap().to_string_lossy());
        places.push((name, Walkable::from(&Scenario::load(&path).unwrap().geometry())));
    }
    let (mut written, mut cut) = (0, 0);
    let mut truth = String::new();
    for (name, place) in &places {
        let low = place.bounds.iter().copied().fold(Vec2::MAX, Vec2::min);
        let high = place.bounds.iter().copied().fold(Vec2::MIN, Vec2::max);
        let tries = (0..400).map(|_| Vec2::new(random.between(low.x, high.x), random.between(low.y, high.y)));
        let free: Vec<Vec2> =
            tries.filter(|at| is_free(place, *at) && distance_to_edges(place, *at) > 0.01).collect();
        let people = &free[..free.len().min(4)];
        if people.is_empty() {
            continue;
        }
        let path = folder.path().join(format!("{name}.sqlite"));
        let mut writer =
            TrajectoryWriter::create(&path, TrajectoryFormat::Sqlite, 10.0, place, Vec::new()).unwrap();
        for _ in 0..2 {
            writer.frame(&frame(people, &vec![0.0; people.len()])).unwrap();
        }
        let ground = writer.finish().unwrap();
        written += 1;
        cut += usize::from(ground.peopled > 1);
        let rings = |rings: &[Vec<Vec2>]| -> Vec<Vec<[f32; 2]>> {
            rings.iter().map(|ring| ring.iter().map(|p| [p.x, -p.y]).collect()).collect()
        };
        let line =
            serde_json::json!([name, rings(std::slice::from_ref(&place.bounds)), rings(&place.obstacles)]);
        truth += &format!("{line}\n");
    }
    assert!(written > 990 && cut > 50, "{written} places, in {cut} of them people in several parts");
    std::fs::write(folder.path().join("truth.jsonl"), truth).unwrap();
    let run = command.arg(folder.path()).output().unwrap();
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    print!("{}", String::from_utf8_lossy(&run.stdout));
}

#[test]
fn pedpy_loads_our_files() {
    if pedpy("").is_none() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    for (name, agents) in [("crossing", 200), ("garden", 40), ("parking", 60), ("scifi", 40)] {
        let scene = scene(name, agents);
        for ending in ["sqlite", "txt"] {
            let path = folder.path().join(format!("{name}.{ending}"));
            write(&path, TrajectoryFormat::from_path(&path).unwrap(), &scene, 6);
            let area = if ending == "sqlite" { scene.0.walkable_area() } else { 0.0 };
            let run = pedpy("pedpy_loads.py")
                .unwrap()
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
