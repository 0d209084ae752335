//! Some agents of the frames of a row group: what each frame has of them, made columns by agent, then by frame.

use super::rounded::Rounded;
use crate::ground::is_absent;
use glam::Vec2;
use std::ops::Range;

/// A frame on its way to the thread, and its memory on the way back.
#[derive(Debug, Default)]
pub(super) struct Copied {
    pub(super) number: u32,
    pub(super) positions: Vec<Vec2>,
    /// How many of these are there.
    pub(super) present: usize,
    /// A number for each agent; of velocities two, of feelings four, or none.
    pub(super) headings: Rounded,
    pub(super) velocities: Rounded,
    pub(super) emotions: Rounded,
}

impl Copied {
    /// Places of agents whose velocities are known: all or none.
    pub(super) fn moving(&self) -> &[Vec2] {
        if self.velocities.is_empty() { &[] } else { &self.positions }
    }

    /// Places of agents whose feelings are known: all or none.
    pub(super) fn feeling(&self) -> &[Vec2] {
        if self.emotions.is_empty() { &[] } else { &self.positions }
    }
}

/// Agents of all frames of a row group. A row is one of them in one of the frames, by agent, then by frame.
pub(super) struct Block<'a> {
    pub(super) frames: &'a [Copied],
    pub(super) agents: Range<usize>,
}

/// Which rows of a block have a value.
#[derive(Clone)]
pub(super) enum Mask {
    All(usize),
    None(usize),
    Some(Vec<bool>),
}

impl Mask {
    fn new(rows: Vec<bool>) -> Self {
        match rows.iter().filter(|row| **row).count() {
            0 => Self::None(rows.len()),
            set if set == rows.len() => Self::All(set),
            _ => Self::Some(rows),
        }
    }

    /// Rows of the block.
    fn len(&self) -> usize {
        match self {
            Self::All(rows) | Self::None(rows) => *rows,
            Self::Some(rows) => rows.len(),
        }
    }

    pub(super) fn and(&self, other: &Self) -> Self {
        match (self, other) {
            (Self::All(_), other) | (other, Self::All(_)) => other.clone(),
            (Self::None(rows), _) | (_, Self::None(rows)) => Self::None(*rows),
            (Self::Some(own), Self::Some(others)) => {
                Self::new(own.iter().zip(others).map(|(one, other)| *one && *other).collect())
            }
        }
    }

    /// Which of the rows of this mask have a value of an optional column.
    pub(super) fn levels(&self, levels: &mut Vec<bool>, of: &Self) {
        let start = levels.len();
        match of {
            Self::All(rows) => levels.resize(start + rows, true),
            Self::None(rows) => levels.resize(start + rows, false),
            Self::Some(rows) => levels.extend_from_slice(rows),
        }
        self.keep(levels, start);
    }

    /// Takes out of a column, from a place on, what is not in the mask.
    fn keep<T: Copy>(&self, column: &mut Vec<T>, start: usize) {
        match self {
            Self::All(_) => {}
            Self::None(_) => column.truncate(start),
            Self::Some(rows) => {
                let mut end = start;
                for (from, _) in (start..).zip(rows).filter(|(_, is_kept)| **is_kept) {
                    column[end] = column[from];
                    end += 1;
                }
                column.truncate(end);
            }
        }
    }
}

