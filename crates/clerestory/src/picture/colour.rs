//! Colour of pictures: primaries, luminance, and the CIE's X, Y and Z.

use crate::error::{Error, Result};

/// Luminous efficacy of Radiance's white light (lumens a watt).
pub const EFFICACY: f64 = 179.0;
/// Chromaticities x and y of Radiance's red, green, blue and white.
pub const PRIMARIES: [f64; 8] = [0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 0.3333, 0.3333];
/// Shares of the three channels in the luminance, for [`PRIMARIES`].
pub const LUMINANCE: [f64; 3] = [0.265_074_126, 0.670_114_631, 0.064_811_243];

type Matrix = [[f64; 3]; 3];

/// Matrix from red, green and blue to X, Y and Z; white (1, 1, 1) has Y = 1.
///
/// # Errors
/// The primaries lie on a line, or one of them has no luminance to speak of.
pub fn to_xyz(primaries: &[f64; 8]) -> Result<Matrix> {
    let fail = || {
        Err(Error::Argument(format!(
            "the primaries {primaries:?} are no colours of a display (give x and y of red, green, blue and white)"
        )))
    };
    let [xr, yr, xg, yg, xb, yb, xw, yw] = *primaries;
    if !primaries.iter().all(|v| v.is_finite()) || yw <= 1e-6 {
        return fail();
    }
    let columns = [
        [xr, xg, xb],
        [yr, yg, yb],
        [1.0 - xr - yr, 1.0 - xg - yg, 1.0 - xb - yb],
    ];
    let white = [xw / yw, 1.0, (1.0 - xw - yw) / yw];
    let Some(inverse) = inverse(&columns) else {
        return fail();
    };
    let scale = apply(&inverse, white);
    if scale.iter().any(|s| !s.is_finite() || *s <= 0.0) {
        return fail();
    }
    Ok(columns.map(|row| [row[0] * scale[0], row[1] * scale[1], row[2] * scale[2]]))
}

/// Matrix from X, Y and Z to red, green and blue.
pub fn from_xyz(primaries: &[f64; 8]) -> Result<Matrix> {
    let matrix = to_xyz(primaries)?;
    inverse(&matrix).ok_or_else(|| Error::Argument(format!("the primaries {primaries:?} lie on a line")))
}

/// Shares of the three channels in the luminance.
pub fn luminance_weights(primaries: Option<&[f64; 8]>) -> Result<[f64; 3]> {
    match primaries {
        None => Ok(LUMINANCE),
        Some(p) => Ok(to_xyz(p)?[1]),
    }
}

/// A matrix times a vector.
pub fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

fn inverse(m: &Matrix) -> Option<Matrix> {
    let cofactor = |r: usize, c: usize| {
        let (a, b, d, e) = ((r + 1) % 3, (r + 2) % 3, (c + 1) % 3, (c + 2) % 3);
        m[a][d] * m[b][e] - m[a][e] * m[b][d]
    };
    let determinant: f64 = (0..3).map(|c| m[0][c] * cofactor(0, c)).sum();
    if determinant.abs() < 1e-9 || !determinant.is_finite() {
        return None;
    }
    Some(std::array::from_fn(|r| {
        std::array::from_fn(|c| cofactor(c, r) / determinant)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn radiance_weights_follow_from_its_primaries() {
        let weights = luminance_weights(Some(&PRIMARIES)).unwrap();
        for (a, b) in weights.iter().zip(LUMINANCE) {
            assert!((a - b).abs() < 1e-8, "{weights:?}");
        }
    }

    #[test]
    fn colours_come_back() {
        let colour = [0.3, 1.7, 0.02];
        let there = apply(&to_xyz(&PRIMARIES).unwrap(), colour);
        let back = apply(&from_xyz(&PRIMARIES).unwrap(), there);
        for (a, b) in colour.iter().zip(back) {
            assert!((a - b).abs() < 1e-12);
        }
        assert!(to_xyz(&[0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.33, 0.33]).is_err());
        assert!(to_xyz(&[0.64, 0.33, 0.29, 0.60, 0.15, 0.06, 0.33, 0.0]).is_err());
    }
}
