//! Errors of the core as Python exceptions.

use clerestory::Error;
use pyo3::create_exception;
use pyo3::exceptions::{PyKeyboardInterrupt, PyOSError, PyValueError};
use pyo3::prelude::*;

create_exception!(
    clerestory,
    ClerestoryError,
    PyValueError,
    "Anything that Clerestory cannot do with what it was given."
);
create_exception!(
    clerestory,
    FileFormatError,
    ClerestoryError,
    "A file's content is not what its format asks for."
);
create_exception!(
    clerestory,
    MissingDataError,
    ClerestoryError,
    "The data set does not hold what was asked for."
);
create_exception!(
    clerestory,
    UnsupportedError,
    ClerestoryError,
    "The operation is not defined for this kind of model."
);

/// Puts the exceptions into the module.
pub fn register(module: &Bound<'_, PyModule>) -> PyResult<()> {
    let py = module.py();
    module.add("ClerestoryError", py.get_type::<ClerestoryError>())?;
    module.add("FileFormatError", py.get_type::<FileFormatError>())?;
    module.add("MissingDataError", py.get_type::<MissingDataError>())?;
    module.add("UnsupportedError", py.get_type::<UnsupportedError>())
}

/// The exception for an error of the core.
#[allow(clippy::needless_pass_by_value, reason = "the shape that map_err asks for")]
pub fn raise(error: Error) -> PyErr {
    let text = error.to_string();
    match error {
        Error::Format { .. } => FileFormatError::new_err(text),
        Error::Missing(_) => MissingDataError::new_err(text),
        Error::Unsupported(_) => UnsupportedError::new_err(text),
        Error::Argument(_) => ClerestoryError::new_err(text),
        Error::Io(_) => PyOSError::new_err(text),
        Error::Interrupted => PyKeyboardInterrupt::new_err(text),
    }
}
