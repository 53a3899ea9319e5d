//! Tensor trees: making, reducing and describing them.

use clerestory::bsdf::tree::Reduction;
use clerestory::bsdf::{Model, Rank, Tree};
use numpy::PyReadonlyArray1;
use pyo3::prelude::*;

use crate::errors::{ClerestoryError, UnsupportedError, raise};
use crate::model::PyModel;

/// RMS error, worst direct-hemispherical difference, leaves before and after.
type ReductionRow = (f64, f64, usize, usize);

fn rank(axes: u32) -> PyResult<Rank> {
    [Rank::Isotropic, Rank::Anisotropic]
        .into_iter()
        .find(|r| r.axes() == axes)
        .ok_or_else(|| {
            ClerestoryError::new_err(format!(
                "an array of {axes} axes does not make a tensor tree (give 3 for isotropic, 4 for anisotropic)"
            ))
        })
}

impl PyModel {
    fn tree(&self) -> PyResult<&Tree> {
        match &*self.0 {
            Model::Tree(tree) => Ok(tree),
            other => Err(UnsupportedError::new_err(format!(
                "a {} model is not a tensor tree (convert it to one first)",
                other.kind()
            ))),
        }
    }
}

#[pymethods]
impl PyModel {
    /// From values of 2^levels cells an axis, axis 0 slowest.
    #[staticmethod]
    fn tree_from_grid(py: Python<'_>, axes: u32, levels: u32, values: PyReadonlyArray1<'_, f32>) -> PyResult<Self> {
        let (rank, values) = (rank(axes)?, values.as_slice()?);
        py.detach(|| Tree::from_grid(rank, levels, values))
            .map(|tree| Self::of(Model::Tree(tree)))
            .map_err(raise)
    }

    /// Rank, depth and number of values.
    fn tree_shape(&self) -> PyResult<(u32, u32, usize)> {
        let tree = self.tree()?;
        Ok((tree.rank().axes(), tree.depth(), tree.leaves()))
    }

    /// By a percentage of the finest blocks.
    fn reduced_by_percent(&self, py: Python<'_>, percent: f64) -> PyResult<(Self, ReductionRow)> {
        let tree = self.tree()?;
        py.detach(|| tree.reduced_by_percent(percent)).map(row).map_err(raise)
    }

    /// By a bound on the RMS error.
    fn reduced_by_error(&self, py: Python<'_>, bound: f64) -> PyResult<(Self, ReductionRow)> {
        let tree = self.tree()?;
        py.detach(|| tree.reduced_by_error(bound)).map(row).map_err(raise)
    }
}

fn row(r: Reduction) -> (PyModel, ReductionRow) {
    (
        PyModel::of(Model::Tree(r.tree)),
        (
            r.rms_error,
            r.worst_direct_hemispherical,
            r.leaves_before,
            r.leaves_after,
        ),
    )
}
