//! The class `Gaits`: walk cycles, from libraries and motion files, and their features.

use crate::error::{Fault, Result};
use crate::fork::on_threads;
use crate::table::Table;
use arrow_array::{ArrayRef, Float64Array, StringArray};
use gaitway::gait::{Gait, JOINT_COUNT, Joint, import, stride};
use gaitway::perception::features::{FEATURES, Variant, features_of};
use gaitway::{Emotion, GaitLibrary};
use glam::Vec3;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyIndexError;
use pyo3::prelude::*;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Gaits, each one walk cycle of 16 joints; `gaitway.gaits` makes them.
#[pyclass(frozen, subclass, module = "gaitway._gaitway")]
#[derive(Debug, Clone)]
pub(crate) struct Gaits {
    pub(crate) library: GaitLibrary,
}

impl Gaits {
    pub(crate) fn gaits(&self) -> &[Gait] {
        self.library.gaits()
    }

    fn gait(&self, at: usize) -> PyResult<&Gait> {
        let count = self.gaits().len();
        self.gaits().get(at).ok_or_else(|| PyIndexError::new_err(format!("gait {at} of {count}")))
    }

    /// The columns by which tables name gaits: `gait`, `label`.
    pub(crate) fn names(&self) -> Vec<(&'static str, &'static str, ArrayRef)> {
        let names: StringArray = self.gaits().iter().map(|gait| Some(gait.name.as_str())).collect();
        let labels: StringArray = self.gaits().iter().map(|gait| gait.label.map(Emotion::name)).collect();
        vec![("gait", "", Arc::new(names)), ("label", "", Arc::new(labels))]
    }
}

/// The gaits of one file: all of a library, or the steadiest stride of each take of a motion file.
fn of_file(path: &Path) -> Result<Vec<Gait>> {
    if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("glb")) {
        return Ok(GaitLibrary::load_glb(path)?.gaits().to_vec());
    }
    let takes = import::import_file(path)?;
    Ok(takes.iter().map(stride::best).collect::<std::result::Result<_, _>>()?)
}

#[pymethods]
impl Gaits {
    /// The same gaits; the subclass names what they can do.
    #[new]
    fn same(gaits: PyRef<'_, Self>) -> Self {
        gaits.clone()
    }

    /// The gaits of files and of folders that are searched for them.
    #[staticmethod]
    fn load(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<Self> {
        let load = || -> Result<GaitLibrary> {
            let (libraries, motion): (Vec<PathBuf>, Vec<PathBuf>) =
                paths.into_iter().partition(|path| path.extension().is_some_and(|ending| ending == "glb"));
            let motion = if motion.is_empty() { motion } else { import::folder::motion_files(&motion)? };
            let mut gaits = Vec::new();
            for path in libraries.iter().chain(&motion) {
                gaits.extend(of_file(path)?);
            }
            Ok(GaitLibrary::from_gaits(gaits)?)
        };
        Ok(Self { library: py.detach(|| on_threads(load))? })
    }

    /// The built-in people, who show their emotions as strongly as `expression` says; `None`: as crowds do.
    #[staticmethod]
    fn built_in(py: Python<'_>, expression: Option<f64>) -> PyResult<Self> {
        let made = || -> Result<GaitLibrary> {
            Ok(match expression {
                None => GaitLibrary::built_in()?,
                Some(expression) => GaitLibrary::expressed(expression)?,
            })
        };
        Ok(Self { library: py.detach(|| on_threads(made))? })
    }

    /// Writes them as a library, a GLB that any glTF viewer plays.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        Ok(py.detach(|| self.library.save_glb(path)).map_err(Fault::from)?)
    }

    fn __len__(&self) -> usize {
        self.gaits().len()
    }

    /// Name, label, speed (m/s) and frame rate (Hz) of a gait.
    #[pyo3(name = "_facts")]
    fn facts(&self, at: usize) -> PyResult<(String, Option<&'static str>, f64, f64)> {
        let gait = self.gait(at)?;
        let (speed, rate) = (f64::from(gait.speed), f64::from(gait.frame_rate));
        Ok((gait.name.clone(), gait.label.map(Emotion::name), speed, rate))
    }

    /// Positions of the joints of a gait, m: `(frames, 16, 3)`.
    #[pyo3(name = "_poses")]
    fn poses<'py>(&self, py: Python<'py>, at: usize) -> PyResult<Bound<'py, PyAny>> {
        let poses = &self.gait(at)?.poses;
        let flat: Vec<f32> = poses.iter().flatten().flat_map(Vec3::to_array).collect();
        Ok(PyArray1::from_vec(py, flat).reshape([poses.len(), JOINT_COUNT, 3])?.into_any())
    }

    /// The 29 features of each gait.
    #[pyo3(name = "_feature_table")]
    fn feature_table(&self, py: Python<'_>, variant: &str) -> PyResult<Table> {
        let variant: Variant = variant.parse().map_err(|error: gaitway::error::UnknownName| {
            Fault::value(error.to_string(), "use variant=\"corrected\"")
        })?;
        let gaits: Vec<&Gait> = self.gaits().iter().collect();
        let found = py.detach(|| {
            on_threads(|| {
                gaits.iter().try_for_each(|gait| gait.check_whole())?;
                Ok(features_of(&gaits, variant))
            })
        })?;
        let mut columns = self.names();
        columns.extend(FEATURES.iter().enumerate().map(|(index, feature)| {
            let numbers: Float64Array = found.iter().map(|row| Some(row[index])).collect();
            let unit = if variant == Variant::StepCode { "" } else { feature.unit };
            (feature.name, unit, Arc::new(numbers) as ArrayRef)
        }));
        Ok(Table::of_columns(columns)?)
    }

    /// Names of the 16 joints, in the order of `poses`.
    #[staticmethod]
    fn joints() -> Vec<&'static str> {
        Joint::ALL.into_iter().map(Joint::name).collect()
    }
}
