//! Pictures, and the models that people and robots look like.

use super::{gaitway, good, has_vulkan, json, refused};
use serde_json::Value;
use std::path::Path;

/// Number of different colours in a PNG.
fn colors(path: &Path) -> usize {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    let frame = reader.next_frame(&mut pixels).unwrap();
    let pixels = &pixels[..frame.buffer_size()];
    let set: std::collections::BTreeSet<&[u8]> =
        pixels.chunks_exact(frame.line_size / frame.width as usize).collect();
    set.len()
}

#[test]
fn a_gait_written_as_csv_comes_back_with_its_speed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("angry.csv");
    let file = path.to_str().unwrap();
    good(&["gait", "walk", "--emotion", "angry", "--sex", "male", "--speed", "1.5", "--out", file]);
    let sheet = folder.path().join("sheet.png");
    let listing = json(&["gait", "show", file, "--out", sheet.to_str().unwrap(), "--json"]);
    let speed = listing["gaits"][0]["v_des"].as_f64().unwrap();
    assert!((speed - 1.5).abs() < 0.02, "{listing}");
    assert!(colors(&sheet) > 4);
}

#[test]
fn pictures_show_something_from_every_camera_on_both_backends() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let out = folder.path().join("picture.png");
    let file = out.to_str().unwrap();
    for (camera, backend) in [("eyes", "vulkan"), ("orbit", "cpu"), ("top", "auto"), ("follow:3", "cpu")] {
        let result = json(&[
            "render",
            "crossing",
            "--at",
            "0.5",
            "--size",
            "192x108",
            "--camera",
            camera,
            "--backend",
            backend,
            "--out",
            file,
            "--force",
            "--json",
        ]);
        assert_eq!(result["frames"], 1, "{result}");
        assert!(colors(&out) > 100, "{camera}: {} colours", colors(&out));
    }
    let frames = format!("{}/frames/", folder.path().display());
    good(&["render", "garden", "--size", "64x36", "--seconds", "0.2", "--out", &frames]);
    assert_eq!(std::fs::read_dir(&frames).unwrap().count(), 6);
    let behind = ["render", "crossing", "--camera", "follow:8", "--force", "--out", file];
    refused(&behind, "there are 8 agents", "numbered from 0");
    refused(&["render", "crossing", "--out", "x.gif"], "x.gif", "hint: use FILE.png");
}

#[test]
fn the_same_moment_looks_the_same_on_both_backends() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |backend: &str| {
        let out = folder.path().join(format!("{backend}.png"));
        let file = out.to_str().unwrap();
        good(&["render", "garden", "--at", "1", "--size", "192x108", "--backend", backend, "--out", file]);
        std::fs::read(out).unwrap()
    };
    assert!(picture("cpu") == picture("vulkan"));
}

/// A man whose hands are folded before him and whose joints are called "Bone 0" and so on, so that names say nothing.
fn nameless_man() -> Vec<u8> {
    use gaitway::gait::Joint;
    let mut avatar = gaitway::avatar::generated(gaitway::avatar::Sex::Male);
    let rest = avatar.joints.map(|joint| joint.joint_from_mesh.inverse().w_axis.truncate());
    for hand in [Joint::LeftHand as usize, Joint::RightHand as usize] {
        let place = glam::Vec3::new(0.04 * rest[hand].x.signum(), 1.0, 0.2);
        avatar.joints[hand].translation = place - rest[Joint::PARENT[hand]];
        avatar.joints[hand].joint_from_mesh = glam::Mat4::from_translation(-place);
    }
    let file = gaitway::avatar::glb(&avatar);
    let length = u32::from_le_bytes(file[12..16].try_into().unwrap()) as usize;
    let mut json: Value = serde_json::from_slice(&file[20..20 + length]).unwrap();
    for (number, node) in json["nodes"].as_array_mut().unwrap().iter_mut().enumerate() {
        node["name"] = format!("Bone {number}").into();
    }
    let mut text = json.to_string().into_bytes();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut out = file[..8].to_vec();
    out.extend(u32::try_from(text.len() + file.len() - length).unwrap().to_le_bytes());
    out.extend(u32::try_from(text.len()).unwrap().to_le_bytes());
    out.extend(b"JSON");
    out.extend(text);
    out.extend(&file[20 + length..]);
    out
}

