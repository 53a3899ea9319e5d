//! How far a model is from scattering alike from all azimuths.

use std::sync::Arc;

use super::{Sampling, to_matrix};
use crate::basis::{Basis, Ring};
use crate::bsdf::{Cells, Model, Rank, Specular};
use crate::error::Result;
use crate::progress::Progress;

/// Cells of each ring but the first.
const CELLS: usize = 6;

/// Share of the light that a turn of the sample would move: half of the mean absolute difference from the mean over all turns
/// by 60°, over the mean, between cells of 60° of azimuth and 25° to 30° of polar angle. 0 for an isotropic model, 1 for one
/// that scatters from one azimuth only; finer structure, such as that of a table's own patches, is not seen.
pub fn anisotropy(model: &Model, progress: &Progress) -> Result<f64> {
    if by_construction(model) {
        return Ok(0.0);
    }
    let limits = [0.0, 10.0, 35.0, 60.0, 90.0];
    let rings = (0..4).map(|k| Ring {
        lower_deg: limits[k],
        upper_deg: limits[k + 1],
        nominal_deg: 0.5 * (limits[k] + limits[k + 1]),
        count: if k == 0 { 1 } else { CELLS },
    });
    let basis = Arc::new(Basis::from_rings("isotropy", rings.collect())?);
    let matrix = to_matrix(model, &basis, &basis, Sampling::of(512), progress)?.matrix;
    let turned = |patch, steps| basis.turned(patch, steps, CELLS).unwrap_or(patch);
    let (mut difference, mut sum) = (0.0, 0.0);
    for i in 0..basis.len() {
        for o in 0..basis.len() {
            let of = |steps| matrix.value(turned(i, steps), turned(o, steps));
            let mean = (0..CELLS).map(of).sum::<f64>() / CELLS as f64;
            let area = basis.projected_solid_angle(i) * basis.projected_solid_angle(o);
            difference += 0.5 * (matrix.value(i, o) - mean).abs() * area;
            sum += matrix.value(i, o) * area;
        }
    }
    Ok(if sum > 0.0 { difference / sum } else { 0.0 })
}

/// Models whose kind makes them isotropic.
pub fn by_construction(model: &Model) -> bool {
    match model {
        Model::Lambertian(_) => true,
        Model::Specular(s) => !matches!(s, Specular::Patches { .. }),
        Model::Beam(b) => matches!(b.cells(), Cells::Tree(Rank::Isotropic, _)),
        Model::Tree(t) => t.rank() == Rank::Isotropic,
        Model::Sum(s) => s.parts().iter().all(|(_, m)| by_construction(m)),
        Model::Turned(t) => by_construction(t.base()),
        Model::Reversed(r) => by_construction(r.base()),
        Model::Separated(s) => by_construction(s.base()),
        Model::Interpolant(i) => i.isotropic(),
        Model::Filtered(f) => [f.base(), f.before(), f.after()]
            .into_iter()
            .all(|m| by_construction(m)),
        Model::Matrix(_) => false,
    }
}
