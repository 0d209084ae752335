//! The library's file, version 2: a GLB whose animations play on a stick figure and carry, in `extras`, what a
//! gait is; the exact joint positions are one more accessor that `extras` names.
//!
//! ```text
//! extras.gaitway               { format: "gaitway-gait-library", version: 2, joints: [16 names] }
//! animations[i].name           the gait's name
//! animations[i].extras.gaitway { positions: accessor of VEC3 f32, [frame][joint], m; frame_rate (Hz); speed (m/s);
//!                                provenance { dataset?, file?, format?, take?, subject?, sex?, label_model?, notes? [],
//!                                label_origin? (rated, predicted or generated) }; acted?; ratings? [4]; label?;
//!                                missing? [names of the joints that were not captured] }
//! ```

use super::figure::{Mesh, Skeleton};
use super::glb::{self, Kind, Writer};
use super::{MOST_FRAMES, check};
use crate::emotion::Emotion;
use crate::gait::{Gait, JOINT_COUNT, Joint, JointSet, Pose, Provenance};
use glam::{Mat4, Quat, Vec3};
use gltf::json as gltf_json;
use gltf_json::validation::Checked::Valid;
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

const FORMAT: &str = "gaitway-gait-library";
const VERSION: u32 = 2;

/// Bytes of one pose.
const POSE_BYTES: usize = JOINT_COUNT * 12;

#[derive(Serialize, Deserialize)]
struct Tagged<T> {
    gaitway: T,
}

#[derive(Serialize, Deserialize)]
struct Header {
    format: String,
    version: u32,
    joints: Vec<String>,
}

/// A gait without its name and poses. Numbers are f64, which holds an f32 exactly, so that text gives them back.
#[derive(Serialize, Deserialize)]
struct Description {
    positions: usize,
    frame_rate: f64,
    speed: f64,
    #[serde(default)]
    provenance: Provenance,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    acted: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    ratings: Option<[f64; 4]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    label: Option<Emotion>,
    /// Joints that were not captured, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    missing: Vec<String>,
}

/// The file of these gaits.
pub(super) fn bytes(gaits: &[Gait]) -> Vec<u8> {
    let skeleton = Skeleton::mean(gaits);
    let mut writer = Writer::default();
    let animations: Vec<Value> = gaits.iter().map(|gait| animation(&mut writer, &skeleton, gait)).collect();
    let header = Header {
        format: FORMAT.to_owned(),
        version: VERSION,
        joints: Joint::ALL.map(|joint| joint.name().to_owned()).to_vec(),
    };
    let mut document = scene(&mut writer, &skeleton);
    document["extras"] = json!(Tagged { gaitway: header });
    if !animations.is_empty() {
        document["animations"] = Value::Array(animations);
    }
    writer.finish(document)
}

