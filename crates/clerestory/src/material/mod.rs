//! What a surface does with light, and what lies between surfaces.
//!
//! * [`Material`]: scattering at a surface.
//! * [`Medium`]: what fills the space on a side of a surface: air, glass, an opal volume.
//! * [`Surface`]: a material for each face, a medium on each side.
//!
//! Every property has one value a band; all bands travel in one path.

mod check;
mod choice;
mod draws;
mod ggx;
mod glossy;
mod haze;
mod interface;
mod lambertian;
mod lobe;
mod measured;
mod medium;
mod microfacet;
mod mixture;
mod padding;
mod pane;
mod polarisation;
mod rough_interface;

pub use draws::Draws;
pub use ggx::Ggx;
pub use glossy::Glossy;
pub use interface::fresnel;
pub use lambertian::cosine;
pub use lobe::{Lobe, LobeValues};
pub use measured::Measured;
pub use medium::{Medium, henyey_greenstein};
pub use mixture::Mixture;
pub use polarisation::Polarisation;

use crate::bsdf::{Bsdf, Slab};
use crate::direction::Side;
use crate::error::Result;
use crate::geometry::Vec3;

/// What a face of a surface does with light. Spectral values are one a band.
#[derive(Debug, Clone)]
pub enum Material {
    /// Absorbs everything.
    Black,
    /// Scatters evenly to both sides.
    Lambertian {
        /// Share that returns.
        reflectance: Vec<f64>,
        /// Share that passes.
        transmittance: Vec<f64>,
    },
    /// Reflects like a mirror.
    Mirror {
        /// Share that returns.
        reflectance: Vec<f64>,
    },
    /// Smooth border of two media: Fresnel's equations.
    Interface,
    /// Radiance's plastic, metal or trans.
    Glossy(Box<Glossy>),
    /// Radiance's glass: a thin pane that light passes straight, one a band.
    Pane(Vec<Slab>),
    /// Rough border of two media, of this roughness.
    RoughInterface(f64),
    /// Rough conductor.
    Ggx(Box<Ggx>),
    /// Gaussian or ABg lobe and even scattering.
    Lobe(Box<Lobe>),
    /// A side of a data set.
    Measured(Box<Measured>),
    /// A sum of materials.
    Mixture(Box<Mixture>),
}

/// A surface: the material that light from the front meets and that light from the back meets, and the media there.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Number of the material of the front and of the back in the sample's list.
    pub materials: [u32; 2],
    /// Number of the medium before the front and behind the back in the sample's list.
    pub media: [u16; 2],
}

/// Light that arrives at a surface.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<'a> {
    /// Unit vector of travel.
    pub direction: Vec3,
    /// Unit normal on the side that it arrives from: `direction · normal` is not above 0.
    pub normal: Vec3,
    /// The medium that it comes through.
    pub here: &'a Medium,
    /// The medium on the other side.
    pub beyond: &'a Medium,
}

/// Light that goes on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Departure {
    /// Unit vector of travel.
    pub direction: Vec3,
    /// It goes to the other side.
    pub passes: bool,
    /// It stays a beam: mirrored, refracted, or straight on.
    pub specular: bool,
}

/// A beam that leaves a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Beam<const N: usize> {
    /// Unit vector of travel.
    pub direction: Vec3,
    /// It goes to the other side.
    pub passes: bool,
    /// Share of the light, a band each.
    pub value: [f64; N],
}

impl Arrival<'_> {
    /// Cosine of the angle of incidence.
    #[inline]
    pub fn cos(&self) -> f64 {
        (-self.direction.dot(self.normal)).clamp(0.0, 1.0)
    }
}

/// How materials are made. All are refused with the name of the parameter and the band where no material has such values.
impl Material {
    /// Scatters evenly: shares of light that return and that pass, one a band each.
    pub fn lambertian(reflectance: &[f64], transmittance: &[f64]) -> Result<Self> {
        check::shares(
            "lambertian",
            &[("reflectance", reflectance), ("transmittance", transmittance)],
        )?;
        Ok(Self::Lambertian {
            reflectance: reflectance.to_vec(),
            transmittance: transmittance.to_vec(),
        })
    }

    /// Reflects like a mirror: share of light that returns, one a band.
    pub fn mirror(reflectance: &[f64]) -> Result<Self> {
        check::shares("mirror", &[("reflectance", reflectance)])?;
        Ok(Self::Mirror {
            reflectance: reflectance.to_vec(),
        })
    }

    /// Radiance's plastic: colour, one a band, specularity and roughness. The specular part has no colour.
    pub fn plastic(colour: &[f64], specularity: f64, roughness: f64) -> Result<Self> {
        let glossy = Glossy::new("plastic", colour, [specularity, roughness], [0.0; 2])?;
        Ok(Self::Glossy(Box::new(glossy)))
    }

