//! Models that are no characters: floors to walk on, carts and cars.

use super::super::{Error, Model};
use super::fault::{Fault, MOST_BYTES};
use super::source::{Part, Source};
use crate::file;
use glam::{Mat3, Vec3};
use std::path::Path;

/// Reads a model; what is more glass than not is left out.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Packed`] and [`Error::Unusable`] when it is packed, malformed or
/// has no triangles.
pub fn model(path: &Path) -> Result<Model, Error> {
    let (name, source) = read(path, Source::read)?;
    let mut model = Model::default();
    for part in &source.parts {
        add(&mut model, &source, part);
    }
    if model.indices.is_empty() {
        return Err(Error::Unusable { name, message: "the model has no triangles".to_owned() });
    }
    Ok(model)
}

fn add(model: &mut Model, source: &Source, part: &Part) {
    let alpha = |corner: &u32| part.colors[*corner as usize].w;
    let stands = Standing::of(source, part, |t| t.iter().map(alpha).sum::<f32>() >= 1.5);
    let first = u32::try_from(model.positions.len()).unwrap_or(u32::MAX);
    model.positions.extend(stands.positions);
    model.normals.extend(stands.normals);
    model.colors.extend(part.colors.iter().map(|color| color.truncate()));
    model.indices.extend(stands.triangles.iter().flatten().map(|corner| first + corner));
}

/// A part where it stands in its scene.
pub(super) struct Standing {
    pub(super) positions: Vec<Vec3>,
    /// Of unit length; without any in the file the mean of the triangles', by area.
    pub(super) normals: Vec<Vec3>,
    pub(super) triangles: Vec<[u32; 3]>,
}

impl Standing {
    /// The triangles of a part that are there.
    pub(super) fn of(source: &Source, part: &Part, is_there: impl Fn(&[u32]) -> bool) -> Self {
        let world = source.nodes[part.node].world;
        let turn = Mat3::from_mat4(world);
        let positions: Vec<Vec3> = part.positions.iter().map(|p| world.transform_point3(*p)).collect();
        let is_mirrored = turn.determinant() < 0.0; // a mirrored node turns its faces round
        let turned = |t: &[u32]| if is_mirrored { [t[0], t[2], t[1]] } else { [t[0], t[1], t[2]] };
        let triangles: Vec<[u32; 3]> =
            part.indices.chunks_exact(3).filter(|t| is_there(t)).map(turned).collect();
        let normals = if let Some(normals) = &part.normals {
            let upright = if turn.determinant().abs() > 1e-12 { turn.inverse().transpose() } else { turn };
            normals.iter().map(|n| (upright * *n).normalize_or(Vec3::Y)).collect()
        } else {
            let mut sums = vec![Vec3::ZERO; positions.len()];
            for t in &triangles {
                let [a, b, c] = t.map(|corner| positions[corner as usize]);
                let normal = (b - a).cross(c - a); // as long as twice the area
                t.iter().for_each(|corner| sums[*corner as usize] += normal);
            }
            sums.iter().map(|sum| sum.normalize_or(Vec3::Y)).collect()
        };
        Self { positions, normals, triangles }
    }
}

/// A file as plain data, read so from its bytes, with its folder; and what errors call it.
pub(super) fn read(
    path: &Path,
    of: impl Fn(&[u8], Option<&Path>) -> Result<Source, Fault>,
) -> Result<(String, Source), Error> {
    let read_error = |source| Error::Read { path: path.to_owned(), source };
    let name = path.display().to_string();
    let bytes = file::read(path, MOST_BYTES).map_err(read_error)?;
    let source = of(&bytes, path.parent()).map_err(|fault| fault.of(&name))?;
    Ok((name, source))
}

/// All triangles of a model, or those of the nodes with that name and below them, where they stand in the scene: metres, y
/// up, front faces counter-clockwise.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Unusable`] when it is malformed or has no such node.
pub fn triangles(path: &Path, node: Option<&str>) -> Result<Vec<[Vec3; 3]>, Error> {
    let (name, source) = read(path, Source::read)?;
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
        let message = format!("has no node {wanted:?}; there are {}", names.join(", "));
        return Err(Error::Unusable { name, message });
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
