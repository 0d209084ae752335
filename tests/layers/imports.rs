//! Which file of the crate uses which: every path in a `use` and in the code, followed through re-exports to the file
//! that defines what it names. Unit tests and re-exports themselves do not count.
#![allow(clippy::unwrap_used, reason = "a test")]

use super::{Token, rust_files, tokens};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::fs;
use std::path::{Path, PathBuf};

/// The rooms of `src/scenario`, from left to right, as in [`ORDER`]. What a file says stands alone; the last line reads all.
const SCENARIO: &[&[&str]] = &[
    &["file"],
    &["schema"],
    &["personality", "polygon", "random", "setting"],
    &["error"],
    &["builtin", "menge"],
    &["place"],
    &["check"],
    &["populate"],
    &["load"],
    &["mod"],
];

/// Rooms in which files still go round: their `mod.rs` both starts its files and holds what these share. To be emptied.
const ROUND: &[&str] = &[];

/// File to the files that it uses.
type Graph = BTreeMap<String, BTreeSet<String>>;

/// Re-exports that are followed from one name to the next.
const DEEPEST: usize = 16;

/// What a file imports, defines no module for, and says in its code.
struct Module {
    file: String,
    /// Names that `use` brings in, and the path of each from the crate's root.
    names: BTreeMap<String, Vec<String>>,
    /// Modules whose items all come in.
    globs: Vec<Vec<String>>,
    /// Names that are only passed on.
    passed: BTreeSet<String>,
    /// Items defined here.
    items: BTreeSet<String>,
    /// Paths in the code, from the crate's root where they begin with `crate`, `self` or `super`.
    paths: Vec<Vec<String>>,
}

/// The path of the module that a file of `src/` is; none of the binary's.
fn module_of(file: &str) -> Option<Vec<String>> {
    let mut parts: Vec<String> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
    match parts.last()?.as_str() {
        "main" if parts.len() == 1 => return None,
        "mod" | "lib" => drop(parts.pop()),
        _ => {}
    }
    Some(parts)
}

/// The tokens without unit tests.
fn without_tests<'s>(tokens: Vec<Token<'s>>) -> Vec<&'s str> {
    let texts: Vec<&str> = tokens.into_iter().map(|token| token.text).collect();
    let (mut kept, mut at) = (Vec::new(), 0);
    while at < texts.len() {
        if !texts[at..].starts_with(&["#", "[", "cfg", "(", "test", ")", "]"]) {
            kept.push(texts[at]);
            at += 1;
            continue;
        }
        let mut depth = 0_i32;
        at += 7;
        while at < texts.len() {
            match texts[at] {
                "{" => depth += 1,
                "}" => depth -= 1,
                _ => {}
            }
            let is_end = depth == 0 && matches!(texts[at], "}" | ";");
            at += 1;
            if is_end {
                break;
            }
        }
    }
    kept
}

/// The leaves of the tree of a `use` that begins at `at`, each with the name that it gets (`*` for all), and where it ends.
fn leaves(words: &[&str], mut at: usize, before: &[String], found: &mut Vec<(Vec<String>, String)>) -> usize {
    let mut path = before.to_vec();
    loop {
        match words.get(at).copied().unwrap_or(";") {
            ":" => at += 1,
            "{" => {
                at += 1;
                while words.get(at).is_some_and(|word| !matches!(*word, "}" | ";")) {
                    at = leaves(words, at, &path, found);
                    at += usize::from(words.get(at) == Some(&","));
                }
                return at + 1;
            }
            "as" => {
                found.push((path, words.get(at + 1).copied().unwrap_or("_").to_owned()));
                return at + 2;
            }
            "," | "}" | ";" => {
                let is_self = path.last().is_some_and(|last| last == "self") && path.len() > 1;
                if is_self {
                    path.pop();
                }
                let name = path.last().cloned().unwrap_or_default();
                found.push((path, name));
                return at;
            }
            word => {
                path.push(word.to_owned());
                at += 1;
            }
        }
    }
}

