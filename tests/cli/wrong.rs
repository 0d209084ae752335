//! The program on devices that are small, poor, short of memory or lost, and with wrong arithmetic.

use super::{device, has_vulkan, json, program};
use serde_json::Value;
use std::path::Path;
use std::process::Output;

/// Runs on a device of this kind.
fn on(kind: &str, arguments: &[&str]) -> Output {
    device::on(&mut program(), kind).args(arguments).output().unwrap()
}

/// Standard output of a run on a device of this kind, which must succeed and leave the validation layer silent.
fn good_on(kind: &str, arguments: &[&str]) -> String {
    let output = on(kind, arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{kind}: {arguments:?}: {:?}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

fn json_on(kind: &str, arguments: &[&str]) -> Value {
    serde_json::from_str(&good_on(kind, arguments)).unwrap()
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    std::fs::read_dir(folder).unwrap().map(name).collect()
}

#[test]
fn what_is_emulated_is_what_the_program_sees() {
    if !has_vulkan() {
        return;
    }
    // a device whose memory is nearly nothing takes no crowd, so the layer is there
    let output = on("memory@1", &["simulate", "garden", "--seconds", "0", "--backend", "vulkan"]);
    assert_eq!(output.status.code(), Some(1), "{}", String::from_utf8_lossy(&output.stderr));
    let unknown = on("no-such-fault", &["devices"]);
    assert!(String::from_utf8_lossy(&unknown.stderr).contains("there is no no-such-fault"));
}

/// Every kernel against its twin, and a crowd, on a device of this kind with such arithmetic.
fn is_verified(kind: &str, faults: &str) {
    if !has_vulkan() {
        return;
    }
    let mut command = program();
    command.args(["verify", "--quick", "--agents", "65", "--crowd", "200", "--json"]);
    let output = device::on(&mut command, kind).env("GAITWAY_WRONG_ARITHMETIC", faults).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{error}");
    let report: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(report["arithmetic"]["native_is_exact"], faults.is_empty(), "{report}");
    assert!(report["crowd"]["differs_by_step"].is_null() && report["pass"] == true, "{report}");
}

#[test]
fn every_kernel_is_exact_on_a_phone_that_is_wrong_by_3_units() {
    is_verified(device::PHONE, "by-3");
}

#[test]
fn every_kernel_is_exact_within_vulkans_own_limits_and_wrong_by_1_unit() {
    is_verified(device::LEAST, "by-1");
}

#[test]
fn every_kernel_is_exact_in_the_memory_of_a_discrete_card() {
    is_verified(device::CARD, "");
}

#[test]
fn a_picture_is_the_same_on_every_kind_of_device() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |kind: &str| {
        let path = folder.path().join(format!("{}.png", kind.len()));
        let out = path.to_str().unwrap();
        // so many people that hidden ones are looked for, where depth can be read
        let crowd = ["render", "crossing", "--agents", "1200", "--size", "256x144", "--out", out];
        good_on(kind, &crowd);
        std::fs::read(path).unwrap()
    };
    let usual = picture("");
    for kind in device::KINDS {
        assert!(picture(kind) == usual, "{kind}");
    }
}

#[test]
fn people_are_drawn_directly_where_indirect_draws_draw_nothing() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let picture = |kind: &str, draws: &str| {
        let path = folder.path().join(format!("{kind}-{draws}.png"));
        let out = path.to_str().unwrap();
        let crowd = ["render", "crossing", "--agents", "1200", "--size", "256x144", "--out", out];
        let output =
            device::on(&mut program(), kind).args(crowd).env("GAITWAY_DRAWS", draws).output().unwrap();
        assert!(output.status.success(), "{kind}, {draws}: {}", String::from_utf8_lossy(&output.stderr));
        std::fs::read(path).unwrap()
    };
    let usual = picture("", "indirect");
    assert!(picture("", "direct") == usual);
    for kind in ["no-indirect-draws", "adreno"] {
        assert!(picture(kind, "direct") == usual, "{kind}");
        assert!(picture(kind, "indirect") != usual, "{kind} draws all the same");
    }
}

