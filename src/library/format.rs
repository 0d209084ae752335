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
use super::glb::{Kind, Writer};
use crate::emotion::Emotion;
use crate::gait::{Gait, JOINT_COUNT, Joint, Provenance};
use glam::{Mat4, Quat, Vec3};
use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

pub(super) const FORMAT: &str = "gaitway-gait-library";
pub(super) const VERSION: u32 = 2;

/// Bytes of one pose.
pub(super) const POSE_BYTES: usize = JOINT_COUNT * 12;

#[derive(Serialize, Deserialize)]
pub(super) struct Tagged<T> {
    pub(super) gaitway: T,
}

#[derive(Serialize, Deserialize)]
pub(super) struct Header {
    pub(super) format: String,
    pub(super) version: u32,
    pub(super) joints: Vec<String>,
}

/// A gait without its name and poses. Numbers are f64, which holds an f32 exactly, so that text gives them back.
#[derive(Serialize, Deserialize)]
pub(super) struct Description {
    pub(super) positions: usize,
    pub(super) frame_rate: f64,
    pub(super) speed: f64,
    #[serde(default)]
    pub(super) provenance: Provenance,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) acted: Option<String>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) ratings: Option<[f64; 4]>,
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub(super) label: Option<Emotion>,
    /// Joints that were not captured, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub(super) missing: Vec<String>,
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