/// A path as written in module `here`, from the crate's root where it says so.
fn absolute(path: &[String], here: &[String]) -> Vec<String> {
    let mut base = match path.first().map(String::as_str) {
        Some("crate") => return [vec!["crate".to_owned()], path[1..].to_vec()].concat(),
        Some("self" | "super") => here.to_vec(),
        _ => return path.to_vec(),
    };
    let mut rest = path;
    while let [first, others @ ..] = rest {
        match first.as_str() {
            "self" => {}
            "super" => drop(base.pop()),
            _ => break,
        }
        rest = others;
    }
    [vec!["crate".to_owned()], base, rest.to_vec()].concat()
}

impl Module {
    fn read(file: &str, source: &str) -> Option<(Vec<String>, Self)> {
        let here = module_of(file)?;
        let words = without_tests(tokens(source));
        let mut module = Self {
            file: file.to_owned(),
            names: BTreeMap::new(),
            globs: Vec::new(),
            passed: BTreeSet::new(),
            items: BTreeSet::new(),
            paths: Vec::new(),
        };
        let is_name = |word: &str| word.starts_with(|c: char| c.is_alphabetic() || c == '_');
        let mut braces: Vec<Option<&str>> = Vec::new(); // names of inline modules
        let (mut at, mut said) = (0, BTreeSet::new());
        while at < words.len() {
            let word = words[at];
            let inside: Vec<String> =
                here.iter().cloned().chain(braces.iter().flatten().map(|&name| name.to_owned())).collect();
            match word {
                "{" => braces.push((at >= 2 && words[at - 2] == "mod").then(|| words[at - 1])),
                "}" => drop(braces.pop()),
                "use" if words.get(at + 1) != Some(&"<") => {
                    let is_public = at > 0 && matches!(words[at - 1], "pub" | ")");
                    let mut found = Vec::new();
                    at = leaves(&words, at + 1, &[], &mut found);
                    for (path, name) in found {
                        let path = absolute(&path, &inside);
                        if name == "*" {
                            module.globs.push(path[..path.len() - 1].to_vec());
                        } else {
                            if is_public {
                                module.passed.insert(name.clone());
                            }
                            module.names.insert(name, path);
                        }
                    }
                }
                "fn" | "struct" | "enum" | "trait" | "const" | "static" | "type" | "union" => {
                    let next = words.get(at + 1).copied().unwrap_or("");
                    module.items.insert(next.to_owned());
                }
                _ if is_name(word) => {
                    said.insert(word.to_owned());
                    let is_follower = at >= 2 && words[at - 1] == ":" && words[at - 2] == ":";
                    let is_visibility = at >= 2 && words[at - 1] == "in" && words[at - 2] == "(";
                    if !is_follower && !is_visibility && words[at + 1..].starts_with(&[":", ":"]) {
                        let mut path = vec![word.to_owned()];
                        let mut next = at + 1;
                        while words[next..].starts_with(&[":", ":"])
                            && words.get(next + 2).is_some_and(|word| is_name(word))
                        {
                            path.push(words[next + 2].to_owned());
                            next += 3;
                        }
                        module.paths.push(absolute(&path, &inside));
                    }
                }
                _ => {}
            }
            at += 1;
        }
        module.passed.retain(|name| !said.contains(name));
        Some((here, module))
    }
}

/// The whole crate.
struct Crate(BTreeMap<Vec<String>, Module>);

impl Crate {
    /// The module that defines what a path from the crate's root names; none: something of another crate.
    fn find(&self, path: &[String], depth: usize) -> Option<&Module> {
        let (mut here, mut rest) = (Vec::new(), path.strip_prefix(&["crate".to_owned()])?);
        while let [name, others @ ..] = rest {
            let module = self.0.get(&here)?;
            let child = [here.as_slice(), std::slice::from_ref(name)].concat();
            if self.0.contains_key(&child) {
                (here, rest) = (child, others);
            } else if let Some(target) = module.names.get(name).filter(|_| depth < DEEPEST) {
                return self.from(target, &here, others, depth + 1);
            } else {
                let mut globs = module.globs.iter().filter_map(|glob| self.from(glob, &here, &[], depth + 1));
                return Some(globs.rfind(|of| of.items.contains(name)).unwrap_or(module));
            }
        }
        self.0.get(&here)
    }

