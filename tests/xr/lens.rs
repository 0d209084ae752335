//! What a headset's compositor and lenses want of pictures: depth, and nothing where it cannot be seen.

use super::service::{Live, Service, is_there};
use super::{POST, after, folder, pictures};

const SIZE: u32 = 320;

/// What the layer saw of depth.
fn depths(seen: &str) -> Vec<&str> {
    seen.lines().filter(|line| line.contains("depth")).collect()
}

/// A run of the post with a fault or pretence of the layer; what came of it, and what the layer saw.
fn run(service: &Service, fault: &str, name: &str) -> (serde_json::Value, String, std::path::PathBuf) {
    let folder = folder(name);
    let (file, seen) = (folder.join("post.toml"), folder.join("seen.txt"));
    std::fs::write(&file, POST).unwrap();
    let (scene, shots, size) = (file.to_str().unwrap(), folder.to_str().unwrap(), format!("{SIZE}x{SIZE}"));
    let run = ["xr", scene, "--eye-size", &size, "--shots", shots, "--every", "5", "--json"];
    let mut command = service.faulty(fault, &run);
    command.env("GAITWAY_SEEN", &seen);
    let live = Live::start(command);
    after(&folder, 2);
    let (found, _) = live.end();
    (found, std::fs::read_to_string(seen).unwrap(), folder)
}

#[test]
fn depth_goes_along_with_the_picture_where_the_runtime_takes_it() {
    if !is_there() {
        return;
    }
    let service = Service::start("depth");
    let (found, seen, _) = run(&service, "", "depth");
    assert_eq!(found["takes_depth"], true, "{found}");
    // reversed and without an end
    let eye = |layer: u32| format!("depth 0 1 inf 0.05 of layer {layer}, {SIZE}x{SIZE}");
    assert_eq!(depths(&seen), [eye(0), eye(1)]);

    let (found, seen, folder) = run(&service, "no-depth-format@1+", "nodepth");
    assert_eq!(found["takes_depth"], false, "{found}");
    assert_eq!(depths(&seen), ["no depth"; 2]);
    assert!(!pictures(&folder).is_empty());
}

#[test]
fn nothing_is_drawn_where_the_lenses_hide_it() {
    if !is_there() {
        return;
    }
    let service = Service::start("mask");
    service.head().set(0.0, 0.0, [0.0, 1.6, 0.0]);
    let (found, _, folder) = run(&service, "mask@1+", "mask");
    assert_eq!(found["hidden_triangles"], serde_json::json!([1, 1]), "{found}");
    let (_, image) = pictures(&folder).pop().unwrap();
    // the field of view is symmetric, its half 0.7418 rad
    let hidden = (0.5 * (1.0 - 0.5 / 0.7418_f32.tan()) * SIZE as f32) as u32;
    let is_black = |x: u32, y: u32| image.pixel(x, y).unwrap()[..3] == [0; 3];
    for y in [3, SIZE / 2, SIZE - 4] {
        let row: Vec<bool> = (0..2 * SIZE).map(|x| is_black(x, y)).collect();
        let edge = |from: u32, to: u32, is: bool| row[from as usize..to as usize].iter().all(|b| *b == is);
        assert!(edge(0, hidden - 2, true), "row {y}: the outer part of the left eye is hidden");
        assert!(edge(hidden + 2, 2 * SIZE - hidden - 2, false), "row {y}: the rest is not");
        assert!(edge(2 * SIZE - hidden + 2, 2 * SIZE, true), "row {y}: and the right eye's outer part");
    }
}

#[test]
fn the_lenses_of_monado_are_asked_for() {
    if !is_there() {
        return;
    }
    let service = Service::start("lenses");
    let mut live = Live::start(service.gaitway(&[
        "xr",
        "crossing",
        "--agents",
        "40",
        "--eye-size",
        "160x160",
        "--json",
    ]));
    live.hear("the headset shows the crowd");
    let (found, _) = live.end();
    let extensions = found["runtime"]["extensions"].as_array().unwrap();
    for name in ["XR_KHR_visibility_mask", "XR_KHR_composition_layer_depth"] {
        assert!(extensions.iter().any(|extension| extension == name), "{found}");
    }
    println!("{} triangles hidden", found["hidden_triangles"]);
}
