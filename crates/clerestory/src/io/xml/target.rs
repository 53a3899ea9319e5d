//! What each program wants of a file, and how a data set is fitted to it.

use std::sync::Arc;

use super::fields::Field;
use super::names;
use crate::basis::Basis;
use crate::bsdf::{Band, Bsdf, Matrix, Metadata, Model};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};
use crate::io::counted;

/// The program that a file is for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Target {
    /// None in particular: all that the data set holds is kept.
    #[default]
    Plain,
    /// Radiance: visible light, with colour if there is any.
    Radiance,
    /// WINDOW 6/7: solar and visible, both sides, with thermal data.
    Window,
    /// WINDOW's way to EnergyPlus, which takes transmission from the exterior and reflection of the interior face.
    EnergyPlus,
}

impl Target {
    /// By the name that people give it.
    pub fn named(name: &str) -> Result<Self> {
        match name.to_ascii_lowercase().as_str() {
            "plain" => Ok(Self::Plain),
            "radiance" => Ok(Self::Radiance),
            "window" => Ok(Self::Window),
            "energyplus" => Ok(Self::EnergyPlus),
            _ => Err(Error::Argument(format!(
                "target {name:?} is not known (give plain, radiance, window or energyplus)"
            ))),
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Plain => "the file",
            Self::Radiance => "Radiance",
            Self::Window => "WINDOW",
            Self::EnergyPlus => "EnergyPlus",
        }
    }
}

/// The data set as the target takes it, and what was changed on the way.
pub(super) fn fit(bsdf: &Bsdf, target: Target) -> Result<(Bsdf, Vec<String>)> {
    let mut notes = Vec::new();
    let plain = bsdf.try_map(|band, side, scatter, model| {
        let what = || format!("{} of band {band:?}", names::direction(side, scatter));
        unseparated(model, what, &mut notes)
    })?;
    let fitted = match target {
        Target::Plain => plain,
        Target::Radiance => for_radiance(&plain, &mut notes)?,
        Target::Window | Target::EnergyPlus => for_window(&plain, target, &mut notes)?,
    };
    Ok((fitted, notes))
}

/// The matrix or tree itself.
fn unseparated(model: &Model, what: impl Fn() -> String, notes: &mut Vec<String>) -> Result<Model> {
    match model {
        Model::Matrix(matrix) => {
            if matrix.standard_errors().is_some() {
                notes.push(format!(
                    "standard errors of {} are left out: XML has no place for them",
                    what()
                ));
            }
            Ok(model.clone())
        }
        Model::Tree(_) => Ok(model.clone()),
        Model::Separated(separated) => {
            notes.push(format!("peaks of {} are written unseparated", what()));
            unseparated(separated.base(), what, notes)
        }
        // A table and the beams that were measured beside it.
        Model::Sum(_) if matches!(model.unseparated(), Model::Matrix(_) | Model::Tree(_)) => {
            notes.push(format!("beams of {} are written as part of the table", what()));
            unseparated(&model.unseparated(), what, notes)
        }
        other => Err(Error::Unsupported(format!(
            "{} is a {} model, which XML cannot hold (convert it to an angle basis or a tensor tree first)",
            what(),
            other.kind()
        ))),
    }
}

/// The same data set with other bands.
fn with_bands(bsdf: &Bsdf, bands: Vec<Band>, metadata: Metadata) -> Result<Bsdf> {
    let mut result = Bsdf::new(bands, metadata)?;
    result.warnings.clone_from(&bsdf.warnings);
    Ok(result)
}

fn left_out(names: &[&str], target: Target, notes: &mut Vec<String>) {
    if !names.is_empty() {
        let list = names.join(", ");
        notes.push(format!(
            "{} does not use these bands, which are left out: {list}",
            target.name()
        ));
    }
}

fn need_band<'b>(bsdf: &'b Bsdf, name: &str, target: Target) -> Result<&'b Band> {
    bsdf.band(Some(name)).map_err(|_| {
        Error::Missing(format!(
            "{} needs band {name:?}; the data set has: {} (merge a file that holds it)",
            target.name(),
            held(bsdf)
        ))
    })
}

/// Names of all bands.
fn held(bsdf: &Bsdf) -> String {
    let names: Vec<&str> = bsdf.bands().iter().map(|b| b.name.as_str()).collect();
    names.join(", ")
}

