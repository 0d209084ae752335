//! Trajectories, streamed frame by frame: JuPedSim SQLite, Pedestrian Dynamics Data Archive text, CSV.
//!
//! The plane of these formats is x to the right, y up the page, seen from above. Ours is the ground (x, z), which
//! seen from above is mirrored, so z is negated: x = x, y = -z ([`plane_from_ground`]). A turn to the left stays a
//! turn to the left, and a heading about +y becomes the angle `heading - 90 degrees` from the x axis. The CSV is
//! ours and keeps x, z and the heading.

use super::atomic::AtomicFile;
use super::trajectory_sqlite::Sqlite;
use super::{Error, wkt};
use crate::ground::is_absent;
use crate::scenario::Geometry;
use glam::{DVec2, Vec2};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Most frames of one file: frame numbers are 32 bits in readers.
const MAX_FRAMES: u32 = i32::MAX as u32;

/// Our ground (x, z) in the trajectory formats' plane (x, y): y = -z keeps left and right as seen from above.
pub fn plane_from_ground(ground: Vec2) -> DVec2 {
    // `0 - z`, not `-z`: no negative zeros in files.
    DVec2::new(f64::from(ground.x), 0.0 - f64::from(ground.y))
}

/// A trajectory file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrajectoryFormat {
    /// JuPedSim's SQLite database, version 2: with orientation and walkable area. `.sqlite`
    Sqlite,
    /// The text of the Pedestrian Dynamics Data Archive: id, frame, x, y, z. `.txt`
    Text,
    /// frame, time, id, x, z, heading in our own frame. `.csv`
    Csv,
}

impl TrajectoryFormat {
    /// The format a file name asks for: `.sqlite`, `.sqlite3` or `.db`; `.txt`; `.csv`.
    ///
    /// # Errors
    /// [`Error::Unusable`] names the endings there are.
    pub fn from_path(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_ascii_lowercase();
        match ending.as_str() {
            "sqlite" | "sqlite3" | "db" => Ok(Self::Sqlite),
            "txt" => Ok(Self::Text),
            "csv" => Ok(Self::Csv),
            _ => Err(Error::Unusable {
                path: path.to_owned(),
                message: format!(
                    "no trajectory format ends in {ending:?}; use .sqlite (JuPedSim, PedPy), .txt (Pedestrian \
                     Dynamics Data Archive) or .csv"
                ),
            }),
        }
    }
}

/// The walkable area, written into formats that hold one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walkable {
    /// Outer outline (x, z), m, either orientation.
    pub bounds: Vec<Vec2>,
    /// Holes (x, z), m, either orientation, disjoint and within the bounds.
    pub obstacles: Vec<Vec<Vec2>>,
}

impl Walkable {
    /// The area as WKT `POLYGON` in the formats' plane.
    pub fn wkt(&self) -> String {
        wkt::polygon(&self.bounds, &self.obstacles)
    }
}

impl From<&Geometry> for Walkable {
    fn from(geometry: &Geometry) -> Self {
        Self { bounds: geometry.bounds.clone(), obstacles: geometry.obstacles.clone() }
    }
}

#[derive(Debug)]
enum Sink {
    // Boxed: it holds a database's statements and is far larger than the other.
    Sqlite(Box<Sqlite>),
    Text(AtomicFile),
    Csv(AtomicFile),
}

/// Writes one trajectory file, frame by frame. The file appears when [`TrajectoryWriter::finish`] is called;
/// dropped before, it leaves nothing.
#[derive(Debug)]
pub struct TrajectoryWriter {
    path: PathBuf,
    sink: Sink,
    frames: u32,
    rate: f64,
}

