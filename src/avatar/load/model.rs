//! Models that are no characters: floors to walk on, carts and cars.

use super::super::{Error, Model};
use super::MOST_BYTES;
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
    let (name, source) = read(path)?;
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
    let world = source.nodes[part.node].world;
    let turn = Mat3::from_mat4(world);
    let upright = if turn.determinant().abs() > 1e-12 { turn.inverse().transpose() } else { turn };
    let first = u32::try_from(model.positions.len()).unwrap_or(u32::MAX);
    model.positions.extend(part.positions.iter().map(|p| world.transform_point3(*p)));
    model.colors.extend(part.colors.iter().map(|color| color.truncate()));
    let alpha = |corner: &u32| part.colors[*corner as usize].w;
    let is_solid = |t: &&[u32]| t.iter().map(alpha).sum::<f32>() >= 1.5;
    let start = model.indices.len();
    for t in part.indices.chunks_exact(3).filter(is_solid) {
        // a mirrored node turns its faces round
        let [b, c] = if turn.determinant() < 0.0 { [t[2], t[1]] } else { [t[1], t[2]] };
        model.indices.extend([t[0], b, c].map(|corner| first + corner));
    }
    match &part.normals {
        Some(normals) => model.normals.extend(normals.iter().map(|n| (upright * *n).normalize_or(Vec3::Y))),
        None => {
            let mut sums = vec![Vec3::ZERO; part.positions.len()];
            for t in model.indices[start..].chunks_exact(3) {
                let [a, b, c] = [0, 1, 2].map(|k| model.positions[t[k] as usize]);
                let normal = (b - a).cross(c - a); // as long as twice the area
                t.iter().for_each(|corner| sums[(corner - first) as usize] += normal);
            }
            model.normals.extend(sums.iter().map(|sum| sum.normalize_or(Vec3::Y)));
        }
    }
}

/// A file as plain data, and what errors call it.
fn read(path: &Path) -> Result<(String, Source), Error> {
    let read_error = |source| Error::Read { path: path.to_owned(), source };
    let name = path.display().to_string();
    let bytes = file::read(path, MOST_BYTES).map_err(read_error)?;
    let source = Source::read(&bytes, path.parent()).map_err(|fault| fault.of(&name))?;
    Ok((name, source))
}

/// All triangles of a model, or those of the nodes with that name and below them, where they stand in the scene: metres, y
/// up, front faces counter-clockwise.
///
/// # Errors
/// [`Error::Read`] when the file cannot be read; [`Error::Unusable`] when it is malformed or has no such node.
pub fn triangles(path: &Path, node: Option<&str>) -> Result<Vec<[Vec3; 3]>, Error> {
    let (name, source) = read(path)?;
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
