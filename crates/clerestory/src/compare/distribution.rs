//! The outgoing light of a model for one incident direction, as points that carry flux.

use std::f64::consts::PI;

use crate::basis::Basis;
use crate::bsdf::{Matrix, Model, Part, Scatterer, Separated, Tree};
use crate::direction::Disk;
use crate::sequence::r2;

/// Points a hemisphere, by projected solid angle; every patch and every cell of a tree has at least one.
const POINTS: f64 = 65_536.0;

/// A point of scattered light.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Direction of travel.
    pub outgoing: Disk,
    /// Flux that it stands for, per unit of incident flux.
    pub flux: f64,
    /// BSDF there (1/sr).
    pub value: f64,
}

/// Outgoing light for one incident direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Distribution {
    /// Scattered light.
    pub points: Vec<Point>,
    /// Directions and values of peaks.
    pub peaks: Vec<(Disk, f64)>,
}

impl Distribution {
    /// Of a model. Patches and cells are divided evenly, so that all flux of a table is there, however narrow its peaks;
    /// a model without cells is sampled at 65,536 points.
    pub fn of(model: &Model, incident: Disk) -> Self {
        let peaks = model.peaks(incident).iter().map(|p| (p.outgoing, p.value)).collect();
        let mut points = Vec::new();
        scattered(model, incident, &mut points);
        Self { points, peaks }
    }

    /// Flux of scattered light and peaks.
    pub fn total(&self) -> f64 {
        let scattered: f64 = self.points.iter().map(|p| p.flux).sum();
        scattered + self.peaks.iter().map(|p| p.1).sum::<f64>()
    }
}

fn scattered(model: &Model, incident: Disk, points: &mut Vec<Point>) {
    match model {
        Model::Matrix(matrix) => of_matrix(matrix, incident, points),
        Model::Tree(tree) => of_tree(tree, incident, points),
        Model::Turned(turned) => {
            let first = points.len();
            scattered(turned.base(), turned.turn().inverse().apply(incident), points);
            for point in &mut points[first..] {
                point.outgoing = turned.turn().apply(point.outgoing);
            }
        }
        Model::Sum(sum) => {
            let first = points.len();
            for (weight, part) in sum.parts() {
                let own = points.len();
                scattered(part, incident, points);
                for point in &mut points[own..] {
                    point.flux *= weight;
                }
            }
            for point in &mut points[first..] {
                point.value = sum.evaluate(incident, point.outgoing);
            }
            points.retain(|p| p.flux > 0.0);
        }
        Model::Separated(separated) => of_separated(separated, incident, points),
        Model::Specular(_) => {}
        _ => everywhere(model, incident, points),
    }
}

fn of_matrix(matrix: &Matrix, incident: Disk, points: &mut Vec<Point>) {
    let patch = matrix.incident().patch_of(incident);
    let basis: &Basis = matrix.outgoing();
    for o in 0..basis.len() {
        let value = matrix.value(patch, o);
        if value <= 0.0 {
            continue;
        }
        let area = basis.projected_solid_angle(o);
        let count = (area / PI * POINTS).ceil();
        for k in 0..count as u32 {
            points.push(Point {
                outgoing: basis.sample_cosine(o, r2(k, shift(o))),
                flux: value * area / count,
                value,
            });
        }
    }
}

fn of_tree(tree: &Tree, incident: Disk, points: &mut Vec<Point>) {
    for (n, cell) in tree.outgoing_cells(incident).iter().enumerate() {
        if cell.value <= 0.0 {
            continue;
        }
        let area = PI * cell.edge * cell.edge;
        let count = (area / PI * POINTS).ceil();
        for k in 0..count as u32 {
            let u = r2(k, shift(n));
            let square = [cell.corner[0] + cell.edge * u[0], cell.corner[1] + cell.edge * u[1]];
            points.push(Point {
                outgoing: tree.rank().out_of_frame(incident, Disk::from_square(square)),
                flux: cell.value * area / count,
                value: cell.value,
            });
        }
    }
}

