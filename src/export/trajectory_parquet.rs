//! Trajectories as Parquet: a row for each agent and frame, in the plane of the databases (y = -z), with ids from 1.
//!
//! Places are those of the simulation to the last bit. Headings, velocities and feelings are rounded to 1/1024, below what a
//! camera sees. In a row group rows stand by agent, then by frame: what changes slowly takes a quarter less.
//!
//! A thread encodes, compresses and writes, so a step waits only for a copy of its numbers. [`QUEUE`] rows may wait for the
//! thread; then the steps wait for it. What goes wrong in it is the error of a later frame, or of the end.

use super::Error;
use super::agents::{AgentInfo, AgentKind, Attendance, Change, Presence, Seen};
use super::area::{Area, Ground};
use super::atomic::wrong;
use super::columns::{AREA_KEY, FRAME_RATE_KEY, agents_path};
use super::parquet_table::{Table, refused};
use super::trajectory::{Frame, TOGETHER, all_finite, refuse_infinite};
use super::trajectory_block::Copied;
use super::trajectory_rows::{COLUMNS, Rows};
use crate::file::Partial;
use glam::Vec2;
use parquet::errors::ParquetError;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

/// Rows that may wait to be written: some 80 MB.
const QUEUE: usize = 1 << 22;
/// Rows of a row group, at least: a file has at most 32,767 groups.
const GROUP: usize = 1 << 18;
/// Frames of a row group, at least, unless as many again were more than [`MOST`] rows.
const FRAMES: usize = 8;
/// Rows of a row group of few frames, at most, but for that of one frame: as columns they take some 40 MB.
const MOST: usize = 1 << 22;

/// Whether so many frames with so many rows are a row group. They are 1, 2, 4 or another power of two, which are made rows of the
/// fastest, unless they have too many rows already.
const fn is_group(frames: usize, rows: usize) -> bool {
    let is_long = frames >= FRAMES || 2 * rows > MOST;
    rows >= MOST || rows >= GROUP && is_long && frames.is_power_of_two()
}

/// What a frame shows: who comes or goes, and whether its numbers are finite.
struct Look {
    changes: Vec<Change>,
    is_finite: bool,
}

/// Copies a frame into memory that is there already, on all cores: the steps wait for it.
fn take(copied: &mut Copied, frame: &Frame<'_>, attendance: &Attendance) -> Look {
    let Frame { positions, headings, velocities, emotions } = *frame;
    let velocities: &[f32] = bytemuck::cast_slice(velocities);
    copied.positions.resize(positions.len(), Vec2::ZERO);
    // a part is read from memory once
    let parts = positions.par_chunks(TOGETHER).zip(copied.positions.par_chunks_mut(TOGETHER)).enumerate();
    let look = parts.map(|(number, (from, to))| {
        to.copy_from_slice(from);
        (attendance.compare(number * TOGETHER, from), all_finite(bytemuck::cast_slice(from)))
    });
    let (seen, are_finite): (Vec<Seen>, Vec<bool>) = look.unzip();
    copied.present = seen.iter().map(|seen| seen.present).sum();
    copied.headings.take(headings);
    copied.velocities.take(velocities);
    copied.emotions.take(emotions.as_flattened());
    // what is near zero is finite
    let is_finite = are_finite.into_iter().all(|is_finite| is_finite)
        && (copied.headings.is_near() || all_finite(headings))
        && (copied.velocities.is_near() || all_finite(velocities));
    Look { changes: seen.into_iter().flat_map(|seen| seen.changes).collect(), is_finite }
}

#[derive(Debug)]
enum Message {
    Frame(Copied),
    /// The file is whole.
    End,
}

/// What the thread leaves: the file and its ground; nothing where it was not told the end.
type Done = Result<Option<(Partial, Ground)>, Error>;

/// Trajectories in Parquet that a thread is writing.
#[derive(Debug)]
pub(super) struct Parquet {
    path: PathBuf,
    sender: Option<SyncSender<Message>>,
    /// Frames that are written.
    used: Receiver<Copied>,
    thread: Option<JoinHandle<Done>>,
}

