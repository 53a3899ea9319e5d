//! A whole data set: bands, both sides, transmission and reflection, and what is known of the sample.

use std::sync::Arc;

use super::{Metadata, Model, Turn};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};

/// A model of light from one side, transmitted or reflected.
pub type Component = Arc<Model>;

/// One spectral band.
#[derive(Debug, Clone)]
pub struct Band {
    /// `visible`, `solar`, `nir`, `thermal`, `cie-x` …, or a wavelength such as `550 nm`.
    pub name: String,
    /// Source spectrum by which the band was weighted, as the file names it.
    pub source_spectrum: Option<String>,
    /// Detector spectrum, as the file names it.
    pub detector_spectrum: Option<String>,
    components: [[Option<Component>; 2]; 2],
}

impl Band {
    /// A band without data.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            source_spectrum: None,
            detector_spectrum: None,
            components: Default::default(),
        }
    }

    /// The component for light from `side`, if the data set holds it.
    pub fn get(&self, side: Side, scatter: Scatter) -> Option<&Component> {
        self.components[side as usize][scatter as usize].as_ref()
    }

    /// Puts a component in; the old one is returned.
    pub fn set(&mut self, side: Side, scatter: Scatter, component: Option<Component>) -> Option<Component> {
        std::mem::replace(&mut self.components[side as usize][scatter as usize], component)
    }

    /// With a component put in.
    #[must_use]
    pub fn with(mut self, side: Side, scatter: Scatter, model: Model) -> Self {
        self.set(side, scatter, Some(Arc::new(model)));
        self
    }

    /// The components that are there, in the order exterior and interior, transmission and reflection.
    pub fn components(&self) -> impl Iterator<Item = (Side, Scatter, &Component)> {
        Side::BOTH
            .into_iter()
            .flat_map(|side| Scatter::BOTH.map(|scatter| (side, scatter)))
            .filter_map(|(side, scatter)| self.get(side, scatter).map(|c| (side, scatter, c)))
    }
}

/// A component that was asked for.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// The model.
    pub component: Component,
    /// It was not in the data set: the other side's transmission answers by reciprocity.
    pub by_reciprocity: bool,
}

/// A data set of one sample.
#[derive(Debug, Clone)]
pub struct Bsdf {
    bands: Vec<Band>,
    /// What is known of the sample.
    pub metadata: Metadata,
    /// What was faulty or surprising in the file that it came from.
    pub warnings: Vec<String>,
}

impl Bsdf {
    /// From bands of different names, one or more.
    pub fn new(bands: Vec<Band>, metadata: Metadata) -> Result<Self> {
        if bands.is_empty() {
            return Err(Error::Missing("a BSDF needs at least one band".into()));
        }
        for (k, band) in bands.iter().enumerate() {
            if bands[..k].iter().any(|b| b.name == band.name) {
                return Err(Error::Argument(format!("band {:?} is there twice", band.name)));
            }
        }
        Ok(Self {
            bands,
            metadata,
            warnings: Vec::new(),
        })
    }

    /// All bands.
    pub fn bands(&self) -> &[Band] {
        &self.bands
    }

    /// A band by its name; `None` asks for visible, or the first where there is no visible one.
    pub fn band(&self, name: Option<&str>) -> Result<&Band> {
        match name {
            None => Ok(self
                .bands
                .iter()
                .find(|b| b.name == "visible")
                .unwrap_or(&self.bands[0])),
            Some(name) => self
                .bands
                .iter()
                .find(|b| b.name.eq_ignore_ascii_case(name))
                .ok_or_else(|| {
                    let names: Vec<&str> = self.bands.iter().map(|b| b.name.as_str()).collect();
                    Error::Missing(format!("no band {name:?} (the data set has: {})", names.join(", ")))
                }),
        }
    }

    /// Only the bands that are named, in that order.
    pub fn with_bands(&self, names: &[String]) -> Result<Self> {
        let bands = names
            .iter()
            .map(|name| self.band(Some(name)).cloned())
            .collect::<Result<_>>()?;
        let mut result = Self::new(bands, self.metadata.clone())?;
        result.warnings.clone_from(&self.warnings);
        Ok(result)
    }

    /// With a band put in; one of the same name is replaced.
    pub fn with_band(&self, band: Band) -> Result<Self> {
        let mut bands = self.bands.clone();
        match bands.iter_mut().find(|b| b.name == band.name) {
            Some(old) => *old = band,
            None => bands.push(band),
        }
        let mut result = Self::new(bands, self.metadata.clone())?;
        result.warnings.clone_from(&self.warnings);
        Ok(result)
    }

