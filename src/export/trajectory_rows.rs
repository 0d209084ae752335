//! Rows of a Parquet file of trajectories: frames, which hold a list for each fact, become pages of columns by agent, then by frame.

use super::columns::{EMOTIONS, FRAME, HEADING, ID, IS_PERSON, VX, VY, X, Y};
use super::parquet_chunk::Chunk;
use super::parquet_table::{ColumnOf, Kind, PAGE, Table, Values};
use super::rounded::Rounded;
use super::trajectory_block::{Block, Copied};
use parquet::errors::ParquetError;

/// Rows of a row group from which on it is written fast: only large crowds fill so many in eight frames.
const FAST: usize = 1 << 19;
/// Rows of a page of such a group: what it needs stays in the cache.
const FAST_PAGE: usize = 1 << 15;
/// Rows that are made at once, about: what they need stays in the cache.
const BLOCK: usize = 4096;

const fn column(name: &'static str, kind: Kind, is_optional: bool) -> ColumnOf {
    ColumnOf { name, kind, is_optional }
}

pub(super) const COLUMNS: [ColumnOf; 12] = [
    column(FRAME, Kind::Whole, false),
    column(ID, Kind::Whole, false),
    column(X, Kind::Exact, false),
    column(Y, Kind::Exact, false),
    column(HEADING, Kind::Step, false),
    column(VX, Kind::Step, true),
    column(VY, Kind::Step, true),
    column(IS_PERSON, Kind::Flag, false),
    column(EMOTIONS[0], Kind::Step, true),
    column(EMOTIONS[1], Kind::Step, true),
    column(EMOTIONS[2], Kind::Step, true),
    column(EMOTIONS[3], Kind::Step, true),
];

/// Rows of the next page, and the columns of the row group so far.
#[derive(Debug)]
pub(super) struct Rows {
    frame: Vec<i32>,
    id: Vec<i32>,
    x: Vec<f32>,
    y: Vec<f32>,
    heading: Rounded,
    velocity: [Rounded; 2],
    has_velocity: Vec<bool>,
    is_person: Vec<bool>,
    emotion: [Rounded; 4],
    has_emotion: Vec<bool>,
    chunks: Vec<Chunk>,
}

impl Rows {
    pub(super) fn new() -> Result<Self, ParquetError> {
        Ok(Self {
            frame: Vec::new(),
            id: Vec::new(),
            x: Vec::new(),
            y: Vec::new(),
            heading: Rounded::default(),
            velocity: Default::default(),
            has_velocity: Vec::new(),
            is_person: Vec::new(),
            emotion: Default::default(),
            has_emotion: Vec::new(),
            chunks: COLUMNS.iter().map(|column| Chunk::new(column.kind)).collect::<Result<_, _>>()?,
        })
    }

    /// Writes a row group of some frames, by agent, then by frame: agents that are there. `count` is how many rows these are.
    pub(super) fn write(
        &mut self,
        table: &mut Table,
        frames: &mut [Copied],
        count: usize,
        is_person: impl Fn(usize) -> bool,
    ) -> Result<(), ParquetError> {
        let is_near = alike(frames, |frame| &mut frame.headings);
        self.heading.begin(is_near);
        let is_near = alike(frames, |frame| &mut frame.velocities);
        self.velocity.iter_mut().for_each(|column| column.begin(is_near));
        let is_near = alike(frames, |frame| &mut frame.emotions);
        self.emotion.iter_mut().for_each(|column| column.begin(is_near));
        let frames = &*frames;
        let is_fast = count >= FAST;
        self.chunks.iter_mut().try_for_each(|chunk| chunk.begin(is_fast))?;
        let page = if is_fast { FAST_PAGE } else { PAGE };
        let agents = frames.iter().map(|frame| frame.positions.len()).max().unwrap_or(0);
        let at_once = (BLOCK / frames.len().max(1)).max(1);
        for first in (0..agents).step_by(at_once) {
            let block = Block { frames, agents: first..agents.min(first + at_once) };
            let people: Vec<bool> = block.agents.clone().map(&is_person).collect();
            self.append(&block, &people);
            if self.id.len() >= page {
                self.page()?;
            }
        }
        if !self.id.is_empty() {
            self.page()?;
        }
        table.append(&mut self.chunks)
    }

