//! Avatars: generated and loaded bodies, driven by gaits. Pictures go to `target/avatar/`.
#![allow(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    missing_debug_implementations,
    unreachable_pub,
    reason = "test helpers"
)]

#[path = "avatar/raster.rs"]
mod raster;
#[path = "avatar/rigs.rs"]
mod rigs;
#[path = "avatar/walker.rs"]
mod walker;

use gaitway::avatar::{
    Avatar, CLIP_FRAMES, Clip, Error, Loaded, RigMap, Sex, generated, glb, load_bytes, load_with_map,
    retarget, standing,
};
use gaitway::gait::Joint;
use glam::{Mat4, Quat, Vec3};
use raster::{Sheet, rest};
use std::path::PathBuf;
use walker::{Walker, mirrored};

const WALKS: [(f32, f32); 4] = [(0.5, 1.5), (0.9, 1.25), (1.35, 1.08), (1.75, 0.95)];

fn picture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("target/avatar").join(name)
}

fn pose(avatar: &Avatar, clip: &Clip, frame: usize) -> [Mat4; 16] {
    let frame = &clip.frames[frame % CLIP_FRAMES];
    avatar.model_from_joint(&frame.rotations, frame.root)
}

/// What the sole of a foot does over a cycle.
#[derive(Debug, Clone, Copy, Default)]
struct Contact {
    /// Largest slide of a sole vertex on the ground between frames, summed over the time it stays there, m.
    slide: f32,
    /// Lowest and highest "lowest point of this foot" while planted, m.
    low: f32,
    /// Frames in which the foot touches the ground.
    planted: usize,
    /// Highest lowest point during the cycle, m.
    clearance: f32,
    /// Frames in which no foot touches.
    airborne: usize,
}

/// Follows every vertex of a foot in the world (the body advances with phase): a vertex lower than 6 mm counts as
/// touching the ground, and its way while it touches counts as slide.
fn contact(avatar: &Avatar, clip: &Clip) -> Contact {
    let mesh = &avatar.levels[0];
    let mut result = Contact::default();
    let mut touching = [false; CLIP_FRAMES];
    for foot in [Joint::LeftFoot, Joint::RightFoot] {
        let hang = |joint: usize| -> Vec<(usize, Vec3)> {
            let own =
                mesh.vertices.iter().filter(|v| usize::from(v.joints[0]) == joint && v.weights[0] > 0.9);
            own.filter(|v| v.position.y < 0.05).map(|v| (joint, v.position)).collect()
        };
        // A peg leg has no foot.
        let own = hang(foot as usize);
        let vertices = if own.is_empty() { hang(foot as usize - 1) } else { own };
        let at = |frame: usize, (joint, p): (usize, Vec3)| {
            let model = pose(avatar, clip, frame)[joint] * avatar.joints[joint].joint_from_mesh;
            model.transform_point3(p) + Vec3::Z * clip.stride_travel * frame as f32 / CLIP_FRAMES as f32
        };
        let frames: Vec<Vec<Vec3>> =
            (0..=2 * CLIP_FRAMES).map(|frame| vertices.iter().map(|&p| at(frame, p)).collect()).collect();
        let lowest: Vec<f32> =
            frames.iter().map(|f| f.iter().map(|p| p.y).fold(f32::MAX, f32::min)).collect();
        for (frame, &low) in lowest.iter().take(CLIP_FRAMES).enumerate() {
            result.low = result.low.min(low);
            result.clearance = result.clearance.max(low);
            if low < 0.006 {
                result.planted += 1;
                touching[frame] = true;
            }
        }
        for v in 0..vertices.len() {
            let mut slide = 0.0;
            for frame in 1..frames.len() {
                let (a, b) = (frames[frame - 1][v], frames[frame][v]);
                slide = if a.y < 0.006 && b.y < 0.006 { slide + (b - a).with_y(0.0).length() } else { 0.0 };
                if slide > 0.02 && (a - b).length() > 1e-3 && std::env::var_os("SLIDE").is_some() {
                    println!(
                        "{} v{v} {:?} frame {frame} y {} z {} -> {}",
                        foot.name(),
                        vertices[v],
                        b.y,
                        a.z,
                        b.z
                    );
                }
                result.slide = result.slide.max(slide);
            }
        }
    }
    result.airborne = touching.iter().filter(|t| !**t).count();
    result
}

