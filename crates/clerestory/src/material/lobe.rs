//! Lobes about the specular direction, mirrored and straight on, that depend on the distance from it in direction cosines,
//! together with even scattering.
//!
//! * Gaussian: exp(-u²/2w²).
//! * ABg: 1/(B + u^g), Harvey and Shack's model with three parameters (Harvey 1976; Stover, Optical Scattering). A is what
//!   makes the integral right.
//!
//! At every incident direction each lobe is scaled so that it carries its hemispherical value, so energy is conserved. Where
//! it is cut by the horizon that scale depends on the incident direction alone, and reciprocity is lost.

use std::f64::consts::{PI, TAU};

use super::choice::{chances, choose};
use super::lambertian::{self, diffuse};
use super::{Arrival, Departure, Draws, check};
use crate::error::Result;
use crate::geometry::Vec3;

/// How a lobe falls off.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Gaussian { width: f64 },
    Abg(Abg),
}

/// ABg with the integral of it times u, for its inversion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Abg {
    b: f64,
    g: f64,
    /// Distances, from 0 to 2.
    edges: Vec<f64>,
    /// Integral up to there.
    sums: Vec<f64>,
}

/// Cells of the table of ABg.
const CELLS: i32 = 2048;

impl Abg {
    fn new(b: f64, g: f64) -> Self {
        // Equal ratios from well within the shoulder to the other end of the disk.
        let shoulder = if g > 0.0 { b.powf(1.0 / g) } else { 1.0 };
        let least = (shoulder * 1e-2).clamp(1e-9, 1e-2);
        let ratio = (2.0 / least).powf(1.0 / f64::from(CELLS - 1));
        let mut edges = vec![0.0];
        edges.extend((0..CELLS).map(|k| least * ratio.powi(k)));
        let mut abg = Self {
            b,
            g,
            edges,
            sums: vec![0.0],
        };
        abg.sums = std::iter::once(0.0)
            .chain(abg.edges.windows(2).scan(0.0, |sum, cell| {
                // Gauss-Legendre, three points.
                let (middle, half) = (0.5 * (cell[0] + cell[1]), 0.5 * (cell[1] - cell[0]));
                let off = half * 0.6_f64.sqrt();
                let at = |u: f64| u * abg.value(u);
                *sum += half / 9.0 * (5.0 * at(middle - off) + 8.0 * at(middle) + 5.0 * at(middle + off));
                Some(*sum)
            }))
            .collect();
        abg
    }

    fn value(&self, u: f64) -> f64 {
        1.0 / (self.b + u.powf(self.g))
    }

    fn cell(&self, u: f64) -> usize {
        (self.edges.partition_point(|e| *e <= u).max(1) - 1).min(self.edges.len() - 2)
    }

    fn integral(&self, u: f64) -> f64 {
        let k = self.cell(u);
        let (low, high) = (self.edges[k], self.edges[k + 1]);
        let share = (u * u - low * low) / (high * high - low * low);
        self.sums[k] + share * (self.sums[k + 1] - self.sums[k])
    }

    /// What stands for the lobe where directions are drawn: its mean over the cell.
    fn drawn(&self, u: f64) -> f64 {
        let k = self.cell(u);
        (self.sums[k + 1] - self.sums[k]) * 2.0 / (self.edges[k + 1].powi(2) - self.edges[k].powi(2))
    }

    /// A distance up to `most`, and the lobe there over the density that it is drawn with, which is even within a cell.
    fn sample(&self, most: f64, xi: f64) -> (f64, f64) {
        let target = xi * self.integral(most);
        let k = (self.sums.partition_point(|s| *s <= target).max(1) - 1).min(self.edges.len() - 2);
        let (low, high) = (self.edges[k].powi(2), self.edges[k + 1].powi(2));
        let sum = self.sums[k + 1] - self.sums[k];
        let u = (low + (target - self.sums[k]) / sum * (high - low)).max(0.0).sqrt();
        (u, self.value(u) * 0.5 * (high - low) / sum)
    }
}