    fn append(&mut self, block: &Block<'_>, people: &[bool]) {
        let there = block.there();
        let moves = there.and(&block.mask(Copied::moving, |_, _| true));
        let feels = there.and(&block.mask(Copied::feeling, |agent, _| people[agent]));
        let whole = |number: usize| i32::try_from(number).unwrap_or(i32::MAX); // frames are checked
        let numbers: Vec<i32> = block.frames.iter().map(|frame| whole(frame.number as usize)).collect();
        block.by_frame(&mut self.frame, &there, &numbers);
        let first = block.agents.start + 1;
        block.by_agent(&mut self.id, &there, |agent| whole(first + agent));
        block.by_agent(&mut self.is_person, &there, |agent| people[agent]);
        block.each(&mut self.x, &there, |frame| &frame.positions, |place| place.x);
        block.each(&mut self.y, &there, |frame| &frame.positions, |place| 0.0 - place.y); // no negative zeros
        block.rounded::<1>(&mut self.heading, &there, |frame| &frame.headings, 0, false);
        let [vx, vy] = &mut self.velocity;
        block.rounded::<2>(vx, &moves, |frame| &frame.velocities, 0, false);
        block.rounded::<2>(vy, &moves, |frame| &frame.velocities, 1, true);
        for (number, column) in self.emotion.iter_mut().enumerate() {
            block.rounded::<4>(column, &feels, |frame| &frame.emotions, number, false);
        }
        there.levels(&mut self.has_velocity, &moves);
        there.levels(&mut self.has_emotion, &feels);
    }

    /// Ends a page of every column.
    fn page(&mut self) -> Result<(), ParquetError> {
        let [vx, vy] = &self.velocity;
        let [happy, angry, sad, neutral] = &self.emotion;
        let (moves, feels) = (Some(self.has_velocity.as_slice()), Some(self.has_emotion.as_slice()));
        let columns = [
            (Values::Whole(&self.frame), None),
            (Values::Whole(&self.id), None),
            (Values::Float(&self.x), None),
            (Values::Float(&self.y), None),
            (Values::Rounded(&self.heading), None),
            (Values::Rounded(vx), moves),
            (Values::Rounded(vy), moves),
            (Values::Flag(&self.is_person), None),
            (Values::Rounded(happy), feels),
            (Values::Rounded(angry), feels),
            (Values::Rounded(sad), feels),
            (Values::Rounded(neutral), feels),
        ];
        for (chunk, (values, has_value)) in self.chunks.iter_mut().zip(columns) {
            chunk.page(&values, has_value)?;
        }
        self.clear();
        Ok(())
    }

    /// Empties the columns and keeps their memory.
    fn clear(&mut self) {
        self.frame.clear();
        self.id.clear();
        self.x.clear();
        self.y.clear();
        let rounded = [&mut self.heading].into_iter().chain(&mut self.velocity).chain(&mut self.emotion);
        rounded.for_each(Rounded::clear);
        self.has_velocity.clear();
        self.has_emotion.clear();
        self.is_person.clear();
    }
}

/// Whether some numbers are near zero in all frames; where not, they are kept as such in all.
fn alike(frames: &mut [Copied], of: impl Fn(&mut Copied) -> &mut Rounded) -> bool {
    let is_near = frames.iter_mut().all(|frame| of(frame).is_near());
    if !is_near {
        frames.iter_mut().for_each(|frame| of(frame).make_far());
    }
    is_near
}

#[cfg(test)]
mod tests {
    use super::super::parquet_table::refused;
    use super::super::rounded::STEPS;
    use super::*;
    use crate::ground::{ABSENT, is_absent};
    use glam::Vec2;
    use parquet::file::reader::{FileReader, SerializedFileReader};
    use parquet::record::Field;
    use std::path::Path;

    fn rounded(value: f32) -> f32 {
        (value * STEPS).round_ties_even() / STEPS + 0.0
    }

    /// A frame before it is copied.
    struct Given {
        number: u32,
        positions: Vec<Vec2>,
        headings: Vec<f32>,
        velocities: Vec<Vec2>,
        emotions: Vec<[f32; 4]>,
    }

    impl Given {
        fn copied(&self) -> Copied {
            let of = |values: &[f32]| {
                let mut rounded = Rounded::default();
                rounded.take(values);
                rounded
            };
            Copied {
                number: self.number,
                positions: self.positions.clone(),
                present: self.positions.iter().filter(|place| !is_absent(place.to_array())).count(),
                headings: of(&self.headings),
                velocities: of(bytemuck::cast_slice(&self.velocities)),
                emotions: of(self.emotions.as_flattened()),
            }
        }
    }

