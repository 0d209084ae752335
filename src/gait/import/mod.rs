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
mod options;
mod points;
mod repair;
mod resample;
mod text;
#[doc(hidden)]
pub mod trc;

use super::{Error, Recording};
pub use joint_map::JointMap;
use labels::Labels;
pub(crate) use options::read;
pub use options::{EXTENSIONS, MAX_BYTES, MAX_FRAMES, MAX_JOINTS, Options};
use options::{folder_name, of_data_set, of_file, read_bytes, stem};
use std::path::Path;
use text::list;

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
