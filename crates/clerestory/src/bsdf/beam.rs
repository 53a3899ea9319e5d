//! A beam that keeps its disk point, straight through or mirrored in the sample's plane, with a value and a standard error
//! for each incident patch: what a measurement tells of light that was not scattered.

use std::f64::consts::FRAC_PI_2;
use std::sync::Arc;

use super::{Estimate, Part, Peak, Rank, Sample, Scatterer, Turn};
use crate::basis::Basis;
use crate::direction::Disk;
use crate::error::{Error, Result};

/// A division of the disk of incident directions.
#[derive(Debug, Clone, PartialEq)]
pub enum Cells {
    /// Patches of an angle basis.
    Patches(Arc<Basis>),
    /// Those of a tensor tree, 2^levels an axis: squares of the concentric map for rank 4, of which number y · 2^levels + x is
    /// x-th along the first axis and y-th along the second; rings for rank 3, the outermost first.
    Tree(Rank, u32),
}

impl Cells {
    /// Number of cells.
    pub fn len(&self) -> usize {
        match self {
            Self::Patches(basis) => basis.len(),
            Self::Tree(Rank::Anisotropic, levels) => 1 << (2 * levels),
            Self::Tree(Rank::Isotropic, levels) => 1 << levels.saturating_sub(1),
        }
    }

    /// Never.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// 0-based cell of a disk point.
    pub fn of(&self, point: Disk) -> usize {
        match *self {
            Self::Patches(ref basis) => basis.patch_of(point),
            Self::Tree(Rank::Anisotropic, levels) => {
                let n = 1_usize << levels;
                let [x, y] = point.to_square().map(|c| (c * n as f64) as usize);
                y * n + x
            }
            Self::Tree(Rank::Isotropic, levels) => {
                let n = f64::from(1_u32 << levels);
                let ring = (0.5 - 0.5 * point.sin2_theta().sqrt()).max(0.0) * n;
                (ring as usize).min(self.len() - 1)
            }
        }
    }

    /// Point of a cell, uniform in projected solid angle for uniform `u`; for rank 3 it travels toward +x.
    pub fn sample(&self, cell: usize, u: [f64; 2]) -> Disk {
        match *self {
            Self::Patches(ref basis) => basis.sample_cosine(cell, u),
            Self::Tree(Rank::Anisotropic, levels) => {
                let n = 1_usize << levels;
                let at = |k: usize, u: f64| (k as f64 + u) / n as f64;
                Disk::from_square([at(cell % n, u[0]), at(cell / n, u[1])])
            }
            Self::Tree(Rank::Isotropic, levels) => {
                let n = f64::from(1_u32 << levels);
                let [outer, inner] = [cell, cell + 1].map(|c| (1.0 - 2.0 * c as f64 / n).max(0.0));
                Disk::new((inner * inner + (outer * outer - inner * inner) * u[0]).sqrt(), 0.0)
            }
        }
    }

    /// Share of the disk's area.
    pub fn share(&self, cell: usize) -> f64 {
        match *self {
            Self::Patches(ref basis) => basis.projected_solid_angle(cell) / std::f64::consts::PI,
            Self::Tree(Rank::Anisotropic, levels) => 0.25_f64.powi(levels as i32),
            Self::Tree(Rank::Isotropic, levels) => {
                let n = f64::from(1_u32 << levels);
                let [outer, inner] = [cell, cell + 1].map(|c| (1.0 - 2.0 * c as f64 / n).max(0.0));
                outer * outer - inner * inner
            }
        }
    }

    /// The cell that a cell comes from in a mirrored or turned sample; None where the cells do not fall onto each other.
    fn source(&self, turn: Turn) -> Option<Vec<usize>> {
        const STEPS: usize = 360;
        let whole = |unit: f64| {
            let steps = turn.angle() / unit;
            ((steps - steps.round()).abs() < 1e-9).then(|| steps.round())
        };
        match self {
            Self::Patches(basis) => {
                let degrees = whole(1_f64.to_radians())?.rem_euclid(360.0) as usize;
                let back = (STEPS - degrees) % STEPS;
                let source = |patch| {
                    let unturned = basis.turned(patch, back, STEPS)?;
                    if turn.mirror() {
                        basis.mirrored(unturned)
                    } else {
                        Some(unturned)
                    }
                };
                (0..basis.len()).map(source).collect()
            }
            Self::Tree(Rank::Anisotropic, _) => {
                whole(FRAC_PI_2)?;
                let middle = |cell| self.sample(cell, [0.5; 2]);
                Some(
                    (0..self.len())
                        .map(|cell| self.of(turn.inverse().apply(middle(cell))))
                        .collect(),
                )
            }
            Self::Tree(Rank::Isotropic, _) => Some((0..self.len()).collect()),
        }
    }
}

