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
use source::Source;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use wgsl_lanes::Isa;
use wgsl_lanes::generate::{Kernel, kernel};

const SHADERS: &str = "../shaders";

/// Kernels whose twin is faster: it walks along rows of cells, or has next to nothing to compute.
const TWIN_IS_FASTER: [&str; 6] = ["flow", "flow_density", "idle", "lead_agents", "queue", "unjam"];

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
    let (mut modules, mut table, mut left) = (String::new(), String::new(), String::new());
    for (number, file) in files.iter().enumerate() {
        let name = file.file_stem().unwrap_or_default().to_string_lossy();
        if TWIN_IS_FASTER.contains(&name.as_ref()) {
            let _ = writeln!(left, "    ({name:?}, \"its twin is faster\"),");
            continue;
        }
        let source =
            Source::read(file, &Path::new(SHADERS).join("shared"), number).map_err(|e| e.to_string())?;
        for (entry, written) in entries(&source, sets)? {
            match written {
                Ok(kernels) => write(&out, &entry, sets, &kernels, &mut modules, &mut table)?,
                Err(why) => _ = writeln!(left, "    (\"{entry}\", {why:?}),"),
            }
        }
    }
    let text = format!(
        "{modules}\n/// All phases that lanes run.\npub static KERNELS: &[Kernel] = &[\n{table}];\n\n\
         /// Those that they do not run, and why.\npub static LEFT_OUT: &[(&str, &str)] = &[\n{left}];\n"
    );
    std::fs::write(out.join("kernels.rs"), text).map_err(|e| format!("{}: {e}", out.display()))
}

type Written = Result<Vec<Kernel>, String>;

/// The entry points of a file: each in all sets, or why not.
fn entries(source: &Source, sets: &[Isa]) -> Result<Vec<(String, Written)>, String> {
    let module = naga::front::wgsl::parse_str(source.text()).map_err(|e| format!("{}: {e}", source.name))?;
    let mut validator = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES);
    let info = validator.validate(&module).map_err(|e| format!("{}: {e}", source.name))?;
    let one = |(at, entry): (usize, &naga::EntryPoint)| {
        let written: Result<Vec<Kernel>, _> =
            sets.iter().map(|isa| kernel(&module, &info, at, *isa)).collect();
        (entry.name.clone(), written.map_err(|e| e.to_string()))
    };
    Ok(module.entry_points.iter().enumerate().map(one).collect())
}

/// Writes one entry point in all sets.
fn write(
    out: &Path,
    entry: &str,
    sets: &[Isa],
    kernels: &[Kernel],
    modules: &mut String,
    table: &mut String,
) -> Result<(), String> {
    let (mut inner, mut runs) = (String::new(), String::new());
    for (isa, kernel) in sets.iter().zip(kernels) {
        let (set, path) = (isa.name(), out.join(format!("{entry}.{}.rs", isa.name())));
        std::fs::write(&path, &kernel.text).map_err(|e| format!("{}: {e}", path.display()))?;
        let _ = writeln!(inner, "    pub mod {set} {{ include!({:?}); }}", path.display().to_string());
        let _ = write!(runs, "(Isa::{isa:?}, {entry}::{set}::run as Run), ");
    }
    let _ = write!(modules, "mod {entry} {{\n{inner}}}\n");
    let names: String = kernels[0]
        .bindings
        .iter()
        .map(|binding| {
            format!("Binding {{ name: {:?}, is_written: {} }}, ", binding.name, binding.is_written)
        })
        .collect();
    let _ = writeln!(table, "    Kernel {{ name: {entry:?}, bindings: &[{names}], runs: &[{runs}] }},");
    Ok(())
}
