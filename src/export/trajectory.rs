//! Trajectories, streamed frame by frame: JuPedSim SQLite, Parquet, Pedestrian Dynamics Data Archive text, CSV.
//!
//! The plane of these formats is x to the right, y up the page, seen from above. Ours is the ground (x, z), which
//! seen from above is mirrored, so z is negated: x = x, y = -z ([`plane_from_ground`]). A turn to the left stays a
//! turn to the left, and a heading about +y becomes the angle `heading - 90 degrees` from the x axis. The CSV is
//! ours and keeps x, z and the heading.
//!
//! Where a file holds people, robots and vehicles are not among them: the database keeps these apart, the CSV names the
//! kind in every row, Parquet has a column that is false for them, the text of the archive leaves them out.

use super::Error;
use super::agents::{AgentInfo, AgentKind, Attendance, strongest_emotion};
use super::area::{Area, Ground};
use super::atomic::AtomicFile;
pub use super::plane::plane_from_ground;
use super::trajectory_parquet::{self, Parquet};
use super::trajectory_sqlite::Sqlite;
use crate::file::Partial;
use crate::ground::is_absent;
use crate::scenario::Geometry;
use glam::Vec2;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Agents of a frame that a thread looks at at once: they stay in its cache.
pub(super) const TOGETHER: usize = 1 << 14;
/// Most frames of one file: frame numbers are 32 bits in readers.
const MAX_FRAMES: u32 = i32::MAX as u32;

/// A trajectory file format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum TrajectoryFormat {
    /// JuPedSim's SQLite database, version 2: with orientation, walkable area, and the table `agents`. `.sqlite`
    Sqlite,
    /// Parquet: frame, id, x, y, heading, velocity, feelings; the table of agents beside it. `.parquet`
    Parquet,
    /// The text of the Pedestrian Dynamics Data Archive: id, frame, x, y, z. `.txt`
    Text,
    /// frame, time, id, x, z, heading and velocity in our own frame, emotion and kind. `.csv`
    Csv,
}

impl TrajectoryFormat {
    /// The format a file name asks for: `.sqlite`, `.sqlite3` or `.db`; `.parquet`; `.txt`; `.csv`.
    ///
    /// # Errors
    /// [`Error::Unusable`] names the endings there are.
    pub fn from_path(path: &Path) -> Result<Self, Error> {
        let ending = path.extension().and_then(|ending| ending.to_str()).unwrap_or("").to_ascii_lowercase();
        match ending.as_str() {
            "sqlite" | "sqlite3" | "db" => Ok(Self::Sqlite),
            "parquet" => Ok(Self::Parquet),
            "txt" => Ok(Self::Text),
            "csv" => Ok(Self::Csv),
            _ => Err(Error::Unusable {
                path: path.to_owned(),
                message: format!(
                    "no trajectory format ends in {ending:?}; use .sqlite (JuPedSim, PedPy), .parquet (polars, pandas, \
                     DuckDB), .txt (Pedestrian Dynamics Data Archive) or .csv"
                ),
            }),
        }
    }
}

/// The walkable area, written into formats that hold one.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Walkable {
    /// Outer outline (x, z), m, either orientation, simple.
    pub bounds: Vec<Vec2>,
    /// What cannot be walked on (x, z), m, either orientation, each simple. Obstacles may overlap, touch and stick out.
    pub obstacles: Vec<Vec<Vec2>>,
}

impl Walkable {
    /// The bounds less the union of the obstacles as WKT `POLYGON`, or MULTIPOLYGON where they cut it into parts, in the
    /// formats' plane. Corners are rounded to a tenth of a millimetre.
    pub fn wkt(&self) -> String {
        Area::new(&self.bounds, &self.obstacles).wkt()
    }

    /// The same as one `POLYGON`, which is all that PedPy and JuPedSim take: of several parts those with `places` (x, z), m,
    /// in them, joined by slits of two millimetres; the largest where no part has any. And how many parts there are.
    pub fn polygon(&self, places: impl IntoIterator<Item = Vec2>) -> (String, Ground) {
        let mut area = Area::new(&self.bounds, &self.obstacles);
        area.visit((0..).zip(places));
        area.polygon()
    }
}

impl From<&Geometry> for Walkable {
    fn from(geometry: &Geometry) -> Self {
        Self { bounds: geometry.bounds.clone(), obstacles: geometry.obstacles.clone() }
    }
}

/// A frame: one entry for each agent. The agent's index is its id; absent agents ([`is_absent`]) are left out.
#[derive(Debug, Clone, Copy, Default)]
pub struct Frame<'a> {
    /// Ground positions (x, z), m.
    pub positions: &'a [Vec2],
    /// Headings about +y, rad.
    pub headings: &'a [f32],
    /// Ground velocities (x, z), m/s; empty: not known.
    pub velocities: &'a [Vec2],
    /// Weights of the emotions, where they change; empty: as at the start.
    pub emotions: &'a [[f32; 4]],
}

