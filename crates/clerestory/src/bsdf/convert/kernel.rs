//! Means of a model over patch pairs, kind by kind: exact where the patches' overlaps tell them, otherwise sampled.

use rayon::prelude::*;

use super::overlap::shares;
use super::points::Points;
use crate::bsdf::{Matrix, Model, Part, Rank, Scatterer, Specular, Tree, Turn};
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
        Model::Matrix(_) | Model::Lambertian(_) => 0,
        Model::Tree(_) | Model::Specular(_) | Model::Reversed(_) | Model::Separated(_) => incident,
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
        Model::Tree(tree) if tree.rank() == Rank::Isotropic => {
            of_isotropic_tree(tree, turn, incident, outgoing, progress)
        }
        Model::Tree(tree) => of_anisotropic_tree(tree, turn, incident, outgoing, progress),
        Model::Specular(_) | Model::Reversed(_) | Model::Separated(_) => {
            of_points(model, turn, incident, outgoing, progress)
        }
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

fn of_anisotropic_tree(
    tree: &Tree,
    turn: Turn,
    incident: &Points,
    outgoing: &Points,
    progress: &Progress,
) -> Result<Means> {
    let (back, rank) = (turn.inverse(), tree.rank());
    let codes_in: Vec<u64> = incident
        .all()
        .iter()
        .map(|&p| rank.incident_code(back.apply(p)))
        .collect();
    let codes_out: Vec<u64> = outgoing
        .all()
        .iter()
        .map(|&p| rank.outgoing_code(back.apply(p)))
        .collect();
    let n = incident.count;
    rows(incident, outgoing, progress, |i, halves| {
        let from = &codes_in[i * n..(i + 1) * n];
        for (o, to) in codes_out.chunks_exact(n).enumerate() {
            let mut sums = [0.0; 2];
            for (k, (a, b)) in from.iter().zip(to).enumerate() {
                sums[k & 1] += f64::from(tree.value_at(a | b));
            }
            halves[0][o] = sums[0];
            halves[1][o] = sums[1];
        }
    })
}

/// Pairs of patches that a turn about the normal takes into each other have the same mean: one of them is sampled.
fn of_isotropic_tree(
    tree: &Tree,
    turn: Turn,
    incident: &Points,
    outgoing: &Points,
    progress: &Progress,
) -> Result<Means> {
    let back = turn.inverse();
    let apply = |points: &Points| -> Vec<Disk> { points.all().iter().map(|&p| back.apply(p)).collect() };
    let (from, to) = (apply(incident), apply(outgoing));
    let (n_out, n) = (outgoing.basis.len(), incident.count);
    let rings_out = outgoing.basis.rings();
    // How many cells of an incident ring are sampled for each outgoing ring: the rest are turned into them.
    let sampled = |ring_in: usize, ring_out: usize| {
        let (a, b) = (incident.basis.rings()[ring_in].count, rings_out[ring_out].count);
        a / gcd(a, b)
    };
    let mut means = rows(incident, outgoing, progress, |i, halves| {
        let (ring_in, cell_in) = incident.basis.place(i);
        for (ring_out, ring) in rings_out.iter().enumerate() {
            if cell_in >= sampled(ring_in, ring_out) {
                continue;
            }
            let first = outgoing.basis.first_of_ring(ring_out);
            for cell in 0..ring.count {
                let o = first + cell;
                let mut sums = [0.0; 2];
                for k in 0..n {
                    sums[k & 1] += tree.evaluate(from[i * n + k], to[o * n + k]);
                }
                halves[0][o] = sums[0];
                halves[1][o] = sums[1];
            }
        }
    })?;
    for i in 0..incident.basis.len() {
        let (ring_in, cell_in) = incident.basis.place(i);
        let count_in = incident.basis.rings()[ring_in].count;
        for (ring_out, ring) in rings_out.iter().enumerate() {
            let (period, first) = (sampled(ring_in, ring_out), outgoing.basis.first_of_ring(ring_out));
            let source = i - cell_in + cell_in % period;
            // A turn by `cell_in - cell_in % period` incident cells is a whole number of outgoing cells.
            let shift = (cell_in - cell_in % period) * ring.count / count_in;
            if source == i {
                continue;
            }
            for cell in 0..ring.count {
                let from = (cell + ring.count - shift % ring.count) % ring.count;
                for half in &mut means.halves {
                    half[i * n_out + first + cell] = half[source * n_out + first + from];
                }
            }
        }
    }
    Ok(means)
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// Any model: point by point, peaks binned into the patch that they fall into.
fn of_points(model: &Model, turn: Turn, incident: &Points, outgoing: &Points, progress: &Progress) -> Result<Means> {
    let back = turn.inverse();
    let to: Vec<Disk> = outgoing.all().iter().map(|&p| back.apply(p)).collect();
    let beam_only = matches!(model, Model::Specular(_));
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
fn rows(
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

/// Mean direct-hemispherical value of every incident patch over its points; None where the model has only an estimate of it.
pub fn totals(model: &Model, incident: &Points) -> Option<Vec<f64>> {
    if estimates_total(model) {
        return None;
    }
    let of = |i: usize| {
        let sum: f64 = incident.of(i).iter().map(|&p| model.total(p, Part::All).value).sum();
        sum / incident.count as f64
    };
    Some((0..incident.basis.len()).into_par_iter().map(of).collect())
}

/// Whether a model's direct-hemispherical value is an estimate.
pub fn estimates_total(model: &Model) -> bool {
    match model {
        Model::Reversed(_) => true,
        Model::Sum(s) => s.parts().iter().any(|(_, m)| estimates_total(m)),
        Model::Turned(t) => estimates_total(t.base()),
        _ => false,
    }
}
