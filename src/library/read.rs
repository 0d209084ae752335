//! Reads the library's file; [`super::format`] says how it lies.

use super::format::{Description, FORMAT, Header, POSE_BYTES, Tagged, VERSION};
use super::{MOST_FRAMES, check};
use crate::gait::{Gait, JOINT_COUNT, Joint, JointSet, Pose};
use crate::glb;
use glam::Vec3;
use gltf_json::Root;
use gltf_json::validation::Checked::Valid;
use serde_json::Value;

/// The gaits of a file; the message says what is wrong with it.
pub(super) fn gaits(bytes: &[u8]) -> Result<Vec<Gait>, String> {
    let (text, binary) = glb::chunks(bytes)?;
    // Without the crate's validation, which panics on some damaged files; what is used here is checked here.
    let root = &Root::from_slice(text).map_err(|error| format!("not valid glTF: {error}"))?;
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

fn header(root: &Root) -> Result<(), String> {
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
fn position_bytes<'a>(root: &Root, binary: &'a [u8], index: usize) -> Result<&'a [u8], String> {
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
