//! The table of agents beside trajectories in Parquet: the columns of the databases' table `agents`.

use super::Error;
use super::agents::{AgentInfo, Presence, strongest_emotion};
use super::columns::EMOTIONS;
use super::parquet_table::{ColumnOf, Kind, Table, Values, refused};
use crate::file::Partial;
use parquet::data_type::ByteArray;
use std::path::Path;

const fn column(name: &'static str, kind: Kind, is_optional: bool) -> ColumnOf {
    ColumnOf { name, kind, is_optional }
}

const COLUMNS: [ColumnOf; 19] = [
    column("id", Kind::Whole, false),
    column("kind", Kind::Word, false),
    column("led", Kind::Flag, false),
    column("emotion", Kind::Word, true),
    column(EMOTIONS[0], Kind::Float, true),
    column(EMOTIONS[1], Kind::Float, true),
    column(EMOTIONS[2], Kind::Float, true),
    column(EMOTIONS[3], Kind::Float, true),
    column("gait", Kind::Word, true),
    column("avatar", Kind::Word, true),
    column("class", Kind::Word, true),
    column("group_id", Kind::Whole, true),
    column("radius", Kind::Float, true),
    column("preferred_speed", Kind::Float, true),
    column("age", Kind::Float, true),
    column("stature", Kind::Float, true),
    column("weight", Kind::Float, true),
    column("entered", Kind::Double, true),
    column("left", Kind::Double, true),
];

/// Values that may be missing, as Parquet has them.
#[derive(Debug)]
struct Sparse<T> {
    values: Vec<T>,
    levels: Vec<i16>,
}

impl<T> FromIterator<Option<T>> for Sparse<T> {
    fn from_iter<I: IntoIterator<Item = Option<T>>>(all: I) -> Self {
        let mut sparse = Self { values: Vec::new(), levels: Vec::new() };
        for value in all {
            sparse.levels.push(i16::from(value.is_some()));
            sparse.values.extend(value);
        }
        sparse
    }
}

/// Writes the table, a row for everyone; the file has no name yet.
pub(super) fn write<'a>(
    path: &Path,
    agents: impl Iterator<Item = (Option<&'a AgentInfo>, Option<Presence>)>,
    frames: u32,
    frame_rate: f64,
) -> Result<Partial, Error> {
    let plain = AgentInfo::default();
    let rows: Vec<_> = agents.collect();
    let known = || rows.iter().map(|(agent, _)| agent.unwrap_or(&plain));
    let text = |text: &str| ByteArray::from(text.as_bytes().to_vec());
    let words = |get: fn(&AgentInfo) -> Option<&str>| -> Sparse<ByteArray> {
        known().map(|agent| get(agent).map(text)).collect()
    };
    let times = || rows.iter().map(|(_, presence)| presence.map(|one| one.times(frames, frame_rate)));
    let whole = |number: u32| i32::try_from(number).unwrap_or(i32::MAX); // ids are checked by frames

    let ids: Vec<i32> = (1..).take(rows.len()).collect();
    let kinds: Vec<ByteArray> = known().map(|agent| text(agent.kind.name())).collect();
    let led: Vec<bool> = known().map(|agent| agent.led).collect();
    let emotion = words(|agent| agent.emotion.map(|weights| strongest_emotion(weights).name()));
    let weights: [Sparse<f32>; 4] =
        std::array::from_fn(|of| known().map(|agent| agent.emotion.map(|weights| weights[of])).collect());
    let gait = words(|agent| agent.gait.as_deref());
    let avatar = words(|agent| agent.avatar.as_deref());
    let class = words(|agent| agent.class.as_deref());
    let group: Sparse<i32> = known().map(|agent| agent.group.map(|first| whole(first + 1))).collect();
    let numbers = |get: fn(&AgentInfo) -> Option<f32>| -> Sparse<f32> { known().map(get).collect() };
    let radius = numbers(|agent| agent.radius);
    let speed = numbers(|agent| agent.preferred_speed);
    let age = numbers(|agent| agent.age);
    let stature = numbers(|agent| agent.stature);
    let weight = numbers(|agent| agent.weight);
    let entered: Sparse<f64> = times().map(|times| times.map(|(entered, _)| entered)).collect();
    let left: Sparse<f64> = times().map(|times| times.and_then(|(_, left)| left)).collect();

    let mut table = Table::create(path, &COLUMNS)?;
    let [happy, angry, sad, neutral] = &weights;
    let filled = table.write(&[
        (Values::Whole(&ids), None),
        (Values::Word(&kinds), None),
        (Values::Flag(&led), None),
        (Values::Word(&emotion.values), Some(&emotion.levels)),
        (Values::Float(&happy.values), Some(&happy.levels)),
        (Values::Float(&angry.values), Some(&angry.levels)),
        (Values::Float(&sad.values), Some(&sad.levels)),
        (Values::Float(&neutral.values), Some(&neutral.levels)),
        (Values::Word(&gait.values), Some(&gait.levels)),
        (Values::Word(&avatar.values), Some(&avatar.levels)),
        (Values::Word(&class.values), Some(&class.levels)),
        (Values::Whole(&group.values), Some(&group.levels)),
        (Values::Float(&radius.values), Some(&radius.levels)),
        (Values::Float(&speed.values), Some(&speed.levels)),
        (Values::Float(&age.values), Some(&age.levels)),
        (Values::Float(&stature.values), Some(&stature.levels)),
        (Values::Float(&weight.values), Some(&weight.levels)),
        (Values::Double(&entered.values), Some(&entered.levels)),
        (Values::Double(&left.values), Some(&left.levels)),
    ]);
    filled.and_then(|()| table.complete()).map_err(refused(path))
}
