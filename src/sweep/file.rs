//! A sweep file: which scenario, which values, which seeds, what is written.

use super::Error;
use crate::file;
use crate::keys::{BadValue, explain, place_of};
use serde::Deserialize;
use std::path::Path;
use toml::{Table, Value};

/// Largest sweep file read, bytes.
const MAX_FILE_BYTES: u64 = 64 << 20;
/// Most runs of a sweep.
pub(super) const MAX_RUNS: usize = 10_000_000;

/// What a sweep file says.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SweepFile {
    /// A built-in scene, or a scenario file beside the sweep file.
    pub scenario: String,
    /// Simulated time, s; with `until_empty` the most of it.
    #[serde(default = "seconds")]
    pub seconds: f64,
    /// Whether a run ends once all people have left by an exit.
    #[serde(default)]
    pub until_empty: bool,
    /// Frames a second of trajectories and of the table of agents.
    #[serde(default = "fps")]
    pub fps: f64,
    /// Whether runs write `trajectories.parquet`.
    #[serde(default)]
    pub trajectories: bool,
    /// Whether runs write `agents.parquet`.
    #[serde(default = "yes")]
    pub agents: bool,
    /// Seeds of every combination; left out: the scenario's.
    #[serde(default)]
    pub seeds: Option<Seeds>,
    /// Keys of the scenario with a value for all runs.
    #[serde(default)]
    pub set: Table,
    /// Keys with lists of values, in all combinations.
    #[serde(default)]
    pub vary: Table,
    /// Keys with lists of equal length: the first values of all go together, then the second ones.
    #[serde(default)]
    pub zip: Vec<Table>,
    /// Runs one by one: keys with a value each. Combined with `vary` and `zip`.
    #[serde(default)]
    pub rows: Vec<Table>,
}

const fn seconds() -> f64 {
    10.0
}

const fn fps() -> f64 {
    10.0
}

const fn yes() -> bool {
    true
}

/// Seeds of a sweep.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(untagged)]
pub enum Seeds {
    /// From 1 to this number.
    Count(u32),
    /// These.
    List(Vec<u64>),
}

/// A sweep with the text that it came from.
#[derive(Debug, Clone)]
pub(super) struct Sweep {
    pub(super) file: SweepFile,
    text: String,
    pub(super) origin: String,
}

/// A key and its values.
pub(super) type Values = (String, Vec<Value>);

/// A list of alternatives, each of which sets these keys.
#[derive(Debug, Default)]
pub(super) struct Axis {
    pub(super) keys: Vec<String>,
    /// For every alternative a value for each key; none leaves the key as it is.
    pub(super) values: Vec<Vec<Option<Value>>>,
}

impl Sweep {
    pub(super) fn load(path: &Path) -> Result<Self, Error> {
        let text = file::read_text(path, MAX_FILE_BYTES)
            .map_err(|source| Error::Read { path: path.to_owned(), source })?;
        Self::parse(text, path.display().to_string())
    }

    pub(super) fn parse(text: String, origin: String) -> Result<Self, Error> {
        let file = toml::from_str(&text).map_err(|error| {
            let found = explain(&error, &text);
            Error::Syntax { place: format!("{origin}:{}", found.line), message: found.message }
        })?;
        let sweep = Self { file, text, origin };
        sweep.check()?;
        Ok(sweep)
    }

    /// An error about the value of a key.
    pub(super) fn wrong(&self, key: &str, value: impl std::fmt::Display, allowed: &str, hint: &str) -> Error {
        let place = place_of(&self.text, &self.origin, key);
        Error::Value(BadValue { place, ..BadValue::new(key, value, allowed, hint) })
    }

    fn check(&self) -> Result<(), Error> {
        let SweepFile { seconds, fps, seeds, .. } = &self.file;
        if !(0.0..=86_400.0).contains(seconds) {
            return Err(self.wrong("seconds", seconds, "0 to 86400", "a day is the most"));
        }
        if !(0.001..=1000.0).contains(fps) {
            return Err(self.wrong("fps", fps, "0.001 to 1000", "10 is usual"));
        }
        if self.count_of_seeds() == Some(0) {
            let value = if matches!(seeds, Some(Seeds::Count(_))) { "0" } else { "[]" };
            return Err(self.wrong(
                "seeds",
                value,
                "a number from 1 up or a list of seeds",
                "leave it out for one",
            ));
        }
        Ok(())
    }

    fn count_of_seeds(&self) -> Option<usize> {
        match self.file.seeds.as_ref()? {
            Seeds::Count(count) => Some(*count as usize),
            Seeds::List(list) => Some(list.len()),
        }
    }

