//! Means of a model over patch pairs, kind by kind: exact where the patches' overlaps tell them, otherwise sampled.

use rayon::prelude::*;

use super::overlap::shares;
use super::points::Points;
use super::{leaves, lobes};
use crate::bsdf::{Beam, Cells, Matrix, Model, Part, Scatterer, Specular, Turn};
use crate::direction::Disk;
use crate::error::Result;
use crate::progress::Progress;

/// Means over patch pairs `[i * n_out + o]` (1/sr), from the even and from the odd samples.
pub struct Means {
    /// By half of the samples.
    pub halves: [Vec<f64>; 2],
    /// Variances that the source's standard errors cause.
    pub variance: Option<Vec<f64>>,
}

impl Means {
    fn exact(values: Vec<f64>) -> Self {
        Self {
            halves: [values.clone(), values],
            variance: None,
        }
    }

    fn add(&mut self, weight: f64, other: &Self) {
        for (sum, part) in self.halves.iter_mut().zip(&other.halves) {
            sum.iter_mut().zip(part).for_each(|(s, p)| *s += weight * p);
        }
        if let Some(part) = &other.variance {
            let sum = self.variance.get_or_insert_with(|| vec![0.0; part.len()]);
            sum.iter_mut().zip(part).for_each(|(s, p)| *s += weight * weight * p);
        }
    }
}

/// Steps that [`means`] reports for a model.
pub fn steps(model: &Model, incident: usize) -> usize {
    match model {
        Model::Sum(s) => s.parts().iter().map(|(_, m)| steps(m, incident)).sum(),
        Model::Turned(t) => steps(t.base(), incident),
        Model::Matrix(_) | Model::Lambertian(_) | Model::Specular(Specular::Constant(_)) => 0,
        Model::Tree(t) if t.depth() <= leaves::MAX_DEPTH => 0,
        Model::Tree(_)
        | Model::Specular(_)
        | Model::Beam(_)
        | Model::Reversed(_)
        | Model::Separated(_)
        | Model::Interpolant(_)
        | Model::Filtered(_) => incident,
    }
}

/// Means of `model`, turned by `turn`.
pub fn means(model: &Model, turn: Turn, incident: &Points, outgoing: &Points, progress: &Progress) -> Result<Means> {
    match model {
        Model::Matrix(m) => Ok(of_matrix(m, turn, incident, outgoing)),
        Model::Lambertian(_) => {
            let value = model.evaluate(Disk::NORMAL, Disk::NORMAL);
            Ok(Means::exact(vec![value; incident.basis.len() * outgoing.basis.len()]))
        }
        Model::Sum(s) => {
            let mut sum = Means::exact(vec![0.0; incident.basis.len() * outgoing.basis.len()]);
            for (weight, part) in s.parts() {
                sum.add(*weight, &means(part, turn, incident, outgoing, progress)?);
            }
            Ok(sum)
        }
        Model::Turned(t) => means(t.base(), turn.after(t.turn()), incident, outgoing, progress),
        Model::Specular(Specular::Constant(value)) => Ok(of_constant_beam(*value, incident, outgoing)),
        Model::Tree(tree) if tree.depth() <= leaves::MAX_DEPTH => {
            leaves::means(tree, turn, &incident.basis, &outgoing.basis, progress).map(Means::exact)
        }
        Model::Beam(beam) if turn == Turn::NONE && on_patches(beam, incident, outgoing) => Ok(of_beam(beam, outgoing)),
        Model::Interpolant(i) => lobes::means(i, turn, incident, outgoing, progress),
        Model::Tree(_)
        | Model::Specular(_)
        | Model::Beam(_)
        | Model::Reversed(_)
        | Model::Separated(_)
        | Model::Filtered(_) => of_points(model, turn, incident, outgoing, progress),
    }
}

/// A table on other patches: its values weighted by the overlaps.
fn of_matrix(matrix: &Matrix, turn: Turn, incident: &Points, outgoing: &Points) -> Means {
    let covers_in = shares(&incident.basis, matrix.incident(), turn);
    let covers_out = shares(&outgoing.basis, matrix.outgoing(), turn);
    let gather = |value: &(dyn Fn(usize, usize) -> f64 + Sync), power: i32| -> Vec<f64> {
        covers_in
            .par_iter()
            .flat_map_iter(|from| {
                // First over the incident patches, then over the outgoing ones.
                let row: Vec<f64> = (0..matrix.outgoing().len())
                    .map(|o| from.iter().map(|&(i, share)| share.powi(power) * value(i, o)).sum())
                    .collect();
                covers_out
                    .iter()
                    .map(move |to| to.iter().map(|&(o, share)| share.powi(power) * row[o]).sum())
                    .collect::<Vec<f64>>()
            })
            .collect()
    };
    let mut means = Means::exact(gather(&|i, o| matrix.value(i, o), 1));
    means.variance = matrix
        .standard_errors()
        .map(|errors| gather(&|i, o| errors[i * matrix.outgoing().len() + o].powi(2), 2));
    means
}

