//! A window: where it is, how it scatters, and what it sends into the room.

use rayon::prelude::*;

use super::Disc;
use super::field::{Incident, Rgb, Scattered};
use super::polygon::Polygon;
use crate::bsdf::{Bsdf, Lambertian, Model, Scatterer};
use crate::direction::{Disk, Scatter, Side};
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Meeting, Mesh, NO_PIECE, Ray, Vec3};
use crate::material::Material;
use crate::progress::Progress;
use crate::sequence::{r2, r4};
use crate::sky::Sky;

/// How a window scatters.
#[derive(Debug, Clone)]
pub struct System {
    /// Transmission from the exterior, one a channel, or one for all.
    transmission: Vec<Model>,
    /// Its faces as materials, the one to the room first.
    faces: [Material; 2],
    up: Vec3,
    warnings: Vec<String>,
}

impl System {
    /// From a data set: the band of each channel (None for its only or visible one), and the direction of the sample's y axis,
    /// as near as the window's plane lets it be.
    ///
    /// Fails where the data set has beams that do not go straight on.
    pub fn new(bsdf: &Bsdf, bands: [Option<&str>; 3], up: Vec3) -> Result<Self> {
        let of = |band| -> Result<Model> {
            let outcome = bsdf.component(band, Side::Exterior, Scatter::Transmission)?;
            Ok((*outcome.component).clone())
        };
        let grey = bands.iter().all(|band| *band == bands[0]);
        let transmission: Vec<Model> = if grey {
            vec![of(bands[0])?]
        } else {
            bands.into_iter().map(of).collect::<Result<_>>()?
        };
        for model in &transmission {
            for k in 0..64 {
                let [a, b] = r2(k, [0.5; 2]);
                let incident = Disk::from_square([a, b]);
                let straight = |p: Disk| (p.x - incident.x).hypot(p.y - incident.y) < 1e-9;
                if model.peaks(incident).iter().any(|p| !straight(p.outgoing)) {
                    return Err(Error::Unsupported(
                        "the window's data set has beams that do not go straight on (convert it to a matrix or a tensor tree)"
                            .into(),
                    ));
                }
            }
        }
        let (whole, warnings) = with_black(bsdf, &bands)?;
        let face = |side| Material::measured(&whole, &bands, side, up);
        Ok(Self {
            transmission,
            faces: [face(Side::Interior)?, face(Side::Exterior)?],
            up,
            warnings,
        })
    }

    /// What is missing in the data set, and what is taken for it.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }
}

/// A data set in which no reflection is missing: what was is black, and told.
fn with_black(bsdf: &Bsdf, bands: &[Option<&str>; 3]) -> Result<(Bsdf, Vec<String>)> {
    let (mut whole, mut warnings) = (bsdf.clone(), Vec::new());
    for band in bands {
        let mut band = whole.band(*band)?.clone();
        for side in Side::BOTH {
            if band.get(side, Scatter::Reflection).is_none() {
                warnings.push(format!(
                    "no reflection for light from the {} in band {:?}: it is taken as black",
                    side.name(),
                    band.name
                ));
                let black = Model::Lambertian(Lambertian::new(0.0)?);
                band = band.with(side, Scatter::Reflection, black);
            }
        }
        whole = whole.with_band(band)?;
    }
    Ok((whole, warnings))
}

/// A window in its place.
#[derive(Debug, Clone)]
pub struct Window {
    name: String,
    polygon: Polygon,
    system: System,
    /// Of the sample: x, y, and z into the room.
    frame: [Vec3; 3],
    obstructed: bool,
    scattered: Scattered,
    /// All that it sends into the room but for the sun's disc, by cells of the square.
    sent: Vec<Rgb>,
    distribution: Distribution,
    /// What it lets pass straight of the sun.
    sun_beam: Rgb,
}

/// Rays that look for what stands before a window.
const LOOKS: u32 = 16_384;
/// Points of the sun's disc at which tables are looked up.
const SUN_POINTS: u32 = 64;

