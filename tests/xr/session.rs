//! A session from its beginning to its end, and that the eyes are where the head is.

use super::service::{self, Live, Service};
use super::{POST, after, folder, outcome, post, shows, states, walked_all_the_time};
use std::path::Path;

#[test]
fn a_session_goes_through_all_its_states_and_ends_in_good_order() {
    if !service::is_there() {
        return;
    }
    let service = Service::start("states");
    let shots = folder("states");
    let shots = shots.to_str().unwrap();
    let run = [
        "xr",
        "crossing",
        "--agents",
        "60",
        "--eye-size",
        "320x320",
        "--shots",
        shots,
        "--every",
        "1",
        "--json",
    ];
    let log = service.folder.join("core-validation.txt");
    let mut checked = service.gaitway(&run);
    checked.env("XR_ENABLE_API_LAYERS", "XR_APILAYER_LUNARG_core_validation");
    checked.env("XR_CORE_VALIDATION_EXPORT_TYPE", "text").env("XR_CORE_VALIDATION_FILE_NAME", &log);
    let live = Live::start(checked);
    after(Path::new(shots), 12);
    let (found, _) = live.end();
    // OpenXR's own rules, beside Vulkan's
    let log = std::fs::read_to_string(log).unwrap();
    assert!(!log.contains("VALID_ERROR"), "{log}");
    let all = [
        "idle",
        "ready",
        "synchronized",
        "visible",
        "focused",
        "visible",
        "synchronized",
        "stopping",
        "idle",
        "exiting",
    ];
    assert_eq!(states(&found), all);
    assert_eq!((found["sessions"].as_u64(), found["hung"].as_bool()), (Some(1), Some(false)));
    assert_eq!(found["ended"], "interrupted");
    assert!(found["frames"]["drawn"].as_u64().unwrap() > 2, "{found}");
    // the host's share of a frame is there, and waiting for the device no part of it
    let half = |share: &str| found["frames"][share]["p50"].as_f64().unwrap();
    // by the processor's time: the clock also counts waiting for a processor that others have
    let host = half("host_cpu_ms");
    assert!(host > 0.0 && half("host_ms") > 0.0 && host < 0.5 * half("work_ms"), "{found}");
    walked_all_the_time(&found);
}

#[test]
fn the_time_that_is_given_ends_the_session() {
    if !service::is_there() {
        return;
    }
    let service = Service::start("time");
    let run = ["xr", "crossing", "--agents", "20", "--seconds", "1.5", "--eye-size", "160x160", "--json"];
    let (found, _) = outcome(service.gaitway(&run).spawn().unwrap());
    // on a busy machine before the first picture
    assert!(found["ended"].as_str().unwrap().starts_with("the time was up"), "{found}");
    assert!(found["seconds"].as_f64().unwrap() > 1.5 - 1.0 / 30.0, "{found}");
    walked_all_the_time(&found);
}

#[test]
fn both_eyes_follow_the_head_with_the_right_parallax() {
    if !service::is_there() {
        return;
    }
    const SIZE: u32 = 960;
    let service = Service::start("head");
    let folder = folder("head");
    let scene = folder.join("post.toml");
    std::fs::write(&scene, POST).unwrap();
    let (scene, shots) = (scene.to_str().unwrap(), folder.to_str().unwrap());
    let mut head = service.head();
    let eye = format!("{SIZE}x{SIZE}");
    let run = ["xr", scene, "--eye-size", &eye, "--shots", shots, "--every", "2", "--json"];
    let live = Live::start(service.gaitway(&run));
    // half the height above the floor is the row that is looked at
    let script: [(f32, f32); 5] = [(0.0, 0.0), (12.0, 0.0), (-20.0, 0.0), (25.0, 0.4), (-3.0, -0.3)];
    let mut worst = [0.0_f32; 2];
    for (turn, aside) in script {
        head.set(turn, 0.0, [aside, 1.6, 0.0]);
        let focal = 0.5 * SIZE as f32 / 0.7418_f32.tan();
        let want = [-0.0315_f32, 0.0315].map(|eye_aside| {
            // the eye in the room, the post's middle from there, and the head's turn to the left
            let turned = turn.to_radians();
            let (x, z) = (aside + eye_aside * turned.cos(), -eye_aside * turned.sin());
            (-x).atan2(10.0 - 0.25 + z).to_degrees() + turn
        });
        // frames that were begun before show the head as it was
        after(&folder, 2);
        let (_, off) = shows(&folder, |picture| {
            let column = |eye| post(picture, eye).ok_or_else(|| format!("no post at {turn} deg, eye {eye}"));
            let seen =
                [column(0)?, column(1)?].map(|at| ((at - 0.5 * SIZE as f32) / focal).atan().to_degrees());
            let off = (seen[0] - want[0]).abs().max((seen[1] - want[1]).abs());
            let parallax = ((seen[0] - seen[1]) - (want[0] - want[1])).abs();
            if off < 0.2 { Ok([off, parallax]) } else { Err(format!("{seen:?} degrees, not {want:?}")) }
        });
        worst = [worst[0].max(off[0]), worst[1].max(off[1])];
    }
    live.end();
    println!("worst: {:.3} deg, parallax {:.3} deg", worst[0], worst[1]);
    assert!(worst[0] < 0.2, "{worst:?}");
    assert!(worst[1] < 0.05, "{worst:?}");
}

#[test]
fn without_a_service_or_a_runtime_one_line_says_why() {
    if !service::is_there() {
        return;
    }
    let mut service = Service::start("none");
    service.kill();
    let run = ["xr", "crossing", "--seconds", "1"];
    let failed = service.gaitway(&run).output().unwrap();
    let text = String::from_utf8_lossy(&failed.stderr);
    assert_eq!(failed.status.code(), Some(1));
    assert!(text.contains("service is not running") && text.contains("hint:"), "{text}");
    let failed = service.gaitway(&run).env("XR_RUNTIME_JSON", "/nowhere/runtime.json").output().unwrap();
    let text = String::from_utf8_lossy(&failed.stderr);
    assert!(text.contains("no OpenXR runtime is active") && text.contains("hint:"), "{text}");
}