impl Shape {
    fn value(&self, u: f64) -> f64 {
        match self {
            Self::Gaussian { width } => (-0.5 * (u / width).powi(2)).exp(),
            Self::Abg(abg) => abg.value(u),
        }
    }

    /// Integral of the lobe times u, from 0.
    fn integral(&self, u: f64) -> f64 {
        match self {
            Self::Gaussian { width } => -width * width * (-0.5 * (u / width).powi(2)).exp_m1(),
            Self::Abg(abg) => abg.integral(u),
        }
    }

    /// The lobe as it is drawn; its integral is that of [`Shape::integral`].
    fn drawn(&self, u: f64) -> f64 {
        match self {
            Self::Gaussian { .. } => self.value(u),
            Self::Abg(abg) => abg.drawn(u),
        }
    }

    /// A distance up to `most` and the weight that it has.
    fn sample(&self, most: f64, xi: f64) -> (f64, f64) {
        match self {
            Self::Gaussian { width } => {
                let share = -(-0.5 * (most / width).powi(2)).exp_m1();
                (width * (-2.0 * (-xi * share).ln_1p()).sqrt(), 1.0)
            }
            Self::Abg(abg) => abg.sample(most, xi),
        }
    }
}

/// A lobe, mirrored and straight on, with even scattering.
#[derive(Debug, Clone, PartialEq)]
pub struct Lobe {
    pub(super) shape: Shape,
    /// Hemispherical values by way, a band each.
    pub(super) values: [Vec<f64>; 4],
    /// Integral of the lobe over the disk, at equal steps of the incident cosine.
    pub(super) integrals: Vec<f64>,
}

const DIFFUSE_BACK: usize = 0;
const DIFFUSE_ON: usize = 1;
const LOBE_BACK: usize = 2;
const LOBE_ON: usize = 3;
/// Steps of the incident cosine.
const STEPS: usize = 512;
/// Steps of the azimuth about the specular direction, over half of it.
const AZIMUTHS: u32 = 512;
/// A direction that lies outside of the disk is drawn anew; at least a quarter of them lie within.
const TRIES: u32 = 100;

/// Hemispherical values, a band each.
#[derive(Debug, Clone, Copy)]
pub struct LobeValues<'a> {
    /// Of the lobe about the mirrored direction.
    pub reflectance: &'a [f64],
    /// Of the lobe straight on.
    pub transmittance: &'a [f64],
    /// Of even scattering back.
    pub diffuse_reflectance: &'a [f64],
    /// Of even scattering to the other side.
    pub diffuse_transmittance: &'a [f64],
}

impl Lobe {
    pub(super) fn gaussian(width: f64, values: LobeValues<'_>) -> Result<Self> {
        check::positive("gaussian", "width", width)?;
        Self::new("gaussian", Shape::Gaussian { width }, values)
    }

    pub(super) fn abg(b: f64, g: f64, values: LobeValues<'_>) -> Result<Self> {
        check::positive("abg", "B", b)?;
        check::number("abg", "g", g, 0.0, 20.0)?;
        Self::new("abg", Shape::Abg(Abg::new(b, g)), values)
    }

    fn new(kind: &str, shape: Shape, values: LobeValues<'_>) -> Result<Self> {
        check::shares(
            kind,
            &[
                ("reflectance", values.reflectance),
                ("transmittance", values.transmittance),
                ("diffuse reflectance", values.diffuse_reflectance),
                ("diffuse transmittance", values.diffuse_transmittance),
            ],
        )?;
        let integrals = (0..=STEPS)
            .map(|k| {
                let cos = k as f64 / STEPS as f64;
                let sin = (1.0 - cos * cos).max(0.0).sqrt();
                let sum: f64 = (0..AZIMUTHS)
                    .map(|j| {
                        let (s, c) = ((f64::from(j) + 0.5) * PI / f64::from(AZIMUTHS)).sin_cos();
                        let far = (1.0 - (sin * s).powi(2)).max(0.0).sqrt() - sin * c;
                        shape.integral(far.max(0.0))
                    })
                    .sum();
                TAU * sum / f64::from(AZIMUTHS)
            })
            .collect();
        Ok(Self {
            shape,
            values: [
                values.diffuse_reflectance.to_vec(),
                values.diffuse_transmittance.to_vec(),
                values.reflectance.to_vec(),
                values.transmittance.to_vec(),
            ],
            integrals,
        })
    }

