//! Recordings of crowds in, [`Trajectories`] out: `JuPedSim`'s databases, Parquet, texts of columns (the Pedestrian Dynamics Data
//! Archive, the `obsmat` of the ETH and UCY data, TrajNet and SGAN, Vadere, Pathfinder, gaitway, any with named columns),
//! UCY's splines with head directions. What is none of these is named by its first bytes.
//!
//! Every reader yields rows of (person, frame, place); what is common to all (what the file does not say, order,
//! duplicates, gaps, limits) is done once, in `infer` and [`tracks`]. Nothing is allocated beyond a small multiple of
//! what the file really holds.

mod area;
#[cfg_attr(not(feature = "parquet"), path = "without_columnar.rs")]
mod columnar;
mod columns;
#[cfg_attr(not(feature = "sqlite"), path = "without_database.rs")]
mod database;
mod found;
mod infer;
#[cfg(feature = "parquet")]
mod pages;
mod signature;
mod splines;
mod text;
pub mod tracks;

pub use columns::{Column, Columns, ColumnsError};
pub use found::{
    Format, MAX_BYTES, MAX_COORDINATE, MAX_MEDIAN_SPEED, MAX_PEOPLE, MAX_SECONDS, Options, Pixels,
};
pub use infer::name_of_unit;

use super::error::Error;
use crate::file;
use found::{Found, Row, clip, decimal, number, syntax, unusable, whole};
use std::io::Read as _;
use std::path::Path;
use tracks::Trajectories;

/// Reads a recording.
///
/// # Errors
/// [`Error::Read`], [`Error::Sqlite`] or [`Error::Parquet`] when the file cannot be read, [`Error::Syntax`] with the line of what is not as
/// it must be, [`Error::Unusable`] when the file is of a kind that is not read (named by its first bytes), the columns, the
/// frame rate or the homography are missing, people are faster than [`MAX_MEDIAN_SPEED`], or a limit ([`MAX_BYTES`],
/// [`MAX_SECONDS`], [`MAX_COORDINATE`], [`MAX_PEOPLE`]) is passed.
pub fn read(path: &Path, options: &Options) -> Result<Trajectories, Error> {
    let head = head_of(path)?;
    let ending = path.extension().and_then(|e| e.to_str()).unwrap_or("").to_ascii_lowercase();
    let by_name = match ending.as_str() {
        "sqlite" | "sqlite3" | "db" => Some(Format::Sqlite),
        "parquet" => Some(Format::Parquet),
        "vsp" => Some(Format::Vsp),
        _ => None,
    };
    let by_head = match head.as_slice() {
        head if head.starts_with(signature::SQLITE) => Some(Format::Sqlite),
        head if head.starts_with(signature::PARQUET) => Some(Format::Parquet),
        _ => None,
    };
    if by_head.is_none()
        && let Some(known) = signature::of(&head)
    {
        return Err(unusable(path, format!("it is {}, which is not read", known.name), known.hint));
    }
    let format = by_head.or(options.format).or(by_name);
    let is_text = !matches!(format, Some(Format::Sqlite | Format::Parquet | Format::Vsp));
    if options.columns.is_some() && !is_text {
        let hint = "leave --columns out; it is for texts of columns";
        return Err(unusable(path, "its columns are known", hint));
    }
    let found = match format {
        Some(Format::Sqlite) => database::read(path)?,
        Some(Format::Parquet) => columnar::read(path)?,
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
    String::from_utf8(bytes).map_err(|error| {
        let at = error.utf8_error().valid_up_to();
        let line = 1 + error.as_bytes()[..at].iter().filter(|byte| **byte == b'\n').count();
        syntax(path, line, "bytes that are no text (UTF-8)")
    })
}
