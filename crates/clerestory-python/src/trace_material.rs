//! Materials and media by their names and numbers.

use std::collections::HashMap;

use clerestory::geometry::Vec3;
use clerestory::material::{LobeValues, Material, Medium};
use pyo3::prelude::*;

use crate::arrays::side;
use crate::bsdf::PyBsdf;
use crate::errors::{ClerestoryError, raise};

/// A material: its kind, and its numbers by name, one a band where they are spectral.
#[derive(FromPyObject)]
pub struct MaterialSpec<'py> {
    #[pyo3(item("kind"))]
    kind: String,
    #[pyo3(item("numbers"))]
    numbers: HashMap<String, Vec<f64>>,
    #[pyo3(item("data"))]
    data: Option<DataSpec<'py>>,
    /// Of a mixture, with their shares.
    #[pyo3(item("parts"))]
    parts: Vec<(f64, MaterialSpec<'py>)>,
}

/// A data set, the names of its bands, the side that it shows, and its upward direction.
type DataSpec<'py> = (Bound<'py, PyBsdf>, Vec<Option<String>>, String, [f64; 3]);

impl MaterialSpec<'_> {
    fn spectrum(&self, name: &str) -> PyResult<&[f64]> {
        self.numbers
            .get(name)
            .map(Vec::as_slice)
            .ok_or_else(|| ClerestoryError::new_err(format!("material {}: {name} is missing", self.kind)))
    }

    fn number(&self, name: &str) -> PyResult<f64> {
        match self.spectrum(name)? {
            [value] => Ok(*value),
            values => Err(ClerestoryError::new_err(format!(
                "material {}: {} values of {name} (give one)",
                self.kind,
                values.len()
            ))),
        }
    }

    fn lobe(&self) -> PyResult<LobeValues<'_>> {
        Ok(LobeValues {
            reflectance: self.spectrum("reflectance")?,
            transmittance: self.spectrum("transmittance")?,
            diffuse_reflectance: self.spectrum("diffuse_reflectance")?,
            diffuse_transmittance: self.spectrum("diffuse_transmittance")?,
        })
    }

    /// The material of the core.
    pub fn into_material(self) -> PyResult<Material> {
        let material = match self.kind.as_str() {
            "black" => Ok(Material::Black),
            "interface" => Ok(Material::Interface),
            "lambertian" => Material::lambertian(self.spectrum("reflectance")?, self.spectrum("transmittance")?),
            "mirror" => Material::mirror(self.spectrum("reflectance")?),
            "plastic" => Material::plastic(
                self.spectrum("colour")?,
                self.number("specularity")?,
                self.number("roughness")?,
            ),
            "metal" => Material::metal(
                self.spectrum("colour")?,
                self.number("specularity")?,
                self.number("roughness")?,
            ),
            "trans" => Material::trans(
                self.spectrum("colour")?,
                self.number("specularity")?,
                self.number("roughness")?,
                self.number("transmission")?,
                self.number("transmitted_specularity")?,
            ),
            "glass" => Material::glass(self.spectrum("transmissivity")?, self.number("index")?),
            "rough interface" => Material::rough_interface(self.number("roughness")?),
            "ggx" => Material::ggx(self.spectrum("reflectance")?, self.number("roughness")?),
            "gaussian" => Material::gaussian(self.number("width")?, self.lobe()?),
            "abg" => Material::abg(self.number("b")?, self.number("g")?, self.lobe()?),
            "measured" => {
                let Some((bsdf, bands, side_name, [x, y, z])) = self.data else {
                    return Err(ClerestoryError::new_err("material measured: the data set is missing"));
                };
                let bands: Vec<Option<&str>> = bands.iter().map(Option::as_deref).collect();
                Material::measured(&bsdf.get().0, &bands, side(&side_name)?, Vec3::new(x, y, z))
            }
            "mixture" => Material::mixture(
                self.parts
                    .into_iter()
                    .map(|(share, part)| Ok((share, part.into_material()?)))
                    .collect::<PyResult<_>>()?,
            ),
            _ => {
                return Err(ClerestoryError::new_err(format!(
                    "no material {:?} is known",
                    self.kind
                )));
            }
        };
        material.map_err(raise)
    }
}

/// A medium: one value a band each.
#[derive(FromPyObject)]
pub struct MediumSpec {
    #[pyo3(item("index"))]
    index: Vec<f64>,
    #[pyo3(item("absorption"))]
    absorption: Vec<f64>,
    #[pyo3(item("scattering"))]
    scattering: Vec<f64>,
    #[pyo3(item("asymmetry"))]
    asymmetry: Vec<f64>,
}

impl MediumSpec {
    /// The medium of the core.
    pub fn into_medium(self) -> PyResult<Medium> {
        Medium::scattering(&self.index, &self.absorption, &self.scattering, &self.asymmetry).map_err(raise)
    }
}
