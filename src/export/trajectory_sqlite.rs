//! JuPedSim's SQLite trajectories, version 2: the version that JuPedSim 1.4 writes and PedPy reads in full.
//!
//! Tables `trajectory_data(frame, id, pos_x, pos_y, ori_x, ori_y)`, `metadata(key, value)`, `geometry(hash, wkt)`,
//! `frame_data(frame, geometry_hash)`; an index on (frame, id). Ids start at 1, frames at 0. Readers take everyone in
//! `trajectory_data` for a pedestrian, so robots and vehicles are in `outsider_data`, which has the same columns.
//!
//! Ours is the table `agents`: a row for everyone, `id` as in the others; `kind` (person, robot, vehicle); `led` (1: goes
//! where a recording, a path or a program says); `emotion`, the strongest, and the weights `happy`, `angry`, `sad`,
//! `neutral` at the start; `gait`; `avatar`; `class`; `group_id`, the id of the first of the group; `radius`, m;
//! `preferred_speed`, m/s; `age`, years; `stature`, m; `weight`, kg; `entered` and `left`, s. NULL stands for what is not
//! known or does not apply: `entered` of agents that never came, `left` of agents present in the last frame, emotions of robots.

use super::Error;
use super::agents::{AgentInfo, Presence, strongest_emotion};
use super::area::{Area, Ground};
use super::atomic::wrong;
use super::plane::plane_from_ground;
use super::trajectory::Sample;
use crate::file::Partial;
use glam::{DVec2, Vec2};
use rusqlite::{Connection, params};
use std::path::{Path, PathBuf};

/// Rows per transaction: a few megabytes of journal.
const BATCH: u32 = 100_000;
/// The only geometry of a file.
const GEOMETRY: i64 = 1;

