//! What the program prints: results on standard output, remarks and errors on standard error, tables.
//!
//! Whether the result could be printed is checked once, at the end ([`said`]): a full disk or a closed pipe
//! (`gaitway ... | head -1`) is an error.

use crate::Error;
use serde::Serialize;
use std::io::Write as _;
use std::sync::atomic::{AtomicU8, Ordering};
use std::sync::{Mutex, PoisonError};

/// The first failure to print a line of the result.
static UNSAID: Mutex<Option<std::io::Error>> = Mutex::new(None);

/// Prints a line of the result.
pub(super) fn say(line: &str) {
    keep(writeln!(std::io::stdout().lock(), "{line}"));
}

/// Keeps the first failure of standard output.
fn keep(written: std::io::Result<()>) {
    if let Err(error) = written {
        UNSAID.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    }
}

/// Whether all of the result could be printed.
pub(super) fn said() -> Result<(), Error> {
    keep(std::io::stdout().lock().flush());
    match UNSAID.lock().unwrap_or_else(PoisonError::into_inner).take() {
        None => Ok(()),
        Some(error) => Err(super::failed(
            format!("cannot write to standard output: {error}"),
            "the result was not printed in full; files that were to be written are there",
        )),
    }
}

/// Prints help, the version, or what is wrong with the command line; the exit code.
pub(super) fn print(answer: &clap::Error) -> u8 {
    let printed = answer.print();
    if answer.use_stderr() {
        return super::WRONG_COMMAND_LINE;
    }
    keep(printed);
    match said() {
        Ok(()) => 0,
        Err(error) => {
            complain(&error, false);
            super::WENT_WRONG
        }
    }
}

/// How much is printed beside results and errors: `--quiet`, neither option, `--verbose`.
static MANNER: AtomicU8 = AtomicU8::new(NORMAL);
const QUIET: u8 = 0;
const NORMAL: u8 = 1;
const VERBOSE: u8 = 2;

/// Sets how much is printed from now on.
pub(super) fn set_manner(is_quiet: bool, is_verbose: bool) {
    let manner = if is_quiet { QUIET } else { NORMAL + u8::from(is_verbose) };
    MANNER.store(manner, Ordering::Relaxed);
}

/// Whether remarks and progress are wanted.
pub(super) fn is_talkative() -> bool {
    MANNER.load(Ordering::Relaxed) >= NORMAL
}

/// Prints a remark, unless `--quiet`.
pub(super) fn note(line: &str) {
    if is_talkative() {
        warn(line);
    }
}

/// Prints a detail, with `--verbose`.
pub(super) fn detail(line: &str) {
    if MANNER.load(Ordering::Relaxed) == VERBOSE {
        warn(line);
    }
}

/// Prints a line on standard error, whatever the manner.
pub(super) fn warn(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

/// Prints an error and the way out. Where the command has `--backend`, the hint for a missing device is `--backend cpu`.
#[cfg_attr(not(feature = "vulkan"), allow(unused_variables, reason = "only a Vulkan device can fail"))]
pub(super) fn complain(error: &Error, has_backend: bool) {
    let (message, hint) = match error {
        Error::Scenario(crate::scenario::Error::Value(bad)) => {
            let place = if bad.place.is_empty() { String::new() } else { format!("{}: ", bad.place) };
            let message = format!("{place}{} = {}: must be {}", bad.key, bad.value, bad.allowed);
            (message, Some(bad.hint.clone()))
        }
        Error::Scenario(crate::scenario::Error::Populate { name, message, hint }) => {
            (format!("scenario {name:?}: {message}"), Some(hint.clone()))
        }
        #[cfg(feature = "vulkan")]
        Error::Gpu(error) if has_backend => {
            let hint = error.hint().map(|hint| format!("{hint}; or "));
            (error.to_string(), Some(hint.unwrap_or_default() + "add --backend cpu"))
        }
        other => (other.to_string(), other.hint().map(str::to_owned)),
    };
    warn(&format!("error: {message}"));
    if let Some(hint) = hint {
        warn(&format!("hint: {hint}"));
    }
    if let Error::Avatar(crate::avatar::Error::Rig { map, .. }) = error {
        say(map.trim_end());
    }
}

/// Prints the one JSON object of `--json`.
pub(super) fn say_json(value: &impl Serialize) -> Result<(), Error> {
    let text = serde_json::to_string_pretty(value).map_err(|error| {
        super::failed(format!("the result has no JSON form: {error}"), "leave --json out")
    })?;
    say(&text);
    Ok(())
}

/// Rows of words in columns as wide as their widest word; columns of numbers stand to the right.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) {
    let width = |column: usize| {
        let words = rows.iter().filter_map(|row| row.get(column)).map(|word| word.chars().count());
        words.chain(head.get(column).map(|word| word.chars().count())).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..head.len()).map(width).collect();
    let numeric = |word: &String| word.starts_with(|c: char| c.is_ascii_digit() || "-+".contains(c));
    let right: Vec<bool> = (0..head.len())
        .map(|column| column > 0 && rows.iter().filter_map(|row| row.get(column)).all(numeric))
        .collect();
    let line = |words: Vec<&str>| {
        let mut text = String::new();
        for (column, word) in words.into_iter().enumerate() {
            let space = widths.get(column).copied().unwrap_or(0).saturating_sub(word.chars().count());
            let pad = " ".repeat(space);
            let gap = if column == 0 { "" } else { "  " };
            text += gap;
            text += &if right.get(column) == Some(&true) { pad + word } else { word.to_owned() + &pad };
        }
        say(text.trim_end());
    };
    line(head.to_vec());
    for row in rows {
        line(row.iter().map(String::as_str).collect());
    }
}

/// A number with separators between thousands.
pub(super) fn thousands(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A rate in words: 12.3 million, 4,567.
pub(super) fn rate(value: f64) -> String {
    if value >= 1e6 { format!("{:.1} million", value / 1e6) } else { format!("{value:.0}") }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(thousands(0), "0");
        assert_eq!(thousands(1234), "1,234");
        assert_eq!(thousands(123_456_789), "123,456,789");
        assert_eq!(rate(12_345_678.0), "12.3 million");
        assert_eq!(rate(4567.2), "4567");
    }
}
