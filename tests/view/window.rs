//! The window, on a virtual display (Xvfb): it opens, draws, is resized and clicked at, and the validation layer
//! has nothing to say (with `GAITWAY_VALIDATION=sync`, as scripts/test has it).
//!
//! Skipped with a line where there is no Xvfb; `GAITWAY_REQUIRE_WINDOW=1` demands it. `scripts/setup --view` brings it.

use crate::common::program;
use gaitway::library::GaitLibrary;
use gaitway::picture::Image;
use gaitway::render::camera::View;
use gaitway::scenario::{Scenario, populate_from};
use gaitway::view::Rig;
use gaitway::view::pick::{self, Pillar, Ray};
use glam::{Vec2, Vec3};
use serde_json::Value;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

/// Longest wait for anything: only a guard against hanging, on machines with other work to do.
const PATIENCE: Duration = Duration::from_secs(240);
const SIZE: [u32; 2] = [960, 600];
const AGENTS: u32 = 40;

/// A virtual display; it ends with this.
struct Display {
    server: Child,
    name: String,
    /// Xvfb keeps the screen in a file here.
    folder: tempfile::TempDir,
}

impl Display {
    /// All pixels of the screen: an XWD image, big-endian words of a header, then pixels of blue, green, red.
    fn shows(&self) -> Vec<[u8; 3]> {
        let bytes = std::fs::read(self.folder.path().join("Xvfb_screen0")).unwrap();
        let word = |at: usize| u32::from_be_bytes(bytes[4 * at..4 * at + 4].try_into().unwrap()) as usize;
        bytes[word(0) + 12 * word(19)..].chunks_exact(4).map(|p| [p[2], p[1], p[0]]).collect()
    }
}

impl Drop for Display {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

fn display() -> Option<Display> {
    let folder = tempfile::tempdir().unwrap();
    let started = Command::new("Xvfb")
        .args(["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp", "-noreset", "-fbdir"])
        .arg(folder.path())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn();
    let mut server = match started {
        Ok(server) => server,
        Err(error) => {
            assert!(!crate::common::gpu::is_demanded("GAITWAY_REQUIRE_WINDOW"), "no Xvfb: {error}");
            println!("skipped: no Xvfb ({error}); scripts/setup --view brings it");
            return None;
        }
    };
    let mut line = String::new();
    BufReader::new(server.stdout.take().unwrap()).read_line(&mut line).unwrap();
    assert!(!line.trim().is_empty(), "Xvfb does not start");
    Some(Display { server, name: format!(":{}", line.trim()), folder })
}

/// The program with these arguments, with no display.
fn gaitway(arguments: &[&str]) -> Command {
    let mut command = program();
    command.args(arguments);
    for name in ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET"] {
        command.env_remove(name);
    }
    command
}

/// A window on the display, of a crowd that stands still.
fn open(display: &Display, more: &[&str]) -> Child {
    let (agents, size) = (AGENTS.to_string(), format!("{}x{}", SIZE[0], SIZE[1]));
    let mut all = vec!["view", "crossing", "--agents", &agents, "--size", &size, "--json"];
    all.extend(more);
    let mut command = gaitway(&all);
    command.env("DISPLAY", &display.name).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// The exit code after Ctrl-C.
const INTERRUPTED: i32 = 130;

/// What came of it, with this exit code.
fn outcome(output: &Output, code: i32) -> Value {
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(code), "{error}");
    assert!(!error.contains("validation:"), "{error}");
    serde_json::from_slice(&output.stdout).unwrap()
}

fn read_png(path: &Path) -> Image {
    let decoder = png::Decoder::new(BufReader::new(std::fs::File::open(path).unwrap()));
    let mut reader = decoder.read_info().unwrap();
    let mut bytes = vec![0; reader.output_buffer_size().unwrap()];
    let info = reader.next_frame(&mut bytes).unwrap();
    let channels = info.color_type.samples();
    let pixels = bytes[..info.buffer_size()]
        .chunks_exact(channels)
        .flat_map(|pixel| [pixel[0], pixel[1], pixel[2], 255])
        .collect();
    Image { width: info.width, height: info.height, pixels }
}

