//! The few things that every scattering model offers.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::turned::Turn;
use crate::basis::Basis;
use crate::direction::{Direction, Disk, Side};
use crate::sequence::r2;

/// An ideal or near-ideal beam among scattered light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// Direction of travel that it leaves with.
    pub outgoing: Disk,
    /// Transmittance or reflectance that it carries.
    pub value: f64,
    /// Full angular width (radians); 0 for an ideal one.
    pub extent: f64,
}

impl Peak {
    /// The one ideal peak of a beam that keeps its direction of travel on the disk; none where it carries nothing.
    pub(super) fn straight(incident: Disk, value: f64) -> Vec<Self> {
        if value <= 0.0 {
            return Vec::new();
        }
        vec![Self {
            outgoing: incident,
            value,
            extent: 0.0,
        }]
    }
}

/// A sampled outgoing direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sample {
    /// Direction of travel.
    pub outgoing: Disk,
    /// BSDF times cosine over density; for a peak its value over its probability. Its mean is the
    /// direct-hemispherical value.
    pub weight: f64,
    /// Whether it is a peak rather than scattered light.
    pub peak: bool,
}

impl Sample {
    /// The only sample of such a beam.
    pub(super) fn straight(incident: Disk, weight: f64) -> Option<Self> {
        (weight > 0.0).then_some(Self {
            outgoing: incident,
            weight,
            peak: true,
        })
    }
}

/// Which light to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Part {
    /// Scattered light and peaks.
    #[default]
    All,
    /// Without peaks.
    Scattered,
    /// Peaks alone.
    Direct,
}

/// A value, with its standard error where one is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The value.
    pub value: f64,
    /// One standard deviation of it.
    pub standard_error: Option<f64>,
}

impl From<f64> for Estimate {
    fn from(value: f64) -> Self {
        Self {
            value,
            standard_error: None,
        }
    }
}

/// A set of outgoing directions.
#[derive(Debug, Clone)]
pub enum Region {
    /// All of them.
    Hemisphere,
    /// Within `half_angle` (radians) of an axis.
    Cone {
        /// The middle.
        axis: Disk,
        /// Half of the opening angle (radians).
        half_angle: f64,
    },
    /// Between two angles (radians) from an axis. Rings that join sum to the cone that they fill.
    Ring {
        /// The middle.
        axis: Disk,
        /// Inner angle (radians).
        inner: f64,
        /// Outer angle (radians).
        outer: f64,
    },
    /// Patches of a basis.
    Patches {
        /// The basis.
        basis: Arc<Basis>,
        /// 0-based patches.
        patches: Vec<usize>,
        /// The basis is turned by this against the sample.
        turn: Turn,
    },
}

impl Region {
    /// Patches of a basis in the sample's frame.
    pub fn patches(basis: Arc<Basis>, patches: Vec<usize>) -> Self {
        Self::Patches {
            basis,
            patches,
            turn: Turn::NONE,
        }
    }

    /// Whether a direction lies in it.
    pub fn contains(&self, point: Disk) -> bool {
        match self {
            Self::Hemisphere => true,
            Self::Cone { axis, half_angle } => axis.angle_to(point) < *half_angle,
            Self::Ring { axis, inner, outer } => {
                let angle = axis.angle_to(point);
                *inner <= angle && angle < *outer
            }
            Self::Patches { basis, patches, turn } => patches.contains(&basis.patch_of(turn.inverse().apply(point))),
        }
    }
}

/// A model of one component: light from one side of a sample, transmitted or reflected.
///
/// Directions are disk points of travel. Values are per unit of incident irradiance on the sample's plane.
pub trait Scatterer: Send + Sync {
    /// BSDF of the scattered part (1/sr); peaks are not in it.
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64;

    /// The same of several outgoing directions, into as many `values`.
    fn evaluate_all(&self, incident: Disk, outgoing: &[Disk], values: &mut [f64]) {
        for (value, &out) in values.iter_mut().zip(outgoing) {
            *value = self.evaluate(incident, out);
        }
    }

    /// The peaks for light from one direction.
    fn peaks(&self, incident: Disk) -> Vec<Peak>;

    /// An outgoing direction for `u` in [0, 1)². None where nothing leaves. A peak is chosen with the probability that is
    /// its share of the total.
    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample>;

    /// Density with which [`Scatterer::sample`] gives a scattered direction (1/sr); it integrates to 1 less the
    /// probability of the peaks.
    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64;

    /// Direct-hemispherical transmittance or reflectance.
    fn total(&self, incident: Disk, part: Part) -> Estimate;

    /// The share that the model is given where several are sampled together. By default its total, which is best; where
    /// that is dear, anything greater than 0 that is near to it is right too.
    fn weight(&self, incident: Disk) -> f64 {
        self.total(incident, Part::All).value
    }

    /// Full angle (radians) below which detail is not resolved; 0 for a model without a grid.
    fn resolution(&self, incident: Disk) -> f64;