/// Nodes, skin and mesh of the stick figure.
fn scene(writer: &mut Writer, skeleton: &Skeleton) -> Value {
    let mesh = Mesh::of(skeleton);
    let count = mesh.positions.len();
    let low = mesh.positions.iter().copied().fold(Vec3::ZERO, Vec3::min);
    let high = mesh.positions.iter().copied().fold(Vec3::ZERO, Vec3::max);
    let positions = writer.push_floats(Kind::VEC3, count, mesh.positions.iter().flat_map(Vec3::to_array));
    writer.bounds(positions, &low.to_array(), &high.to_array());
    let normals = writer.push_floats(Kind::VEC3, count, mesh.normals.iter().flat_map(Vec3::to_array));
    let joints = writer.push(Kind::JOINTS, count, mesh.joints.iter().flat_map(|&joint| [joint, 0, 0, 0]));
    let weights =
        writer.push_floats(Kind::VEC4, count, mesh.joints.iter().flat_map(|_| [1.0, 0.0, 0.0, 0.0]));
    let inverse_bind = skeleton.positions().map(|position| Mat4::from_translation(-position));
    let matrices = inverse_bind.iter().flat_map(Mat4::to_cols_array);
    let inverse_bind = writer.push_floats(Kind::MAT4, JOINT_COUNT, matrices);
    let mut nodes: Vec<Value> = Joint::ALL.map(|joint| node(skeleton, joint)).to_vec();
    nodes.push(json!({ "name": "figure", "mesh": 0, "skin": 0 }));
    json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("gaitway ", env!("CARGO_PKG_VERSION")),
        },
        "scene": 0,
        "scenes": [{ "nodes": [0, JOINT_COUNT] }],
        "nodes": nodes,
        "skins": [{
            "joints": (0..JOINT_COUNT).collect::<Vec<_>>(), "skeleton": 0, "inverseBindMatrices": inverse_bind,
        }],
        "materials": [{
            "name": "figure",
            "pbrMetallicRoughness": { "baseColorFactor": [0.6, 0.55, 0.5, 1.0], "metallicFactor": 0.0 },
        }],
        "meshes": [{ "name": "figure", "primitives": [{
            "attributes": {
                "POSITION": positions, "NORMAL": normals, "JOINTS_0": joints, "WEIGHTS_0": weights,
            },
            "material": 0,
        }] }],
    })
}

fn node(skeleton: &Skeleton, joint: Joint) -> Value {
    let index = joint as usize;
    let children: Vec<usize> =
        (index + 1..JOINT_COUNT).filter(|&child| Joint::PARENT[child] == index).collect();
    let mut node = json!({ "name": joint.name(), "translation": skeleton.offsets[index].to_array() });
    if !children.is_empty() {
        node["children"] = json!(children);
    }
    node
}

/// One clip: root translation and size, joint rotations, and the exact positions beside them.
fn animation(writer: &mut Writer, skeleton: &Skeleton, gait: &Gait) -> Value {
    let frames = gait.poses.len();
    let positions = writer.push_floats(
        Kind::VEC3,
        frames * JOINT_COUNT,
        gait.poses.iter().flatten().flat_map(Vec3::to_array),
    );
    // The clip ends with its first pose, so that viewers that do not blend over the end loop smoothly.
    let looped = || gait.poses.iter().chain(gait.poses.first());
    let times: Vec<f32> = (0_u16..).take(frames + 1).map(|i| f32::from(i) / gait.frame_rate).collect();
    let end = times.last().copied().unwrap_or(0.0);
    let input = writer.push_floats(Kind::SCALAR, times.len(), times.iter().copied());
    writer.bounds(input, &[0.0], &[end]);

    let (mut samplers, mut channels) = (Vec::new(), Vec::new());
    let mut channel = |input: usize, output: usize, node: usize, path: &str| {
        channels.push(json!({ "sampler": samplers.len(), "target": { "node": node, "path": path } }));
        samplers.push(json!({ "input": input, "output": output }));
    };
    let root = looped().flat_map(|pose| pose[0].to_array());
    channel(input, writer.push_floats(Kind::VEC3, frames + 1, root), 0, "translation");
    let start = writer.push_floats(Kind::SCALAR, 1, [0.0]);
    writer.bounds(start, &[0.0], &[0.0]);
    let scale = writer.push_floats(Kind::VEC3, 1, [skeleton.scale_of(gait); 3]);
    channel(start, scale, 0, "scale");

    let mut rotations: Vec<[Quat; JOINT_COUNT]> = looped().map(|pose| skeleton.rotations(pose)).collect();
    // Neighbouring frames in one hemisphere, so that viewers interpolate the short way.
    let mut before = [Quat::IDENTITY; JOINT_COUNT];
    for frame in &mut rotations {
        for (rotation, before) in frame.iter_mut().zip(&mut before) {
            if rotation.dot(*before) < 0.0 {
                *rotation = -*rotation;
            }
            *before = *rotation;
        }
    }
    for joint in Joint::ALL {
        if !matches!(joint, Joint::Head | Joint::LeftHand | Joint::RightHand) {
            let shorts = rotations.iter().flat_map(|frame| frame[joint as usize].to_array().map(short));
            let output = writer.push(Kind::ROTATION, frames + 1, shorts.flat_map(i16::to_le_bytes));
            channel(input, output, joint as usize, "rotation");
        }
    }
    let description = Description {
        positions,
        frame_rate: f64::from(gait.frame_rate),
        speed: f64::from(gait.speed),
        provenance: gait.provenance.clone(),
        acted: gait.acted.clone(),
        ratings: gait.ratings.map(|ratings| ratings.map(f64::from)),
        label: gait.label,
        missing: gait.missing.iter().map(|joint| joint.name().to_owned()).collect(),
    };
    json!({
        "name": gait.name, "channels": channels, "samplers": samplers,
        "extras": Tagged { gaitway: description },
    })
}

