//! Trajectories as Parquet: a row for each agent and frame, in the plane of the databases (y = -z), with ids from 1.
//!
//! Places are those of the simulation to the last bit. Headings, velocities and feelings are rounded to 1/1024, below what a
//! camera sees. In a row group rows stand by agent, then by frame: what changes slowly takes a quarter less.
//!
//! A thread encodes, compresses and writes, so a step waits only for a copy of its numbers. [`QUEUE`] rows may wait for the
//! thread; then the steps wait for it. What goes wrong in it is the error of a later frame, or of the end.

use super::Error;
use super::agents::{AgentInfo, AgentKind, Presence};
use super::area::{Area, Ground};
use super::atomic::wrong;
use super::columns::{
    AREA_KEY, EMOTIONS, FRAME, FRAME_RATE_KEY, HEADING, ID, IS_PERSON, VX, VY, X, Y, agents_path,
};
use super::parquet_table::{ColumnOf, Kind, Table, Values, refused};
use super::trajectory::Frame;
use crate::file::Partial;
use crate::ground::is_absent;
use glam::Vec2;
use parquet::errors::ParquetError;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, SyncSender, channel, sync_channel};
use std::thread::JoinHandle;

/// Rows that may wait to be written: some 80 MB.
const QUEUE: usize = 1 << 22;
/// Rows of a row group, at least: a file has at most 32,767 groups.
const GROUP: usize = 1 << 18;
/// Frames of a row group, at least, unless it has [`MOST`] rows.
const FRAMES: usize = 8;
/// Rows of a row group from which on it is written whatever its frames: they take some 250 MB.
const MOST: usize = 1 << 22;
/// Headings, velocities and weights of emotions are multiples of its inverse.
const STEPS: f32 = 1024.0;

const fn column(name: &'static str, kind: Kind, is_optional: bool) -> ColumnOf {
    ColumnOf { name, kind, is_optional }
}

const COLUMNS: [ColumnOf; 12] = [
    column(FRAME, Kind::Whole, false),
    column(ID, Kind::Whole, false),
    column(X, Kind::Float, false),
    column(Y, Kind::Float, false),
    column(HEADING, Kind::Float, false),
    column(VX, Kind::Float, true),
    column(VY, Kind::Float, true),
    column(IS_PERSON, Kind::Flag, false),
    column(EMOTIONS[0], Kind::Float, true),
    column(EMOTIONS[1], Kind::Float, true),
    column(EMOTIONS[2], Kind::Float, true),
    column(EMOTIONS[3], Kind::Float, true),
];

/// A frame on its way to the thread, and its memory on the way back.
#[derive(Debug, Default)]
struct Copied {
    number: u32,
    positions: Vec<Vec2>,
    headings: Vec<f32>,
    velocities: Vec<Vec2>,
    emotions: Vec<[f32; 4]>,
}

impl Copied {
    fn take(&mut self, number: u32, frame: &Frame<'_>) {
        self.number = number;
        self.positions.clear();
        self.positions.extend_from_slice(frame.positions);
        self.headings.clear();
        self.headings.extend_from_slice(frame.headings);
        self.velocities.clear();
        self.velocities.extend_from_slice(frame.velocities);
        self.emotions.clear();
        self.emotions.extend_from_slice(frame.emotions);
    }

