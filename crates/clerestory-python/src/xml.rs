//! BSDF XML and the metadata that it carries.

use clerestory::bsdf::{Element, Metadata};
use clerestory::io::gzip::deflate;
use clerestory::io::xml::fields::{FIELDS, Field, Kind};
use clerestory::io::xml::{Hints, Target, read, write};
use pyo3::prelude::*;
use pyo3::pybacked::PyBackedBytes;
use pyo3::types::PyBytes;

use crate::arrays::{scatter, side};
use crate::basis::PyBasis;
use crate::bsdf::PyBsdf;
use crate::errors::raise;

/// Name, attributes, text and children.
#[derive(IntoPyObject, FromPyObject)]
pub struct ElementParts(String, Vec<(String, String)>, String, Vec<ElementParts>);

impl From<&Element> for ElementParts {
    fn from(e: &Element) -> Self {
        Self(
            e.name.clone(),
            e.attributes.clone(),
            e.text.clone(),
            e.children.iter().map(Self::from).collect(),
        )
    }
}

impl From<ElementParts> for Element {
    fn from(p: ElementParts) -> Self {
        Self {
            name: p.0,
            attributes: p.1,
            text: p.2,
            children: p.3.into_iter().map(Self::from).collect(),
        }
    }
}

/// Element type, material, geometry, comments, other elements by the path of their parent.
type MetadataParts = (
    Option<String>,
    Option<ElementParts>,
    Option<ElementParts>,
    Vec<String>,
    Vec<(String, ElementParts)>,
);

/// A field's value.
#[derive(IntoPyObject, FromPyObject)]
pub enum Value {
    /// A number.
    Number(f64),
    /// Words.
    Text(String),
}

#[pymethods]
impl PyBsdf {
    #[staticmethod]
    #[pyo3(signature = (data, side_name=None, scatter_name=None, basis=None, band=None))]
    fn from_xml(
        py: Python<'_>,
        data: PyBackedBytes,
        side_name: Option<&str>,
        scatter_name: Option<&str>,
        basis: Option<&PyBasis>,
        band: Option<String>,
    ) -> PyResult<Self> {
        let hints = Hints {
            side: side_name.map(side).transpose()?,
            scatter: scatter_name.map(scatter).transpose()?,
            basis: basis.map(|b| b.0.clone()),
            band,
        };
        py.detach(|| read(&data, &hints)).map(Self).map_err(raise)
    }

    /// The file for a program, and notes on what it could not take.
    fn to_xml<'py>(&self, py: Python<'py>, target: &str, gzip: bool) -> PyResult<(Bound<'py, PyBytes>, Vec<String>)> {
        let (bytes, notes) = py
            .detach(|| {
                let (bytes, notes) = write(&self.0, Target::named(target)?)?;
                Ok((if gzip { deflate(&bytes) } else { bytes }, notes))
            })
            .map_err(raise)?;
        Ok((PyBytes::new(py, &bytes), notes))
    }

    /// All metadata.
    fn metadata_parts(&self) -> MetadataParts {
        let m = &self.0.metadata;
        (
            m.element_type.clone(),
            m.material.as_ref().map(Into::into),
            m.geometry.as_ref().map(Into::into),
            m.comments.clone(),
            m.other.iter().map(|(path, e)| (path.clone(), e.into())).collect(),
        )
    }

    /// The same models with other metadata.
    fn with_metadata_parts(&self, parts: MetadataParts) -> Self {
        let metadata = Metadata {
            element_type: parts.0,
            material: parts.1.map(Into::into),
            geometry: parts.2.map(Into::into),
            comments: parts.3,
            other: parts.4.into_iter().map(|(path, e)| (path, e.into())).collect(),
        };
        self.with(metadata)
    }

    /// The fields of the material that are there, by our names.
    fn metadata_fields(&self) -> Vec<(&'static str, Value)> {
        let m = &self.0.metadata;
        FIELDS
            .iter()
            .filter_map(|field| {
                let value = match field.kind {
                    Kind::Text => Value::Text(field.text(m)?.to_owned()),
                    _ => Value::Number(field.number(m)?),
                };
                Some((field.name, value))
            })
            .collect()
    }

    /// The same models with some fields of the material given.
    fn with_metadata_fields(&self, fields: Vec<(String, Value)>) -> PyResult<Self> {
        let mut metadata = self.0.metadata.clone();
        for (name, value) in fields {
            let field = Field::named(&name).map_err(raise)?;
            match value {
                Value::Number(x) => field.set_number(&mut metadata, x),
                Value::Text(text) => field.set_text(&mut metadata, &text),
            }
            .map_err(raise)?;
        }
        Ok(self.with(metadata))
    }
}

impl PyBsdf {
    fn with(&self, metadata: Metadata) -> Self {
        let mut bsdf = self.0.clone();
        bsdf.metadata = metadata;
        Self(bsdf)
    }
}
