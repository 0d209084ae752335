//! Which module may use which: reads every path from the crate's root in `src/` and fails on an arrow that
//! points back.
//!
//! Comments and strings do not count (documentation may name what comes later); a module's own unit
//! tests do. What a test needs of several layers belongs in `tests/`.

#[path = "layers/documents.rs"]
mod documents;
#[path = "layers/errors.rs"]
mod errors;
#[path = "layers/imports.rs"]
mod imports;
#[path = "layers/loops.rs"]
mod loops;
#[path = "layers/words.rs"]
mod words;

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// From left to right; a module uses what stands in an earlier line, never its own line or a later one.
const ORDER: &[&[&str]] = &[
    &["statistics"],
    &["gait"],
    &["perception"],
    &["library"],
    &["avatar"],
    &["scenario"],
    &["sim"],
    &["export"],
    &["replay"],
    &["render"],
    &["scene"],
    &["view", "xr"],
    &["closed_loop", "study", "sweep", "validate", "verify"],
    &["bench"],
    &["cli"],
];
/// Words of the subject, and dealings with the system, that every module of [`ORDER`] may use. They use one another and no more.
const COMMON: &[&str] = &[
    "emotion", "glb", "ground", "hash", "keys", "picture", "random", "file", "spelling", "stop", "table",
    "wkt",
];
/// Declarations that both backends share, and the constants of the shaders: under every room.
const FLOOR: &str = "kernels";
/// They stand on the floor alone and know nothing of gaits or emotions. What lanes do not run, the reference runs for them.
const BACKENDS: &[&str] = &["reference", "lanes", "gpu"];
/// What the backend of devices uses besides: it keeps compiled pipelines in a file.
const USED_BY_GPU: &[&str] = &["file", "hash"];
/// The modules that may touch a backend.
const USES_BACKENDS: &[&str] =
    &["sim", "render", "scene", "view", "xr", "closed_loop", "validate", "verify", "bench", "cli"];
/// Gathers the errors of all layers, and every layer may return it: the one way round by intention.
const ERROR: &str = "error";

/// Place in [`ORDER`].
fn place(module: &str) -> Option<usize> {
    ORDER.iter().position(|line| line.contains(&module))
}

fn known(module: &str) -> bool {
    place(module).is_some()
        || COMMON.contains(&module)
        || BACKENDS.contains(&module)
        || [FLOOR, ERROR].contains(&module)
}

fn may_use(from: &str, to: &str) -> bool {
    if from == to || to == ERROR {
        return true;
    }
    if COMMON.contains(&to) {
        let is_for_gpu = from == "gpu" && USED_BY_GPU.contains(&to);
        return COMMON.contains(&from) || place(from).is_some() || is_for_gpu;
    }
    if to == FLOOR {
        return from != ERROR;
    }
    if BACKENDS.contains(&to) {
        return USES_BACKENDS.contains(&from) || (from, to) == ("lanes", "reference");
    }
    match (place(from), place(to)) {
        (Some(from), Some(to)) => to < from,
        _ => false,
    }
}

/// A word or a sign of Rust source, and its line.
#[derive(Debug, PartialEq, Eq)]
struct Token<'a> {
    text: &'a str,
    line: usize,
}

/// Words and single signs, without comments, strings, character literals and spaces.
fn tokens(source: &str) -> Vec<Token<'_>> {
    let bytes = source.as_bytes();
    let word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
    let (mut found, mut at) = (Vec::new(), 0);
    while at < bytes.len() {
        let rest = &source[at..];
        let length = if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") {
            block_comment(rest)
        } else if let Some(length) = string(rest) {
            length
        } else if word(bytes[at]) {
            let length = rest.bytes().take_while(|&byte| word(byte)).count();
            found.push((at, length));
            length
        } else {
            let length = rest.chars().next().map_or(1, char::len_utf8);
            if !bytes[at].is_ascii_whitespace() {
                found.push((at, length));
            }
            length
        };
        at += length;
    }
    let (mut line, mut seen) = (1, 0);
    let numbered = found.into_iter().map(|(start, length)| {
        line += source[seen..start].matches('\n').count();
        seen = start;
        Token { text: &source[start..start + length], line }
    });
    numbered.collect()
}

