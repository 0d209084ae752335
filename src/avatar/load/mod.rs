//! Loads rigged glTF 2.0, GLB and VRM (0.x, 1.0) humanoids and reduces them to the 16 driven joints.
//!
//! The file is read into plain checked data ([`source`]), its joints are recognised ([`rig`]), and everything is
//! brought to our rest pose ([`reduce`]): metres, y up, facing +z, feet at y = 0, all joint axes along the model's.
//! What was inferred on the way is reported line by line (U-04).

mod accessor;
mod reduce;
mod rig;
mod simplify;
mod source;

use super::rig_map::RigMap;
use super::{Avatar, Error};
use std::path::Path;

/// Largest file read, bytes.
const MOST_BYTES: u64 = 512 << 20;

/// A loaded character and what was inferred about it.
#[derive(Debug, Clone, PartialEq)]
pub struct Loaded {
    /// The character.
    pub avatar: Avatar,
    /// One line per inference or repair: joint map, unit, facing, rest pose, what was left out.
    pub report: Vec<String>,
}

/// Loads a character from a `.glb`, `.gltf` or `.vrm` file.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Unusable`] when it is malformed or no humanoid, with
/// the reason and the way out.
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
    let length = std::fs::metadata(path).map_err(read_error)?.len();
    if length > MOST_BYTES {
        return Err(Error::Unusable {
            name,
            message: format!("the file has {length} bytes; characters of up to {MOST_BYTES} bytes are read"),
        });
    }
    let bytes = std::fs::read(path).map_err(read_error)?;
    load_bytes(&name, &bytes, path.parent(), map)
}

/// All triangles of a model, or those of the nodes with that name and below them, where they stand in the scene: metres, y
/// up, front faces counter-clockwise.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Unusable`] when it is malformed or has no such node.
pub fn triangles(path: &Path, node: Option<&str>) -> Result<Vec<[glam::Vec3; 3]>, Error> {
    let read_error = |source| Error::Read { path: path.to_owned(), source };
    let name = path.display().to_string();
    let unusable = |message: String| Error::Unusable { name: name.clone(), message };
    let length = std::fs::metadata(path).map_err(read_error)?.len();
    if length > MOST_BYTES {
        return Err(unusable(format!(
            "the file has {length} bytes; models of up to {MOST_BYTES} bytes are read"
        )));
    }
    let bytes = std::fs::read(path).map_err(read_error)?;
    let source = source::Source::read(&bytes, path.parent()).map_err(unusable)?;
    let is_wanted = |start: usize| {
        let mut above = Some(start);
        node.is_none_or(|wanted| {
            while let Some(at) = above {
                if source.nodes[at].name == wanted {
                    return true;
                }
                above = source.nodes[at].parent; // no loops: the reader has refused them
            }
            false
        })
    };
    if let Some(wanted) = node.filter(|wanted| !source.nodes.iter().any(|node| node.name == **wanted)) {
        let names: Vec<&str> = source.nodes.iter().map(|node| node.name.as_str()).take(12).collect();
        return Err(unusable(format!("has no node {wanted:?}; there are {}", names.join(", "))));
    }
    let mut all = Vec::new();
    for part in source.parts.iter().filter(|part| is_wanted(part.node)) {
        let world = source.nodes[part.node].world;
        let corner = |index: u32| world.transform_point3(part.positions[index as usize]);
        let turns = world.determinant() < 0.0; // a mirrored node turns its faces round
        all.extend(part.indices.chunks_exact(3).map(|t| {
            let [a, b, c] = [corner(t[0]), corner(t[1]), corner(t[2])];
            if turns { [a, c, b] } else { [a, b, c] }
        }));
    }
    Ok(all)
}

/// Loads a character from the bytes of a file; `base` is where files that it names lie.
///
/// # Errors
/// [`Error::Unusable`], as [`load`].
pub fn load_bytes(name: &str, bytes: &[u8], base: Option<&Path>, map: &RigMap) -> Result<Loaded, Error> {
    let unusable = |message: String| Error::Unusable { name: name.to_owned(), message };
    let mut source = source::Source::read(bytes, base).map_err(unusable)?;
    let avatar = reduce::reduce(name, &mut source, map).map_err(unusable)?;
    Ok(Loaded { avatar, report: source.report })
}