fn for_radiance(bsdf: &Bsdf, notes: &mut Vec<String>) -> Result<Bsdf> {
    let visible = need_band(bsdf, "visible", Target::Radiance)?;
    let is_tree = visible
        .components()
        .next()
        .is_some_and(|(.., m)| matches!(**m, Model::Tree(_)));
    let colours = if is_tree {
        ["cie-u", "cie-v"]
    } else {
        ["cie-x", "cie-z"]
    };
    let (used, unused): (Vec<&Band>, Vec<&Band>) = bsdf
        .bands()
        .iter()
        .partition(|b| b.name == "visible" || colours.contains(&b.name.as_str()));
    let names: Vec<&str> = unused.iter().map(|b| b.name.as_str()).collect();
    left_out(&names, Target::Radiance, notes);
    let mut metadata = bsdf.metadata.clone();
    metadata.other.retain(|(_, element)| {
        let keep = element.name != "WavelengthData";
        if !keep {
            notes.push("data beside transmission and reflection are left out".into());
        }
        keep
    });
    // Radiance refuses a file for a length that it does not understand, or geometry that is not MGF.
    if let Some(material) = &mut metadata.material {
        material.children.retain(|field| {
            let is_length = matches!(field.name.as_str(), "Thickness" | "Width" | "Height");
            let sound = field.text.parse::<f64>().is_ok_and(|v| v >= 0.0 && v.is_finite())
                && field.attribute("unit").is_none_or(|u| Metadata::metres_in(u).is_some());
            if is_length && !sound {
                notes.push(format!("<{}> {:?} is left out: no length", field.name, field.text));
            }
            !is_length || sound
        });
    }
    let is_mgf = |g: &crate::bsdf::Element| g.attribute("format").is_none_or(|f| f.eq_ignore_ascii_case("MGF"));
    if metadata.geometry.as_ref().is_some_and(|g| !is_mgf(g)) {
        notes.push("the embedded geometry is left out: it is not MGF".into());
        metadata.geometry = None;
    }
    let bands = used.into_iter().cloned().collect();
    with_bands(bsdf, bands, metadata)
}

/// Bands of a file for WINDOW, in its order.
const WINDOW_BANDS: [&str; 2] = ["solar", "visible"];

fn for_window(bsdf: &Bsdf, target: Target, notes: &mut Vec<String>) -> Result<Bsdf> {
    need_for_window(bsdf, target)?;
    let mut bands = Vec::new();
    for name in WINDOW_BANDS {
        bands.push(window_band(need_band(bsdf, name, target)?, target, notes)?);
    }
    let names: Vec<&str> = bsdf
        .bands()
        .iter()
        .map(|b| b.name.as_str())
        .filter(|n| !WINDOW_BANDS.contains(n))
        .collect();
    left_out(&names, target, notes);
    let mut metadata = bsdf.metadata.clone();
    in_millimetres(&mut metadata);
    // LBNL's parser ends in a crash without the first two.
    for (field, text) in [
        ("Name", "unnamed"),
        ("Manufacturer", "unknown"),
        ("DeviceType", "Other"),
    ] {
        if metadata.material_text(field).is_none() {
            notes.push(format!("<{field}> is not known; {text:?} is written"));
            metadata.set_material(field, text, None);
        }
    }
    with_bands(bsdf, bands, metadata)
}

/// Sizes in millimetres, as WINDOW writes them: some of its readers do not look at the unit.
fn in_millimetres(metadata: &mut Metadata) {
    for field in ["Thickness", "Width", "Height"] {
        if let Some(metres) = metadata.material_length_m(field) {
            // Nine decimals are a picometre, and hide the rounding of the change of unit.
            let text = format!("{:.9}", metres * 1000.0);
            let text = text.trim_end_matches('0').trim_end_matches('.');
            metadata.set_material(field, text, Some("Millimeter"));
        }
    }
}

