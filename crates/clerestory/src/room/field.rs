//! What a window sends into the room when nothing but sky and ground stands before it: one radiance a direction, the same
//! from every point of it.

use std::convert::Infallible;

use rayon::prelude::*;

use crate::bsdf::{Matrix, Model, Rank, Scatterer, Tree};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;
use crate::sequence::r2;

/// Light of the three channels.
pub type Rgb = [f64; 3];

/// Steps of the concentric square along each axis on which incident light is summed, a power of two.
const INCIDENT: usize = 128;
/// And on which outgoing light is tabulated where the model has no patches of its own.
const OUTGOING: usize = 128;
/// Incident directions that are drawn for an outgoing one where a model is no table.
const DRAWN: u32 = 512;

/// What arrives at the window from outside: the means over the cells of the square, in W/(m² sr), and the sun's disc as a few
/// directions, each with its irradiance on a plane that faces it (W/m²).
pub struct Incident {
    sky: Vec<Rgb>,
    sun: Vec<(Disk, Rgb)>,
}

impl Incident {
    /// Of a radiance by direction of travel, and the points of the sun's disc.
    pub fn new(radiance: impl Fn(Disk) -> Rgb + Sync, sun: Vec<(Disk, Rgb)>) -> Self {
        const INSIDE: u32 = 4;
        let sky = (0..INCIDENT * INCIDENT)
            .into_par_iter()
            .map(|cell| {
                let mut mean = [0.0; 3];
                for k in 0..INSIDE {
                    let [u, v] = r2(k, [0.0; 2]);
                    let at = |index: usize, u: f64| (index as f64 + u) / INCIDENT as f64;
                    let here = radiance(Disk::from_square([at(cell / INCIDENT, u), at(cell % INCIDENT, v)]));
                    for (m, h) in mean.iter_mut().zip(here) {
                        *m += h / f64::from(INSIDE);
                    }
                }
                mean
            })
            .collect();
        Self { sky, sun }
    }

    fn mean(&self, point: Disk) -> Rgb {
        let [a, b] = point.to_square().map(|x| (x * INCIDENT as f64) as usize);
        self.sky[a * INCIDENT + b]
    }
}

/// Radiance by outgoing direction [W/(m² sr)] of the scattered light; beams are not in it.
#[derive(Debug, Clone)]
pub enum Scattered {
    /// Nothing.
    Dark,
    /// One value a patch of a basis.
    Patches(std::sync::Arc<crate::basis::Basis>, Vec<Rgb>),
    /// One value a cell of the concentric square, `[a * steps + b]`.
    Cells(usize, Vec<Rgb>),
}

impl Scattered {
    /// For models of the transmission into the room, one a channel, or one for all three.
    pub fn new(models: &[Model], incident: &Incident, progress: &Progress) -> Result<Self> {
        if models.iter().all(is_beam) {
            return Ok(Self::Dark);
        }
        if let [model] = models
            && let Some((weight, matrix)) = only_matrix(model)
        {
            let mut values = by_patch(matrix, &incident.sky, &incident.sun);
            for value in values.iter_mut().flatten() {
                *value *= weight;
            }
            return Ok(Self::Patches(matrix.outgoing().clone(), values));
        }
        let mut cells = vec![[0.0; 3]; OUTGOING * OUTGOING];
        for (k, model) in models.iter().enumerate() {
            progress.check()?;
            let channels = if models.len() == 1 { 0..3 } else { k..k + 1 };
            let values = of_model(model, incident);
            for (cell, value) in cells.iter_mut().zip(values) {
                cell[channels.clone()].copy_from_slice(&value[channels.clone()]);
            }
        }
        Ok(Self::Cells(OUTGOING, cells))
    }

    /// Radiance along a direction of travel into the room.
    #[inline]
    pub fn radiance(&self, outgoing: Disk) -> Rgb {
        match self {
            Self::Dark => [0.0; 3],
            Self::Patches(basis, values) => values[basis.patch_of(outgoing)],
            Self::Cells(steps, values) => {
                let [a, b] = outgoing.to_square().map(|x| (x * *steps as f64) as usize);
                values[a * steps + b]
            }
        }
    }
}

/// Centre of a cell of the outgoing square.
fn centre(cell: usize, steps: usize) -> Disk {
    Disk::from_square([cell / steps, cell % steps].map(|k| (k as f64 + 0.5) / steps as f64))
}

fn is_beam(model: &Model) -> bool {
    matches!(model, Model::Specular(_) | Model::Beam(_))
}

/// The matrix that all scattered light comes from, and its weight.
fn only_matrix(model: &Model) -> Option<(f64, &Matrix)> {
    match model {
        Model::Matrix(matrix) => Some((1.0, matrix)),
        Model::Sum(sum) => {
            let mut scattering = sum.parts().iter().filter(|(_, part)| !is_beam(part));
            match (scattering.next(), scattering.next()) {
                (Some((weight, part)), None) => only_matrix(part).map(|(inner, matrix)| (weight * inner, matrix)),
                _ => None,
            }
        }
        _ => None,
    }
}

