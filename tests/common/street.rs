//! A street as a user would bring it: a GLB with materials, textures, a wall with holes and a mirrored node.
#![allow(clippy::unwrap_used, reason = "a test")]

use super::glb;
use gaitway::render::Image;
use serde_json::{Value, json};

/// Half of its ground's side, m.
pub(crate) const REACH: f32 = 20.0;
/// Colours of the squares of half a metre on its ground, sRGB.
pub(crate) const SQUARES: [[u8; 4]; 2] = [[200, 60, 50, 255], [40, 70, 190, 255]];

/// The document while it is made.
#[derive(Default)]
struct Document {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    meshes: Vec<Value>,
    nodes: Vec<Value>,
    images: Vec<Value>,
}

impl Document {
    fn view(&mut self, bytes: &[u8]) -> usize {
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        self.views.push(json!({ "buffer": 0, "byteOffset": self.binary.len(), "byteLength": bytes.len() }));
        self.binary.extend(bytes);
        self.views.len() - 1
    }

    fn floats(&mut self, kind: &str, values: &[f32]) -> usize {
        let bytes: Vec<u8> = values.iter().flat_map(|value| value.to_le_bytes()).collect();
        let view = self.view(&bytes);
        let each = if kind == "VEC2" { 2 } else { 3 };
        let extreme = |pick: fn(f32, f32) -> f32| -> Vec<f32> {
            (0..each).map(|c| values.iter().skip(c).step_by(each).copied().reduce(pick).unwrap()).collect()
        };
        self.accessors.push(json!({
            "bufferView": view, "componentType": 5126, "count": values.len() / each, "type": kind,
            "min": extreme(f32::min), "max": extreme(f32::max),
        }));
        self.accessors.len() - 1
    }

    fn image(&mut self, image: &Image) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.png");
        gaitway::export::image::write_png(&path, image).unwrap();
        let view = self.view(&std::fs::read(path).unwrap());
        self.images.push(json!({ "bufferView": view, "mimeType": "image/png" }));
    }

    /// A node with a mesh of quads, whose corners go counter-clockwise seen from the front. Textures span `tiles` along each side.
    fn quads(&mut self, name: &str, material: usize, quads: &[[[f32; 3]; 4]], tiles: f32) -> &mut Value {
        let mut positions = Vec::new();
        let mut uv = Vec::new();
        for quad in quads {
            for corner in [0, 1, 2, 0, 2, 3] {
                positions.extend(quad[corner]);
                uv.extend([[0.0, tiles], [tiles, tiles], [tiles, 0.0], [0.0, 0.0]][corner]);
            }
        }
        let (positions, uv) = (self.floats("VEC3", &positions), self.floats("VEC2", &uv));
        let attributes = json!({ "POSITION": positions, "TEXCOORD_0": uv });
        self.meshes.push(json!({ "primitives": [{ "attributes": attributes, "material": material }] }));
        self.nodes.push(json!({ "name": name, "mesh": self.meshes.len() - 1 }));
        self.nodes.last_mut().unwrap()
    }

    fn file(self, materials: &Value) -> Vec<u8> {
        let textures: Vec<Value> = (0..self.images.len()).map(|image| json!({ "source": image })).collect();
        let nodes: Vec<usize> = (0..self.nodes.len()).collect();
        let json = json!({
            "asset": { "version": "2.0" },
            "buffers": [{ "byteLength": self.binary.len() }],
            "bufferViews": self.views,
            "accessors": self.accessors,
            "meshes": self.meshes,
            "nodes": self.nodes,
            "scenes": [{ "nodes": nodes }],
            "scene": 0,
            "images": self.images,
            "textures": textures,
            "materials": materials,
        });
        glb::file(json.to_string(), self.binary)
    }
}

/// The sides and the top of a box.
fn block(low: [f32; 3], high: [f32; 3]) -> Vec<[[f32; 3]; 4]> {
    let [[a, b, c], [x, y, z]] = [low, high];
    vec![
        [[a, b, z], [x, b, z], [x, y, z], [a, y, z]],
        [[x, b, c], [a, b, c], [a, y, c], [x, y, c]],
        [[x, b, z], [x, b, c], [x, y, c], [x, y, z]],
        [[a, b, c], [a, b, z], [a, y, z], [a, y, c]],
        [[a, y, z], [x, y, z], [x, y, c], [a, y, c]],
    ]
}

/// The street: ground of coloured squares; a grey house of 4 by 4 by 5 m about (6, 6); about (-6, 0) a fence of 4 m along x, of
/// whose texture every second half metre is a hole; a white board on a mirrored node at (0, 1, -8), which faces +z; about (-8, 10) a
/// block of smooth metal. The house's normals lean to the left and up, by a map.
pub(crate) fn street() -> Vec<u8> {
    let mut document = Document::default();
    let mut squares = Image::filled(64, 64, SQUARES[0]);
    squares.fill(32, 0, 32, 32, SQUARES[1]);
    squares.fill(0, 32, 32, 32, SQUARES[1]);
    document.image(&squares);
    let mut fence = Image::filled(32, 32, [30, 160, 60, 255]);
    fence.fill(0, 0, 16, 32, [30, 160, 60, 0]);
    document.image(&fence);
    // normals that lean to the left and up
    document.image(&Image::filled(4, 4, [60, 170, 220, 255]));
    document.image(&Image::filled(4, 4, [255, 20, 255, 255])); // smooth metal
    let r = REACH;
    // squares of half a metre: a texture of two by two of them every metre, from the corner (-r, r) on
    document.quads("Ground", 0, &[[[-r, 0.0, r], [r, 0.0, r], [r, 0.0, -r], [-r, 0.0, -r]]], 2.0 * r);
    document.quads("House", 1, &block([4.0, 0.0, 4.0], [8.0, 5.0, 8.0]), 1.0);
    document.quads(
        "Fence",
        2,
        &[[[-8.0, 0.0, 0.0], [-4.0, 0.0, 0.0], [-4.0, 4.0, 0.0], [-8.0, 4.0, 0.0]]],
        4.0,
    );
    let board = [[-1.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [-1.0, 1.0, 0.0]];
    // mirrored by z, it faces +z only if it faces -z in the mesh
    let turned = [board[1], board[0], board[3], board[2]];
    let node = document.quads("Board", 3, &[turned], 1.0);
    node["translation"] = json!([0.0, 1.0, -8.0]);
    node["scale"] = json!([1.0, 1.0, -1.0]);
    document.quads("Plate", 4, &block([-9.0, 0.0, 9.0], [-7.0, 2.0, 11.0]), 1.0);
    let texture = |index: usize| json!({ "index": index });
    let materials = json!([
        { "pbrMetallicRoughness": { "baseColorTexture": texture(0), "metallicFactor": 0.0 } },
        { "pbrMetallicRoughness": { "baseColorFactor": [0.5, 0.5, 0.5, 1.0], "metallicFactor": 0.0 }, "normalTexture": texture(2) },
        { "pbrMetallicRoughness": { "baseColorTexture": texture(1), "metallicFactor": 0.0 }, "alphaMode": "MASK", "doubleSided": true },
        { "pbrMetallicRoughness": { "metallicFactor": 0.0 } },
        { "pbrMetallicRoughness": { "metallicRoughnessTexture": texture(3) }, "occlusionTexture": texture(3) },
    ]);
    document.file(&materials)
}
