//! Rigs that are not recognised, hats, glass, and files that are packed.

use crate::clips::picture;
use crate::loading::edited;
use crate::raster;
use gaitway::avatar::{Avatar, Error, Loaded, Material, RigMap, Sex, Vertex};
use gaitway::avatar::{generated, glb, load_bytes, retarget};
use gaitway::gait::{JOINT_COUNT, Joint};
use glam::{Mat4, Vec3};
use serde_json::json;

use crate::walker::Walker;

/// A man with his hands folded before him: his skeleton alone does not tell which joints are his hands.
fn folded() -> Avatar {
    let mut avatar = generated(Sex::Male);
    let rest = avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate());
    for hand in [Joint::LeftHand, Joint::RightHand] {
        let hand = hand as usize;
        let place = Vec3::new(0.04 * rest[hand].x.signum(), 1.0, 0.2);
        avatar.joints[hand].translation = place - rest[Joint::PARENT[hand]];
        avatar.joints[hand].joint_from_mesh = Mat4::from_translation(-place);
    }
    avatar
}

/// The file with its joints called otherwise.
fn renamed(file: &[u8], name: impl Fn(usize, &str) -> String) -> Vec<u8> {
    edited(file, |json| {
        for (i, node) in json["nodes"].as_array_mut().unwrap().iter_mut().enumerate().take(JOINT_COUNT) {
            node["name"] = name(i, node["name"].as_str().unwrap()).into();
        }
    })
}

fn read(file: &[u8], map: &RigMap) -> Result<Loaded, Error> {
    load_bytes("hero", file, None, map)
}

/// The map that a refused file comes with.
fn refused(file: &[u8], map: &RigMap) -> (String, String) {
    match read(file, map).unwrap_err() {
        Error::Rig { message, map, .. } => (message, map),
        other => panic!("{other}"),
    }
}

#[test]
fn a_rig_that_is_not_recognised_comes_with_a_map_which_filled_in_gives_the_same_character() {
    let file = glb(&folded());
    let known = read(&file, &RigMap::default()).unwrap();
    let strange = renamed(&file, |i, _| format!("Bone.{i:03}"));
    let (message, text) = refused(&strange, &RigMap::default());
    assert!(message.contains("left_hip") && message.contains("no humanoid"), "{message}");
    println!("{text}");
    let map = RigMap::from_toml("map", &text).unwrap();
    assert_eq!(map.avatar(), Some("hero"));
    for joint in Joint::ALL {
        assert!(text.contains(&format!("\n{} = \"\"  # ", joint.name())), "{}", joint.name());
        assert_eq!(map.name(joint), None);
        assert!(text.contains(&format!("\"Bone.{:03}\"  (", joint as usize)), "{}", joint.name());
    }
    // as it is it says nothing
    assert!(refused(&strange, &map).0.contains("no humanoid"));
    let mut filled = text.clone();
    for joint in Joint::ALL {
        let line = format!("\n{} = \"\"", joint.name());
        filled = filled.replace(&line, &format!("\n{} = \"Bone.{:03}\"", joint.name(), joint as usize));
    }
    let back = read(&strange, &RigMap::from_toml("map", &filled).unwrap()).unwrap();
    assert_eq!(back.avatar, known.avatar);
    let gait = Walker::at(1.2, 1.1).gait();
    assert_eq!(retarget(&gait, &back.avatar).unwrap(), retarget(&gait, &known.avatar).unwrap());
    // a wrong name, and one name twice: the map comes again, with what was right in it
    let (message, again) =
        refused(&strange, &RigMap::from_toml("map", &filled.replace("Bone.011", "Leg")).unwrap());
    assert!(
        message.contains("left_knee \"Leg\"") && again.contains("left_hip = \"Bone.010\"  # found"),
        "{message}"
    );
    let twice = filled.replace("left_foot = \"Bone.012\"", "left_foot = \"Bone.011\"");
    assert!(refused(&strange, &RigMap::from_toml("map", &twice).unwrap()).0.contains("\"Bone.011\""));
}

#[test]
fn what_a_map_guesses_from_the_tree_of_joints_is_right_and_nodes_without_names_have_numbers() {
    let file = glb(&folded());
    let strange = renamed(&file, |i, name| match i {
        6 | 9 => String::new(),
        10 => "Trousers".to_owned(),
        _ => name.to_owned(),
    });
    let (_, text) = refused(&strange, &RigMap::default());
    for line in [
        "left_hand = \"#6\"  # a guess",
        "right_hand = \"#9\"  # a guess",
        "left_hip = \"Trousers\"  # a guess",
        "right_hip = \"right_hip\"  # found",
    ] {
        assert!(text.contains(line), "{line}: {text}");
    }
    let back = read(&strange, &RigMap::from_toml("map", &text).unwrap()).unwrap().avatar;
    assert_eq!(back, read(&file, &RigMap::default()).unwrap().avatar);
}