impl Window {
    pub(super) fn new(name: String, polygon: Polygon, system: System) -> Self {
        let z = polygon.normal();
        let y = system.up - z * system.up.dot(z);
        let frame = if y.length() < 1e-9 {
            let [x, y] = z.frame();
            [x, y, z]
        } else {
            let y = y.unit();
            [y.cross(z), y, z]
        };
        Self {
            name,
            polygon,
            system,
            frame,
            obstructed: false,
            scattered: Scattered::Dark,
            sent: Vec::new(),
            distribution: Distribution::new(&[]),
            sun_beam: [0.0; 3],
        }
    }

    /// Finds what stands before it, and what it sends into the room.
    pub(super) fn look_out(&mut self, mesh: &Mesh, sky: &Sky, sun: Option<&Disc>, progress: &Progress) -> Result<()> {
        progress.check()?;
        self.obstructed = self.is_obstructed(mesh);
        let mut points = Vec::new();
        if let Some(disc) = sun {
            let share = disc.solid_angle / f64::from(SUN_POINTS);
            for k in 0..SUN_POINTS {
                let travel = -disc.sample(r2(k, [0.0; 2]));
                if travel.dot(self.frame[2]) > 0.0 {
                    let beam = self.beam(self.disk(travel));
                    for (mean, here) in self.sun_beam.iter_mut().zip(beam) {
                        *mean += here / f64::from(SUN_POINTS);
                    }
                    points.push((self.disk(travel), disc.radiance.map(|l| l * share)));
                }
            }
        }
        let incident = Incident::new(|travel| sky.radiance(-self.travel(travel)), points);
        self.scattered = Scattered::new(&self.system.transmission, &incident, progress)?;
        let sent = |cell: usize| {
            let at = |k: usize| (k as f64 + 0.5) / SENT as f64;
            let outgoing = Disk::from_square([at(cell / SENT), at(cell % SENT)]);
            let (beam, scattered) = (self.beam(outgoing), self.scattered.radiance(outgoing));
            let behind = sky.radiance(-self.travel(outgoing));
            std::array::from_fn(|c| scattered[c] + beam[c] * behind[c])
        };
        self.sent = (0..SENT * SENT).into_par_iter().map(sent).collect();
        self.distribution = Distribution::new(&self.sent);
        Ok(())
    }

    /// Whether anything but sky and ground can be seen through it.
    fn is_obstructed(&self, mesh: &Mesh) -> bool {
        let plane = self.polygon.corners()[0];
        let size = self.polygon.area().sqrt();
        let behind = |p: Vec3| (p - plane).dot(self.frame[2]) < -1e-6 * size;
        let reaches = mesh.scene().elements.iter().any(|e| {
            let [low, high] = e.shape.bounds();
            (0..8).any(|k| {
                let pick = |bit: u32, low: f64, high: f64| if k >> bit & 1 == 0 { low } else { high };
                behind(Vec3::new(
                    pick(0, low.x, high.x),
                    pick(1, low.y, high.y),
                    pick(2, low.z, high.z),
                ))
            })
        });
        reaches
            && (0..LOOKS).any(|k| {
                let u = r4(k, [0.0; 4]);
                let out = -self.travel(Disk::from_square([u[0], u[1]]));
                let mut ray = Ray {
                    origin: self.polygon.sample([u[2], u[3]]) + out * (1e-6 * size),
                    direction: out,
                    piece: NO_PIECE,
                };
                matches!(mesh.meet(&mut ray), Meeting::Hit(_))
            })
    }

    /// What it is called.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// How it scatters.
    pub fn system(&self) -> &System {
        &self.system
    }

    /// Axes of its sample: x, y, and z into the room.
    pub(super) fn frame(&self) -> &[Vec3; 3] {
        &self.frame
    }

    /// Where it is.
    pub(super) fn polygon(&self) -> &Polygon {
        &self.polygon
    }

    /// Whether something other than sky and ground is seen through it: then light is followed outside path by path.
    pub fn obstructed(&self) -> bool {
        self.obstructed
    }

    /// Its face to the room (0) or to the outside (1) as a material.
    pub(super) fn face(&self, face: usize) -> &Material {
        &self.system.faces[face]
    }

    /// Disk point of a direction of travel into the room.
    #[inline]
    pub(super) fn disk(&self, travel: Vec3) -> Disk {
        Disk::new(travel.dot(self.frame[0]), travel.dot(self.frame[1]))
    }