/// A number in [-1, 1] as a normalised 16-bit integer.
#[allow(clippy::cast_possible_truncation, reason = "clamped to the range of i16 before the cast")]
fn short(value: f32) -> i16 {
    (value * 32767.0).round().clamp(-32767.0, 32767.0) as i16
}

/// The gaits of a file; the message says what is wrong with it.
pub(super) fn gaits(bytes: &[u8]) -> Result<Vec<Gait>, String> {
    let (text, binary) = glb::chunks(bytes)?;
    // Without the crate's validation, which panics on some damaged files; what is used here is checked here.
    // The parser would take a JSON chunk that begins with "glTF" for another GLB file.
    if text.first() != Some(&b'{') {
        return Err("its JSON chunk does not begin with {".to_owned());
    }
    let parsed = gltf::Gltf::from_slice_without_validation(text)
        .map_err(|error| format!("not valid glTF: {error}"))?;
    let root = parsed.document.as_json();
    header(root)?;
    let mut spent = 0_usize;
    let mut gaits = Vec::new();
    for (index, animation) in root.animations.iter().enumerate() {
        let name = animation.name.clone().ok_or_else(|| format!("animation {index} has no name"))?;
        let what = |message: String| format!("gait {name:?}: {message}");
        let raw = animation.extras.as_ref().ok_or_else(|| what("no extras.gaitway".to_owned()))?;
        let description: Tagged<Description> =
            serde_json::from_str(raw.get()).map_err(|error| what(format!("extras.gaitway: {error}")))?;
        let data = position_bytes(root, binary, description.gaitway.positions).map_err(what)?;
        // Each gait has positions of its own, so together they cannot exceed the file: no blow-up on reading.
        spent = spent.saturating_add(data.len());
        if spent > binary.len() {
            return Err(what(
                "its positions are shared with another gait's; each gait needs its own".to_owned(),
            ));
        }
        let missing = joints(&description.gaitway.missing).map_err(what)?;
        let gait = gait(&name, description.gaitway, missing, data);
        check(&gait).map_err(what)?;
        gaits.push(gait);
    }
    Ok(gaits)
}

fn header(root: &gltf_json::Root) -> Result<(), String> {
    let hint = "it is glTF but not a gait library; write one with GaitLibrary::save_glb";
    let raw = root.extras.as_ref().ok_or_else(|| format!("no extras: {hint}"))?;
    // The version first: another version may have another header.
    let loose: Value = serde_json::from_str(raw.get()).map_err(|error| format!("extras: {error}"))?;
    let (format, version) = (&loose["gaitway"]["format"], &loose["gaitway"]["version"]);
    if format != FORMAT {
        return Err(format!("extras.gaitway.format is {format}, not {FORMAT:?}: {hint}"));
    }
    if *version != VERSION {
        return Err(format!("library version {version}; this program reads version {VERSION}"));
    }
    let header: Tagged<Header> = serde_json::from_value(loose).map_err(|error| format!("extras: {error}"))?;
    let expected = Joint::ALL.map(Joint::name);
    if header.gaitway.joints != expected {
        return Err(format!("its joints are {:?}; expected {expected:?}", header.gaitway.joints));
    }
    Ok(())
}