impl Parquet {
    pub(super) fn create(
        path: &Path,
        frame_rate: f64,
        area: Option<Area>,
        agents: &[AgentInfo],
    ) -> Result<Self, Error> {
        let mut table = Table::create(path, &COLUMNS)?;
        table.note(FRAME_RATE_KEY, frame_rate.to_string());
        let queue = (QUEUE / agents.len().max(1)).clamp(2, 1024);
        let (sender, receiver) = sync_channel(queue);
        let (written, used) = channel();
        let mut writer = Writer {
            path: path.to_owned(),
            table,
            written,
            frames: Vec::new(),
            count: 0,
            rows: Rows::new().map_err(refused(path))?,
            are_people: agents.iter().map(|agent| agent.kind == AgentKind::Person).collect(),
            area,
        };
        let work = move || writer.run(&receiver).and_then(|is_whole| writer.end(is_whole));
        let thread = std::thread::Builder::new().name("parquet".to_owned()).spawn(work);
        let thread = thread.map_err(wrong(path))?;
        Ok(Self { path: path.to_owned(), sender: Some(sender), used, thread: Some(thread) })
    }

    /// Takes a frame, whose lists fit one another, and notes who comes and goes. Numbers that are not finite are refused.
    pub(super) fn frame(
        &mut self,
        number: u32,
        frame: &Frame<'_>,
        attendance: &mut Attendance,
    ) -> Result<(), Error> {
        let mut copied = self.used.try_recv().unwrap_or_default();
        copied.number = number;
        let look = take(&mut copied, frame, attendance);
        if !look.is_finite {
            refuse_infinite(&self.path, number, frame)?;
        }
        attendance.apply(number, frame.positions.len(), &look.changes);
        self.send(Message::Frame(copied))
    }

    fn send(&mut self, message: Message) -> Result<(), Error> {
        if self.sender.as_ref().is_some_and(|sender| sender.send(message).is_ok()) {
            return Ok(());
        }
        self.join().and(Err(self.ended()))
    }

    /// What the thread left, once it has ended.
    fn join(&mut self) -> Done {
        self.sender = None;
        match self.thread.take().map(JoinHandle::join) {
            Some(Ok(done)) => done,
            _ => Err(self.ended()),
        }
    }

    fn ended(&self) -> Error {
        let message = "the thread that writes it has ended; the file is not written".to_owned();
        Error::Unusable { path: self.path.clone(), message }
    }

    /// Completes the file and writes the table of agents beside it.
    pub(super) fn finish<'a>(
        mut self,
        agents: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
        frames: u32,
        frame_rate: f64,
    ) -> Result<Ground, Error> {
        self.send(Message::End)?;
        let Some((file, ground)) = self.join()? else { return Err(self.ended()) };
        write_agents(&agents_path(&self.path), agents, frames, frame_rate)?;
        file.sync().and_then(|()| file.finish()).map_err(wrong(&self.path))?;
        Ok(ground)
    }
}

/// Writes the table of agents.
pub(super) fn write_agents<'a>(
    path: &Path,
    agents: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
    frames: u32,
    frame_rate: f64,
) -> Result<(), Error> {
    let table = super::agents_parquet::write(path, agents, frames, frame_rate)?;
    table.sync().and_then(|()| table.finish()).map_err(wrong(path))
}

impl Drop for Parquet {
    fn drop(&mut self) {
        // Without its end the thread removes what it wrote; a destructor cannot return an error.
        let _ = self.join();
    }
}

/// What the thread holds.
#[derive(Debug)]
struct Writer {
    path: PathBuf,
    table: Table,
    /// Takes the memory of frames back.
    written: Sender<Copied>,
    /// Frames of the next row group, and its rows.
    frames: Vec<Copied>,
    count: usize,
    rows: Rows,
    are_people: Vec<bool>,
    area: Option<Area>,
}

impl Writer {
    /// Writes frames until the end; whether that came.
    fn run(&mut self, receiver: &Receiver<Message>) -> Result<bool, Error> {
        for message in receiver {
            let Message::Frame(frame) = message else { return Ok(true) };
            self.visit(&frame);
            self.count += frame.present;
            self.frames.push(frame);
            if is_group(self.frames.len(), self.count) {
                self.flush().map_err(refused(&self.path))?;
            }
        }
        Ok(false)
    }

