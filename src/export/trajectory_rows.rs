//! Rows of a Parquet file of trajectories: frames, which hold a list for each fact, become columns by agent, then by frame.

use super::columns::{EMOTIONS, FRAME, HEADING, ID, IS_PERSON, VX, VY, X, Y};
use super::parquet_table::{ColumnOf, Kind, Table, Values};
use crate::ground::is_absent;
use glam::Vec2;
use parquet::errors::ParquetError;
use std::ops::Range;

/// Agents whose rows are made at once: what they need stays in the cache.
const BLOCK: usize = 1024;
/// Headings, velocities and weights of emotions are multiples of its inverse.
const STEPS: f32 = 1024.0;

const fn column(name: &'static str, kind: Kind, is_optional: bool) -> ColumnOf {
    ColumnOf { name, kind, is_optional }
}

pub(super) const COLUMNS: [ColumnOf; 12] = [
    column(FRAME, Kind::Whole, false),
    column(ID, Kind::Whole, false),
    column(X, Kind::Exact, false),
    column(Y, Kind::Exact, false),
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
pub(super) struct Copied {
    pub(super) number: u32,
    pub(super) positions: Vec<Vec2>,
    pub(super) headings: Vec<f32>,
    pub(super) velocities: Vec<Vec2>,
    pub(super) emotions: Vec<[f32; 4]>,
}

/// Rows that are collected for the next row group.
#[derive(Debug, Default)]
pub(super) struct Rows {
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

impl Rows {
    /// The rows of some frames, by agent, then by frame: those of agents that are there.
    pub(super) fn fill(&mut self, frames: &[Copied], is_person: impl Fn(usize) -> bool) {
        self.clear();
        let agents = frames.iter().map(|frame| frame.positions.len()).max().unwrap_or(0);
        for first in (0..agents).step_by(BLOCK) {
            let block = Block { frames, agents: first..agents.min(first + BLOCK) };
            let people: Vec<bool> = block.agents.clone().map(&is_person).collect();
            self.append(&block, &people);
        }
    }

    fn append(&mut self, block: &Block<'_>, people: &[bool]) {
        let there = block.mask(|frame| &frame.positions, |_, place| !is_absent(place.to_array()));
        let moves = there.and(&block.mask(|frame| &frame.velocities, |_, _| true));
        let feels = there.and(&block.mask(|frame| &frame.emotions, |agent, _| people[agent]));
        let whole = |number: usize| i32::try_from(number).unwrap_or(i32::MAX); // frames are checked
        let numbers: Vec<i32> = block.frames.iter().map(|frame| whole(frame.number as usize)).collect();
        block.put(&mut self.frame, &there, |_, rows: &mut [i32]| rows.copy_from_slice(&numbers));
        let first = block.agents.start + 1;
        block.put(&mut self.id, &there, |agent, rows| rows.fill(whole(first + agent)));
        block.put(&mut self.is_person, &there, |agent, rows| rows.fill(people[agent]));
        block.each(&mut self.x, &there, |frame| &frame.positions, |place| place.x);
        block.each(&mut self.y, &there, |frame| &frame.positions, |place| 0.0 - place.y); // no negative zeros
        block.each(&mut self.heading, &there, |frame| &frame.headings, |heading| round(*heading));
        let [vx, vy] = &mut self.velocity;
        block.each(vx, &moves, |frame| &frame.velocities, |velocity| round(velocity.x));
        block.each(vy, &moves, |frame| &frame.velocities, |velocity| round(0.0 - velocity.y));
        for (number, column) in self.emotion.iter_mut().enumerate() {
            block.each(column, &feels, |frame| &frame.emotions, |emotion| round(emotion[number]));
        }
        there.levels(&mut self.has_velocity, &moves);
        there.levels(&mut self.has_emotion, &feels);
    }

    pub(super) fn write(&self, table: &mut Table) -> Result<(), ParquetError> {
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

/// Agents of all frames of a row group. A row is one of them in one of the frames, by agent, then by frame.
struct Block<'a> {
    frames: &'a [Copied],
    agents: Range<usize>,
}

/// Which rows of a block have a value.
struct Mask {
    rows: Vec<bool>,
    are_all: bool,
    are_none: bool,
}

impl Mask {
    fn new(rows: Vec<bool>) -> Self {
        let set = rows.iter().filter(|row| **row).count();
        Self { are_all: set == rows.len(), are_none: set == 0, rows }
    }

    fn and(&self, other: &Self) -> Self {
        Self::new(self.rows.iter().zip(&other.rows).map(|(one, other)| *one && *other).collect())
    }

    /// Levels of an optional column for the rows of this mask: 1 where the column has a value.
    fn levels(&self, levels: &mut Vec<i16>, of: &Self) {
        let start = levels.len();
        levels.extend(of.rows.iter().map(|has_value| i16::from(*has_value)));
        self.keep(levels, start);
    }

    /// Takes out of a column, from a place on, what is not in the mask.
    fn keep<T: Copy>(&self, column: &mut Vec<T>, start: usize) {
        if self.are_all {
            return;
        }
        let mut end = start;
        for (from, _) in (start..).zip(&self.rows).filter(|(_, is_kept)| **is_kept) {
            column[end] = column[from];
            end += 1;
        }
        column.truncate(end);
    }
}

impl<'a> Block<'a> {
    /// What a list of a frame, of an entry for each agent or of none, has of this block.
    fn of<S>(&self, list: &'a [S]) -> &'a [S] {
        &list[self.agents.start.min(list.len())..self.agents.end.min(list.len())]
    }

    /// The rows that are in the frames' lists and pass a test, which is given the number in the block.
    fn mask<S: 'a>(&self, list: impl Fn(&'a Copied) -> &'a [S], test: impl Fn(usize, &S) -> bool) -> Mask {
        let mut rows = vec![false; self.agents.len() * self.frames.len()];
        for (number, frame) in self.frames.iter().enumerate() {
            let own = self.of(list(frame)).iter().enumerate();
            for (rows, (agent, one)) in rows.chunks_exact_mut(self.frames.len()).zip(own) {
                rows[number] = test(agent, one);
            }
        }
        Mask::new(rows)
    }

    /// Appends the rows of a mask to a column; `set` sets those of an agent, by its number in the block.
    fn put<T: Copy + Default>(&self, column: &mut Vec<T>, mask: &Mask, set: impl Fn(usize, &mut [T])) {
        if mask.are_none {
            return;
        }
        let start = column.len();
        column.resize(start + mask.rows.len(), T::default());
        for (agent, rows) in column[start..].chunks_exact_mut(self.frames.len()).enumerate() {
            set(agent, rows);
        }
        mask.keep(column, start);
    }

    /// Appends a value of each row of a mask, made from a list of its frame.
    fn each<S: 'a, T: Copy + Default>(
        &self,
        column: &mut Vec<T>,
        mask: &Mask,
        list: impl Fn(&'a Copied) -> &'a [S],
        value: impl Fn(&S) -> T,
    ) {
        if mask.are_none {
            return;
        }
        let start = column.len();
        column.resize(start + mask.rows.len(), T::default());
        for (number, frame) in self.frames.iter().enumerate() {
            let own = self.of(list(frame));
            for (rows, one) in column[start..].chunks_exact_mut(self.frames.len()).zip(own) {
                rows[number] = value(one);
            }
        }
        mask.keep(column, start);
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
