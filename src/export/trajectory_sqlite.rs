//! JuPedSim's SQLite trajectories, version 2: the version that JuPedSim 1.4 writes and PedPy reads in full.
//!
//! Tables `trajectory_data(frame, id, pos_x, pos_y, ori_x, ori_y)`, `metadata(key, value)`, `geometry(hash, wkt)`,
//! `frame_data(frame, geometry_hash)`; an index on (frame, id). Ids start at 1, frames at 0.

use super::Error;
use super::atomic::Neighbour;
use super::trajectory::plane_from_ground;
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
    CREATE TABLE metadata (key TEXT NOT NULL UNIQUE PRIMARY KEY, value TEXT NOT NULL);
    CREATE TABLE geometry (hash INTEGER NOT NULL, wkt TEXT NOT NULL);
    CREATE TABLE frame_data (frame INTEGER NOT NULL, geometry_hash INTEGER NOT NULL);
";

/// An open trajectory database in a temporary neighbour of its place.
#[derive(Debug)]
pub(super) struct Sqlite {
    path: PathBuf,
    // Declared before the neighbour: the database closes before its file is removed.
    connection: Connection,
    neighbour: Neighbour,
    low: DVec2,
    high: DVec2,
    pending: u32,
}

impl Sqlite {
    pub(super) fn create(path: &Path, frame_rate: f64, wkt: &str) -> Result<Self, Error> {
        let neighbour = Neighbour::new(path)?;
        let sqlite = |source| Error::Sqlite { path: path.to_owned(), source };
        let connection = Connection::open(&neighbour.path).map_err(sqlite)?;
        let set_up = || -> rusqlite::Result<()> {
            // The file is worthless until renamed, so a crash needs no journal. (A memory journal leaves no
            // second file behind, either.)
            connection.execute_batch("PRAGMA journal_mode = MEMORY; PRAGMA synchronous = OFF;")?;
            connection.execute_batch(TABLES)?;
            let mut metadata = connection.prepare("INSERT INTO metadata VALUES (?1, ?2)")?;
            metadata.execute(params!["version", "2"])?;
            metadata.execute(params!["fps", frame_rate.to_string()])?;
            connection.execute("INSERT INTO geometry VALUES (?1, ?2)", params![GEOMETRY, wkt])?;
            connection.execute_batch("BEGIN")
        };
        set_up().map_err(sqlite)?;
        Ok(Self {
            path: path.to_owned(),
            connection,
            neighbour,
            low: DVec2::INFINITY,
            high: DVec2::NEG_INFINITY,
            pending: 0,
        })
    }

    pub(super) fn frame(
        &mut self,
        frame: u32,
        rows: impl Iterator<Item = (u32, (Vec2, f32))>,
    ) -> Result<(), Error> {
        self.write(frame, rows).map_err(|source| Error::Sqlite { path: self.path.clone(), source })
    }

    fn write(&mut self, frame: u32, rows: impl Iterator<Item = (u32, (Vec2, f32))>) -> rusqlite::Result<()> {
        let mut insert =
            self.connection.prepare_cached("INSERT INTO trajectory_data VALUES (?1, ?2, ?3, ?4, ?5, ?6)")?;
        for (id, (position, heading)) in rows {
            let place = plane_from_ground(position);
            // Heading 0 faces +z, which is -y of their plane.
            let facing = plane_from_ground(Vec2::new(heading.sin(), heading.cos()));
            insert.execute(params![frame, i64::from(id) + 1, place.x, place.y, facing.x, facing.y])?;
            self.low = self.low.min(place);
            self.high = self.high.max(place);
            self.pending += 1;
        }
        self.connection
            .prepare_cached("INSERT INTO frame_data VALUES (?1, ?2)")?
            .execute(params![frame, GEOMETRY])?;
        if self.pending >= BATCH {
            self.connection.execute_batch("COMMIT; BEGIN")?;
            self.pending = 0;
        }
        Ok(())
    }

    pub(super) fn finish(self) -> Result<(), Error> {
        let Self { path, connection, neighbour, low, high, .. } = self;
        let sqlite = |source| Error::Sqlite { path: path.clone(), source };
        // No agents, no extent: readers want numbers all the same.
        let (low, high) = if low.is_finite() { (low, high) } else { (DVec2::ZERO, DVec2::ZERO) };
        let complete = || -> rusqlite::Result<()> {
            let mut metadata = connection.prepare("INSERT INTO metadata VALUES (?1, ?2)")?;
            for (key, value) in [("xmin", low.x), ("xmax", high.x), ("ymin", low.y), ("ymax", high.y)] {
                metadata.execute(params![key, value.to_string()])?;
            }
            connection.execute_batch("COMMIT; CREATE INDEX frame_id_idx ON trajectory_data(frame, id);")
        };
        complete().map_err(sqlite)?;
        connection.close().map_err(|(_, source)| sqlite(source))?;
        let wrong = super::atomic::wrong(&path);
        std::fs::OpenOptions::new()
            .write(true)
            .open(&neighbour.path)
            .and_then(|file| file.sync_all())
            .map_err(&wrong)?;
        neighbour.rename(&path)
    }
}