    fn end(mut self, is_whole: bool) -> Done {
        if !is_whole {
            return Ok(None);
        }
        let mut ground = Ground::default();
        if let Some(area) = self.area.take() {
            let (wkt, found) = area.polygon();
            self.table.note(AREA_KEY, wkt);
            ground = found;
        }
        let rest = if self.count == 0 { Ok(()) } else { self.flush() };
        let path = std::mem::take(&mut self.path);
        let file = rest.and_then(|()| self.table.complete()).map_err(refused(&path))?;
        Ok(Some((file, ground)))
    }

    fn is_person(&self, agent: usize) -> bool {
        self.are_people.get(agent).copied().unwrap_or(true)
    }

    /// Notes in which part of the walkable area people are.
    fn visit(&mut self, frame: &Copied) {
        if let Some(mut area) = self.area.take() {
            let people = (0_u32..).zip(&frame.positions).filter(|(id, _)| self.is_person(*id as usize));
            area.visit(people.map(|(id, place)| (id, *place)));
            self.area = Some(area);
        }
    }

    /// Writes the frames as a row group.
    fn flush(&mut self) -> Result<(), ParquetError> {
        let are_people = &self.are_people;
        let is_person = |agent: usize| are_people.get(agent).copied().unwrap_or(true);
        self.rows.write(&mut self.table, &mut self.frames, self.count, is_person)?;
        for frame in self.frames.drain(..) {
            let _ = self.written.send(frame); // not taken once the simulation has ended
        }
        self.count = 0;
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::{TrajectoryFormat, TrajectoryWriter, Walkable};
    use super::*;
    use crate::ground::ABSENT;
    use parquet::file::reader::{FileReader, SerializedFileReader};

    #[test]
    fn row_groups_have_a_power_of_two_of_frames_or_very_many_rows() {
        let ends = |agents: usize| (1..).find(|frames| is_group(*frames, frames * agents));
        let expected = [(100, 4096), (10_000, 32), (40_000, 8), (500_000, 8), (600_000, 4), (1_000_000, 4)];
        for (agents, frames) in expected {
            assert_eq!(ends(agents), Some(frames), "{agents} agents");
        }
        assert_eq!(ends(5_000_000), Some(1));
        assert!(is_group(1001, 5_000_000), "a crowd that comes after a thousand empty frames");
    }

    #[test]
    fn numbers_that_are_not_finite_are_refused_of_who_is_there_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.parquet");
        let format = TrajectoryFormat::Parquet;
        let mut writer =
            TrajectoryWriter::create(&path, format, 10.0, &Walkable::default(), Vec::new()).unwrap();
        let fine = Frame {
            positions: &[Vec2::ONE, Vec2::ONE],
            headings: &[0.5, 0.5],
            velocities: &[Vec2::ONE, Vec2::ONE],
            emotions: &[],
        };
        for odd in [
            Frame { positions: &[Vec2::ONE, Vec2::NAN], ..fine },
            Frame { headings: &[0.5, f32::INFINITY], ..fine },
            Frame { velocities: &[Vec2::ONE, Vec2::NEG_INFINITY], ..fine },
        ] {
            let error = writer.frame(&odd).unwrap_err().to_string();
            assert!(error.contains("agent 1"), "{error}");
        }
        assert_eq!(writer.frames(), 0);
        let gone = Frame {
            positions: &[Vec2::ONE, Vec2::splat(ABSENT)],
            headings: &[0.5, f32::NAN],
            velocities: &[Vec2::ONE, Vec2::NAN],
            emotions: &[],
        };
        writer.frame(&gone).unwrap();
        writer.frame(&fine).unwrap();
        writer.finish().unwrap();
        let file = SerializedFileReader::new(std::fs::File::open(&path).unwrap()).unwrap();
        assert_eq!(file.metadata().file_metadata().num_rows(), 3);
    }
}
