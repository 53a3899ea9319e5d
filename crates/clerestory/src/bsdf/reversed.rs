//! The other side's transmission, or the same reflection, by reciprocity: f(vᵢ, vₒ) = f(vₒ, vᵢ).
//!
//! Matrices with reversible bases and 4D trees become such tables exactly (see [`Model::reciprocal`]). This view serves
//! the rest: isotropic trees and matrices on other bases. It has the table's own values, and its totals and samples are
//! exact: backwards, too, a table is constant in parts of the disk whose areas are known.

use std::sync::Arc;

use super::matrix::patch_extent;
use super::separated::{Cell, Tabular, tabular};
use super::tree::Backwards;
use super::{Estimate, Matrix, Model, Part, Peak, Rank, Sample, Scatterer, Tree};
use crate::direction::Disk;

/// Another model, its paths travelled backwards.
#[derive(Debug, Clone)]
pub struct Reversed {
    base: Arc<Model>,
    way: Way,
}

/// How it is answered.
#[derive(Debug, Clone)]
enum Way {
    /// The base is an isotropic tree.
    Tree(Arc<Backwards>),
    /// The base is a matrix.
    Matrix,
    /// By a model of its own.
    Model(Arc<Model>),
}

/// The way with the table that it takes.
enum Taken<'a> {
    Tree(&'a Tree, &'a Backwards),
    Matrix(&'a Matrix),
    Model(&'a Model),
}

impl Reversed {
    /// `base` backwards.
    pub fn new(base: Arc<Model>) -> Self {
        let way = match &*base {
            Model::Tree(tree) if tree.rank() == Rank::Isotropic => Way::Tree(Arc::new(Backwards::new(tree))),
            Model::Matrix(_) => Way::Matrix,
            other => Way::Model(Arc::new(other.reciprocal())),
        };
        Self { base, way }
    }

    /// The model whose paths are reversed.
    pub fn base(&self) -> &Arc<Model> {
        &self.base
    }

    fn taken(&self) -> Taken<'_> {
        match (&self.way, &*self.base) {
            (Way::Tree(backwards), Model::Tree(tree)) => Taken::Tree(tree, backwards),
            (Way::Matrix, Model::Matrix(matrix)) => Taken::Matrix(matrix),
            (Way::Model(model), _) => Taken::Model(model),
            _ => unreachable!("a way is chosen for its base"),
        }
    }
}

/// A matrix backwards: from its outgoing patch `o` into its incident ones.
fn flux(matrix: &Matrix, o: usize) -> impl Iterator<Item = f64> {
    (0..matrix.incident().len()).map(move |i| matrix.value(i, o) * matrix.incident().projected_solid_angle(i))
}

fn sample_matrix(matrix: &Matrix, incident: Disk, u: [f64; 2]) -> Option<Sample> {
    let o = matrix.outgoing().patch_of(incident.reversed());
    let weight: f64 = flux(matrix, o).sum();
    let target = u[0] * weight;
    let (mut before, mut chosen) = (0.0, None);
    for (i, part) in flux(matrix, o).enumerate().filter(|(_, part)| *part > 0.0) {
        chosen = Some((i, ((target - before) / part).clamp(0.0, 1.0 - f64::EPSILON)));
        before += part;
        if target < before {
            break;
        }
    }
    let (i, along) = chosen?;
    Some(Sample {
        outgoing: matrix.incident().sample_cosine(i, [along, u[1]]).reversed(),
        weight,
        peak: false,
    })
}

impl Scatterer for Reversed {
    fn evaluate(&self, incident: Disk, outgoing: Disk) -> f64 {
        match self.taken() {
            Taken::Tree(tree, _) => tree.evaluate(outgoing.reversed(), Backwards::settled(incident).reversed()),
            Taken::Matrix(matrix) => matrix.evaluate(outgoing.reversed(), incident.reversed()),
            Taken::Model(model) => model.evaluate(incident, outgoing),
        }
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        match self.taken() {
            Taken::Tree(..) | Taken::Matrix(_) => Vec::new(),
            Taken::Model(model) => model.peaks(incident),
        }
    }

