//! The table that `yardsticks.py` writes, and the comparison with it.

use serde_json::Value;
use std::sync::LazyLock;

static TABLES: LazyLock<Value> =
    LazyLock::new(|| serde_json::from_str(include_str!("yardsticks.json")).unwrap());

/// The rows of one part of the table.
pub(crate) fn rows(part: &str) -> &'static [Value] {
    TABLES[part].as_array().unwrap_or_else(|| panic!("no part {part}"))
}

pub(crate) fn real(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

pub(crate) fn whole(value: &Value) -> u64 {
    value.as_u64().unwrap()
}

pub(crate) fn reals(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(real).collect()
}

/// One-digit answers in rows of `columns`.
pub(crate) fn digits(columns: &Value, text: &Value) -> Vec<Vec<u8>> {
    let answers: Vec<u8> = text.as_str().unwrap().bytes().map(|digit| digit - b'0').collect();
    answers.chunks(whole(columns) as usize).map(<[u8]>::to_vec).collect()
}

/// The same as numbers.
pub(crate) fn answers(columns: &Value, text: &Value) -> Vec<Vec<f64>> {
    digits(columns, text).into_iter().map(|row| row.into_iter().map(f64::from).collect()).collect()
}

/// The largest differences found, each within 1e-9 of the yardstick (relative) or 1e-12 (absolute).
#[derive(Default)]
pub(crate) struct Comparison {
    count: usize,
    relative: f64,
    absolute: f64,
}

impl Comparison {
    /// Compares one number.
    pub(crate) fn see(&mut self, ours: f64, yardstick: f64, what: &dyn std::fmt::Debug) {
        let absolute = (ours - yardstick).abs();
        let relative = absolute / yardstick.abs();
        assert!(
            relative <= 1e-9 || absolute <= 1e-12 && yardstick.abs() < 1e-3,
            "{what:?}: {ours:e}, yardstick {yardstick:e}"
        );
        self.count += 1;
        self.absolute = self.absolute.max(absolute);
        // of what is 0 but for rounding, the relative difference means nothing
        if yardstick.abs() > 1e-12 || absolute > 1e-15 {
            self.relative = self.relative.max(relative);
        }
    }

    /// Prints the largest differences, and fails if fewer than `least` numbers were compared.
    pub(crate) fn tell(&self, what: &str, least: usize) {
        println!("| {what} | {} | {:.0e} | {:.0e} |", self.count, self.relative, self.absolute);
        assert!(self.count >= least, "{what}: only {} numbers", self.count);
    }
}