/// An agent in a frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Sample {
    pub(super) id: u32,
    pub(super) position: Vec2,
    pub(super) heading: f32,
    velocity: Option<Vec2>,
    emotion: Option<[f32; 4]>,
}

#[derive(Debug)]
enum Sink {
    // Boxed: it holds a database's statements and is far larger than the other.
    Sqlite(Box<Sqlite>),
    Parquet(Parquet),
    /// Nothing but the table of agents.
    Agents,
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
    agents: Vec<AgentInfo>,
    attendance: Attendance,
}

impl TrajectoryWriter {
    /// Begins a file; `frame_rate` in frames per second, `agents` by index (agents beyond its end
    /// count as people without further data).
    ///
    /// # Errors
    /// [`Error::Unusable`] for a frame rate outside 0.001 to 1000, bounds of fewer than 3 corners, or obstacles that leave
    /// no ground (SQLite); [`Error::Write`] or [`Error::Sqlite`] when the file cannot be made.
    pub fn create(
        path: &Path,
        format: TrajectoryFormat,
        frame_rate: f64,
        walkable: &Walkable,
        agents: Vec<AgentInfo>,
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
                let area = Area::new(&walkable.bounds, &walkable.obstacles);
                if area.is_empty() {
                    let message =
                        "the obstacles leave no ground to walk on; use .txt or .csv, which hold no area";
                    return Err(unusable(message.to_owned()));
                }
                Sink::Sqlite(Box::new(Sqlite::create(path, frame_rate, area)?))
            }
            TrajectoryFormat::Parquet => {
                let area = (walkable.bounds.len() >= 3)
                    .then(|| Area::new(&walkable.bounds, &walkable.obstacles))
                    .filter(|area| !area.is_empty());
                Sink::Parquet(Parquet::create(path, frame_rate, area, &agents)?)
            }
            TrajectoryFormat::Text => {
                let mut file = AtomicFile::create(path)?;
                write!(file, "# framerate: {frame_rate:.6}\n# id frame x/m y/m z/m\n")
                    .map_err(super::atomic::wrong(path))?;
                Sink::Text(file)
            }
            TrajectoryFormat::Csv => {
                let mut file = AtomicFile::create(path)?;
                writeln!(file, "frame,time_s,id,x_m,z_m,heading_rad,vx_m_s,vz_m_s,emotion,kind")
                    .map_err(super::atomic::wrong(path))?;
                Sink::Csv(file)
            }
        };
        let path = path.to_owned();
        Ok(Self { path, sink, frames: 0, rate: frame_rate, agents, attendance: Attendance::default() })
    }

    /// Begins a table of agents as Parquet, without their trajectories: frames tell when they enter and leave.
    pub(crate) fn of_agents(path: &Path, frame_rate: f64, agents: Vec<AgentInfo>) -> Result<Self, Error> {
        Partial::create(path).map_err(super::atomic::wrong(path))?;
        let (path, sink) = (path.to_owned(), Sink::Agents);
        Ok(Self { path, sink, frames: 0, rate: frame_rate, agents, attendance: Attendance::default() })
    }

    /// Frames written so far.
    pub const fn frames(&self) -> u32 {
        self.frames
    }

    /// Appends a frame. Frames are `1 / frame_rate` apart.
    ///
    /// # Errors
    /// [`Error::Unusable`] when the lists differ in length or hold a number that is not finite (agent named);
    /// [`Error::Write`], [`Error::Sqlite`] or [`Error::Parquet`] when the disc is full; of Parquet, which a thread writes, with
    /// a later frame.
    pub fn frame(&mut self, frame: &Frame<'_>) -> Result<(), Error> {
        self.fits(frame)?;
        let number = self.frames;
        if let Sink::Parquet(file) = &mut self.sink {
            file.frame(number, frame, &mut self.attendance)?;
            self.frames += 1;
            return Ok(());
        }
        // in three sweeps; only who fails is looked for one by one
        if !(all_finite(bytemuck::cast_slice(frame.positions))
            && all_finite(frame.headings)
            && all_finite(bytemuck::cast_slice(frame.velocities)))
        {
            refuse_infinite(&self.path, number, frame)?;
        }
        self.attendance.see(number, frame.positions);
        let there = || samples(frame);
        let agents = &self.agents;
        let kind =
            |sample: &Sample| agents.get(sample.id as usize).map_or(AgentKind::Person, |agent| agent.kind);
        let people = || there().filter(|sample| kind(sample) == AgentKind::Person);
        match &mut self.sink {
            Sink::Sqlite(database) => {
                let others = there().filter(|sample| kind(sample) != AgentKind::Person);
                database.frame(number, people, others)?;
            }
            Sink::Parquet(_) | Sink::Agents => {}
            Sink::Text(file) => {
                text_frame(file, number, people()).map_err(super::atomic::wrong(&self.path))?;
            }
            Sink::Csv(file) => {
                let time = f64::from(number) / self.rate;
                csv_frame(file, number, time, there(), agents).map_err(super::atomic::wrong(&self.path))?;
            }
        }
        self.frames += 1;
        Ok(())
    }

    /// Refuses lists that do not fit one another.
    fn fits(&self, frame: &Frame<'_>) -> Result<(), Error> {
        let unusable = |message: String| Error::Unusable { path: self.path.clone(), message };
        let Frame { positions, headings, velocities, emotions } = frame;
        let (number, p, h) = (self.frames, positions.len(), headings.len());
        if p != h {
            return Err(unusable(format!("frame {number}: {p} positions but {h} headings; give one each")));
        }
        for (what, found) in [("velocities", velocities.len()), ("emotions", emotions.len())] {
            if found != 0 && found != p {
                let message =
                    format!("frame {number}: {p} positions but {found} {what}; give one each, or none");
                return Err(unusable(message));
            }
        }
        if number >= MAX_FRAMES || u32::try_from(p).is_err() {
            return Err(unusable(format!("more than {MAX_FRAMES} frames or agents; split the run")));
        }
        Ok(())
    }

    /// Completes the file and gives it its name. Returns the parts of a database's or Parquet file's walkable area.
    ///
    /// # Errors
    /// [`Error::Write`], [`Error::Sqlite`] or [`Error::Parquet`]; the name is then as it was before.
    pub fn finish(self) -> Result<Ground, Error> {
        let presence = self.attendance.finish(self.frames);
        let known = presence.len().max(self.agents.len());
        let agents = (0..known).map(|id| (self.agents.get(id), presence.get(id).copied().flatten()));
        match self.sink {
            Sink::Sqlite(database) => database.finish(agents, self.frames, self.rate),
            Sink::Parquet(file) => file.finish(agents, self.frames, self.rate),
            Sink::Agents => {
                trajectory_parquet::write_agents(&self.path, agents, self.frames, self.rate)?;
                Ok(Ground::default())
            }
            Sink::Text(file) | Sink::Csv(file) => file.finish().map(|()| Ground::default()),
        }
    }
}

