//! What readers are asked for and what they find.

use super::super::error::Error;
use super::columns::Columns;
use glam::DVec2;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Largest file read, bytes.
#[doc(hidden)]
pub const MAX_BYTES: u64 = 512 << 20;

/// Longest recording, s.
#[doc(hidden)]
pub const MAX_SECONDS: f64 = 86_400.0;

/// Greatest distance of a person from the origin, m.
#[doc(hidden)]
pub const MAX_COORDINATE: f64 = 50_000.0;

/// Most people of a recording.
#[doc(hidden)]
pub const MAX_PEOPLE: usize = 1_000_000;

/// Half of the steps of a recording are slower than this, or it was misread, m/s.
#[doc(hidden)]
pub const MAX_MEDIAN_SPEED: f64 = 4.0;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// `JuPedSim`'s SQLite database, version 1 or 2.
    Sqlite,
    /// Parquet with named columns; among them gaitway's own.
    Parquet,
    /// The text of the Pedestrian Dynamics Data Archive: id, frame, x, y, z.
    Archive,
    /// Columns without names in another order: frame, id, x, y as `TrajNet` and SGAN have them, or as asked for.
    Columns,
    /// ETH and UCY: frame, id, x, 0, y, and three velocities.
    Obsmat,
    /// UCY: splines in the picture with head directions, and a homography to the ground.
    Vsp,
    /// Named columns, separated by commas or semicolons; among them gaitway's own.
    Csv,
}

/// How the pixels of a homography are counted.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Pixels {
    /// (x, y) from the centre of the picture, y up, as the splines have them.
    Centre,
    /// (row, column) from the upper left corner.
    RowColumn,
}

/// What the caller knows better than the file. The default infers everything.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// The format.
    pub format: Option<Format>,
    /// What stands in which column of a text.
    pub columns: Option<Columns>,
    /// Frames per second.
    pub frame_rate: Option<f64>,
    /// Read also what is faster than people walk ([`MAX_MEDIAN_SPEED`]).
    pub accept_speed: bool,
    /// Metres per unit of length of the file.
    pub metres_per_unit: Option<f64>,
    /// Homography of a `.vsp` file; otherwise `H.txt` beside it.
    pub homography: Option<PathBuf>,
    /// How its pixels are counted.
    pub pixels: Option<Pixels>,
    /// The file's plane is left-handed as seen from above (y down the page), so that right is left in it.
    pub mirror: bool,
    /// A gap between two samples that is longer than this is an absence, s; `None`: 2 s.
    pub longest_gap: Option<f64>,
}

/// One person at one moment, in the plane of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Row {
    pub(super) id: i64,
    /// A whole number, unless times are not evenly spaced.
    pub(super) frame: f64,
    /// x to the right, y up the page, in units of the file.
    pub(super) place: DVec2,
    /// The same of the velocity, units a second.
    pub(super) velocity: Option<[f32; 2]>,
    /// Direction of body or head as an angle from the x axis, rad.
    pub(super) facing: Option<f64>,
    /// Line or row of the file.
    pub(super) line: usize,
}

/// What a reader found, before its rows are sorted by person.
#[derive(Debug)]
pub(super) struct Found {
    pub(super) format: Format,
    pub(super) rows: Vec<Row>,
    /// The columns of a text, and the origin of that.
    pub(super) columns: Option<(Columns, &'static str)>,
    /// Frames per second, and the origin of that.
    pub(super) frame_rate: Option<(f64, &'static str)>,
    /// Frames per second of the format where neither the file nor its data tell.
    pub(super) usual_rate: Option<f64>,
    /// Metres per unit, and the origin of that.
    pub(super) metres_per_unit: Option<(f64, &'static str)>,
    /// Heights of people, in units of the file.
    pub(super) heights: Vec<f64>,
    /// Outer outline and holes, in the plane of the file, m.
    pub(super) area: Option<Vec<Vec<DVec2>>>,
    /// Rows are control points of curves: a gap between them is no absence, however long.
    pub(super) is_curve: bool,
    /// What was inferred, in words.
    pub(super) notes: Vec<String>,
}

impl Default for Found {
    fn default() -> Self {
        Self {
            format: Format::Archive,
            rows: Vec::new(),
            columns: None,
            frame_rate: None,
            usual_rate: None,
            metres_per_unit: None,
            heights: Vec::new(),
            area: None,
            is_curve: false,
            notes: Vec::new(),
        }
    }
}

pub(super) fn syntax(path: &Path, line: usize, message: impl Into<String>) -> Error {
    Error::Syntax { path: path.to_owned(), line, message: message.into() }
}

pub(super) fn unusable(path: &Path, message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Unusable { path: path.to_owned(), message: message.into(), hint: hint.into() }
}

/// A number as programs write it, or with a decimal comma; between blanks it may be quoted, too.
pub(super) fn decimal(cell: &str) -> Option<f64> {
    let cell = cell.trim_matches('"');
    cell.parse().ok().or_else(|| cell.replacen(',', ".", 1).parse().ok())
}

/// A cell as a finite number.
pub(super) fn number(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<f64, Error> {
    let Some(cell) = cell else {
        return Err(syntax(path, line, format!("{name} is missing")));
    };
    match decimal(cell) {
        Some(value) if value.is_finite() => Ok(value),
        _ => Err(syntax(path, line, format!("{name} is {:?}, not a finite number", clip(cell)))),
    }
}

/// A cell as a whole number; `1.000e+00` is one.
pub(super) fn whole(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<i64, Error> {
    let value = number(path, line, name, cell)?;
    if value.fract() != 0.0 || value.abs() > 9_007_199_254_740_992.0 {
        let message = format!("{name} is {value}, not a whole number of up to 53 bits");
        return Err(syntax(path, line, message));
    }
    #[allow(clippy::cast_possible_truncation, reason = "a whole number of 53 bits")]
    let value = value as i64;
    Ok(value)
}

/// The beginning of a text from a file, for messages.
pub(super) fn clip(text: &str) -> String {
    text.chars().take(40).collect()
}