const TABLES: &str = "
    CREATE TABLE trajectory_data (
        frame INTEGER NOT NULL, id INTEGER NOT NULL,
        pos_x REAL NOT NULL, pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);
    CREATE TABLE outsider_data (
        frame INTEGER NOT NULL, id INTEGER NOT NULL,
        pos_x REAL NOT NULL, pos_y REAL NOT NULL, ori_x REAL NOT NULL, ori_y REAL NOT NULL);
    CREATE TABLE metadata (key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);
    CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL);
    CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);
    CREATE TABLE agents (
        id INTEGER PRIMARY KEY, kind TEXT NOT NULL, led INTEGER NOT NULL,
        emotion TEXT, happy REAL, angry REAL, sad REAL, neutral REAL,
        gait TEXT, avatar TEXT, class TEXT, group_id INTEGER, radius REAL, preferred_speed REAL,
        age REAL, stature REAL, weight REAL, entered REAL, \"left\" REAL);
";
const PERSON: &str = "INSERT INTO trajectory_data VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
const OUTSIDER: &str = "INSERT INTO outsider_data VALUES (?1, ?2, ?3, ?4, ?5, ?6)";
const AGENT: &str = "INSERT INTO agents VALUES (?1, ?2, ?3, ?4, ?5, ?6, ?7, ?8, ?9, ?10, ?11, ?12, ?13, ?14, ?15, ?16, ?17, ?18, ?19)";

/// An open trajectory database in a temporary neighbour of its place.
#[derive(Debug)]
pub(super) struct Sqlite {
    path: PathBuf,
    // Declared before the unfinished file: the database closes before its file is removed.
    connection: Connection,
    partial: Partial,
    area: Area,
    low: DVec2,
    high: DVec2,
    pending: u32,
}

impl Sqlite {
    pub(super) fn create(path: &Path, frame_rate: f64, area: Area) -> Result<Self, Error> {
        let partial = Partial::create(path).map_err(wrong(path))?;
        let sqlite = |source: rusqlite::Error| Error::Sqlite { path: path.to_owned(), source: source.into() };
        let connection = Connection::open(partial.temporary()).map_err(sqlite)?;
        let set_up = || -> rusqlite::Result<()> {
            // The file is worthless until renamed, so a crash needs no journal. (A memory journal leaves no
            // second file behind, either.)
            connection.execute_batch("PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF;")?;
            connection.execute_batch(TABLES)?;
            let mut metadata = connection.prepare("INSERT INTO metadata VALUES (?1, ?2)")?;
            metadata.execute(params!["version", "2"])?;
            metadata.execute(params!["fps", frame_rate.to_string()])?;
            connection.execute_batch("BEGIN")
        };
        set_up().map_err(sqlite)?;
        Ok(Self {
            path: path.to_owned(),
            connection,
            partial,
            area,
            low: DVec2::INFINITY,
            high: DVec2::NEG_INFINITY,
            pending: 0,
        })
    }

    pub(super) fn frame<People: Iterator<Item = Sample>>(
        &mut self,
        frame: u32,
        people: impl Fn() -> People,
        outsiders: impl Iterator<Item = Sample>,
    ) -> Result<(), Error> {
        self.area.visit(people().map(|sample| (sample.id, sample.position)));
        for sample in people() {
            let place = plane_from_ground(sample.position);
            self.low = self.low.min(place);
            self.high = self.high.max(place);
        }
        self.write(frame, people(), outsiders)
            .map_err(|source| Error::Sqlite { path: self.path.clone(), source: source.into() })
    }

    fn write(
        &mut self,
        frame: u32,
        people: impl Iterator<Item = Sample>,
        outsiders: impl Iterator<Item = Sample>,
    ) -> rusqlite::Result<()> {
        self.pending += insert(&self.connection, PERSON, frame, people)?;
        self.pending += insert(&self.connection, OUTSIDER, frame, outsiders)?;
        self.connection
            .prepare_cached("INSERT INTO frame_data VALUES (?1, ?2)")?
            .execute(params![frame, GEOMETRY])?;
        if self.pending >= BATCH {
            self.connection.execute_batch("COMMIT; BEGIN")?;
            self.pending = 0;
        }
        Ok(())
    }

    pub(super) fn finish<'a>(
        self,
        agents: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
        frames: u32,
        frame_rate: f64,
    ) -> Result<Ground, Error> {
        let Self { path, connection, partial, area, low, high, .. } = self;
        let sqlite = |source: rusqlite::Error| Error::Sqlite { path: path.clone(), source: source.into() };
        // No agents, no extent: readers want numbers all the same.
        let (low, high) = if low.is_finite() { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
        let (wkt, ground) = area.polygon();
        let complete = || -> rusqlite::Result<()> {
            connection.execute("INSERT INTO geometry VALUES (?1, ?2)", params![GEOMETRY, wkt])?;
            let mut metadata = connection.prepare("INSERT INTO metadata VALUES (?1, ?2)")?;
            for (key, value) in [("xmin", low.x), ("xmax", high.x), ("ymin", low.y), ("ymax", high.y)] {
                metadata.execute(params![key, value.to_string()])?;
            }
            for (id, (agent, presence)) in (1_i64..).zip(agents) {
                insert_agent(
                    &connection,
                    id,
                    agent,
                    presence.map(|presence| presence.times(frames, frame_rate)),
                )?;
            }
            connection.execute_batch("COMMIT; CREATE INDEX frame_id_idx ON trajectory_data(frame, id);")
        };
        complete().map_err(sqlite)?;
        connection.close().map_err(|(_, source)| sqlite(source))?;
        partial.sync().and_then(|()| partial.finish()).map_err(wrong(&path))?;
        Ok(ground)
    }
}

/// Rows of one frame; how many.
fn insert(
    connection: &Connection,
    sql: &str,
    frame: u32,
    samples: impl Iterator<Item = Sample>,
) -> rusqlite::Result<u32> {
    let mut statement = connection.prepare_cached(sql)?;
    let mut count = 0;
    for Sample { id, position, heading, .. } in samples {
        let place = plane_from_ground(position);
        // Heading 0 faces +z, which is -y of their plane.
        let facing = plane_from_ground(Vec2::new(heading.sin(), heading.cos()));
        statement.execute(params![frame, i64::from(id) + 1, place.x, place.y, facing.x, facing.y])?;
        count += 1;
    }
    Ok(count)
}

fn insert_agent(
    connection: &Connection,
    id: i64,
    agent: Option<&AgentInfo>,
    times: Option<(f64, Option<f64>)>,
) -> rusqlite::Result<()> {
    let plain = AgentInfo::default();
    let agent = agent.unwrap_or(&plain);
    let [happy, angry, sad, neutral] =
        agent.emotion.map_or([None; 4], |weights| weights.map(|weight| Some(f64::from(weight))));
    connection.prepare_cached(AGENT)?.execute(params![
        id,
        agent.kind.name(),
        agent.led,
        agent.emotion.map(|weights| strongest_emotion(weights).name()),
        happy,
        angry,
        sad,
        neutral,
        agent.gait,
        agent.avatar,
        agent.class,
        agent.group.map(|first| i64::from(first) + 1),
        agent.radius.map(f64::from),
        agent.preferred_speed.map(f64::from),
        agent.age.map(f64::from),
        agent.stature.map(f64::from),
        agent.weight.map(f64::from),
        times.map(|(entered, _)| entered),
        times.and_then(|(_, left)| left),
    ])?;
    Ok(())
}
