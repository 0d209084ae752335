//! Errors of the public interface have types: a program can tell one from another without reading a sentence.

use super::{Token, rust_files, tokens};
use std::fs;
use std::path::Path;

/// How many tokens from `open` on it takes to close the bracket there.
fn group(tokens: &[Token<'_>], [open, close]: [&str; 2]) -> usize {
    let mut depth = 0_usize;
    for (at, token) in tokens.iter().enumerate() {
        let is_arrow = at > 0 && token.text == ">" && tokens[at - 1].text == "-";
        if token.text == open {
            depth += 1;
        } else if token.text == close && !is_arrow {
            depth -= 1;
            if depth == 0 {
                return at + 1;
            }
        }
    }
    tokens.len()
}

/// The error type of the `Result<..>` whose `<` comes first; empty where an alias leaves it out.
fn error_type<'s, 't>(tokens: &'t [Token<'s>]) -> &'t [Token<'s>] {
    let inside = &tokens[1..group(tokens, ["<", ">"]).max(2) - 1];
    let (mut at, mut last) = (0, None);
    while at < inside.len() {
        let pair = match inside[at].text {
            "<" => ["<", ">"],
            "(" => ["(", ")"],
            "[" => ["[", "]"],
            text => {
                at += 1;
                // one more may close the list
                last = if text == "," && at < inside.len() { Some(at) } else { last };
                continue;
            }
        };
        at += group(&inside[at..], pair);
    }
    last.map_or(&[], |last| &inside[last..])
}

/// Whether it is text, nothing, or anything at all.
fn is_untyped(error: &[Token<'_>]) -> bool {
    error.iter().any(|token| matches!(token.text, "String" | "str" | "dyn" | "(")) && !error.is_empty()
}

/// Lines of public items whose error is text. What is `pub` can be reached: the lint `unreachable_pub` sees to it.
fn untyped(source: &str) -> Vec<usize> {
    let tokens = tokens(source);
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text);
    let mut found = Vec::new();
    for start in 0..tokens.len() {
        let until = |ends: &[&str]| {
            let mut at = start;
            while at < tokens.len() && !ends.contains(&text(at)) {
                // the `;` of `[u8; 2]` ends nothing
                at += if text(at) == "[" { group(&tokens[at..], ["[", "]"]) } else { 1 };
            }
            at
        };
        let end = match text(start) {
            "type" if matches!(text(start + 1), "Err" | "Error") && text(start + 2) == "=" => {
                if is_untyped(&tokens[start + 3..until(&[";"])]) {
                    found.push(tokens[start].line);
                }
                continue;
            }
            "pub" if text(start + 1) == "(" => continue,
            // what these hold is as public as they are
            "pub" if matches!(text(start + 1), "enum" | "trait") => {
                let body = until(&["{"]);
                body + group(&tokens[body..], ["{", "}"])
            }
            "pub" => until(&["{", "}", ";"]),
            _ => continue,
        };
        for at in start..end {
            if text(at) == "Result" && text(at + 1) == "<" && is_untyped(error_type(&tokens[at + 1..end])) {
                found.push(tokens[at].line);
            }
        }
    }
    found
}

#[test]
fn errors_of_public_items_have_types() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&src, &mut files).unwrap();
    assert!(files.len() > 300, "{} files", files.len());
    let mut faults = Vec::new();
    for file in files {
        let lines = untyped(&fs::read_to_string(&file).unwrap());
        let place = |line| format!("{}:{line}", file.strip_prefix(&src).unwrap().display());
        faults.extend(lines.into_iter().map(place));
    }
    assert_eq!(faults, Vec::<String>::new(), "give these errors a type that implements std::error::Error");
}

#[test]
fn finds_text_for_an_error_however_it_is_written() {
    for (line, source) in [
        (1, "pub fn f(a: &str) -> Result<Self, String> {}"),
        (
            4,
            "pub const fn f<T: Fn(u8) -> u8>(\n    a: T,\n    b: [u8; 2],\n) -> Result<\n    Vec<u8>,\n    String,\n>;",
        ),
        (1, "pub unsafe fn f() -> std::result::Result<(u8, Vec<(u8, u8)>), &'static str> where u8: Copy {}"),
        (1, "pub fn f(each: impl Fn() -> Result<(), String>) {}"),
        (2, "pub struct S {\n    pub parse: fn(&str) -> Result<f32, std::string::String>,\n}"),
        (3, "pub trait T {\n    type A;\n    fn f() -> Result<(), Box<dyn Error>>;\n}"),
        (1, "pub enum E { A(u8), B { found: Result<u8, ()> } }"),
        (1, "pub type Answer<T> = Result<T, Option<String>>;"),
        (2, "impl FromStr for S {\n    type Err = String;\n}"),
        (1, "impl TryFrom<u8> for S { type Error = &'static str; }"),
    ] {
        assert_eq!(untyped(source), [line], "{source}");
    }
    for source in [
        "pub(crate) fn f() -> Result<(), String> {} fn g() -> Result<(), String> {}",
        "pub fn f() -> Result<HashMap<String, String>, Error> { let a: Result<u8, String> = g(); }",
        "pub fn f() -> Result<String> {} pub fn g() -> fmt::Result {} // Result<u8, String>",
        "pub fn f(of: fn(&str) -> u8) -> Result<Box<dyn Fn(u8) -> String>, super::Error<'_>> {}",
        "impl FromStr for S { type Err = UnknownName; } impl Iterator for S { type Item = String; }",
        "struct S { pub a: u8 } fn f() -> Result<u8, String> {}",
    ] {
        assert_eq!(untyped(source), Vec::<usize>::new(), "{source}");
    }
}
