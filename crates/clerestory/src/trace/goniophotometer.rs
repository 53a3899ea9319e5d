//! Incident directions in, matrices with standard errors out.

use std::sync::Arc;

use rayon::prelude::*;

use super::balance::Balance;
use super::flight::{Collector, Flight, Limits};
use super::sample::Sample;
use crate::basis::Basis;
use crate::bsdf::{Band, Bsdf, Matrix, Metadata, Model};
use crate::direction::{Disk, Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::Area;
use crate::progress::Progress;
use crate::sequence::mix;

/// An instrument that looks at a sample from every direction.
#[derive(Debug, Clone)]
pub struct Goniophotometer {
    /// Light comes evenly from each patch of this basis.
    pub incident: Arc<Basis>,
    /// It is collected in the patches of this one.
    pub outgoing: Arc<Basis>,
    /// Sides that light comes from.
    pub sides: Vec<Side>,
    /// Independent repetitions; their scatter gives the standard errors.
    pub replications: u32,
    /// Paths a repetition and incident patch.
    pub paths: u32,
    /// Number from which all random numbers follow.
    pub seed: u64,
    /// When paths end.
    pub limits: Limits,
}

/// What came out.
#[derive(Debug)]
pub struct Measured {
    /// The models.
    pub bsdf: Bsdf,
    /// Flux by what became of it, a band each, over all paths: traced, transmitted, reflected, absorbed, roulette, cut off,
    /// lost.
    pub balance: Vec<[f64; 7]>,
}

/// Sum and sum of squares over replications.
#[derive(Clone, Copy, Default)]
struct Moments {
    sum: f64,
    squares: f64,
}

impl Moments {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    /// Mean of `n` values and its standard error.
    fn mean(self, n: u32) -> [f64; 2] {
        let n = f64::from(n);
        let mean = self.sum / n;
        let variance = (self.squares / n - mean * mean).max(0.0) * n / (n - 1.0);
        [mean, (variance / n).sqrt()]
    }
}

/// Flux of one replication by what becomes of it and where it goes.
struct Histogram<'a, const N: usize> {
    basis: &'a Basis,
    /// By scatter and outgoing patch.
    flux: [Vec<[f64; N]>; 2],
}

impl<const N: usize> Collector<N> for Histogram<'_, N> {
    fn collect(&mut self, scatter: Scatter, _incident: Disk, outgoing: Disk, _beam: bool, weight: &[f64; N]) {
        let cell = &mut self.flux[scatter as usize][self.basis.patch_of(outgoing)];
        for (c, w) in cell.iter_mut().zip(weight) {
            *c += w;
        }
    }
}

/// What one incident patch gave.
struct Unit<const N: usize> {
    /// By scatter and outgoing patch.
    moments: [Vec<[Moments; N]>; 2],
    balance: Balance<N>,
}

impl Goniophotometer {
    /// Measures a sample.
    pub fn measure(&self, sample: &Sample, progress: &Progress) -> Result<Measured> {
        if self.replications < 2 || self.paths == 0 {
            return Err(Error::Argument(
                "a measurement needs two replications or more, of one path or more each".into(),
            ));
        }
        match sample.bands.len() {
            0 => Err(Error::Missing("the sample has no bands (name at least one)".into())),
            1 => self.run::<1>(sample, progress),
            2 => self.run::<2>(sample, progress),
            3 => self.run::<3>(sample, progress),
            4 => self.run::<4>(sample, progress),
            n => Err(Error::Unsupported(format!("{n} bands in one run"))),
        }
    }

    fn run<const N: usize>(&self, sample: &Sample, progress: &Progress) -> Result<Measured> {
        let area = sample.area()?;
        let patches = self.incident.len();
        let work: Vec<(Side, usize)> = self
            .sides
            .iter()
            .flat_map(|&s| (0..patches).map(move |p| (s, p)))
            .collect();
        progress.expect(work.len());
        let units: Vec<Unit<N>> = work
            .par_iter()
            .map(|&(side, patch)| {
                let unit = self.unit(sample, area, side, patch);
                progress.step().map(|()| unit)
            })
            .collect::<Result<_>>()?;
        let mut balance = Balance::default();
        for unit in &units {
            balance.merge(&unit.balance);
        }
        let bands = sample
            .bands
            .iter()
            .enumerate()
            .map(|(b, name)| self.band(b, name, &units))
            .collect::<Result<_>>()?;
        Ok(Measured {
            bsdf: Bsdf::new(bands, Metadata::default())?,
            balance: (0..N)
                .map(|b| {
                    let Balance {
                        traced,
                        transmitted,
                        reflected,
                        absorbed,
                        roulette,
                        cut_off,
                        lost,
                    } = balance;
                    [traced, transmitted, reflected, absorbed, roulette, cut_off, lost].map(|tally| tally[b])
                })
                .collect(),
        })
    }

