//! What documents and lists say is there.

use std::fs;
use std::path::Path;

/// What stands between backticks, with what stands before it.
fn quoted(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let parts: Vec<&str> = text.split('`').collect();
    (1..parts.len()).step_by(2).map(move |i| (parts[i - 1], parts[i])).collect::<Vec<_>>().into_iter()
}

/// Files and modules that a document names and that are not there.
fn missing(root: &Path, document: &str) -> Vec<String> {
    let folders = ["src/", "tests/", "shaders/", "scripts/", "assets/", "benches/", "docs/", ".ci/"];
    let is_path = |name: &str| folders.iter().any(|folder| name.starts_with(folder));
    let is_pattern = |name: &str| {
        name.contains(['*', '{', ' ', '<']) || ["NAME", "READER"].iter().any(|part| name.contains(part))
    };
    let mut found: Vec<String> = quoted(document)
        .map(|(_, name)| name.split_once(':').map_or(name, |(path, _)| path))
        .filter(|name| is_path(name) && !is_pattern(name) && !root.join(name).exists())
        .map(str::to_owned)
        .collect();
    // a row of the table of rooms names modules of its folder
    for row in document.lines().filter(|line| line.starts_with("| `src/")) {
        let mut names = quoted(row);
        let Some((_, folder)) = names.next().filter(|(_, name)| name.ends_with('/')) else { continue };
        for (_, name) in names.filter(|(before, _)| !before.ends_with("feature ")) {
            let stem = name.strip_suffix(".rs").unwrap_or(name);
            let is_module = stem.bytes().all(|b| b.is_ascii_lowercase() || b == b'_');
            let place = root.join(folder).join(stem);
            if is_module && !place.is_dir() && !place.with_extension("rs").is_file() {
                found.push(format!("{folder}{name}"));
            }
        }
    }
    found
}

/// The files that a document links to, from its own folder.
fn links(document: &str) -> Vec<&str> {
    let targets = document.split("](").skip(1).filter_map(|rest| rest.split(')').next());
    let files = targets.filter(|target| !target.contains("://") && !target.starts_with('#'));
    files.map(|target| target.split('#').next().unwrap_or(target)).collect()
}

#[test]
fn documents_name_files_and_modules_that_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = fs::read_dir(root.join("docs")).expect("a folder of the repository");
    let docs = docs.map(|entry| entry.expect("a file of the repository").path());
    let own = ["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name));
    for path in own.into_iter().chain(docs) {
        let document = fs::read_to_string(&path).expect("a document of the repository");
        let name = path.display();
        assert_eq!(missing(root, &document), Vec::<String>::new(), "{name}");
        for target in links(&document) {
            assert!(path.with_file_name(target).exists(), "{name}: no {target}");
        }
    }
    assert_eq!(links("[a](b.md#c) ![d](e.png) [f](https://g)"), ["b.md", "e.png"]);
    let planted =
        "`src/none.rs`\n| `src/xr/` | the headset: `session`, `stop` (Ctrl-C), built with feature `view` |";
    assert_eq!(missing(root, planted), ["src/none.rs", "src/xr/stop"]);
}

/// Texts of the errors that `mutants` plants in the sources which do not stand exactly once in their file.
fn misplaced(entries: &[toml::Value], read: impl Fn(&str) -> String) -> Vec<String> {
    let field = |entry: &toml::Value, name: &str| entry[name].as_str().unwrap_or_default().to_owned();
    let count = |entry: &toml::Value| read(&field(entry, "file")).matches(&field(entry, "old")).count();
    let fault = |entry: &toml::Value| match count(entry) {
        1 => None,
        found => Some(format!("{}: stands {found} times in {}", field(entry, "name"), field(entry, "file"))),
    };
    entries.iter().filter_map(fault).collect()
}

#[test]
fn every_listed_error_can_be_planted_where_the_list_says() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let read = |file: &str| fs::read_to_string(root.join(file)).unwrap_or_default();
    let entries = |list: &str| list.parse::<toml::Table>().unwrap()["mutant"].as_array().unwrap().clone();
    let mut lists = 0;
    for list in fs::read_dir(root.join("tests/mutants/rust")).unwrap() {
        let text = fs::read_to_string(list.unwrap().path()).unwrap();
        assert_eq!(misplaced(&entries(&text), read), Vec::<String>::new());
        lists += 1;
    }
    assert!(lists >= 4, "{lists} lists");
    let moved = entries("[[mutant]]\nname = \"moved\"\nfile = \"a.rs\"\nold = \"x < y\"\n");
    assert_eq!(misplaced(&moved, |_| "x < y".into()), Vec::<String>::new());
    assert_eq!(misplaced(&moved, |_| "y > x".into()), ["moved: stands 0 times in a.rs"]);
    assert_eq!(misplaced(&moved, |_| "x < y, x < y".into()), ["moved: stands 2 times in a.rs"]);
}

/// The tests that `scripts/test --quick` leaves out by name.
fn left_out(script: &str) -> Vec<&str> {
    let list = script.split("\nlong_tests=(").nth(1).and_then(|rest| rest.split(')').next());
    list.into_iter().flat_map(str::split_whitespace).collect()
}

#[test]
fn the_tests_that_a_quick_run_leaves_out_are_there() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let script = fs::read_to_string(root.join("scripts/test")).expect("a script of the repository");
    let mut files = Vec::new();
    super::rust_files(&root.join("tests"), &mut files).expect("a folder of the repository");
    let all: String = files.iter().filter_map(|file| fs::read_to_string(file).ok()).collect();
    let names = left_out(&script);
    assert!(names.len() > 5, "{names:?}");
    for name in names {
        assert!(all.contains(&format!("fn {name}()")), "no test is called {name}");
    }
    assert_eq!(left_out("a\nlong_tests=(\n  one\n  two\n)\n"), ["one", "two"]);
}
