//! Structs that buffers hold, as Rust.

use crate::compile::{Field, Layout, Shader, Source};
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// The Rust twins of all structs in buffers, each of which must be the same wherever it is declared.
pub(crate) fn text<'a>(shaders: impl Iterator<Item = &'a (Source, Shader)>) -> Result<String, String> {
    let mut layouts: BTreeMap<&str, &Layout> = BTreeMap::new();
    for layout in shaders.flat_map(|(_, shader)| &shader.layouts) {
        if let Some(first) = layouts.insert(&layout.name, layout)
            && first.fields != layout.fields
        {
            return Err(format!("{}: `{}` differs from {}", layout.place, layout.name, first.place));
        }
    }
    let mut text = String::from("// Written by build.rs from the structs of shaders/.\n");
    for layout in layouts.values() {
        let (name, place) = (&layout.name, &layout.place);
        let _ = write!(
            text,
            "/// `struct {name}`, declared at `{place}`.\n#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]\n\
             #[repr(C)]\npub struct {name} {{\n"
        );
        for field in &layout.fields {
            let comment = documentation(field);
            let _ = writeln!(text, "/// {comment}\npub {}: {},", field.name, field.rust);
        }
        let _ = write!(
            text,
            "}}\nimpl Default for {name} {{\nfn default() -> Self {{ Zeroable::zeroed() }}\n}}\n"
        );
    }
    Ok(text)
}

/// What is said of a field, as Markdown: names of WGSL as code.
fn documentation(field: &Field) -> String {
    if field.comment.is_empty() {
        return field.name.replace('_', " ");
    }
    let word = |word: &str| {
        let name = word.trim_matches(|c: char| !(c.is_alphanumeric() || c == '_'));
        if name.contains('_') { word.replacen(name, &format!("`{name}`"), 1) } else { word.to_owned() }
    };
    let words: Vec<String> = field.comment.split(' ').map(word).collect();
    words.join(" ").replace('[', "\\[").replace(']', "\\]")
}
