//! The class `Perceiver`: what people would see in a gait.

use crate::error::Result;
use crate::fork::on_threads;
use crate::gaits::Gaits;
use crate::table::Table;
use arrow_array::{ArrayRef, BooleanArray, Float64Array, StringArray};
use gaitway::Emotion;
use gaitway::gait::Gait;
use gaitway::perception::model::{Model, Prediction};
use pyo3::prelude::*;
use std::path::PathBuf;
use std::sync::Arc;

/// A trained classifier; `gaitway.Perceiver` stands on it.
#[pyclass(frozen, subclass, module = "gaitway._gaitway")]
#[derive(Debug)]
pub(crate) struct Perceiver {
    model: Model,
}

#[pymethods]
impl Perceiver {
    /// The model of a file, or the one that ships.
    #[new]
    #[pyo3(signature = (path))]
    fn new(py: Python<'_>, path: Option<PathBuf>) -> PyResult<Self> {
        let load = || -> Result<Model> {
            Ok(match path {
                Some(path) => Model::load(&path)?,
                None => Model::built_in()?,
            })
        };
        Ok(Self { model: py.detach(load)? })
    }

    /// The method, what it learned from, how well that went.
    #[getter]
    fn description(&self) -> String {
        self.model.describe()
    }

    /// What people would see in each gait.
    #[pyo3(name = "_judge")]
    fn judge(&self, py: Python<'_>, gaits: &Gaits) -> PyResult<Table> {
        let all: Vec<&Gait> = gaits.gaits().iter().collect();
        let found = py.detach(|| {
            on_threads(|| {
                all.iter().try_for_each(|gait| gait.check_whole())?;
                Ok(self.model.predict_all(&all))
            })
        })?;
        let number = |value: &dyn Fn(&Prediction) -> Option<f64>| -> ArrayRef {
            Arc::new(found.iter().map(value).collect::<Float64Array>())
        };
        let seen: StringArray = found.iter().map(|seen| Some(seen.emotion.name())).collect();
        let mut columns = gaits.names();
        columns.push(("emotion", "", Arc::new(seen)));
        columns.extend(Emotion::ALL.map(|emotion| {
            (emotion.name(), "", number(&move |seen| Some(seen.probabilities[emotion.index()])))
        }));
        columns.push(("margin", "", number(&|seen| Some(seen.margin))));
        columns.push(("novelty", "", number(&|seen| seen.novelty)));
        let unlike: Vec<bool> = found.iter().map(Prediction::is_unlike).collect();
        columns.push(("unlike", "", Arc::new(BooleanArray::from(unlike))));
        Ok(Table::of_columns(columns)?)
    }
}