/// Whether the patches of both sides are those of a beam.
fn on_patches(beam: &Beam, incident: &Points, outgoing: &Points) -> bool {
    let same = |points: &Points| *beam.cells() == Cells::Patches(points.basis.clone());
    same(incident) && same(outgoing)
}

/// A beam that keeps its patch.
fn of_beam(beam: &Beam, outgoing: &Points) -> Means {
    let n = outgoing.basis.len();
    let diagonal = |value: &dyn Fn(usize, f64) -> f64| {
        let mut all = vec![0.0; n * n];
        for p in 0..n {
            all[p * n + p] = value(p, outgoing.basis.projected_solid_angle(p));
        }
        all
    };
    let mut means = Means::exact(diagonal(&|p, area| beam.values()[p] / area));
    means.variance = beam
        .standard_errors()
        .map(|errors| diagonal(&|p, area| (errors[p] / area).powi(2)));
    means
}

/// An ideal beam of one value: what leaves into a patch is what the incident patch shares with it.
fn of_constant_beam(value: f64, incident: &Points, outgoing: &Points) -> Means {
    let mut values = Vec::with_capacity(incident.basis.len() * outgoing.basis.len());
    for covers in shares(&incident.basis, &outgoing.basis, Turn::NONE) {
        let mut row = vec![0.0; outgoing.basis.len()];
        for (o, share) in covers {
            row[o] += value * share / outgoing.basis.projected_solid_angle(o);
        }
        values.extend(row);
    }
    Means::exact(values)
}

/// Any model: point by point, peaks binned into the patch that they fall into.
fn of_points(model: &Model, turn: Turn, incident: &Points, outgoing: &Points, progress: &Progress) -> Result<Means> {
    let back = turn.inverse();
    let to: Vec<Disk> = outgoing.all().iter().map(|&p| back.apply(p)).collect();
    let beam_only = matches!(model, Model::Specular(_) | Model::Beam(_));
    let n = incident.count;
    rows(incident, outgoing, progress, |i, halves| {
        for (k, &point) in incident.of(i).iter().enumerate() {
            let (from, half) = (back.apply(point), &mut halves[k & 1]);
            let peaks = model.peaks(from);
            for peak in &peaks {
                let o = outgoing.basis.patch_of(turn.apply(peak.outgoing));
                half[o] += peak.value / outgoing.basis.projected_solid_angle(o);
            }
            if beam_only {
                continue;
            }
            for (sum, to) in half.iter_mut().zip(to[k..].iter().step_by(n)) {
                *sum += model.evaluate(from, *to);
            }
        }
    })
}

/// Runs `row` over all incident patches; it sums samples into rows of the even and the odd ones.
pub fn rows(
    incident: &Points,
    outgoing: &Points,
    progress: &Progress,
    row: impl Fn(usize, &mut [Vec<f64>; 2]) + Sync,
) -> Result<Means> {
    let (n, n_out) = (incident.count, outgoing.basis.len());
    // Samples 0, 2, 4 … are one more than the others where their number is odd.
    let counts = [n.div_ceil(2), n / 2];
    let done: Vec<[Vec<f64>; 2]> = (0..incident.basis.len())
        .into_par_iter()
        .map(|i| {
            let mut halves = [vec![0.0; n_out], vec![0.0; n_out]];
            row(i, &mut halves);
            for (half, count) in halves.iter_mut().zip(counts) {
                for value in half {
                    *value /= count as f64;
                }
            }
            progress.step().map(|()| halves)
        })
        .collect::<Result<_>>()?;
    Ok(Means {
        halves: [0, 1].map(|h| done.iter().flat_map(|d| d[h].iter().copied()).collect()),
        variance: None,
    })
}

/// Mean direct-hemispherical value of every incident patch over its points.
pub fn totals(model: &Model, incident: &Points) -> Vec<f64> {
    let of = |i: usize| {
        let sum: f64 = incident.of(i).iter().map(|&p| model.total(p, Part::All).value).sum();
        sum / incident.count as f64
    };
    (0..incident.basis.len()).into_par_iter().map(of).collect()
}
