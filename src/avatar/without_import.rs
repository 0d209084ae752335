//! A build without the feature `import` reads no characters and models.

use super::rig_map::RigMap;
use super::{Avatar, Error, Loaded, Model, PlaceModel};
use glam::Vec3;
use std::path::Path;

/// Loads a character; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub fn load(path: &Path) -> Result<Avatar, Error> {
    Err(refused(&path.display().to_string()))
}

/// Loads a character with joint names given by a map; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub fn load_with_map(path: &Path, _: &RigMap) -> Result<Loaded, Error> {
    Err(refused(&path.display().to_string()))
}

/// Loads a character from the bytes of a file; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub fn load_bytes(name: &str, _: &[u8], _: Option<&Path>, _: &RigMap) -> Result<Loaded, Error> {
    Err(refused(name))
}

/// Reads a model; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub fn model(path: &Path) -> Result<Model, Error> {
    Err(refused(&path.display().to_string()))
}

/// Reads a place; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub(crate) fn place(path: &Path) -> Result<PlaceModel, Error> {
    Err(refused(&path.display().to_string()))
}

/// The triangles of a model; not in this build.
///
/// # Errors
/// [`Error::Unusable`].
pub fn triangles(path: &Path, _: Option<&str>) -> Result<Vec<[Vec3; 3]>, Error> {
    Err(refused(&path.display().to_string()))
}

fn refused(name: &str) -> Error {
    let message = "this build reads no glTF: build it with the feature `import`";
    Error::Unusable { name: name.to_owned(), message: message.to_owned() }
}
