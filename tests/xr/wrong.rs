//! Sessions on devices that are small or poor.

use super::service::{Live, Service, is_there};
use super::{device, outcome, states, walked_all_the_time};
use serde_json::Value;
use std::time::Duration;

/// A session of 8 s on a device of this kind, which must end well: its outcome. [`outcome`] asserts that no layer had anything to
/// say.
fn session(service: &Service, kind: &str) -> Value {
    // so many people that hidden ones are looked for, where depth can be read
    let crowd = ["xr", "crossing", "--agents", "1200", "--eye-size", "160x160", "--backend", "vulkan"];
    let mut command = service.gaitway(&[&crowd[..], &["--seconds", "8", "--json"]].concat());
    // the services' tests always have the validation layer
    let (found, _) = outcome(device::on_validated(&mut command, kind).spawn().unwrap());
    assert_eq!(
        (found["sessions"].as_u64(), found["hung"].as_bool()),
        (Some(1), Some(false)),
        "{kind}: {found}"
    );
    walked_all_the_time(&found);
    found
}

#[test]
fn a_session_on_every_kind_of_device_leaves_the_validation_layer_silent() {
    if !is_there() {
        return;
    }
    let service = Service::start("wrong");
    for kind in device::KINDS {
        let found = session(&service, kind);
        assert!(states(&found).contains(&"focused"), "{kind}: {found}");
        assert!(found["frames"]["drawn"].as_u64() > Some(0), "{kind}: {found}");
    }
}

/// A session of which a device is lost: what it says then, and its outcome.
fn after_a_loss(service: &Service, kind: &str, said: &str) -> Value {
    let run = ["xr", "crossing", "--agents", "200", "--eye-size", "160x160", "--backend", "vulkan", "--json"];
    let mut command = service.gaitway(&run);
    device::on_validated(&mut command, kind);
    let mut live = Live::start(command);
    live.hear(said);
    std::thread::sleep(Duration::from_secs(1));
    let (found, notes) = live.end();
    assert_eq!(found["hung"].as_bool(), Some(false), "{kind}: {found}\n{notes:#?}");
    assert_eq!(states(&found).last(), Some(&"exiting"), "{kind}: {found}");
    walked_all_the_time(&found);
    found
}

#[test]
fn a_device_that_is_lost_in_mid_session_is_opened_again_and_the_crowd_goes_on() {
    if !is_there() {
        return;
    }
    let service = Service::start("lost");
    let found = after_a_loss(&service, "first-lost@90", "the crowd's device is opened again");
    assert_eq!((found["device_losses"].as_u64(), found["sessions"].as_u64()), (Some(1), Some(1)), "{found}");
    let found = after_a_loss(&service, "second-lost@20", "the headset is back after");
    assert_eq!((found["device_losses"].as_u64(), found["sessions"].as_u64()), (Some(0), Some(2)), "{found}");
    let again = states(&found).iter().filter(|state| **state == "focused").count();
    assert_eq!(again, 2, "{found}");
}

#[test]
fn a_recovered_session_compiles_nothing_again() {
    if !is_there() {
        return;
    }
    let service = Service::start("kept");
    let log = service.folder.join("pipelines");
    let run = ["xr", "crossing", "--agents", "40", "--eye-size", "160x160", "--backend", "cpu", "--json"];
    let mut command = service.faulty("session-lost-at-wait@6", &run);
    device::on_validated(&mut command, "pipelines");
    command.env(device::layer::pipelines::LOG, &log).env("GAITWAY_PIPELINE_CACHE", "off");
    let mut live = Live::start(command);
    live.hear("the headset is back after");
    live.end();
    let text = std::fs::read_to_string(log).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let [first, second] = lines[..] else { panic!("two devices: {text}") };
    assert!(first.ends_with(", 0 taken") && second.starts_with("0 compiled, "), "{text}");
    let pipelines = |line: &str, word| line.split(' ').nth(word).and_then(|count| count.parse::<u32>().ok());
    // the first device was probed, too
    assert_eq!(pipelines(first, 0), pipelines(second, 2).map(|taken| taken + 1), "{text}");
}
