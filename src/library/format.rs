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
use crate::emotion::Emotion;
use crate::gait::{Gait, JOINT_COUNT, Joint, Provenance};
use crate::glb::{self, Kind, Writer};
use glam::{Mat4, Quat, Vec3};
use gltf_json::animation::{Animation, Channel, Interpolation, Property, Sampler, Target};
use gltf_json::material::{Material, PbrBaseColorFactor, PbrMetallicRoughness, StrengthFactor};
use gltf_json::mesh::Semantic;
use gltf_json::validation::Checked::Valid;
use gltf_json::{Accessor, Extras, Index, Node};
use serde::{Deserialize, Serialize};
use serde_json::value::to_raw_value;

pub(super) const FORMAT: &str = "gaitway-gait-library";
pub(super) const VERSION: u32 = 2;

/// What the mesh and its material are called.
const FIGURE: &str = "figure";

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
    for gait in gaits {
        let animation = animation(&mut writer, &skeleton, gait);
        writer.root.push(animation);
    }
    figure(&mut writer, &skeleton);
    writer.root.extras = extras(Header {
        format: FORMAT.to_owned(),
        version: VERSION,
        joints: Joint::ALL.map(|joint| joint.name().to_owned()).to_vec(),
    });
    writer.finish()
}

/// What glTF has no place for; gltf-json keeps it as text.
fn extras<T: Serialize>(gaitway: T) -> Extras {
    // it cannot fail: every key is text
    to_raw_value(&Tagged { gaitway }).ok()
}

/// The stick figure.
fn figure(writer: &mut Writer, skeleton: &Skeleton) {
    let mesh = Mesh::of(skeleton);
    let low = mesh.positions.iter().copied().fold(Vec3::ZERO, Vec3::min);
    let high = mesh.positions.iter().copied().fold(Vec3::ZERO, Vec3::max);
    let positions = mesh.positions.iter().flat_map(Vec3::to_array);
    let attributes = [
        (Semantic::Positions, writer.bounded(Kind::VEC3, positions, [low, high].map(Vec3::into))),
        (Semantic::Normals, writer.floats(Kind::VEC3, mesh.normals.iter().flat_map(Vec3::to_array))),
        (
            Semantic::Joints(0),
            writer.push(Kind::JOINTS, mesh.joints.iter().flat_map(|&joint| [joint, 0, 0, 0])),
        ),
        (
            Semantic::Weights(0),
            writer.floats(Kind::VEC4, mesh.joints.iter().flat_map(|_| [1.0, 0.0, 0.0, 0.0])),
        ),
    ];
    let inverse_bind = skeleton.positions().map(|position| Mat4::from_translation(-position));
    let inverse_bind = writer.floats(Kind::MAT4, inverse_bind.iter().flat_map(Mat4::to_cols_array));
    let material = writer.root.push(Material {
        name: Some(FIGURE.to_owned()),
        pbr_metallic_roughness: PbrMetallicRoughness {
            base_color_factor: PbrBaseColorFactor([0.6, 0.55, 0.5, 1.0]),
            metallic_factor: StrengthFactor(0.0),
            ..PbrMetallicRoughness::default()
        },
        ..Material::default()
    });
    let joints = Joint::ALL.map(|joint| Node {
        name: Some(joint.name().to_owned()),
        translation: Some(skeleton.offsets[joint as usize].to_array()),
        ..Node::default()
    });
    let mesh = glb::mesh(FIGURE, vec![glb::triangles(attributes, None, material)]);
    writer.figure(joints.to_vec(), &Joint::PARENT, inverse_bind, mesh);
}

/// Samplers and channels of a clip.
#[derive(Default)]
struct Tracks {
    samplers: Vec<Sampler>,
    channels: Vec<Channel>,
}

impl Tracks {
    /// `output` over the times `input` moves `path` of a joint.
    fn add(&mut self, input: Index<Accessor>, output: Index<Accessor>, joint: Joint, path: Property) {
        let interpolation = Valid(Interpolation::Linear);
        let sampler = Sampler { input, interpolation, output, extensions: None, extras: None };
        let node = Index::new(joint as u32);
        self.channels.push(Channel {
            sampler: Index::push(&mut self.samplers, sampler),
            target: Target { node, path: Valid(path), extensions: None, extras: None },
            extensions: None,
            extras: None,
        });
    }
}

/// One clip: root translation and size, joint rotations, and the exact positions beside them.
fn animation(writer: &mut Writer, skeleton: &Skeleton, gait: &Gait) -> Animation {
    let frames = gait.poses.len();
    let positions = writer.floats(Kind::VEC3, gait.poses.iter().flatten().flat_map(Vec3::to_array));
    // The clip ends with its first pose, so that viewers that do not blend over the end loop smoothly.
    let looped = || gait.poses.iter().chain(gait.poses.first());
    let times: Vec<f32> = (0_u16..).take(frames + 1).map(|i| f32::from(i) / gait.frame_rate).collect();
    let end = times.last().copied().unwrap_or(0.0);
    let input = writer.bounded(Kind::SCALAR, times, [[0.0], [end]]);
    let mut tracks = Tracks::default();
    let root = writer.floats(Kind::VEC3, looped().flat_map(|pose| pose[0].to_array()));
    tracks.add(input, root, Joint::Root, Property::Translation);
    let start = writer.bounded(Kind::SCALAR, [0.0], [[0.0]; 2]);
    let scale = writer.floats(Kind::VEC3, [skeleton.scale_of(gait); 3]);
    tracks.add(start, scale, Joint::Root, Property::Scale);

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
            let output = writer.push(Kind::ROTATION, shorts.flat_map(i16::to_le_bytes));
            tracks.add(input, output, joint, Property::Rotation);
        }
    }
    let description = Description {
        positions: positions.value(),
        frame_rate: f64::from(gait.frame_rate),
        speed: f64::from(gait.speed),
        provenance: gait.provenance.clone(),
        acted: gait.acted.clone(),
        ratings: gait.ratings.map(|ratings| ratings.map(f64::from)),
        label: gait.label,
        missing: gait.missing.iter().map(|joint| joint.name().to_owned()).collect(),
    };
    let Tracks { samplers, channels } = tracks;
    let (name, extras) = (Some(gait.name.clone()), extras(description));
    Animation { name, channels, samplers, extensions: None, extras }
}

/// A number in [-1, 1] as a normalised 16-bit integer.
#[allow(clippy::cast_possible_truncation, reason = "clamped to the range of i16 before the cast")]
fn short(value: f32) -> i16 {
    (value * 32767.0).round().clamp(-32767.0, 32767.0) as i16
}