/// Bytes of the block comment that `text` begins with; they nest.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0_usize, 0);
    while at < text.len() {
        let pair = text.as_bytes().get(at..at + 2);
        match pair {
            Some(b"/*") => (depth, at) = (depth + 1, at + 2),
            Some(b"*/") => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
    text.len()
}

/// Bytes of the string or character literal that `text` begins with, if it does.
fn string(text: &str) -> Option<usize> {
    let prefix = ["br", "cr", "r", "b", "c", ""]
        .into_iter()
        .find(|prefix| text.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(['"', '\'', '#'])))?;
    let body = &text[prefix.len()..];
    if prefix.ends_with('r') {
        let hashes = body.bytes().take_while(|&byte| byte == b'#').count();
        let inner = body[hashes..].strip_prefix('"')?; // otherwise a raw word, r#type
        let end = format!("\"{}", "#".repeat(hashes));
        return Some(inner.find(&end).map_or(text.len(), |at| prefix.len() + hashes + 1 + at + end.len()));
    }
    let quote = *body.as_bytes().first()?;
    if quote == b'\'' {
        // A lifetime has no closing quote after one character.
        let mut inner = body[1..].chars();
        let first = inner.next()?;
        if first != '\\' && inner.next() != Some('\'') {
            return None;
        }
    } else if quote != b'"' {
        return None;
    }
    let mut escaped = false;
    for (at, byte) in body.bytes().enumerate().skip(1) {
        if byte == quote && !escaped {
            return Some(prefix.len() + at + 1);
        }
        escaped = byte == b'\\' && !escaped;
    }
    Some(text.len())
}

/// First words of the path or `{..}` group that begins at `at`: what it takes from the root.
fn heads<'s>(tokens: &[Token<'s>], at: usize) -> Vec<(usize, &'s str)> {
    let Some(first) = tokens.get(at) else { return Vec::new() };
    if first.text != "{" {
        return vec![(first.line, first.text)];
    }
    let (mut depth, mut found, mut starts) = (1_usize, Vec::new(), true);
    for token in &tokens[at + 1..] {
        match token.text {
            "{" => depth += 1,
            "}" => depth -= 1,
            "," if depth == 1 => starts = true,
            text if starts && text != ":" => {
                found.push((token.line, text));
                starts = false;
            }
            _ => {}
        }
        if depth == 0 {
            break;
        }
    }
    found
}

/// What the source takes from the crate's root, by `crate::` or by enough `super::`; `depth` is the
/// number of modules the file lies below the root.
fn root_uses(source: &str, depth: usize) -> Vec<(usize, &str)> {
    let tokens = tokens(source);
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    let separator = |at: usize| text(at) == ":" && text(at + 1) == ":";
    let (mut found, mut at) = (Vec::new(), 0);
    let mut braces = Vec::new(); // true for those of an inline module
    while at < tokens.len() {
        match text(at) {
            "{" => braces.push(at >= 2 && text(at - 2) == "mod"),
            "}" => {
                braces.pop();
            }
            "crate" if separator(at + 1) => found.extend(heads(&tokens, at + 3)),
            "super" if separator(at + 1) => {
                let mut steps = 0;
                while text(at) == "super" && separator(at + 1) {
                    (steps, at) = (steps + 1, at + 3);
                }
                if steps == depth + braces.iter().filter(|&&module| module).count() {
                    found.extend(heads(&tokens, at));
                }
                continue; // `at` is on the word after the last `super::` already
            }
            _ => {}
        }
        at += 1;
    }
    found
}

/// What `lib.rs` re-exports at the root: name to module.
fn reexports(library: &str) -> BTreeMap<&str, &str> {
    let tokens = tokens(library);
    let mut found = BTreeMap::new();
    for start in 0..tokens.len() {
        if tokens[start].text != "use" {
            continue;
        }
        let words = tokens[start + 1..].iter().take_while(|token| token.text != ";");
        let mut words = words.map(|token| token.text).filter(|text| text.starts_with(char::is_alphabetic));
        if let Some(module) = words.next() {
            found.extend(words.map(|name| (name, module)));
        }
    }
    found
}