    fn unit<const N: usize>(&self, sample: &Sample, area: Area, side: Side, patch: usize) -> Unit<N> {
        let n_out = self.outgoing.len();
        let mut unit = Unit {
            moments: [(); 2].map(|()| vec![[Moments::default(); N]; n_out]),
            balance: Balance::default(),
        };
        let mut flight = Flight::<N>::new(sample, area, self.limits);
        let mut histogram = Histogram {
            basis: &self.outgoing,
            flux: [(); 2].map(|()| vec![[0.0; N]; n_out]),
        };
        for replication in 0..self.replications {
            let key = mix(mix(mix(self.seed) ^ (patch as u64) << 1 ^ side as u64) ^ u64::from(replication));
            let incident = |u| self.incident.sample_cosine(patch, u);
            flight.run(side, key, 0..self.paths, incident, &mut histogram, &mut unit.balance);
            for (moments, flux) in unit.moments.iter_mut().zip(&mut histogram.flux) {
                for (m, f) in moments.iter_mut().zip(flux) {
                    for b in 0..N {
                        m[b].add(f[b] / f64::from(self.paths));
                    }
                    *f = [0.0; N];
                }
            }
        }
        unit
    }

    fn band<const N: usize>(&self, b: usize, name: &str, units: &[Unit<N>]) -> Result<Band> {
        let mut band = Band::new(name);
        for (units, &side) in units.chunks(self.incident.len()).zip(&self.sides) {
            for scatter in Scatter::BOTH {
                let mut values = Vec::with_capacity(units.len() * self.outgoing.len());
                let mut errors = Vec::with_capacity(values.capacity());
                for unit in units {
                    for (o, m) in unit.moments[scatter as usize].iter().enumerate() {
                        let [mean, error] = m[b].mean(self.replications);
                        let area = self.outgoing.projected_solid_angle(o);
                        values.push(mean / area);
                        errors.push(error / area);
                    }
                }
                let matrix = Matrix::new(self.incident.clone(), self.outgoing.clone(), values)?;
                band.set(
                    side,
                    scatter,
                    Some(Arc::new(Model::Matrix(matrix.with_standard_errors(errors)?))),
                );
            }
        }
        Ok(band)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{Part, Scatterer};
    use crate::geometry::{Geometry, Piece, Profile};
    use crate::material::{Material, Medium, Surface};

    fn blind(reflectance: f64) -> Sample {
        let piece = Piece {
            from: [-0.04, 0.0],
            to: [0.04, 0.0],
            turn: 0.0,
            surface: 0,
        };
        let profile = Profile::new(vec![piece], 0.072).expect("a sound profile");
        Sample {
            bands: vec!["visible".into()],
            layers: vec![Box::new(profile) as Box<dyn Geometry>],
            surfaces: vec![Surface {
                materials: [0, 0],
                media: [0, 0],
            }],
            materials: vec![Material::Lambertian {
                reflectance: vec![reflectance],
                transmittance: vec![0.0],
            }],
            media: vec![Medium::air(1)],
        }
    }

    #[test]
    fn flat_slats_of_the_round_robin_pass_what_radiosity_says() {
        let instrument = Goniophotometer {
            incident: Arc::new(Basis::klems_full()),
            outgoing: Arc::new(Basis::klems_full()),
            sides: vec![Side::Exterior],
            replications: 16,
            paths: 256,
            seed: 1,
            limits: Limits::default(),
        };
        for (reflectance, expected) in [(0.0, 0.383_74), (0.5, 0.480_36), (0.7, 0.538_47)] {
            let measured = instrument
                .measure(&blind(reflectance), &Progress::default())
                .expect("it runs");
            let model = measured
                .bsdf
                .component(None, Side::Exterior, Scatter::Transmission)
                .expect("is there");
            let areas = instrument.incident.projected_solid_angles();
            let t: f64 = areas
                .iter()
                .enumerate()
                .map(|(p, a)| a * model.component.total(instrument.incident.centre(p), Part::All).value)
                .sum::<f64>()
                / std::f64::consts::PI;
            // Radiosity of 400 strips a face.
            assert!(
                (t - expected).abs() < 0.001,
                "{reflectance}: {t} {:?}",
                measured.balance
            );
            let [traced, rest @ ..] = measured.balance[0];
            assert!((rest.iter().sum::<f64>() / traced - 1.0).abs() < 1e-9);
        }
    }
}