    fn sample(&self, incident: Disk, u: [f64; 2]) -> Option<Sample> {
        match self.taken() {
            Taken::Tree(tree, backwards) => backwards.sample(tree, incident, u).map(|outgoing| Sample {
                outgoing,
                weight: backwards.total(tree, incident),
                peak: false,
            }),
            Taken::Matrix(matrix) => sample_matrix(matrix, incident, u),
            Taken::Model(model) => model.sample(incident, u),
        }
    }

    fn pdf(&self, incident: Disk, outgoing: Disk) -> f64 {
        if let Taken::Model(model) = self.taken() {
            return model.pdf(incident, outgoing);
        }
        let total = self.total(incident, Part::All).value;
        if total > 0.0 {
            self.evaluate(incident, outgoing) * outgoing.cos_theta() / total
        } else {
            0.0
        }
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        let value = match self.taken() {
            Taken::Model(model) => return model.total(incident, part),
            _ if part == Part::Direct => 0.0,
            Taken::Tree(tree, backwards) => backwards.total(tree, incident),
            Taken::Matrix(matrix) => flux(matrix, matrix.outgoing().patch_of(incident.reversed())).sum(),
        };
        value.into()
    }

    fn resolution(&self, incident: Disk) -> f64 {
        match self.taken() {
            Taken::Model(model) => model.resolution(incident),
            _ => self.base.resolution(incident.reversed()),
        }
    }
}

/// A table's reverse, where the base is a table; [`super::Separated`] asks for it only then.
impl Tabular for Reversed {
    fn cell(&self, incident: Disk, outgoing: Disk) -> Cell {
        match self.taken() {
            Taken::Tree(tree, backwards) => {
                let incident = Backwards::settled(incident);
                let (cell, level) = tree.leaf(outgoing.reversed(), incident.reversed());
                Cell {
                    outgoing_area: backwards.area(incident, outgoing, level),
                    ..cell
                }
            }
            Taken::Matrix(matrix) => Cell {
                outgoing_area: matrix
                    .incident()
                    .projected_solid_angle(matrix.incident().patch_of(outgoing.reversed())),
                ..matrix.cell(outgoing.reversed(), incident.reversed())
            },
            Taken::Model(_) => self.table().cell(incident, outgoing),
        }
    }

    fn smallest_area(&self) -> f64 {
        self.table().smallest_area()
    }

    fn floor(&self) -> f64 {
        self.table().floor()
    }

    fn extent(&self, incident: Disk, outgoing: Disk) -> f64 {
        match self.taken() {
            Taken::Model(_) => self.table().extent(incident, outgoing),
            Taken::Tree(_, backwards) => backwards.extent(incident, outgoing),
            Taken::Matrix(matrix) => patch_extent(matrix.incident(), outgoing.reversed()),
        }
    }
}

