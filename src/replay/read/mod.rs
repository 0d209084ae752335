//! Recordings of crowds in, [`Trajectories`] out: `JuPedSim`'s databases, texts of columns (the Pedestrian Dynamics Data
//! Archive, the `obsmat` of the ETH and UCY data, TrajNet and SGAN, Vadere, Pathfinder, gaitway, any with named columns),
//! UCY's splines with head directions. What is none of these is named by its first bytes.
//!
//! Every reader yields rows of (person, frame, place); what is common to all (what the file does not say, order,
//! duplicates, gaps, limits) is done once, in `infer` and [`tracks`]. Nothing is allocated beyond a small multiple of
//! what the file really holds.

mod columns;
#[cfg_attr(not(feature = "sqlite"), path = "without_database.rs")]
mod database;
mod infer;
mod signature;
mod splines;
mod text;
pub mod tracks;

pub use columns::{Column, Columns};
pub use infer::name_of_unit;

use super::error::Error;
use crate::file;
use glam::DVec2;
use serde::Serialize;
use std::io::Read as _;
use std::path::{Path, PathBuf};
use tracks::Trajectories;

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
struct Row {
    id: i64,
    /// A whole number, unless times are not evenly spaced.
    frame: f64,
    /// x to the right, y up the page, in units of the file.
    place: DVec2,
    /// The same of the velocity, units a second.
    velocity: Option<[f32; 2]>,
    /// Direction of body or head as an angle from the x axis, rad.
    facing: Option<f64>,
    /// Line or row of the file.
    line: usize,
}

/// What a reader found, before its rows are sorted by person.
#[derive(Debug)]
struct Found {
    format: Format,
    rows: Vec<Row>,
    /// The columns of a text, and the origin of that.
    columns: Option<(Columns, &'static str)>,
    /// Frames per second, and the origin of that.
    frame_rate: Option<(f64, &'static str)>,
    /// Frames per second of the format where neither the file nor its data tell.
    usual_rate: Option<f64>,
    /// Metres per unit, and the origin of that.
    metres_per_unit: Option<(f64, &'static str)>,
    /// Heights of people, in units of the file.
    heights: Vec<f64>,
    /// Outer outline and holes, in the plane of the file, m.
    area: Option<Vec<Vec<DVec2>>>,
    /// Rows are control points of curves: a gap between them is no absence, however long.
    is_curve: bool,
    /// What was inferred, in words.
    notes: Vec<String>,
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

/// Reads a recording.
///
/// # Errors
/// [`Error::Read`] or [`Error::Sqlite`] when the file cannot be read, [`Error::Syntax`] with the line of what is not as
/// it must be, [`Error::Unusable`] when the file is of a kind that is not read (named by its first bytes), the columns, the
/// frame rate or the homography are missing, people are faster than [`MAX_MEDIAN_SPEED`], or a limit ([`MAX_BYTES`],
/// [`MAX_SECONDS`], [`MAX_COORDINATE`], [`MAX_PEOPLE`]) is passed.
pub fn read(path: &Path, options: &Options) -> Result<Trajectories, Error> {
    let head = head_of(path)?;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let by_name = match ending.as_str() {
        "sqlite" | "sqlite3" | "db" => Some(Format::Sqlite),
        "vsp" => Some(Format::Vsp),
        _ => None,
    };
    let is_database = head.starts_with(signature::SQLITE);
    if !is_database && let Some(known) = signature::of(&head) {
        return Err(unusable(path, format!("it is {}, which is not read", known.name), known.hint));
    }
    let format = if is_database { Some(Format::Sqlite) } else { options.format.or(by_name) };
    let is_text = !matches!(format, Some(Format::Sqlite | Format::Vsp));
    if options.columns.is_some() && !is_text {
        let hint = "leave --columns out; it is for texts of columns";
        return Err(unusable(path, "its columns are known", hint));
    }
    let found = match format {
        Some(Format::Sqlite) => database::read(path)?,
        Some(Format::Vsp) => splines::parse(path, &text_of(path)?, &homography(path, options)?)?,
        _ => text::parse(path, &text_of(path)?, options)?,
    };
    tracks::gather(path, found, options)
}

/// The first bytes of a file.
fn head_of(path: &Path) -> Result<Vec<u8>, Error> {
    let wrong = |source| Error::Read { path: path.to_owned(), source };
    let mut head = Vec::new();
    file::regular(path).map_err(wrong)?;
    std::fs::File::open(path).map_err(wrong)?.take(256).read_to_end(&mut head).map_err(wrong)?;
    Ok(head)
}

/// The homography of a `.vsp` file.
fn homography(path: &Path, options: &Options) -> Result<splines::Homography, Error> {
    let file = match &options.homography {
        Some(file) => file.clone(),
        None => path.with_file_name("H.txt"),
    };
    if !file.is_file() {
        let message = format!("its points are pixels, and there is no homography {file:?}");
        return Err(unusable(path, message, "name it with --homography FILE"));
    }
    splines::Homography::parse(&file, &text_of(&file)?, options.pixels)
}

fn text_of(path: &Path) -> Result<String, Error> {
    let wrong = |source| Error::Read { path: path.to_owned(), source };
    let bytes = file::read(path, MAX_BYTES).map_err(wrong)?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        syntax(path, line, "bytes that are no text (UTF-8)")
    })?;
    // a mark of the order of bytes, as spreadsheets write it
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

fn syntax(path: &Path, line: usize, message: impl Into<String>) -> Error {
    Error::Syntax { path: path.to_owned(), line, message: message.into() }
}

fn unusable(path: &Path, message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Unusable { path: path.to_owned(), message: message.into(), hint: hint.into() }
}

/// A number as programs write it, or with a decimal comma.
fn decimal(cell: &str) -> Option<f64> {
    let cell = cell.trim().trim_matches('"');
    cell.parse().ok().or_else(|| cell.replacen(',', ".", 1).parse().ok())
}

/// A cell as a finite number.
fn number(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<f64, Error> {
    let Some(cell) = cell else {
        return Err(syntax(path, line, format!("{name} is missing")));
    };
    match decimal(cell) {
        Some(value) if value.is_finite() => Ok(value),
        _ => Err(syntax(path, line, format!("{name} is {:?}, not a finite number", clip(cell)))),
    }
}

/// A cell as a whole number; `1.000e+00` is one.
fn whole(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<i64, Error> {
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
fn clip(text: &str) -> String {
    text.chars().take(40).collect()
}
