//! `gaitway._gaitway`: the library as a module for Python. What users import is `python/gaitway`, which stands on this.
//!
//! One file a subject. A [`simulation::Simulation`] is a [`crowd::Crowd`] behind a lock, so that a step can let other Python threads
//! run. Numbers go out as views ([`views`]) and as Arrow tables ([`table`]).
#![allow(clippy::needless_pass_by_value, reason = "what Python gives is passed by value")]

mod choices;
mod command;
mod crowd;
mod error;
mod fork;
mod gaits;
mod perceive;
mod picture;
mod recorder;
mod simulation;
mod statistics;
mod study;
mod table;
mod views;

use pyo3::prelude::*;

/// The Rust half of the package.
#[pymodule]
fn _gaitway(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_class::<simulation::Simulation>()?;
    module.add_class::<table::Table>()?;
    module.add_class::<gaits::Gaits>()?;
    module.add_class::<perceive::Perceiver>()?;
    module.add_function(wrap_pyfunction!(command::main, module)?)?;
    module.add_function(wrap_pyfunction!(picture::png, module)?)?;
    module.add_function(wrap_pyfunction!(choices::scenes, module)?)?;
    module.add_function(wrap_pyfunction!(choices::scenario_schema, module)?)?;
    module.add_function(wrap_pyfunction!(study::study_tables, module)?)?;
    statistics::register(module)
}
