//! Peaks of whole data sets taken out of their tables.

use std::sync::Arc;

use super::convert::shares;
use super::{Beam, Bsdf, Cells, Matrix, Model, Separated, Sum, Turn, Turned};
use crate::direction::Scatter;
use crate::error::Result;

impl Bsdf {
    /// With the through-beam of every transmission table as an explicit peak, see [`Separated`]; reflection is left as it is.
    pub fn with_separated_peaks(&self) -> Result<Self> {
        self.try_map(|_, _, scatter, model| match scatter {
            Scatter::Transmission => model.with_separated_peaks(),
            Scatter::Reflection => Ok(model.clone()),
        })
    }
}

impl Model {
    /// With the through-beam of every table in it as an explicit peak. Models without tables are left as they are.
    pub fn with_separated_peaks(&self) -> Result<Self> {
        Ok(match self {
            Self::Matrix(_) | Self::Tree(_) | Self::Reversed(_) => {
                Self::Separated(Separated::new(Arc::new(self.clone()))?)
            }
            Self::Sum(s) => {
                let parts = s.parts().iter();
                let parts = parts.map(|(w, m)| Ok((*w, Arc::new(m.with_separated_peaks()?))));
                Self::Sum(Sum::new(parts.collect::<Result<_>>()?)?)
            }
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().with_separated_peaks()?), t.turn())),
            Self::Lambertian(_) | Self::Specular(_) | Self::Beam(_) | Self::Separated(_) | Self::Interpolant(_) => {
                self.clone()
            }
            Self::Filtered(f) => Self::Filtered(f.with_base(f.base().with_separated_peaks()?)?),
        })
    }

    /// With separated peaks put back into the tables that they were taken from, and measured beams into the table beside
    /// which they were measured, as plain files carry them.
    #[must_use]
    pub fn unseparated(&self) -> Self {
        match self {
            Self::Separated(s) => s.base().unseparated(),
            Self::Sum(s) => {
                let Ok(sum) = Sum::new(s.parts().iter().map(|(w, m)| (*w, Arc::new(m.unseparated()))).collect()) else {
                    return self.clone();
                };
                with_beams_in_table(&sum).unwrap_or(Self::Sum(sum))
            }
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().unseparated()), t.turn())),
            _ => self.clone(),
        }
    }

    /// With separated peaks put back into the tables that they were taken from; measured beams stay beams.
    pub(super) fn without_separated(&self) -> Self {
        match self {
            Self::Separated(s) => s.base().without_separated(),
            Self::Sum(s) => {
                let parts = s.parts().iter();
                let parts = parts.map(|(w, m)| (*w, Arc::new(m.without_separated()))).collect();
                Sum::new(parts).map_or_else(|_| self.clone(), Self::Sum)
            }
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().without_separated()), t.turn())),
            _ => self.clone(),
        }
    }
}

/// A table and beams on its incident cells as one table; None for all else.
fn with_beams_in_table(sum: &Sum) -> Option<Model> {
    let (mut table, mut beams) = (None, Vec::new());
    for (w, part) in sum.parts() {
        match &**part {
            Model::Beam(beam) => beams.push((*w, beam)),
            Model::Matrix(_) | Model::Tree(_) if table.is_none() => table = Some(part.scaled(*w).ok()?),
            _ => return None,
        }
    }
    let beam = Beam::mixture(&beams)?;
    match table? {
        Model::Matrix(m) if *beam.cells() == Cells::Patches(m.incident().clone()) => {
            with_beam_in_matrix(&m, &beam).ok().map(Model::Matrix)
        }
        Model::Tree(t) => match beam.cells() {
            Cells::Tree(rank, levels) if *rank == t.rank() => t.with_beam(*levels, beam.values()).ok().map(Model::Tree),
            _ => None,
        },
        _ => None,
    }
}

