//! Peaks of whole data sets taken out of their tables.

use std::sync::Arc;

use super::{Bsdf, Model, Separated, Sum, Turned};
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
            Self::Lambertian(_) | Self::Specular(_) | Self::Separated(_) => self.clone(),
        })
    }

    /// With separated peaks put back into the tables that they were taken from, as plain files carry them.
    #[must_use]
    pub fn unseparated(&self) -> Self {
        match self {
            Self::Separated(s) => s.base().unseparated(),
            Self::Sum(s) => Sum::new(s.parts().iter().map(|(w, m)| (*w, Arc::new(m.unseparated()))).collect())
                .map_or_else(|_| self.clone(), Self::Sum),
            Self::Turned(t) => Self::Turned(Turned::new(Arc::new(t.base().unseparated()), t.turn())),
            _ => self.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::basis::Basis;
    use crate::bsdf::{Band, Lambertian, Matrix, Metadata, Part, Reversed, Scatterer, Turn};
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
