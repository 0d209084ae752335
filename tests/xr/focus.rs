//! What is no fault but not the usual course either: another application in front, late wake-ups, a runtime with one eye.

use super::service::{Live, Service, is_there};
use super::states;
use std::time::Duration;

const RUN: [&str; 7] = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--json"];
const PATIENCE: Duration = Duration::from_secs(30);

#[test]
fn another_application_takes_the_focus_and_gives_it_back() {
    if !is_there() {
        return;
    }
    let service = Service::start("focus", 4276);
    let mut ours = Live::start(service.gaitway(&RUN));
    ours.hear("the headset shows the crowd", PATIENCE);
    let mut other = Live::start(service.gaitway(&RUN));
    other.hear("the headset shows the crowd", PATIENCE);
    std::thread::sleep(Duration::from_millis(700));
    other.end();
    std::thread::sleep(Duration::from_millis(1500));
    let (found, notes) = ours.end();
    let seen = states(&found);
    let lost = seen.iter().position(|state| *state == "focused").unwrap() + 1;
    assert_eq!(seen[lost..lost + 2], ["visible", "synchronized"], "{seen:?}");
    assert!(seen[lost + 2..].contains(&"focused"), "{seen:?}");
    assert_eq!(found["sessions"], 1, "{found}");
    assert!(found["frames"]["empty"].as_u64().unwrap() > 3, "frames without a picture: {found}");
    let told = notes.iter().filter(|line| line.contains("the headset")).count();
    assert_eq!(told, 1, "{notes:#?}");
}

#[test]
fn late_wake_ups_cost_frames_and_nothing_else() {
    if !is_there() {
        return;
    }
    let service = Service::start("late", 4277);
    let mut late = service.gaitway(&RUN);
    late.env("OXR_DEBUG_WAIT_FRAME_EXTRA_SLEEP_MS", "70");
    let mut live = Live::start(late);
    live.hear("the headset shows the crowd", PATIENCE);
    std::thread::sleep(Duration::from_secs(2));
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
    let service = Service::start_with("eye", 4278, &ONE_EYE);
    let failed = service.gaitway(&RUN).output().unwrap();
    let text = String::from_utf8_lossy(&failed.stderr);
    assert_eq!(failed.status.code(), Some(1), "{text}");
    let errors: Vec<&str> = text.lines().filter(|line| line.starts_with("error:")).collect();
    assert!(errors.len() == 1 && errors[0].contains("a view for each of two eyes"), "{text}");
}
