//! The readers of `targets.rs` under libFuzzer, which keeps inputs that reach new code. See `docs/fuzzing.md`.
//!
//! `GAITWAY_FUZZ_READER` names the reader; where it is not set, the names are printed. `GAITWAY_FUZZ_SEEDS` names a folder that the reader's valid files are written to,
//! and a dictionary of their words, `words.dict`, beside them in the folder above.
#![no_main]
#![allow(clippy::unwrap_used, clippy::panic, reason = "what fails here is a finding")]

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

use libfuzzer_sys::{fuzz_mutator, fuzz_target, fuzzer_mutate};
use mutate::Random;
use std::collections::BTreeSet;
use std::path::Path;
use std::sync::LazyLock;
use targets::Target;

static READER: LazyLock<&Target> = LazyLock::new(|| {
    let name = std::env::var("GAITWAY_FUZZ_READER").unwrap_or_default();
    targets::all().find(|target| target.name == name).unwrap_or_else(|| {
        let names: Vec<&str> = targets::all().map(|target| target.name).collect();
        panic!("GAITWAY_FUZZ_READER is {name:?}; it must be one of {}", names.join(", "))
    })
});
static SEEDS: LazyLock<Vec<Vec<u8>>> = LazyLock::new(|| (READER.seeds)());

fuzz_target!(
    init: {
        if std::env::var_os("GAITWAY_FUZZ_READER").is_none() {
            targets::all().for_each(|target| println!("{}", target.name));
            std::process::exit(0);
        }
        if let Some(folder) = std::env::var_os("GAITWAY_FUZZ_SEEDS") {
            write_seeds(Path::new(&folder));
        }
    },
    |input: &[u8]| {
        if let Err(fault) = answer::ask(&READER, input) {
            panic!("{}: {fault}", READER.name);
        }
    }
);

// One fault in sixteen is ours: numbers, words and packed arrays that libFuzzer would not come upon by itself.
fuzz_mutator!(|data: &mut [u8], size: usize, most: usize, seed: u32| {
    if seed % 16 > 0 {
        return fuzzer_mutate(data, size, most);
    }
    let mut random = Random::new(seed.into());
    let seeds = &SEEDS;
    let pool = [data[..size].to_vec(), seeds[random.below(seeds.len())].clone()];
    let faulty = mutate::mutate(&pool, READER.form, &mut random);
    let kept = faulty.len().min(most);
    data[..kept].copy_from_slice(&faulty[..kept]);
    kept
});

fn write_seeds(folder: &Path) {
    std::fs::create_dir_all(folder).unwrap();
    let mut words = BTreeSet::new();
    for (number, seed) in SEEDS.iter().enumerate() {
        std::fs::write(folder.join(format!("seed-{number}")), seed).unwrap();
        let parts = seed.split(|byte| !byte.is_ascii_alphanumeric() && !b"_-.".contains(byte));
        words.extend(parts.filter(|word| (2..=40).contains(&word.len())).map(<[u8]>::to_vec));
    }
    let lines: Vec<String> =
        words.iter().map(|word| format!("\"{}\"\n", String::from_utf8_lossy(word))).collect();
    std::fs::write(folder.with_file_name("words.dict"), lines.concat()).unwrap();
}
