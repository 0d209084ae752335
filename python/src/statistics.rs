//! The tests of the paper's studies: `gaitway.statistics`.

use crate::error::{Fault, Result};
use gaitway::low_level::statistics::{Adjustment, adjust, describe, friedman, icc, wilcoxon};
use numpy::{PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;
use serde::Serialize;

/// A result as JSON, which Python makes a dictionary of.
fn json(result: &impl Serialize) -> Result<String> {
    serde_json::to_string(result).map_err(|error| Fault::failed(error.to_string(), "please report this"))
}

fn rows(table: &PyReadonlyArray2<'_, f64>) -> Vec<Vec<f64>> {
    table.as_array().outer_iter().map(|row| row.to_vec()).collect()
}

#[pyfunction]
#[pyo3(name = "friedman")]
fn friedman_test(py: Python<'_>, answers: PyReadonlyArray2<'_, f64>) -> PyResult<(String, f64)> {
    let rows = rows(&answers);
    let found =
        py.detach(|| -> Result<_> { Ok((json(&friedman::friedman(&rows)?)?, friedman::exact_p(&rows)?)) });
    Ok(found?)
}

#[pyfunction]
#[pyo3(name = "wilcoxon")]
fn wilcoxon_test(py: Python<'_>, differences: PyReadonlyArray1<'_, f64>) -> PyResult<String> {
    let differences = differences.as_array().to_vec();
    let options = wilcoxon::Options::default();
    Ok(py.detach(|| -> Result<_> { json(&wilcoxon::wilcoxon(&differences, options)?) })?)
}

#[pyfunction]
#[pyo3(name = "icc")]
fn icc_models(py: Python<'_>, ratings: PyReadonlyArray2<'_, f64>, level: f64) -> PyResult<String> {
    let rows = rows(&ratings);
    Ok(py.detach(|| -> Result<_> { json(&icc::icc(&rows, level)?) })?)
}

#[pyfunction]
#[pyo3(name = "describe")]
fn describe_sample(values: PyReadonlyArray1<'_, f64>) -> PyResult<String> {
    let described = describe(&values.as_array().to_vec()).map_err(Fault::from)?;
    Ok(json(&described)?)
}

#[pyfunction]
#[pyo3(name = "adjust")]
fn adjust_p(p: PyReadonlyArray1<'_, f64>, method: &str) -> PyResult<Vec<f64>> {
    let adjustment = match method {
        "bonferroni" => Adjustment::Bonferroni,
        "holm" => Adjustment::Holm,
        "benjamini-hochberg" => Adjustment::BenjaminiHochberg,
        _ => {
            let message = format!("method = {method:?}: must be bonferroni, holm or benjamini-hochberg");
            return Err(Fault::value(message, "use method=\"holm\"").into());
        }
    };
    Ok(adjust(&p.as_array().to_vec(), adjustment).map_err(Fault::from)?)
}

/// Adds the functions to the module.
pub(crate) fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add_function(wrap_pyfunction!(friedman_test, module)?)?;
    module.add_function(wrap_pyfunction!(wilcoxon_test, module)?)?;
    module.add_function(wrap_pyfunction!(icc_models, module)?)?;
    module.add_function(wrap_pyfunction!(describe_sample, module)?)?;
    module.add_function(wrap_pyfunction!(adjust_p, module)?)
}
