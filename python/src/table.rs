//! Tables in Arrow's memory, handed over by the `PyCapsule` protocol.

use crate::error::Fault;
use arrow_array::cast::AsArray;
use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::types::{Float32Type, Float64Type, Int8Type, UInt32Type};
use arrow_array::{Array, ArrayRef, RecordBatch, RecordBatchIterator};
use arrow_schema::ffi::FFI_ArrowSchema;
use arrow_schema::{ArrowError, DataType, Field, Schema, SchemaRef};
use glam::Vec2;
use numpy::{Element, PyArray1};
use pyo3::exceptions::PyKeyError;
use pyo3::prelude::*;
use pyo3::types::{PyCapsule, PyList};
use std::collections::HashMap;
use std::sync::Arc;

/// A table in Arrow's memory: columns of numbers and words.
///
/// pandas, polars, pyarrow and duckdb take it as it is, without a copy (`__arrow_c_stream__`). `table["name"]` gives a column as
/// a numpy array, or a list where it holds words.
#[pyclass(frozen, subclass, module = "gaitway")]
#[derive(Debug, Clone)]
pub(crate) struct Table {
    schema: SchemaRef,
    batches: Arc<[RecordBatch]>,
}

impl Table {
    pub(crate) fn new(schema: SchemaRef, batches: Vec<RecordBatch>) -> Self {
        Self { schema, batches: batches.into() }
    }

    /// A table of one batch, of columns with their names and units.
    pub(crate) fn of_columns(columns: Vec<(&str, &str, ArrayRef)>) -> Result<Self, Fault> {
        let field = |(name, unit, array): &(&str, &str, ArrayRef)| {
            column(name, unit, array.data_type().clone()).with_nullable(array.null_count() > 0)
        };
        let schema = Arc::new(Schema::new(columns.iter().map(field).collect::<Vec<_>>()));
        let arrays = columns.into_iter().map(|(_, _, array)| array).collect();
        let batch = RecordBatch::try_new(schema.clone(), arrays).map_err(broken)?;
        Ok(Self::new(schema, vec![batch]))
    }

    /// The places (x, z), m, of a table of trajectories.
    pub(crate) fn places(&self) -> PyResult<Vec<Vec2>> {
        let (x, z) = (self.index("x_m")?, self.index("z_m")?);
        let numbers =
            |batch: &RecordBatch, at: usize| batch.column(at).as_primitive::<Float32Type>().values().to_vec();
        let places = |batch: &RecordBatch| {
            numbers(batch, x)
                .into_iter()
                .zip(numbers(batch, z))
                .map(|(x, z)| Vec2::new(x, z))
                .collect::<Vec<_>>()
        };
        Ok(self.batches.iter().flat_map(places).collect())
    }

    fn rows(&self) -> usize {
        self.batches.iter().map(RecordBatch::num_rows).sum()
    }

    fn index(&self, name: &str) -> PyResult<usize> {
        let known =
            || self.schema.fields().iter().map(|field| field.name().as_str()).collect::<Vec<_>>().join(", ");
        self.schema
            .index_of(name)
            .map_err(|_unknown| PyKeyError::new_err(format!("{name:?}: the columns are {}", known())))
    }

    /// A column of numbers, all batches one after another.
    fn numbers<'py, T: Element + Copy>(
        &self,
        py: Python<'py>,
        at: usize,
        values: impl Fn(&ArrayRef) -> Vec<T>,
    ) -> Bound<'py, PyAny> {
        let all: Vec<T> = self.batches.iter().flat_map(|batch| values(batch.column(at))).collect();
        PyArray1::from_vec(py, all).into_any()
    }
}

/// A field with its unit, if it has one.
pub(crate) fn column(name: &str, unit: &str, kind: DataType) -> Field {
    let field = Field::new(name, kind, false);
    if unit.is_empty() {
        field
    } else {
        field.with_metadata(HashMap::from([("unit".to_owned(), unit.to_owned())]))
    }
}