    /// Whether an agent is there in this frame.
    fn has(&self, agent: usize) -> bool {
        self.positions.get(agent).is_some_and(|place| !is_absent(place.to_array()))
    }
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
            rows: Rows::default(),
            are_people: agents.iter().map(|agent| agent.kind == AgentKind::Person).collect(),
            area,
        };
        let work = move || writer.run(&receiver).and_then(|is_whole| writer.end(is_whole));
        let thread = std::thread::Builder::new().name("parquet".to_owned()).spawn(work);
        let thread = thread.map_err(wrong(path))?;
        Ok(Self { path: path.to_owned(), sender: Some(sender), used, thread: Some(thread) })
    }

    pub(super) fn frame(&mut self, number: u32, frame: &Frame<'_>) -> Result<(), Error> {
        let mut copied = self.used.try_recv().unwrap_or_default();
        copied.take(number, frame);
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

/// Rows that are collected for the next row group.
#[derive(Debug, Default)]
struct Rows {
    /// Which agent in which frame of the group a row is of.
    of: Vec<(u32, u32)>,
    frame: Vec<i32>,
    id: Vec<i32>,
    x: Vec<f32>,
    y: Vec<f32>,
    heading: Vec<f32>,
    velocity: [Vec<f32>; 2],
    has_velocity: Vec<i16>,
    is_person: Vec<bool>,
    emotion: [Vec<f32>; 4],
    has_emotion: Vec<i16>,
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
    /// Its columns while it is written.
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
            self.count += frame.positions.iter().filter(|place| !is_absent(place.to_array())).count();
            self.frames.push(frame);
            if self.count >= MOST || self.count >= GROUP && self.frames.len() >= FRAMES {
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

    /// Turns the frames into rows, and writes these as a group.
    fn flush(&mut self) -> Result<(), ParquetError> {
        let mut rows = std::mem::take(&mut self.rows);
        rows.fill(&self.frames, |agent| self.is_person(agent));
        for frame in self.frames.drain(..) {
            let _ = self.written.send(frame); // not taken once the simulation has ended
        }
        self.count = 0;
        rows.write(&mut self.table)?;
        self.rows = rows;
        Ok(())
    }
}

impl Rows {
    /// The rows of some frames, by agent, then by frame; column by column, which is faster than row by row.
    fn fill(&mut self, frames: &[Copied], is_person: impl Fn(usize) -> bool) {
        self.clear();
        let agents = frames.iter().map(|frame| frame.positions.len()).max().unwrap_or(0);
        for (number, agent) in (0..).zip(0..agents) {
            let there = (0..).zip(frames).filter(|(_, frame)| frame.has(agent));
            self.of.extend(there.map(|(of, _)| (number, of)));
        }
        let rows = || self.of.iter().map(|&(agent, of)| (agent as usize, &frames[of as usize]));
        let whole = |number: usize| i32::try_from(number).unwrap_or(i32::MAX); // frames are checked
        self.frame.extend(rows().map(|(_, frame)| whole(frame.number as usize)));
        self.id.extend(rows().map(|(agent, _)| whole(agent + 1)));
        self.x.extend(rows().map(|(agent, frame)| frame.positions[agent].x));
        self.y.extend(rows().map(|(agent, frame)| 0.0 - frame.positions[agent].y)); // no negative zeros
        self.heading.extend(rows().map(|(agent, frame)| round(frame.headings[agent])));
        self.is_person.extend(rows().map(|(agent, _)| is_person(agent)));
        let velocities = || rows().map(|(agent, frame)| frame.velocities.get(agent));
        self.has_velocity.extend(velocities().map(|velocity| i16::from(velocity.is_some())));
        self.velocity[0].extend(velocities().flatten().map(|velocity| round(velocity.x)));
        self.velocity[1].extend(velocities().flatten().map(|velocity| round(0.0 - velocity.y)));
        let emotions = || rows().map(|(agent, frame)| frame.emotions.get(agent).filter(|_| is_person(agent)));
        self.has_emotion.extend(emotions().map(|emotion| i16::from(emotion.is_some())));
        for (number, column) in self.emotion.iter_mut().enumerate() {
            column.extend(emotions().flatten().map(|emotion| round(emotion[number])));
        }
    }

    fn write(&self, table: &mut Table) -> Result<(), ParquetError> {
        let [vx, vy] = &self.velocity;
        let [happy, angry, sad, neutral] = &self.emotion;
        let (moves, feels) = (Some(self.has_velocity.as_slice()), Some(self.has_emotion.as_slice()));
        table.write(&[
            (Values::Whole(&self.frame), None),
            (Values::Whole(&self.id), None),
            (Values::Float(&self.x), None),
            (Values::Float(&self.y), None),
            (Values::Float(&self.heading), None),
            (Values::Float(vx), moves),
            (Values::Float(vy), moves),
            (Values::Flag(&self.is_person), None),
            (Values::Float(happy), feels),
            (Values::Float(angry), feels),
            (Values::Float(sad), feels),
            (Values::Float(neutral), feels),
        ])
    }

    /// Empties the columns and keeps their memory.
    fn clear(&mut self) {
        self.of.clear();
        self.frame.clear();
        self.id.clear();
        for column in [&mut self.x, &mut self.y, &mut self.heading] {
            column.clear();
        }
        self.velocity.iter_mut().chain(&mut self.emotion).for_each(Vec::clear);
        self.has_velocity.clear();
        self.has_emotion.clear();
        self.is_person.clear();
    }
}

/// The nearest multiple of 1 / [`STEPS`]; halves go to the even one.
fn round(value: f32) -> f32 {
    // A sum of this size has no fraction, so adding rounds, in an instruction. The function of the library is a call.
    const WHOLE: f32 = 12_582_912.0; // 1.5 * 2^23
    let steps = value * STEPS;
    let whole = if steps.abs() < 0.25 * WHOLE { steps + WHOLE - WHOLE } else { steps.round_ties_even() };
    whole / STEPS
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_rounded_to_the_nearest_of_a_thousand_and_twenty_four_parts() {
        for part in 0..40_000 {
            let value = (part as f32 - 20_000.0) * 0.000_123_4 * (1.0 + part as f32);
            assert_eq!(
                round(value).to_bits(),
                ((value * STEPS).round_ties_even() / STEPS).to_bits(),
                "{value}"
            );
        }
        let halves = [0.5_f32, 1.5, -0.5, 2.5].map(|half| round(half / STEPS) * STEPS);
        assert_eq!(halves.map(f32::abs).map(f32::to_bits), [0.0_f32, 2.0, 0.0, 2.0].map(f32::to_bits));
    }
}