#[test]
fn planted_feet_stand_still_on_both_bodies_at_every_speed() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for (speed, time) in WALKS {
            let clip = retarget(&Walker::at(speed, time).gait(), &avatar).unwrap();
            let c = contact(&avatar, &clip);
            println!("{} {speed} m/s: travel {:.3} {c:?}", avatar.name, clip.stride_travel);
            assert!(c.slide < 0.02, "{} at {speed} m/s: a planted vertex slides {} m", avatar.name, c.slide);
            assert!(c.low > -0.012, "{} at {speed} m/s: a sole sinks to {} m", avatar.name, c.low);
            assert_eq!(c.airborne, 0, "{} at {speed} m/s floats", avatar.name);
            assert!((0.03..0.3).contains(&c.clearance), "feet are lifted {} m", c.clearance);
            assert!((64..96).contains(&c.planted), "{} of 128 foot frames are planted", c.planted);
            assert!((clip.speed - clip.stride_travel / time).abs() < 1e-4);
        }
    }
}

/// Largest difference of a clip's rotations between neighbouring frames, radians, the loop included.
fn roughness(clip: &Clip) -> f32 {
    let n = clip.frames.len();
    let step = |i: usize, j: usize| {
        let (a, b) = (clip.frames[i].rotations[j], clip.frames[(i + 1) % n].rotations[j]);
        assert!(a.dot(b) > 0.0, "frames {i} and {} of joint {j} are in different hemispheres", (i + 1) % n);
        assert!((a.length() - 1.0).abs() < 1e-4);
        a.angle_between(b)
    };
    (0..n).flat_map(|i| (0..16).map(move |j| (i, j))).map(|(i, j)| step(i, j)).fold(0.0, f32::max)
}

#[test]
fn clips_loop_smoothly_and_bodies_keep_their_shape() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for (speed, time) in WALKS {
            let gait = Walker::at(speed, time).gait();
            let clip = retarget(&gait, &avatar).unwrap();
            assert_eq!(clip.frames.len(), CLIP_FRAMES);
            let rough = roughness(&clip);
            assert!(rough < 0.25, "{} at {speed} m/s turns {rough} rad in a 64th of a cycle", avatar.name);
            for frame in 0..CLIP_FRAMES {
                let model = pose(&avatar, &clip, frame).map(|m| m.w_axis.truncate());
                let at = |joint: Joint| model[joint as usize];
                let head = at(Joint::Head).y / avatar.height;
                assert!((0.83..0.91).contains(&head), "head at {head} of the height");
                for joint in [Joint::LeftHip, Joint::LeftShoulder, Joint::LeftFoot, Joint::LeftHand] {
                    assert!(at(joint).x > at(joint.mirrored()).x, "{} is on the right", joint.name());
                }
                for hip in [Joint::LeftHip, Joint::RightHip] {
                    let [hip, knee, foot] = [0, 1, 2].map(|k| model[hip as usize + k]);
                    let bend = (knee - hip).cross(foot - knee).x;
                    assert!(bend > -1e-4, "a knee bends backwards in frame {frame}: {bend}");
                }
            }
        }
    }
}

