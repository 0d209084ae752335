//! Expressions of VRM characters: what the file moves is what our faces move.

use crate::common::glb;
use gaitway::avatar::{Avatar, Loaded, RigMap, Sex, generated, load_bytes};
use gaitway::avatar::{Error, FaceVertex};
use glam::Vec3;
use serde_json::{Value, json};
use std::collections::BTreeMap;

/// Morph targets, by their numbers: how far they move every vertex of the first primitive.
const HAPPY: Vec3 = Vec3::new(0.0, 0.004, 0.001);
const ANGRY: Vec3 = Vec3::new(0.002, -0.001, 0.0);
const SAD: Vec3 = Vec3::new(0.0, -0.005, 0.0);
const OPEN: Vec3 = Vec3::new(0.0, -0.010, 0.0);
const BLINK: Vec3 = Vec3::new(0.0, 0.0, 0.003);
const TARGETS: [Vec3; 5] = [HAPPY, ANGRY, SAD, OPEN, BLINK];
const NAMES: [&str; 5] = ["happy", "angry", "sad", "aa", "blink"];
const OLD_NAMES: [&str; 5] = ["Joy", "angry", "sorrow", "A", "blink"];

/// How targets are written.
#[derive(Clone, Copy, PartialEq)]
enum Written {
    Whole,
    /// Every second vertex, by number; the others stay.
    Sparse,
}

/// A generated woman with these morph targets; `edit` changes the document.
fn file(written: Written, edit: impl Fn(&mut Value)) -> Vec<u8> {
    let (json, mut binary) = glb::parts(&gaitway::avatar::glb(&generated(Sex::Female)));
    let mut json: Value = serde_json::from_slice(&json).unwrap();
    let positions = &json["meshes"][0]["primitives"][0]["attributes"]["POSITION"];
    let count = u16::try_from(json["accessors"][number(positions)]["count"].as_u64().unwrap()).unwrap();
    let mut view = |json: &mut Value, bytes: Vec<u8>| {
        binary.resize(binary.len().next_multiple_of(4), 0);
        let views = json["bufferViews"].as_array_mut().unwrap();
        views.push(json!({ "buffer": 0, "byteOffset": binary.len(), "byteLength": bytes.len() }));
        binary.extend(bytes);
        views.len() - 1
    };
    let mut targets = Vec::new();
    for way in TARGETS {
        let moved: Vec<u16> = (0..count).step_by(if written == Written::Sparse { 2 } else { 1 }).collect();
        let values = moved.iter().flat_map(|_| way.to_array()).flat_map(f32::to_le_bytes).collect();
        let values = view(&mut json, values);
        let mut accessor = json!({ "componentType": 5126, "count": count, "type": "VEC3" });
        if written == Written::Sparse {
            let indices = view(&mut json, moved.iter().flat_map(|number| number.to_le_bytes()).collect());
            accessor["sparse"] = json!({
                "count": moved.len(),
                "indices": { "bufferView": indices, "componentType": 5123 },
                "values": { "bufferView": values },
            });
        } else {
            accessor["bufferView"] = values.into();
        }
        let accessors = json["accessors"].as_array_mut().unwrap();
        accessors.push(accessor);
        targets.push(json!({ "POSITION": accessors.len() - 1 }));
    }
    json["meshes"][0]["primitives"][0]["targets"] = targets.into();
    json["buffers"][0]["byteLength"] = binary.len().next_multiple_of(4).into();
    edit(&mut json);
    binary.resize(binary.len().next_multiple_of(4), 0);
    glb::file(json.to_string(), binary)
}

fn number(value: &Value) -> usize {
    usize::try_from(value.as_u64().unwrap()).unwrap()
}

/// Binds each expression to its morph target, as VRM 1.0 does.
fn new(json: &mut Value) {
    let node = json["nodes"].as_array().unwrap().iter().position(|node| node["mesh"] == 0).unwrap();
    for (target, name) in NAMES.iter().enumerate() {
        let bind = json!([{ "node": node, "index": target, "weight": 1.0 }]);
        json["extensions"]["VRMC_vrm"]["expressions"]["preset"][name] = json!({ "morphTargetBinds": bind });
    }
}

