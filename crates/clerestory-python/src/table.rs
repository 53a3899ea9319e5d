//! Text and packed bytes of measurements.

use clerestory::Error;
use clerestory::io::gzip;
use clerestory::io::table::{Layout, read, write};
use numpy::{IntoPyArray, PyArray1, PyReadonlyArray1};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::errors::raise;

/// Columns, lists of words, where the table ends and in which line.
type Parts<'py> = (Vec<Bound<'py, PyArray1<f64>>>, Vec<Vec<String>>, usize, usize);

/// A table of numbers.
#[pyfunction]
#[pyo3(signature = (
    data, columns=0, *, start=0, line=1, delimiter=None, words=vec![], runs=vec![], empty=false, stops=false
))]
#[allow(clippy::too_many_arguments, reason = "named in Python")]
pub fn read_table(
    py: Python<'_>,
    data: PyBackedBytes,
    columns: usize,
    start: usize,
    line: usize,
    delimiter: Option<char>,
    words: Vec<usize>,
    runs: Vec<usize>,
    empty: bool,
    stops: bool,
) -> PyResult<Parts<'_>> {
    let layout = Layout {
        columns,
        delimiter: delimiter.and_then(|c| u8::try_from(c).ok()),
        words,
        runs,
        empty,
        stops,
    };
    let table = py.detach(|| read(&data, start, line, &layout)).map_err(raise)?;
    let starts = table.starts.iter().map(|&row| row as f64).collect::<Vec<_>>();
    let starts = (!layout.runs.is_empty()).then_some(starts);
    let columns = table.columns.into_iter().chain(starts);
    let columns = columns.map(|c| c.into_pyarray(py)).collect();
    Ok((columns, table.words, table.end, table.line))
}

/// Rows of numbers as text, each behind the same words.
#[pyfunction]
#[pyo3(signature = (columns, separator, before=""))]
pub fn write_table<'py>(
    py: Python<'py>,
    columns: Vec<PyReadonlyArray1<'py, f64>>,
    separator: char,
    before: &str,
) -> PyResult<Bound<'py, PyBytes>> {
    let slices = columns.iter().map(|c| c.as_slice()).collect::<Result<Vec<_>, _>>()?;
    let text = py.detach(|| write(&slices, before, separator));
    Ok(PyBytes::new(py, &text))
}

/// What gzip data unpack to.
#[pyfunction]
pub fn gunzip(py: Python<'_>, data: PyBackedBytes) -> PyResult<Bound<'_, PyBytes>> {
    let zeros = |head: &[u8]| {
        if head.iter().any(|&c| c != 0) {
            return Ok(());
        }
        Err(Error::format(
            "gzip",
            "the file unpacks to nothing but zeros",
            "get the file again",
        ))
    };
    let bytes = py.detach(|| gzip::inflate(&data, zeros)).map_err(raise)?;
    Ok(PyBytes::new(py, &bytes))
}
