//! Characters as others make them: loading, units, names, broken files.

use crate::clips::{contact, picture, pose, roughness};
use crate::common::{self, data_set};
use crate::raster::{self, Sheet, rest};
use crate::rigs;
use crate::walker::Walker;
use gaitway::Emotion;
use gaitway::avatar::{Avatar, CLIP_FRAMES, Error, Loaded, RigMap, Sex};
use gaitway::avatar::{generated, glb, load_bytes, load_with_map, retarget, standing, write_glb};
use gaitway::gait::Joint;
use glam::{Quat, Vec3};
use std::path::PathBuf;

/// Where the characters made by others lie, if they are there.
pub fn characters() -> Option<PathBuf> {
    data_set("characters")
}

fn character_files() -> Vec<PathBuf> {
    let Some(folder) = characters() else {
        println!("skipped: no characters beside the repository and GAITWAY_DATA is not set");
        return Vec::new();
    };
    let mut files: Vec<PathBuf> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|entry| std::fs::read_dir(entry.unwrap().path()).ok())
        .flatten()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "glb" || e == "vrm"))
        .collect();
    files.sort();
    files
}

fn no_limb_is_flipped(name: &str, model: &[Vec3; 16]) {
    let at = |joint: Joint| model[joint as usize];
    assert!(
        at(Joint::Head).y > at(Joint::Spine).y && at(Joint::Spine).y > at(Joint::Root).y,
        "{name}: upside down"
    );
    assert!(at(Joint::LeftElbow).y < at(Joint::LeftShoulder).y, "{name}: an arm points up");
    for (upper, sign) in [
        (Joint::LeftHip, 1.0),
        (Joint::RightHip, 1.0),
        (Joint::LeftShoulder, -1.0),
        (Joint::RightShoulder, -1.0),
    ] {
        let [a, b, c] = [0, 1, 2].map(|k| model[upper as usize + k]);
        let bend = (b - a).cross(c - b).x * sign;
        assert!(bend > -1e-3, "{name}: the limb below {} bends the wrong way: {bend}", upper.name());
    }
    for joint in [Joint::LeftHand, Joint::LeftFoot, Joint::LeftKnee] {
        assert!(at(joint).x > at(joint.mirrored()).x, "{name}: {} is on the right", joint.name());
    }
}

#[test]
fn every_character_walks_or_is_refused_with_a_reason() {
    let gait = Walker::at(1.2, 1.1).gait();
    for file in character_files() {
        let stem = file.file_stem().unwrap().to_string_lossy().into_owned();
        let loaded = match load_with_map(&file, &RigMap::default()) {
            Ok(loaded) => loaded,
            Err(error) => {
                println!("{stem}: refused: {error}");
                assert_eq!(stem, "RiggedSimple", "{error}");
                assert!(error.to_string().contains("no humanoid"), "{error}");
                continue;
            }
        };
        let avatar = loaded.avatar;
        let joints = rest(&avatar);
        let model = avatar.model_from_joint(&joints.rotations, joints.root).map(|m| m.w_axis.truncate());
        println!("{stem}: {}\n    eyes {} ", loaded.report.join("\n    "), avatar.eyes_in_head);
        let legs = model[Joint::LeftHip as usize].y - model[Joint::LeftFoot as usize].y;
        for joint in Joint::ALL.into_iter().filter(|&joint| joint.mirrored() > joint) {
            let (left, right) = (model[joint as usize], model[joint.mirrored() as usize]);
            assert!(left.x > right.x, "{stem}: {} is on the right", joint.name());
        }
        let clip = retarget(&gait, &avatar).unwrap();
        let c = contact(&avatar, &clip);
        println!("    travel {:.3} rough {:.3} {c:?}", clip.stride_travel, roughness(&clip));
        assert!(c.slide < 0.02 && c.low > -0.01, "{stem}: {c:?}");
        // the gait's own knees turn by up to 0.25 before they strike
        assert!(roughness(&clip) < 0.3, "{stem}: {}", roughness(&clip));
        assert!((clip.stride_travel / legs - gait.stride_travel() / 0.84).abs() < 0.25);
        for frame in 0..CLIP_FRAMES {
            no_limb_is_flipped(&stem, &pose(&avatar, &clip, frame).map(|m| m.w_axis.truncate()));
        }
        let mut sheet = Sheet::new(7.0, 2.5, 200.0);
        sheet.draw(&avatar, 0, &rest(&avatar), 0.5, 1.6, -0.1);
        sheet.draw(&avatar, 0, &standing(&avatar, Emotion::Neutral, 0).frames[0], 0.3, 1.0, -0.1);
        for frame in [0, 16] {
            sheet.draw(&avatar, 0, &clip.frames[frame], 1.57, 1.1, -0.1);
        }
        sheet.draw(&avatar, 0, &clip.frames[40], 0.4, 0.9, -0.1);
        let last = avatar.levels.len() - 1;
        sheet.draw(&avatar, last.min(1), &clip.frames[40], 0.4, 0.8, -0.1);
        sheet.draw(&avatar, last, &clip.frames[40], 0.4, 0.7, -0.1);
        sheet.save(&picture(&format!("loaded-{stem}.png")));
    }
}

