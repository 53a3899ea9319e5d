//! Arrays of directions and words of the API.

use clerestory::direction::{Direction, Scatter, Side};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;
use rayon::prelude::*;

use crate::errors::{ClerestoryError, raise};

/// Rows of an (n, 3) array as directions.
pub fn directions(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<Direction>> {
    table::<3>(array, what, "x, y, z")?
        .par_iter()
        .with_min_len(4096)
        .map(|&[x, y, z]| Direction::new(x, y, z))
        .collect::<Result<_, _>>()
        .map_err(raise)
}

/// Rows of an (n, 2) array.
pub fn pairs(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<[f64; 2]>> {
    Ok(table::<2>(array, what, "two numbers")?.to_vec())
}

/// Rows of an array of N columns, which lie one behind the other.
pub fn table<'a, const N: usize>(
    array: &'a PyReadonlyArray2<'_, f64>,
    what: &str,
    columns: &str,
) -> PyResult<&'a [[f64; N]]> {
    if array.shape()[1] != N {
        return Err(ClerestoryError::new_err(format!(
            "{what}: an array of {} columns does not fit (give {columns} a row)",
            array.shape()[1]
        )));
    }
    Ok(array.as_slice()?.as_chunks().0)
}

/// An array of `width` columns from the numbers of its rows.
pub fn rows(py: Python<'_>, values: Vec<f64>, width: usize) -> PyResult<Bound<'_, PyArray2<f64>>> {
    let count = values.len() / width.max(1);
    PyArray1::from_vec(py, values).reshape([count, width])
}

/// Checks that two arrays of rows go together.
pub fn same_length(a: usize, b: usize) -> PyResult<()> {
    if a == b {
        return Ok(());
    }
    Err(ClerestoryError::new_err(format!(
        "{a} incident directions do not go with {b} of the other array (give arrays of equal length)"
    )))
}

/// `exterior` or `interior`.
pub fn side(name: &str) -> PyResult<Side> {
    Side::BOTH
        .into_iter()
        .find(|s| s.name() == name)
        .ok_or_else(|| ClerestoryError::new_err(format!("side {name:?} is not known (give exterior or interior)")))
}

/// `transmission` or `reflection`.
pub fn scatter(name: &str) -> PyResult<Scatter> {
    Scatter::BOTH
        .into_iter()
        .find(|s| s.name() == name)
        .ok_or_else(|| ClerestoryError::new_err(format!("{name:?} is not known (give transmission or reflection)")))
}
