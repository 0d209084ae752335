//! Compiled pipelines that later programs find in a file: on a device whose driver hands them out.

use super::{device, has_vulkan, program};
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const DRIVER: &str = "pipelines";
const CROWD: [&str; 4] = ["simulate", "crossing", "--seconds", "0"];

/// Folders of one test.
struct Place {
    folder: tempfile::TempDir,
}

impl Place {
    fn new() -> Self {
        Self { folder: tempfile::tempdir().unwrap() }
    }

    fn cache(&self) -> PathBuf {
        self.folder.path().join("cache")
    }

    fn log(&self) -> PathBuf {
        self.folder.path().join("log")
    }

    /// A command whose cache is here.
    fn command(&self, arguments: &[&str], cache: &Path) -> Command {
        let mut command = program();
        device::on(&mut command, DRIVER).args(arguments).args(["--backend", "vulkan", "--json", "--quiet"]);
        command.env("GAITWAY_PIPELINE_CACHE", cache).env(device::layer::pipelines::LOG, self.log());
        command
    }

    /// What a run says that must end well and without a word on standard error.
    fn run(&self, arguments: &[&str], cache: &Path) -> Value {
        let output = self.command(arguments, cache).output().unwrap();
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success() && error.is_empty(), "{arguments:?}: {:?}\n{error}", output.status);
        serde_json::from_slice(&output.stdout).unwrap()
    }

    fn hash(&self) -> Value {
        self.run(&CROWD, &self.cache())["state_hash"].clone()
    }

    /// Pipelines that the last device compiled, and that it found.
    fn last(&self) -> [u32; 2] {
        let text = fs::read_to_string(self.log()).unwrap();
        let words = text.lines().last().unwrap().split(", ");
        let numbers: Vec<u32> = words.map(|word| word.split(' ').next().unwrap().parse().unwrap()).collect();
        [numbers[0], numbers[1]]
    }

    /// The one file of the cache.
    fn file(&self) -> PathBuf {
        let found: Vec<_> = fs::read_dir(self.cache()).unwrap().map(|entry| entry.unwrap().path()).collect();
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].clone()
    }
}

#[test]
fn what_one_program_compiled_the_next_one_finds() {
    if !has_vulkan() {
        return;
    }
    let place = Place::new();
    let hash = place.hash();
    let [compiled, taken] = place.last();
    assert!(compiled > 5 && taken == 0, "{compiled} {taken}");
    let written = fs::metadata(place.file()).unwrap().modified().unwrap();
    assert_eq!(place.hash(), hash);
    assert_eq!(place.last(), [0, compiled]);
    assert_eq!(fs::metadata(place.file()).unwrap().modified().unwrap(), written, "written again for nothing");

    // pictures add to it, drawing pipelines too
    let picture = place.folder.path().join("p.png");
    let render = ["render", "crossing", "--size", "64x36", "--force", "--out", picture.to_str().unwrap()];
    place.run(&render, &place.cache());
    let [more, _] = place.last();
    assert!(more > 10, "{more}");
    place.run(&render, &place.cache());
    assert_eq!(place.last()[0], 0);
    place.hash();
    assert_eq!(place.last(), [0, compiled]);
}

#[test]
fn a_damaged_file_is_ignored_and_replaced() {
    if !has_vulkan() {
        return;
    }
    let place = Place::new();
    let hash = place.hash();
    let [compiled, _] = place.last();
    let whole = fs::read(place.file()).unwrap();
    let with = |change: &dyn Fn(&mut Vec<u8>)| {
        let mut bytes = whole.clone();
        change(&mut bytes);
        bytes
    };
    let damaged = [
        with(&|bytes| bytes.truncate(whole.len() - 1)),
        with(&|bytes| bytes[whole.len() / 2] ^= 0x10),
        vec![0xff; 100_000],
    ];
    for (number, bytes) in damaged.into_iter().enumerate() {
        fs::write(place.file(), bytes).unwrap();
        assert_eq!(place.hash(), hash, "damage {number}");
        assert_eq!(place.last(), [compiled, 0], "damage {number}");
        assert_eq!(fs::read(place.file()).unwrap(), whole, "damage {number}");
    }
}

#[test]
fn a_folder_that_cannot_be_written_to_is_no_error() {
    if !has_vulkan() {
        return;
    }
    let place = Place::new();
    let hash = place.hash();
    let file = place.folder.path().join("a-file");
    fs::write(&file, "").unwrap();
    for cache in [file.join("below"), file.clone(), "/proc/nowhere".into(), "off".into()] {
        assert_eq!(place.run(&CROWD, &cache)["state_hash"], hash, "{}", cache.display());
        assert_eq!(place.last()[1], 0, "{}", cache.display());
    }
    assert_eq!(fs::read(&file).unwrap(), b"");
    assert!(!Path::new("off").exists());
    // nor is a folder in the place of the file
    let own = place.file();
    fs::remove_file(&own).unwrap();
    fs::create_dir(&own).unwrap();
    assert_eq!(place.hash(), hash);
}

#[test]
fn programs_that_write_at_once_leave_one_whole_file() {
    if !has_vulkan() {
        return;
    }
    let place = Place::new();
    let start = |crowd: &[&str]| {
        place.command(crowd, &place.cache()).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap()
    };
    // other models have other kernels, so that the files differ
    let rvo = [&CROWD[..], &["--set", "navigation.model=rvo"]].concat();
    let programs: Vec<_> = (0..6).map(|number| start(if number % 2 == 0 { &CROWD } else { &rvo })).collect();
    let mut hashes = [Vec::new(), Vec::new()];
    for (number, program) in programs.into_iter().enumerate() {
        let output = program.wait_with_output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        let said: Value = serde_json::from_slice(&output.stdout).unwrap();
        hashes[number % 2].push(said["state_hash"].clone());
    }
    for hashes in &mut hashes {
        hashes.dedup();
        assert_eq!(hashes.len(), 1, "{hashes:?}");
    }
    assert_eq!(vec![place.hash()], hashes[0]);
    // at most the last two missed one another; now all is there
    place.run(&rvo, &place.cache());
    for crowd in [&CROWD[..], &rvo] {
        place.run(crowd, &place.cache());
        assert_eq!(place.last()[0], 0, "{crowd:?}");
    }
    place.file();
}

#[test]
fn wrong_arithmetic_never_gets_into_the_file() {
    if !has_vulkan() {
        return;
    }
    let place = Place::new();
    let mut command = place.command(&CROWD, &place.cache());
    assert!(command.env("GAITWAY_WRONG_ARITHMETIC", "by-1").output().unwrap().status.success());
    assert!(!place.cache().exists());
}
