//! A character as a user would bring it: the GLB of one of our own, with textures.
#![allow(clippy::unwrap_used, reason = "a test")]

use super::glb;
use gaitway::render::Image;
use serde_json::{Value, json};

/// Tiles of a texture a metre, across and up the body.
pub(crate) const TILES: f32 = 4.0;

/// The file with these images, as textures of the same numbers, and coordinates by which they lie flat before the body; `edit`
/// changes the document.
pub(crate) fn textured(file: &[u8], images: &[Image], edit: impl Fn(&mut Value)) -> Vec<u8> {
    let (json, mut binary) = glb::parts(file);
    let mut json: Value = serde_json::from_slice(&json).unwrap();
    let view = |json: &mut Value, binary: &mut Vec<u8>, bytes: &[u8]| {
        binary.resize(binary.len().next_multiple_of(4), 0);
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        binary.extend(bytes);
        views.len() - 1
    };
    for primitive in 0..json["meshes"][0]["primitives"].as_array().unwrap().len() {
        let positions = json["meshes"][0]["primitives"][primitive]["attributes"]["POSITION"].clone();
        let positions = json["accessors"][index(&positions)].clone();
        let count = index(&positions["count"]);
        let place = &json["bufferViews"][index(&positions["bufferView"])]["byteOffset"];
        let from = index(place) + index(&positions["byteOffset"]);
        let number = |at: usize| f32::from_le_bytes(binary[from + 4 * at..][..4].try_into().unwrap());
        let uv: Vec<u8> = (0..count)
            .flat_map(|vertex| [TILES * number(3 * vertex), -TILES * number(3 * vertex + 1)])
            .flat_map(f32::to_le_bytes)
            .collect();
        let view = view(&mut json, &mut binary, &uv);
        let accessors = json["accessors"].as_array_mut().unwrap();
        accessors.push(json!({ "bufferView": view, "componentType": 5126, "count": count, "type": "VEC2" }));
        let number = accessors.len() - 1;
        json["meshes"][0]["primitives"][primitive]["attributes"]["TEXCOORD_0"] = number.into();
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("image.png");
    let (mut all, mut textures) = (Vec::new(), Vec::new());
    for (number, image) in images.iter().enumerate() {
        gaitway::export::image::write_png(&path, image).unwrap();
        let view = view(&mut json, &mut binary, &std::fs::read(&path).unwrap());
        all.push(json!({ "bufferView": view, "mimeType": "image/png" }));
        textures.push(json!({ "source": number }));
        std::fs::remove_file(&path).unwrap();
    }
    (json["images"], json["textures"]) = (all.into(), textures.into());
    binary.resize(binary.len().next_multiple_of(4), 0);
    json["buffers"][0]["byteLength"] = binary.len().into();
    edit(&mut json);
    glb::file(json.to_string(), binary)
}

/// A number of the document; 0 where it gives none.
fn index(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap_or(0)).unwrap()
}

/// Squares of both colours, two by two in a tile.
pub(crate) fn squares(colors: [[u8; 4]; 2]) -> Image {
    let mut image = Image::filled(64, 64, colors[0]);
    image.fill(32, 0, 32, 32, colors[1]);
    image.fill(0, 32, 32, 32, colors[1]);
    image
}