#[test]
fn arms_and_back_point_where_the_gait_points() {
    let gait = Walker { slump: 0.3, frames: CLIP_FRAMES, ..Walker::at(0.9, 1.25) }.gait();
    let avatar = generated(Sex::Male);
    let clip = retarget(&gait, &avatar).unwrap();
    for frame in [0, 13, 32, 50] {
        let model = pose(&avatar, &clip, frame).map(|m| m.w_axis.truncate());
        for (from, to) in [(4, 5), (5, 6), (7, 8), (8, 9)] {
            let wanted = (gait.poses[frame][to] - gait.poses[frame][from]).normalize();
            let found = (model[to] - model[from]).normalize();
            // The arms may be spread a little for a broader body.
            assert!(wanted.angle_between(found) < 0.15, "joint {to} frame {frame}: {wanted} {found}");
        }
        let back = (model[Joint::Neck as usize] - model[Joint::Root as usize]).normalize();
        assert!((back.z.asin() - 0.3).abs() < 0.08, "back leans {} rad", back.z.asin());
    }
}

#[test]
fn a_mirrored_gait_gives_a_mirrored_clip() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let gait = Walker::at(1.2, 1.1).gait();
        let clip = retarget(&gait, &avatar).unwrap();
        let other = retarget(&mirrored(&gait), &avatar).unwrap();
        assert!((clip.stride_travel - other.stride_travel).abs() < 1e-5);
        for (a, b) in clip.frames.iter().zip(&other.frames) {
            assert!((a.root * Vec3::new(-1.0, 1.0, 1.0)).distance(b.root) < 1e-4);
            for joint in Joint::ALL {
                let q = a.rotations[joint as usize];
                let mirror = Quat::from_xyzw(q.x, -q.y, -q.z, q.w);
                let angle = mirror.angle_between(b.rotations[joint.mirrored() as usize]);
                assert!(angle < 2e-3, "{} differs by {angle} rad", joint.name());
            }
        }
    }
}

#[test]
fn metres_scale_with_the_leg_and_time_does_not() {
    let avatar = generated(Sex::Female);
    let small = Walker { size: 0.5, ..Walker::at(0.6, 1.0) };
    let large = Walker { size: 2.0, ..Walker::at(2.4, 1.0) };
    let (small, large) =
        (retarget(&small.gait(), &avatar).unwrap(), retarget(&large.gait(), &avatar).unwrap());
    assert!((small.stride_travel - large.stride_travel).abs() < 1e-4);
    for (a, b) in small.frames.iter().zip(&large.frames) {
        assert!(a.root.distance(b.root) < 1e-4);
    }
}

#[test]
fn standing_bodies_keep_both_feet_flat_and_hands_by_their_sides() {
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let clip = standing(&avatar);
        assert_eq!((clip.frames.len(), clip.stride_travel, clip.speed), (CLIP_FRAMES, 0.0, 0.0));
        let c = contact(&avatar, &clip);
        assert!(c.planted == 2 * CLIP_FRAMES && c.slide < 0.002 && c.low > -0.002, "{c:?}");
        assert!(roughness(&clip) < 0.01);
        let model = pose(&avatar, &clip, 0).map(|m| m.w_axis.truncate());
        assert!(model[Joint::LeftHand as usize].y < model[Joint::Root as usize].y);
        assert!(model[Joint::Head as usize].y > 0.86 * avatar.height);
    }
}

#[test]
fn unusable_gaits_are_refused_with_the_value_found() {
    let avatar = generated(Sex::Male);
    let good = Walker::at(1.2, 1.1).gait();
    let refused = |change: &dyn Fn(&mut gaitway::gait::Gait)| {
        let mut gait = good.clone();
        change(&mut gait);
        retarget(&gait, &avatar).unwrap_err().to_string()
    };
    assert!(refused(&|g| g.poses.truncate(3)).contains("has 3 frames"));
    assert!(refused(&|g| g.poses[7][5].x = f32::NAN).contains("frame 7: joint left_elbow"));
    assert!(refused(&|g| g.frame_rate = 0.0).contains("0 Hz"));
    assert!(refused(&|g| g.speed = -1.0).contains("-1 m/s"));
    assert!(
        refused(&|g| g.poses.iter_mut().flatten().for_each(|p| *p = Vec3::Y)).contains("legs are 0 m long")
    );
    let mut legless = avatar.clone();
    legless.joints[Joint::LeftKnee as usize].translation = Vec3::ZERO;
    assert!(retarget(&good, &legless).unwrap_err().to_string().contains("left_hip"));
    assert_eq!(standing(&legless).frames.len(), CLIP_FRAMES);
}

