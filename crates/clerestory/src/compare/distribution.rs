//! The outgoing light of a model for one incident direction, as points that carry flux.

use std::f64::consts::PI;

use crate::basis::Basis;
use crate::bsdf::{Matrix, Model, Part, Scatterer, Separated, Tree};
use crate::direction::Disk;
use crate::sequence::r2;

/// Points a hemisphere, by projected solid angle; every patch and every cell of a tree has at least one.
const POINTS: f64 = 65_536.0;
/// One in so many of them is looked up in another model.
const PROBED: f64 = 4.0;

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
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Distribution {
    /// Scattered light.
    pub points: Vec<Point>,
    /// All of it once more at fewer points, to be looked up in other models.
    pub probes: Vec<Point>,
    /// Directions and values of peaks.
    pub peaks: Vec<(Disk, f64)>,
}

impl Distribution {
    /// Of a model. Patches and cells are divided evenly, so that all flux of a table is there, however narrow its peaks;
    /// a model without cells is sampled at 65,536 points.
    pub fn of(model: &Model, incident: Disk) -> Self {
        let mut light = Self::default();
        light.add_scattered(model, incident);
        light.peaks = model.peaks(incident).iter().map(|p| (p.outgoing, p.value)).collect();
        light
    }

    /// Flux of scattered light and peaks.
    pub fn total(&self) -> f64 {
        let scattered: f64 = self.points.iter().map(|p| p.flux).sum();
        scattered + self.peaks.iter().map(|p| p.1).sum::<f64>()
    }

    fn add_scattered(&mut self, model: &Model, incident: Disk) {
        match model {
            Model::Matrix(matrix) => self.add_matrix(matrix, incident),
            Model::Tree(tree) => self.add_tree(tree, incident),
            Model::Turned(turned) => {
                let mut own = Self::default();
                own.add_scattered(turned.base(), turned.turn().inverse().apply(incident));
                own.change(|p| p.outgoing = turned.turn().apply(p.outgoing));
                self.join(own);
            }
            Model::Sum(sum) => {
                let mut own = Self::default();
                for (weight, part) in sum.parts() {
                    let mut light = Self::default();
                    light.add_scattered(part, incident);
                    light.change(|p| p.flux *= weight);
                    own.join(light);
                }
                own.change(|p| p.value = sum.evaluate(incident, p.outgoing));
                self.join(own);
            }
            Model::Separated(separated) => self.add_separated(separated, incident),
            Model::Specular(_) | Model::Beam(_) => {}
            _ => self.add_anything(model, incident),
        }
    }

    fn add_matrix(&mut self, matrix: &Matrix, incident: Disk) {
        let patch = matrix.incident().patch_of(incident);
        let basis: &Basis = matrix.outgoing();
        for o in 0..basis.len() {
            let place = |u| basis.sample_cosine(o, u);
            self.add_cell(o, basis.projected_solid_angle(o), matrix.value(patch, o), place);
        }
    }

    fn add_tree(&mut self, tree: &Tree, incident: Disk) {
        for (n, cell) in tree.outgoing_cells(incident).iter().enumerate() {
            let place = |u: [f64; 2]| {
                let square = [cell.corner[0] + cell.edge * u[0], cell.corner[1] + cell.edge * u[1]];
                tree.rank().out_of_frame(incident, Disk::from_square(square))
            };
            self.add_cell(n, PI * cell.edge * cell.edge, cell.value, place);
        }
    }

    /// Even points of a cell of one value; `number` tells it from its neighbours.
    fn add_cell(&mut self, number: usize, area: f64, value: f64, place: impl Fn([f64; 2]) -> Disk) {
        if value <= 0.0 {
            return;
        }
        let count = (area / PI * POINTS).ceil();
        let probed = (count / PROBED).ceil();
        for k in 0..count as u32 {
            let point = Point {
                outgoing: place(r2(k, shift(number))),
                flux: value * area / count,
                value,
            };
            self.points.push(point);
            // The first points of a low-discrepancy sequence are spread evenly too.
            if f64::from(k) < probed {
                let flux = value * area / probed;
                self.probes.push(Point { flux, ..point });
            }
        }
    }

    /// The table's points, less what went into its beam.
    fn add_separated(&mut self, separated: &Separated, incident: Disk) {
        let mut own = Self::default();
        own.add_scattered(separated.base(), incident);
        if separated.total(incident, Part::Direct).value > 0.0 {
            own.change(|point| {
                let value = separated.evaluate(incident, point.outgoing);
                point.flux *= value / point.value;
                point.value = value;
            });
        }
        self.join(own);
    }

    fn add_anything(&mut self, model: &Model, incident: Disk) {
        for k in 0..POINTS as u32 {
            let outgoing = Disk::uniform(r2(k, shift(0)));
            let value = model.evaluate(incident, outgoing);
            let flux = value * PI / POINTS;
            self.points.push(Point { outgoing, flux, value });
            if f64::from(k) < POINTS / PROBED {
                let flux = PROBED * flux;
                self.probes.push(Point { outgoing, flux, value });
            }
        }
    }

    fn change(&mut self, change: impl Fn(&mut Point)) {
        for list in [&mut self.points, &mut self.probes] {
            for point in list.iter_mut() {
                change(point);
            }
            list.retain(|p| p.flux > 0.0);
        }
    }

    fn join(&mut self, other: Self) {
        self.points.extend(other.points);
        self.probes.extend(other.probes);
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
                let light = Distribution::of(&model, incident);
                let total = light.total();
                let probed: f64 = light.probes.iter().map(|p| p.flux).sum();
                let scattered = model.total(incident, Part::Scattered).value;
                assert!((probed - scattered).abs() < 1e-3 * scattered, "{}", model.kind());
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
