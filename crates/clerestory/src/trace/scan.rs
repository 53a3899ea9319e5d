//! Listed incident directions, as a real goniophotometer measures them.

use std::sync::Arc;

use super::balance::Tallies;
use super::goniophotometer::{Goniophotometer, Place, Totals, estimate, places, summed};
use super::sample::Sample;
use super::scene::{Scene, with_bands};
use super::state::{State, Unit};
use super::unit::{Bench, Source};
use crate::basis::Basis;
use crate::bsdf::Estimate;
use crate::direction::{Direction, Scatter, Side};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// Light of one band from one listed direction, transmitted or reflected.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// Name of the band.
    pub band: String,
    /// Number of the direction in the list.
    pub direction: usize,
    /// Side that light came from.
    pub side: Side,
    /// Transmitted or reflected.
    pub scatter: Scatter,
    /// BSDF of scattered light (1/sr), the mean over each outgoing patch.
    pub values: Vec<Estimate>,
    /// Transmittance or reflectance of the beam straight on.
    pub beam: Estimate,
    /// Direct-hemispherical value, all light.
    pub total: Estimate,
}

/// What came out for listed directions.
#[derive(Debug, Clone)]
pub struct Scan {
    /// By direction, band and scatter.
    pub distributions: Vec<Distribution>,
    /// Tallies of all paths, one a band.
    pub balance: Vec<Tallies>,
    /// The same by direction.
    pub places: Vec<Place>,
    /// What people must know.
    pub warnings: Vec<String>,
}

impl Scan {
    /// Direct-hemispherical values of the directions from one side, band by band.
    pub fn totals(&self, side: Side, scatter: Scatter, band: &str) -> Totals {
        let here = |d: &&Distribution| d.side == side && d.scatter == scatter && d.band == band;
        Totals {
            band: band.into(),
            side,
            scatter,
            values: self.distributions.iter().filter(here).map(|d| d.total).collect(),
            hemispherical: None,
        }
    }
}

impl Goniophotometer {
    /// Light from listed directions, which point to the source, so each one tells its side; the sides of the settings do not
    /// count. With a source cone the light comes from about each direction.
    pub fn scan(
        &self,
        sample: &Sample,
        directions: &[Direction],
        outgoing: &Arc<Basis>,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Scan> {
        self.settings.check()?;
        if directions.is_empty() {
            return Err(Error::Argument(
                "no incident directions are listed (give one or more)".into(),
            ));
        }
        if let Some(k) = directions.iter().position(|d| d.z.abs() < 1e-9) {
            return Err(Error::Argument(format!(
                "incident direction {} lies in the sample's plane (give polar angles below 90°)",
                k + 1
            )));
        }
        with_bands!(sample, self.scan_of(directions, outgoing, state, progress))
    }

    fn scan_of<const N: usize>(
        &self,
        scene: &Scene<'_>,
        directions: &[Direction],
        outgoing: &Arc<Basis>,
        state: &mut State,
        progress: &Progress,
    ) -> Result<Scan> {
        let bench = Bench {
            scene,
            settings: &self.settings,
            area: scene.sample.area()?,
            incident: outgoing,
            outgoing,
        };
        let work: Vec<(Side, Source)> = directions
            .iter()
            .map(|d| (d.side(), Source::Direction(d.incident_disk())))
            .collect();
        bench.measure::<N>(&work, state, progress)?;
        let layout = bench.layout();
        let units: Vec<&Unit> = state.units().collect();
        let areas = outgoing.projected_solid_angles();
        let mut distributions = Vec::new();
        for (direction, (unit, (side, _))) in units.iter().zip(&work).enumerate() {
            for (b, band) in scene.sample.bands.iter().enumerate() {
                for scatter in Scatter::BOTH {
                    let get = |patch| layout.get(unit, scatter, b, patch);
                    let value = |(o, area): (usize, &f64)| estimate(get(o).map(|v| v / area));
                    distributions.push(Distribution {
                        band: band.clone(),
                        direction,
                        side: *side,
                        scatter,
                        values: areas.iter().enumerate().map(value).collect(),
                        beam: estimate(get(layout.patches)),
                        total: estimate(layout.total(unit, scatter, b)),
                    });
                }
            }
        }
        let mut places = places(&units, &[Side::Exterior], layout.bands, |unit| layout.worst(unit));
        for (place, (side, _)) in places.iter_mut().zip(&work) {
            place.side = *side;
        }
        Ok(Scan {
            distributions,
            balance: summed(&places),
            warnings: self.warnings(&places),
            places,
        })
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;
    use crate::trace::testing::{blind, sheet};
    use crate::trace::{Settings, Stop};

    fn instrument() -> Goniophotometer {
        Goniophotometer {
            settings: Settings {
                stop: Stop::Paths(1 << 14),
                ..Settings::default()
            },
        }
    }

    fn scan(sample: &Sample, directions: &[Direction]) -> Result<Scan> {
        let basis = Arc::new(Basis::klems_quarter());
        instrument().scan(sample, directions, &basis, &mut State::new(""), &Progress::default())
    }

    #[test]
    fn black_slats_cut_light_off_where_geometry_says() {
        // The sun above, in the plane across the slats.
        let thetas = [0.0_f64, 20.0, 35.0, 41.0, 43.0, 60.0];
        let from = |side, theta: &f64| Direction::from_angles(side, theta.to_radians(), FRAC_PI_2);
        let directions: Vec<Direction> = Side::BOTH
            .iter()
            .flat_map(|&side| thetas.iter().map(move |t| from(side, t)))
            .collect();
        let scan = scan(&blind(0.0), &directions).expect("it runs");
        assert_eq!(scan.places.len(), 12);
        for distribution in scan.distributions.iter().filter(|d| d.scatter == Scatter::Transmission) {
            let theta = thetas[distribution.direction % 6].to_radians();
            let exact = (1.0 - 0.08 / 0.072 * theta.tan()).max(0.0);
            let Estimate { value, standard_error } = distribution.beam;
            assert!(
                (value - exact).abs() < 5e-4,
                "{theta}: {value} {exact} {standard_error:?}"
            );
            assert_eq!(distribution.total, distribution.beam);
            assert!(distribution.values.iter().all(|v| v.value == 0.0));
        }
        assert_eq!(
            scan.totals(Side::Interior, Scatter::Transmission, "400 nm")
                .values
                .len(),
            6
        );
    }

    #[test]
    fn what_is_no_direction_of_incidence_is_refused() {
        let sheet = sheet(crate::material::Material::Black, 1);
        assert!(scan(&sheet, &[]).is_err());
        let grazing = Direction::new(1.0, 0.0, 0.0).expect("a direction");
        assert!(
            scan(&sheet, &[grazing])
                .unwrap_err()
                .to_string()
                .contains("direction 1")
        );
    }
}