    /// Radiance's metal: colour, one a band, specularity and roughness. The specular part has the colour, too.
    pub fn metal(colour: &[f64], specularity: f64, roughness: f64) -> Result<Self> {
        let glossy = Glossy::new("metal", colour, [specularity, roughness], [0.0; 2])?;
        Ok(Self::Glossy(Box::new(glossy)))
    }

    /// Radiance's trans: colour, one a band, specularity, roughness, transmission (share of what is not specularly reflected
    /// that passes) and transmitted specularity (share of it that is not spread evenly).
    pub fn trans(
        colour: &[f64],
        specularity: f64,
        roughness: f64,
        transmission: f64,
        transmitted_specularity: f64,
    ) -> Result<Self> {
        let passes = [transmission, transmitted_specularity];
        let glossy = Glossy::new("trans", colour, [specularity, roughness], passes)?;
        Ok(Self::Glossy(Box::new(glossy)))
    }

    /// Radiance's glass: a thin pane of a transmissivity (transmittance of one pass along the normal between the faces), one
    /// a band, and a refractive index (1.52 where a scene does not say).
    pub fn glass(transmissivity: &[f64], index: f64) -> Result<Self> {
        pane::slabs(transmissivity, index).map(Self::Pane)
    }

    /// Border of two media whose facets have the distribution GGX: roughness (alpha of Walter et al. 2007), 0 for a smooth one.
    pub fn rough_interface(roughness: f64) -> Result<Self> {
        check::number("rough interface", "roughness", roughness, 0.0, 1.0)?;
        Ok(if roughness <= microfacet::SMOOTH {
            Self::Interface
        } else {
            Self::RoughInterface(roughness)
        })
    }

    /// Conductor whose facets have the distribution GGX: reflectance of a facet at normal incidence, one a band, and
    /// roughness (alpha), 0 for a smooth one.
    pub fn ggx(reflectance: &[f64], roughness: f64) -> Result<Self> {
        Ok(Self::Ggx(Box::new(Ggx::new(reflectance, roughness)?)))
    }

    /// Gaussian lobe of a standard deviation in direction cosines, and even scattering.
    pub fn gaussian(width: f64, values: LobeValues<'_>) -> Result<Self> {
        Ok(Self::Lobe(Box::new(Lobe::gaussian(width, values)?)))
    }

    /// ABg lobe and even scattering.
    pub fn abg(b: f64, g: f64, values: LobeValues<'_>) -> Result<Self> {
        Ok(Self::Lobe(Box::new(Lobe::abg(b, g, values)?)))
    }

    /// The face of a data set that is its `side`, with its y axis as near to `up` as the surface lets it be. Bands as in
    /// [`Bsdf::band`], one for each that is traced.
    pub fn measured(bsdf: &Bsdf, bands: &[Option<&str>], side: Side, up: Vec3) -> Result<Self> {
        Ok(Self::Measured(Box::new(Measured::new(bsdf, bands, side, up)?)))
    }

    /// Materials with their shares, which sum to 1 at most; the rest is black.
    pub fn mixture(parts: Vec<(f64, Self)>) -> Result<Self> {
        Ok(Self::Mixture(Box::new(Mixture::new(parts)?)))
    }

    /// How many bands it is made for; None where any number will do.
    pub fn bands(&self) -> Option<usize> {
        match self {
            Self::Black | Self::Interface | Self::RoughInterface(_) => None,
            Self::Lambertian { reflectance, .. } | Self::Mirror { reflectance } => Some(reflectance.len()),
            Self::Glossy(glossy) => Some(glossy.bands()),
            Self::Pane(slabs) => Some(slabs.len()),
            Self::Ggx(ggx) => Some(ggx.bands()),
            Self::Lobe(lobe) => Some(lobe.bands()),
            Self::Measured(measured) => Some(measured.bands()),
            Self::Mixture(mixture) => mixture.bands(),
        }
    }
}