impl Reversed {
    fn table(&self) -> &dyn Tabular {
        let table = match self.taken() {
            Taken::Model(model) => model,
            _ => &self.base,
        };
        tabular(table).expect("asked for tables only")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::{Basis, Ring};
    use crate::bsdf::{Lambertian, Specular, Turn, Turned};
    use crate::sequence::{r2, uniform};

    fn ring(lower_deg: f64, upper_deg: f64, count: usize) -> Ring {
        Ring {
            lower_deg,
            upper_deg,
            nominal_deg: lower_deg,
            count,
        }
    }

    /// A matrix on a basis that has no reverse, with a dark patch.
    fn odd() -> Model {
        let basis = Basis::from_rings(
            "odd",
            vec![ring(0.0, 30.0, 1), ring(30.0, 60.0, 5), ring(60.0, 90.0, 7)],
        );
        let basis = Arc::new(basis.unwrap());
        let value = |i: usize, o: usize| if i == 4 { 0.0 } else { uniform(3, (i * 13 + o) as u64) };
        Model::Matrix(Matrix::from_fn(basis.clone(), basis, value).unwrap())
    }

    #[test]
    fn a_matrix_of_any_basis_is_summed_and_sampled_exactly() {
        let model = odd().reciprocal();
        assert_eq!(model.kind(), "reversed");
        for k in 0..10 {
            let incident = Disk::uniform(r2(k, [0.2, 0.6]));
            let n = 1 << 16;
            let points = (0..n).map(|k| Disk::uniform(r2(k, [0.0; 2])));
            let mean = points.map(|o| model.evaluate(incident, o)).sum::<f64>() / f64::from(n);
            let total = model.total(incident, Part::All).value;
            assert!((mean * std::f64::consts::PI - total).abs() < 2e-3 * total);
            let bins = Basis::klems_quarter();
            let mut counts = vec![0.0; bins.len()];
            for k in 0..n {
                let sample = model.sample(incident, r2(k, [0.0; 2])).unwrap();
                assert!((sample.weight - total).abs() < 1e-12 * total);
                let value = model.evaluate(incident, sample.outgoing) * sample.outgoing.cos_theta();
                assert!((sample.weight * model.pdf(incident, sample.outgoing) - value).abs() < 1e-12);
                assert!(value > 0.0);
                counts[bins.patch_of(sample.outgoing)] += total / f64::from(n);
            }
            for (patch, count) in counts.iter().enumerate() {
                let points = (0..4096).map(|k| bins.sample_cosine(patch, r2(k, [0.0; 2])));
                let mean = points.map(|o| model.evaluate(incident, o)).sum::<f64>() / 4096.0;
                let flux = mean * bins.projected_solid_angle(patch);
                assert!((count - flux).abs() < 0.01 * total, "{patch}: {count} {flux}");
            }
        }
    }

    #[test]
    fn a_dark_patch_gives_no_samples() {
        let basis = Basis::from_rings("odd", vec![ring(0.0, 40.0, 1), ring(40.0, 90.0, 5)]);
        let basis = Arc::new(basis.unwrap());
        let dark = Matrix::from_fn(basis.clone(), basis, |_, o| if o == 0 { 0.0 } else { 0.1 }).unwrap();
        let model = Model::Matrix(dark).reciprocal();
        assert_eq!(model.total(Disk::NORMAL, Part::All).value, 0.0);
        assert!(model.sample(Disk::NORMAL, [0.5; 2]).is_none());
        assert_eq!(model.pdf(Disk::NORMAL, Disk::NORMAL), 0.0);
    }

    #[test]
    fn what_has_a_reverse_of_its_own_is_that() {
        let incident = Disk::from_angles(0.6, 1.0);
        let beam = Reversed::new(Arc::new(Model::Specular(Specular::constant(0.4).unwrap())));
        assert_eq!(beam.peaks(incident).len(), 1);
        assert!((beam.total(incident, Part::Direct).value - 0.4).abs() < 1e-12);
        let diffuse = Reversed::new(Arc::new(Model::Lambertian(Lambertian::new(0.3).unwrap())));
        assert_eq!(diffuse.sample(incident, [0.1, 0.2]).unwrap().weight, 0.3);
        let turned = Model::Turned(Turned::new(Arc::new(odd()), Turn::new(0.4, true)));
        let twice = Reversed::new(Arc::new(Model::Reversed(Reversed::new(Arc::new(turned.clone())))));
        for k in 0..100 {
            let outgoing = Disk::uniform(r2(k, [0.0; 2]));
            assert_eq!(twice.evaluate(incident, outgoing), turned.evaluate(incident, outgoing));
            assert_eq!(twice.pdf(incident, outgoing), turned.pdf(incident, outgoing));
        }
    }
}