#[test]
fn a_rig_map_is_printed_filled_in_and_taken_from_the_command_line_or_the_scenario() {
    let folder = std::env::temp_dir().join(format!("gaitway-rig-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    std::fs::write(file("hero.glb"), nameless_man()).unwrap();
    let scene = |name: &str, rig_maps: &str| {
        let text = format!(
            "name = \"place\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[[routes]]\nname = \"a\"\nwaypoints = [[2, 2], [7, 7]]\n\
             [population]\nagents = 2\navatars = [\"hero.glb\", \"female\"]\navatar_genders = [\"male\", \"female\"]\n{rig_maps}\n"
        );
        std::fs::write(file(name), text).unwrap();
        file(name)
    };
    let simulate = |scene: &str, more: &[&str]| {
        gaitway(&[&["simulate", scene, "--seconds", "0.5", "--backend", "cpu"], more].concat())
    };
    let plain = scene("plain.toml", "");
    let output = simulate(&plain, &[]);
    assert_eq!(output.status.code(), Some(1));
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(error.contains("no humanoid") && error.contains("--rig-map"), "{error}");
    let mut map = String::from_utf8(output.stdout).unwrap();
    for joint in gaitway::gait::Joint::ALL {
        let filled = format!("\n{} = \"Bone {}\"", joint.name(), joint as usize);
        map = map.replace(&format!("\n{} = \"\"", joint.name()), &filled);
    }
    std::fs::write(file("hero.rig.toml"), &map).unwrap();
    let output = simulate(&plain, &["--rig-map", &file("hero.rig.toml")]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let own = scene("own.toml", "rig_maps = [\"hero.rig.toml\"]");
    assert!(simulate(&own, &[]).status.success());
    // a map for another avatar
    std::fs::write(file("other.toml"), map.replace("avatar = \"hero\"", "avatar = \"heroine\"")).unwrap();
    let error = simulate(&plain, &["--rig-map", &file("other.toml")]).stderr;
    let error = String::from_utf8(error).unwrap();
    assert!(error.contains("heroine") && error.contains("hero, female"), "{error}");
    // the map of one is not that of another
    std::fs::copy(file("hero.glb"), file("villain.glb")).unwrap();
    let two =
        std::fs::read_to_string(&plain).unwrap().replace("\"female\"]\navatar", "\"villain.glb\"]\navatar");
    std::fs::write(file("two.toml"), two).unwrap();
    let output = simulate(&file("two.toml"), &["--rig-map", &file("hero.rig.toml")]);
    let printed = String::from_utf8(output.stdout).unwrap();
    assert!(output.status.code() == Some(1) && printed.contains("avatar = \"villain\""), "{printed}");
    std::fs::remove_dir_all(&folder).unwrap();
}

#[test]
fn a_robot_looks_like_a_model_of_the_scenes_and_a_wrong_one_is_named() {
    let folder = std::env::temp_dir().join(format!("gaitway-model-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let file = |name: &str| folder.join(name).display().to_string();
    let cart = gaitway::avatar::glb(&gaitway::avatar::generated(gaitway::avatar::Sex::Male));
    std::fs::write(file("cart.glb"), &cart).unwrap();
    std::fs::write(file("broken.glb"), &cart[..cart.len() / 2]).unwrap();
    let simulate = |outsider: &str| {
        let text = format!(
            "name = \"place\"\nbounds = [[0, 0], [9, 0], [9, 9], [0, 9]]\n[population]\nagents = 0\n\
             [[outsiders]]\n{outsider}\npath = [[0, 1, 1], [9, 8, 8]]\n"
        );
        std::fs::write(file("scene.toml"), text).unwrap();
        gaitway(&["simulate", &file("scene.toml"), "--seconds", "0.5", "--backend", "cpu"])
    };
    for good in [
        "kind = \"robot\"",
        "kind = \"robot\"\nmodel = \"cart.glb\"",
        "kind = \"vehicle\"\nmodel = \"cart.glb\"\nsize = [1, 1, 2]",
    ] {
        let output = simulate(good);
        assert!(output.status.success(), "{good}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for (wrong, words) in [
        ("kind = \"robot\"\nmodel = \"lost.glb\"", ["outsiders[0].model", "lost.glb", "cannot read"]),
        (
            "kind = \"robot\"\nmodel = \"broken.glb\"",
            ["outsiders[0].model", "broken.glb", "not a usable glTF"],
        ),
        ("kind = \"robot\"\nmodel = \"\"", ["scene.toml:", "outsiders[0].model", "a .glb or .gltf"]),
        (
            "kind = \"person\"\nmodel = \"cart.glb\"",
            ["scene.toml:", "outsiders[0].model", "population.avatars"],
        ),
        ("kind = \"robot\"\nsize = [1, 1, 1]", ["outsiders[0].size", "without a model", "radius"]),
        ("kind = \"robot\"\nmodel = \"cart.glb\"\nsize = [1, 0, 1]", ["outsiders[0].size", "0.05", "height"]),
    ] {
        let output = simulate(wrong);
        let error = String::from_utf8(output.stderr).unwrap();
        assert_eq!(output.status.code(), Some(1), "{error}");
        assert!(words.iter().all(|word| error.contains(word)), "{wrong}: {error}");
    }
    std::fs::remove_dir_all(&folder).unwrap();
}
