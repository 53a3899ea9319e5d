//! Between which measured incident directions a direction lies.
//!
//! Isotropic samples have a chain of polar angles. All others have triangles: Delaunay's on the sphere, which are those of the
//! stereographic projection. Weights are barycentric on the disk of travel, so light that goes straight on, is mirrored or
//! is turned by a grating is found exactly where it goes.

use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::sequence::uniform;

/// How incident directions hang together.
#[derive(Debug, Clone)]
pub enum Mesh {
    /// In rising order along +x.
    Chain(Vec<f64>),
    /// Corners' numbers.
    Triangles(Vec<Disk>, Vec<[usize; 3]>),
}

/// Corners about a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Numbers of one to three corners.
    pub corners: [usize; 3],
    /// How many of them count.
    pub count: usize,
    /// Shares of what they carry, 0 or more.
    pub shares: [f64; 3],
    /// Shares of their positions, which go on beyond the mesh.
    pub reach: [f64; 3],
    /// Distance (on the disk) to the mesh; 0 in it.
    pub beyond: f64,
}

impl Mesh {
    /// Points on +x, in any order; they have to be in rising order in what they index.
    pub fn chain(points: &[Disk]) -> Result<Self> {
        let places: Vec<f64> = points.iter().map(|p| p.x).collect();
        if places.len() < 2 {
            return Err(Error::Argument(
                "one incident angle does not make a model (measure two or more)".into(),
            ));
        }
        Ok(Self::Chain(places))
    }

    /// Delaunay triangles of three or more points that do not lie on a line.
    pub fn triangles(points: &[Disk]) -> Result<Self> {
        let flat: Vec<[f64; 2]> = points
            .iter()
            .enumerate()
            .map(|(k, p)| {
                let scale = 1.0 + p.cos_theta();
                // Grids of directions lie on common circles; a hair of disorder decides.
                let hair = |axis| 1e-7 * (uniform(axis, k as u64) - 0.5);
                [p.x / scale + hair(71), p.y / scale + hair(72)]
            })
            .collect();
        let triangles: Vec<[usize; 3]> = delaunay(&flat)
            .into_iter()
            .filter(|&[a, b, c]| area(points[a], points[b], points[c]) > 1e-5)
            .collect();
        if triangles.is_empty() {
            return Err(Error::Argument(
                "the incident directions lie on a line (say that the sample is isotropic, or measure other azimuths)"
                    .into(),
            ));
        }
        Ok(Self::Triangles(points.to_vec(), triangles))
    }

    /// Pairs of neighbours, the lower number first.
    pub fn edges(&self) -> Vec<(usize, usize)> {
        match self {
            Self::Chain(places) => (1..places.len()).map(|k| (k - 1, k)).collect(),
            Self::Triangles(_, triangles) => {
                let mut edges: Vec<(usize, usize)> = triangles
                    .iter()
                    .flat_map(|&[a, b, c]| [(a, b), (b, c), (a, c)])
                    .map(|(a, b)| (a.min(b), a.max(b)))
                    .collect();
                edges.sort_unstable();
                edges.dedup();
                edges
            }
        }
    }

    /// Where a point lies; one of a chain on +x.
    pub fn place(&self, point: Disk) -> Place {
        match self {
            Self::Chain(places) => {
                let after = places.partition_point(|&p| p < point.x).clamp(1, places.len() - 1);
                let (a, b) = (places[after - 1], places[after]);
                let t = (point.x - a) / (b - a);
                let share = t.clamp(0.0, 1.0);
                let reach = t.clamp(-1.0, 2.0);
                Place {
                    corners: [after - 1, after, 0],
                    count: 2,
                    shares: [1.0 - share, share, 0.0],
                    reach: [1.0 - reach, reach, 0.0],
                    beyond: ((t - share) * (b - a)).abs(),
                }
            }
            Self::Triangles(points, triangles) => {
                let places = triangles.iter().map(|&corners| in_triangle(points, corners, point));
                places
                    .min_by(|a, b| a.beyond.total_cmp(&b.beyond))
                    .expect("there is a triangle")
            }
        }
    }

    /// The corner that is nearest.
    pub fn nearest(&self, point: Disk) -> usize {
        let closest = |points: &mut dyn Iterator<Item = f64>| {
            let by = points.enumerate().min_by(|a, b| a.1.total_cmp(&b.1));
            by.map_or(0, |(k, _)| k)
        };
        match self {
            Self::Chain(places) => closest(&mut places.iter().map(|p| (p.asin() - point.x.asin()).abs())),
            Self::Triangles(points, _) => closest(&mut points.iter().map(|p| p.angle_to(point))),
        }
    }
}

fn area(a: Disk, b: Disk, c: Disk) -> f64 {
    0.5 * ((b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x)).abs()
}

