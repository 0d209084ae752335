//! The program `gaitway`, inside the wheel.

use pyo3::prelude::*;
use std::ffi::OsString;

/// Does what a command line says and returns the exit code; the first word is the program's name.
#[pyfunction]
pub(crate) fn main(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| gaitway::cli::run_with(words))
}
