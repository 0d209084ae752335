//! Constants of shaders as Rust.

use crate::compile::constants::Constant;
use crate::compile::{Shader, Source};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Constants of shared texts, by file and name.
pub(crate) type Shared<'a> = BTreeMap<String, BTreeMap<&'a str, &'a Constant>>;

fn stem(file: &Path) -> String {
    file.file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

pub(crate) fn shared<'a>(shaders: impl Iterator<Item = &'a (Source, Shader)>) -> Shared<'a> {
    let mut shared = Shared::new();
    for constant in shaders.flat_map(|(_, shader)| &shader.constants) {
        if constant.file.starts_with("shaders/shared") {
            shared.entry(stem(&constant.file)).or_default().insert(&constant.name, constant);
        }
    }
    shared
}

/// Constants that a shader's own file declares.
pub(crate) fn own(source: &Source, shader: &Shader) -> String {
    let own = |c: &&Constant| !c.file.starts_with("shaders/shared") && stem(&c.file) == source.name;
    constants_text(shader.constants.iter().filter(own))
}

/// Constants in Rust; numbers without a sign also as lengths and indices.
fn constants_text<'a>(constants: impl Iterator<Item = &'a Constant>) -> String {
    let (mut text, mut lengths) = (String::new(), String::new());
    for c in constants {
        let (name, ty) = (&c.name, c.value.rust_type());
        let doc = format!("/// `{}:{}`: {}\n", c.file.display(), c.line, c.value.text());
        let _ = writeln!(text, "{doc}pub const {name}: {ty} = {};", c.value.rust());
        if ty == "u32" {
            let _ = writeln!(lengths, "{doc}pub const {name}: usize = super::{name} as usize;");
        }
    }
    if !lengths.is_empty() {
        let _ = write!(text, "/// The same, to count and to index with.\npub mod index {{\n{lengths}}}\n");
    }
    text
}

/// Refuses a constant in `src/reference` that has the name of one of its kernel's file or of a shared one.
pub(crate) fn are_declared_once(kernels: &[(Source, Shader)], shared: &Shared<'_>) -> Result<(), String> {
    let folder = Path::new("src/reference");
    let listing = std::fs::read_dir(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    let mut files: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.sort();
    let mut errors = Vec::new();
    for file in files {
        let own = kernels.iter().find(|(source, _)| source.name == stem(&file));
        let own = own.into_iter().flat_map(|(_, shader)| &shader.constants);
        let known: Vec<&Constant> = own.chain(shared.values().flat_map(BTreeMap::values).copied()).collect();
        let text = std::fs::read_to_string(&file).map_err(|e| format!("{}: {e}", file.display()))?;
        for (number, line) in text.lines().enumerate() {
            let words: Vec<&str> = line.split_whitespace().collect();
            let declared = words.windows(2).find(|pair| matches!(pair[0], "const" | "static"));
            let name = declared.and_then(|pair| pair[1].strip_suffix(':'));
            if let Some(first) = known.iter().find(|constant| Some(constant.name.as_str()) == name) {
                errors.push(format!(
                    "{}:{}: `{}` stands at {}:{} already: import it from crate::kernels",
                    file.display(),
                    number + 1,
                    first.name,
                    first.file.display(),
                    first.line
                ));
            }
        }
    }
    if errors.is_empty() { Ok(()) } else { Err(errors.join("\n")) }
}

/// A module for each shared file that declares constants.
pub(crate) fn write_shared(shared: &Shared<'_>, text: &mut String) {
    text.push_str("/// The constants of `shaders/shared/`.\npub mod shared {\n");
    for (stem, constants) in shared {
        let constants = constants_text(constants.values().copied());
        let _ = write!(
            text,
            "/// Constants of `shaders/shared/{stem}.wgsl`.\npub mod {stem} {{\n{constants}}}\n"
        );
    }
    text.push_str("}\n");
}
