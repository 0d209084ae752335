//! Broken files of every kind that is read: whatever the bytes, the reader answers, quickly, with memory in
//! proportion, and never panics.
//!
//! Valid files are mutated (bytes flipped, cut, doubled, spliced; numbers replaced by NaN, 1e30 and huge counts; words
//! doubled; arrays and chunks repacked so that checksums and lengths hold). An input whose answer is new (another
//! message, or the first that is read) joins the pool that is mutated further. What fails is stored in
//! `tests/fuzz/corpus/` as `READER-HASH` and is replayed by `the_corpus_is_answered` from then on.
//!
//! `cargo test` runs 2 seconds in all. For longer, or for one reader:
//! ```text
//! GAITWAY_FUZZ_SECONDS=600 GAITWAY_FUZZ_READER=bvh cargo test --test fuzz -- --nocapture
//! ```
//! `GAITWAY_FUZZ_SEED` starts another sequence, `GAITWAY_FUZZ_KEEP=N` stores N small inputs a reader whose answers
//! are new, though nothing is wrong with them. The same readers guided by coverage: `scripts/test fuzz` (`docs/fuzzing.md`).
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "helpers of tests: a failed unwrap is a failed test, and what was measured is printed"
)]

mod answer;
#[path = "../gait/import/containers.rs"]
mod containers;
mod crowds;
mod memory;
mod mutate;
mod people;
#[cfg(feature = "study")]
mod requests;
mod studies;
mod targets;
#[cfg(feature = "study")]
mod visits;
#[path = "../gait/import/walker.rs"]
#[allow(dead_code, reason = "shared with the tests of import; not all of it is needed here")]
mod walker;

use answer::MEMORY_FREE;
use mutate::Random;
use std::collections::HashSet;
use std::hash::{DefaultHasher, Hash as _, Hasher as _};
use std::path::{Path, PathBuf};
use std::time::Instant;
use targets::Target;

/// Largest input that is kept for further mutation.
const LARGEST: usize = 1 << 16;
/// Largest input that `GAITWAY_FUZZ_KEEP` stores.
const KEPT_BYTES: usize = 3000;
/// Most inputs in the pool.
const POOL: usize = 3000;

/// The answer to one input, without the numbers in it; or what is wrong.
fn ask(target: &Target, input: &[u8]) -> Result<String, String> {
    let answer = answer::ask(target, input)?;
    Ok(answer.map_or_else(|message| signature(&message), |read| format!("read: {read}")))
}

/// A message without what comes from the input: quoted text and numbers.
fn signature(message: &str) -> String {
    let mut quoted = false;
    let mut kept = String::new();
    for c in message.chars().take(400) {
        if c == '"' {
            quoted = !quoted;
        } else if !quoted && (c.is_ascii_alphabetic() || c == ' ') {
            kept.push(c);
        }
    }
    kept.truncate(120);
    kept
}

fn corpus() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/corpus")
}

fn store(target: &Target, input: &[u8]) -> PathBuf {
    let mut hasher = DefaultHasher::new();
    input.hash(&mut hasher);
    let path = corpus().join(format!("{}-{:016x}", target.name, hasher.finish()));
    std::fs::create_dir_all(corpus()).unwrap();
    std::fs::write(&path, input).unwrap();
    path
}

/// Mutates for some time; the failures found, with the number of inputs and of different answers.
fn shake(target: &Target, seconds: f64, seed: u64, last: Option<&Path>) -> (Vec<String>, usize, usize) {
    let mut random = Random::new(seed);
    let mut pool = (target.seeds)();
    for (index, input) in pool.iter().enumerate() {
        match answer::ask(target, input) {
            Ok(Ok(_)) => {}
            wrong => return (vec![format!("{}: seed {index} must be read: {wrong:?}", target.name)], 0, 0),
        }
    }
    let (mut answers, mut failures, mut failed) = (HashSet::new(), Vec::new(), HashSet::new());
    let (begin, mut count) = (Instant::now(), 0);
    let (keep, mut kept) = (variable("GAITWAY_FUZZ_KEEP").unwrap_or(0), 0);
    while begin.elapsed().as_secs_f64() < seconds {
        let input = mutate::mutate(&pool, target.form, &mut random);
        if let Some(last) = last {
            // A stack overflow or a refused allocation ends the process: the input is then here.
            std::fs::write(last, &input).unwrap();
        }
        count += 1;
        match ask(target, &input) {
            Ok(answer) => {
                if answers.insert(answer) && pool.len() < POOL && input.len() <= LARGEST {
                    if kept < keep && input.len() <= KEPT_BYTES {
                        store(target, &input);
                        kept += 1;
                    }
                    pool.push(input);
                }
            }
            Err(fault) => {
                if failed.insert(signature(&fault)) {
                    let path = store(target, &input);
                    failures.push(format!("{}: {fault}; input {}", target.name, path.display()));
                }
            }
        }
    }
    (failures, count, answers.len())
}

