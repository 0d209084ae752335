//! Binary glTF (glTF 2.0, section 4): the container, read and written, and documents whose accessors lie in its one buffer.
//!
//! Documents are the types of gltf-json. The crate gltf has a container, too. It would be two more packages of the library
//! without features, which reads and writes gait libraries, and it trusts the lengths in a file.

use gltf_json::accessor::{Accessor, ComponentType, GenericComponentType, Type};
use gltf_json::buffer::{Buffer, View};
use gltf_json::mesh::{Mesh, Mode, Primitive, Semantic};
use gltf_json::validation::Checked::Valid;
use gltf_json::{Index, Material, Node, Root, Scene, Skin};

/// "glTF" as a little-endian number.
const MAGIC: u32 = 0x4654_6C67;
const JSON: u32 = 0x4E4F_534A;
const BIN: u32 = 0x004E_4942;

/// The JSON chunk and the binary chunk (empty if there is none) of a GLB file.
///
/// Every length is checked against the bytes that are really there.
pub(crate) fn chunks(bytes: &[u8]) -> Result<(&[u8], &[u8]), String> {
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
pub(crate) struct Kind {
    component: ComponentType,
    shape: Type,
    normalized: bool,
}

impl Kind {
    pub(crate) const SCALAR: Self = Self::floats(Type::Scalar);
    pub(crate) const VEC3: Self = Self::floats(Type::Vec3);
    pub(crate) const VEC4: Self = Self::floats(Type::Vec4);
    pub(crate) const MAT4: Self = Self::floats(Type::Mat4);
    /// Rotations as 16-bit integers, 32767 for 1.
    pub(crate) const ROTATION: Self =
        Self { component: ComponentType::I16, shape: Type::Vec4, normalized: true };
    /// Four joints of a skin.
    pub(crate) const JOINTS: Self =
        Self { component: ComponentType::U8, shape: Type::Vec4, normalized: false };
    /// A vertex of a triangle.
    pub(crate) const INDEX: Self =
        Self { component: ComponentType::U32, shape: Type::Scalar, normalized: false };

    const fn floats(shape: Type) -> Self {
        Self { component: ComponentType::F32, shape, normalized: false }
    }

    fn size(self) -> usize {
        self.component.size() * self.shape.multiplicity()
    }
}

/// A document, and the binary chunk in which its accessors lie.
#[derive(Default)]
pub(crate) struct Writer {
    pub(crate) root: Root,
    binary: Vec<u8>,
}

impl Writer {
    /// Adds an accessor of whole elements, little-endian.
    pub(crate) fn push(&mut self, kind: Kind, bytes: impl IntoIterator<Item = u8>) -> Index<Accessor> {
        let offset = self.binary.len();
        self.binary.extend(bytes);
        let length = self.binary.len() - offset;
        self.binary.resize(self.binary.len().next_multiple_of(4), 0);
        let view = self.root.push(View {
            buffer: Index::new(0),
            byte_length: length.into(),
            byte_offset: Some(offset.into()),
            byte_stride: None,
            name: None,
            target: None,
            extensions: None,
            extras: None,
        });
        self.root.push(Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: (length / kind.size()).into(),
            component_type: Valid(GenericComponentType(kind.component)),
            type_: Valid(kind.shape),
            min: None,
            max: None,
            name: None,
            normalized: kind.normalized,
            sparse: None,
            extensions: None,
            extras: None,
        })
    }

    /// Adds an accessor of floats.
    pub(crate) fn floats(&mut self, kind: Kind, floats: impl IntoIterator<Item = f32>) -> Index<Accessor> {
        self.push(kind, floats.into_iter().flat_map(f32::to_le_bytes))
    }

    /// Adds an accessor of floats with the range of its values, which glTF demands of times and vertex positions.
    pub(crate) fn bounded<const N: usize>(
        &mut self,
        kind: Kind,
        floats: impl IntoIterator<Item = f32>,
        [low, high]: [[f32; N]; 2],
    ) -> Index<Accessor> {
        let index = self.floats(kind, floats);
        let accessor = &mut self.root.accessors[index.value()];
        accessor.min = Some(low.to_vec().into());
        accessor.max = Some(high.to_vec().into());
        index
    }

    /// The scene: joints below their parents, the first of them the root, and beside it the mesh that they move.
    pub(crate) fn figure(
        &mut self,
        joints: Vec<Node>,
        parents: &[usize],
        inverse_bind: Index<Accessor>,
        mesh: Mesh,
    ) {
        let numbers: Vec<Index<Node>> = (0..).map(Index::new).take(joints.len()).collect();
        let root = Index::new(0);
        self.root.nodes = joints;
        for (&child, &parent) in numbers.iter().zip(parents).skip(1) {
            self.root.nodes[parent].children.get_or_insert_default().push(child);
        }
        let skin = self.root.push(Skin {
            joints: numbers,
            skeleton: Some(root),
            inverse_bind_matrices: Some(inverse_bind),
            name: None,
            extensions: None,
            extras: None,
        });
        let name = mesh.name.clone();
        let mesh = self.root.push(mesh);
        let holder = self.root.push(Node { name, mesh: Some(mesh), skin: Some(skin), ..Node::default() });
        let scene = Scene { nodes: vec![root, holder], name: None, extensions: None, extras: None };
        self.root.scene = Some(self.root.push(scene));
    }

    /// The finished file.
    pub(crate) fn finish(mut self) -> Vec<u8> {
        self.root.asset.generator = Some(concat!("gaitway ", env!("CARGO_PKG_VERSION")).to_owned());
        self.root.push(Buffer {
            byte_length: self.binary.len().into(),
            name: None,
            uri: None,
            extensions: None,
            extras: None,
        });
        // It cannot fail: every value is `Valid`, and every key is text.
        container(self.root.to_vec().unwrap_or_default(), self.binary)
    }
}

/// The file of a JSON chunk and a binary chunk.
fn container(mut json: Vec<u8>, mut binary: Vec<u8>) -> Vec<u8> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    // A file of 4 GiB would hold some 200,000 gaits; it would be refused on reading.
    let size = |length: usize| u32::try_from(length).unwrap_or(u32::MAX);
    let head = [MAGIC, 2, size(28 + json.len() + binary.len()), size(json.len()), JSON];
    let words = |words: &[u32]| words.iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
    [words(&head), json, words(&[size(binary.len()), BIN]), binary].concat()
}

/// A mesh of these triangles.
pub(crate) fn mesh(name: &str, primitives: Vec<Primitive>) -> Mesh {
    Mesh { name: Some(name.to_owned()), primitives, weights: None, extensions: None, extras: None }
}

/// Triangles of one material; without `indices` every three vertices are one.
pub(crate) fn triangles(
    attributes: impl IntoIterator<Item = (Semantic, Index<Accessor>)>,
    indices: Option<Index<Accessor>>,
    material: Index<Material>,
) -> Primitive {
    Primitive {
        attributes: attributes.into_iter().map(|(semantic, index)| (Valid(semantic), index)).collect(),
        indices,
        material: Some(material),
        mode: Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: None,
    }
}