/// Columns that do not fit one another: a fault of ours.
pub(crate) fn broken(error: ArrowError) -> Fault {
    Fault::failed(format!("cannot make the table: {error}"), "please report this")
}

#[pymethods]
impl Table {
    /// The same table; subclasses add to it.
    #[new]
    #[pyo3(signature = (table, *_more, **_names))]
    fn same(
        table: PyRef<'_, Self>,
        _more: &Bound<'_, pyo3::types::PyTuple>,
        _names: Option<&Bound<'_, pyo3::types::PyDict>>,
    ) -> Self {
        table.clone()
    }

    /// The table as an Arrow stream (`PyCapsule` protocol). A wish for another schema is not granted, as the protocol allows.
    #[pyo3(signature = (requested_schema=None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        drop(requested_schema);
        let batches: Vec<Result<RecordBatch, ArrowError>> = self.batches.iter().cloned().map(Ok).collect();
        let reader = RecordBatchIterator::new(batches, self.schema.clone());
        PyCapsule::new_with_value(py, FFI_ArrowArrayStream::new(Box::new(reader)), c"arrow_array_stream")
    }

    /// The columns and their types as an Arrow schema (`PyCapsule` protocol).
    fn __arrow_c_schema__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyCapsule>> {
        let schema = FFI_ArrowSchema::try_from(self.schema.as_ref()).map_err(broken)?;
        PyCapsule::new_with_value(py, schema, c"arrow_schema")
    }

    /// Number of rows.
    fn __len__(&self) -> usize {
        self.rows()
    }

    /// Names of the columns, in order.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.schema.fields().iter().map(|field| field.name().clone()).collect()
    }

    /// Unit of each column that has one, such as `m/s`.
    #[getter]
    fn units(&self) -> HashMap<String, String> {
        let unit = |field: &Arc<Field>| Some((field.name().clone(), field.metadata().get("unit")?.clone()));
        self.schema.fields().iter().filter_map(unit).collect()
    }

    /// A column: a numpy array `(rows,)`, NaN where there is no number, or a list of words and `None`.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        let at = self.index(name)?;
        Ok(match self.schema.field(at).data_type() {
            DataType::UInt32 if self.schema.field(at).is_nullable() => self.numbers(py, at, |array| {
                let numbers = array.as_primitive::<UInt32Type>().iter();
                numbers.map(|number| number.map_or(f64::NAN, f64::from)).collect()
            }),
            DataType::UInt32 => {
                self.numbers(py, at, |array| array.as_primitive::<UInt32Type>().values().to_vec())
            }
            DataType::Float32 => self.numbers(py, at, |array| {
                array.as_primitive::<Float32Type>().iter().map(|value| value.unwrap_or(f32::NAN)).collect()
            }),
            DataType::Float64 => self.numbers(py, at, |array| {
                array.as_primitive::<Float64Type>().iter().map(|value| value.unwrap_or(f64::NAN)).collect()
            }),
            DataType::Boolean => self.numbers(py, at, |array| {
                array.as_boolean().iter().map(|value| value.unwrap_or(false)).collect()
            }),
            _ => PyList::new(py, self.batches.iter().flat_map(|batch| words(batch.column(at))))?.into_any(),
        })
    }

    fn __repr__(&self) -> String {
        format!("<gaitway.Table: {} rows; {}>", self.rows(), self.columns().join(", "))
    }
}

/// The words of a column.
fn words(array: &ArrayRef) -> Vec<Option<String>> {
    let owned = |word: Option<&str>| word.map(str::to_owned);
    if let Some(dictionary) = array.as_dictionary_opt::<Int8Type>() {
        let known = dictionary.values().as_string::<i32>();
        return dictionary.keys_iter().map(|key| key.map(|key| known.value(key).to_owned())).collect();
    }
    array.as_string_opt::<i32>().map(|array| array.iter().map(owned).collect()).unwrap_or_default()
}