    /// A band under another name.
    pub fn with_renamed_band(&self, old: &str, new: &str) -> Result<Self> {
        let name = self.band(Some(old))?.name.clone();
        let mut bands = self.bands.clone();
        for band in bands.iter_mut().filter(|b| b.name == name) {
            band.name = new.to_ascii_lowercase();
        }
        let mut result = Self::new(bands, self.metadata.clone())?;
        result.warnings.clone_from(&self.warnings);
        Ok(result)
    }

    /// A component. A missing transmission side is answered by reciprocity; a missing reflection is an error.
    pub fn component(&self, band: Option<&str>, side: Side, scatter: Scatter) -> Result<Outcome> {
        let band = self.band(band)?;
        if let Some(component) = band.get(side, scatter) {
            return Ok(Outcome {
                component: component.clone(),
                by_reciprocity: false,
            });
        }
        if scatter == Scatter::Transmission
            && let Some(other) = band.get(side.opposite(), scatter)
        {
            return Ok(Outcome {
                component: Arc::new(other.reciprocal()),
                by_reciprocity: true,
            });
        }
        let held: Vec<String> = band
            .components()
            .map(|(s, c, _)| format!("{} from the {}", c.name(), s.name()))
            .collect();
        Err(Error::Missing(format!(
            "band {:?} has no {} for light from the {} (it has {})",
            band.name,
            scatter.name(),
            side.name(),
            if held.is_empty() {
                "nothing".to_owned()
            } else {
                held.join(", ")
            }
        )))
    }

    /// Every component replaced by what `map` makes of it.
    pub fn try_map(&self, mut map: impl FnMut(&str, Side, Scatter, &Model) -> Result<Model>) -> Result<Self> {
        let mut result = self.clone();
        for band in &mut result.bands {
            for side in Side::BOTH {
                for scatter in Scatter::BOTH {
                    if let Some(component) = band.get(side, scatter).cloned() {
                        let model = map(&band.name, side, scatter, &component)?;
                        band.set(side, scatter, Some(Arc::new(model)));
                    }
                }
            }
        }
        Ok(result)
    }

    /// The sample turned about its vertical axis: the interior face becomes the exterior one.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let mut result = self.clone();
        result.metadata = self.metadata.flipped();
        for (new, old) in result.bands.iter_mut().zip(&self.bands) {
            for side in Side::BOTH {
                for scatter in Scatter::BOTH {
                    let model = old
                        .get(side.opposite(), scatter)
                        .map(|c| Arc::new(c.turned(Turn::new(0.0, true))));
                    new.set(side, scatter, model);
                }
            }
        }
        result
    }

    /// The sample mirrored or turned in its plane.
    pub fn turned(&self, turn: Turn) -> Result<Self> {
        self.try_map(|_, _, _, model| Ok(model.turned(turn)))
    }

    /// Bands of several data sets of one sample as one. The metadata of the first is kept, with the `<Material>` fields
    /// that only others have.
    pub fn merged(sets: &[Self]) -> Result<Self> {
        for (k, set) in sets.iter().enumerate() {
            let twice = |b: &&Band| {
                sets[..k]
                    .iter()
                    .any(|s| s.bands.iter().any(|other| other.name == b.name))
            };
            if let Some(band) = set.bands.iter().find(twice) {
                return Err(Error::Argument(format!(
                    "more than one data set holds band {:?}: number {} does too (rename the band in one of them, or leave \
                     it out)",
                    band.name,
                    k + 1
                )));
            }
        }
        let bands = sets.iter().flat_map(|s| s.bands.iter().cloned()).collect();
        let mut metadata = sets.first().map(|s| s.metadata.clone()).unwrap_or_default();
        for set in sets.iter().skip(1) {
            for field in set.metadata.material.iter().flat_map(|m| &m.children) {
                if metadata.material_text(&field.name).is_none() {
                    let material = metadata
                        .material
                        .get_or_insert_with(|| super::Element::leaf("Material", ""));
                    material.children.retain(|c| c.name != field.name);
                    material.children.push(field.clone());
                }
            }
        }
        let mut result = Self::new(bands, metadata)?;
        result.warnings = sets.iter().flat_map(|s| s.warnings.iter().cloned()).collect();
        Ok(result)
    }
}
