//! A direct-hemispherical value between the incident directions at which it was measured, and beyond them.
//!
//! In between it is smooth in angle: a monotone cubic (Fritsch and Carlson 1980) of the polar angle of a chain, a thin-plate
//! spline of all others. Beyond the last polar angle it goes on toward 0 as a power of the cosine or, where it rises, toward 1.

use std::f64::consts::FRAC_PI_2;

use crate::direction::Disk;

/// A function of the incident direction.
#[derive(Debug, Clone)]
pub struct Trend {
    kind: Kind,
    last: f64,
    least: f64,
    most: f64,
}

#[derive(Debug, Clone)]
enum Kind {
    Chain {
        angles: Vec<f64>,
        values: Vec<f64>,
        slopes: Vec<f64>,
    },
    /// What all azimuths have in common, where there are rings of them, and a plate for the rest: it would sag between
    /// azimuths where values are steep.
    Plate {
        common: Option<Box<Trend>>,
        centres: Vec<[f64; 2]>,
        weights: Vec<f64>,
    },
}

impl Trend {
    /// Of values at points of a chain on +x, in any order, alike on both sides of the normal.
    pub fn chain(points: &[Disk], values: &[f64]) -> Self {
        let mut pairs: Vec<(f64, f64)> = points
            .iter()
            .zip(values)
            .flat_map(|(p, &v)| [(p.theta(), v), (-p.theta(), v)])
            .collect();
        pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
        pairs.dedup_by(|b, a| (a.0 - b.0).abs() < 1e-9);
        let (angles, values): (Vec<f64>, Vec<f64>) = pairs.into_iter().unzip();
        let slopes = monotone(&angles, &values);
        let last = *angles.last().expect("two points");
        Self::new(
            Kind::Chain {
                angles,
                values: values.clone(),
                slopes,
            },
            last,
            &values,
        )
    }

    /// Of values at points of a mesh.
    pub fn plate(points: &[Disk], values: &[f64]) -> Self {
        let centres: Vec<[f64; 2]> = points.iter().map(|&p| flat(p)).collect();
        let common = common(points, values).map(Box::new);
        let n = centres.len();
        let mut rows = vec![vec![0.0; n + 4]; n + 3];
        for i in 0..n {
            for j in 0..n {
                rows[i][j] = plate(centres[i], centres[j]);
            }
            for (k, v) in [1.0, centres[i][0], centres[i][1]].into_iter().enumerate() {
                rows[i][n + k] = v;
                rows[n + k][i] = v;
            }
            rows[i][n + 3] = values[i] - common.as_ref().map_or(0.0, |c| c.inside(points[i].theta(), 0.0));
        }
        let weights = solved(rows);
        let last = points.iter().map(|p| p.theta()).fold(0.0, f64::max);
        let kind = Kind::Plate {
            common,
            centres,
            weights,
        };
        Self::new(kind, last, values)
    }

    fn new(kind: Kind, last: f64, values: &[f64]) -> Self {
        let least = values.iter().copied().fold(f64::INFINITY, f64::min);
        let most = values.iter().copied().fold(0.0, f64::max);
        let margin = 0.1 * (most - least);
        Self {
            kind,
            last,
            least: (least - margin).max(0.0),
            most: (most + margin).min(1.0),
        }
    }

    /// Its value, 0 to 1.
    pub fn at(&self, incident: Disk) -> f64 {
        /// How far back the power is taken from.
        const BACK: f64 = 0.1745;
        let (theta, phi) = (incident.theta(), incident.phi());
        if theta <= self.last {
            return self.inside(theta, phi);
        }
        let here = self.inside(self.last, phi);
        let before = self.inside((self.last - BACK).max(0.0), phi);
        let cosines = (self.last.cos() / (self.last - BACK).max(0.0).cos()).ln();
        let on = (theta.min(FRAC_PI_2).cos().max(1e-9) / self.last.cos()).ln();
        let power = |here: f64, before: f64| {
            if here <= 0.0 || before <= here {
                return here;
            }
            here * ((here / before).ln() / cosines * on).exp()
        };
        if before > here {
            power(here, before)
        } else {
            1.0 - power(1.0 - here, 1.0 - before)
        }
    }

    fn inside(&self, theta: f64, phi: f64) -> f64 {
        let value = match &self.kind {
            Kind::Chain { angles, values, slopes } => {
                let k = angles.partition_point(|&a| a < theta).clamp(1, angles.len() - 1);
                let width = angles[k] - angles[k - 1];
                let t = ((theta - angles[k - 1]) / width).clamp(0.0, 1.0);
                let s = 1.0 - t;
                (1.0 + 2.0 * t) * s * s * values[k - 1]
                    + t * s * s * width * slopes[k - 1]
                    + t * t * (3.0 - 2.0 * t) * values[k]
                    - t * t * s * width * slopes[k]
            }
            Kind::Plate {
                common,
                centres,
                weights,
            } => {
                let at = [theta * phi.cos(), theta * phi.sin()];
                let n = centres.len();
                let sum: f64 = centres.iter().zip(weights).map(|(&c, w)| w * plate(at, c)).sum();
                let common = common.as_ref().map_or(0.0, |c| c.inside(theta, 0.0));
                common + sum + weights[n] + weights[n + 1] * at[0] + weights[n + 2] * at[1]
            }
        };
        value.clamp(self.least, self.most)
    }
}