/// A beam by incident patch.
#[derive(Debug, Clone, PartialEq)]
pub struct Beam {
    cells: Cells,
    values: Vec<f64>,
    standard_errors: Option<Vec<f64>>,
}

impl Beam {
    /// From one transmittance or reflectance a cell.
    pub fn new(cells: Cells, values: Vec<f64>) -> Result<Self> {
        if let Cells::Tree(_, levels) = cells
            && levels > 10
        {
            return Err(Error::Argument(format!(
                "a beam on 2^{levels} cells an axis is too fine (give at most 2^10)"
            )));
        }
        if values.len() != cells.len() {
            return Err(Error::Argument(format!(
                "{} values for the {} incident cells of a beam",
                values.len(),
                cells.len()
            )));
        }
        check(&values, "a transmittance or reflectance")?;
        Ok(Self {
            cells,
            values,
            standard_errors: None,
        })
    }

    /// With one standard error a value.
    pub fn with_standard_errors(mut self, errors: Vec<f64>) -> Result<Self> {
        if errors.len() != self.values.len() {
            return Err(Error::Argument(format!(
                "{} standard errors for {} values",
                errors.len(),
                self.values.len()
            )));
        }
        check(&errors, "a standard error")?;
        self.standard_errors = Some(errors);
        Ok(self)
    }

    /// Where the values hold.
    pub fn cells(&self) -> &Cells {
        &self.cells
    }

    /// Transmittances or reflectances, one a cell.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Standard errors, one a cell.
    pub fn standard_errors(&self) -> Option<&[f64]> {
        self.standard_errors.as_deref()
    }

    /// Transmittance or reflectance for light from a direction.
    pub fn value(&self, incident: Disk) -> f64 {
        self.values[self.cells.of(incident)]
    }

    /// Values multiplied by a factor of 0 or more for each cell.
    #[must_use]
    pub fn scaled(&self, factor: impl Fn(usize) -> f64) -> Self {
        let scale = |v: &[f64]| v.iter().enumerate().map(|(k, v)| v * factor(k)).collect();
        Self {
            cells: self.cells.clone(),
            values: scale(&self.values),
            standard_errors: self.standard_errors.as_deref().map(scale),
        }
    }

    /// The beam of the mirrored or turned sample, where the cells fall onto each other.
    pub fn turned(&self, turn: Turn) -> Option<Self> {
        let source = self.cells.source(turn)?;
        Some(self.picked(&source))
    }

    /// The beam of the paths travelled backwards, where the cells fall onto each other.
    pub fn reversed(&self) -> Option<Self> {
        if let Cells::Patches(basis) = &self.cells {
            // Rings of an even number of patches: more than a turn by whole degrees finds.
            let source: Vec<usize> = (0..basis.len()).map(|p| basis.reversed(p)).collect::<Option<_>>()?;
            return Some(self.picked(&source));
        }
        self.turned(Turn::new(std::f64::consts::PI, false))
    }

    /// With each cell's value taken from another one.
    fn picked(&self, source: &[usize]) -> Self {
        let pick = |v: &[f64]| source.iter().map(|&k| v[k]).collect();
        Self {
            cells: self.cells.clone(),
            values: pick(&self.values),
            standard_errors: self.standard_errors.as_deref().map(pick),
        }
    }

    /// Weighted sum of beams on the same cells; None where they differ.
    pub fn mixture(parts: &[(f64, &Self)]) -> Option<Self> {
        let (_, first) = parts.first()?;
        if parts.iter().any(|(_, b)| b.cells != first.cells) {
            return None;
        }
        let sum = |k: usize| parts.iter().map(|(w, b)| w * b.values[k]).sum();
        let known = parts.iter().any(|(_, b)| b.standard_errors.is_some());
        let error = |k: usize| {
            let errors = parts
                .iter()
                .filter_map(|(w, b)| Some((w * b.standard_errors.as_ref()?[k]).powi(2)));
            errors.sum::<f64>().sqrt()
        };
        let n = first.values.len();
        Some(Self {
            cells: first.cells.clone(),
            values: (0..n).map(sum).collect(),
            standard_errors: known.then(|| (0..n).map(error).collect()),
        })
    }
}

