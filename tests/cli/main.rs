//! The program as people use it: help, results, JSON, errors with a way out, the same bits on both backends.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::float_cmp,
    clippy::print_stdout,
    clippy::doc_markdown,
    reason = "a test: a failure is a panic that prints, and what must be the same is the same bit for bit"
)]

#[path = "../common/mod.rs"]
mod common;
#[cfg(feature = "vulkan")]
#[path = "../device/mod.rs"]
mod device;

#[cfg(feature = "vulkan")]
mod cache;
mod crowds;
mod ending;
mod measures;
mod odd;
mod outcomes;
mod pictures;
#[cfg(feature = "study")]
mod registration;
mod scenario;
mod simulate;
mod study;
mod sweeps;
mod words;
#[cfg(feature = "vulkan")]
mod wrong;

use common::program;
use serde_json::Value;
use std::process::Output;

/// Runs the program.
fn gaitway(arguments: &[&str]) -> Output {
    program().args(arguments).output().unwrap()
}

/// Standard output of a run that must succeed.
fn good(arguments: &[&str]) -> String {
    let output = gaitway(arguments);
    let error = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{arguments:?}: {:?}\n{error}", output.status);
    String::from_utf8(output.stdout).unwrap()
}

/// The one JSON object of a run that must succeed.
fn json(arguments: &[&str]) -> Value {
    let text = good(arguments);
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{arguments:?}: {error}\n{text}"))
}

/// Exit code and standard error of a run that must fail with nothing on standard output.
fn bad(arguments: &[&str]) -> (i32, String) {
    let output = gaitway(arguments);
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(!output.status.success(), "{arguments:?} succeeded");
    assert!(output.stdout.is_empty(), "{arguments:?}: {}", String::from_utf8_lossy(&output.stdout));
    assert!(!error.contains("panicked"), "{arguments:?}: {error}");
    (output.status.code().unwrap(), error)
}

/// An error in our words: `error: ...` with `want` in it, and a way out.
fn told(code: i32, arguments: &[&str], want: &str, hint: &str) {
    let (found, error) = bad(arguments);
    assert_eq!(found, code, "{arguments:?}: {error}");
    assert_eq!(error.lines().filter(|line| line.starts_with("error: ")).count(), 1, "{arguments:?}: {error}");
    assert!(error.contains(want), "{arguments:?}: {error}");
    assert!(error.contains(hint), "{arguments:?}: {error}");
}

/// A command line that is wrong.
fn refused(arguments: &[&str], want: &str, hint: &str) {
    told(2, arguments, want, hint);
}

/// Something that went wrong while doing.
fn fails(arguments: &[&str], want: &str, hint: &str) {
    told(1, arguments, want, hint);
}

/// Whether there is a Vulkan device; prints why not. With GAITWAY_REQUIRE_GPU=1 there must be one.
fn has_vulkan() -> bool {
    if !cfg!(feature = "vulkan") {
        println!("skipped: built without Vulkan");
        return false;
    }
    let devices = json(&["devices", "--json"]);
    let has_one = devices["best"].is_u64();
    if !has_one {
        assert!(!common::gpu::is_required(), "{devices}");
        println!("skipped: no Vulkan device ({})", devices["missing"]);
    }
    has_one
}