/// The same as VRM 0.x does.
fn old(json: &mut Value) {
    let groups = OLD_NAMES.iter().enumerate().map(|(target, name)| {
        json!({ "presetName": name, "binds": [{ "mesh": 0, "index": target, "weight": 100.0 }] })
    });
    let groups: Vec<Value> = groups.collect();
    json["extensions"]["VRM"]["blendShapeMaster"]["blendShapeGroups"] = groups.into();
}

fn read(file: &[u8], map: &RigMap) -> Result<Loaded, Error> {
    load_bytes("vrm", file, None, map)
}

fn face(written: Written, edit: impl Fn(&mut Value)) -> Avatar {
    read(&file(written, edit), &RigMap::default()).unwrap().avatar
}

/// Where a vertex goes with a mouth's numbers: corner and opening.
fn moved(own: &FaceVertex, corner: f32, open: f32) -> Vec3 {
    let corners = if corner > 0.0 { own.corners_up * corner } else { own.corners_down * -corner };
    corners + if open > 0.0 { own.opened * open } else { own.pressed * -open }
}

#[test]
fn faces_at_full_strength_are_those_of_the_file() {
    let avatar = face(Written::Whole, new);
    assert!(avatar.face.len() > 100, "{} vertices", avatar.face.len());
    for own in &avatar.face {
        // the numbers that shaders/eyes.wgsl gives a happy, an angry and a sad face
        for (want, corner, open) in [(HAPPY, 1.0, 0.4), (ANGRY, -0.35, -1.0), (SAD, -1.0, -0.05)] {
            let got = moved(own, corner, open);
            assert!(got.distance(want) < 1e-6, "{got}, not {want}");
        }
        assert!(own.opened.distance(OPEN) < 1e-6 && own.blink.distance(BLINK) < 1e-6, "{own:?}");
        assert!(own.inner_brow == Vec3::ZERO && own.fist == Vec3::ZERO);
    }
}

#[test]
fn both_versions_of_vrm_and_sparse_targets_are_read() {
    let vertices = |avatar: &Avatar| -> BTreeMap<u32, FaceVertex> {
        avatar.face.iter().map(|own| (own.vertex, *own)).collect()
    };
    let whole = vertices(&face(Written::Whole, new));
    assert_eq!(vertices(&face(Written::Whole, old)), whole);
    let sparse = vertices(&face(Written::Sparse, old));
    assert_eq!(sparse.len(), whole.len().div_ceil(2));
    let first = *whole.keys().next().unwrap();
    assert!(sparse.iter().all(|(number, own)| (number - first) % 2 == 0 && whole[number] == *own));
    // without expressions nothing moves, whatever targets there are
    assert!(face(Written::Whole, |_| {}).face.is_empty());
}

#[test]
fn expressions_grow_with_the_character() {
    let tall = |height: f32| {
        let map = RigMap::from_toml("map", &format!("height = {height:?}")).unwrap();
        read(&file(Written::Whole, new), &map).unwrap().avatar
    };
    let [small, large] = [1.0, 2.0].map(|height| tall(height).face[0].opened.length());
    assert!((large / small - 2.0).abs() < 1e-4, "{small} m and {large} m");
}

#[test]
fn what_a_file_does_not_have_is_an_error_that_says_where() {
    let message = |written, edit: &dyn Fn(&mut Value)| {
        read(&file(written, edit), &RigMap::default()).unwrap_err().to_string()
    };
    let missing = message(Written::Whole, &|json| {
        new(json);
        json["meshes"][0]["primitives"][0]["targets"].as_array_mut().unwrap().truncate(2);
    });
    assert!(missing.contains("has 2 morph targets, but the expression sad names number 2"), "{missing}");
    let fewer = message(Written::Whole, &|json| {
        new(json);
        let target = number(&json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]);
        json["accessors"][target]["count"] = 7.into();
    });
    assert!(fewer.contains("positions but 7 in morph target 0"), "{fewer}");
    let beyond = message(Written::Sparse, &|json| {
        new(json);
        let target = number(&json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"]);
        json["accessors"][target]["count"] = 200.into();
    });
    assert!(beyond.contains("is sparse and names element 200 of 200"), "{beyond}");
}
