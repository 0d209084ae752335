//! Where a recording is kept: recordings that broke off are repaired, and nothing is lost to a new one.

use super::{FIRST, RecordingError};
use std::fs::{File, OpenOptions};
use std::io::{Read as _, Seek as _, SeekFrom};
use std::path::{Path, PathBuf};

/// Longer than any line of a recording.
const TAIL: u64 = 1 << 16;

/// A place for a new recording.
#[derive(Debug)]
pub struct Way {
    /// The empty file.
    pub file: File,
    /// What was done about a recording that broke off there, in one line.
    pub note: Option<String>,
}

/// The end of a file, and where that begins.
fn tail(file: &mut File) -> std::io::Result<(Vec<u8>, u64)> {
    let length = file.metadata()?.len();
    let from = length.saturating_sub(TAIL);
    file.seek(SeekFrom::Start(from))?;
    let mut bytes = Vec::new();
    file.take(TAIL).read_to_end(&mut bytes)?;
    Ok((bytes, from))
}

/// Cuts what is left of a line that was not completed, where a program was killed while it recorded. Returns how many
/// bytes that were; none if the last line is whole.
///
/// # Errors
/// When the file cannot be read, or there is something to cut and it cannot be written.
pub fn repair(path: &Path) -> std::io::Result<u64> {
    let mut file = File::open(path)?;
    if !file.metadata()?.is_file() {
        return Ok(0);
    }
    let (bytes, from) = tail(&mut file)?;
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |at| at + 1);
    let cut = (bytes.len() - whole) as u64;
    if cut > 0 {
        OpenOptions::new().write(true).open(path)?.set_len(from + whole as u64)?;
    }
    Ok(cut)
}

/// Makes way for a new recording at `path`. A recording there that broke off is repaired and moved aside; one that broke
/// off before its first step is replaced.
///
/// # Errors
/// [`RecordingError::Taken`] when there is a complete recording or something else; [`RecordingError::File`] when the file
/// cannot be made.
pub fn make_way(path: &Path) -> Result<Way, RecordingError> {
    let is_file = std::fs::metadata(path).map(|found| found.is_file());
    let create = || OpenOptions::new().write(true).create(true).truncate(true).open(path);
    match is_file {
        Ok(true) => {}
        Ok(false) => return Ok(Way { file: OpenOptions::new().write(true).open(path)?, note: None }),
        Err(_) => return Ok(Way { file: create()?, note: None }),
    }
    let mut head = Vec::new();
    File::open(path)?.take(TAIL).read_to_end(&mut head)?;
    let head = String::from_utf8_lossy(&head);
    let begins = format!("# {FIRST} ");
    if head.is_empty() || (begins.starts_with(&*head) && head.len() < begins.len()) {
        return Ok(Way { file: create()?, note: None });
    }
    if !head.starts_with(&begins) {
        return Err(RecordingError::Taken("there is a file that is no recording"));
    }
    let (end, _) = tail(&mut File::open(path)?)?;
    let end = String::from_utf8_lossy(&end);
    if end.lines().next_back().is_some_and(|line| line.starts_with("# end ")) {
        return Err(RecordingError::Taken("there is a complete recording"));
    }
    if !head.lines().any(|line| line.starts_with(|first: char| first.is_ascii_digit())) {
        return Ok(Way { file: create()?, note: None });
    }
    let cut = repair(path)?;
    let aside = aside(path);
    std::fs::rename(path, &aside)?;
    let torn = if cut > 0 { ", cut at its last whole step," } else { "" };
    let note = format!("the recording that broke off there{torn} is kept as {}", aside.display());
    Ok(Way { file: create()?, note: Some(note) })
}

/// A name beside a recording's that is not taken: `visit.broken-off.csv`, `visit.broken-off-2.csv`, ...
fn aside(path: &Path) -> PathBuf {
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let ending = path.extension().map_or(String::new(), |ending| format!(".{}", ending.to_string_lossy()));
    let name = |number: u32| match number {
        1 => path.with_file_name(format!("{stem}.broken-off{ending}")),
        number => path.with_file_name(format!("{stem}.broken-off-{number}{ending}")),
    };
    (1..).map(name).find(|path| !path.exists()).unwrap_or_else(|| name(1))
}