/// A beam is spread evenly over its incident patch, so each outgoing patch takes the share that both have in common.
fn with_beam_in_matrix(matrix: &Matrix, beam: &Beam) -> Result<Matrix> {
    let n = matrix.outgoing().len();
    let areas = matrix.outgoing().projected_solid_angles();
    let mut values = matrix.values().to_vec();
    let mut errors = matrix.standard_errors().map(<[f64]>::to_vec);
    let covers = shares(matrix.incident(), matrix.outgoing(), Turn::NONE);
    for (i, cover) in covers.iter().enumerate() {
        for &(o, share) in cover {
            values[i * n + o] += beam.values()[i] * share / areas[o];
            if let (Some(errors), Some(of_beam)) = (&mut errors, beam.standard_errors()) {
                errors[i * n + o] = errors[i * n + o].hypot(of_beam[i] * share / areas[o]);
            }
        }
    }
    let mut result = Matrix::new(matrix.incident().clone(), matrix.outgoing().clone(), values)?;
    if let Some(errors) = errors {
        result = result.with_standard_errors(errors)?;
    }
    if let Some(totals) = matrix.total_standard_errors() {
        let of_beam = |i: usize| beam.standard_errors().map_or(0.0, |e| e[i]);
        let totals = totals.iter().enumerate().map(|(i, e)| e.hypot(of_beam(i))).collect();
        result = result.with_total_standard_errors(totals)?;
    }
    Ok(result)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::{Band, Lambertian, Metadata, Part, Rank, Reversed, Scatterer, Tree};
    use crate::direction::{Disk, Side};

    /// A haze and a beam of 0.4 in the patch straight through.
    fn sheet() -> Model {
        let basis = Arc::new(Basis::klems_full());
        let beam = |p: usize| 0.4 / basis.projected_solid_angle(p);
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| {
            0.06 + if i == o { beam(i) } else { 0.0 }
        });
        Model::Matrix(matrix.unwrap())
    }

    #[test]
    fn tables_within_other_models_are_found() {
        let table = Arc::new(sheet());
        let lambertian = Arc::new(Model::Lambertian(Lambertian::new(0.2).unwrap()));
        let turned = Arc::new(Model::Turned(Turned::new(table.clone(), Turn::new(0.3, false))));
        let sum = Model::Sum(Sum::new(vec![(0.5, table), (0.5, turned), (0.1, lambertian)]).unwrap());
        let separated = sum.with_separated_peaks().unwrap();
        let incident = Disk::from_angles(0.5, 1.0);
        assert_eq!(sum.total(incident, Part::Direct).value, 0.0);
        assert!((separated.total(incident, Part::Direct).value - 0.4).abs() < 1e-3);
        let all = |m: &Model| m.total(incident, Part::All).value;
        assert!((all(&separated) - all(&sum)).abs() < 1e-9);
        // Once more changes nothing.
        let again = separated.with_separated_peaks().unwrap();
        assert_eq!(again.peaks(incident), separated.peaks(incident));
        let reversed = Model::Reversed(Reversed::new(Arc::new(sheet())));
        let direct = reversed
            .with_separated_peaks()
            .unwrap()
            .total(incident, Part::Direct)
            .value;
        assert!((direct - 0.4).abs() < 1e-3);
        let mirror = Arc::new(Model::Specular(crate::bsdf::Specular::Constant(0.4)));
        assert!(Model::Reversed(Reversed::new(mirror)).with_separated_peaks().is_err());
    }

    #[test]
    fn measured_beams_go_into_the_table_and_keep_their_flux() {
        let (full, quarter) = (Arc::new(Basis::klems_full()), Arc::new(Basis::klems_quarter()));
        let value = |k: usize| 0.3 + 0.001 * k as f64;
        for outgoing in [full.clone(), quarter] {
            let table = Matrix::from_fn(full.clone(), outgoing.clone(), |_, _| 0.1).unwrap();
            let table = table.with_standard_errors(vec![0.01; 145 * outgoing.len()]).unwrap();
            let table = table.with_total_standard_errors(vec![0.03; 145]).unwrap();
            let beam = Beam::new(Cells::Patches(full.clone()), (0..145).map(value).collect()).unwrap();
            let beam = beam.with_standard_errors(vec![0.04; 145]).unwrap();
            let parts = vec![
                (0.5, Arc::new(Model::Matrix(table))),
                (0.5, Arc::new(Model::Beam(beam))),
            ];
            let sum = Model::Sum(Sum::new(parts).unwrap());
            let one = sum.unseparated();
            assert_eq!(one.kind(), "matrix");
            for k in 0..145 {
                let i = full.centre(k);
                let (a, b) = (sum.total(i, Part::All), one.total(i, Part::All));
                assert!((a.value - b.value).abs() < 1e-12);
                assert!((b.standard_error.unwrap() - 0.025).abs() < 1e-12, "{b:?}");
                assert!(one.evaluate(i, i) > 0.4);
            }
        }
    }

    #[test]
    fn measured_beams_go_into_trees() {
        for (rank, levels, depth) in [
            (Rank::Anisotropic, 3, 2),
            (Rank::Anisotropic, 2, 3),
            (Rank::Isotropic, 4, 2),
            (Rank::Isotropic, 2, 3),
        ] {
            let tree = Model::Tree(crate::bsdf::tree::testing::random(rank, depth, 3));
            let cells = Cells::Tree(rank, levels);
            let values = (0..cells.len()).map(|k| 0.1 + 0.01 * k as f64).collect();
            let beam = Model::Beam(Beam::new(cells, values).unwrap());
            let sum = Model::Sum(Sum::new(vec![(1.0, Arc::new(tree.clone())), (1.0, Arc::new(beam.clone()))]).unwrap());
            let one = sum.unseparated();
            assert_eq!(one.kind(), "tensor tree");
            for k in 0..200 {
                let i = Disk::uniform(crate::sequence::r2(k, [0.1; 2]));
                let (a, b) = (sum.total(i, Part::All).value, one.total(i, Part::All).value);
                assert!((a - b).abs() < 1e-5 * a, "{rank:?} {levels}: {a} {b}");
                let here = std::f64::consts::PI * 0.25_f64.powi(levels as i32);
                let share = if rank == Rank::Isotropic { 0.5 } else { 1.0 };
                let gained = one.evaluate(i, i) - tree.evaluate(i, i);
                let beam = beam.total(i, Part::All).value * share / here;
                assert!(
                    (gained - beam).abs() < 1e-4 * beam,
                    "{rank:?} {levels}: {gained} {beam}"
                );
            }
        }
        let tree = Arc::new(Model::Tree(Tree::constant(Rank::Isotropic, 0.1).unwrap()));
        let beam = Beam::new(Cells::Tree(Rank::Anisotropic, 1), vec![0.1; 4]).unwrap();
        let sum = Model::Sum(Sum::new(vec![(1.0, tree), (1.0, Arc::new(Model::Beam(beam)))]).unwrap());
        assert_eq!(sum.unseparated().kind(), "sum");
    }

    #[test]
    fn only_transmission_is_separated() {
        let band = Band::new("visible")
            .with(Side::Exterior, Scatter::Transmission, sheet())
            .with(Side::Exterior, Scatter::Reflection, sheet());
        let set = Bsdf::new(vec![band], Metadata::default())
            .unwrap()
            .with_separated_peaks()
            .unwrap();
        let kind = |scatter| set.bands()[0].get(Side::Exterior, scatter).unwrap().kind();
        assert_eq!(
            (kind(Scatter::Transmission), kind(Scatter::Reflection)),
            ("separated", "matrix")
        );
    }
}