#[test]
fn draws_the_bodies() {
    let mut sheet = Sheet::new(4.8, 1.9, 300.0);
    let mut faces = Sheet::new(2.0, 0.5, 900.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for turn in [0.0, 0.7, 1.57, 3.14] {
            sheet.draw(&avatar, 0, &rest(&avatar), turn, 0.6, -0.05);
        }
        for turn in [0.0, 0.7, 1.57, 3.14] {
            faces.draw(&avatar, 0, &rest(&avatar), turn, 0.25, avatar.height - 0.42);
        }
    }
    sheet.save(&picture("bodies.png"));
    faces.save(&picture("faces.png"));
    let mut levels = Sheet::new(3.6, 1.9, 300.0);
    for sex in Sex::ALL {
        let avatar = generated(sex);
        for level in 0..3 {
            levels.draw(&avatar, level, &rest(&avatar), 0.5, 0.6, -0.05);
        }
    }
    levels.save(&picture("levels.png"));
    for sex in Sex::ALL {
        let avatar = generated(sex);
        let clip = retarget(&Walker::at(1.35, 1.08).gait(), &avatar).unwrap();
        let mut walk = Sheet::new(7.2, 1.9, 220.0);
        for frame in 0..8 {
            walk.draw(&avatar, 0, &clip.frames[frame * 8], 1.57, 0.9, -0.05);
        }
        walk.save(&picture(&format!("walk-{}.png", avatar.name)));
        let mut front = Sheet::new(5.4, 1.9, 260.0);
        for frame in 0..5 {
            front.draw(&avatar, 0, &clip.frames[frame * 8], 0.4, 0.9, -0.05);
        }
        front.draw(&avatar, 0, &standing(&avatar).frames[0], 0.4, 0.9, -0.05);
        front.save(&picture(&format!("front-{}.png", avatar.name)));
    }
}

/// Where the characters made by others lie, if they are there.
fn characters() -> Option<PathBuf> {
    let data = std::env::var_os("GAITWAY_DATA")
        .map_or_else(|| PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../shared/data"), PathBuf::from);
    let folder = data.join("characters");
    folder.is_dir().then_some(folder)
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
        for joint in Joint::ALL {
            println!("    {:15} {:.3}", joint.name(), model[joint as usize]);
        }
        let clip = retarget(&gait, &avatar).unwrap();
        let c = contact(&avatar, &clip);
        println!("    travel {:.3} rough {:.3} {c:?}", clip.stride_travel, roughness(&clip));
        let mut sheet = Sheet::new(7.0, 2.5, 200.0);
        sheet.draw(&avatar, 0, &rest(&avatar), 0.5, 1.6, -0.1);
        sheet.draw(&avatar, 0, &standing(&avatar).frames[0], 0.3, 1.0, -0.1);
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
            (standing(&plain), standing(&odd)),
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
            assert!(a.distance(b) < 0.02 * size.min(1.0) * 10.0 && tinted == back_tinted, "{a} {b}");
        }
        let inches = read(&glb(&rigs::with_joint_axes(&plain, &odd_axes(), 100.0))).unwrap();
        assert!(inches.report.iter().any(|line| line.contains("centimetres")), "{:?}", inches.report);
    }
}

/// The file with its JSON changed; the binary part stays.
fn edited(file: &[u8], edit: impl Fn(&mut serde_json::Value)) -> Vec<u8> {
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    edit(&mut json);
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = file[..8].to_vec();
    out.extend(u32::try_from(20 + text.len() + file.len() - 20 - length).unwrap().to_le_bytes());
    out.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
    out.extend(b"JSON");
    out.extend(text);
    out.extend(&file[20 + length..]);
    out
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
    assert!(message.contains("draco") && message.contains("uncompressed"), "{message}");
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
