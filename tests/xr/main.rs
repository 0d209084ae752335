//! The headset, for real: Monado without a display, its head moved by a script, on lavapipe with validation.
//!
//! Needs `scripts/setup --xr`; without it the tests say so and pass, unless `GAITWAY_REQUIRE_XR=1`.
#![cfg(feature = "xr")]
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "a test: a failure is a panic that prints"
)]

#[path = "../common/mod.rs"]
mod common;
#[path = "../device/mod.rs"]
mod device;
mod devices;
mod endurance;
mod faults;
mod flight;
mod focus;
mod gaze;
mod hands;
mod layer;
mod lens;
#[cfg(feature = "view")]
mod mirror;
mod presented;
mod recording;
mod runtimes;
mod service;
mod session;
mod smooth;
mod stage;
mod study;
mod timing;
mod wrong;

use gaitway::picture::Image;
use serde_json::Value;
use service::until;
use std::path::{Path, PathBuf};
use std::process::Child;

/// An empty square with a post straight ahead, ten metres away.
const POST: &str = r#"
name = "post"
condition = "eva-g"
bounds = [[-30.0, -30.0], [30.0, -30.0], [30.0, 30.0], [-30.0, 30.0]]
[population]
agents = 0
[user]
position = [0.0, 0.0]
heading_deg = 180.0
[[environment.props]]
kind = "box"
position = [0.0, -10.0]
size = [0.5, 6.0, 0.5]
"#;

fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("xr-{name}"));
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// The JSON object of a run that must end well, and what it noted on the way.
fn outcome(child: Child) -> (Value, String) {
    let output = child.wait_with_output().unwrap();
    let (out, notes) =
        (String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr).into_owned());
    assert!(output.status.success(), "{:?}\n{out}\n{notes}", output.status);
    assert!(!notes.contains("validation:"), "{notes}");
    (serde_json::from_str(&out).unwrap_or_else(|error| panic!("{error}: {out}\n{notes}")), notes)
}

fn states(outcome: &Value) -> Vec<&str> {
    outcome["states"].as_array().unwrap().iter().map(|state| state.as_str().unwrap()).collect()
}

/// Asserts that the crowd was stepped, or let time pass where the machine was too slow, from when it set off to its last
/// step: by the program's own clock.
fn walked_all_the_time(outcome: &Value) {
    let walked = outcome["steps"].as_f64().unwrap() / 30.0 + outcome["time_lost"].as_f64().unwrap();
    let seconds = outcome["seconds"].as_f64().unwrap();
    // at most a quarter of a second may be made up for later
    assert!((-0.05..0.3).contains(&(seconds - walked)), "{walked} of {seconds} s: {outcome}");
}

/// Columns of the post's edges in one eye's half of a picture, in fractions of a pixel.
fn post(image: &Image, eye: u32) -> Option<f32> {
    let width = image.width / 2;
    let row = image.height / 2;
    let light = |x: u32| {
        let at = ((row * image.width + eye * width + x) * 4) as usize;
        image.pixels[at..at + 3].iter().map(|c| f32::from(*c)).sum::<f32>()
    };
    // the sky at the horizon lies left and right of the post; whatever differs from it is post
    let sky = light(2);
    let (mut sum, mut mass) = (0.0, 0.0);
    for x in 0..width {
        let differs = ((light(x) - sky).abs() - 12.0).max(0.0);
        sum += differs * (x as f32 + 0.5);
        mass += differs;
    }
    (mass > 30.0).then(|| sum / mass)
}

/// A picture of ours: eight bits, with or without opacity.
fn picture(path: &Path) -> Image {
    let file = std::io::BufReader::new(std::fs::File::open(path).unwrap());
    let mut reader = png::Decoder::new(file).read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    bytes.truncate(info.buffer_size());
    let pixels = match info.color_type {
        png::ColorType::Rgb => bytes.chunks_exact(3).flat_map(|p| [p[0], p[1], p[2], 255]).collect(),
        _ => bytes,
    };
    Image { width: info.width, height: info.height, pixels }
}

/// The frames of which there are pictures in a folder, in order.
fn frames(folder: &Path) -> Vec<u64> {
    let number = |path: PathBuf| {
        path.extension().filter(|kind| *kind == "png")?;
        path.file_stem()?.to_str()?.strip_prefix("frame-")?.parse().ok()
    };
    let entries = std::fs::read_dir(folder).unwrap();
    let mut found: Vec<u64> = entries.filter_map(|entry| number(entry.unwrap().path())).collect();
    found.sort_unstable();
    found
}

/// The newest picture of a folder, once there are so many more than now.
fn after(folder: &Path, more: usize) -> Image {
    let before = frames(folder).len();
    until(|| {
        let found = frames(folder);
        match found.last() {
            Some(last) if found.len() >= before + more => {
                Ok(picture(&folder.join(format!("frame-{last:06}.png"))))
            }
            _ => Err(format!("{} pictures, {more} more than {before} are wanted", found.len())),
        }
    })
}

/// The newest picture of a folder, as soon as it shows what it should; `look` says what it lacks.
fn shows<T>(folder: &Path, mut look: impl FnMut(&Image) -> Result<T, String>) -> (Image, T) {
    until(|| {
        let found = frames(folder);
        let last = found.last().ok_or("no picture yet")?;
        let image = picture(&folder.join(format!("frame-{last:06}.png")));
        look(&image).map(|found| (image, found))
    })
}

/// The steps of a recording that is being written: the fields of its whole lines.
fn steps(recording: &Path) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(recording).unwrap_or_default();
    let rows =
        text.split_inclusive('\n').filter(|line| line.ends_with('\n') && line.as_bytes()[0].is_ascii_digit());
    rows.map(|row| row.trim_end().split(',').map(str::to_owned).collect()).collect()
}

/// Waits until a recording has so many more steps than now that are as they should be.
fn recorded(recording: &Path, more: usize, is_it: impl Fn(&[String]) -> bool) {
    let before = steps(recording).len();
    until(|| match steps(recording).iter().skip(before).filter(|step| is_it(step)).count() {
        found if found >= more => Ok(()),
        found => Err(format!("{found} such steps, {more} are wanted")),
    });
}

/// The pictures of a folder in the order of their frames.
fn pictures(folder: &Path) -> Vec<(u64, Image)> {
    let mut found: Vec<(u64, Image)> = std::fs::read_dir(folder)
        .unwrap()
        .filter_map(|entry| {
            let path = entry.unwrap().path();
            path.extension().filter(|kind| *kind == "png")?;
            let number = path.file_stem()?.to_str()?.strip_prefix("frame-")?.parse().ok()?;
            Some((number, picture(&path)))
        })
        .collect();
    found.sort_by_key(|(number, _)| *number);
    found
}