    /// The module that defines what a path means in module `here`, with `rest` behind it.
    fn from(&self, path: &[String], here: &[String], rest: &[String], depth: usize) -> Option<&Module> {
        if depth >= DEEPEST {
            return None;
        }
        let first = path.first()?;
        if first == "crate" {
            return self.find(&[path, rest].concat(), depth);
        }
        let child = [here, std::slice::from_ref(first)].concat();
        if self.0.contains_key(&child) {
            let root = vec!["crate".to_owned()];
            return self.find(&[root.as_slice(), here, path, rest].concat(), depth);
        }
        let target = self.0.get(here)?.names.get(first).filter(|target| target.first() != Some(first))?;
        self.from(target, here, &[&path[1..], rest].concat(), depth + 1)
    }
}

/// Which file uses which; `files` are paths below `src/` with their text.
fn graph<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Graph {
    let is_test = |file: &str| file.ends_with("/tests.rs");
    let files = files.into_iter().filter(|(file, _)| !is_test(file));
    let all = Crate(files.filter_map(|(file, source)| Module::read(file, source)).collect());
    let mut graph = Graph::new();
    for (here, module) in &all.0 {
        let imported = module.names.iter().filter(|(name, _)| !module.passed.contains(*name));
        let paths = imported.map(|(_, path)| path).chain(&module.globs).chain(&module.paths);
        let used = paths.filter_map(|path| all.from(path, here, &[], 0)).map(|used| used.file.clone());
        graph.insert(module.file.clone(), used.filter(|used| *used != module.file).collect());
    }
    graph
}

/// The shortest way along the arrows from one file to another that does not begin with the arrow between them.
fn way(graph: &Graph, from: &str, to: &str) -> Option<Vec<String>> {
    let mut before: BTreeMap<&str, &str> = BTreeMap::new();
    let mut queue = VecDeque::from([from]);
    while let Some(file) = queue.pop_front() {
        for next in graph.get(file).into_iter().flatten().map(String::as_str) {
            if (file == from && next == to) || next == from || before.contains_key(next) {
                continue;
            }
            before.insert(next, file);
            if next == to {
                let back = std::iter::successors(Some(to), |file| before.get(file).copied());
                let mut files: Vec<String> = back.map(str::to_owned).collect();
                files.reverse();
                return Some(files);
            }
            queue.push_back(next);
        }
    }
    None
}

/// Import cycles of more than two files, one (a shortest) for every set of files. Files of errors are left out: an error
/// that gathers those of its parts goes round by intention.
fn cycles(graph: &Graph) -> Vec<Vec<String>> {
    let is_error = |file: &str| file == "error.rs" || file.ends_with("/error.rs");
    let mut own = graph.clone();
    own.retain(|file, _| !is_error(file));
    own.values_mut().for_each(|used| used.retain(|file| !is_error(file)));
    let mut found: BTreeMap<BTreeSet<String>, Vec<String>> = BTreeMap::new();
    for (from, used) in &own {
        for to in used {
            if let Some(way) = way(&own, to, from) {
                found.entry(way.iter().cloned().collect()).or_insert(way);
            }
        }
    }
    found.into_values().collect()
}

/// Paths below `src/` and texts of all files of the library.
fn sources() -> Vec<(String, String)> {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files).unwrap();
    let read = |file: PathBuf| {
        let path = file.strip_prefix(&src).unwrap().to_str().unwrap();
        (path.replace('\\', "/"), fs::read_to_string(&file).unwrap())
    };
    files.into_iter().map(read).collect()
}

fn graph_of(files: &[(String, String)]) -> Graph {
    graph(files.iter().map(|(path, source)| (path.as_str(), source.as_str())))
}

