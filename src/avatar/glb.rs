//! Writes an avatar as binary glTF, readable by any viewer and, without loss, by [`super::load()`].
//!
//! One skinned mesh (level 0) with one primitive per [`Material`], named `gaitway.skin` and so on: the base colour
//! of the material is an example, the vertex colours are the avatar's. Glass has a primitive and a material of its own.

use super::{Avatar, Error, Material, Mesh};
use crate::file;
use crate::gait::{JOINT_COUNT, Joint};
use glam::Vec3;
use serde_json::{Value, json};
use std::path::Path;

/// Materials by name, with an example of the colour an agent may have there (linear).
pub(super) const MATERIALS: [(Material, &str, [f32; 3]); 5] = [
    (Material::Fixed, "gaitway.fixed", [1.0, 1.0, 1.0]),
    (Material::Skin, "gaitway.skin", [0.55, 0.31, 0.20]),
    (Material::Hair, "gaitway.hair", [0.06, 0.03, 0.02]),
    (Material::Top, "gaitway.top", [0.06, 0.20, 0.34]),
    (Material::Bottom, "gaitway.bottom", [0.10, 0.09, 0.12]),
];

const FLOAT: u32 = 5126;
const BYTE: u32 = 5121;
const INDEX: u32 = 5125;

/// Collects accessors over one buffer.
#[derive(Default)]
struct Buffer {
    bytes: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Buffer {
    /// Adds an accessor of `count` elements; returns its index.
    fn add(
        &mut self,
        bytes: &[u8],
        count: usize,
        component: u32,
        shape: &str,
        extra: &[(&str, Value)],
    ) -> usize {
        let offset = self.bytes.len();
        self.bytes.extend_from_slice(bytes);
        self.bytes.resize(self.bytes.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": bytes.len() }));
        let mut accessor = json!({ "bufferView": self.views.len() - 1, "componentType": component, "count": count, "type": shape });
        for (key, value) in extra {
            accessor[*key] = value.clone();
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    fn floats(&mut self, values: &[f32], width: usize, shape: &str, extra: &[(&str, Value)]) -> usize {
        self.add(bytemuck::cast_slice(values), values.len() / width, FLOAT, shape, extra)
    }
}

/// The avatar's finest level as a GLB file.
pub fn glb(avatar: &Avatar) -> Vec<u8> {
    let mut buffer = Buffer::default();
    let inverse: Vec<f32> =
        avatar.joints.iter().flat_map(|joint| joint.joint_from_mesh.to_cols_array()).collect();
    let inverse = buffer.floats(&inverse, 16, "MAT4", &[]);
    let empty = Mesh::default();
    let primitives = primitives(&mut buffer, avatar.levels.first().unwrap_or(&empty));
    let mut nodes: Vec<Value> = Joint::ALL.iter().map(|&joint| node(avatar, joint)).collect();
    nodes.push(json!({ "name": avatar.name, "mesh": 0, "skin": 0 }));
    let material = |(_, name, [r, g, b]): &(Material, &str, [f32; 3])| {
        let surface =
            json!({ "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.9 });
        json!({ "name": name, "pbrMetallicRoughness": surface })
    };
    let mut materials: Vec<Value> = MATERIALS.iter().map(material).collect();
    if primitives.iter().any(|primitive| primitive["material"].as_u64() >= Some(materials.len() as u64)) {
        materials.extend(MATERIALS.iter().map(material).map(|mut glass| {
            glass["alphaMode"] = json!("BLEND");
            glass
        }));
    }
    let joints: Vec<usize> = (0..JOINT_COUNT).collect();
    let document = json!({
        "asset": { "version": "2.0", "generator": concat!("gaitway ", env!("CARGO_PKG_VERSION")), "copyright": "CC0 1.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0, JOINT_COUNT] }],
        "nodes": nodes,
        "meshes": [{ "name": avatar.name, "primitives": primitives }],
        "skins": [{ "joints": joints, "skeleton": 0, "inverseBindMatrices": inverse }],
        "materials": materials,
        "buffers": [{ "byteLength": buffer.bytes.len() }],
        "bufferViews": buffer.views,
        "accessors": buffer.accessors,
    });
    pack(document.to_string().into_bytes(), &buffer.bytes)
}

/// Writes [`glb`] to a file; it appears under its name only when complete.
///
/// # Errors
/// [`Error::Write`] when the folder or file cannot be written.
pub fn write_glb(avatar: &Avatar, path: &Path) -> Result<(), Error> {
    file::write(path, &glb(avatar)).map_err(|source| Error::Write { path: path.to_owned(), source })
}

fn node(avatar: &Avatar, joint: Joint) -> Value {
    let rest = &avatar.joints[joint as usize];
    let children: Vec<usize> =
        (1..JOINT_COUNT).filter(|&child| Joint::PARENT[child] == joint as usize).collect();
    let name = if joint == Joint::Root { "hips" } else { joint.name() };
    let mut node = json!({
        "name": name,
        "translation": rest.translation.to_array(),
        "rotation": rest.rotation.to_array(),
    });
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

/// One primitive per material that has triangles, and one of its glass; each has its own vertices.
fn primitives(buffer: &mut Buffer, mesh: &Mesh) -> Vec<Value> {
    let mut primitives = Vec::new();
    let glass = MATERIALS.iter().map(|material| (material, true));
    let all = MATERIALS.iter().map(|material| (material, false)).chain(glass);
    for (index, ((material, ..), is_glass)) in all.enumerate() {
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
        let (least, most) = (json!(bound(Vec3::min)), json!(bound(Vec3::max)));
        let positions = buffer.floats(&vectors(|v| v.position), 3, "VEC3", &[("min", least), ("max", most)]);
        let normals = buffer.floats(&vectors(|v| v.normal), 3, "VEC3", &[]);
        let colors = if is_glass {
            let colors: Vec<f32> = vertices.iter().flat_map(|v| v.color.extend(v.alpha).to_array()).collect();
            buffer.floats(&colors, 4, "VEC4", &[])
        } else {
            buffer.floats(&vectors(|v| v.color), 3, "VEC3", &[])
        };
        let joints: Vec<u8> = vertices.iter().flat_map(|v| v.joints).collect();
        let joints = buffer.add(&joints, vertices.len(), BYTE, "VEC4", &[]);
        let weights: Vec<f32> = vertices.iter().flat_map(|v| v.weights).collect();
        let weights = buffer.floats(&weights, 4, "VEC4", &[]);
        let count = indices.len();
        let indices = buffer.add(bytemuck::cast_slice(&indices), count, INDEX, "SCALAR", &[]);
        primitives.push(json!({
            "attributes": {
                "POSITION": positions, "NORMAL": normals, "COLOR_0": colors, "JOINTS_0": joints, "WEIGHTS_0": weights
            },
            "indices": indices,
            "material": index,
        }));
    }
    primitives
}

/// The GLB container: header, JSON chunk padded with spaces, binary chunk padded with zeros.
fn pack(mut text: Vec<u8>, binary: &[u8]) -> Vec<u8> {
    text.resize(text.len().next_multiple_of(4), b' ');
    let word = |value: usize| u32::try_from(value).unwrap_or(u32::MAX).to_le_bytes();
    let padded = binary.len().next_multiple_of(4);
    let mut file = Vec::with_capacity(28 + text.len() + padded);
    file.extend_from_slice(b"glTF");
    file.extend_from_slice(&2_u32.to_le_bytes());
    file.extend_from_slice(&word(28 + text.len() + padded));
    file.extend_from_slice(&word(text.len()));
    file.extend_from_slice(b"JSON");
    file.extend_from_slice(&text);
    file.extend_from_slice(&word(padded));
    file.extend_from_slice(b"BIN\0");
    file.extend_from_slice(binary);
    file.resize(file.len() + padded - binary.len(), 0);
    file
}
