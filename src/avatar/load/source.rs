//! A glTF or VRM file as plain data: nodes, skins and triangles in file space, everything checked.

use super::super::Material;
use super::accessor::{self, Buffer, MOST_VERTICES};
use super::expressions::{Expressions, Ways};
use super::paint::{Paint, Texture, tint};
use super::surface::Surface;
use super::{Fault, outside, packed};
use glam::{Mat4, Vec2, Vec3, Vec4};
use gltf::mesh::Mode;
use serde_json::Value;
use std::path::Path;

/// Most joints of a skin.
const MOST_JOINTS: usize = 512;
/// Most nodes of a file: far above any character.
const MOST_NODES: usize = 65_536;

/// A node of the file.
#[derive(Debug, Clone)]
pub(super) struct Node {
    pub(super) name: String,
    pub(super) parent: Option<usize>,
    pub(super) local: Mat4,
    pub(super) world: Mat4,
}

/// A skin of the file.
#[derive(Debug, Clone)]
pub(super) struct Skin {
    /// Nodes.
    pub(super) joints: Vec<usize>,
    /// Mesh space to joint space at bind time, one per joint; `None` where the file gives none.
    pub(super) inverse_bind: Option<Vec<Mat4>>,
}

/// Triangles with one material.
#[derive(Debug, Clone, Default)]
pub(super) struct Part {
    pub(super) node: usize,
    pub(super) skin: Option<usize>,
    pub(super) positions: Vec<Vec3>,
    pub(super) normals: Option<Vec<Vec3>>,
    /// Linear colour and alpha per vertex.
    pub(super) colors: Vec<Vec4>,
    /// (index into the skin's joints, weight) per vertex.
    pub(super) influences: Vec<Vec<(usize, f32)>>,
    pub(super) indices: Vec<u32>,
    /// Of a character: the triangles of a cut-out that are there for the larger part, and all others.
    pub(super) whole: Vec<u32>,
    /// Of a character: colours and alpha without textures, linear.
    pub(super) own: Vec<Vec4>,
    /// What tints it.
    pub(super) material: Material,
    /// Number among [`Source::surfaces`] of what it is made of, and where each vertex lies on its textures.
    pub(super) surface: usize,
    pub(super) uv: Vec<Vec2>,
    /// How far expressions move each vertex; empty where they move none.
    pub(super) ways: Vec<Ways>,
}

/// The file.
#[derive(Debug, Clone, Default)]
pub(super) struct Source {
    pub(super) nodes: Vec<Node>,
    pub(super) skins: Vec<Skin>,
    pub(super) parts: Vec<Part>,
    /// VRM humanoid: (bone, node).
    pub(super) humanoid: Vec<(String, usize)>,
    /// VRM: eyes relative to the head bone, file space, m.
    pub(super) eyes: Option<Vec3>,
    /// VRM: expressions of the face.
    pub(super) expressions: Expressions,
    pub(super) report: Vec<String>,
    /// Of a place or a character: what its parts are made of, and its images.
    pub(super) surfaces: Vec<Surface>,
    pub(super) textures: Vec<Texture>,
}

/// What becomes of textures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Textures {
    /// They are looked up at the vertices; one that cannot be read is white.
    AtVertices,
    /// They are kept.
    Kept,
    /// Both; one that cannot be read is left out.
    Both,
}

impl Source {
    /// Reads `bytes`; files named by the document are looked for beside `base`. Textures become colours of vertices.
    ///
    /// # Errors
    /// A message that says what is wrong and where in the file.
    pub(super) fn read(bytes: &[u8], base: Option<&Path>) -> Result<Self, Fault> {
        Self::read_with(bytes, base, Textures::AtVertices)
    }

    /// The same with surfaces and textures apart.
    ///
    /// # Errors
    /// As [`Self::read`]; also where an image cannot be read.
    pub(super) fn read_place(bytes: &[u8], base: Option<&Path>) -> Result<Self, Fault> {
        Self::read_with(bytes, base, Textures::Kept)
    }