/// Some joint axes, none of them special.
fn odd_axes() -> [Quat; 16] {
    std::array::from_fn(|j| {
        let t = j as f32;
        Quat::from_euler(glam::EulerRot::XYZ, 1.3 * t, 0.7 - 0.9 * t, 2.1 * t)
    })
}

fn read(bytes: &[u8]) -> Result<Loaded, Error> {
    load_bytes("test", bytes, None, &RigMap::default())
}

#[test]
fn joint_axes_of_a_rig_do_not_change_what_is_seen() {
    let gait = Walker::at(1.2, 1.1).gait();
    for sex in Sex::ALL {
        let plain = generated(sex);
        let odd = rigs::with_joint_axes(&plain, &odd_axes(), 1.0);
        for (a, b) in [
            (retarget(&gait, &plain).unwrap(), retarget(&gait, &odd).unwrap()),
            (standing(&plain, Emotion::Angry, 1), standing(&odd, Emotion::Angry, 1)),
        ] {
            assert!(roughness(&b) < 0.25);
            for frame in [0, 20, 45] {
                let a = raster::skin(&plain, &plain.levels[0], &a.frames[frame]);
                let b = raster::skin(&odd, &odd.levels[0], &b.frames[frame]);
                let apart = a.iter().zip(&b).map(|(a, b)| a.0.distance(b.0)).fold(0.0, f32::max);
                assert!(apart < 1e-3, "vertices differ by {apart} m");
            }
        }
    }
}

#[test]
fn a_written_avatar_is_read_back_whatever_its_unit_and_joint_axes() {
    for sex in Sex::ALL {
        let plain = generated(sex);
        for (axes, size) in
            [([Quat::IDENTITY; 16], 1.0), (odd_axes(), 1.0), (odd_axes(), 100.0), (odd_axes(), 1000.0)]
        {
            let loaded = read(&glb(&rigs::with_joint_axes(&plain, &axes, size))).unwrap();
            let (back, report) = (loaded.avatar, loaded.report.join("; "));
            assert!((back.height - plain.height).abs() < 1e-3, "{report}");
            for (a, b) in plain.joints.iter().zip(&back.joints) {
                assert!(a.translation.distance(b.translation) < 1e-3, "{report}");
            }
            assert_eq!(back.levels[0].indices.len(), plain.levels[0].indices.len());
            let sum = |avatar: &Avatar| -> (Vec3, usize) {
                let mesh = &avatar.levels[0];
                let corners = mesh.indices.iter().map(|&i| mesh.vertices[i as usize]);
                let tinted =
                    corners.clone().filter(|v| v.material != gaitway::avatar::Material::Fixed).count();
                (corners.map(|v| v.position * (1.0 + v.color.x)).sum(), tinted)
            };
            let ((a, tinted), (b, back_tinted)) = (sum(&plain), sum(&back));
            let corners = plain.levels[0].indices.len() as f32;
            assert!(a.distance(b) < 5e-5 * size.min(1.0) * corners && tinted == back_tinted, "{a} {b}");
        }
        let inches = read(&glb(&rigs::with_joint_axes(&plain, &odd_axes(), 100.0))).unwrap();
        assert!(inches.report.iter().any(|line| line.contains("centimetres")), "{:?}", inches.report);
    }
}

