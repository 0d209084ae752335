//! Motion files in, [`Recording`]s out: BVH, ASF/AMC, C3D, TRC, `NumPy` arrays, CSV of joint positions, E-Gait.
//!
//! Every importer yields the 16 joints of [`Joint`](super::Joint) in metres, right-handed, y up, and writes into
//! [`Recording::report`] what it inferred or repaired. `parse_*` functions take text, so they can be tested
//! without files; [`import_file`] chooses by extension. Design: section 4; paper: S-01, S-02.
//!
//! Nothing is allocated beyond a small multiple of the text that is really there, whatever counts it claims.

#[doc(hidden)]
pub mod asf_amc;
#[doc(hidden)]
pub mod bvh;
#[doc(hidden)]
pub mod c3d;
#[doc(hidden)]
pub mod csv;
#[doc(hidden)]
pub mod egait;
pub mod folder;
mod gaps;
mod heading;
pub mod joint_map;
pub mod labels;
mod markers;
#[doc(hidden)]
#[cfg(feature = "import")]
pub mod npz;
mod points;
mod repair;
mod resample;
pub(crate) mod table;
mod text;
#[doc(hidden)]
pub mod trc;

use super::{Error, Provenance, Recording};
use crate::file;
pub use joint_map::JointMap;
use labels::Labels;
use std::path::{Path, PathBuf};
use text::list;

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

/// Reads all takes of a motion file: `.bvh`, `.amc` (with its `.asf`), `.c3d`, `.trc`, `.npz`, `.npy`, `.csv`, `.tsv` or `.txt`
/// of joint positions.
///
/// # Errors
/// [`Error::Read`] if the file cannot be read or is larger than [`MAX_BYTES`], [`Error::Syntax`] with file and
/// line if it is not what its format demands, [`Error::Unusable`] if its motion is not that of a body; as
/// [`Labels::beside`] for the tables of labels beside it.
pub fn import_file(path: &Path) -> Result<Vec<Recording>, Error> {
    import_file_with(path, &Options::default())
}

/// [`import_file`] with what the caller knows.
///
/// # Errors
/// As [`import_file`].
pub fn import_file_with(path: &Path, options: &Options) -> Result<Vec<Recording>, Error> {
    // the file is read before its tables, so that its own error comes first
    let takes = takes(path, options)?;
    labelled(path, takes, options, &Labels::beside(&[path])?)
}

/// [`import_file_with`] for one of many files, with the tables beside them, which were read before.
///
/// # Errors
/// As [`import_file`], but for the tables.
pub fn import_labelled(path: &Path, options: &Options, labels: &Labels) -> Result<Vec<Recording>, Error> {
    labelled(path, takes(path, options)?, options, labels)
}

/// The takes with what the tables say about them, at the wanted rate.
fn labelled(
    path: &Path,
    mut takes: Vec<Recording>,
    options: &Options,
    labels: &Labels,
) -> Result<Vec<Recording>, Error> {
    labels.apply(path, &mut takes);
    // a path such as "walk.bvh" does not name its folder
    for take in takes.iter_mut().filter(|take| take.provenance.dataset.is_empty()) {
        take.provenance.dataset =
            std::fs::canonicalize(path).map_or_else(|_| String::new(), |p| folder_name(&p));
    }
    match options.resample {
        Some(hertz) => takes.into_iter().map(|take| take.resampled(hertz)).collect(),
        None => Ok(takes),
    }
}

/// The takes of a file, as the file has them.
fn takes(path: &Path, options: &Options) -> Result<Vec<Recording>, Error> {
    let shown = path.display().to_string();
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).unwrap_or_default();
    Ok(match extension.as_str() {
        "bvh" => vec![bvh::parse_bvh(&read(path)?, &shown, options)?],
        "amc" => {
            let skeleton = match &options.skeleton {
                Some(given) => given.clone(),
                None => asf_amc::skeleton_beside(path)?,
            };
            let skeleton = asf_amc::parse_asf(&read(&skeleton)?, &skeleton.display().to_string())?;
            vec![asf_amc::parse_amc(&read(path)?, &shown, &skeleton, options)?]
        }
        "asf" => {
            let message = "a skeleton without motion; import the .amc, its .asf is found beside it";
            return Err(text::syntax(&shown, 0, message));
        }
        "csv" | "txt" | "tsv" => csv::parse_csv(&read(path)?, &shown, options)?,
        "trc" => trc::parse_trc(&read(path)?, &shown, options)?,
        "c3d" => c3d::parse_c3d(&read_bytes(path)?, &shown, options)?,
        #[cfg(feature = "import")]
        "npz" => npz::parse_npz(&read_bytes(path)?, &shown, options)?,
        #[cfg(feature = "import")]
        "npy" => npz::parse_npy(&read_bytes(path)?, &shown, options)?,
        #[cfg(not(feature = "import"))]
        "npz" | "npy" => {
            return Err(text::syntax(
                &shown,
                0,
                "this build reads no NumPy files: build it with the feature `import`",
            ));
        }
        "h5" | "hdf5" => {
            let message = "HDF5 is not read; turn it into .npz with three lines of Python: import h5py, numpy; \
                           f = h5py.File(\"features.h5\"); \
                           numpy.savez_compressed(\"features.npz\", **{k: f[k][:] for k in f})";
            return Err(text::syntax(&shown, 0, message));
        }
        other => {
            let message = format!("unknown extension {other:?}; known are {}", list(&EXTENSIONS));
            return Err(text::syntax(&shown, 0, message));
        }
    })
}

/// Reads a text file within [`MAX_BYTES`]; bytes that are not UTF-8 (names in old code pages) are replaced.
pub(crate) fn read(path: &Path) -> Result<String, Error> {
    Ok(match String::from_utf8(read_bytes(path)?) {
        Ok(text) => text,
        Err(error) => String::from_utf8_lossy(error.as_bytes()).into_owned(),
    })
}

/// Reads a file within [`MAX_BYTES`].
fn read_bytes(path: &Path) -> Result<Vec<u8>, Error> {
    file::read(path, MAX_BYTES).map_err(|source| Error::Read { path: path.to_owned(), source })
}

/// File name without folder and extension; names recordings.
fn stem(path: &str) -> String {
    Path::new(path).file_stem().map_or_else(|| path.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// File name without folder; names sources.
fn file_name(path: &str) -> String {
    Path::new(path).file_name().map_or_else(|| path.to_owned(), |s| s.to_string_lossy().into_owned())
}

/// Name of the folder that a file is in; empty if the path does not say.
fn folder_name(path: &Path) -> String {
    path.parent().and_then(Path::file_name).map_or_else(String::new, |s| s.to_string_lossy().into_owned())
}

/// Where the only take of a file comes from: its folder is the data set.
fn of_file(path: &str, format: &str) -> Provenance {
    Provenance {
        dataset: folder_name(Path::new(path)),
        file: file_name(path),
        format: format.to_owned(),
        take: stem(path),
        ..Provenance::default()
    }
}

/// Where a take of a file of many comes from: the file is the data set.
fn of_data_set(path: &str, format: &str, take: &str) -> Provenance {
    Provenance { dataset: stem(path), take: take.to_owned(), ..of_file(path, format) }
}
