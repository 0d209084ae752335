//! What readers share: options, limits, files, where takes come from.

use super::super::{Error, Provenance};
use super::joint_map::JointMap;
use crate::file;
use std::path::{Path, PathBuf};

/// Most joints a file may have.
#[doc(hidden)]
pub const MAX_JOINTS: usize = 512;

/// Most frames a take may have.
#[doc(hidden)]
pub const MAX_FRAMES: usize = 1_000_000;

/// Largest file read, bytes.
#[doc(hidden)]
pub const MAX_BYTES: u64 = 512 << 20;

/// Extensions of the files that are read, in lower case.
pub const EXTENSIONS: [&str; 9] = ["bvh", "amc", "c3d", "trc", "npz", "npy", "csv", "tsv", "txt"];

/// What the caller knows better than the file. The default infers everything.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Options {
    /// ASF skeleton of an AMC file; otherwise it is looked for beside the AMC.
    pub skeleton: Option<PathBuf>,
    /// Metres per unit of length of the file.
    pub metres_per_unit: Option<f32>,
    /// Frames per second, whatever the file states.
    pub frame_rate: Option<f32>,
    /// Names of the 16 joints in the file.
    pub joint_map: Option<JointMap>,
    /// Frames per second that every take is brought to.
    pub resample: Option<f32>,
    /// E-Gait's gaits as they were published: pitched, in units of their own, without travel. To compare with others
    /// who computed on those numbers.
    pub as_published: bool,
}

/// Reads a text file within [`MAX_BYTES`]; bytes that are not UTF-8 (names in old code pages) are replaced.
pub(crate) fn read(path: &Path) -> Result<String, Error> {
    Ok(match String::from_utf8(read_bytes(path)?) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    })
}

/// Reads a file within [`MAX_BYTES`].
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    file::read(path, MAX_BYTES).map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// File name without folder and extension; names recordings.
pub(super) fn stem(path: &str) -> String {
    Path::new(path).file_stem().map_or_else(|| path.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// File name without folder; names sources.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or_else(|| path.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Name of the folder that a file is in; empty if the path does not say.
pub(super) fn folder_name(path: &Path) -> String {
    path.parent().and_then(Path::file_name).map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// Where the only take of a file comes from: its folder is the data set.
pub(super) fn of_file(path: &str, format: &str) -> Provenance {
    Provenance {
        dataset: folder_name(Path::new(path)),
        file: file_name(path),
        format: format.to_owned(),
        take: stem(path),
        ..Provenance::default()
    }
}

/// Where a take of a file of many comes from: the file is the data set.
pub(super) fn of_data_set(path: &str, format: &str, take: &str) -> Provenance {
    Provenance { dataset: stem(path), take: take.to_owned(), ..of_file(path, format) }
}