    /// Direction of travel into the room of a point of the disk.
    #[inline]
    pub(super) fn travel(&self, point: Disk) -> Vec3 {
        self.frame[0] * point.x + self.frame[1] * point.y + self.frame[2] * point.cos_theta()
    }

    /// Transmittance of what goes straight on.
    pub(super) fn beam(&self, travel: Disk) -> Rgb {
        let of = |model: &Model| model.peaks(travel).iter().map(|p| p.value).sum::<f64>();
        match &self.system.transmission[..] {
            [one] => [of(one); 3],
            all => std::array::from_fn(|c| of(&all[c])),
        }
    }

    /// What it lets pass straight of the sun.
    pub(super) fn sun_beam(&self) -> Rgb {
        self.sun_beam
    }

    /// Radiance that it scatters into the room along a direction of travel, where it is not obstructed.
    #[inline]
    pub(super) fn radiance(&self, travel: Disk) -> Rgb {
        self.scattered.radiance(travel)
    }

    /// All that it sends into the room along a direction of travel but for the sun's disc, of the cell of its table.
    #[inline]
    pub(super) fn sent(&self, travel: Disk) -> Rgb {
        let [a, b] = travel.to_square().map(|x| (x * SENT as f64) as usize);
        self.sent[a * SENT + b]
    }

    /// Where its light goes, for importance sampling.
    pub(super) fn distribution(&self) -> &Distribution {
        &self.distribution
    }
}

/// Directions into the room by the light that goes there.
#[derive(Debug, Clone)]
pub(super) struct Distribution {
    /// Shares up to and with each cell of the square.
    shares: Vec<f64>,
    /// Light that leaves, for three channels together (W/m²).
    flux: f64,
}

/// Steps along each axis of the square on which all that a window sends is tabulated.
const SENT: usize = 128;
/// Steps along each axis of the square.
const STEPS: usize = 64;
/// Share that goes evenly everywhere.
const EVEN: f64 = 0.05;

impl Distribution {
    /// By the light of the cells of the square, `SENT` steps along each axis.
    fn new(sent: &[Rgb]) -> Self {
        const FINER: usize = SENT / STEPS;
        let n = STEPS * STEPS;
        let mut weights = vec![0.0; n];
        for (cell, light) in sent.iter().enumerate() {
            let coarse = cell / SENT / FINER * STEPS + cell % SENT / FINER;
            weights[coarse] += light.iter().sum::<f64>() / (FINER * FINER) as f64;
        }
        let sum: f64 = weights.iter().sum();
        for w in &mut weights {
            *w = if sum > 0.0 { (1.0 - EVEN) * *w / sum } else { 1.0 - EVEN } + EVEN / n as f64;
        }
        if sum <= 0.0 {
            weights.fill(1.0 / n as f64);
        }
        let mut total = 0.0;
        let shares = weights.into_iter().map(|w| {
            total += w;
            total
        });
        Self {
            shares: shares.collect(),
            flux: sum * std::f64::consts::PI / n as f64,
        }
    }

    /// Light that leaves, for three channels together (W/m²).
    pub(super) fn flux(&self) -> f64 {
        self.flux
    }

    /// A direction of travel.
    pub(super) fn sample(&self, u: [f64; 2]) -> Disk {
        let cell = self.shares.partition_point(|s| *s <= u[0]).min(self.shares.len() - 1);
        let below = if cell == 0 { 0.0 } else { self.shares[cell - 1] };
        let inside = ((u[0] - below) / (self.shares[cell] - below)).clamp(0.0, 1.0 - 1e-12);
        let at = |k: usize, u: f64| (k as f64 + u) / STEPS as f64;
        Disk::from_square([at(cell / STEPS, inside), at(cell % STEPS, u[1])])
    }

    /// Its density over solid angle (1/sr).
    #[inline]
    pub(super) fn density(&self, travel: Disk) -> f64 {
        let [a, b] = travel.to_square().map(|x| (x * STEPS as f64) as usize);
        let cell = a * STEPS + b;
        let below = if cell == 0 { 0.0 } else { self.shares[cell - 1] };
        (self.shares[cell] - below) * (STEPS * STEPS) as f64 / std::f64::consts::PI * travel.cos_theta()
    }
}