fn check(values: &[f64], what: &str) -> Result<()> {
    match values.iter().find(|v| !(v.is_finite() && **v >= 0.0)) {
        Some(v) => Err(Error::Argument(format!(
            "{v} is not {what} of a beam (give a finite number of 0 or more)"
        ))),
        None => Ok(()),
    }
}

impl Scatterer for Beam {
    fn evaluate(&self, _: Disk, _: Disk) -> f64 {
        0.0
    }

    fn peaks(&self, incident: Disk) -> Vec<Peak> {
        Peak::straight(incident, self.value(incident))
    }

    fn sample(&self, incident: Disk, _: [f64; 2]) -> Option<Sample> {
        Sample::straight(incident, self.value(incident))
    }

    fn pdf(&self, _: Disk, _: Disk) -> f64 {
        0.0
    }

    fn total(&self, incident: Disk, part: Part) -> Estimate {
        if part == Part::Scattered {
            return 0.0.into();
        }
        let cell = self.cells.of(incident);
        Estimate {
            value: self.values[cell],
            standard_error: self.standard_errors.as_ref().map(|e| e[cell]),
        }
    }

    fn resolution(&self, _: Disk) -> f64 {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::Model;
    use crate::sequence::{r2, uniform};

    fn all() -> Vec<Beam> {
        [
            Cells::Patches(Arc::new(Basis::klems_full())),
            Cells::Tree(Rank::Anisotropic, 3),
            Cells::Tree(Rank::Isotropic, 4),
            Cells::Tree(Rank::Isotropic, 0),
        ]
        .into_iter()
        .map(|cells| {
            let n = cells.len() as u64;
            let beam = Beam::new(cells, (0..n).map(|k| uniform(1, k)).collect()).unwrap();
            beam.with_standard_errors((0..n).map(|k| uniform(2, k)).collect())
                .unwrap()
        })
        .collect()
    }

    #[test]
    fn samples_of_a_cell_lie_in_it_and_shares_fill_the_disk() {
        for beam in all() {
            let cells = beam.cells();
            assert!(((0..cells.len()).map(|c| cells.share(c)).sum::<f64>() - 1.0).abs() < 1e-12);
            for cell in 0..cells.len() {
                for k in 0..20 {
                    assert_eq!(cells.of(cells.sample(cell, r2(k, [0.0; 2]))), cell);
                }
            }
        }
    }

    #[test]
    fn it_is_a_beam_straight_on() {
        for beam in all() {
            let i = Disk::new(0.31, -0.47);
            let value = beam.value(i);
            assert_eq!(beam.evaluate(i, i), 0.0);
            assert_eq!(beam.peaks(i)[0].outgoing, i);
            assert_eq!(beam.total(i, Part::Direct).value, value);
            assert!(beam.total(i, Part::All).standard_error.unwrap() > 0.0);
            assert_eq!(beam.total(i, Part::Scattered).value, 0.0);
            assert_eq!(beam.sample(i, [0.5; 2]).unwrap().weight, value);
        }
    }

    #[test]
    fn turned_and_reversed_beams_are_what_the_directions_say() {
        let quarter = std::f64::consts::FRAC_PI_2;
        for beam in all() {
            let model = Model::Beam(beam.clone());
            for turn in [
                Turn::new(quarter, false),
                Turn::new(-quarter, true),
                Turn::new(0.3, true),
            ] {
                let turned = model.turned(turn);
                for k in 0..100 {
                    let i = Disk::uniform(r2(k, [0.2; 2]));
                    assert_eq!(
                        turned.total(turn.apply(i), Part::All),
                        model.total(i, Part::All),
                        "{turn:?}"
                    );
                }
            }
            let back = model.reciprocal();
            assert_eq!(back.kind(), "beam");
            for k in 0..100 {
                let i = Disk::uniform(r2(k, [0.2; 2]));
                assert_eq!(back.total(i.reversed(), Part::All), model.total(i, Part::All));
            }
        }
    }

    #[test]
    fn what_is_no_beam_is_refused() {
        let cells = Cells::Tree(Rank::Anisotropic, 1);
        assert!(Beam::new(cells.clone(), vec![0.5; 3]).is_err());
        assert!(Beam::new(cells.clone(), vec![-0.5; 4]).is_err());
        let beam = Beam::new(cells, vec![0.5; 4]).unwrap();
        assert!(beam.clone().with_standard_errors(vec![f64::NAN; 4]).is_err());
        assert!(beam.with_standard_errors(vec![]).is_err());
    }
}