/// What materials do.
impl Material {
    /// One way on for light, drawn at random. `weight` is what the light carries; it is multiplied so that its mean is what
    /// goes on, `polarisation` becomes what leaves, and `absorbed` is set to what stays, the same mean exactly known where
    /// there is a formula. None when nothing goes on.
    pub fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        polarisation: &mut Polarisation<N>,
        draws: &mut Draws,
    ) -> Option<Departure> {
        if !matches!(self, Self::Interface) {
            *polarisation = Polarisation::NONE;
        }
        match self {
            Self::Black => {
                *absorbed = *weight;
                None
            }
            Self::Lambertian {
                reflectance,
                transmittance,
            } => lambertian::scatter(reflectance, transmittance, arrival, weight, absorbed, draws),
            Self::Mirror { reflectance } => {
                for b in 0..N {
                    absorbed[b] = weight[b] * (1.0 - reflectance[b]);
                    weight[b] *= reflectance[b];
                }
                Some(Departure {
                    direction: mirrored(arrival.direction, arrival.normal),
                    passes: false,
                    specular: true,
                })
            }
            Self::Interface => {
                *absorbed = [0.0; N];
                interface::scatter(arrival, weight, polarisation, draws)
            }
            Self::Glossy(glossy) => glossy.scatter(arrival, weight, absorbed, draws),
            Self::Pane(slabs) => pane::scatter(slabs, arrival, weight, absorbed, draws),
            Self::RoughInterface(alpha) => rough_interface::scatter(*alpha, arrival, weight, absorbed, draws),
            Self::Ggx(ggx) => ggx.scatter(arrival, weight, absorbed, draws),
            Self::Lobe(lobe) => lobe.scatter(arrival, weight, absorbed, draws),
            Self::Measured(measured) => measured.scatter(arrival, weight, absorbed, draws),
            Self::Mixture(mixture) => mixture.scatter(arrival, weight, absorbed, draws),
        }
    }

    /// BSDF of the scattered part (1/sr), a band each, for light that leaves along `outgoing`: flux out over flux in, solid
    /// angle and outgoing cosine.
    pub fn evaluate<const N: usize>(&self, arrival: &Arrival<'_>, outgoing: Vec3) -> [f64; N] {
        match self {
            Self::Black | Self::Mirror { .. } | Self::Interface | Self::Pane(_) => [0.0; N],
            Self::Lambertian {
                reflectance,
                transmittance,
            } => lambertian::evaluate(reflectance, transmittance, arrival, outgoing),
            Self::Glossy(glossy) => glossy.evaluate(arrival, outgoing),
            Self::RoughInterface(alpha) => rough_interface::evaluate(*alpha, arrival, outgoing),
            Self::Ggx(ggx) => ggx.evaluate(arrival, outgoing),
            Self::Lobe(lobe) => lobe.evaluate(arrival, outgoing),
            Self::Measured(measured) => measured.evaluate(arrival, outgoing),
            Self::Mixture(mixture) => mixture.evaluate(arrival, outgoing),
        }
    }

    /// Density (1/sr) with which [`Material::scatter`] sends light that carries `weight` along `outgoing`, beams apart; 0 where
    /// it cannot. It integrates to the probability of a departure that is not specular, and there the mean of the weights
    /// along a direction is `weight` times BSDF times cosine over density.
    pub fn density<const N: usize>(&self, arrival: &Arrival<'_>, weight: &[f64; N], outgoing: Vec3) -> f64 {
        match self {
            Self::Black | Self::Mirror { .. } | Self::Interface | Self::Pane(_) => 0.0,
            Self::Lambertian {
                reflectance,
                transmittance,
            } => {
                let ways = [reflectance, transmittance].map(|values| std::array::from_fn(|b| values[b]));
                lambertian::density(choice::chances(weight, &ways), arrival, outgoing)
            }
            Self::Glossy(glossy) => glossy.density(arrival, weight, outgoing),
            Self::RoughInterface(alpha) => rough_interface::density(*alpha, arrival, weight, outgoing),
            Self::Ggx(ggx) => ggx.density(arrival, outgoing),
            Self::Lobe(lobe) => lobe.density(arrival, weight, outgoing),
            Self::Measured(measured) => measured.density(arrival, outgoing),
            Self::Mixture(mixture) => mixture.density(arrival, weight, outgoing),
        }
    }

    /// The beams, mirrored, straight on or refracted.
    pub fn beams<const N: usize>(&self, arrival: &Arrival<'_>) -> Vec<Beam<N>> {
        let two = |[back, on]: [[f64; N]; 2]| {
            let back = Beam {
                direction: mirrored(arrival.direction, arrival.normal),
                passes: false,
                value: back,
            };
            let on = Beam {
                direction: arrival.direction,
                passes: true,
                value: on,
            };
            let some = |beam: &Beam<N>| beam.value.iter().any(|v| *v > 0.0);
            [back, on].into_iter().filter(some).collect()
        };
        match self {
            Self::Mirror { reflectance } => two([std::array::from_fn(|b| reflectance[b]), [0.0; N]]),
            Self::Interface => interface::beams(arrival),
            Self::Glossy(glossy) => two(glossy.beams(arrival)),
            Self::Pane(slabs) => two(pane::values(slabs, arrival)),
            Self::RoughInterface(alpha) if rough_interface::is_smooth::<N>(*alpha, arrival) => {
                interface::beams(arrival)
            }
            Self::Black | Self::Lambertian { .. } | Self::Lobe(_) | Self::RoughInterface(_) => Vec::new(),
            Self::Ggx(ggx) => two([ggx.beam(arrival), [0.0; N]]),
            Self::Measured(measured) => measured.beams(arrival),
            Self::Mixture(mixture) => mixture.beams(arrival),
        }
    }
}

/// Mirrored in the plane of a normal.
pub fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * (2.0 * direction.dot(normal))).unit()
}
