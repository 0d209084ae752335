//! Runtimes that are not Monado: other displays, images and controllers.

use super::service::{Live, Service, is_there};
use super::{POST, after, folder, pictures, post};
use serde_json::Value;

const SIZE: u32 = 320;

/// What came of a run of the post before a runtime that the layer fakes.
struct Run {
    found: Value,
    notes: Vec<String>,
    /// What the layer saw of the first picture, and of the inputs.
    seen: String,
    suggested: String,
    /// Column of the post in each eye's picture.
    columns: [f32; 2],
}

fn run(service: &Service, fake: &str, name: &str) -> Run {
    let folder = folder(name);
    let [file, seen, suggested] = ["post.toml", "seen.txt", "suggested.txt"].map(|name| folder.join(name));
    std::fs::write(&file, POST).unwrap();
    let (scene, shots, size) = (file.to_str().unwrap(), folder.to_str().unwrap(), format!("{SIZE}x{SIZE}"));
    let run = ["xr", scene, "--eye-size", &size, "--shots", shots, "--every", "3", "--json"];
    let mut command = service.faulty(fake, &run);
    command.env("GAITWAY_SEEN", &seen).env("GAITWAY_SUGGESTED", &suggested);
    let live = Live::start(command);
    after(&folder, 2);
    let (found, notes) = live.end();
    let (_, image) = pictures(&folder).pop().unwrap();
    Run {
        found,
        notes,
        seen: std::fs::read_to_string(seen).unwrap(),
        suggested: std::fs::read_to_string(suggested).unwrap(),
        columns: [0, 1].map(|eye| post(&image, eye).unwrap()),
    }
}

#[test]
fn pictures_are_opaque_where_the_runtime_has_that_and_else_as_it_likes_best() {
    if !is_there() {
        return;
    }
    let service = Service::start("blend");
    let told = |run: &Run| run.notes.iter().any(|line| line.contains("see-through"));
    let opaque = run(&service, "opaque-last@1+", "opaque");
    assert!(opaque.seen.starts_with("blend 1\n"), "{}", opaque.seen);
    assert_eq!(opaque.found["blend_mode"], "opaque");
    assert!(!told(&opaque), "{:#?}", opaque.notes);
    let additive = run(&service, "no-opaque@1+", "additive");
    assert!(additive.seen.starts_with("blend 2\n"), "{}", additive.seen);
    assert_eq!(additive.found["blend_mode"], "additive");
    assert!(told(&additive), "{:#?}", additive.notes);
}

#[test]
fn without_images_of_two_layers_each_eye_has_its_own() {
    if !is_there() {
        return;
    }
    let service = Service::start("layers");
    service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let eye = |layer: u32, chain: &str| format!("colour of layer {layer} of the {chain}, {SIZE}x{SIZE}");
    let colours = |run: &Run| -> Vec<String> {
        run.seen.lines().filter(|line| line.starts_with("colour")).map(str::to_owned).collect()
    };
    let layered = run(&service, "", "layered");
    assert_eq!(colours(&layered), [eye(0, "first"), eye(1, "first")]);
    let single = run(&service, "no-layers@1+", "single");
    assert_eq!(colours(&single), [eye(0, "first"), eye(0, "another")]);
    assert_eq!(single.found["takes_depth"], true, "{}", single.found);
    assert!(single.seen.contains("depth 0 1 inf 0.05 of layer 0"), "{}", single.seen);
    // the same eyes see the same
    let off = [0, 1].map(|eye| (layered.columns[eye] - single.columns[eye]).abs());
    assert!(off.iter().all(|off| *off < 0.1), "{:?} {:?}", layered.columns, single.columns);
    assert!((layered.columns[0] - layered.columns[1]).abs() > 0.3, "the eyes stand apart");
}

#[test]
fn controllers_and_hands_are_bound_where_the_runtime_has_their_extension() {
    if !is_there() {
        return;
    }
    let service = Service::start("bound");
    let Run { found, suggested, .. } = run(&service, "", "bound");
    let has = |extension: &str| {
        found["runtime"]["extensions"].as_array().unwrap().iter().any(|known| known == extension)
    };
    let bound = |profile: &str| {
        let name = format!(" /interaction_profiles/{profile} ");
        suggested.lines().find(|line| line.contains(&name))
    };
    // Monado knows every path of the profiles that it has
    assert!(suggested.lines().all(|line| line.starts_with("0 ")), "{suggested}");
    for profile in ["oculus/touch_controller", "valve/index_controller", "khr/simple_controller"] {
        assert!(bound(profile).is_some(), "{suggested}");
    }
    let more = [
        ("XR_BD_controller_interaction", "bytedance/pico4_controller", "right/input/a/click"),
        ("XR_BD_controller_interaction", "bytedance/pico_neo3_controller", "right/input/a/click"),
        ("XR_HTC_vive_focus3_controller_interaction", "htc/vive_focus3_controller", "right/input/a/click"),
        ("XR_EXT_hp_mixed_reality_controller", "hp/mixed_reality_controller", "right/input/a/click"),
        ("XR_EXT_hand_interaction", "ext/hand_interaction_ext", "right/input/aim_activate_ext/value"),
    ];
    for (extension, profile, teleport) in more {
        assert_eq!(bound(profile).is_some(), has(extension), "{extension}: {suggested}\n{found}");
        let bindings = bound(profile).unwrap_or_default();
        let is_bound = |path: &str| bindings.contains(&format!("/user/hand/{path}"));
        let aims = is_bound("left/input/aim/pose") && is_bound("right/input/grip/pose");
        assert_eq!(is_bound(teleport) && aims, has(extension), "{bindings}");
        println!("{extension}: {}", has(extension));
    }
}