/// The bytes of the positions accessor: a whole number of poses, inside the binary chunk.
fn position_bytes<'a>(root: &gltf_json::Root, binary: &'a [u8], index: usize) -> Result<&'a [u8], String> {
    let accessor = root.accessors.get(index).ok_or_else(|| {
        format!("its positions are accessor {index}, but there are {} accessors", root.accessors.len())
    })?;
    let float = gltf_json::accessor::ComponentType::F32;
    let is_float = matches!(&accessor.component_type, Valid(kind) if kind.0 == float);
    let is_vec3 = matches!(accessor.type_, Valid(gltf_json::accessor::Type::Vec3));
    if !is_float || !is_vec3 || accessor.sparse.is_some() || accessor.normalized {
        return Err(format!("its positions (accessor {index}) are not plain VEC3 of 32-bit floats"));
    }
    let count = accessor.count.0;
    let most = (MOST_FRAMES * JOINT_COUNT) as u64;
    if count == 0 || count > most || count % JOINT_COUNT as u64 != 0 {
        return Err(format!(
            "{count} positions (accessor {index}); expected a multiple of {JOINT_COUNT} up to {most}"
        ));
    }
    let view = accessor.buffer_view.and_then(|view| root.buffer_views.get(view.value()));
    let view = view.ok_or_else(|| format!("its positions (accessor {index}) have no buffer view"))?;
    if view.buffer.value() != 0 || view.byte_stride.is_some_and(|stride| stride.0 != 12) {
        return Err(format!("its positions (accessor {index}) are not packed in the file's own buffer"));
    }
    let inner = accessor.byte_offset.map_or(0, |offset| offset.0);
    let outer = view.byte_offset.map_or(0, |offset| offset.0);
    let need = count * 12;
    let fits = inner.checked_add(need).is_some_and(|end| end <= view.byte_length.0);
    let from = outer.checked_add(inner).filter(|_| fits).and_then(|from| usize::try_from(from).ok());
    let until = from.zip(usize::try_from(need).ok()).and_then(|(from, need)| from.checked_add(need));
    from.zip(until).and_then(|(from, until)| binary.get(from..until)).ok_or_else(|| {
        format!(
            "its positions (accessor {index}) need {need} bytes at {outer} + {inner}, but the view has {} and the \
             binary chunk {}",
            view.byte_length.0,
            binary.len()
        )
    })
}

/// Joints by their names.
fn joints(names: &[String]) -> Result<JointSet, String> {
    let named = |name: &String| {
        Joint::ALL.into_iter().find(|joint| joint.name() == name).ok_or_else(|| {
            format!("missing names {name:?}; the joints are {}", Joint::ALL.map(Joint::name).join(", "))
        })
    };
    names.iter().map(named).collect()
}

#[allow(clippy::cast_possible_truncation, reason = "the numbers were f32 when written; others are rounded")]
fn gait(name: &str, description: Description, missing: JointSet, data: &[u8]) -> Gait {
    let mut poses = Vec::with_capacity(data.len() / POSE_BYTES);
    for bytes in data.chunks_exact(POSE_BYTES) {
        let mut pose: Pose = [Vec3::ZERO; JOINT_COUNT];
        for (position, bytes) in pose.iter_mut().zip(bytes.chunks_exact(12)) {
            for (axis, bytes) in bytes.chunks_exact(4).enumerate() {
                position[axis] = f32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]);
            }
        }
        poses.push(pose);
    }
    Gait {
        name: name.to_owned(),
        poses,
        frame_rate: description.frame_rate as f32,
        speed: description.speed as f32,
        provenance: description.provenance,
        acted: description.acted,
        ratings: description.ratings.map(|ratings| ratings.map(|rating| rating as f32)),
        label: description.label,
        missing,
    }
}