fn in_triangle(points: &[Disk], corners: [usize; 3], point: Disk) -> Place {
    const FARTHEST: f64 = 1.0;
    let [a, b, c] = corners.map(|k| points[k]);
    let cross = |p: Disk, q: Disk, r: Disk| (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
    let whole = cross(a, b, c);
    let reach = [
        cross(point, b, c) / whole,
        cross(a, point, c) / whole,
        cross(a, b, point) / whole,
    ];
    if reach.iter().all(|&w| w >= -1e-12) {
        let shares = reach.map(|w| w.max(0.0));
        return Place {
            corners,
            count: 3,
            shares,
            reach: shares,
            beyond: 0.0,
        };
    }
    // The nearest point of the border.
    let mut best = (f64::INFINITY, [0.0; 3]);
    for (i, j) in [(0, 1), (1, 2), (2, 0)] {
        let (p, q) = ([a, b, c][i], [a, b, c][j]);
        let (dx, dy) = (q.x - p.x, q.y - p.y);
        let t = (((point.x - p.x) * dx + (point.y - p.y) * dy) / (dx * dx + dy * dy)).clamp(0.0, 1.0);
        let distance = (p.x + t * dx - point.x).hypot(p.y + t * dy - point.y);
        if distance < best.0 {
            let mut shares = [0.0; 3];
            shares[i] = 1.0 - t;
            shares[j] = t;
            best = (distance, shares);
        }
    }
    let (beyond, shares) = best;
    let farthest = reach.iter().zip(shares).map(|(r, s)| (r - s).abs()).fold(0.0, f64::max);
    let step = (FARTHEST / farthest).min(1.0);
    Place {
        corners,
        count: 3,
        shares,
        reach: std::array::from_fn(|k| shares[k] + step * (reach[k] - shares[k])),
        beyond,
    }
}

/// Bowyer and Watson's triangulation of a few hundred points.
fn delaunay(points: &[[f64; 2]]) -> Vec<[usize; 3]> {
    const FAR: f64 = 1e4;
    let n = points.len();
    let mut all = points.to_vec();
    all.extend([[-FAR, -FAR], [FAR, -FAR], [0.0, FAR]]);
    let mut triangles = vec![[n, n + 1, n + 2]];
    for k in 0..n {
        let (bad, good): (Vec<_>, Vec<_>) = triangles.into_iter().partition(|t| in_circle(&all, *t, all[k]));
        let edges: Vec<(usize, usize)> = bad.iter().flat_map(|&[a, b, c]| [(a, b), (b, c), (c, a)]).collect();
        triangles = good;
        for &(a, b) in &edges {
            if !edges.contains(&(b, a)) {
                triangles.push([a, b, k]);
            }
        }
    }
    triangles.retain(|t| t.iter().all(|&k| k < n));
    triangles
}

/// Whether a point lies in the circle about a triangle that is counter-clockwise.
fn in_circle(all: &[[f64; 2]], [a, b, c]: [usize; 3], p: [f64; 2]) -> bool {
    let [a, b, c] = [a, b, c].map(|k| {
        let (x, y) = (all[k][0] - p[0], all[k][1] - p[1]);
        (x, y, x * x + y * y)
    });
    a.2 * (b.0 * c.1 - b.1 * c.0) - b.2 * (a.0 * c.1 - a.1 * c.0) + c.2 * (a.0 * b.1 - a.1 * b.0) > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::r2;

    fn grid() -> Vec<Disk> {
        let mut points = vec![Disk::NORMAL];
        for theta in 1..9 {
            for phi in 0..24 {
                points.push(Disk::from_angles(
                    f64::from(theta * 10).to_radians(),
                    f64::from(phi * 15).to_radians(),
                ));
            }
        }
        points
    }

    #[test]
    fn triangles_fill_the_disk_and_weights_give_the_point_back() {
        let points = grid();
        let mesh = Mesh::triangles(&points).unwrap();
        let Mesh::Triangles(_, triangles) = &mesh else {
            unreachable!()
        };
        let sum: f64 = triangles
            .iter()
            .map(|&[a, b, c]| area(points[a], points[b], points[c]))
            .sum();
        let ring = 80_f64.to_radians().sin();
        let polygon = 12.0 * ring * ring * 15_f64.to_radians().sin();
        assert!((sum - polygon).abs() < 1e-9, "{sum} {polygon}");
        for k in 0..500 {
            let point = Disk::uniform(r2(k, [0.3; 2]));
            let place = mesh.place(point);
            let sum =
                |of: fn(Disk) -> f64| -> f64 { (0..3).map(|c| place.reach[c] * of(points[place.corners[c]])).sum() };
            if place.beyond < 0.02 {
                assert!((sum(|p| p.x) - point.x).abs() < 1e-9 && (sum(|p| p.y) - point.y).abs() < 1e-9);
            }
            assert!((place.shares.iter().sum::<f64>() - 1.0).abs() < 1e-9);
            assert_eq!(place.beyond > 0.0, place.shares != place.reach);
        }
    }

    #[test]
    fn points_on_a_line_are_refused() {
        let line: Vec<Disk> = (0..5).map(|k| Disk::new(0.2 * f64::from(k), 0.0)).collect();
        assert!(Mesh::triangles(&line).unwrap_err().to_string().contains("isotropic"));
        assert!(Mesh::chain(&line[..1]).is_err());
    }
}
