//! Writes every kernel of `shaders/` that lanes can run as Rust, once for each set of instructions.
#![allow(clippy::print_stdout, reason = "cargo reads a build script's standard output")]

#[path = "../src/kernels/fault.rs"]
#[allow(dead_code, missing_docs, unreachable_pub, reason = "checked in the crate gaitway")]
mod fault;
#[path = "../src/kernels/source.rs"]
#[allow(
    dead_code,
    missing_docs,
    unreachable_pub,
    clippy::missing_errors_doc,
    reason = "checked in the crate gaitway"
)]
mod source;

use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Expression, Literal};
use source::Source;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use wgsl_lanes::Isa;
use wgsl_lanes::generate::{Arrays, Axis, Options, kernels};

const SHADERS: &str = "../shaders";

/// Kernels whose twin is faster: it walks along rows of cells, or has next to nothing to compute.
const TWIN_IS_FASTER: [&str; 6] = ["flow", "flow_density", "idle", "lead_agents", "queue", "unjam"];

/// Kernels whose lanes are different agents, y: what they do with a vertex, x, is the same for all.
const ALONG_Y: [&str; 1] = ["skin"];
/// What these read of each agent for one vertex after another.
const KEPT: [(&str, Elements); 2] =
    [("palettes", Elements::Constant("PALETTE_STRIDE")), ("expressions", Elements::One)];

/// How many elements of a buffer an agent has.
enum Elements {
    One,
    /// As a constant of the shader says.
    Constant(&'static str),
}

impl Elements {
    fn number(&self, module: &naga::Module) -> Option<u32> {
        let Self::Constant(name) = self else { return Some(1) };
        let (_, constant) = module.constants.iter().find(|(_, one)| one.name.as_deref() == Some(name))?;
        match module.global_expressions[constant.init] {
            Expression::Literal(Literal::U32(number)) => Some(number),
            _ => None,
        }
    }
}

fn main() -> ExitCode {
    println!("cargo::rerun-if-changed={SHADERS}");
    match generate() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("cargo::error={error}");
            ExitCode::FAILURE
        }
    }
}

fn generate() -> Result<(), String> {
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let architecture =
        std::env::var("CARGO_CFG_TARGET_ARCH").map_err(|e| format!("CARGO_CFG_TARGET_ARCH: {e}"))?;
    let sets = Isa::of(&architecture);
    let listing = std::fs::read_dir(SHADERS).map_err(|e| format!("{SHADERS}: {e}"))?;
    let mut files: Vec<PathBuf> = listing.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|extension| extension == "wgsl"));
    files.sort();
    let mut lists = Lists::default();
    for (number, file) in files.iter().enumerate() {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        if TWIN_IS_FASTER.contains(&name.as_ref()) {
            let _ = writeln!(lists.left, "    ({name:?}, \"its twin is faster\"),");
            continue;
        }
        let source =
            Source::read(file, &Path::new(SHADERS).join("shared"), number).map_err(|e| e.to_string())?;
        write(&out, &source, &name, sets, &mut lists)?;
    }
    let Lists { modules, table, left } = lists;
    let text = format!(
        "{modules}\n/// All phases that lanes run.\npub static KERNELS: &[Kernel] = &[\n{table}];\n\n\
         /// Those that they do not run, and why.\npub static LEFT_OUT: &[(&str, &str)] = &[\n{left}];\n"
    );
    std::fs::write(out.join("kernels.rs"), text).map_err(|e| format!("{}: {e}", out.display()))
}

/// What the crate has of all files.
#[derive(Default)]
struct Lists {
    modules: String,
    /// Kernels.
    table: String,
    /// Those that lanes do not run.
    left: String,
}

/// Writes the entry points of a file in all sets.
fn write(out: &Path, source: &Source, file: &str, sets: &[Isa], lists: &mut Lists) -> Result<(), String> {
    let module = naga::front::wgsl::parse_str(source.text()).map_err(|e| format!("{}: {e}", source.name))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES);
    let info = validator.validate(&module).map_err(|e| format!("{}: {e}", source.name))?;
    let axis = if ALONG_Y.contains(&file) { Axis::Y } else { Axis::X };
    let kept: Vec<(&str, u32)> = match axis {
        Axis::X => Vec::new(),
        Axis::Y => {
            KEPT.iter().filter_map(|(name, elements)| Some((*name, elements.number(&module)?))).collect()
        }
    };
    let mut all = Vec::new();
    let mut inner = String::new();
    for isa in sets {
        let written = kernels(&module, &info, *isa, Options { arrays: Arrays::Unset, axis, kept: &kept });
        let (set, path) = (isa.name(), out.join(format!("{file}.{}.rs", isa.name())));
        std::fs::write(&path, &written.text).map_err(|e| format!("{}: {e}", path.display()))?;
        let _ = writeln!(inner, "    pub mod {set} {{ include!({:?}); }}", path.display().to_string());
        all = written.kernels; // alike in all sets
    }
    let _ = write!(lists.modules, "mod {file} {{\n{inner}}}\n");
    for (kernel, entry) in all.iter().zip(&module.entry_points) {
        let kernel = match kernel {
            Ok(kernel) => kernel,
            Err(why) => {
                let _ = writeln!(lists.left, "    ({:?}, {:?}),", entry.name, why.to_string());
                continue;
            }
        };
        let runs: String = sets
            .iter()
            .map(|isa| format!("(Isa::{isa:?}, {file}::{}::run_{} as Run), ", isa.name(), kernel.name))
            .collect();
        let names: String = kernel
            .bindings
            .iter()
            .map(|binding| {
                format!("Binding {{ name: {:?}, is_written: {} }}, ", binding.name, binding.is_written)
            })
            .collect();
        let _ = writeln!(
            lists.table,
            "    Kernel {{ name: {:?}, axis: Axis::{axis:?}, bindings: &[{names}], runs: &[{runs}] }},",
            kernel.name
        );
    }
    Ok(())
}
