//! Python binding: converts arguments, releases the interpreter lock, maps errors. No arithmetic here.

#![allow(clippy::needless_pass_by_value, reason = "the shapes that PyO3 hands over")]

mod arrays;
mod basis;
mod bsdf;
mod compare;
mod convert;
mod errors;
mod glare;
mod interpolant;
mod jobs;
mod model;
mod npz;
mod picture;
mod room;
mod room_matrix;
mod room_scene;
mod sky;
mod system;
mod table;
mod trace;
mod trace_material;
mod trace_measure;
mod trace_scene;
mod tree;
mod xml;

use pyo3::prelude::*;

/// Clerestory's compiled core; use it through the `clerestory` package.
#[pymodule]
mod _core {
    use pyo3::prelude::*;

    #[pymodule_export]
    use crate::basis::PyBasis;
    #[pymodule_export]
    use crate::bsdf::PyBsdf;
    #[pymodule_export]
    use crate::compare::distances;
    #[pymodule_export]
    use crate::glare::{PyLens, glare_preset, rate_glare, rate_glare_hours};
    #[pymodule_export]
    use crate::interpolant::PyDistributions;
    #[pymodule_export]
    use crate::model::PyModel;
    #[pymodule_export]
    use crate::picture::{PyPicture, PyView};
    #[pymodule_export]
    use crate::room::{PyRoom, PyRoomPicture, PyRoomShapes};
    #[pymodule_export]
    use crate::room_matrix::{PyWindowGroups, square_cells, square_directions};
    #[pymodule_export]
    use crate::room_scene::read_room_scene;
    #[pymodule_export]
    use crate::sky::{PySky, PySkyPatches, cie_names, gensky_factor, sun_by_radiance};
    #[pymodule_export]
    use crate::system::PySystem;
    #[pymodule_export]
    use crate::table::{gunzip, read_table, write_table};
    #[pymodule_export]
    use crate::trace::{PyGeometry, PySample};
    #[pymodule_export]
    use crate::trace_measure::PyTraceState;
    #[pymodule_export]
    use crate::trace_scene::PyScene;

    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        crate::errors::register(module)?;
        module.add("__version__", env!("CARGO_PKG_VERSION"))
    }
}