    /// Keys with a value for all runs.
    pub(super) fn fixed(&self) -> Result<Vec<(String, Value)>, Error> {
        let fixed = leaves(&self.file.set);
        self.free_of_seeds("set", fixed.iter().map(|(key, _)| key))?;
        Ok(fixed)
    }

    /// What is combined: rows, lists that go together, lists of their own.
    pub(super) fn axes(&self) -> Result<Vec<Axis>, Error> {
        let mut axes = Vec::new();
        if !self.file.rows.is_empty() {
            axes.push(rows(&self.file.rows));
        }
        for (number, table) in self.file.zip.iter().enumerate() {
            axes.push(self.zipped(number, table)?);
        }
        for (key, value) in leaves(&self.file.vary) {
            let values = self.list("vary", &key, value)?;
            axes.push(Axis {
                keys: vec![key],
                values: values.into_iter().map(|value| vec![Some(value)]).collect(),
            });
        }
        let mut keys: Vec<&String> = axes.iter().flat_map(|axis| &axis.keys).collect();
        self.free_of_seeds("vary", keys.iter().copied())?;
        keys.sort_unstable();
        if let Some(twice) = keys.windows(2).find(|two| two[0] == two[1]) {
            return Err(self.wrong(
                "vary",
                format!("{:?}", twice[0]),
                "a key once",
                "leave it out of one of the lists",
            ));
        }
        Ok(axes)
    }

    /// Lists of equal length.
    fn zipped(&self, number: usize, table: &Table) -> Result<Axis, Error> {
        let place = format!("zip[{number}]");
        let lists: Vec<Values> = leaves(table)
            .into_iter()
            .map(|(key, value)| self.list(&place, &key, value).map(|values| (key, values)))
            .collect::<Result<_, _>>()?;
        let length = lists.first().map_or(0, |(_, values)| values.len());
        if let Some((key, values)) = lists.iter().find(|(_, values)| values.len() != length) {
            let value = format!("{} values for {key:?}", values.len());
            let allowed = format!("{length} values, as the first has");
            return Err(self.wrong(&place, value, &allowed, "lists in one [[zip]] are of equal length"));
        }
        let row = |at: usize| lists.iter().map(|(_, values)| values.get(at).cloned()).collect();
        Ok(Axis {
            values: (0..length).map(row).collect(),
            keys: lists.iter().map(|(key, _)| key.clone()).collect(),
        })
    }

    /// The values of a key that has a list of them.
    fn list(&self, table: &str, key: &str, value: Value) -> Result<Vec<Value>, Error> {
        match value {
            Value::Array(values) if !values.is_empty() => Ok(values),
            other => {
                let shown = format!("{key:?} = {other}");
                Err(self.wrong(
                    table,
                    shown,
                    "keys with lists of one value or more",
                    "a value for all runs stands in [set]",
                ))
            }
        }
    }

    fn free_of_seeds<'a>(
        &self,
        table: &str,
        mut keys: impl Iterator<Item = &'a String>,
    ) -> Result<(), Error> {
        match keys.find(|key| *key == "seed") {
            Some(_) => Err(self.wrong(
                table,
                "\"seed\"",
                "without the seed",
                "seeds = 6 or seeds = [1, 2, 3] vary it",
            )),
            None => Ok(()),
        }
    }
}

/// Keys with dots, and their values; `a.b = 1` and `"a.b" = 1` are the same.
fn leaves(table: &Table) -> Vec<(String, Value)> {
    let mut found = Vec::new();
    for (key, value) in table {
        match value {
            Value::Table(inner) => {
                found.extend(leaves(inner).into_iter().map(|(rest, value)| (format!("{key}.{rest}"), value)));
            }
            other => found.push((key.clone(), other.clone())),
        }
    }
    found
}

/// Rows as alternatives; a key that a row leaves out keeps its value.
fn rows(tables: &[Table]) -> Axis {
    let rows: Vec<Vec<(String, Value)>> = tables.iter().map(leaves).collect();
    let mut keys: Vec<String> = rows.iter().flatten().map(|(key, _)| key.clone()).collect();
    keys.sort_unstable();
    keys.dedup();
    let value = |row: &[(String, Value)], key: &String| {
        row.iter().find(|(one, _)| one == key).map(|(_, value)| value.clone())
    };
    let values = rows.iter().map(|row| keys.iter().map(|key| value(row, key)).collect()).collect();
    Axis { keys, values }
}
