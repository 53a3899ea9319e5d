//! What a surface does with light, and what lies between surfaces.
//!
//! * [`Material`]: scattering at a surface.
//! * [`Medium`]: what fills the space on a side of a surface: air, glass, an opal volume.
//! * [`Surface`]: a material for each face, a medium on each side.
//!
//! Every property has one value a band; all bands travel in one path.

mod draws;
mod interface;

pub use draws::Draws;

use std::f64::consts::{PI, TAU};

use crate::geometry::Vec3;

/// What fills the space between surfaces.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// Refractive index, one a band.
    pub index: Vec<f64>,
    /// Absorption coefficient (1/m), one a band.
    pub absorption: Vec<f64>,
}

impl Medium {
    /// Air: index 1, clear.
    pub fn air(bands: usize) -> Self {
        Self {
            index: vec![1.0; bands],
            absorption: vec![0.0; bands],
        }
    }
}

/// What a face of a surface does with light. Spectral values are one a band.
#[derive(Debug, Clone, PartialEq)]
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
    /// Smooth border of two media: Fresnel's equations, unpolarised.
    Interface,
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

impl Material {
    /// One way on for light, drawn at random. `weight` is what the light carries; it is multiplied so that its mean is what
    /// goes on, and `absorbed` is set to what stays, the same mean exactly known where there is a formula. None when
    /// nothing goes on.
    pub fn scatter<const N: usize>(
        &self,
        arrival: &Arrival<'_>,
        weight: &mut [f64; N],
        absorbed: &mut [f64; N],
        draws: &mut Draws,
    ) -> Option<Departure> {
        match self {
            Self::Black => {
                *absorbed = *weight;
                None
            }
            Self::Lambertian {
                reflectance,
                transmittance,
            } => lambertian(reflectance, transmittance, arrival, weight, absorbed, draws),
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
            Self::Interface => interface::scatter(arrival, weight, absorbed, draws),
        }
    }
}

/// Mirrored in the plane of a normal.
pub fn mirrored(direction: Vec3, normal: Vec3) -> Vec3 {
    (direction - normal * (2.0 * direction.dot(normal))).unit()
}

fn lambertian<const N: usize>(
    reflectance: &[f64],
    transmittance: &[f64],
    arrival: &Arrival<'_>,
    weight: &mut [f64; N],
    absorbed: &mut [f64; N],
    draws: &mut Draws,
) -> Option<Departure> {
    let (reflectance, transmittance) = (&reflectance[..N], &transmittance[..N]);
    let (mut back, mut on) = (0.0, 0.0);
    for b in 0..N {
        absorbed[b] = weight[b] * (1.0 - reflectance[b] - transmittance[b]);
        back += weight[b] * reflectance[b];
        on += weight[b] * transmittance[b];
    }
    let sum = back + on;
    if sum <= 0.0 {
        return None;
    }
    let u = [draws.next(), draws.next()];
    let passes = on > 0.0 && draws.next() * sum >= back;
    let (share, values) = if passes {
        (on / sum, transmittance)
    } else {
        (back / sum, reflectance)
    };
    for b in 0..N {
        weight[b] *= values[b] / share;
    }
    let normal = if passes { -arrival.normal } else { arrival.normal };
    Some(Departure {
        direction: cosine(normal, u),
        passes,
        specular: false,
    })
}

/// A direction about a normal, its density in proportion to the cosine.
pub fn cosine(normal: Vec3, u: [f64; 2]) -> Vec3 {
    let [t, b] = normal.frame();
    let r = u[0].sqrt();
    let (sin, cos) = (TAU * u[1] - PI).sin_cos();
    // At least a little above the surface, so that light never runs in it.
    let z = (1.0 - u[0]).max(1e-12).sqrt();
    (t * (r * cos) + b * (r * sin) + normal * z).unit()
}