fn colors(image: &Image, columns: std::ops::Range<u32>) -> usize {
    let of_row = |y| columns.clone().filter_map(move |x| image.pixel(x, y));
    (0..image.height).flat_map(of_row).collect::<std::collections::BTreeSet<_>>().len()
}

/// An agent that can be seen to the right of the panel, and the pixel of its chest, before the first step.
fn person_in_view() -> (u64, [u32; 2]) {
    let mut scenario = Scenario::builtin("crossing").unwrap();
    scenario.population.agents = AGENTS;
    let geometry = scenario.geometry();
    let crowd = populate_from(&scenario, &GaitLibrary::built_in().unwrap()).unwrap();
    let camera = Rig::new(geometry.overview.0, geometry.overview.1).camera();
    let view = View::mono(&camera, SIZE[0], SIZE[1]);
    let scenery = geometry.scenery();
    let people = || {
        let pillar = |agent: &gaitway::scenario::AgentStart| Pillar {
            position: agent.position.to_array(),
            foot: agent.elevation,
            radius: agent.radius,
            height: 1.8,
        };
        crowd.agents.iter().map(pillar)
    };
    let size = Vec2::new(SIZE[0] as f32, SIZE[1] as f32);
    for (number, agent) in crowd.agents.iter().enumerate() {
        let chest = Vec3::new(agent.position.x, agent.elevation + 1.1, agent.position.y);
        let Some(pixel) = view.pixel_from_world(0, chest, SIZE[0], SIZE[1]) else { continue };
        if pixel.x < 330.0 || pixel.x > size.x - 10.0 || pixel.y < 10.0 || pixel.y > size.y - 10.0 {
            continue;
        }
        let at = Vec2::new(pixel.x.round(), pixel.y.round());
        let ray = Ray { origin: view.eyes[0], direction: view.ray(0, at / size * 2.0 - 1.0) };
        if pick::first(&ray, people(), pick::wall(&ray, &scenery)).is_some_and(|(found, _)| found == number) {
            return (number as u64, [at.x as u32, at.y as u32]);
        }
    }
    panic!("no person can be seen");
}

/// Whether that is the colour of the bracket about a picked person.
fn is_bracket([red, green, blue]: [u8; 3]) -> bool {
    red > 240 && green > 220 && (90..150).contains(&blue)
}

