//! What the test programs share: the device, data of others, and the program itself.
#![allow(dead_code, reason = "shared by many test programs, of which few need all of it")]

pub(crate) mod built;
#[cfg(feature = "import")]
pub(crate) mod glb;
pub(crate) mod gpu;
pub(crate) mod lab;
#[cfg(all(feature = "import", feature = "vulkan"))]
pub(crate) mod street;
#[cfg(all(feature = "import", feature = "vulkan"))]
pub(crate) mod textured;

use std::path::{Path, PathBuf};
use std::process::Command;

/// The root of the repository.
pub(crate) fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folder of a data set, under `GAITWAY_DATA` or `../shared/data`. Where there is none, a line says so.
pub(crate) fn data_set(name: &str) -> Option<PathBuf> {
    let beside = || repository().join("../shared/data");
    let folder = std::env::var_os("GAITWAY_DATA").map_or_else(beside, PathBuf::from).join(name);
    if !folder.is_dir() {
        println!("skipped: no {name} beside the repository or in GAITWAY_DATA");
        return None;
    }
    Some(folder)
}

/// `gaitway`, not yet started: through the program that `GAITWAY_TEST_RUNNER` or `GAITWAY_RUNNER` names, if any.
pub(crate) fn program() -> Command {
    let program = env!("CARGO_BIN_EXE_gaitway");
    let runner = ["GAITWAY_TEST_RUNNER", "GAITWAY_RUNNER"].into_iter().find_map(std::env::var_os);
    let Some(runner) = runner else { return Command::new(program) };
    let mut command = Command::new(runner);
    command.arg(program);
    command
}

/// The Python of `GAITWAY_PEDPY` with a script of this folder. Where there is none, a line says so.
pub(crate) fn pedpy(script: &str) -> Option<Command> {
    let Some(python) = std::env::var_os("GAITWAY_PEDPY") else {
        println!("skipped: set GAITWAY_PEDPY to a python that has pedpy");
        return None;
    };
    let mut command = Command::new(python);
    command.arg(repository().join("tests/common").join(script));
    Some(command)
}