    /// The same with both: colours of vertices, and surfaces and textures.
    ///
    /// # Errors
    /// As [`Self::read`].
    pub(super) fn read_character(bytes: &[u8], base: Option<&Path>) -> Result<Self, Fault> {
        Self::read_with(bytes, base, Textures::Both)
    }

    fn read_with(bytes: &[u8], base: Option<&Path>, kept: Textures) -> Result<Self, Fault> {
        let json = json_of(bytes)?;
        packed::check(&json)?;
        let gltf =
            gltf::Gltf::from_slice(bytes).map_err(|error| format!("not a usable glTF 2.0 file: {error}"))?;
        let buffers = outside::buffers(&gltf, base)?;
        let mut source = Self::default();
        source.read_nodes(&gltf)?;
        source.read_skins(&gltf, &buffers)?;
        source.read_humanoid(&json);
        source.expressions = Expressions::of(&json);
        let mut textures = Vec::new();
        for image in gltf.images() {
            // The crate trusts that these are there.
            let entry = &json["images"][image.index()];
            let is_described =
                entry["uri"].is_string() || (entry["bufferView"].is_u64() && entry["mimeType"].is_string());
            let texture = is_described.then(|| outside::texture(&image, base, &buffers)).transpose();
            if kept == Textures::Kept {
                let wrong = |message: String| format!("image {} {message}", image.index());
                let found = texture
                    .and_then(|texture| texture.ok_or_else(|| "has neither a file nor a type".to_owned()));
                source.textures.push(found.map_err(wrong)?);
                continue;
            }
            if let Err(message) = &texture {
                source.report.push(format!("image {} {message}; taken as white", image.index()));
            }
            textures.push(texture.unwrap_or_default());
        }
        if kept != Textures::AtVertices {
            let is_there = |image: usize| textures.get(image).is_none_or(Option::is_some);
            source.surfaces = Surface::all(&gltf, &json, is_there, &mut source.report);
        }
        source.read_parts(&gltf, &json, &buffers, &textures, kept)?;
        if kept == Textures::Both {
            source.textures = textures.into_iter().map(Option::unwrap_or_default).collect();
        }
        Ok(source)
    }

    /// What a rig map calls a node, quoted: its name, or `#` and its number if it has none.
    pub(super) fn label(&self, node: usize) -> String {
        let name = self.nodes.get(node).map_or("", |node| node.name.as_str());
        let name = if name.is_empty() { format!("#{node}") } else { name.to_owned() };
        toml::Value::String(name).to_string()
    }

    /// The node that a rig map calls so.
    pub(super) fn node(&self, label: &str) -> Option<usize> {
        let by_name = self.nodes.iter().position(|node| node.name == label);
        let number = || label.strip_prefix('#')?.parse().ok().filter(|node| *node < self.nodes.len());
        by_name.or_else(number)
    }

    fn read_nodes(&mut self, gltf: &gltf::Gltf) -> Result<(), String> {
        let count = gltf.nodes().len();
        if count > MOST_NODES {
            return Err(format!("has {count} nodes; at most {MOST_NODES} are read"));
        }
        for node in gltf.nodes() {
            let local = Mat4::from_cols_array_2d(&node.transform().matrix());
            let name = node.name().unwrap_or("").to_owned();
            if !local.is_finite() {
                return Err(format!("node {} ({name:?}) has a transform that is not finite", node.index()));
            }
            self.nodes.push(Node { name, parent: None, local, world: local });
        }
        for node in gltf.nodes() {
            for child in node.children() {
                let parent = &mut self.nodes[child.index()].parent;
                if parent.replace(node.index()).is_some() {
                    return Err(format!("node {} has two parents", child.index()));
                }
            }
        }
        for index in 0..count {
            let mut world = self.nodes[index].local;
            let mut above = self.nodes[index].parent;
            let mut depth = 0;
            while let Some(parent) = above {
                depth += 1;
                if depth > MOST_JOINTS.max(64) {
                    return Err(format!("node {index} lies in a loop or more than {depth} levels deep"));
                }
                world = self.nodes[parent].local * world;
                above = self.nodes[parent].parent;
            }
            self.nodes[index].world = world;
        }
        Ok(())
    }