#[test]
fn a_tiler_is_known_by_its_driver() {
    if !has_vulkan() {
        return;
    }
    let facts = |kind| {
        let list = json_on(kind, &["devices", "--json"]);
        ["tiler", "indirect_draws"].map(|name| list["devices"][0][name].as_bool().unwrap())
    };
    assert_eq!(["", "tiler", "adreno"].map(facts), [[false, true], [true, true], [true, false]]);
    assert!(good_on("tiler", &["devices"]).contains(", tiler"));
}

/// Depth and samples of a picture of 1920 by 1080 pixels take 66 MB, but nothing where tiles suffice for them.
#[test]
fn attachments_of_a_tiler_take_no_memory() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    let large = ["render", "crossing", "--size", "1920x1080", "--at", "0", "--force", "--out"];
    let large = [&large[..], &[path.to_str().unwrap()]].concat();
    good_on("memory@96,tiler", &large);
    let output = on("memory@96", &large);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.code() == Some(1) && error.contains("error: cannot allocate"), "{error}");
}

#[test]
fn kernels_are_timed_without_timestamps() {
    if !has_vulkan() {
        return;
    }
    let report = json_on("no-timestamps", &["bench", "--agents", "64", "--backend", "vulkan", "--json"]);
    let rows = report["rows"].as_array().unwrap();
    for name in ["integrate", "velocity_orca", "step"] {
        let row = rows.iter().find(|row| row["name"] == name);
        assert!(row.is_some_and(|row| row["ms_min"].as_f64().unwrap() > 0.0), "{name}: {report}");
    }
}

#[test]
fn little_memory_is_enough_for_little_and_too_little_is_one_error() {
    if !has_vulkan() {
        return;
    }
    const LITTLE: &str = "memory@64";
    let crowd = |agents, backend| {
        ["simulate", "crossing", "--agents", agents, "--seconds", "0.5", "--backend", backend, "--json"]
    };
    let on_cpu = json(&crowd("500", "cpu"));
    assert_eq!(json_on(LITTLE, &crowd("500", "vulkan"))["state_hash"], on_cpu["state_hash"]);
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("p.png");
    let out = path.to_str().unwrap();
    let picture = |size| ["render", "crossing", "--size", size, "--out", out, "--force"];
    good_on(LITTLE, &picture("160x90"));
    std::fs::remove_file(&path).unwrap();
    for arguments in [&crowd("400000", "vulkan")[..], &picture("3840x2160")] {
        let output = on(LITTLE, arguments);
        let error = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
        assert_eq!(
            error.lines().filter(|line| line.starts_with("error: cannot allocate")).count(),
            1,
            "{error}"
        );
        assert!(error.contains("hint: ask for fewer agents or smaller images"), "{error}");
    }
    assert_eq!(names(folder.path()), Vec::<String>::new());
}

#[test]
fn a_device_that_is_lost_ends_the_program_with_one_error_and_no_file() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| format!("--out={}", folder.path().join(name).display());
    let runs = [
        vec!["simulate", "crossing", "--seconds", "0.2", "--backend", "vulkan"],
        vec!["render", "crossing", "--size", "64x36", "--at", "0.5", "--backend", "vulkan"],
        vec!["render", "crossing", "--size", "64x36", "--seconds", "0.2", "--backend", "vulkan"],
    ];
    for (mut run, name) in runs.into_iter().zip(["run.csv", "p.png", "v.y4m"]) {
        let out = at(name);
        run.push(&out);
        let (mut submission, mut lost) = (1, 0);
        loop {
            let output = on(&format!("lost@{submission}"), &run);
            let error = String::from_utf8_lossy(&output.stderr);
            if output.status.success() {
                break;
            }
            assert_eq!(output.status.code(), Some(1), "{run:?} at {submission}: {error}");
            let errors: Vec<&str> = error.lines().filter(|line| line.starts_with("error: ")).collect();
            assert!(errors.len() == 1 && errors[0].contains("lost"), "{run:?} at {submission}: {error}");
            assert!(!error.contains("validation:"), "{run:?} at {submission}: {error}");
            assert!(
                error.contains("hint: ") && !error.contains("hint: or "),
                "{run:?} at {submission}: {error}"
            );
            assert_eq!(names(folder.path()), Vec::<String>::new(), "{run:?} at {submission}");
            (submission, lost) = (submission * 4, lost + 1);
        }
        assert!(lost >= 2, "{run:?}");
        assert_eq!(names(folder.path()), [name], "the device was not lost before the run ended");
        std::fs::remove_file(folder.path().join(name)).unwrap();
    }
}
