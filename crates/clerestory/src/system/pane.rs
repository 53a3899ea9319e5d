//! Clear panes of glass as layers.

use std::f64::consts::PI;

use crate::bsdf::{Band, Bsdf, Metadata, Model, Slab, Specular};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};

/// Transmittance of one pass through `thickness` for an extinction coefficient (imaginary part of the refractive index)
/// and a wavelength in vacuum, both lengths in metres: exp(−4πκd/λ).
pub fn internal_by_extinction(extinction: f64, thickness: f64, wavelength: f64) -> Result<f64> {
    if !(wavelength.is_finite() && wavelength > 0.0) {
        return Err(Error::Argument(format!(
            "wavelength {wavelength} m is not a length greater than 0"
        )));
    }
    internal_by_absorption(4.0 * PI * extinction / wavelength, thickness)
}

/// Transmittance of one pass through `thickness` (m) for an absorption coefficient (1/m): exp(−αd).
pub fn internal_by_absorption(coefficient: f64, thickness: f64) -> Result<f64> {
    let depth = coefficient * thickness;
    if !(depth.is_finite() && coefficient >= 0.0 && thickness > 0.0) {
        return Err(Error::Argument(format!(
            "absorption of {coefficient} 1/m over {thickness} m is not one of a pane (give an absorption of 0 or more and \
             a thickness greater than 0)"
        )));
    }
    Ok((-depth).exp())
}

/// The pane as a data set of one band: beams from both sides.
pub fn pane(slab: Slab, band: impl Into<String>) -> Result<Bsdf> {
    let band = Side::BOTH.into_iter().fold(Band::new(band), |band, side| {
        Scatter::BOTH.into_iter().fold(band, |band, scatter| {
            band.with(side, scatter, Model::Specular(Specular::Pane(slab, scatter)))
        })
    });
    let metadata = Metadata {
        element_type: Some("Layer".into()),
        ..Metadata::default()
    };
    Bsdf::new(vec![band], metadata)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extinction_and_absorption_agree() {
        let by_extinction = internal_by_extinction(1e-6, 3e-3, 550e-9).unwrap();
        let by_absorption = internal_by_absorption(4.0 * PI * 1e-6 / 550e-9, 3e-3).unwrap();
        assert!((by_extinction - by_absorption).abs() < 1e-15);
        assert!((by_extinction - 0.933_753).abs() < 1e-6, "{by_extinction}");
        for (k, d, l) in [(-1e-6, 3e-3, 550e-9), (1e-6, 0.0, 550e-9), (1e-6, 3e-3, 0.0)] {
            assert!(internal_by_extinction(k, d, l).is_err());
        }
    }
}
