//! The libraries of operations: functions that stand in for what Vulkan leaves open (`src/kernels/link.rs`).

use crate::compile::{Shader, Source, emit};
use crate::link::{FloatMode, Operation, declare, link};
use std::fmt::Write as _;
use std::path::Path;

/// The files of `shaders/operations/` and their names in Rust; `UNITS` of those that ask for it.
const LIBRARIES: [(&str, &str, Option<u32>, &str); 7] = [
    ("plain", "PLAIN", None, "Minimum, maximum and clamp as compare and select."),
    ("careful", "CAREFUL", None, "Correctly rounded division and root, integer minimum, maximum and clamp."),
    ("wrong", "WRONG_BY_1", Some(1), "For tests: division and root wrong by up to one unit."),
    ("wrong", "WRONG_BY_3", Some(3), "For tests: division and root wrong by up to three units."),
    ("slip", "SLIP", None, "For tests: division and root wrong by one unit for few operands."),
    ("zeros", "ZEROS", None, "For tests: minimum, maximum and clamp that return the other zero."),
    ("flush", "FLUSH", None, "For tests: subnormal numbers taken for zero."),
];

/// Compiles the libraries, writes them for Rust, and links them into every kernel, so that what cannot be linked stops the build.
/// They are no modules that a device takes, and have a folder of their own.
pub(crate) fn write(
    kernels: &[(Source, Shader)],
    [spirv, libraries]: [&Path; 2],
    text: &mut String,
) -> Result<(), String> {
    text.push_str(
        "/// Libraries of operations, which `kernels::link` puts into kernels.\npub mod operations {\n",
    );
    let mut compiled = Vec::new();
    for (file, name, units, doc) in LIBRARIES {
        let path = format!("shaders/operations/{file}.wgsl");
        let mut source = std::fs::read_to_string(&path).map_err(|e| format!("{path}: {e}"))?;
        if let Some(units) = units {
            source.push_str(&format!("const UNITS: u32 = {units}u;\n"));
        }
        let words = emit::library(&source).map_err(|e| format!("{path}: {e}"))?;
        let file = name.to_lowercase();
        crate::write_spirv(libraries, &file, &words)?;
        let list = crate::words(&format!("operations/{file}"), &words);
        let _ = write!(text, "/// {doc}\npub static {name}: &[u32] = {list};\n");
        compiled.push((name, words));
    }
    text.push_str("}\n");
    let library = |wanted: &str| compiled.iter().find(|(name, _)| *name == wanted).map(|(_, words)| words);
    let (Some(careful), Some(wrong), Some(flush)) =
        (library("CAREFUL"), library("WRONG_BY_3"), library("FLUSH"))
    else {
        return Err("a library of operations is missing".to_owned());
    };
    use Operation::{Add, Clamp, Divide, InverseRoot, Least, Most, Multiply, Root, Subtract};
    let modes = [FloatMode::SignedZeroInfNanPreserve, FloatMode::RoundingModeRte];
    for entry in kernels.iter().flat_map(|(_, shader)| &shader.entries) {
        let careful = link(&entry.spirv, careful, &[Divide, Root, Least, Most, Clamp])
            .and_then(|words| link(&words, wrong, &[Divide, Root, InverseRoot]))
            .and_then(|words| link(&words, flush, &[Add, Subtract, Multiply, Divide, Root]))
            .map_err(|error| format!("{}: {error}", entry.name))?;
        crate::write_spirv(spirv, &format!("{}.careful", entry.name), &declare(&careful, &modes))?;
    }
    Ok(())
}
