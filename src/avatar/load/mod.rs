//! Loads rigged glTF 2.0, GLB and VRM (0.x, 1.0) humanoids and reduces them to the 16 driven joints.
//!
//! The file is read into plain checked data ([`source`]), its joints are recognised ([`rig`]), and everything is
//! brought to our rest pose ([`reduce`]): metres, y up, facing +z, feet at y = 0, all joint axes along the model's.
//! What was inferred on the way is reported line by line (U-04).

mod accessor;
mod expressions;
mod fault;
mod guess;
mod model;
mod outside;
mod packed;
mod paint;
mod place;
mod placement;
mod reduce;
mod rig;
mod simplify;
mod source;
mod stature;
mod surface;
mod textured;

use super::rig_map::RigMap;
use super::{Avatar, Error, Loaded};
use crate::file;
use fault::{Fault, MOST_BYTES};
pub use model::{model, triangles};
pub(crate) use place::place;
use std::path::Path;

/// Loads a character from a `.glb`, `.gltf` or `.vrm` file.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Unusable`] when it is malformed; [`Error::Packed`] when an
/// extension packs it; [`Error::Rig`], with a map to fill in, when its joints are not recognised.
pub fn load(path: &Path) -> Result<Avatar, Error> {
    load_with_map(path, &RigMap::default()).map(|loaded| loaded.avatar)
}

/// Loads a character with joint names given by `map` (those it leaves out are found as usual), and reports.
///
/// # Errors
/// As [`load`]; also when the map names a node that the file does not have.
pub fn load_with_map(path: &Path, map: &RigMap) -> Result<Loaded, Error> {
    let read_error = |source| Error::Read { path: path.to_owned(), source };
    let name =
        path.file_stem().map_or_else(|| path.display().to_string(), |s| s.to_string_lossy().into_owned());
    let bytes = file::read(path, MOST_BYTES).map_err(read_error)?;
    load_bytes(&name, &bytes, path.parent(), map)
}

/// Loads a character from the bytes of a file; `base` is where files that it names lie.
///
/// # Errors
/// [`Error::Unusable`], as [`load`].
pub fn load_bytes(name: &str, bytes: &[u8], base: Option<&Path>, map: &RigMap) -> Result<Loaded, Error> {
    let mut source = source::Source::read_character(bytes, base).map_err(|fault| fault.of(name))?;
    let avatar = reduce::reduce(name, &mut source, map).map_err(|fault| fault.of(name))?;
    Ok(Loaded { avatar, report: source.report })
}