    /// Flux into a region per unit of incident flux.
    fn integrate(&self, incident: Disk, region: &Region, part: Part) -> Estimate {
        if matches!(region, Region::Hemisphere) {
            return self.total(incident, part);
        }
        let mut value = 0.0;
        if part != Part::Direct {
            value += integrate_scattered(self, incident, region);
        }
        if part != Part::Scattered {
            value += self
                .peaks(incident)
                .iter()
                .filter(|p| region.contains(p.outgoing))
                .map(|p| p.value)
                .sum::<f64>();
        }
        value.into()
    }
}

/// Integrates over a region: smooth light by low-discrepancy points, and what stands out of it, and may be narrower than the
/// points' distance, by samples of the model, which find it.
pub(super) fn integrate_scattered<S: Scatterer + ?Sized>(model: &S, incident: Disk, region: &Region) -> f64 {
    const PATCH_POINTS: u32 = 1024;
    match region {
        Region::Hemisphere => model.total(incident, Part::Scattered).value,
        Region::Cone { axis, half_angle } => cone(model, incident, *axis, *half_angle),
        Region::Ring { axis, inner, outer } => {
            cone(model, incident, *axis, *outer) - cone(model, incident, *axis, *inner)
        }
        Region::Patches { basis, patches, turn } => {
            let total = model.total(incident, Part::Scattered).value;
            let level = STANDS_OUT * total / PI;
            let smooth: f64 = patches
                .iter()
                .map(|&p| {
                    let sum: f64 = (0..PATCH_POINTS)
                        .map(|k| {
                            let point = basis.sample_cosine(p, r2(k, [0.0; 2]));
                            model.evaluate(incident, turn.apply(point)).min(level)
                        })
                        .sum();
                    sum / f64::from(PATCH_POINTS) * basis.projected_solid_angle(p)
                })
                .sum();
            let rest = total - by_points(model, incident, Disk::NORMAL, PI / 2.0, level);
            smooth + rest * share_above(model, incident, region, level)
        }
    }
}

/// Light stands out where the BSDF is above so many times its mean over the hemisphere.
const STANDS_OUT: f64 = 1.0;

/// Share of what the BSDF has above a level that leaves into a region: ∫ max(f − level, 0) cosθ dω there, over that of the
/// hemisphere. Samples find it however narrow it is, and the shares of a partition sum to 1.
fn share_above<S: Scatterer + ?Sized>(model: &S, incident: Disk, region: &Region, level: f64) -> f64 {
    const SAMPLES: u32 = 1 << 13;
    let (mut inside, mut all) = (0.0, 0.0);
    for k in 0..SAMPLES {
        let Some(sample) = model.sample(incident, r2(k, [0.0; 2])).filter(|s| !s.peak) else {
            continue;
        };
        let value = model.evaluate(incident, sample.outgoing);
        if value > level {
            let excess = sample.weight * (1.0 - level / value);
            all += excess;
            if region.contains(sample.outgoing) {
                inside += excess;
            }
        }
    }
    if all > 0.0 { inside / all } else { 0.0 }
}

/// ∫ f cosθ dω over the part of a cone that is above the horizon.
fn cone<S: Scatterer + ?Sized>(model: &S, incident: Disk, axis: Disk, half_angle: f64) -> f64 {
    /// A cone that is no wider than so many cells is resolved by its points.
    const NARROW: f64 = 1.5;
    if half_angle <= 0.0 {
        return 0.0;
    }
    let everything = PI / 2.0 + axis.theta();
    if half_angle >= everything {
        return model.total(incident, Part::Scattered).value;
    }
    if half_angle <= NARROW * model.resolution(incident) {
        return by_points(model, incident, axis, half_angle, f64::INFINITY);
    }
    let total = model.total(incident, Part::Scattered).value;
    let level = STANDS_OUT * total / PI;
    let region = Region::Cone { axis, half_angle };
    let rest = total - by_points(model, incident, axis, everything, level);
    by_points(model, incident, axis, half_angle, level) + rest * share_above(model, incident, &region, level)
}

/// ∫ min(f, level) cosθ dω over the part of a cone that is above the horizon.
fn by_points<S: Scatterer + ?Sized>(model: &S, incident: Disk, axis: Disk, half_angle: f64, level: f64) -> f64 {
    const POINTS: u32 = 1 << 13;
    let w = axis.outgoing(Side::Interior);
    // Two axes across the cone's.
    let (sin_phi, cos_phi) = axis.phi().sin_cos();
    let u = [w.z * cos_phi, w.z * sin_phi, -(w.x * cos_phi + w.y * sin_phi)];
    let v = [-sin_phi, cos_phi, 0.0];
    let height = 1.0 - half_angle.cos();
    let mut sum = 0.0;
    for k in 0..POINTS {
        // Even in solid angle.
        let [along, around] = r2(k, [0.0; 2]);
        let cos = 1.0 - along * height;
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let (s, c) = (TAU * around).sin_cos();
        let d = Direction {
            x: sin * (c * u[0] + s * v[0]) + cos * w.x,
            y: sin * (c * u[1] + s * v[1]) + cos * w.y,
            z: sin * (c * u[2] + s * v[2]) + cos * w.z,
        };
        if d.z > 0.0 {
            sum += model.evaluate(incident, d.outgoing_disk()).min(level) * d.z;
        }
    }
    sum * height * TAU / f64::from(POINTS)
}