/// The file with its JSON changed; the binary part stays.
pub fn edited(file: &[u8], edit: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
    let (json, binary) = common::glb::parts(file);
    let mut json = serde_json::from_slice(&json).unwrap();
    edit(&mut json);
    common::glb::file(json.to_string(), binary)
}

#[test]
fn feet_hung_under_the_root_follow_the_lower_leg() {
    let plain = generated(Sex::Male);
    let file = edited(&glb(&plain), |json| {
        for (foot, knee) in [(12, 11), (15, 14)] {
            json["nodes"][knee].as_object_mut().unwrap().remove("children");
            json["nodes"][0]["children"].as_array_mut().unwrap().push(foot.into());
            // The rest rotations are the identity, so the place in the root's space is a sum.
            let chain = if foot == 12 { [10, 11, 12] } else { [13, 14, 15] };
            let place: Vec3 = chain.iter().map(|&j| plain.joints[j].translation).sum();
            json["nodes"][foot]["translation"] = serde_json::json!(place.to_array());
        }
    });
    let back = read(&file).unwrap().avatar;
    for (a, b) in plain.joints.iter().zip(&back.joints) {
        assert!(a.translation.distance(b.translation) < 1e-4);
    }
}

#[test]
fn turned_tipped_and_onlooker_named_characters_come_out_alike() {
    let plain = generated(Sex::Male);
    let expected = read(&glb(&plain)).unwrap().avatar;
    let turned = |by: Quat| {
        edited(&glb(&plain), |json| {
            let parent = serde_json::json!({ "name": "world", "rotation": by.to_array(), "children": [0] });
            json["nodes"].as_array_mut().unwrap().push(parent);
            json["scenes"][0]["nodes"] = serde_json::json!([17, 16]);
        })
    };
    let exchanged = edited(&glb(&plain), |json| {
        for node in json["nodes"].as_array_mut().unwrap() {
            let name = node["name"].as_str().unwrap();
            node["name"] = match name.split_once('_') {
                Some(("left", part)) => format!("right_{part}"),
                Some(("right", part)) => format!("left_{part}"),
                _ => name.to_owned(),
            }
            .into();
        }
    });
    for (file, said) in [
        (turned(Quat::from_rotation_y(1.0)), "facing: turned by -57"),
        (turned(Quat::from_rotation_x(std::f32::consts::FRAC_PI_2)), "up: "),
        (exchanged, "left and right were exchanged"),
    ] {
        let found = read(&file).unwrap();
        assert!(found.report.iter().any(|line| line.contains(said)), "{:?}", found.report);
        for (a, b) in expected.joints.iter().zip(&found.avatar.joints) {
            assert!(
                a.translation.distance(b.translation) < 1e-3,
                "{said}: {} {}",
                a.translation,
                b.translation
            );
        }
        let far =
            |avatar: &Avatar| avatar.levels[0].vertices.iter().map(|v| v.position.z).fold(0.0, f32::max);
        assert!((far(&expected) - far(&found.avatar)).abs() < 2e-3, "{said}: the toes point elsewhere");
    }
}

/// The files in `assets/avatars` are what this program writes; `GAITWAY_UPDATE_ASSETS=1` rewrites them.
#[test]
fn shipped_avatars_are_the_generated_ones() {
    for sex in Sex::ALL {
        let path =
            PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("assets/avatars/{}.glb", sex.name()));
        let avatar = generated(sex);
        if std::env::var_os("GAITWAY_UPDATE_ASSETS").is_some() {
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            write_glb(&avatar, &path).unwrap();
        }
        let shipped = load_with_map(&path, &RigMap::default()).unwrap().avatar;
        let fresh = read(&glb(&avatar)).unwrap().avatar;
        assert_eq!(shipped.levels[0].indices, fresh.levels[0].indices, "run with GAITWAY_UPDATE_ASSETS=1");
        for (a, b) in shipped.levels[0].vertices.iter().zip(&fresh.levels[0].vertices) {
            assert!(a.position.distance(b.position) < 1e-4, "run with GAITWAY_UPDATE_ASSETS=1");
        }
    }
}

