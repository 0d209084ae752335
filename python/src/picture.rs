//! Pictures as files in memory.

use crate::error::Fault;
use gaitway::picture::Image;
use numpy::PyReadonlyArray3;
use pyo3::prelude::*;
use pyo3::types::PyBytes;

/// A picture `(height, width, 4)` of uint8 as PNG.
#[pyfunction]
pub(crate) fn png<'py>(py: Python<'py>, pixels: PyReadonlyArray3<'py, u8>) -> PyResult<Bound<'py, PyBytes>> {
    let view = pixels.as_array();
    let wrong = |_| Fault::value("a picture is larger than 2^32 pixels a side", "draw a smaller one");
    let [height, width] = [view.shape()[0], view.shape()[1]].map(|side| u32::try_from(side).map_err(wrong));
    let image = Image { width: width?, height: height?, pixels: view.iter().copied().collect() };
    let bytes = py.detach(|| gaitway::export::image::png(&image));
    Ok(PyBytes::new(py, &bytes.map_err(gaitway::export::Error::from).map_err(Fault::from)?))
}
