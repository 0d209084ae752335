//! What `gaitway devices` says of the headset.

use super::service::{Service, is_there};
use serde_json::Value;
use std::process::Command;

fn json(command: &mut Command) -> Value {
    let output = command.output().unwrap();
    assert!(output.status.success(), "{output:?}");
    let found: Value =
        serde_json::from_slice(&output.stdout).unwrap_or_else(|error| panic!("{error}: {output:?}"));
    found["openxr"].clone()
}

fn reached(openxr: &Value) -> [bool; 3] {
    ["loader", "installed", "answers"].map(|key| openxr[key].as_bool().unwrap())
}

#[test]
fn devices_tell_how_far_a_headset_is() {
    if !is_there() {
        return;
    }
    let mut service = Service::start("devices");
    let devices = ["devices", "--json"];
    let found = json(&mut service.gaitway(&devices));
    assert_eq!(reached(&found), [true; 3], "{found}");
    assert!(found["runtime"]["runtime"].as_str().unwrap().starts_with("Monado"), "{found}");
    assert!(found["manifest"].as_str().unwrap().ends_with("openxr_monado.json"), "{found}");
    let extensions = found["runtime"]["extensions"].as_array().unwrap();
    for name in ["XR_KHR_vulkan_enable2", "XR_KHR_composition_layer_depth", "XR_KHR_visibility_mask"] {
        assert!(extensions.iter().any(|extension| extension == name), "{found}");
    }
    assert!(found["missing"].is_null() && found["hint"].is_null(), "{found}");

    service.signal("STOP");
    let found = json(&mut service.gaitway(&devices));
    assert_eq!(reached(&found), [true, true, false], "{found}");
    assert!(found["missing"].as_str().unwrap().contains("does not answer"), "{found}");

    service.kill();
    let found = json(&mut service.gaitway(&devices));
    assert_eq!(reached(&found), [true, true, false], "{found}");
    assert!(found["hint"].as_str().unwrap().contains("monado-service"), "{found}");

    let found = json(service.gaitway(&devices).env("XR_RUNTIME_JSON", "/nowhere/runtime.json"));
    assert_eq!(reached(&found), [true, false, false], "{found}");
    assert!(found["hint"].as_str().unwrap().contains("libopenxr1-monado"), "{found}");

    // by the machine's own libraries, which may or may not have a loader
    let own = json(Command::new(env!("CARGO_BIN_EXE_gaitway")).args(devices));
    if !reached(&own)[0] {
        assert!(own["hint"].as_str().unwrap().contains("libopenxr-loader1"), "{own}");
    }
}