#[test]
fn vrm_names_and_rig_maps_are_followed() {
    let plain = generated(Sex::Female);
    let nameless = edited(&glb(&plain), |json| {
        for (i, node) in json["nodes"].as_array_mut().unwrap().iter_mut().enumerate() {
            node["name"] = format!("node {i}").into();
        }
    });
    let bones = [
        "hips",
        "spine",
        "neck",
        "head",
        "leftUpperArm",
        "leftLowerArm",
        "leftHand",
        "rightUpperArm",
        "rightLowerArm",
        "rightHand",
        "leftUpperLeg",
        "leftLowerLeg",
        "leftFoot",
        "rightUpperLeg",
        "rightLowerLeg",
        "rightFoot",
    ];
    let old = edited(&nameless, |json| {
        let list: Vec<_> = bones
            .iter()
            .enumerate()
            .map(|(node, bone)| serde_json::json!({ "bone": bone, "node": node }))
            .collect();
        json["extensions"] = serde_json::json!({ "VRM": { "humanoid": { "humanBones": list } } });
    });
    let new = edited(&nameless, |json| {
        let mut object = serde_json::Map::new();
        for (node, bone) in bones.iter().enumerate() {
            object.insert((*bone).to_owned(), serde_json::json!({ "node": node }));
        }
        let eyes = serde_json::json!({ "offsetFromHeadBone": [0.0, 0.06, 0.1] });
        json["extensions"] =
            serde_json::json!({ "VRMC_vrm": { "humanoid": { "humanBones": object }, "lookAt": eyes } });
    });
    assert!(read(&old).unwrap().report[0].contains("VRM"));
    let new = read(&new).unwrap();
    assert_eq!(new.avatar.eyes_in_head, Vec3::new(0.0, 0.06, 0.1));
    assert_eq!(new.avatar.joints[5].translation, read(&glb(&plain)).unwrap().avatar.joints[5].translation);
    let map = Joint::ALL
        .iter()
        .fold(RigMap::default(), |map, &joint| map.with(joint, &format!("node {}", joint as usize)));
    load_bytes("test", &nameless, None, &map).unwrap();
    let wrong = RigMap::default().with(Joint::LeftKnee, "patella");
    let message = load_bytes("test", &nameless, None, &wrong).unwrap_err().to_string();
    assert!(message.contains("left_knee") && message.contains("patella"), "{message}");
}

