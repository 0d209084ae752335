//! GLB files, taken apart and put together.
#![allow(clippy::unwrap_used, reason = "a test")]

use gltf::binary::{Glb, Header};

/// The JSON chunk and the binary chunk.
pub(crate) fn parts(file: &[u8]) -> (Vec<u8>, Vec<u8>) {
    let Glb { json, bin, .. } = Glb::from_slice(file).unwrap();
    (json.into_owned(), bin.unwrap_or_default().into_owned())
}

/// The file of these chunks.
pub(crate) fn file(json: impl Into<Vec<u8>>, binary: Vec<u8>) -> Vec<u8> {
    let header = Header { magic: *b"glTF", version: 2, length: 0 }; // the length is found from the chunks
    Glb { header, json: json.into().into(), bin: Some(binary.into()) }.to_vec().unwrap()
}