    fn read_skins(&mut self, gltf: &gltf::Gltf, buffers: &[Buffer]) -> Result<(), String> {
        for skin in gltf.skins() {
            let joints: Vec<usize> = skin.joints().map(|node| node.index()).collect();
            let count = joints.len();
            if count == 0 || count > MOST_JOINTS {
                return Err(format!("skin {} has {count} joints; 1 to {MOST_JOINTS} are read", skin.index()));
            }
            let inverse_bind = match skin.inverse_bind_matrices() {
                Some(matrices) => Some(accessor::mat4(&matrices, buffers)?),
                None => None,
            };
            if let Some(found) = inverse_bind.as_ref().map(Vec::len).filter(|&found| found < count) {
                return Err(format!(
                    "skin {} has {count} joints but {found} inverse bind matrices",
                    skin.index()
                ));
            }
            self.skins.push(Skin { joints, inverse_bind });
        }
        Ok(())
    }

    /// VRM 0.x: `extensions.VRM.humanoid.humanBones` is a list; VRM 1.0: `VRMC_vrm` has an object.
    fn read_humanoid(&mut self, json: &Value) {
        let mut add = |bone: &str, node: Option<u64>| {
            let node =
                node.and_then(|node| usize::try_from(node).ok()).filter(|&node| node < self.nodes.len());
            self.humanoid.extend(node.map(|node| (bone.to_owned(), node)));
        };
        let old = &json["extensions"]["VRM"];
        for entry in old["humanoid"]["humanBones"].as_array().into_iter().flatten() {
            add(entry["bone"].as_str().unwrap_or(""), entry["node"].as_u64());
        }
        let new = &json["extensions"]["VRMC_vrm"];
        for (bone, entry) in new["humanoid"]["humanBones"].as_object().into_iter().flatten() {
            add(bone, entry["node"].as_u64());
        }
        #[allow(clippy::cast_possible_truncation, reason = "a head fits into f32")]
        let number = |value: &Value| value.as_f64().map(|v| v as f32).filter(|v| v.is_finite());
        let offset = &new["lookAt"]["offsetFromHeadBone"];
        let axes = [number(&offset[0]), number(&offset[1]), number(&offset[2])];
        let offset = &old["firstPerson"]["firstPersonBoneOffset"];
        let old_axes = [number(&offset["x"]), number(&offset["y"]), number(&offset["z"])];
        for found in [axes, old_axes] {
            if let [Some(x), Some(y), Some(z)] = found {
                // Exporters write zeros for an offset that was not set.
                self.eyes = self.eyes.or(Some(Vec3::new(x, y, z)).filter(|offset| offset.length() > 1e-4));
            }
        }
    }

    fn read_parts(
        &mut self,
        gltf: &gltf::Gltf,
        json: &Value,
        buffers: &[Buffer],
        textures: &[Option<Texture>],
        kept: Textures,
    ) -> Result<(), String> {
        let mut total: usize = 0;
        for node in gltf.nodes() {
            let Some(mesh) = node.mesh() else { continue };
            for primitive in mesh.primitives() {
                let place = format!(
                    "node {:?}, mesh {}, primitive {}",
                    node.name().unwrap_or(""),
                    mesh.index(),
                    primitive.index()
                );
                if primitive.mode() != Mode::Triangles {
                    self.report.push(format!(
                        "{place}: {:?} are left out, only triangles are read",
                        primitive.mode()
                    ));
                    continue;
                }
                let material =
                    primitive.material().index().map_or(&Value::Null, |number| &json["materials"][number]);
                let part = self
                    .read_part(&primitive, material, &node, buffers, textures, kept)
                    .and_then(|part| {
                        let ways =
                            self.expressions.ways(&primitive, mesh.index(), part.positions.len(), buffers)?;
                        Ok(Part { ways, ..part })
                    })
                    .map_err(|message| format!("{place}: {message}"))?;
                total += part.positions.len();
                if total > MOST_VERTICES {
                    return Err(format!("has more than {MOST_VERTICES} vertices"));
                }
                self.parts.push(part);
            }
        }
        Ok(())
    }

