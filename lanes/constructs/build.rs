//! Writes each shader of `wgsl/` as Rust, once for each set of instructions.
#![allow(clippy::print_stdout, reason = "cargo reads a build script's standard output")]

use naga::valid::{Capabilities, ValidationFlags, Validator};
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use wgsl_lanes::Isa;
use wgsl_lanes::generate::{Arrays, Axis, Options, kernels};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=wgsl");
    let out = PathBuf::from(std::env::var_os("OUT_DIR").ok_or("OUT_DIR is not set")?);
    let architecture = std::env::var("CARGO_CFG_TARGET_ARCH")?;
    let mut all = String::new();
    for entry in std::fs::read_dir("wgsl")? {
        let file = entry?.path();
        let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        let module = naga::front::wgsl::parse_str(&std::fs::read_to_string(&file)?)?;
        let info = Validator::new(ValidationFlags::all(), Capabilities::IMMEDIATES).validate(&module)?;
        let arrays = if name == "unset" { Arrays::Unset } else { Arrays::Set };
        let axis = if name == "across" || name == "kept" { Axis::Y } else { Axis::X };
        let mut runs = vec![String::new(); module.entry_points.len()];
        for isa in Isa::of(&architecture) {
            let set = isa.name();
            let written = kernels(&module, &info, *isa, Options { arrays, axis, kept: &[("own", 5)] });
            std::fs::write(out.join(format!("{name}.{set}.rs")), written.text)?;
            let path = Path::new(&out).join(format!("{name}.{set}.rs"));
            let _ = writeln!(all, "mod {name}_{set} {{ include!({:?}); }}", path.display().to_string());
            for (runs, kernel) in runs.iter_mut().zip(written.kernels) {
                let _ = write!(runs, "(Isa::{isa:?}, {name}_{set}::run_{} as Run), ", kernel?.name);
            }
        }
        for (runs, entry) in runs.iter().zip(&module.entry_points) {
            let entry = if entry.name == "main" { &name } else { &entry.name };
            let _ = writeln!(
                all,
                "/// Of `wgsl/{name}.wgsl`.\npub const {}: Runs = &[{runs}];",
                entry.to_uppercase()
            );
        }
    }
    std::fs::write(out.join("constructs.rs"), all)?;
    Ok(())
}
