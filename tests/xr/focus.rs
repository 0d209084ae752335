//! What is no fault but not the usual course either: another application in front, late wake-ups, a runtime with one eye.

use super::service::{Live, Service, is_there, until};
use super::{after, folder, frames, states};
use std::path::Path;

const RUN: [&str; 7] = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--json"];

/// The run with pictures of all its frames in a folder.
fn with_shots(folder: &Path) -> Vec<&str> {
    RUN.into_iter().chain(["--shots", folder.to_str().unwrap(), "--every", "1"]).collect()
}

#[test]
fn another_application_takes_the_focus_and_gives_it_back() {
    if !is_there() {
        return;
    }
    let service = Service::start("focus");
    let [mine, theirs] = ["focus", "focus-other"].map(folder);
    let mut ours = Live::start(service.gaitway(&with_shots(&mine)));
    ours.hear("the headset shows the crowd");
    after(&mine, 2);
    let mut other = Live::start(service.gaitway(&with_shots(&theirs)));
    other.hear("the headset shows the crowd");
    // while the other one is in front, ours has frames without a picture
    until(|| {
        let before = frames(&mine).len();
        after(&theirs, 6);
        if frames(&mine).len() == before { Ok(()) } else { Err("ours is still drawn".to_owned()) }
    });
    other.end();
    after(&mine, 2);
    let (found, notes) = ours.end();
    let seen = states(&found);
    let lost = seen.iter().position(|state| *state == "focused").unwrap() + 1;
    assert_eq!(seen[lost..lost + 2], ["visible", "synchronized"], "{seen:?}");
    assert!(seen[lost + 2..].contains(&"focused"), "{seen:?}");
    assert_eq!(found["sessions"], 1, "{found}");
    assert!(found["frames"]["empty"].as_u64().unwrap() > 0, "frames without a picture: {found}");
    let told = notes.iter().filter(|line| line.contains("the headset")).count();
    assert_eq!(told, 1, "{notes:#?}");
}

#[test]
fn late_wake_ups_cost_frames_and_nothing_else() {
    if !is_there() {
        return;
    }
    let service = Service::start("late");
    let folder = folder("late");
    let mut late = service.gaitway(&with_shots(&folder));
    late.env("OXR_DEBUG_WAIT_FRAME_EXTRA_SLEEP_MS", "70");
    let live = Live::start(late);
    after(&folder, 8);
    let (found, _) = live.end();
    assert_eq!(found["sessions"], 1, "{found}");
    let count = |key: &str| found["frames"][key].as_u64().unwrap();
    assert!(count("drawn") > 3 && count("missed") > 3, "{found}");
}

#[test]
fn a_runtime_with_one_eye_is_refused_in_one_line() {
    if !is_there() {
        return;
    }
    const ONE_EYE: [(&str, &str); 3] =
        [("P_OVERRIDE_ACTIVE_CONFIG", "none"), ("SIMULATED_ENABLE", "1"), ("SIMULATED_VIEW_COUNT", "1")];
    let service = Service::start_with("eye", &ONE_EYE);
    let failed = service.gaitway(&RUN).output().unwrap();
    let text = String::from_utf8_lossy(&failed.stderr);
    assert_eq!(failed.status.code(), Some(1), "{text}");
    let errors: Vec<&str> = text.lines().filter(|line| line.starts_with("error:")).collect();
    assert!(errors.len() == 1 && errors[0].contains("a view for each of two eyes"), "{text}");
}