/// Waits until something is there.
fn until<T>(what: &str, mut look: impl FnMut() -> Option<T>) -> T {
    let begin = Instant::now();
    loop {
        if let Some(found) = look() {
            return found;
        }
        assert!(begin.elapsed() < PATIENCE, "{what}: not there after {PATIENCE:?}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[test]
fn without_a_display_the_error_says_what_to_do_instead() {
    let output = gaitway(&["view", "crossing", "--agents", "4", "--seconds", "1"]).output().unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{error}");
    assert!(error.contains("no window can be opened") && error.contains("gaitway render"), "{error}");
    assert!(!error.contains("panicked"), "{error}");
}

#[test]
fn the_window_shows_crowd_and_panel_and_a_click_picks_who_stands_there() {
    let Some(display) = display() else { return };
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("window.png");
    let (agent, [x, y]) = person_in_view();
    let click = format!("{x},{y}");
    let shot = file.to_str().unwrap();
    let child = open(&display, &["--pause", "--seconds", "6", "--shot", shot, "--click", &click]);
    let outcome = outcome(&child.wait_with_output().unwrap(), 0);
    assert!(outcome["frames"].as_u64().unwrap() > 0, "{outcome}");
    assert_eq!(outcome["steps"], 0, "it is paused: {outcome}");
    assert_eq!(outcome["picked"]["id"], agent, "{outcome}");
    assert!(outcome["picked"]["emotion"].is_string());
    assert_eq!(outcome["shots"], serde_json::json!([file]));
    let image = read_png(&file);
    assert_eq!([image.width, image.height], SIZE);
    keep(&file, "window.png");
    assert!(colors(&image, 300..SIZE[0]) > 500, "streets, buildings and people have many colours");
    let panel = colors(&image, 0..280);
    assert!(panel > 20, "{panel}: text has many tones");
    let corner = image.pixel(3, SIZE[1] - 3).unwrap();
    assert!(corner.iter().take(3).all(|tone| *tone < 70), "the panel is dark: {corner:?}");
    // the bracket about the picked person
    let bracket = (0..image.height)
        .flat_map(|y| (300..image.width).map(move |x| (x, y)))
        .filter(|(x, y)| image.pixel(*x, *y).is_some_and(|p| is_bracket([p[0], p[1], p[2]])));
    assert!(bracket.count() > 20, "a bracket about who was picked");
}

#[test]
fn a_real_click_and_a_change_of_size_reach_the_crowd_and_it_is_filmed() {
    let Some(display) = display() else { return };
    let hand =
        |arguments: &[&str]| Command::new("xdotool").args(arguments).env("DISPLAY", &display.name).output();
    if hand(&["version"]).is_err() {
        println!("skipped: no xdotool");
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let film = folder.path().join("seen.y4m");
    let (agent, [x, y]) = person_in_view();
    // if a wait below fails, the window closes by itself in the end
    let seconds = PATIENCE.as_secs().to_string();
    let child = open(&display, &["--pause", "--seconds", &seconds, "--record", film.to_str().unwrap()]);
    let window = until("a window", || {
        let found = hand(&["search", "--name", "gaitway"]).unwrap();
        let text = String::from_utf8_lossy(&found.stdout).trim().to_owned();
        text.lines().next().map(str::to_owned)
    });
    until("the crowd in the window", || {
        let tones: std::collections::BTreeSet<[u8; 3]> = display.shows().into_iter().collect();
        (tones.len() > 500).then_some(())
    });
    let bracket = || display.shows().into_iter().filter(|[r, g, b]| is_bracket([*r, *g, *b])).count();
    let before = bracket();
    let (x, y) = (x.to_string(), y.to_string());
    hand(&["mousemove", "--window", &window, &x, &y]).unwrap();
    hand(&["click", "1"]).unwrap();
    until("a bracket about who was picked", || (bracket() > before + 20).then_some(()));
    hand(&["windowsize", &window, "700", "420"]).unwrap();
    until("the end of the film, where the size changes", || film.exists().then_some(()));
    // Ctrl-C, since there is no window manager that could close it
    assert!(Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap().success());
    let outcome = outcome(&child.wait_with_output().unwrap(), INTERRUPTED);
    assert_eq!(outcome["picked"]["id"], agent, "{outcome}");
    assert_eq!(outcome["size"], serde_json::json!([700, 420]), "{outcome}");
    assert!(outcome["swapchains"].as_u64().unwrap() >= 2, "{outcome}");
    assert_eq!(outcome["videos"], serde_json::json!([film]), "a video ends where the size changes");
    assert!(std::fs::metadata(&film).unwrap().len() > 500_000);
}

#[test]
fn times_are_shown_on_both_backends() {
    let Some(display) = display() else { return };
    for backend in ["cpu", "vulkan"] {
        let child = open(&display, &["--seconds", "4", "--backend", backend]);
        let outcome = outcome(&child.wait_with_output().unwrap(), 0);
        for (what, kernels) in
            [("step_ms", ["advance_journey", "integrate"]), ("picture_ms", ["cull", "pose"])]
        {
            let whole = outcome[what]["whole"].as_f64().unwrap();
            let of = |kernel: &str| outcome[what]["kernels"][kernel].as_f64();
            assert!(
                kernels.iter().all(|kernel| of(kernel).is_some_and(|ms| ms > 0.0)),
                "{backend}: {outcome}"
            );
            let times = outcome[what]["kernels"].as_object().unwrap().values();
            let sum: f64 = times.map(|ms| ms.as_f64().unwrap()).sum();
            assert!(sum < whole, "{backend}, {what}: {sum} of {whole}");
        }
    }
}

/// Copies a picture to where `GAITWAY_PICTURES` says, to be looked at.
fn keep(file: &Path, name: &str) {
    if let Some(folder) = std::env::var_os("GAITWAY_PICTURES") {
        std::fs::copy(file, PathBuf::from(folder).join(name)).unwrap();
    }
}
