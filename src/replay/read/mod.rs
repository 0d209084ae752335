//! Recordings of crowds in, [`Trajectories`] out: `JuPedSim`'s databases, the text of the Pedestrian Dynamics Data Archive,
//! the `obsmat` of the ETH and UCY data, UCY's splines with head directions, CSV (ours and any with named columns).
//!
//! Every reader yields rows of (person, frame, place); what is common to all (order, duplicates, gaps, limits) is done
//! once, in [`tracks`]. Nothing is allocated beyond a small multiple of what the file really holds.

mod columns;
mod database;
mod obsmat;
mod splines;
pub mod tracks;
mod wkt;

use super::error::Error;
use glam::DVec2;
use serde::Serialize;
use std::path::{Path, PathBuf};
use tracks::Trajectories;

/// Largest file read, bytes.
pub const MAX_BYTES: u64 = 512 << 20;
/// Longest recording, s.
pub const MAX_SECONDS: f64 = 86_400.0;
/// Farthest from the origin that anybody may be, m.
pub const MAX_COORDINATE: f64 = 50_000.0;
/// Most people of a recording.
pub const MAX_PEOPLE: usize = 1_000_000;

/// A format that is read.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Format {
    /// `JuPedSim`'s SQLite database, version 1 or 2.
    Sqlite,
    /// The text of the Pedestrian Dynamics Data Archive: id, frame, x, y, z.
    Archive,
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
    /// Frames per second.
    pub frame_rate: Option<f64>,
    /// Metres per unit of length of the file.
    pub metres_per_unit: Option<f64>,
    /// Homography of a `.vsp` file; otherwise `H.txt` beside it.
    pub homography: Option<PathBuf>,
    /// How its pixels are counted.
    pub pixels: Option<Pixels>,
    /// The file's plane is left-handed as seen from above (y down the page), so that right is left in it.
    pub mirror: bool,
    /// A person who is not seen for longer than this is absent meanwhile, s; `None`: 2 s.
    pub longest_gap: Option<f64>,
}

/// One person at one moment, in the plane of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Row {
    id: i64,
    frame: i64,
    /// x to the right, y up the page, in units of the file.
    place: DVec2,
    /// Direction of body or head as an angle from the x axis, rad.
    facing: Option<f64>,
    /// Line or row of the file.
    line: usize,
}

/// What a reader found, before people are told apart.
#[derive(Debug, Default)]
struct Found {
    rows: Vec<Row>,
    /// Frames per second as the file says.
    frame_rate: Option<f64>,
    /// Frames per second of the format where the file does not say.
    usual_rate: Option<f64>,
    /// Metres per unit as the file says, or as inferred; `None`: metres.
    metres_per_unit: Option<f64>,
    /// Outer outline and holes, in the plane of the file, m.
    area: Option<Vec<Vec<DVec2>>>,
    /// Control points of curves: however far apart, nobody leaves between them.
    is_curve: bool,
    /// What was inferred, in words.
    notes: Vec<String>,
}

/// Reads a recording.
///
/// # Errors
/// [`Error::Read`] or [`Error::Sqlite`] when the file cannot be read, [`Error::Syntax`] with the line of what is not as
/// it must be, [`Error::Unusable`] when the format is not known, the frame rate or the homography is missing, or a limit
/// ([`MAX_BYTES`], [`MAX_SECONDS`], [`MAX_COORDINATE`], [`MAX_PEOPLE`]) is passed.
pub fn read(path: &Path, options: &Options) -> Result<Trajectories, Error> {
    let size = std::fs::metadata(path).map_err(|source| Error::Read { path: path.to_owned(), source })?.len();
    if size > MAX_BYTES {
        return Err(unusable(
            path,
            format!("{size} bytes; at most {MAX_BYTES} are read"),
            "cut it into parts",
        ));
    }
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let by_name = match ending.as_str() {
        "sqlite" | "sqlite3" | "db" => Some(Format::Sqlite),
        "vsp" => Some(Format::Vsp),
        "csv" => Some(Format::Csv),
        _ => None,
    };
    if options.format.or(by_name) == Some(Format::Sqlite) {
        return tracks::gather(path, Format::Sqlite, database::read(path)?, options);
    }
    let text = text_of(path)?;
    let format = match options.format.or(by_name) {
        Some(format) => format,
        None => guess(path, &text)?,
    };
    let found = match format {
        Format::Obsmat => obsmat::parse(path, &text)?,
        Format::Vsp => splines::parse(path, &text, &homography(path, options)?)?,
        Format::Csv => columns::parse_csv(path, &text)?,
        Format::Archive | Format::Sqlite => columns::parse_archive(path, &text, options)?,
    };
    tracks::gather(path, format, found, options)
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
    let size = std::fs::metadata(path).map_err(wrong)?.len();
    if size > MAX_BYTES {
        return Err(unusable(
            path,
            format!("{size} bytes; at most {MAX_BYTES} are read"),
            "cut it into parts",
        ));
    }
    let bytes = std::fs::read(path).map_err(wrong)?;
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        syntax(path, line, "bytes that are no text (UTF-8)")
    })
}

/// The format of a text, by its first row of numbers.
fn guess(path: &Path, text: &str) -> Result<Format, Error> {
    let row = text.lines().map(str::trim).find(|line| !line.is_empty() && !line.starts_with('#'));
    let cells: Vec<&str> = row.unwrap_or("").split_whitespace().collect();
    let is_number = |cell: &&str| cell.parse::<f64>().is_ok();
    if row.is_some_and(|row| row.contains(',') || row.contains(';')) {
        return Ok(Format::Csv);
    }
    if cells.iter().all(is_number) {
        match cells.len() {
            4 | 5 => return Ok(Format::Archive),
            8 => return Ok(Format::Obsmat),
            _ => {}
        }
    }
    let message = format!("its first row has {} columns; no format that is read looks so", cells.len());
    Err(unusable(
        path,
        message,
        "recordings are .sqlite (JuPedSim), .txt (id frame x y z; or the 8 columns of obsmat), .vsp or .csv; --format says which",
    ))
}

fn syntax(path: &Path, line: usize, message: impl Into<String>) -> Error {
    Error::Syntax { path: path.to_owned(), line, message: message.into() }
}

fn unusable(path: &Path, message: impl Into<String>, hint: impl Into<String>) -> Error {
    Error::Unusable { path: path.to_owned(), message: message.into(), hint: hint.into() }
}

/// A cell as a finite number.
fn number(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<f64, Error> {
    let Some(cell) = cell else {
        return Err(syntax(path, line, format!("{name} is missing")));
    };
    match cell.trim().parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(syntax(path, line, format!("{name} is {:?}, not a finite number", clip(cell)))),
    }
}

/// A cell as a whole number; `1.000e+00` is one.
fn whole(path: &Path, line: usize, name: &str, cell: Option<&str>) -> Result<i64, Error> {
    let value = number(path, line, name, cell)?;
    if value.fract() != 0.0 || value.abs() > 2_147_483_647.0 {
        return Err(syntax(path, line, format!("{name} is {value}, not a whole number of up to 31 bits")));
    }
    #[allow(clippy::cast_possible_truncation, reason = "a whole number of 31 bits")]
    let value = value as i64;
    Ok(value)
}

/// The beginning of a text from a file, for messages.
fn clip(text: &str) -> String {
    text.chars().take(40).collect()
}