/// Refuses numbers that are none, of agents that are there.
pub(super) fn refuse_infinite(path: &Path, number: u32, frame: &Frame<'_>) -> Result<(), Error> {
    let is_whole = |s: &Sample| {
        s.position.is_finite() && s.heading.is_finite() && s.velocity.is_none_or(Vec2::is_finite)
    };
    match samples(frame).find(|sample| !is_whole(sample)) {
        Some(Sample { id, position, heading, .. }) => {
            let message = format!(
                "frame {number}: agent {id} is at {position}, heading {heading}; both and its velocity must be finite"
            );
            Err(Error::Unusable { path: path.to_owned(), message })
        }
        None => Ok(()),
    }
}

/// Whether numbers are. Without an early end, so that the compiler makes vectors of it.
pub(super) fn all_finite(values: &[f32]) -> bool {
    values.iter().fold(true, |all, value| all & value.is_finite())
}

/// The agents present in a frame.
fn samples<'a>(frame: &Frame<'a>) -> impl Iterator<Item = Sample> + use<'a> {
    let Frame { positions, headings, velocities, emotions } = *frame;
    let all = (0_u32..).zip(positions.iter().zip(headings)).zip(0..);
    let sample = move |((id, (position, heading)), at): ((u32, (&Vec2, &f32)), usize)| Sample {
        id,
        position: *position,
        heading: *heading,
        velocity: velocities.get(at).copied(),
        emotion: emotions.get(at).copied(),
    };
    all.map(sample).filter(|sample| !is_absent(sample.position.to_array()))
}

fn text_frame(
    file: &mut AtomicFile,
    frame: u32,
    samples: impl Iterator<Item = Sample>,
) -> std::io::Result<()> {
    for Sample { id, position, .. } in samples {
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
    samples: impl Iterator<Item = Sample>,
    agents: &[AgentInfo],
) -> std::io::Result<()> {
    for Sample { id, position: p, heading, velocity, emotion } in samples {
        // `{}` prints the shortest text that reads back as the same f32.
        write!(file, "{frame},{time:.6},{id},{},{},{heading},", p.x, p.y)?;
        match velocity {
            Some(v) => write!(file, "{},{},", v.x, v.y)?,
            None => write!(file, ",,")?,
        }
        let agent = agents.get(id as usize);
        let own = agent.and_then(|agent| agent.emotion);
        // A robot feels nothing, whatever the crowd does.
        if let Some(weights) = own.and(emotion).or(own).or(if agent.is_none() { emotion } else { None }) {
            write!(file, "{}", strongest_emotion(weights))?;
        }
        writeln!(file, ",{}", agent.map_or(AgentKind::Person, |agent| agent.kind).name())?;
    }
    Ok(())
}
