//! A clear plane-parallel pane without coating: Fresnel reflection at both faces, absorption between them, all internal
//! reflections (Furler 1991, "Angular dependence of optical properties of homogeneous glasses", ASHRAE Transactions 97).
//!
//! Incoherent: the pane is thick against the light's coherence length. Both polarisations are followed and averaged at
//! the end, so natural light is meant.

use crate::direction::{Disk, Scatter};
use crate::error::{Error, Result};

/// A pane by its refractive index and its internal transmittance along the normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Slab {
    index: f64,
    internal: f64,
}

impl Slab {
    /// From a real refractive index of 1 or more and the transmittance of one pass along the normal between the faces.
    pub fn new(index: f64, internal: f64) -> Result<Self> {
        if !(index.is_finite() && index >= 1.0) {
            return Err(Error::Argument(format!(
                "refractive index {index} is not one of a pane in air (give a number of 1 or more)"
            )));
        }
        if !(0.0..=1.0).contains(&internal) {
            return Err(Error::Argument(format!(
                "internal transmittance {internal} is not a number from 0 to 1"
            )));
        }
        Ok(Self { index, internal })
    }

    /// From measured transmittance and reflectance at normal incidence.
    ///
    /// Fails where no uncoated pane has both.
    pub fn from_normal(transmittance: f64, reflectance: f64) -> Result<Self> {
        let (t, r) = (transmittance, reflectance);
        let fail = || {
            Error::Argument(format!(
                "no uncoated pane has transmittance {t} and reflectance {r} at normal incidence (give both of one \
                 wavelength or band, greater than 0 and with a sum of at most 1; coated panes need angular data)"
            ))
        };
        if !(t > 0.0 && r > 0.0 && t + r <= 1.0) {
            return Err(fail());
        }
        let beta = t * t - r * r + 2.0 * r + 1.0;
        let face = (beta - (beta * beta - 4.0 * (2.0 - r) * r).sqrt()) / (2.0 * (2.0 - r));
        let internal = (r - face) / (t * face);
        let index = (1.0 + face.sqrt()) / (1.0 - face.sqrt());
        // Rounding may leave a lossless pane a hair above 1.
        if !(internal > 0.0 && internal < 1.0 + 1e-9) {
            return Err(fail());
        }
        Self::new(index, internal.min(1.0)).map_err(|_| fail())
    }

    /// Real refractive index.
    pub fn index(&self) -> f64 {
        self.index
    }

    /// Transmittance of one pass along the normal between the faces.
    pub fn internal(&self) -> f64 {
        self.internal
    }

    /// Transmittance and reflectance for light of a polar angle, given by its sin².
    pub fn values(&self, sin2_theta: f64) -> [f64; 2] {
        let n = self.index;
        let cos = (1.0 - sin2_theta).max(0.0).sqrt();
        let inner = (1.0 - sin2_theta.min(1.0) / (n * n)).max(0.0).sqrt();
        let pass = self.internal.powf(1.0 / inner);
        let face = |p: f64, q: f64| {
            let amplitude = if p + q > 0.0 { (p - q) / (p + q) } else { 0.0 };
            amplitude * amplitude
        };
        let [s, p] = [face(cos, n * inner), face(n * cos, inner)].map(|r| {
            let round_trip = 1.0 - pass * pass * r * r;
            // At grazing incidence nothing enters.
            let t = if round_trip > 0.0 {
                pass * (1.0 - r) * (1.0 - r) / round_trip
            } else {
                0.0
            };
            [t, r * (1.0 + pass * t)]
        });
        [0.5 * (s[0] + p[0]), 0.5 * (s[1] + p[1])]
    }

    /// Transmittance or reflectance of the beam for light that travels along a disk point.
    pub fn value(&self, incident: Disk, scatter: Scatter) -> f64 {
        self.values(incident.sin2_theta())[scatter as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(slab: Slab, theta_deg: f64) -> [f64; 2] {
        slab.values(theta_deg.to_radians().sin().powi(2))
    }

    #[test]
    fn published_pane_of_known_index() {
        // EnergyPlus Engineering Reference: n = 1.526 and T = 0.86156 give R = 0.07846, by an internal transmittance of
        // {√[(1−r)⁴ + 4r²T²] − (1−r)²}/(2r²T) = 0.93987.
        let slab = Slab::new(1.526, 0.939_870).unwrap();
        let [t, r] = at(slab, 0.0);
        assert!((t - 0.86156).abs() < 1e-5 && (r - 0.07846).abs() < 2e-5, "{t} {r}");
        let back = Slab::from_normal(t, r).unwrap();
        assert!((back.index() - 1.526).abs() < 1e-12 && (back.internal() - slab.internal()).abs() < 1e-12);
    }

    #[test]
    fn clear_3_mm_glass_by_angle() {
        let slab = Slab::from_normal(0.8993, 0.0826).unwrap();
        for (theta, t, r) in [
            (0.0, 0.8993, 0.0826),
            (30.0, 0.8960, 0.0848),
            (50.0, 0.8699, 0.1091),
            (60.0, 0.8222, 0.1558),
            (70.0, 0.7050, 0.2722),
            (80.0, 0.4406, 0.5362),
        ] {
            let [t_is, r_is] = at(slab, theta);
            // The published figures are rounded to four digits, and so are the two that the pane is made from.
            assert!(
                (t_is - t).abs() < 1.5e-4 && (r_is - r).abs() < 1.5e-4,
                "{theta}: {t_is} {r_is}"
            );
        }
    }

    #[test]
    fn limits() {
        for internal in [1.0, 0.9, 0.0] {
            let slab = Slab::new(1.5, internal).unwrap();
            let [t, r] = slab.values(1.0);
            assert!(t.abs() < 1e-12 && (r - 1.0).abs() < 1e-12, "{t} {r}");
            for k in 0..=90 {
                let [t, r] = at(slab, f64::from(k));
                assert!(t >= 0.0 && r >= 0.0 && t + r <= 1.0 + 1e-12);
                assert!(internal < 1.0 || (t + r - 1.0).abs() < 1e-12);
            }
        }
        // No faces: absorption alone, over the longer path at an angle.
        let gas = Slab::new(1.0, 0.5).unwrap();
        let [t, r] = at(gas, 60.0);
        assert!((t - 0.25).abs() < 1e-12 && r.abs() < 1e-12);
    }

    #[test]
    fn impossible_panes_are_refused() {
        for (t, r) in [(0.9, 0.0), (0.0, 0.1), (0.9, 0.2), (f64::NAN, 0.1)] {
            assert!(Slab::from_normal(t, r).is_err(), "{t} {r}");
        }
        for (n, a) in [
            (0.9, 1.0),
            (f64::INFINITY, 1.0),
            (1.5, 1.1),
            (1.5, -0.1),
            (1.5, f64::NAN),
        ] {
            assert!(Slab::new(n, a).is_err());
        }
    }
}