    /// Frames of agents that come and go, if they may, stand, walk, or fly, with and without velocities and feelings.
    fn frames(agents: u16, count: u32, apart: u32, may_go: bool) -> Vec<Given> {
        let frame = |number: u32| {
            let time = number as f32 * 0.1;
            let is_there =
                |agent: u16| !may_go || agent % 7 != 3 || (u32::from(agent) % 50..60).contains(&number);
            let speed = |agent: u16| match agent % 5 {
                0 => 0.0,
                1 if may_go && agent % 11 == 1 => 31.9 + f32::from(agent % 9), // beyond the words of the dictionary
                own => 0.3 * f32::from(own) + 0.01 * (time * f32::from(agent)).sin(),
            };
            let place = |agent: u16| match is_there(agent) {
                true => Vec2::new(f32::from(agent) * 0.37 + speed(agent) * time, -0.11 * time - 3.0),
                false => Vec2::splat(ABSENT),
            };
            let all = || 0..agents;
            let (moves, feels) = (number % 40 != 17, number >= count / 3);
            Given {
                number: number * apart,
                positions: all().map(place).collect(),
                headings: all().map(|agent| f32::from(agent).sin() * 3.1).collect(),
                velocities: all()
                    .filter(|_| moves)
                    .map(|agent| Vec2::new(speed(agent), -0.5 * speed(agent)))
                    .collect(),
                emotions: all()
                    .filter(|_| feels)
                    .map(|agent| [0.5, 0.25, time.fract(), f32::from(agent % 3)])
                    .collect(),
            }
        };
        (0..count).map(frame).collect()
    }

    /// Row after row: whole numbers and bits of numbers; none where a value is missing.
    type Cells = Vec<Option<u32>>;

    fn read(path: &Path) -> Vec<Cells> {
        let file = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
        assert!(file.num_row_groups() > 1);
        let cell = |field: &Field| match field {
            Field::Null => None,
            Field::Bool(value) => Some(u32::from(*value)),
            Field::Int(value) => Some(value.cast_unsigned()),
            Field::Float(value) => Some(value.to_bits()),
            other => panic!("{other}"),
        };
        let rows = file.get_row_iter(None).unwrap().map(Result::unwrap);
        rows.map(|row| row.get_column_iter().map(|(_, field)| cell(field)).collect()).collect()
    }

    #[test]
    fn what_the_library_reads_is_every_row_by_agent_then_by_frame() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.parquet");
        let is_person = |agent: usize| !agent.is_multiple_of(13);
        // numbers of frames whose differences take few bits, 16, and more
        let groups = [
            (frames(1500, 100, 1, true), FAST),
            (frames(40, 90, 1, true), 0),
            (frames(700, 9, 20_000, true), FAST),
            (frames(50, 9, 7_000, true), 0),
            // as many frames as a large crowd's groups have
            (frames(3000, 8, 1, true), FAST),
            (frames(9000, 4, 3, false), FAST),
            (frames(2000, 1, 1, false), FAST),
        ];
        let mut table = Table::create(&path, &COLUMNS).unwrap();
        let mut rows = Rows::new().unwrap();
        let mut expected: Vec<Cells> = Vec::new();
        for (group, count) in &groups {
            let mut copied: Vec<Copied> = group.iter().map(Given::copied).collect();
            rows.write(&mut table, &mut copied, *count, is_person).unwrap();
            for agent in 0..group[0].positions.len() {
                for frame in group.iter().filter(|frame| !is_absent(frame.positions[agent].to_array())) {
                    let bits = |value: f32| Some(value.to_bits());
                    let velocity = frame.velocities.get(agent);
                    let emotion = frame.emotions.get(agent).filter(|_| is_person(agent));
                    let place = frame.positions[agent];
                    let mut cells = vec![
                        Some(frame.number),
                        u32::try_from(agent + 1).ok(),
                        bits(place.x),
                        bits(-place.y),
                        bits(rounded(frame.headings[agent])),
                        velocity.and_then(|velocity| bits(rounded(velocity.x))),
                        velocity.and_then(|velocity| bits(rounded(0.0 - velocity.y))),
                        Some(u32::from(is_person(agent))),
                    ];
                    cells.extend((0..4).map(|of| emotion.and_then(|emotion| bits(rounded(emotion[of])))));
                    expected.push(cells);
                }
            }
        }
        table.complete().map_err(refused(&path)).unwrap().finish().unwrap();
        let found = read(&path);
        assert_eq!(found.len(), expected.len());
        for (found, expected) in found.iter().zip(&expected) {
            assert_eq!(found, expected);
        }
    }
}