/// The mean over azimuths by polar angle, where directions lie on a few rings.
fn common(points: &[Disk], values: &[f64]) -> Option<Trend> {
    const ALIKE: f64 = 1e-4;
    let mut order: Vec<usize> = (0..points.len()).collect();
    order.sort_by(|&a, &b| points[a].theta().total_cmp(&points[b].theta()));
    let rings: Vec<&[usize]> = order
        .chunk_by(|&a, &b| points[b].theta() - points[a].theta() < ALIKE)
        .collect();
    if rings.len() < 2 || 3 * rings.len() > points.len() {
        return None;
    }
    let middles: Vec<Disk> = rings
        .iter()
        .map(|r| Disk::from_angles(points[r[0]].theta(), 0.0))
        .collect();
    let means: Vec<f64> = rings
        .iter()
        .map(|r| r.iter().map(|&k| values[k]).sum::<f64>() / r.len() as f64)
        .collect();
    Some(Trend::chain(&middles, &means))
}

fn flat(point: Disk) -> [f64; 2] {
    let (s, c) = point.phi().sin_cos();
    [point.theta() * c, point.theta() * s]
}

fn plate(a: [f64; 2], b: [f64; 2]) -> f64 {
    let r2 = (a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2);
    if r2 > 0.0 { r2 * r2.ln() } else { 0.0 }
}

/// Slopes at which a cubic does not overshoot.
fn monotone(x: &[f64], y: &[f64]) -> Vec<f64> {
    let secant: Vec<f64> = (1..x.len()).map(|k| (y[k] - y[k - 1]) / (x[k] - x[k - 1])).collect();
    (0..x.len())
        .map(|k| {
            if k == 0 {
                return secant[0];
            }
            if k == x.len() - 1 {
                // A parabola through the last three.
                let Some(&before) = secant.get(secant.len().wrapping_sub(2)) else {
                    return secant[k - 1];
                };
                let (h, g) = (x[k] - x[k - 1], x[k - 1] - x[k - 2]);
                let slope = ((2.0 * h + g) * secant[k - 1] - h * before) / (h + g);
                let limit = 3.0 * secant[k - 1].abs();
                return if slope * secant[k - 1] <= 0.0 {
                    0.0
                } else {
                    slope.clamp(-limit, limit)
                };
            }
            let (a, b) = (secant[k - 1], secant[k]);
            if a * b <= 0.0 {
                return 0.0;
            }
            let (h, g) = (x[k] - x[k - 1], x[k + 1] - x[k]);
            3.0 * (h + g) / ((2.0 * g + h) / a + (g + 2.0 * h) / b)
        })
        .collect()
}

/// Solution of rows of coefficients and a right side, by elimination with pivots.
fn solved(mut rows: Vec<Vec<f64>>) -> Vec<f64> {
    let n = rows.len();
    for k in 0..n {
        let pivot = (k..n)
            .max_by(|&a, &b| rows[a][k].abs().total_cmp(&rows[b][k].abs()))
            .unwrap_or(k);
        rows.swap(k, pivot);
        let (top, below) = rows.split_at_mut(k + 1);
        let top = &top[k];
        if top[k] == 0.0 {
            continue;
        }
        for row in below {
            let factor = row[k] / top[k];
            if factor != 0.0 {
                for (v, t) in row[k..].iter_mut().zip(&top[k..]) {
                    *v -= factor * t;
                }
            }
        }
    }
    let mut x = vec![0.0; n];
    for k in (0..n).rev() {
        let sum: f64 = (k + 1..n).map(|j| rows[k][j] * x[j]).sum();
        x[k] = if rows[k][k] == 0.0 {
            0.0
        } else {
            (rows[k][n] - sum) / rows[k][k]
        };
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pane_s_transmittance_is_found_between_angles() {
        use crate::bsdf::Slab;
        use crate::direction::Scatter;
        let pane = Slab::new(1.52, 0.97).unwrap();
        let truth = |p: Disk| pane.value(p, Scatter::Transmission);
        let chain: Vec<Disk> = (0..9)
            .map(|k| Disk::from_angles(f64::from(k * 10).to_radians(), 0.0))
            .collect();
        let grid: Vec<Disk> = (0..9)
            .flat_map(|k| (0..if k == 0 { 1 } else { 24 }).map(move |a| (k, a)))
            .map(|(k, a)| Disk::from_angles(f64::from(k * 10).to_radians(), f64::from(a * 15).to_radians()))
            .collect();
        let values = |points: &[Disk]| points.iter().map(|&p| truth(p)).collect::<Vec<_>>();
        for trend in [
            Trend::chain(&chain, &values(&chain)),
            Trend::plate(&grid, &values(&grid)),
        ] {
            for k in 0..75 {
                let at = Disk::from_angles(f64::from(k).to_radians(), 0.4);
                assert!(
                    (trend.at(at) - truth(at)).abs() < 0.008,
                    "{k}: {} {}",
                    trend.at(at),
                    truth(at)
                );
            }
            let last = Disk::from_angles(89.9_f64.to_radians(), 0.4);
            assert!(trend.at(last) < 0.1 * truth(chain[8]));
        }
    }

    #[test]
    fn what_rises_goes_on_to_one() {
        let chain: Vec<Disk> = (0..9)
            .map(|k| Disk::from_angles(f64::from(k * 10).to_radians(), 0.0))
            .collect();
        let values: Vec<f64> = (0..9).map(|k| 0.1 + 0.4 * (f64::from(k) / 8.0).powi(3)).collect();
        let trend = Trend::chain(&chain, &values);
        let high = trend.at(Disk::from_angles(89.99_f64.to_radians(), 0.0));
        assert!(high > 0.9 && high <= 1.0, "{high}");
    }
}
