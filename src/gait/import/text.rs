//! Small helpers of the text formats: numbers that are finite, errors that name file and line.

use crate::gait::Error;

/// Largest magnitude of a number in a motion file; beyond it sums and products could overflow.
pub(super) const MAX_MAGNITUDE: f32 = 1e6;

/// A syntax error at a line (from 1; 0 = the file as a whole).
pub(super) fn syntax(path: &str, line: usize, message: impl Into<String>) -> Error {
    Error::Syntax { path: path.to_owned(), line, message: message.into() }
}

/// `text` for a message: quoted, cut to a readable length.
pub(super) fn shown(text: &str) -> String {
    let mut short: String = text.chars().take(40).collect();
    if short.len() < text.len() {
        short.push_str("...");
    }
    format!("{short:?}")
}

/// Up to a dozen names for a message.
pub(super) fn list<S: AsRef<str>>(names: &[S]) -> String {
    let mut text: Vec<&str> = names.iter().take(40).map(AsRef::as_ref).collect();
    if names.len() > text.len() {
        text.push("...");
    }
    text.join(", ")
}

/// A finite number of sensible size.
pub(super) fn number(path: &str, line: usize, token: &str, what: &str) -> Result<f32, Error> {
    match token.parse::<f32>() {
        Ok(value) if value.abs() <= MAX_MAGNITUDE => Ok(value),
        Ok(value) => {
            let range = format!("-{MAX_MAGNITUDE} to {MAX_MAGNITUDE}");
            Err(syntax(path, line, format!("{what} is {value}; it must be a finite number from {range}")))
        }
        Err(_) => Err(syntax(path, line, format!("{what} is {}; a number was expected", shown(token)))),
    }
}

/// A count no larger than `limit`.
pub(super) fn count(path: &str, line: usize, token: &str, what: &str, limit: usize) -> Result<usize, Error> {
    match token.parse::<u64>().ok().and_then(|n| usize::try_from(n).ok()) {
        Some(n) if n <= limit => Ok(n),
        _ => {
            let message =
                format!("{what} is {}; a whole number from 0 to {limit} was expected", shown(token));
            Err(syntax(path, line, message))
        }
    }
}

/// Frames per second within what motion capture uses.
pub(super) fn frame_rate(path: &str, line: usize, hertz: f32) -> Result<f32, Error> {
    if (1.0..=2000.0).contains(&hertz) {
        Ok(hertz)
    } else {
        Err(syntax(path, line, format!("frame rate is {hertz} Hz; it must be from 1 to 2000 Hz")))
    }
}
