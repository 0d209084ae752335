//! Recorded crowds: the text files of the Jülich archive and the `obsmat.txt` of UCY.

use super::tracks::Tracks;
use crate::file;
use glam::Vec2;
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Largest file read, bytes.
const MAX_BYTES: u64 = 256 << 20;
/// Most frames from the first to the last: more than an hour at 25 a second.
const MOST_FRAMES: f64 = 100_000.0;
/// Largest number of a frame.
const MOST_NUMBER: f64 = 1e12;

/// Why a file could not be used.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// It cannot be read.
    #[error("{path}: {source}")]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: std::io::Error,
    },
    /// A line is not what it should be.
    #[error("{path}:{line}: found {found:?}; wanted {wanted}")]
    Line {
        /// The file.
        path: PathBuf,
        /// Which line, from 1.
        line: usize,
        /// Its beginning.
        found: String,
        /// What should stand there.
        wanted: &'static str,
    },
    /// Its frames lie too far apart.
    #[error(
        "{path}: frames {first} to {last}; at most {MOST_FRAMES} frames are read, from 0 to {MOST_NUMBER:e}"
    )]
    Frames {
        /// The file.
        path: PathBuf,
        /// The least.
        first: f64,
        /// The largest.
        last: f64,
    },
}

/// Rows of numbers, at least `least` in each; lines that begin with `#` are none.
fn rows(path: &Path, least: usize, wanted: &'static str) -> Result<Vec<Vec<f64>>, Error> {
    let read = |source| Error::Read { path: path.to_owned(), source };
    let text = file::read_text(path, MAX_BYTES).map_err(read)?;
    let mut rows = Vec::new();
    for (index, line) in text.lines().enumerate() {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        let numbers: Result<Vec<f64>, _> = line.split_whitespace().map(str::parse).collect();
        match numbers {
            Ok(row) if row.len() >= least && row.iter().all(|n| n.is_finite()) => rows.push(row),
            _ => {
                let found = line.chars().take(60).collect();
                return Err(Error::Line { path: path.to_owned(), line: index + 1, found, wanted });
            }
        }
    }
    Ok(rows)
}

/// A person in a frame: the frame, the person, the place in m.
type Row = (f64, f64, Vec2);

#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "numbers of people and frames")]
fn collect(path: &Path, rate: f64, every: f64, rows: impl Iterator<Item = Row>) -> Result<Tracks, Error> {
    let rows: Vec<Row> = rows.map(|(frame, who, at)| ((frame / every).round(), who, at)).collect();
    let numbers = || rows.iter().map(|row| row.0);
    let (first, last) =
        (numbers().fold(f64::INFINITY, f64::min), numbers().fold(f64::NEG_INFINITY, f64::max));
    let is_readable = first >= 0.0 && last <= MOST_NUMBER && last - first < MOST_FRAMES;
    if !(rows.is_empty() || is_readable) {
        return Err(Error::Frames { path: path.to_owned(), first, last });
    }
    let mut frames: BTreeMap<i64, Vec<(u32, Vec2)>> = BTreeMap::new();
    for (frame, who, at) in rows {
        frames.entry(frame as i64).or_default().push((who as u32, at));
    }
    let mut tracks = Tracks::new(rate);
    let mut next = frames.keys().next().copied().unwrap_or(0);
    for (frame, mut people) in frames {
        // a gap in the recording is frames without people
        while next < frame {
            tracks.frames.push(Vec::new());
            next += 1;
        }
        people.sort_by_key(|person| person.0);
        people.dedup_by_key(|person| person.0);
        tracks.frames.push(people);
        next = frame + 1;
    }
    Ok(tracks)
}

/// A file of the Jülich archive: `id frame x y z`, with `scale` metres to its unit and `rate` frames a second.
///
/// # Errors
/// [`Error`] with file and line.
pub fn juelich(path: &Path, scale: f64, rate: f64) -> Result<Tracks, Error> {
    let rows = rows(path, 4, "id frame x y z")?;
    #[allow(clippy::cast_possible_truncation, reason = "metres")]
    let at = |row: &[f64]| Vec2::new((row[2] * scale) as f32, (row[3] * scale) as f32);
    collect(path, rate, 1.0, rows.iter().map(|row| (row[1], row[0], at(row))))
}

/// A file of UCY as `OpenTraj` has it: `frame id x _ y vx _ vy`, 25 frames a second, a row every ten.
///
/// # Errors
/// [`Error`] with file and line.
pub fn ucy(path: &Path) -> Result<Tracks, Error> {
    let rows = rows(path, 8, "frame id x _ y vx _ vy")?;
    #[allow(clippy::cast_possible_truncation, reason = "metres")]
    let at = |row: &[f64]| Vec2::new(row[2] as f32, row[4] as f32);
    collect(path, 2.5, 10.0, rows.iter().map(|row| (row[0] - 1.0, row[1], at(row))))
}

/// A recorded crowd that is there but cannot be used.
#[allow(clippy::needless_pass_by_value, reason = "for map_err")]
pub(super) fn unusable(error: Error) -> crate::Error {
    let hint = "leave the file out, or name another folder with --data";
    crate::Error::Failed { message: error.to_string(), hint: hint.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_become_tracks_and_wrong_lines_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.txt");
        std::fs::write(&path, "# id frame x y z\n7 3 100 200 170\n2 3 50 60 170\n7 5 110 200 170\n").unwrap();
        let tracks = juelich(&path, 0.01, 16.0).unwrap();
        assert_eq!(tracks.frames.len(), 3);
        assert_eq!(tracks.frames[0], [(2, Vec2::new(0.5, 0.6)), (7, Vec2::new(1.0, 2.0))]);
        assert!(tracks.frames[1].is_empty() && tracks.at(2, 7) == Some(Vec2::new(1.1, 2.0)));
        let error = ucy(&path).unwrap_err().to_string();
        assert!(error.contains("a.txt:2") && error.contains("vx"), "{error}");
        std::fs::write(&path, "1 1 4.5 0 2 0 0 0\n11 1 5 0 2 0 0 0\n").unwrap();
        let tracks = ucy(&path).unwrap();
        assert_eq!((tracks.frames.len(), tracks.rate), (2, 2.5));
        std::fs::write(&path, "1 1 nan 0 2 0 0 0\n").unwrap();
        assert!(ucy(&path).is_err() && ucy(&folder.path().join("none")).is_err());
        for far in ["1 0 1 1\n1 200000 1 1\n", "1 0 1 1\n1 1e300 1 1\n", "1 -3 1 1\n"] {
            std::fs::write(&path, far).unwrap();
            let error = juelich(&path, 0.01, 16.0).unwrap_err().to_string();
            assert!(error.contains("a.txt: frames ") && error.contains("100000"), "{error}");
        }
    }
}