/// Fails with the names of all that is missing, metadata and data, and how to give it.
fn need_for_window(bsdf: &Bsdf, target: Target) -> Result<()> {
    let mut needed = vec![
        ("emissivity_exterior", "--emissivity-exterior"),
        ("emissivity_interior", "--emissivity-interior"),
        ("tir", "--tir"),
        ("thickness_m", "--thickness"),
    ];
    if target == Target::EnergyPlus {
        needed.push(("thermal_conductivity", "--conductivity"));
    }
    let (mut fields, mut options) = (Vec::new(), Vec::new());
    let mut zero = None;
    for (name, option) in needed {
        match Field::named(name)?.number(&bsdf.metadata) {
            Some(0.0) if target == Target::EnergyPlus && name.starts_with("emissivity") => zero = Some((name, option)),
            Some(_) => {}
            None => {
                fields.push(name);
                options.push(option);
            }
        }
    }
    let mut data = Vec::new();
    for name in WINDOW_BANDS {
        match bsdf.band(Some(name)) {
            Ok(band) => data.extend(missing_directions(band, target)),
            Err(_) => data.push(format!("band {name:?}")),
        }
    }
    let mut parts = Vec::new();
    if !fields.is_empty() {
        parts.push(format!("{} (give {})", fields.join(", "), options.join(", ")));
    }
    if !data.is_empty() {
        parts.push(format!(
            "{}; the data set has: {} (merge a file that holds {})",
            data.join(", "),
            held(bsdf),
            if data.len() == 1 { "it" } else { "them" }
        ));
    }
    if !parts.is_empty() {
        return Err(Error::Missing(format!(
            "{} needs {}",
            target.name(),
            parts.join(" and ")
        )));
    }
    // Its heat balance does not converge with an emissivity of 0 (EnergyPlus issue 7698).
    zero.map_or(Ok(()), |(name, option)| {
        Err(Error::Argument(format!(
            "{name} is 0, with which EnergyPlus cannot compute (give a value above 0 with {option})"
        )))
    })
}

/// The directions of a band that the target needs and that cannot be had by reciprocity either.
fn missing_directions(band: &Band, target: Target) -> Vec<String> {
    let mut missing = Vec::new();
    for side in Side::BOTH {
        for scatter in Scatter::BOTH {
            let unneeded = target == Target::EnergyPlus && (side, scatter) == (Side::Exterior, Scatter::Reflection);
            if !unneeded && available(band, side, scatter).is_none() {
                missing.push(format!(
                    "{} (light from the {}) of band {:?}",
                    names::direction(side, scatter),
                    side.name(),
                    band.name
                ));
            }
        }
    }
    missing
}

/// The model of a direction, or of the other side's transmission, which has the same by reciprocity (then true).
fn available(band: &Band, side: Side, scatter: Scatter) -> Option<(&Model, bool)> {
    let of = |side| band.get(side, scatter).map(Arc::as_ref);
    match (of(side), scatter) {
        (Some(model), _) => Some((model, false)),
        (None, Scatter::Transmission) => of(side.opposite()).map(|model| (model, true)),
        (None, Scatter::Reflection) => None,
    }
}

/// A band on a Klems basis with all directions that are needed; that these are there is known.
fn window_band(band: &Band, target: Target, notes: &mut Vec<String>) -> Result<Band> {
    let mut result = Band::new(band.name.clone());
    result.source_spectrum.clone_from(&band.source_spectrum);
    result.detector_spectrum.clone_from(&band.detector_spectrum);
    for side in Side::BOTH {
        for scatter in Scatter::BOTH {
            let what = format!("{} of band {:?}", names::direction(side, scatter), band.name);
            let Some((model, by_reciprocity)) = available(band, side, scatter) else {
                notes.push(format!("{what} is not there; {} does without", target.name()));
                continue;
            };
            let matrix = if by_reciprocity {
                notes.push(format!("{what} was not there; it is the other side's by reciprocity"));
                window_matrix(&model.reciprocal(), &what, target, notes)?
            } else {
                window_matrix(model, &what, target, notes)?
            };
            result.set(side, scatter, Some(matrix.into()));
        }
    }
    Ok(result)
}

/// The matrix on a Klems basis under its standard name, without negative values.
fn window_matrix(model: &Model, what: &str, target: Target, notes: &mut Vec<String>) -> Result<Model> {
    let klems = match model {
        Model::Matrix(m) if m.incident() == m.outgoing() => {
            [Basis::klems_full(), Basis::klems_half(), Basis::klems_quarter()]
                .into_iter()
                .find(|b| *b == **m.incident())
                .map(|b| (m, b))
        }
        _ => None,
    };
    let Some((matrix, basis)) = klems else {
        return Err(Error::Unsupported(format!(
            "{what} is not on a Klems basis, which {} needs (convert it with --basis klems-full)",
            target.name()
        )));
    };
    let negative = matrix.values().iter().filter(|v| **v < 0.0).count();
    if negative > 0 {
        notes.push(format!(
            "{} of {what} written as 0",
            counted(negative, "negative value")
        ));
    }
    let values = matrix.values().iter().map(|v| v.max(0.0)).collect();
    let basis = Arc::new(basis);
    Ok(Model::Matrix(Matrix::new(basis.clone(), basis, values)?))
}
