//! Materials and media by their names and numbers.

use std::collections::HashMap;

use clerestory::material::{Material, Medium};
use pyo3::prelude::*;

use crate::errors::ClerestoryError;

/// A material: its kind, and its numbers by name, one a band where they are spectral.
#[derive(FromPyObject)]
pub struct MaterialSpec {
    #[pyo3(item("kind"))]
    kind: String,
    #[pyo3(item("numbers"))]
    numbers: HashMap<String, Vec<f64>>,
}

impl MaterialSpec {
    fn spectrum(&mut self, name: &str) -> PyResult<Vec<f64>> {
        self.numbers
            .remove(name)
            .ok_or_else(|| ClerestoryError::new_err(format!("material {}: {name} is missing", self.kind)))
    }

    /// The material of the core.
    pub fn into_material(mut self) -> PyResult<Material> {
        Ok(match self.kind.as_str() {
            "black" => Material::Black,
            "lambertian" => Material::Lambertian {
                reflectance: self.spectrum("reflectance")?,
                transmittance: self.spectrum("transmittance")?,
            },
            "mirror" => Material::Mirror {
                reflectance: self.spectrum("reflectance")?,
            },
            "interface" => Material::Interface,
            _ => {
                return Err(ClerestoryError::new_err(format!(
                    "no material {:?} is known",
                    self.kind
                )));
            }
        })
    }
}

/// A medium: one value a band each.
#[derive(FromPyObject)]
pub struct MediumSpec {
    #[pyo3(item("index"))]
    index: Vec<f64>,
    #[pyo3(item("absorption"))]
    absorption: Vec<f64>,
}

impl MediumSpec {
    /// The medium of the core.
    pub fn into_medium(self) -> Medium {
        let none = vec![0.0; self.index.len()];
        Medium {
            index: self.index,
            absorption: self.absorption,
            scattering: none.clone(),
            asymmetry: none,
        }
    }
}