/// One line for each use within `src/scenario` that points back.
fn inner_faults(graph: &Graph) -> Vec<String> {
    let room = |file: &str| {
        let inner = file.strip_prefix("scenario/")?;
        Some(inner.split('/').next().unwrap_or(inner).trim_end_matches(".rs").to_owned())
    };
    let line = |room: &str| SCENARIO.iter().position(|line| line.contains(&room));
    let mut found = Vec::new();
    for (file, used) in graph {
        for (other, from, to) in used.iter().filter_map(|other| Some((other, room(file)?, room(other)?))) {
            let points_back = match (line(&from), line(&to)) {
                (Some(from), Some(to)) => to >= from,
                _ => true,
            };
            if from != to && points_back {
                found.push(format!("src/{file} may not use src/{other}: {from} stands before {to}"));
            }
        }
    }
    found
}

#[test]
fn the_rooms_of_a_scenario_use_one_another_one_way() {
    let graph = graph_of(&sources());
    let inner = graph.iter().filter(|(file, _)| file.starts_with("scenario/"));
    let arrows: usize = inner.map(|(_, used)| used.len()).sum();
    assert!(arrows > 150, "only {arrows} arrows from files of src/scenario: are imports still read?");
    let found = inner_faults(&graph);
    assert!(found.is_empty(), "{} arrows:\n{}", found.len(), found.join("\n"));
}

/// Cycles by the room that they lie in; `/` for those through several.
fn cycles_by_room(graph: &Graph) -> BTreeMap<String, Vec<String>> {
    let room = |file: &String| file.split(['/', '.']).next().unwrap_or_default().to_owned();
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    for cycle in cycles(graph) {
        let first = room(&cycle[0]);
        let of = if cycle.iter().all(|file| room(file) == first) { first } else { "/".to_owned() };
        found.entry(of).or_default().push(cycle.join(" -> "));
    }
    found
}

#[test]
fn no_import_cycle_has_more_than_two_files() {
    let mut found = cycles_by_room(&graph_of(&sources()));
    for room in ROUND {
        assert!(found.remove(*room).is_some(), "{room} has no cycle any more: take it out of ROUND");
    }
    let left: Vec<String> = found.into_values().flatten().collect();
    assert!(left.is_empty(), "{} cycles:\n{}", left.len(), left.join("\n"));
}

#[test]
fn a_planted_inner_arrow_and_a_planted_cycle_are_found_through_re_exports() {
    let plant = |changed: &str, line: &str| {
        let mut files = sources();
        let file = files.iter_mut().find(|(path, _)| path == changed).unwrap();
        file.1.insert_str(file.1.find("\nuse ").unwrap(), &format!("\n{line}"));
        graph_of(&files)
    };
    // through the door of the room, of `scenario` and of the crate; and as a path in the code
    for line in [
        "use crate::scenario::check::people::class;",
        "use crate::scenario::Clearance;",
        "use super::super::populate::{Crowd as All};",
        "fn f() -> usize { crate::scenario::place::extent() }",
    ] {
        let found = inner_faults(&plant("scenario/file/routes.rs", line));
        assert_eq!(found.len(), 1, "{line}: {found:?}");
        assert!(found[0].starts_with("src/scenario/file/routes.rs may not use src/scenario/"), "{found:?}");
    }
    assert!(inner_faults(&plant("scenario/check/routes.rs", "use crate::scenario::Clearance;")).is_empty());
    assert!(inner_faults(&plant("scenario/file/routes.rs", "pub(in crate::scenario) fn f() {}")).is_empty());
    let small = |c: &str| {
        let files = [
            ("lib.rs", "mod a; mod b; mod error; pub use b::B;"),
            ("a.rs", "use crate::B; use crate::error::E;"),
            ("b/mod.rs", "mod inner; pub use inner::B; pub(crate) use crate::error::E;"),
            ("b/inner.rs", "use super::c::C; #[cfg(test)] mod tests { use crate::a::A; }"),
            ("b/c.rs", c),
            ("error.rs", "use crate::a::A; use crate::b::C;"),
        ];
        cycles(&graph(files))
    };
    assert_eq!(small("use super::B; use crate::error::E;"), Vec::<Vec<String>>::new(), "two files");
    let cycle = small("fn f(a: crate::a::A) {}");
    assert_eq!(cycle.len(), 1, "{cycle:?}");
    assert_eq!(cycle[0].len(), 3, "{cycle:?}");
}