    fn read_part(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        material: &Value,
        node: &gltf::Node<'_>,
        buffers: &[Buffer],
        textures: &[Option<Texture>],
        kept: Textures,
    ) -> Result<Part, String> {
        use gltf::Semantic;
        let positions = primitive.get(&Semantic::Positions).ok_or("has no POSITION")?;
        let positions = accessor::vec3(&positions, buffers)?;
        let count = positions.len();
        let checked = |what: &str, found: usize| {
            if found == count { Ok(()) } else { Err(format!("has {count} positions but {found} {what}")) }
        };
        let normals = match primitive.get(&Semantic::Normals) {
            Some(normals) => Some(accessor::vec3(&normals, buffers)?),
            None => None,
        };
        checked("normals", normals.as_ref().map_or(count, Vec::len))?;
        let indices = match primitive.indices() {
            Some(indices) => accessor::integers(&indices, buffers, 1)?,
            None => (0..u32::try_from(count).unwrap_or(0)).collect(),
        };
        if indices.len() % 3 != 0 {
            return Err(format!("has {} indices, which is no number of triangles", indices.len()));
        }
        if let Some(bad) = indices.iter().find(|&&index| index as usize >= count) {
            return Err(format!("index {bad} points past its {count} vertices"));
        }
        let paint = Paint::of(primitive, material, count, buffers, textures)?;
        let skin = node.skin().map(|skin| skin.index());
        let mut part = Part { node: node.index(), skin, positions, normals, ..Part::default() };
        part.material = tint(primitive);
        part.surface = primitive.material().index().unwrap_or(self.surfaces.len().saturating_sub(1));
        if let Some(surface) = self.surfaces.get(part.surface) {
            part.uv = surface.places(primitive, count, buffers)?;
        }
        match kept {
            Textures::AtVertices => {
                part.indices = paint.visible(indices, primitive);
                part.colors = paint.colors(primitive);
            }
            Textures::Kept => {
                part.indices = indices;
                part.colors = paint.own;
            }
            Textures::Both => {
                part.whole = paint.visible(indices.clone(), primitive);
                part.indices = indices;
                part.colors = paint.colors(primitive);
                part.own = paint.own;
            }
        }
        let mut influences = vec![Vec::new(); count];
        if let Some(skin) = skin {
            let joints = self.skins.get(skin).map_or(0, |skin| skin.joints.len());
            for set in 0..4 {
                let attributes =
                    (primitive.get(&Semantic::Joints(set)), primitive.get(&Semantic::Weights(set)));
                let (Some(indices), Some(weights)) = attributes else { break };
                let indices = accessor::integers(&indices, buffers, 4)?;
                let weights = accessor::vec4(&weights, buffers)?;
                checked("joint indices", indices.len() / 4)?;
                checked("weights", weights.len())?;
                for (vertex, (four, shares)) in indices.chunks_exact(4).zip(&weights).enumerate() {
                    for (&joint, &weight) in four.iter().zip(shares) {
                        if weight <= 0.0 {
                            continue;
                        }
                        if joint as usize >= joints {
                            return Err(format!(
                                "vertex {vertex} is bound to joint {joint} of a skin of {joints}"
                            ));
                        }
                        influences[vertex].push((joint as usize, weight));
                    }
                }
            }
        }
        part.influences = influences;
        Ok(part)
    }
}

/// The JSON of a `.glb` or `.gltf`, for extensions that the glTF crate does not know.
fn json_of(bytes: &[u8]) -> Result<Value, String> {
    let word = |at: usize| -> Option<usize> {
        let four = bytes.get(at..at.checked_add(4)?)?;
        usize::try_from(u32::from_le_bytes(four.try_into().ok()?)).ok()
    };
    let text = if bytes.starts_with(b"glTF") {
        if word(4) != Some(2) {
            return Err(format!("is glTF version {}, expected 2", word(4).unwrap_or(0)));
        }
        let end = word(12).and_then(|length| length.checked_add(20));
        end.and_then(|end| bytes.get(20..end)).ok_or("is cut off: its JSON part is longer than the file")?
    } else {
        bytes
    };
    serde_json::from_slice(text)
        .map_err(|error| format!("is neither GLB nor glTF: its JSON is wrong ({error})"))
}
