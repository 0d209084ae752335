//! Sessions on devices that are small or poor.
//!
//! Each lasts 2 s, or as many seconds as `GAITWAY_XR_SECONDS` says.

use super::service::{Live, Service, is_there};
use super::{device, outcome, states, walked_all_the_time};
use serde_json::Value;

/// A session on a device of this kind, which must end well: its outcome. [`outcome`] asserts that no layer had anything to say.
fn session(service: &Service, kind: &str) -> Value {
    let seconds = std::env::var("GAITWAY_XR_SECONDS").unwrap_or_else(|_| "2".to_owned());
    // so many people that hidden ones are looked for, where depth can be read
    let crowd =
        ["xr", "crossing", "--agents", "1200", "--eye-size", "160x160", "--backend", "vulkan", "--json"];
    let mut command = service.gaitway(&[&crowd[..], &["--seconds", &seconds]].concat());
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
