//! The GLB container: a header, a JSON chunk and a binary chunk, all little-endian (glTF 2.0, section 4).

use serde_json::{Value, json};

/// "glTF" as a little-endian number.
const MAGIC: u32 = 0x4654_6C67;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The JSON chunk and the binary chunk (empty if there is none) of a GLB file.
///
/// Every length is checked against the bytes that are really there.
pub(super) fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), String> {
    let size = bytes.len();
    if size < 12 || word(bytes, 0)? != MAGIC {
        return Err(format!("not a GLB file: its {size} bytes do not begin with glTF"));
    }
    let (version, length) = (word(bytes, 4)?, word(bytes, 8)?);
    if version != 2 {
        return Err(format!("GLB version {version}; only version 2 can be read"));
    }
    if usize::try_from(length) != Ok(size) {
        return Err(format!("its header says {length} bytes but it has {size}; it is cut off or damaged"));
    }
    let (json, after) = chunk(bytes, 12, JSON, "JSON")?;
    let binary = if after == size { &[][..] } else { chunk(bytes, after, BIN, "binary")?.0 };
    Ok((json, binary))
}

/// The chunk that begins at `start`, and where the next one begins.
fn chunk<'a>(bytes: &'a [u8], start: usize, kind: u32, name: &str) -> Result<(&'a [u8], usize), String> {
    let (length, found) = (word(bytes, start)?, word(bytes, start + 4)?);
    if found != kind {
        return Err(format!(
            "byte {start}: a chunk of type {found:#010x} stands where the {name} chunk should"
        ));
    }
    let from = start + 8;
    let until = usize::try_from(length).ok().and_then(|length| from.checked_add(length));
    let content = until.and_then(|until| bytes.get(from..until)).ok_or_else(|| {
        format!("byte {start}: the {name} chunk says {length} bytes but {} follow", bytes.len() - from)
    })?;
    Ok((content, from + content.len()))
}

/// The little-endian u32 at `at`.
fn word(bytes: &[u8], at: usize) -> Result<u32, String> {
    let four = at.checked_add(4).and_then(|end| bytes.get(at..end)).and_then(|four| four.try_into().ok());
    four.map(u32::from_le_bytes)
        .ok_or_else(|| format!("byte {at}: 4 bytes should follow but the file ends at {}", bytes.len()))
}

/// What an accessor holds.
#[derive(Clone, Copy)]
pub(super) struct Kind {
    pub(super) component: u32,
    pub(super) shape: &'static str,
    pub(super) normalized: bool,
}

impl Kind {
    pub(super) const SCALAR: Self = Self { component: 5126, shape: "SCALAR", normalized: false };
    pub(super) const VEC3: Self = Self { component: 5126, shape: "VEC3", normalized: false };
    pub(super) const VEC4: Self = Self { component: 5126, shape: "VEC4", normalized: false };
    pub(super) const MAT4: Self = Self { component: 5126, shape: "MAT4", normalized: false };
    /// Rotations as 16-bit integers, 32767 for 1.
    pub(super) const ROTATION: Self = Self { component: 5122, shape: "VEC4", normalized: true };
    pub(super) const JOINTS: Self = Self { component: 5121, shape: "VEC4", normalized: false };
}

/// Collects a binary chunk with its buffer views and accessors.
#[derive(Default)]
pub(super) struct Writer {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
}

impl Writer {
    /// Appends `count` elements; returns the accessor's index.
    pub(super) fn push(&mut self, kind: Kind, count: usize, bytes: impl IntoIterator<Item = u8>) -> usize {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        self.views
            .push(json!({ "buffer": 0, "byteOffset": offset, "byteLength": self.binary.len() - offset }));
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let mut accessor = json!({
            "bufferView": self.views.len() - 1, "componentType": kind.component,
            "type": kind.shape, "count": count,
        });
        if kind.normalized {
            accessor["normalized"] = json!(true);
        }
        self.accessors.push(accessor);
        self.accessors.len() - 1
    }

    /// Appends floats of `kind`.
    pub(super) fn push_floats(
        &mut self,
        kind: Kind,
        count: usize,
        floats: impl IntoIterator<Item = f32>,
    ) -> usize {
        self.push(kind, count, floats.into_iter().flat_map(f32::to_le_bytes))
    }

    /// States the range of an accessor's values, which glTF demands of times and vertex positions.
    pub(super) fn bounds(&mut self, accessor: usize, min: &[f32], max: &[f32]) {
        self.accessors[accessor]["min"] = json!(min);
        self.accessors[accessor]["max"] = json!(max);
    }

    /// The finished file: `document` with buffers, views and accessors added, and the binary chunk.
    pub(super) fn finish(self, mut document: Value) -> Vec<u8> {
        document["buffers"] = json!([{ "byteLength": self.binary.len() }]);
        document["bufferViews"] = Value::Array(self.views);
        document["accessors"] = Value::Array(self.accessors);
        let mut text = document.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let length = 12 + 8 + text.len() + 8 + self.binary.len();
        let mut file = Vec::with_capacity(length);
        for part in [MAGIC, 2, size(length), size(text.len()), JSON] {
            file.extend(part.to_le_bytes());
        }
        file.extend(text);
        for part in [size(self.binary.len()), BIN] {
            file.extend(part.to_le_bytes());
        }
        file.extend(self.binary);
        file
    }
}

/// A length as GLB writes it. A library of 4 GiB would hold some 200,000 gaits; it would be refused on reading.
fn size(length: usize) -> u32 {
    u32::try_from(length).unwrap_or(u32::MAX)
}
