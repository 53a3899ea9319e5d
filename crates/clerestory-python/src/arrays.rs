//! Arrays of directions and words of the API.

use clerestory::direction::{Direction, Scatter, Side};
use numpy::{PyReadonlyArray2, PyUntypedArrayMethods};
use pyo3::prelude::*;

use crate::errors::ClerestoryError;

/// Rows of an (n, 3) array as directions.
pub fn directions(array: &PyReadonlyArray2<'_, f64>, what: &str) -> PyResult<Vec<Direction>> {
    let [_, width] = array.shape() else {
        unreachable!("two dimensions")
    };
    if *width != 3 {
        return Err(ClerestoryError::new_err(format!(
            "{what}: an array of {width} columns is not one of directions (give x, y, z)"
        )));
    }
    array
        .as_array()
        .rows()
        .into_iter()
        .map(|row| Direction::new(row[0], row[1], row[2]).map_err(crate::errors::raise))
        .collect()
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
