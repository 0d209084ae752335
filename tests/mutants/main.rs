//! Are the tests good? Plants single errors and runs the tests that ought to notice.
//!
//! `scripts/test mutants` runs everything and writes `docs/mutants.md`. Parts:
//!
//! ```text
//! scripts/gpu-env cargo test --features view,hot-reload --test mutants -- shaders [PART OF A FILE'S NAME ...]
//! scripts/gpu-env cargo test --features view,hot-reload --test mutants -- rust [PART OF AN ERROR'S NAME]
//! scripts/gpu-env cargo test --features view,hot-reload --test mutants -- page
//! ```
//!
//! What a part finds is kept in `target/mutants.json`, in the place of what was found there before. `page` writes the page from that, after
//! `survivors.toml` was edited, say. `--most N` tries N errors in a file instead of twenty.
#![allow(
    clippy::print_stdout,
    clippy::print_stderr,
    clippy::cast_precision_loss,
    reason = "a program for the terminal that counts to some thousands"
)]

mod check;
mod list;
mod plant;
mod rust;
mod shaders;
mod tokens;
mod types;

use serde::{Deserialize, Serialize};
use shaders::Fate;
use std::path::Path;
use std::process::ExitCode;

const SURVIVORS: &str = "tests/mutants/survivors.toml";
const TABLES: &str = "tests/mutants/rust";
const PAGE: &str = "docs/mutants.md";
/// Errors tried in a file.
const MOST: usize = 20;

/// What was found, by parts.
const KEPT: &str = "target/mutants.json";

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// All that was found.
#[derive(Debug, Default, Serialize, Deserialize)]
struct Found {
    planted: Vec<shaders::Planted>,
    tried: Vec<rust::Tried>,
}

impl Found {
    fn read() -> Result<Self, Failure> {
        match std::fs::read_to_string(KEPT) {
            Ok(text) => Ok(serde_json::from_str(&text)?),
            Err(_) => Ok(Self::default()),
        }
    }

    /// Replaces the earlier findings with the new ones.
    fn keep(mut self, planted: Vec<shaders::Planted>, tried: Vec<rust::Tried>) -> Result<(), Failure> {
        self.planted.retain(|old| planted.iter().all(|new| new.name != old.name));
        self.tried.retain(|old| tried.iter().all(|new| new.name != old.name));
        self.planted.extend(planted);
        self.tried.extend(tried);
        self.planted.sort_by(|a, b| a.name.cmp(&b.name));
        self.tried.sort_by(|a, b| a.name.cmp(&b.name));
        Ok(std::fs::write(KEPT, serde_json::to_string_pretty(&self)?)?)
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::FAILURE,
        Err(error) => {
            eprintln!("mutants: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run() -> Result<bool, Failure> {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let most = match words.iter().position(|word| word == "--most") {
        Some(at) if at + 1 < words.len() => {
            let number = words[at + 1].parse()?;
            words.drain(at..at + 2);
            number
        }
        _ => MOST,
    };
    let words: Vec<&str> = words.iter().map(String::as_str).collect();
    match words.as_slice() {
        ["check", folder, file, job] => {
            let done = check::check(Path::new(folder), Path::new(file), Path::new(job));
            done.map(|()| true).map_err(|error| error.to_string().into())
        }
        ["shaders", only @ ..] => {
            let planted = plant_shaders(only, most)?;
            let is_caught =
                planted.iter().flat_map(|file| file.fates.values()).all(|fate| *fate != Fate::Survived);
            let mut kept = Found::read()?;
            if only.is_empty() {
                kept.planted.clear(); // files that are gone
            }
            kept.keep(planted, Vec::new())?;
            Ok(is_caught)
        }
        ["rust", only @ ..] => {
            let tried = rust::run(TABLES, only.first().unwrap_or(&""))?;
            let is_caught = tried.iter().all(|one| one.caught);
            let mut kept = Found::read()?;
            if only.is_empty() {
                kept.tried.clear();
            }
            kept.keep(Vec::new(), tried)?;
            Ok(is_caught)
        }
        ["page"] => page(most),
        ["all"] => {
            let planted = plant_shaders(&[], most)?;
            Found::default().keep(planted, Vec::new())?;
            Found::read()?.keep(Vec::new(), rust::run(TABLES, "")?)?;
            page(most)
        }
        _ => {
            Err("say what to plant: all, shaders [PART OF A NAME ...] or rust [PART OF A NAME]; or: page"
                .into())
        }
    }
}

fn plant_shaders(only: &[&str], most: usize) -> Result<Vec<shaders::Planted>, Failure> {
    let workers = std::thread::available_parallelism().map_or(1, usize::from);
    shaders::run(only, most, workers, &list::Survivors::read(SURVIVORS)?.always)
}

/// Writes the page; true if all is as it must be.
fn page(most: usize) -> Result<bool, Failure> {
    let Found { planted, tried } = Found::read()?;
    let outcome = list::judge(&planted, &tried, &list::Survivors::read(SURVIVORS)?, most);
    std::fs::create_dir_all("docs")?;
    std::fs::write(PAGE, &outcome.page)?;
    outcome.faults.iter().for_each(|fault| println!("{fault}"));
    Ok(outcome.faults.is_empty())
}
