//! How it ends: output that cannot be written, Ctrl-C, a kill, too little memory.

use super::{bad, good, has_vulkan, program};
use std::fs::File;
use std::io::{BufRead as _, BufReader, Read as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

#[test]
fn a_result_that_cannot_be_printed_is_an_error() {
    for arguments in [
        &["--help"][..],
        &["--version"],
        &["devices"],
        &["devices", "--json"],
        &["gait", "show"],
        &["simulate", "garden", "--seconds", "0", "--backend", "cpu"],
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let full = File::options().write(true).open("/dev/full").unwrap();
        for (out, why) in [(Stdio::from(writer), "Broken pipe"), (Stdio::from(full), "No space")] {
            let output = program().args(arguments).stdout(out).output().unwrap();
            let error = String::from_utf8(output.stderr).unwrap();
            assert_eq!(output.status.code(), Some(1), "{arguments:?}: {error}");
            assert!(
                error.contains("error: cannot write to standard output") && error.contains(why),
                "{error}"
            );
        }
    }
}

#[test]
fn a_picture_or_file_that_cannot_be_written_is_an_error() {
    let folder = tempfile::tempdir().unwrap();
    let missing = folder.path().join("no/such/sheet.png");
    let (code, error) = bad(&["gait", "show", "--out", missing.to_str().unwrap()]);
    assert!(code == 1 && error.contains("sheet.png"), "{error}");
    for (out, what) in [("/dev/null", "a device"), ("/tmp", "a folder")] {
        let link = folder.path().join("link.csv");
        let _ = std::fs::remove_file(&link);
        std::os::unix::fs::symlink(out, &link).unwrap();
        let file = link.to_str().unwrap();
        let (_, error) = bad(&["gait", "walk", "--emotion", "sad", "--out", file, "--force"]);
        assert!(error.contains(what), "{error}");
    }
}

/// A run that goes on until it is asked to end.
fn endless(arguments: &[&str]) -> Child {
    program().args(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
}

fn tell(child: &Child, signal: &str) {
    let status = Command::new("kill").args([signal, &child.id().to_string()]).status().unwrap();
    assert!(status.success());
}

/// Waits until a file that a run writes has more than `bytes` bytes.
fn wait_for(child: &mut Child, file: &Path, bytes: u64) {
    while std::fs::metadata(file).map_or(0, |data| data.len()) <= bytes {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it had written {}", file.display());
        std::thread::sleep(Duration::from_millis(5));
    }
}

fn names(folder: &Path) -> Vec<String> {
    let name = |entry: std::io::Result<std::fs::DirEntry>| entry.unwrap().file_name().into_string().unwrap();
    let mut names: Vec<_> = std::fs::read_dir(folder).unwrap().map(name).collect();
    names.sort();
    names
}

fn forever(out: &str) -> [&str; 9] {
    ["simulate", "crossing", "--agents", "60", "--seconds", "86400", "--backend", "cpu", out]
}

#[test]
fn interrupted_trajectories_end_where_they_were_and_can_be_read() {
    // the smaller number of bytes is there before the first step
    for (signal, name, bytes) in [
        ("-INT", "run.csv", 4096),
        ("-TERM", "run.sqlite", 4096),
        ("-TERM", "run.sqlite", 0),
        ("-INT", "run.txt", 4096),
        ("-INT", "run.txt", 0),
    ] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let mut child = endless(&forever(&format!("--out={}", path.display())));
        wait_for(&mut child, &folder.path().join(format!(".{name}.partial")), bytes);
        tell(&child, signal);
        let mut result = String::new();
        child.stdout.take().unwrap().read_to_string(&mut result).unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{name}: {result}");
        assert!(result.contains("state hash"), "{result}");
        assert_eq!(names(folder.path()), [name], "nothing else is left");
        let again = ["replay", path.to_str().unwrap(), "--fps", "10", "--seconds", "0", "--backend", "cpu"];
        assert!(good(&again).contains("60 people"), "{name}");
    }
}

#[test]
fn an_interrupted_video_ends_at_the_frame_reached() {
    if !has_vulkan() {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("v.y4m");
    let out = format!("--out={}", path.display());
    let mut child = endless(&["render", "garden", "--size", "64x36", "--seconds", "86400", &out]);
    wait_for(&mut child, &folder.path().join(".v.y4m.partial"), 10_000);
    tell(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let bytes = std::fs::read(&path).unwrap();
    let head = bytes.iter().position(|byte| *byte == b'\n').unwrap() + 1;
    assert_eq!((bytes.len() - head) % (6 + 64 * 36 * 3 / 2), 0, "whole frames");
    assert_eq!(names(folder.path()), ["v.y4m"]);
}

#[test]
fn what_keeps_no_part_of_its_result_ends_at_once() {
    let mut child = endless(&["validate", "--backend", "cpu"]);
    let mut said = BufReader::new(child.stderr.take().unwrap()).lines();
    assert!(said.next().unwrap().unwrap().starts_with("validating"));
    tell(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
}

#[test]
fn what_is_stopped_in_the_middle_of_a_file_leaves_no_part_of_it() {
    let folder = tempfile::tempdir().unwrap();
    let videos = folder.path().join("videos");
    let mut child = endless(&["gait", "show", "--videos", videos.to_str().unwrap()]);
    let is_part = |name: &String| name.ends_with(".partial");
    while !videos.exists() || !names(&videos).iter().any(is_part) {
        assert!(child.try_wait().unwrap().is_none(), "it ended before it had begun a video");
        std::thread::sleep(Duration::from_millis(5));
    }
    tell(&child, "-TERM");
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!names(&videos).iter().any(is_part), "{:?}", names(&videos));
}

#[test]
fn what_a_killed_run_left_is_swept_by_the_next_of_that_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.csv");
    let left = folder.path().join(".run.csv.partial");
    let out = format!("--out={}", path.display());
    let mut child = endless(&forever(&out));
    wait_for(&mut child, &left, 4096);
    child.kill().unwrap();
    child.wait().unwrap();
    assert_eq!(names(folder.path()), [".run.csv.partial"]);
    good(&["simulate", "crossing", "--seconds", "0.1", "--backend", "cpu", &out]);
    assert_eq!(names(folder.path()), ["run.csv"]);
}

/// Runs with at most so many KiB of address space.
fn within(kib: u32, arguments: &[&str]) -> (Option<i32>, String) {
    let program = program();
    let mut words: Vec<String> = vec![program.get_program().to_str().unwrap().into()];
    words.extend(program.get_args().map(|word| word.to_str().unwrap().to_owned()));
    words.extend(arguments.iter().map(|word| (*word).to_owned()));
    let line = format!("ulimit -v {kib}; exec \"$@\"");
    let output = Command::new("sh").args(["-c", &line, "sh"]).args(&words).output().unwrap();
    (output.status.code(), String::from_utf8(output.stderr).unwrap())
}

#[test]
fn too_little_memory_gives_one_line_of_error() {
    let simulate = |agents| ["simulate", "crossing", "--agents", agents, "--seconds", "0.1"];
    let (code, error) = within(300_000, &simulate("400000"));
    let errors = error.lines().filter(|line| line.starts_with("error: ")).count();
    assert_eq!((code, errors), (Some(1), 1), "{error}");
    assert!(error.contains("not enough memory") && error.contains("hint: "), "{error}");
    // a small crowd has room, on the CPU, with as many threads as there is room for
    let (code, error) = within(300_000, &simulate("8"));
    assert_eq!(code, Some(0), "{error}");
}