/// Each outgoing patch takes the incident patches' light by its row of the matrix.
fn by_patch(matrix: &Matrix, sky: &[Rgb], sun: &[(Disk, Rgb)]) -> Vec<Rgb> {
    let (from, to) = (matrix.incident(), matrix.outgoing());
    let area = std::f64::consts::PI / sky.len() as f64;
    let mut flux = vec![[0.0; 3]; from.len()];
    for (cell, sky) in sky.iter().enumerate() {
        // Cells straddle patches: by parts of them.
        const PARTS: usize = 4;
        for part in 0..PARTS * PARTS {
            let at = |k: usize, p: usize| (k as f64 + (p as f64 + 0.5) / PARTS as f64) / INCIDENT as f64;
            let point = Disk::from_square([at(cell / INCIDENT, part / PARTS), at(cell % INCIDENT, part % PARTS)]);
            for (f, s) in flux[from.patch_of(point)].iter_mut().zip(sky) {
                *f += s * area / (PARTS * PARTS) as f64;
            }
        }
    }
    for (point, irradiance) in sun {
        for (f, e) in flux[from.patch_of(*point)].iter_mut().zip(irradiance) {
            *f += e * point.cos_theta();
        }
    }
    let values = (0..to.len()).map(|o| {
        let mut sum = [0.0; 3];
        for (i, flux) in flux.iter().enumerate() {
            let f = matrix.value(i, o).max(0.0);
            for (s, x) in sum.iter_mut().zip(flux) {
                *s += f * x;
            }
        }
        sum
    });
    values.collect()
}

/// On the outgoing square.
fn of_model(model: &Model, incident: &Incident) -> Vec<Rgb> {
    let mut all = sky_of(model, incident);
    all.par_iter_mut().enumerate().for_each(|(cell, value)| {
        let outgoing = centre(cell, OUTGOING);
        for (point, irradiance) in &incident.sun {
            let f = model.evaluate(*point, outgoing).max(0.0) * point.cos_theta();
            for (v, e) in value.iter_mut().zip(irradiance) {
                *v += f * e;
            }
        }
    });
    all
}

fn sky_of(model: &Model, incident: &Incident) -> Vec<Rgb> {
    match model {
        _ if is_beam(model) => vec![[0.0; 3]; OUTGOING * OUTGOING],
        Model::Sum(sum) => {
            let mut all = vec![[0.0; 3]; OUTGOING * OUTGOING];
            for (weight, part) in sum.parts() {
                for (v, p) in all.iter_mut().flatten().zip(sky_of(part, incident).iter().flatten()) {
                    *v += weight * p;
                }
            }
            all
        }
        Model::Separated(separated) => {
            // What the beam takes out of the table, it takes from about the direction that it comes from.
            let mut all = sky_of(separated.base(), incident);
            all.par_iter_mut().enumerate().for_each(|(cell, value)| {
                let through = centre(cell, OUTGOING);
                let beam: f64 = model.peaks(through).iter().map(|p| p.value).sum();
                for (v, s) in value.iter_mut().zip(incident.mean(through)) {
                    *v = (*v - beam * s).max(0.0);
                }
            });
            all
        }
        Model::Matrix(matrix) => {
            let values = by_patch(matrix, &incident.sky, &[]);
            let patch = |cell| matrix.outgoing().patch_of(centre(cell, OUTGOING));
            (0..OUTGOING * OUTGOING).map(|cell| values[patch(cell)]).collect()
        }
        Model::Tree(tree) if tree.rank() == Rank::Anisotropic && 1 << tree.depth() <= OUTGOING => {
            of_leaves(tree, incident)
        }
        other => drawn(&other.reciprocal(), incident),
    }
}

/// Incident directions drawn by the model of the reversed paths.
fn drawn(backwards: &Model, incident: &Incident) -> Vec<Rgb> {
    (0..OUTGOING * OUTGOING)
        .into_par_iter()
        .map(|cell| {
            let from = centre(cell, OUTGOING).reversed();
            let mut sum = [0.0; 3];
            for k in 0..DRAWN {
                let Some(sample) = backwards.sample(from, r2(k, [0.0; 2])) else {
                    continue;
                };
                if sample.peak {
                    continue;
                }
                for (s, l) in sum.iter_mut().zip(incident.mean(sample.outgoing.reversed())) {
                    *s += sample.weight * l / f64::from(DRAWN);
                }
            }
            sum
        })
        .collect()
}

/// Exact but for the sky's change within a cell: every leaf takes the light of its incident square to its outgoing one.
fn of_leaves(tree: &Tree, incident: &Incident) -> Vec<Rgb> {
    let levels = OUTGOING.ilog2() as usize;
    // Light of the squares of each level (W/m²).
    let area = std::f64::consts::PI / incident.sky.len() as f64;
    let mut light: Vec<Vec<Rgb>> = vec![incident.sky.iter().map(|l| l.map(|l| l * area)).collect()];
    for level in (0..levels).rev() {
        let (n, finer) = (1 << level, &light[light.len() - 1]);
        let coarser = (0..n * n).map(|cell| {
            let (a, b) = (2 * (cell / n), 2 * (cell % n));
            let four = [(a, b), (a, b + 1), (a + 1, b), (a + 1, b + 1)].map(|(a, b)| finer[a * 2 * n + b]);
            std::array::from_fn(|c| four.iter().map(|x| x[c]).sum())
        });
        let coarser = coarser.collect();
        light.push(coarser);
    }
    light.reverse();
    let mut sums: Vec<Vec<Rgb>> = (0..=levels).map(|level| vec![[0.0; 3]; 1 << (2 * level)]).collect();
    for top in tree.top() {
        let Ok(()) = tree.visit_leaves(top, &mut |_| Ok::<(), Infallible>(()), &mut |level, cell, value| {
            let arrives = light[level][(cell[0] << level) + cell[1]];
            for (s, l) in sums[level][(cell[2] << level) + cell[3]].iter_mut().zip(arrives) {
                *s += value * l;
            }
        });
    }
    for level in 0..levels {
        let (n, m) = (1_usize << level, 2_usize << level);
        for cell in 0..m * m {
            let above = sums[level][cell / m / 2 * n + cell % m / 2];
            for (s, a) in sums[level + 1][cell].iter_mut().zip(above) {
                *s += a;
            }
        }
    }
    sums.pop().unwrap_or_default()
}
