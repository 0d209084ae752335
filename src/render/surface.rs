//! The environment: coloured triangles that do not move.

use super::Error;
use crate::scenario::{EnvironmentMesh, SurfaceMaterial};
use glam::Vec3;

/// A coloured triangle mesh in the world, metres, y up; triangles wind counter-clockwise seen from outside.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Position of each vertex, m.
    pub positions: &'a [Vec3],
    /// Unit normal of each vertex.
    pub normals: &'a [Vec3],
    /// Linear colour of each vertex, 0 to 1; what is above 1 glows.
    pub colors: &'a [Vec3],
    /// Of what lies flat, the layer of each vertex, see [`crate::scenario::EnvironmentMesh::layers`]; empty: nothing does.
    pub layers: &'a [u8],
    /// What each vertex is made of; empty: [`SurfaceMaterial::Plain`].
    pub materials: &'a [SurfaceMaterial],
    /// Three indices per triangle.
    pub indices: &'a [u32],
}

/// The surface of a scene.
pub(super) fn surface(scenery: &EnvironmentMesh) -> Surface<'_> {
    Surface {
        positions: &scenery.positions,
        normals: &scenery.normals,
        colors: &scenery.colors,
        layers: &scenery.layers,
        materials: &scenery.materials,
        indices: &scenery.indices,
    }
}

/// Position with layer, normal and colour with material of a vertex, as `shaders/draw/environment.wgsl` reads them.
pub(crate) type PackedVertex = [[f32; 4]; 3];

/// Light of a lamp behind a pane, linear.
const LAMP: Vec3 = Vec3::new(0.8, 0.42, 0.12);

/// Colour of a vertex where lamps have a share of their light: what is above 1 glows, more behind brighter panes.
fn lit(color: Vec3, material: SurfaceMaterial, lamps: f32) -> Vec3 {
    if material != SurfaceMaterial::LitPane {
        return color;
    }
    let glow = LAMP * (0.6 + 5.0 * color.y).min(1.2);
    color.lerp(Vec3::ONE + glow, lamps)
}

/// One list of vertices and one of indices for several surfaces; lamps behind their panes have a share of their light, 0 to 1.
///
/// # Errors
/// When the lists of a surface differ in length, an index points past them, or a triangle is not whole.
pub(crate) fn pack(surfaces: &[Surface<'_>], lamps: f32) -> Result<(Vec<PackedVertex>, Vec<u32>), Error> {
    let (mut vertices, mut indices) = (Vec::new(), Vec::new());
    for (number, surface) in surfaces.iter().enumerate() {
        let count = surface.positions.len();
        for (found, what) in [(surface.layers.len(), "layers"), (surface.materials.len(), "materials")] {
            if found > 0 && found != count {
                return Err(Error::Mesh(format!(
                    "surface {number} has {count} positions, but {found} {what}"
                )));
            }
        }
        if surface.normals.len() != count || surface.colors.len() != count {
            return Err(Error::Mesh(format!(
                "surface {number} has {count} positions, {} normals and {} colours; it needs one of each per vertex",
                surface.normals.len(),
                surface.colors.len()
            )));
        }
        if !surface.indices.len().is_multiple_of(3) {
            let found = surface.indices.len();
            return Err(Error::Mesh(format!("surface {number} has {found} indices; a triangle has three")));
        }
        if let Some(index) = surface.indices.iter().find(|index| **index as usize >= count) {
            return Err(Error::Mesh(format!(
                "surface {number}: index {index}, but there are {count} vertices"
            )));
        }
        let first = u32::try_from(vertices.len())
            .map_err(|error| Error::Mesh(format!("{} vertices: {error}", vertices.len())))?;
        let layers = surface.layers.iter().copied().chain(std::iter::repeat(0));
        let materials = surface.materials.iter().copied().chain(std::iter::repeat(SurfaceMaterial::Plain));
        let parts = surface.positions.iter().zip(surface.normals).zip(surface.colors);
        vertices.extend(parts.zip(layers.zip(materials)).map(|(((p, n), c), (layer, material))| {
            [
                p.extend(f32::from(layer)),
                n.extend(0.0),
                lit(*c, material, lamps).extend(f32::from(material as u8)),
            ]
            .map(|v| v.to_array())
        }));
        indices.extend(surface.indices.iter().map(|index| first + index));
    }
    Ok((vertices, indices))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn surfaces_are_joined_and_wrong_ones_refused_with_the_place() {
        let (three, four) = ([Vec3::X, Vec3::Y, Vec3::Z], [Vec3::ONE; 4]);
        let good = Surface {
            positions: &three,
            normals: &three,
            colors: &three,
            layers: &[],
            materials: &[],
            indices: &[0, 1, 2],
        };
        let (vertices, indices) = pack(&[good, Surface { layers: &[0, 0, 0], ..good }], 0.0).unwrap();
        assert_eq!(indices, [0, 1, 2, 3, 4, 5]);
        assert_eq!(vertices[4], [[0.0, 1.0, 0.0, 0.0]; 3]);
        let message = |surface| pack(&[good, surface], 0.0).unwrap_err().to_string();
        assert!(
            message(Surface { colors: &four, ..good }).contains("surface 1 has 3 positions, 3 normals and 4")
        );
        assert!(message(Surface { indices: &[0, 1], ..good }).contains("2 indices"));
        assert!(message(Surface { indices: &[0, 1, 3], ..good }).contains("index 3"));
        assert!(message(Surface { layers: &[1], ..good }).contains("1 layers"));
        let (flat, _) = pack(&[Surface { layers: &[2, 2, 2], ..good }], 0.0).unwrap();
        assert_eq!(flat[0][0].map(f32::to_bits), [1.0_f32, 0.0, 0.0, 2.0].map(f32::to_bits));
        assert!(message(Surface { materials: &[SurfaceMaterial::Glass], ..good }).contains("1 materials"));
        let (glass, _) = pack(&[Surface { materials: &[SurfaceMaterial::Glass; 3], ..good }], 1.0).unwrap();
        assert_eq!(glass[1][2].map(f32::to_bits), [0.0_f32, 1.0, 0.0, 11.0].map(f32::to_bits));
        assert!(pack(&[], 0.0).unwrap().0.is_empty());
    }

    #[test]
    fn panes_with_a_lamp_behind_glow_when_it_burns() {
        let three = [Vec3::X, Vec3::Y, Vec3::Z];
        let color_of = |material, lamps| {
            let surface = Surface {
                positions: &three,
                normals: &three,
                colors: &three,
                layers: &[],
                materials: &[material; 3],
                indices: &[0, 1, 2],
            };
            pack(&[surface], lamps).unwrap().0[2][2]
        };
        let [pane, lit] = [SurfaceMaterial::Pane, SurfaceMaterial::LitPane];
        assert_eq!(color_of(pane, 1.0).map(f32::to_bits), [0.0_f32, 0.0, 1.0, 16.0].map(f32::to_bits));
        assert_eq!(color_of(lit, 0.0).map(f32::to_bits), [0.0_f32, 0.0, 1.0, 17.0].map(f32::to_bits));
        let [low, high] = [0.5, 1.0].map(|lamps| color_of(lit, lamps));
        assert!(high[0] > high[1] && high[1] > high[2] && high[2] > 1.0, "{high:?}: warm");
        assert!(low[0] < high[0] && low[0] > 0.5, "{low:?}");
    }
}