/// The table's points, less what went into its beam.
fn of_separated(separated: &Separated, incident: Disk, points: &mut Vec<Point>) {
    let first = points.len();
    scattered(separated.base(), incident, points);
    if separated.total(incident, Part::Direct).value <= 0.0 {
        return;
    }
    for point in &mut points[first..] {
        let value = separated.evaluate(incident, point.outgoing);
        point.flux *= value / point.value;
        point.value = value;
    }
    points.retain(|p| p.flux > 0.0);
}

fn everywhere(model: &Model, incident: Disk, points: &mut Vec<Point>) {
    for k in 0..POINTS as u32 {
        let outgoing = Disk::uniform(r2(k, shift(0)));
        let value = model.evaluate(incident, outgoing);
        if value > 0.0 {
            points.push(Point {
                outgoing,
                flux: value * PI / POINTS,
                value,
            });
        }
    }
}

/// Offset of the points of a cell, so that neighbours do not line up with the borders of another partition.
fn shift(cell: usize) -> [f64; 2] {
    r2(cell as u32, [0.0; 2])
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::bsdf::{Lambertian, Rank, Specular, Sum, Turn};

    /// A tree with one bright cell at the bottom.
    fn narrow_tree() -> Tree {
        let mut entries = Vec::new();
        let depth = 9_u32;
        for level in 0..depth {
            let mut block = vec![0.1_f32.to_bits(); 16];
            for child in [5, 10] {
                block[child] = 0.3_f32.to_bits();
            }
            block[12] = if level + 1 == depth {
                5e4_f32.to_bits()
            } else {
                1 << 31 | (level + 1)
            };
            entries.extend(block);
        }
        Tree::from_entries(Rank::Anisotropic, 1 << 31, entries).unwrap()
    }

    #[test]
    fn all_light_is_there() {
        let klems = Arc::new(Basis::klems_full());
        let quarter = Arc::new(Basis::klems_quarter());
        let matrix = Matrix::from_fn(klems, quarter, |i, o| {
            if o == 7 {
                4.0
            } else {
                0.01 * ((i + 3 * o) % 7) as f64 - 0.01
            }
        })
        .unwrap();
        let tree = narrow_tree();
        let models = [
            Model::Matrix(matrix.clone()),
            Model::Tree(tree.clone()),
            Model::Tree(tree.clone()).turned(Turn::new(0.3, true)),
            Model::Lambertian(Lambertian::new(0.4).unwrap()),
            Model::Separated(Separated::new(Arc::new(Model::Tree(tree.clone()))).unwrap()),
            Model::Sum(
                Sum::new(vec![
                    (0.3, Arc::new(Model::Matrix(matrix))),
                    (0.5, Arc::new(Model::Tree(tree))),
                    (0.2, Arc::new(Model::Specular(Specular::constant(0.7).unwrap()))),
                ])
                .unwrap(),
            ),
        ];
        for model in models {
            for incident in [Disk::NORMAL, Disk::new(-0.49, -0.51), Disk::new(-0.4, 0.2)] {
                let total = Distribution::of(&model, incident).total();
                let expected = model.total(incident, Part::All).value;
                assert!((total - expected).abs() < 1e-9 * expected.max(1.0), "{}", model.kind());
            }
        }
    }

    #[test]
    fn values_are_the_models_own() {
        let model = Model::Sum(
            Sum::new(vec![
                (0.5, Arc::new(Model::Tree(narrow_tree()))),
                (0.5, Arc::new(Model::Lambertian(Lambertian::new(0.2).unwrap()))),
            ])
            .unwrap(),
        );
        let incident = Disk::new(-0.49, -0.51);
        for point in Distribution::of(&model, incident).points.iter().step_by(97) {
            assert!((point.value - model.evaluate(incident, point.outgoing)).abs() < 1e-9);
        }
    }
}