/// One line for each use in `source` (the file `path`, relative to `src/`) that points back or nowhere.
fn faults(path: &str, source: &str, reexports: &BTreeMap<&str, &str>) -> Vec<String> {
    let modules: Vec<&str> =
        path.trim_end_matches(".rs").split('/').filter(|&part| part != "mod" && part != "main").collect();
    let from = modules.first().copied().unwrap_or("cli");
    if [ERROR, "lib", "low_level"].contains(&from) {
        return Vec::new();
    }
    if !known(from) {
        return vec![format!("src/{path}: module {from} has no place in tests/layers.rs: give it one")];
    }
    let fault = |(line, name): (usize, &str)| {
        let to = reexports.get(name).copied().unwrap_or(name);
        if matches!(to, "*" | "self") {
            Some(format!("src/{path}:{line}: takes the whole root of the crate: name the module instead"))
        } else if !known(to) {
            Some(format!("src/{path}:{line}: {from} uses crate::{to}, which has no place in tests/layers.rs"))
        } else if !may_use(from, to) {
            Some(format!("src/{path}:{line}: {from} may not use {to}: the arrow points back"))
        } else {
            None
        }
    };
    root_uses(source, modules.len()).into_iter().filter_map(fault).collect()
}

/// All `.rs` files below a folder, sorted.
fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) -> io::Result<()> {
    let mut entries = fs::read_dir(folder)?.map(|entry| Ok(entry?.path())).collect::<io::Result<Vec<_>>>()?;
    entries.sort();
    for path in entries {
        if path.is_dir() {
            rust_files(&path, found)?;
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    Ok(())
}

#[test]
fn no_arrow_points_back() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let library = fs::read_to_string(src.join("lib.rs")).unwrap();
    let reexports = reexports(&library);
    let mut files = Vec::new();
    rust_files(&src, &mut files).unwrap();
    assert!(files.len() > 10, "only {} files found below {}", files.len(), src.display());
    let mut all = Vec::new();
    for file in &files {
        let path = file.strip_prefix(&src).unwrap().to_str().unwrap().replace('\\', "/");
        all.extend(faults(&path, &fs::read_to_string(file).unwrap(), &reexports));
    }
    assert!(all.is_empty(), "{} arrows:\n{}", all.len(), all.join("\n"));
}

/// Faults of one planted line, with `Emotion` and `Error` re-exported at the root.
fn planted(path: &str, source: &str) -> Vec<String> {
    faults(path, source, &reexports("pub use emotion::Emotion;\npub use error::{Error, Result};"))
}

#[test]
fn finds_a_planted_arrow_however_it_is_written() {
    for (path, source) in [
        ("gait/mod.rs", "use crate::sim::Simulation;"),
        ("gait/mod.rs", "pub(crate) use crate::sim;"),
        ("gait/mod.rs", "use crate::{emotion::Emotion, sim::{self, State}};"),
        ("gait/mod.rs", "use crate::{\n    emotion::Emotion,\n    sim,\n};"),
        ("gait/mod.rs", "fn f() -> usize { crate::sim::count() }"),
        ("gait/mod.rs", "use super::sim::Simulation;"),
        ("gait/import/bvh.rs", "use super::super::super::sim::Simulation;"),
        ("gait/mod.rs", "mod tests { use super::super::sim::Simulation; }"),
        ("gait/mod.rs", "fn f<'a>(x: &'a str) { let c = '\"'; crate::sim::f(x, c) }"),
        ("gait/mod.rs", "/* a /* nested */ comment */ use crate::sim::Simulation;"),
        ("gait/mod.rs", "let a = r#\"\"quoted\"\"#; let b = b'\\''; use crate::sim::Simulation;"),
    ] {
        let found = planted(path, source);
        assert_eq!(found.len(), 1, "{path}: {source}: {found:?}");
        assert!(found[0].contains("gait may not use sim"), "{found:?}");
    }
}

#[test]
fn names_the_file_and_line_of_an_arrow() {
    let found = planted(
        "avatar/mod.rs",
        "//! Avatars.\n\nuse crate::{\n    gait::Joint,\n    scenario::Crowd,\n};\n",
    );
    assert_eq!(found, ["src/avatar/mod.rs:5: avatar may not use scenario: the arrow points back"]);
}

#[test]
fn comments_strings_and_neighbours_in_the_same_module_are_no_arrows() {
    for (path, source) in [
        ("gait/mod.rs", "//! Feeds [`crate::sim`].\n/// crate::render\n/* crate::sim */ fn f() {}"),
        ("gait/mod.rs", "const TEXT: &str = \"crate::sim::Simulation \\\" crate::render\";"),
        ("gait/mod.rs", "const TEXT: &str = r#\"use crate::sim;\"#;"),
        ("gait/import/bvh.rs", "use super::super::Gait; use super::Error; use crate::gait::Joint;"),
        ("gait/mod.rs", "mod tests { use super::sim; use super::*; }"),
        ("gait/mod.rs", "pub(crate) fn f() {} pub(in crate::gait) fn g() {}"),
        ("gait/mod.rs", "use crate::{Emotion, Error, ground};"),
        ("scenario/mod.rs", "use crate::{Result, avatar, library::{GaitLibrary, sim}};"),
    ] {
        let found = planted(path, source);
        assert!(found.is_empty(), "{path}: {source}: {found:?}");
    }
}

#[test]
fn the_order_is_that_of_the_design() {
    let allowed = [
        ("sim", "scenario"),
        ("sim", "gpu"),
        ("sim", "reference"),
        ("sim", "lanes"),
        ("lanes", "reference"),
        ("sim", "kernels"),
        ("scenario", "kernels"),
        ("ground", "kernels"),
        ("gpu", "kernels"),
        ("reference", "kernels"),
        ("gpu", "error"),
        ("gpu", "file"),
        ("render", "export"),
        ("render", "gpu"),
        ("export", "sim"),
        ("export", "gait"),
        ("xr", "render"),
        ("verify", "reference"),
        ("bench", "verify"),
        ("cli", "render"),
    ];
    let forbidden = [
        ("gait", "perception"),
        ("library", "avatar"),
        ("sim", "render"),
        ("sim", "export"),
        ("export", "render"),
        ("export", "gpu"),
        ("export", "cli"),
        ("scenario", "gpu"),
        ("avatar", "reference"),
        ("gpu", "reference"),
        ("gpu", "lanes"),
        ("reference", "lanes"),
        ("lanes", "sim"),
        ("reference", "gpu"),
        ("gpu", "gait"),
        ("gpu", "emotion"),
        ("reference", "file"),
        ("reference", "ground"),
        ("kernels", "gpu"),
        ("kernels", "emotion"),
        ("emotion", "gait"),
        ("view", "xr"),
        ("verify", "cli"),
    ];
    for (from, to) in allowed {
        assert!(may_use(from, to), "{from} must be allowed to use {to}");
    }
    for (from, to) in forbidden {
        assert!(!may_use(from, to), "{from} must not be allowed to use {to}");
    }
}

#[test]
fn a_module_without_a_place_and_a_glob_of_the_root_are_faults() {
    assert!(planted("utils.rs", "").concat().contains("utils has no place"));
    assert!(planted("gait/mod.rs", "use crate::helpers::f;").concat().contains("crate::helpers"));
    assert!(planted("gait/mod.rs", "use crate::*;").concat().contains("whole root"));
    assert!(planted("gait/mod.rs", "use crate::{self as root};").concat().contains("whole root"));
    assert!(planted("main.rs", "use crate::cli;").is_empty());
}

/// Lines of a test by which it would pass, and say nothing, where a device or a simulation fails.
fn silent_skips(source: &str) -> Vec<&str> {
    let asks = |line: &str| {
        ["var(", "var_os("].iter().any(|read| line.contains(&format!("{read}\"GAITWAY_REQUIRE_")))
    };
    let drops = |line: &str| {
        let makes =
            ["imulation", "Device::open", "Engine::new", "device("].iter().any(|name| line.contains(name));
        let is_branch =
            line.contains("let Ok(") || line.trim_start().starts_with("if ") && line.contains("is_err()");
        makes && (is_branch || line.contains(".ok()"))
    };
    source.lines().filter(|line| asks(line) || drops(line)).collect()
}

#[test]
fn tests_ask_for_a_device_in_one_way_which_never_skips_in_silence() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let own = [root.join("tests/common/gpu.rs"), root.join("tests/layers.rs")];
    let mut read = 0;
    for folder in ["src", "tests"] {
        let mut files = Vec::new();
        rust_files(&root.join(folder), &mut files).expect("a folder of the repository");
        for path in files.iter().filter(|path| !own.contains(path)) {
            let source = fs::read_to_string(path).expect("a file of the repository");
            let tests = match folder {
                "src" => source.find("#[cfg(test)]").map_or("", |at| &source[at..]),
                _ => &source,
            };
            let found = silent_skips(tests);
            assert!(found.is_empty(), "{}: use tests/common/gpu.rs: {found:#?}", path.display());
            read += 1;
        }
    }
    assert!(read > 300, "{read} files");
    for planted in [
        "let Ok(mut simulation) = simulation(&scenario, backend) else { return None };",
        "let device = Device::open(None, Validation::Off).ok()?;",
        "Err(error) if std::env::var(\"GAITWAY_REQUIRE_GPU\").is_err() => return,",
    ] {
        assert_eq!(silent_skips(planted), [planted]);
    }
}