impl<'a> Block<'a> {
    /// What a list of a frame, of an entry for each agent or of none, has of this block.
    fn of<S>(&self, list: &'a [S]) -> &'a [S] {
        &list[self.agents.start.min(list.len())..self.agents.end.min(list.len())]
    }

    fn rows(&self) -> usize {
        self.agents.len() * self.frames.len()
    }

    /// The rows of agents that are there.
    pub(super) fn there(&self) -> Mask {
        let is_whole =
            |frame: &Copied| frame.present == frame.positions.len() && frame.present >= self.agents.end;
        match self.frames.iter().all(is_whole) {
            true => Mask::All(self.rows()),
            false => self.mask(|frame| &frame.positions, |_, place| !is_absent(place.to_array())),
        }
    }

    /// The rows that are in the frames' lists and pass a test, which is given the number in the block.
    pub(super) fn mask<S: 'a>(
        &self,
        list: impl Fn(&'a Copied) -> &'a [S],
        test: impl Fn(usize, &S) -> bool,
    ) -> Mask {
        let lists = || self.frames.iter().map(|frame| self.of(list(frame)));
        let listed: usize = lists().map(<[S]>::len).sum();
        if listed == 0 {
            return Mask::None(self.rows());
        }
        // most often all are there: seen without making a list of it
        let passed = |own: &[S]| own.iter().enumerate().filter(|(agent, one)| test(*agent, one)).count();
        if listed == self.rows() && lists().map(passed).sum::<usize>() == listed {
            return Mask::All(listed);
        }
        let mut rows = vec![false; self.rows()];
        for (number, own) in lists().enumerate() {
            for (rows, (agent, one)) in rows.chunks_exact_mut(self.frames.len()).zip(own.iter().enumerate()) {
                rows[number] = test(agent, one);
            }
        }
        Mask::new(rows)
    }

    /// Appends the rows of a mask to a column: a value for each frame.
    pub(super) fn by_frame<T: Copy + Default>(&self, column: &mut Vec<T>, mask: &Mask, values: &[T]) {
        let Some(start) = grow(column, mask) else { return };
        let rows = &mut column[start..];
        let mut known = values.len().min(rows.len());
        rows[..known].copy_from_slice(&values[..known]);
        while known < rows.len() {
            let more = known.min(rows.len() - known);
            rows.copy_within(..more, known);
            known += more;
        }
        mask.keep(column, start);
    }

    /// Appends the rows of a mask to a column: a value for each agent, by its number in the block.
    pub(super) fn by_agent<T: Copy + Default>(
        &self,
        column: &mut Vec<T>,
        mask: &Mask,
        of: impl Fn(usize) -> T,
    ) {
        let Some(start) = grow(column, mask) else { return };
        match self.frames.len() {
            4 => spread::<4, T>(&mut column[start..], of),
            8 => spread::<8, T>(&mut column[start..], of),
            frames => {
                let agents = column[start..].chunks_exact_mut(frames).enumerate();
                agents.for_each(|(agent, rows)| rows.fill(of(agent)));
            }
        }
        mask.keep(column, start);
    }

    /// Appends a value of each row of a mask, read from a list of its frame.
    pub(super) fn each<S: 'a, T: Copy + Default>(
        &self,
        column: &mut Vec<T>,
        mask: &Mask,
        list: impl Fn(&'a Copied) -> &'a [S],
        of: impl Fn(&S) -> T,
    ) {
        let Some(start) = grow(column, mask) else { return };
        let lists: Vec<&[S]> = self.frames.iter().map(|frame| self.of(list(frame))).collect();
        interleave(&mut column[start..], &lists, of);
        mask.keep(column, start);
    }

    /// The same of rounded numbers, of which a list has `WIDTH` for an agent: one of these, or its opposite.
    pub(super) fn rounded<const WIDTH: usize>(
        &self,
        column: &mut Rounded,
        mask: &Mask,
        list: impl Fn(&'a Copied) -> &'a Rounded,
        number: usize,
        is_opposite: bool,
    ) {
        let sign = if is_opposite { -1 } else { 1 };
        match column {
            Rounded::Near(steps) => {
                self.each(steps, mask, |frame| list(frame).near::<WIDTH>(), |own| sign * own[number]);
            }
            Rounded::Far(values) => {
                let sign = f32::from(sign);
                self.each(values, mask, |frame| list(frame).far::<WIDTH>(), |own| sign * own[number] + 0.0);
            }
        }
    }
}

/// Sets rows of a known number of frames: a value for each agent.
fn spread<const FRAMES: usize, T: Copy>(rows: &mut [T], of: impl Fn(usize) -> T) {
    let agents = rows.as_chunks_mut::<FRAMES>().0.iter_mut().enumerate();
    agents.for_each(|(agent, rows)| *rows = [of(agent); FRAMES]);
}

/// Sets rows from lists of as many entries: those of an agent side by side.
fn interleave<S, T>(rows: &mut [T], lists: &[&[S]], of: impl Fn(&S) -> T) {
    // where the number is known, the compiler makes vectors of it
    if interleave_of::<4, S, T>(rows, lists, &of) || interleave_of::<8, S, T>(rows, lists, &of) {
        return;
    }
    for (number, own) in lists.iter().enumerate() {
        for (row, one) in rows[number..].iter_mut().step_by(lists.len()).zip(*own) {
            *row = of(one);
        }
    }
}

/// The same of a known number of lists of equal length. Whether there are such.
fn interleave_of<const LISTS: usize, S, T>(rows: &mut [T], lists: &[&[S]], of: impl Fn(&S) -> T) -> bool {
    let (rows, _) = rows.as_chunks_mut::<LISTS>();
    let Ok(lists) = <[&[S]; LISTS]>::try_from(lists) else { return false };
    if lists.iter().any(|list| list.len() != rows.len()) {
        return false;
    }
    for (agent, row) in rows.iter_mut().enumerate() {
        *row = std::array::from_fn(|frame| of(&lists[frame][agent]));
    }
    true
}

/// Makes room for the rows of a block, if any has a value, and tells where they begin.
fn grow<T: Copy + Default>(column: &mut Vec<T>, mask: &Mask) -> Option<usize> {
    let start = column.len();
    column.resize(start + if let Mask::None(_) = mask { 0 } else { mask.len() }, T::default());
    (!matches!(mask, Mask::None(_))).then_some(start)
}