    /// Number of bands.
    pub(super) fn bands(&self) -> usize {
        self.values[0].len()
    }

    /// Integral of the lobe over the disk.
    fn integral(&self, arrival: &Arrival<'_>) -> f64 {
        let x = arrival.cos() * STEPS as f64;
        let k = (x as usize).min(STEPS - 1);
        let t = x - k as f64;
        self.integrals[k] * (1.0 - t) + self.integrals[k + 1] * t
    }

    pub(super) fn evaluate<const N: usize>(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
        let (even, lobe) = if outgoing.dot(arrival.normal) > 0.0 {
            (DIFFUSE_BACK, LOBE_BACK)
        } else {
            (DIFFUSE_ON, LOBE_ON)
        };
        let shape = self.shape.value(distance(arrival, outgoing)) / self.integral(arrival);
        std::array::from_fn(|b| self.values[even][b] / PI + self.values[lobe][b] * shape)
    }

    /// Density of departures (1/sr).
    pub(super) fn density<const N: usize>(&self, arrival: &Arrival<'_>, weight: &[f64; N], outgoing: Vec3) -> f64 {
        let chances = chances(weight, &self.ways());
        let even = lambertian::density([chances[DIFFUSE_BACK], chances[DIFFUSE_ON]], arrival, outgoing);
        let cos_out = outgoing.dot(arrival.normal);
        let lobe = chances[if cos_out > 0.0 { LOBE_BACK } else { LOBE_ON }];
        even + lobe * self.shape.drawn(distance(arrival, outgoing)) / self.integral(arrival) * cos_out.abs()
    }

    /// Shares of light that go each way, a band each.
    fn ways<const N: usize>(&self) -> [[f64; N]; 4] {
        std::array::from_fn(|way| std::array::from_fn(|b| self.values[way][b]))
    }

    pub(super) fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<Departure> {
        let ways = self.ways::<N>();
        for b in 0..N {
            absorbed[b] = weight[b] * (1.0 - ways.iter().map(|way| way[b]).sum::<f64>());
        }
        let u = [draws.next(), draws.next()];
        let way = choose(weight, &ways, draws)?;
        let passes = way == DIFFUSE_ON || way == LOBE_ON;
        if way < LOBE_BACK {
            return Some(diffuse(arrival, passes, u));
        }
        let [s, t] = arrival.normal.frame();
        let from = [arrival.direction.dot(s), arrival.direction.dot(t)];
        let most = 1.0 + from[0].hypot(from[1]);
        let mut u = u;
        for _ in 0..TRIES {
            let (distance, factor) = self.shape.sample(most, u[0]);
            let (sin, cos) = (TAU * u[1] - PI).sin_cos();
            let (x, y) = (from[0] + distance * cos, from[1] + distance * sin);
            let z2 = 1.0 - x * x - y * y;
            if z2 > 1e-12 {
                for w in weight.iter_mut() {
                    *w *= factor;
                }
                let z = if passes { -z2.sqrt() } else { z2.sqrt() };
                return Some(Departure {
                    direction: (s * x + t * y + arrival.normal * z).unit(),
                    passes,
                    specular: false,
                });
            }
            u = [draws.next(), draws.next()];
        }
        None
    }
}

/// Distance of a direction from the specular one, in direction cosines.
fn distance(arrival: &Arrival<'_>, outgoing: Vec3) -> f64 {
    let off = outgoing - arrival.direction;
    (off - arrival.normal * off.dot(arrival.normal)).length()
}