impl TrajectoryWriter {
    /// Begins a file; `frame_rate` in frames per second.
    ///
    /// # Errors
    /// [`Error::Unusable`] for a frame rate outside 0.001 to 1000 or bounds of fewer than 3 corners (SQLite);
    /// [`Error::Write`] or [`Error::Sqlite`] when the file cannot be made.
    pub fn create(
        path: &Path,
        format: TrajectoryFormat,
        frame_rate: f64,
        walkable: &Walkable,
    ) -> Result<Self, Error> {
        let unusable = |message: String| Error::Unusable { path: path.to_owned(), message };
        if !(0.001..=1000.0).contains(&frame_rate) {
            return Err(unusable(format!(
                "frame rate {frame_rate}; it must be 0.001 to 1000 frames per second"
            )));
        }
        let sink = match format {
            TrajectoryFormat::Sqlite => {
                if walkable.bounds.len() < 3 {
                    let found = walkable.bounds.len();
                    let message =
                        format!("walkable area of {found} corners; it needs 3 or more, or use .txt or .csv");
                    return Err(unusable(message));
                }
                Sink::Sqlite(Box::new(Sqlite::create(path, frame_rate, &walkable.wkt())?))
            }
            TrajectoryFormat::Text => {
                let mut file = AtomicFile::create(path)?;
                write!(file, "# framerate: {frame_rate:.6}\n# id frame x/m y/m z/m\n")
                    .map_err(super::atomic::wrong(path))?;
                Sink::Text(file)
            }
            TrajectoryFormat::Csv => {
                let mut file = AtomicFile::create(path)?;
                writeln!(file, "frame,time_s,id,x_m,z_m,heading_rad").map_err(super::atomic::wrong(path))?;
                Sink::Csv(file)
            }
        };
        Ok(Self { path: path.to_owned(), sink, frames: 0, rate: frame_rate })
    }

    /// Frames written so far.
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// Appends a frame: ground positions (x, z) in m and headings about +y in radians, one per agent; the agent's
    /// index is its id, and one who is absent ([`is_absent`]) is left out. Frames are `1 / frame_rate` apart.
    ///
    /// # Errors
    /// [`Error::Unusable`] when the lists differ in length or hold a number that is not finite (agent named);
    /// [`Error::Write`] or [`Error::Sqlite`] when the disc is full.
    pub fn frame(&mut self, positions: &[Vec2], headings: &[f32]) -> Result<(), Error> {
        let unusable = |message: String| Error::Unusable { path: self.path.clone(), message };
        if positions.len() != headings.len() {
            let (p, h) = (positions.len(), headings.len());
            return Err(unusable(format!(
                "frame {}: {p} positions but {h} headings; give one each",
                self.frames
            )));
        }
        if self.frames >= MAX_FRAMES || u32::try_from(positions.len()).is_err() {
            return Err(unusable(format!("more than {MAX_FRAMES} frames or agents; split the run")));
        }
        let rows = || {
            let all = (0_u32..).zip(positions.iter().copied().zip(headings.iter().copied()));
            all.filter(|(_, (position, _))| !is_absent(position.to_array()))
        };
        if let Some((id, (position, heading))) = rows().find(|(_, (p, h))| !p.is_finite() || !h.is_finite()) {
            let frame = self.frames;
            let message =
                format!("frame {frame}: agent {id} is at {position}, heading {heading}; both must be finite");
            return Err(unusable(message));
        }
        let frame = self.frames;
        match &mut self.sink {
            Sink::Sqlite(database) => database.frame(frame, rows())?,
            Sink::Text(file) => text_frame(file, frame, rows()).map_err(super::atomic::wrong(&self.path))?,
            Sink::Csv(file) => {
                let time = f64::from(frame) / self.rate;
                csv_frame(file, frame, time, rows()).map_err(super::atomic::wrong(&self.path))?;
            }
        }
        self.frames += 1;
        Ok(())
    }

    /// Completes the file and gives it its name.
    ///
    /// # Errors
    /// [`Error::Write`] or [`Error::Sqlite`]; nothing then stands under the name that did not before.
    pub fn finish(self) -> Result<(), Error> {
        match self.sink {
            Sink::Sqlite(database) => database.finish(),
            Sink::Text(file) | Sink::Csv(file) => file.finish(),
        }
    }
}

fn text_frame(
    file: &mut AtomicFile,
    frame: u32,
    rows: impl Iterator<Item = (u32, (Vec2, f32))>,
) -> std::io::Result<()> {
    for (id, (position, _)) in rows {
        let p = plane_from_ground(position);
        // Ids start at 1 in the archive. A tenth of a millimetre is finer than any tracking.
        writeln!(file, "{} {frame} {:.4} {:.4} 0.0000", id + 1, p.x, p.y)?;
    }
    Ok(())
}

fn csv_frame(
    file: &mut AtomicFile,
    frame: u32,
    time: f64,
    rows: impl Iterator<Item = (u32, (Vec2, f32))>,
) -> std::io::Result<()> {
    for (id, (p, heading)) in rows {
        // `{}` prints the shortest text that reads back as the same f32.
        writeln!(file, "{frame},{time:.6},{id},{},{},{heading}", p.x, p.y)?;
    }
    Ok(())
}