fn variable<T: std::str::FromStr>(name: &str) -> Option<T> {
    std::env::var(name).ok().and_then(|value| value.parse().ok())
}

#[test]
fn broken_files_are_answered() {
    let seconds: f64 = variable("GAITWAY_FUZZ_SECONDS").unwrap_or(2.0);
    let seed: u64 = variable("GAITWAY_FUZZ_SEED").unwrap_or(1);
    let only: Option<String> = variable("GAITWAY_FUZZ_READER");
    let chosen: Vec<&Target> =
        targets::all().filter(|target| only.as_deref().is_none_or(|only| only == target.name)).collect();
    let names: Vec<&str> = targets::all().map(|target| target.name).collect();
    assert!(!chosen.is_empty(), "no reader {only:?}; there are {names:?}");
    // The faults are reported at the end; a stack trace each would drown them.
    std::panic::set_hook(Box::new(|_| {}));
    let is_long = seconds > 10.0;
    let mut failures = Vec::new();
    for target in &chosen {
        let last = std::env::temp_dir().join(format!("gaitway-fuzz-{}-{}", target.name, std::process::id()));
        let share = seconds / chosen.len() as f64;
        let (found, count, answers) = shake(target, share, seed, is_long.then_some(last.as_path()));
        println!(
            "{}: {count} inputs in {share:.1} s, {answers} different answers, {} faults",
            target.name,
            found.len()
        );
        failures.extend(found);
        let _ = std::fs::remove_file(last);
    }
    let _ = std::panic::take_hook();
    assert!(failures.is_empty(), "seed {seed}:\n{}", failures.join("\n"));
}

#[test]
fn the_corpus_is_answered() {
    let mut files: Vec<PathBuf> = std::fs::read_dir(corpus())
        .map(|entries| entries.map(|entry| entry.unwrap().path()).collect())
        .unwrap_or_default();
    files.sort();
    let mut count = 0;
    for path in files {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let reader = name.rsplit_once('-').map_or("", |(reader, _)| reader);
        let target = targets::all().find(|target| target.name == reader);
        let target = target.unwrap_or_else(|| panic!("{name}: no reader is called {reader:?}"));
        let input = std::fs::read(&path).unwrap();
        if let Err(fault) = ask(target, &input) {
            panic!("{name}: {fault}");
        }
        count += 1;
    }
    println!("{count} inputs replayed");
}

#[test]
fn files_made_to_unfold_are_held_in_proportion() {
    let named = |name: &str| targets::all().find(|target| target.name == name).unwrap();
    for (name, what, input) in targets::hostile() {
        match ask(named(name), &input) {
            Ok(answer) => println!("{name}, {what}, {} bytes: {answer}", input.len()),
            Err(fault) => panic!("{name}, {what}: {fault}"),
        }
    }
}

#[test]
fn the_harness_sees_panics_and_greed() {
    let target = |read| Target { name: "test", form: mutate::Form::Text, seeds: Vec::new, read };
    assert!(ask(&target(|_| panic!("no")), b"").unwrap_err().contains("panics: no"));
    let greedy = target(|_| {
        let held = vec![1_u8; MEMORY_FREE + 4096];
        Ok(held.iter().filter(|&&b| b == 1).count().to_string())
    });
    assert!(ask(&greedy, b"1").unwrap_err().contains("holds"));
    let modest = target(|_| {
        for _ in 0..100 {
            std::hint::black_box(vec![1_u8; 1 << 20]);
        }
        Ok(String::new())
    });
    assert!(ask(&modest, b"1").is_ok(), "what is freed does not count");
}
