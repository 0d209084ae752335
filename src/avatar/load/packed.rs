//! What a file asks of its readers: the version, and extensions that pack its geometry or textures.

use super::Fault;
use serde_json::Value;

/// Extensions that pack a file, by a part of their names, and the way out.
const PACKED: [(&str, &str); 6] = [
    ("draco", "unpack it: `npx @gltf-transform/cli copy IN.glb OUT.glb`"),
    ("meshopt", "unpack it: `npx @gltf-transform/cli dequantize IN.glb OUT.glb`"),
    ("quantization", "unpack it: `npx @gltf-transform/cli dequantize IN.glb OUT.glb`"),
    ("basisu", "turn its KTX2 textures into PNG: `npx @gltf-transform/cli ktxdecompress IN.glb OUT.glb`"),
    ("webp", "turn its WebP textures into PNG: `npx @gltf-transform/cli png IN.glb OUT.glb`"),
    ("avif", "turn its AVIF textures into PNG: `npx @gltf-transform/cli png IN.glb OUT.glb`"),
];

/// Refuses what the glTF crate does not: other versions, extensions that pack the file, and positions that
/// point past the accessors (the crate would index with them).
pub(super) fn check(json: &Value) -> Result<(), Fault> {
    let version = json["asset"]["version"].as_str().unwrap_or("none");
    if !version.starts_with("2.") {
        return Err(format!("is glTF version {version}, expected 2.0").into());
    }
    let required = || list(&json["extensionsRequired"]).filter_map(Value::as_str);
    if let Some(fault) = required().find_map(packed) {
        return Err(fault);
    }
    let accessors = list(&json["accessors"]).count();
    for (index, mesh) in list(&json["meshes"]).enumerate() {
        for primitive in list(&mesh["primitives"]) {
            let attributes = || primitive["attributes"].as_object().into_iter().flatten();
            for (name, accessor) in attributes() {
                let found = accessor.as_u64().and_then(|found| usize::try_from(found).ok());
                let Some(found) = found.filter(|found| *found < accessors) else {
                    return Err(format!("mesh {index}: {name} is accessor {accessor} of {accessors}").into());
                };
                // a file may leave the plain geometry out without requiring its extension
                if json["accessors"][found]["bufferView"].is_null()
                    && let Some(fault) = extensions(primitive).find_map(packed)
                {
                    return Err(fault);
                }
            }
        }
    }
    let is_bare = |texture: &&Value| texture["source"].is_null();
    let textures = list(&json["textures"]).filter(is_bare).flat_map(extensions);
    let buffers = list(&json["buffers"]).flat_map(extensions); // stand-ins without data
    textures.chain(buffers).find_map(packed).map_or(Ok(()), Err)
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

/// Names of the extensions of a part of the file.
fn extensions(part: &Value) -> impl Iterator<Item = &str> {
    part["extensions"].as_object().into_iter().flatten().map(|(name, _)| name.as_str())
}

/// The fault of a file that needs an extension that packs it.
fn packed(name: &str) -> Option<Fault> {
    let lower = name.to_ascii_lowercase();
    let (_, hint) = PACKED.iter().find(|(part, _)| lower.contains(part))?;
    Some(Fault::Packed { extension: name.to_owned(), hint })
}