#[test]
fn hands_named_palm_are_hands() {
    let file = glb(&folded());
    let known = read(&file, &RigMap::default()).unwrap().avatar;
    for [left, right] in [
        ["Palm.L", "Palm.R"],
        ["palm_l", "palm_r"],
        ["PalmL", "PalmR"],
        ["LeftPalm", "RightPalm"],
        ["leftpalm", "rightpalm"],
        ["lpalm", "rpalm"],
        ["Palm1.L", "Palm1.R"],
        ["palm_01_l", "palm_01_r"],
    ] {
        let palms = renamed(&file, |i, name| match i {
            6 => left.to_owned(),
            9 => right.to_owned(),
            _ => name.to_owned(),
        });
        assert_eq!(read(&palms, &RigMap::default()).unwrap().avatar, known, "{left}");
    }
}

/// The avatar with a cone on its head, brim and all.
fn hatted(plain: &Avatar, tall: f32) -> Avatar {
    let mut avatar = plain.clone();
    if tall <= 0.0 {
        return avatar;
    }
    let mesh = &mut avatar.levels[0];
    let vertex = |position: Vec3| Vertex {
        position,
        normal: Vec3::Y,
        color: Vec3::new(0.2, 0.1, 0.3),
        alpha: 1.0,
        material: Material::Fixed,
        joints: [Joint::Head as u8; 4],
        weights: [1.0, 0.0, 0.0, 0.0],
    };
    let size = plain.height;
    let brim = plain.height - 0.06 * size;
    let first = mesh.vertices.len() as u32;
    for (radius, y) in [(0.16 * size, brim), (0.07 * size, brim), (0.0, plain.height + tall)] {
        for k in 0..12 {
            let angle = std::f32::consts::TAU * k as f32 / 12.0;
            mesh.vertices.push(vertex(Vec3::new(radius * angle.sin(), y, radius * angle.cos())));
        }
    }
    for ring in 0..2 {
        for k in 0..12 {
            let at = |ring: u32, k: u32| first + ring * 12 + k % 12;
            mesh.indices.extend([at(ring, k), at(ring, k + 1), at(ring + 1, k + 1)]);
            mesh.indices.extend([at(ring, k), at(ring + 1, k + 1), at(ring + 1, k)]);
        }
    }
    avatar
}

#[test]
fn a_family_in_hats_comes_out_alike_in_scale_whatever_the_unit() {
    for (sex, unit) in [(Sex::Male, 1.0_f32), (Sex::Female, 1.4), (Sex::Male, 100.0)] {
        let plain = crate::rigs::with_joint_axes(&generated(sex), &[glam::Quat::IDENTITY; 16], unit);
        let bare = read(&glb(&plain), &RigMap::default()).unwrap().avatar;
        assert!((1.5..1.9).contains(&bare.height), "{}", bare.height);
        for tall in [0.1, 0.5, 1.0, 1.5] {
            let loaded = read(&glb(&hatted(&plain, tall * unit)), &RigMap::default()).unwrap();
            let (found, report) = (loaded.avatar, loaded.report.join("; "));
            let ratio = found.height / bare.height;
            let bones = found.joints[Joint::LeftKnee as usize].translation.length()
                / bare.joints[Joint::LeftKnee as usize].translation.length();
            assert!(
                (ratio - 1.0).abs() < 0.06 && (bones - 1.0).abs() < 0.06,
                "{tall}: {ratio} {bones} {report}"
            );
            assert!(
                tall < 0.5 || found.top() > found.height + 0.5 * tall,
                "the hat is there: {}",
                found.top()
            );
            let apart = (found.eyes_in_head - bare.eyes_in_head).abs();
            assert!(apart.y < 0.06 && apart.z < 0.1, "{} {}", found.eyes_in_head, bare.eyes_in_head);
        }
    }
    // and a height that is given
    let map = RigMap::from_toml("map", "height = 2.5").unwrap();
    let giant = read(&glb(&generated(Sex::Male)), &map).unwrap().avatar;
    assert!((giant.height - 2.5).abs() < 1e-3, "{}", giant.height);
}

#[test]
fn a_knight_without_and_with_his_helmet_is_as_tall() {
    let Some(folder) = crate::loading::characters() else { return };
    let file = std::fs::read(folder.join("kaykit/Knight.glb")).unwrap();
    let helmet = |scale: f32| {
        edited(&file, |json| {
            let nodes = json["nodes"].as_array_mut().unwrap();
            let helmet = nodes.iter_mut().find(|node| node["name"] == "Knight_Helmet").unwrap();
            helmet["scale"] = json!([scale, scale, scale]);
        })
    };
    let sizes = [0.01, 1.0, 2.5].map(|scale| {
        let avatar = read(&helmet(scale), &RigMap::default()).unwrap().avatar;
        println!("helmet x {scale}: {} m, to the top {} m", avatar.height, avatar.top());
        let mut sheet = raster::Sheet::new(2.0, 2.6, 150.0);
        sheet.draw(&avatar, 0, &raster::rest(&avatar), 0.5, 1.0, -0.1);
        sheet.save(&picture(&format!("knight-{scale}.png")));
        [avatar.height, avatar.joints[Joint::LeftKnee as usize].translation.length()]
    });
    // his unit is not known, so he is made 1.7 m: without the helmet, or his legs would tell
    for [height, thigh] in sizes {
        assert!((height - 1.7).abs() < 0.01 && (thigh / sizes[0][1] - 1.0).abs() < 0.01, "{sizes:?}");
    }
}