#[test]
fn malformed_files_are_refused_with_their_fault_and_never_panic() {
    let good = glb(&generated(Sex::Male));
    let refused = |edit: &dyn Fn(&mut serde_json::Value)| {
        read(&edited(&good, edit)).map(|loaded| loaded.report).unwrap_err().to_string()
    };
    assert!(read(b"").unwrap_err().to_string().contains("neither GLB nor glTF"));
    assert!(read(&good[..good.len() / 2]).is_err());
    let message = refused(&|json| json["skins"] = serde_json::json!([]));
    assert!(message.contains("skin"), "{message}");
    let message = refused(&|json| json["accessors"][0]["count"] = 4_000_000_000_u32.into());
    assert!(message.contains("accessor 0 claims 4000000000 elements"), "{message}");
    let message = refused(&|json| json["bufferViews"][1]["byteLength"] = 400_000_000.into());
    assert!(message.contains("buffer"), "{message}");
    let message = refused(&|json| json["nodes"][3]["children"] = serde_json::json!([0]));
    assert!(message.contains("loop") || message.contains("parent"), "{message}");
    let message =
        refused(&|json| json["extensionsRequired"] = serde_json::json!(["KHR_draco_mesh_compression"]));
    assert!(message.contains("draco"), "{message}");
    let message = refused(&|json| json["buffers"][0]["uri"] = "../../secret.bin".into());
    assert!(message.contains("leaves the folder"), "{message}");
    let message = refused(&|json| json["asset"]["version"] = "1.0".into());
    assert!(!message.is_empty());
    // A NaN position, an index past the end, a joint past the skin.
    let spoilt = |accessor: usize, bytes: [u8; 4]| {
        let mut at = 0;
        edited(&good, |json| {
            let view = json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
            assert!(json["bufferViews"][view]["byteOffset"].is_u64());
        });
        let length = u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
        let json: serde_json::Value = serde_json::from_slice(&good[20..20 + length]).unwrap();
        let view = json["accessors"][accessor]["bufferView"].as_u64().unwrap() as usize;
        at += 28 + length + json["bufferViews"][view]["byteOffset"].as_u64().unwrap() as usize;
        let mut file = good.clone();
        file[at..at + 4].copy_from_slice(&bytes);
        read(&file).map(|loaded| loaded.report).unwrap_err().to_string()
    };
    let accessors = |name: &str| -> usize {
        let length = u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
        let json: serde_json::Value = serde_json::from_slice(&good[20..20 + length]).unwrap();
        let primitive = &json["meshes"][0]["primitives"][0];
        let found = if name == "indices" { &primitive["indices"] } else { &primitive["attributes"][name] };
        found.as_u64().unwrap() as usize
    };
    assert!(spoilt(accessors("POSITION"), f32::NAN.to_le_bytes()).contains("not finite"));
    assert!(spoilt(accessors("indices"), 77_777_u32.to_le_bytes()).contains("index 77777"));
    assert!(spoilt(accessors("JOINTS_0"), [99; 4]).contains("joint 99"));
}

#[test]
fn no_change_of_a_file_makes_the_loader_panic() {
    let good = glb(&generated(Sex::Female));
    let mut state = 12345_u32;
    let mut random = |most: usize| {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        state as usize % most
    };
    let length = u32::from_le_bytes(good[12..16].try_into().unwrap()) as usize;
    for _ in 0..150 {
        let mut file = good.clone();
        for _ in 0..=random(4) {
            // Mostly digits and keys of the JSON, where the claims stand.
            let (from, room) = if random(4) == 0 { (0, file.len()) } else { (20, length) };
            let at = from + random(room);
            file[at] = if file[at].is_ascii_digit() { b'0' + random(10) as u8 } else { random(256) as u8 };
        }
        let _ = read(&file);
    }
    for cut in (0..good.len()).step_by(good.len() / 60) {
        assert!(read(&good[..cut]).is_err());
    }
    // Every number of the document, made huge, negative or zero.
    let json: serde_json::Value = serde_json::from_slice(&good[20..20 + length]).unwrap();
    let mut paths = Vec::new();
    numbers(&json, &mut String::new(), &mut paths);
    for path in paths.iter().step_by(3) {
        for value in [
            serde_json::json!(-1),
            serde_json::json!(0),
            serde_json::json!(4_294_967_295_u32),
            serde_json::json!(1e300),
        ] {
            let _ = read(&edited(&good, |json| *json.pointer_mut(path).unwrap() = value.clone()));
        }
    }
}

fn numbers(value: &serde_json::Value, path: &mut String, found: &mut Vec<String>) {
    let inner: Vec<(String, &serde_json::Value)> = match value {
        serde_json::Value::Number(_) => return found.push(path.clone()),
        serde_json::Value::Array(list) => list.iter().enumerate().map(|(i, v)| (i.to_string(), v)).collect(),
        serde_json::Value::Object(map) => map.iter().map(|(k, v)| (k.clone(), v)).collect(),
        _ => return,
    };
    for (key, value) in inner {
        let length = path.len();
        path.push('/');
        path.push_str(&key);
        numbers(value, path, found);
        path.truncate(length);
    }
}
