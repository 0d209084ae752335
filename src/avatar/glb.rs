//! Writes an avatar as binary glTF, readable by any viewer and, without loss, by [`super::load()`].
//!
//! One skinned mesh (level 0) with one primitive per [`Material`], named `gaitway.skin` and so on: the base colour
//! of the material is an example, the vertex colours are the avatar's. Glass has a primitive and a material of its own.

use super::{Avatar, Error, Material, Mesh};
use crate::file;
use crate::gait::Joint;
use crate::glb::{self, Kind, Writer};
use glam::Vec3;
use gltf_json::material::{self, AlphaMode, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::{Primitive, Semantic};
use gltf_json::scene::UnitQuaternion;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Node};
use std::path::Path;

/// Materials by name, with an example of the colour an agent may have there (linear).
pub(super) const MATERIALS: [(Material, &str, [f32; 3]); 5] = [
    (Material::Fixed, "gaitway.fixed", [1.0, 1.0, 1.0]),
    (Material::Skin, "gaitway.skin", [0.55, 0.31, 0.20]),
    (Material::Hair, "gaitway.hair", [0.06, 0.03, 0.02]),
    (Material::Top, "gaitway.top", [0.06, 0.20, 0.34]),
    (Material::Bottom, "gaitway.bottom", [0.10, 0.09, 0.12]),
];

/// The avatar's finest level as a GLB file.
pub fn glb(avatar: &Avatar) -> Vec<u8> {
    let mut writer = Writer::default();
    let inverse = avatar.joints.iter().flat_map(|joint| joint.joint_from_mesh.to_cols_array());
    let inverse = writer.floats(Kind::MAT4, inverse);
    let empty = Mesh::default();
    let primitives = primitives(&mut writer, avatar.levels.first().unwrap_or(&empty));
    let opaque = MATERIALS.len();
    let has_glass = primitives.iter().filter_map(|primitive| primitive.material).any(|m| m.value() >= opaque);
    writer.root.materials.extend(MATERIALS.map(|material| surface(material, AlphaMode::Opaque)));
    if has_glass {
        writer.root.materials.extend(MATERIALS.map(|material| surface(material, AlphaMode::Blend)));
    }
    writer.root.asset.copyright = Some("CC0 1.0".to_owned());
    let joints = Joint::ALL.map(|joint| node(avatar, joint)).to_vec();
    writer.figure(joints, &Joint::PARENT, inverse, glb::mesh(&avatar.name, primitives));
    writer.finish()
}

/// Writes [`glb()`] to a file; it appears under its name only when complete.
///
/// # Errors
/// [`Error::Write`] when the folder or file cannot be written.
pub fn write_glb(avatar: &Avatar, path: &Path) -> Result<(), Error> {
    file::write(path, &glb(avatar)).map_err(|source| Error::Write { path: path.to_owned(), source })
}

fn surface((_, name, [r, g, b]): (Material, &str, [f32; 3]), alpha: AlphaMode) -> material::Material {
    material::Material {
        name: Some(name.to_owned()),
        alpha_mode: Valid(alpha),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([r, g, b, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            roughness_factor: StrengthFactor(0.9),
            ..PbrMetallicRoughness::default()
        },
        ..material::Material::default()
    }
}

fn node(avatar: &Avatar, joint: Joint) -> Node {
    let rest = &avatar.joints[joint as usize];
    Node {
        name: Some(if joint == Joint::Root { "hips" } else { joint.name() }.to_owned()),
        translation: Some(rest.translation.to_array()),
        rotation: Some(UnitQuaternion(rest.rotation.to_array())),
        ..Node::default()
    }
}

/// One primitive per material that has triangles, and one of its glass; each has its own vertices.
fn primitives(writer: &mut Writer, mesh: &Mesh) -> Vec<Primitive> {
    let mut primitives = Vec::new();
    let glass = MATERIALS.iter().map(|material| (material, true));
    let all = MATERIALS.iter().map(|material| (material, false)).chain(glass);
    for (number, ((material, ..), is_glass)) in (0..).zip(all) {
        let vertex = |corner: &u32| mesh.vertices.get(*corner as usize);
        let own = |t: &&[u32]| {
            let has_alpha = t.iter().filter_map(vertex).any(|v| v.alpha < 1.0);
            has_alpha == is_glass && vertex(&t[0]).is_some_and(|v| v.material == *material)
        };
        let mut renamed = vec![u32::MAX; mesh.vertices.len()];
        let mut vertices = Vec::new();
        let mut indices: Vec<u32> = Vec::new();
        for &old in mesh.indices.chunks_exact(3).filter(own).flatten() {
            let slot = &mut renamed[old as usize];
            if *slot == u32::MAX {
                *slot = u32::try_from(vertices.len()).unwrap_or(u32::MAX);
                vertices.push(mesh.vertices[old as usize]);
            }
            indices.push(*slot);
        }
        if indices.is_empty() {
            continue;
        }
        let vectors = |of: fn(&super::Vertex) -> Vec3| -> Vec<f32> {
            vertices.iter().flat_map(|v| of(v).to_array()).collect()
        };
        let bound = |fold: fn(Vec3, Vec3) -> Vec3| {
            vertices.iter().map(|v| v.position).reduce(fold).unwrap_or_default().to_array()
        };
        let bounds = [bound(Vec3::min), bound(Vec3::max)];
        let positions = writer.bounded(Kind::VEC3, vectors(|v| v.position), bounds);
        let normals = writer.floats(Kind::VEC3, vectors(|v| v.normal));
        let colors = if is_glass {
            writer.floats(Kind::VEC4, vertices.iter().flat_map(|v| v.color.extend(v.alpha).to_array()))
        } else {
            writer.floats(Kind::VEC3, vectors(|v| v.color))
        };
        let attributes = [
            (Semantic::Positions, positions),
            (Semantic::Normals, normals),
            (Semantic::Colors(0), colors),
            (
                Semantic::Joints(0),
                writer.push(Kind::JOINTS, vertices.iter().flat_map(super::Vertex::driven_joints)),
            ),
            (Semantic::Weights(0), writer.floats(Kind::VEC4, vertices.iter().flat_map(|v| v.weights))),
        ];
        let indices = writer.push(Kind::INDEX, indices.iter().copied().flat_map(u32::to_le_bytes));
        primitives.push(glb::triangles(attributes, Some(indices), Index::new(number)));
    }
    primitives
}