/// Glasses: two panes before the eyes.
fn bespectacled(alpha: f32) -> Avatar {
    let mut avatar = generated(Sex::Female);
    let head = avatar.joints[Joint::Head as usize].joint_from_mesh.inverse().w_axis.truncate();
    let eyes = head + avatar.eyes_in_head;
    let mesh = &mut avatar.levels[0];
    for side in [-1.0, 1.0] {
        let first = mesh.vertices.len() as u32;
        for (x, y) in [(-0.025, -0.02), (0.025, -0.02), (0.025, 0.02), (-0.025, 0.02)] {
            mesh.vertices.push(Vertex {
                position: eyes + Vec3::new(0.033 * side + x, y, 0.03),
                normal: Vec3::Z,
                color: Vec3::new(0.02, 0.02, 0.02),
                alpha,
                material: Material::Fixed,
                joints: [Joint::Head as u8; 4],
                weights: [1.0, 0.0, 0.0, 0.0],
            });
        }
        mesh.indices.extend([0, 1, 2, 0, 2, 3].map(|i| first + i));
    }
    avatar
}

#[test]
fn glass_keeps_its_alpha_cut_outs_are_cut_out_and_opaque_means_opaque() {
    let glasses = bespectacled(0.3);
    let file = glb(&glasses);
    let back = read(&file, &RigMap::default()).unwrap().avatar;
    let panes = |avatar: &Avatar, level: usize| {
        avatar.levels[level].vertices.iter().filter(|v| (v.alpha - 0.3).abs() < 1e-6).count()
    };
    assert_eq!(panes(&back, 0), 8);
    assert_eq!(back.levels[0].indices.len(), glasses.levels[0].indices.len());
    // farther away faces are seen, not glasses before them
    assert!((1..back.levels.len()).all(|level| back.levels[level].vertices.iter().all(|v| v.alpha >= 1.0)));
    let mode = |mode: &str, cutoff: f64| {
        edited(&file, |json| {
            for material in json["materials"].as_array_mut().unwrap() {
                if material["alphaMode"] == "BLEND" {
                    material["alphaMode"] = mode.into();
                    material["alphaCutoff"] = cutoff.into();
                }
            }
        })
    };
    let triangles = |file: &[u8]| read(file, &RigMap::default()).unwrap().avatar.levels[0].indices.len() / 3;
    let all = triangles(&file);
    assert_eq!((triangles(&mode("MASK", 0.5)), triangles(&mode("MASK", 0.25))), (all - 4, all));
    let opaque = edited(&mode("OPAQUE", 0.5), |json| {
        json["materials"].as_array_mut().unwrap().iter_mut().for_each(|m| {
            m.as_object_mut().unwrap().remove("alphaCutoff");
        });
    });
    let opaque = read(&opaque, &RigMap::default()).unwrap().avatar;
    assert!(opaque.levels[0].vertices.iter().all(|v| v.alpha >= 1.0));
}

#[test]
fn packed_files_are_refused_by_name_with_the_command_that_unpacks_them() {
    let good = glb(&generated(Sex::Male));
    let refused = |edit: &dyn Fn(&mut serde_json::Value)| {
        let error = read(&edited(&good, edit), &RigMap::default()).unwrap_err();
        assert!(matches!(error, Error::Packed { .. }), "{error}");
        (error.to_string(), error.hint().unwrap().to_owned())
    };
    for (extension, command) in [
        ("KHR_draco_mesh_compression", "gltf-transform/cli copy IN.glb OUT.glb"),
        ("EXT_meshopt_compression", "gltf-transform/cli dequantize IN.glb OUT.glb"),
        ("KHR_mesh_quantization", "gltf-transform/cli dequantize IN.glb OUT.glb"),
        ("KHR_texture_basisu", "gltf-transform/cli ktxdecompress IN.glb OUT.glb"),
        ("EXT_texture_webp", "gltf-transform/cli png IN.glb OUT.glb"),
    ] {
        let (message, hint) =
            refused(&|json| json["extensionsRequired"] = json!(["KHR_materials_unlit", extension]));
        assert!(message.contains(extension) && message.contains("hero"), "{message}");
        assert!(hint.contains(command), "{hint}");
    }
    // not required, but there is nothing else in the file
    let (message, _) = refused(&|json| {
        let position =
            json["meshes"][0]["primitives"][0]["attributes"]["POSITION"].as_u64().unwrap() as usize;
        json["accessors"][position].as_object_mut().unwrap().remove("bufferView");
        json["meshes"][0]["primitives"][0]["extensions"] =
            json!({ "KHR_draco_mesh_compression": { "bufferView": 0 } });
    });
    assert!(message.contains("KHR_draco_mesh_compression"), "{message}");
    let (message, _) = refused(&|json| {
        json["textures"] = json!([{ "extensions": { "KHR_texture_basisu": { "source": 0 } } }]);
    });
    assert!(message.contains("KHR_texture_basisu"), "{message}");
}
