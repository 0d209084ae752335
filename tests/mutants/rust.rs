//! Errors in the Rust sources: all in one copy of the tree, each switched on by its name.

use serde::{Deserialize, Serialize};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

type Failure = Box<dyn std::error::Error + Send + Sync>;

/// The environment variable that switches an error on.
const SWITCH: &str = "GAITWAY_MUTANT";
/// In `new`: whether the error is switched on.
const MARK: &str = "MUTANT";
/// A test that takes so long does not end.
const PATIENCE: Duration = Duration::from_secs(300);

/// What is added to the copy's library, and to its build script.
const SWITCHED: &str = "
/// Whether an error is switched on.
#[doc(hidden)]
pub fn mutant(name: &str) -> bool {
    static NAME: std::sync::LazyLock<Option<String>> = std::sync::LazyLock::new(|| std::env::var(\"GAITWAY_MUTANT\").ok());
    NAME.as_deref() == Some(name)
}
";

#[derive(Debug, Deserialize)]
struct Table {
    mutant: Vec<Entry>,
}

/// An error: where `old` stands, once, the program does `new` instead.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Entry {
    /// What is wrong then, in words.
    name: String,
    file: String,
    /// An expression or statements.
    old: String,
    /// What is done instead; or, where it holds [`MARK`], what stands there in both cases.
    new: String,
    /// Test program: `lib`, or a name in `tests/`.
    program: String,
    /// The test that must notice, or a part of the names of several.
    test: String,
}

/// What became of an error.
#[derive(Debug, Serialize, Deserialize)]
pub(crate) struct Tried {
    pub(crate) name: String,
    pub(crate) file: String,
    pub(crate) test: String,
    pub(crate) caught: bool,
}

/// The errors that the tables in a folder list.
fn listed(folder: &str) -> Result<Vec<Entry>, Failure> {
    let files: Result<Vec<PathBuf>, _> = std::fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect();
    let mut files = files.map_err(|error: std::io::Error| error)?;
    files.sort();
    let mut entries: Vec<Entry> = Vec::new();
    for file in files {
        let table: Table = toml::from_str(&std::fs::read_to_string(&file)?)
            .map_err(|error| format!("{}: {error}", file.display()))?;
        entries.extend(table.mutant);
    }
    let mut names = BTreeSet::new();
    match entries.iter().find(|entry| !names.insert(&entry.name)) {
        Some(twice) => Err(format!("{}: two errors have this name", twice.name).into()),
        None => Ok(entries),
    }
}

/// Tries the errors that the tables in a folder list, and whose names hold `only`.
pub(crate) fn run(tables: &str, only: &str) -> Result<Vec<Tried>, Failure> {
    let entries: Vec<Entry> = listed(tables)?.into_iter().filter(|entry| entry.name.contains(only)).collect();
    if entries.is_empty() {
        return Ok(Vec::new());
    }
    let folder = copy_of_the_tree(&switched(&entries)?)?;
    let programs = build(&folder, &entries)?;
    let mut passed = BTreeSet::new();
    let mut tried = Vec::new();
    for entry in entries {
        let program =
            programs.get(&entry.program).ok_or_else(|| format!("no test program {}", entry.program))?;
        if passed.insert((entry.program.clone(), entry.test.clone()))
            && !passes(&folder, program, &entry.test, None)?
        {
            return Err(format!("{}: {} fails without any error", entry.program, entry.test).into());
        }
        let caught = !passes(&folder, program, &entry.test, Some(&entry.name))?;
        println!("{}: {}", if caught { "caught" } else { "SURVIVED" }, entry.name);
        let test = format!("{} {}", entry.program, entry.test);
        tried.push(Tried { name: entry.name, file: entry.file, test, caught });
    }
    Ok(tried)
}

/// A copy of what git knows, and of what it would add, in a folder that stays between runs; `texts` stand in the place of
/// files.
fn copy_of_the_tree(texts: &BTreeMap<String, String>) -> Result<PathBuf, Failure> {
    let folder = std::env::current_dir()?.join("target/mutants");
    let listing = Command::new("git")
        .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
        .output()?;
    if !listing.status.success() {
        return Err("git ls-files fails: the errors are planted in a copy of a git checkout".into());
    }
    let listing = String::from_utf8(listing.stdout)?;
    let files: BTreeSet<&str> = listing.split('\0').filter(|file| Path::new(file).is_file()).collect();
    remove_others(&folder, &folder, &files)?;
    for &file in &files {
        let original = std::fs::read(file)?;
        let contents = texts.get(file).map_or(original, |text| text.clone().into_bytes());
        let place = folder.join(file);
        // what is the same is left alone, so that cargo need not build it again
        if !std::fs::read(&place).is_ok_and(|old| old == contents) {
            std::fs::create_dir_all(place.parent().unwrap_or(&folder))?;
            std::fs::write(&place, contents)?;
        }
        std::fs::set_permissions(&place, std::fs::metadata(file)?.permissions())?;
    }
    Ok(folder)
}

/// Removes the files of a copy that the tree has no more: the build would take a shader that was renamed for two.
fn remove_others(copy: &Path, folder: &Path, files: &BTreeSet<&str>) -> Result<(), Failure> {
    let Ok(listing) = std::fs::read_dir(folder) else { return Ok(()) };
    for entry in listing {
        let path = entry?.path();
        let known = path.strip_prefix(copy)?;
        if path.is_dir() {
            if known != Path::new("target") {
                remove_others(copy, &path, files)?;
            }
        } else if !known.to_str().is_some_and(|known| files.contains(known) || known == "Cargo.lock") {
            std::fs::remove_file(&path)?;
        }
    }
    Ok(())
}

/// The files with the errors in them.
fn switched(entries: &[Entry]) -> Result<BTreeMap<String, String>, Failure> {
    let mut texts: BTreeMap<&str, (String, String)> = BTreeMap::new();
    for entry in entries {
        if !texts.contains_key(entry.file.as_str()) {
            let text = std::fs::read_to_string(&entry.file)
                .map_err(|error| format!("{}: {}: {error}", entry.name, entry.file))?;
            texts.insert(&entry.file, (text.clone(), text));
        }
        let Some((original, text)) = texts.get_mut(entry.file.as_str()) else { continue };
        for (place, what) in [(&*original, "there"), (&*text, "left by the errors before it")] {
            let count = place.matches(&entry.old).count();
            if count != 1 {
                let Entry { name, file, old, .. } = entry;
                return Err(format!(
                    "{name}: `{old}` must stand once in {file}, and is {what} {count} times"
                )
                .into());
            }
        }
        let Entry { name, old, new, .. } = entry;
        let switch = format!("crate::mutant({name:?})");
        let both = if new.contains(MARK) {
            new.replace(MARK, &switch)
        } else {
            format!("{{ if {switch} {{ {new} }} else {{ {old} }} }}")
        };
        *text = text.replace(old, &both);
    }
    // the build script includes some files of the library
    for root in ["src/lib.rs", "build.rs"] {
        if !texts.contains_key(root) {
            texts.insert(root, (String::new(), std::fs::read_to_string(root)?));
        }
        if let Some((_, text)) = texts.get_mut(root) {
            text.push_str(SWITCHED);
        }
    }
    Ok(texts.into_iter().map(|(file, (_, text))| (file.to_owned(), text)).collect())
}

/// Builds the test programs, with what is built for the tests anyway.
fn build(folder: &Path, entries: &[Entry]) -> Result<BTreeMap<String, PathBuf>, Failure> {
    let programs: BTreeSet<&str> = entries.iter().map(|entry| entry.program.as_str()).collect();
    let mut command = Command::new("cargo");
    command.args([
        "test",
        "--locked",
        "--features",
        "view",
        "--no-run",
        "--message-format=json-render-diagnostics",
    ]);
    for program in programs {
        match program {
            "lib" => command.arg("--lib"),
            other => command.args(["--test", other]),
        };
    }
    let target = std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| folder.join(".."), PathBuf::from);
    command.current_dir(folder).env("CARGO_TARGET_DIR", target).stderr(Stdio::inherit());
    let output = command.output()?;
    if !output.status.success() {
        return Err(
            "the copy with the errors does not build: run cargo test --no-run in target/mutants".into()
        );
    }
    let mut found = BTreeMap::new();
    for line in String::from_utf8(output.stdout)?.lines() {
        let message: serde_json::Value = serde_json::from_str(line)?;
        let (kind, name) =
            (&message["target"]["kind"][0], message["target"]["name"].as_str().unwrap_or_default());
        if let Some(file) = message["executable"].as_str().filter(|_| message["profile"]["test"] == true) {
            let name = if kind == "test" { name } else { "lib" };
            found.insert(name.to_owned(), PathBuf::from(file));
        }
    }
    Ok(found)
}

/// Whether the tests of a name pass, with an error or without; there must be some.
fn passes(folder: &Path, program: &Path, test: &str, mutant: Option<&str>) -> Result<bool, Failure> {
    let mut command = crate::shaders::on_driver(program);
    command.arg(test).current_dir(folder).env_remove(SWITCH);
    command.env("GAITWAY_REQUIRE_GPU", "1").env("GAITWAY_VALIDATION", "sync"); // as scripts/test has them
    if let Some(mutant) = mutant {
        command.env(SWITCH, mutant);
    }
    let log = tempfile::NamedTempFile::new()?;
    command.stdout(log.reopen()?).stderr(Stdio::null()).stdin(Stdio::null());
    let mut child = command.spawn()?;
    let begin = Instant::now();
    let status = loop {
        match child.try_wait()? {
            Some(status) => break Some(status),
            None if begin.elapsed() > PATIENCE => {
                child.kill()?;
                child.wait()?;
                break None;
            }
            None => std::thread::sleep(Duration::from_millis(20)),
        }
    };
    let said = std::fs::read_to_string(log.path())?;
    if said.contains("running 0 tests") {
        return Err(format!("{} has no test {test}", program.display()).into());
    }
    Ok(status.is_some_and(|status| status.success()))
}
