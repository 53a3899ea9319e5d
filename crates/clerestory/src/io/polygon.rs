//! Polygons into triangles.

use crate::error::Error;
use crate::error::Result;
use crate::geometry::Vec3;
use crate::io::counted;

/// Triangles that make up a flat polygon, as numbers of its corners, in the polygon's sense. Holes are joined to the outside
/// by a seam: two sides on top of each other (as Radiance draws them). Corners that make no angle stay corners, so that
/// neighbours meet them.
pub(crate) fn triangles(corners: &[Vec3]) -> Result<Vec<[usize; 3]>> {
    let n = corners.len();
    if n < 3 {
        return Err(Error::Argument(format!(
            "a polygon with {} (give three or more)",
            counted(n, "corner")
        )));
    }
    let (normal, reach) = size(corners);
    if !normal.length().is_finite() {
        return Err(Error::Argument(
            "a polygon with a corner that is no point (repair it)".into(),
        ));
    }
    if is_nothing(corners) {
        return Err(Error::Argument("a polygon without area (remove it)".into()));
    }
    if n == 3 {
        return Ok(vec![[0, 1, 2]]);
    }
    let normal = normal.unit();
    let from = |k: usize| corners[k] - corners[0];
    let off = (0..n).map(|k| from(k).dot(normal).abs()).fold(0.0, f64::max);
    if off > 1e-3 * reach && n == 4 {
        // A bent square, as programs for curved shapes write them, is folded where most fold it.
        return Ok(vec![[0, 1, 2], [0, 2, 3]]);
    }
    if off > 1e-3 * reach {
        return Err(Error::Argument(format!(
            "a polygon that is not flat: a corner lies {off:.3e} off its plane, at a size of {reach:.3e} (cut it into triangles)"
        )));
    }
    let [u, v] = normal.frame();
    let flat: Vec<[f64; 2]> = (0..n).map(|k| [from(k).dot(u), from(k).dot(v)]).collect();
    ears(&flat, outline(&flat), reach * reach * 1e-13)
}

/// Numbers of the corners in order, with the loops of holes against the sense of what they are in: programs that count
/// crossings take holes of either sense, and their files have both.
fn outline(flat: &[[f64; 2]]) -> Vec<usize> {
    let n = flat.len();
    let mut order: Vec<usize> = (0..n).collect();
    for first in 0..n {
        for last in first + 3..n {
            // A seam goes there and back.
            let (before, after) = ((first + n - 1) % n, (last + 1) % n);
            if flat[first] != flat[last] || flat[before] != flat[after] || before == after {
                continue;
            }
            let around: Vec<[f64; 2]> = flat[..first].iter().chain(&flat[last + 1..]).copied().collect();
            if area(&flat[first..last]) * area(&around) > 0.0 && contains(&around, flat[first]) {
                order[first..=last].reverse();
            }
        }
    }
    order
}

/// Twice the area of a loop, positive if it runs counter-clockwise.
fn area(corners: &[[f64; 2]]) -> f64 {
    (1..corners.len().max(1) - 1)
        .map(|k| turn(corners[0], corners[k], corners[k + 1]))
        .sum()
}

/// Whether a point lies in a loop, by counting crossings.
fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let n = corners.len();
    let crossed = |k: &usize| {
        let ([x0, y0], [x1, y1]) = (corners[*k], corners[(k + 1) % n]);
        (y0 > y) != (y1 > y) && x < x0 + (y - y0) / (y1 - y0) * (x1 - x0)
    };
    (0..n).filter(crossed).count() % 2 == 1
}

/// Twice the area along the normal (Newell), about the first corner so that no digits are lost, and the greatest distance
/// from that corner.
fn size(corners: &[Vec3]) -> (Vec3, f64) {
    let from = |k: usize| corners[k] - corners[0];
    let mut normal = Vec3::default();
    for k in 1..corners.len() - 1 {
        normal += from(k).cross(from(k + 1));
    }
    let reach = (1..corners.len()).map(|k| from(k).length()).fold(0.0, f64::max);
    (normal, reach)
}

/// Whether a polygon of three corners or more has no area.
pub(super) fn is_nothing(corners: &[Vec3]) -> bool {
    if corners.len() < 3 {
        return false;
    }
    let (normal, reach) = size(corners);
    normal.length() <= 1e-12 * reach * reach
}

/// Twice the area of a triangle, positive if it runs counter-clockwise.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// Cuts off ears (Meisters 1975) until nothing is left. Areas up to `nothing` are rounding.
fn ears(flat: &[[f64; 2]], mut left: Vec<usize>, nothing: f64) -> Result<Vec<[usize; 3]>> {
    let mut cut = Vec::with_capacity(flat.len() - 2);
    let mut work = 0_u64;
    while left.len() > 3 {
        let m = left.len();
        let around = |k: usize| [left[(k + m - 1) % m], left[k], left[(k + 1) % m]];
        // The best ear is the one whose smallest angle is greatest; quick polygons take the first good one.
        let mut best: Option<(f64, usize)> = None;
        for k in 0..m {
            let [a, b, c] = around(k);
            let area = turn(flat[a], flat[b], flat[c]);
            if area <= nothing {
                continue;
            }
            work += m as u64;
            if work > 200_000_000 {
                return Err(Error::Argument(format!(
                    "a polygon with {} corners that is too complicated (cut it into smaller ones)",
                    flat.len()
                )));
            }
            if left.iter().any(|&p| blocks(flat, [a, b, c], p, nothing)) {
                continue;
            }
            let side = |p: usize, q: usize| (flat[p][0] - flat[q][0]).powi(2) + (flat[p][1] - flat[q][1]).powi(2);
            let quality = area / side(a, b).max(side(b, c)).max(side(c, a));
            if best.is_none_or(|(q, _)| quality > q) {
                best = Some((quality, k));
            }
            if quality > 0.3 {
                break;
            }
        }
        let Some((_, k)) = best else {
            // What is left may have no area: the two sides of a seam.
            let rest: f64 = (1..m - 1)
                .map(|k| turn(flat[left[0]], flat[left[k]], flat[left[k + 1]]))
                .sum();
            if rest.abs() <= nothing * m as f64 * 4.0 {
                return Ok(cut);
            }
            return Err(Error::Argument(
                "a polygon whose sides cross (cut it into simple ones; a hole is joined to the outside by a seam)"
                    .into(),
            ));
        };
        cut.push(around(k));
        left.remove(k);
    }
    let last = turn(flat[left[0]], flat[left[1]], flat[left[2]]);
    if last < -4.0 * nothing {
        return Err(crossing());
    }
    if last > nothing {
        cut.push([left[0], left[1], left[2]]);
    }
    Ok(cut)
}

fn crossing() -> Error {
    Error::Argument(
        "a polygon whose sides cross (cut it into simple ones; a hole is joined to the outside by a seam)".into(),
    )
}

/// Whether a corner lies in a triangle, so that this is no ear. Corners at the same place as the triangle's (of a seam) do
/// not, but those on its sides do, so that no side of a triangle passes over a corner.
fn blocks(flat: &[[f64; 2]], [a, b, c]: [usize; 3], p: usize, nothing: f64) -> bool {
    if p == a || p == b || p == c || flat[p] == flat[a] || flat[p] == flat[b] || flat[p] == flat[c] {
        return false;
    }
    let inside = |s: usize, t: usize| turn(flat[s], flat[t], flat[p]) >= -nothing;
    inside(a, b) && inside(b, c) && inside(c, a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], triangles: &[[usize; 3]]) -> f64 {
        let mut sum = Vec3::default();
        for &[a, b, c] in triangles {
            let part = (corners[b] - corners[a]).cross(corners[c] - corners[a]);
            assert!(part.dot(Vec3::new(0.0, 0.48, 0.6)) > 0.0, "a triangle is turned");
            sum += part * 0.5;
        }
        sum.length()
    }

    /// In a plane tilted about x.
    fn tilted(flat: &[[f64; 2]], size: f64) -> Vec<Vec3> {
        let c = 1.0 / (0.8_f64 * 0.8 + 1.0).sqrt();
        flat.iter()
            .map(|&[x, y]| Vec3::new(x, y * c, -0.8 * y * c) * size)
            .collect()
    }

    #[test]
    fn concave_polygons_keep_their_area() {
        for size in [5e-5, 1.0, 1e3] {
            let comb = [
                [0.0, 0.0],
                [5.0, 0.0],
                [5.0, 3.0],
                [4.0, 3.0],
                [4.0, 1.0],
                [3.0, 1.0],
                [3.0, 3.0],
                [2.0, 3.0],
                [2.0, 1.0],
                [1.0, 1.0],
                [1.0, 3.0],
                [0.0, 3.0],
            ];
            let corners = tilted(&comb, size);
            let cut = triangles(&corners).unwrap();
            assert_eq!(cut.len(), 10);
            assert!((area(&corners, &cut) / size / size - 11.0).abs() < 1e-12);
        }
    }

    #[test]
    fn a_hole_of_either_sense_is_joined_by_a_seam() {
        let outside = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let mut hole = [[1.0, 1.0], [1.0, 3.0], [3.0, 3.0], [3.0, 1.0], [1.0, 1.0]];
        for _ in 0..2 {
            let corners = tilted(&[outside, hole].concat(), 1.0);
            let cut = triangles(&corners).unwrap();
            assert!((area(&corners, &cut) - 12.0).abs() < 1e-12);
            for &[a, b, c] in &cut {
                let m = (corners[a] + corners[b] + corners[c]) * (1.0 / 3.0);
                let y = m.y * (0.8_f64 * 0.8 + 1.0).sqrt();
                assert!(
                    !((1.0..3.0).contains(&m.x) && (1.0..3.0).contains(&y)),
                    "a triangle in the hole"
                );
            }
            hole.reverse();
        }
    }

    #[test]
    fn what_is_beside_is_no_hole() {
        let first = [[0.0, 0.0], [4.0, 0.0], [4.0, 4.0], [0.0, 4.0], [0.0, 0.0]];
        let beside = [[-1.0, -1.0], [-3.0, -1.0], [-3.0, -3.0], [-1.0, -3.0], [-1.0, -1.0]];
        assert_eq!(outline(&[first, beside].concat()), (0..10).collect::<Vec<_>>());
    }

    #[test]
    fn corners_on_straight_sides_stay_corners() {
        let flat = [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let cut = triangles(&tilted(&flat, 1.0)).unwrap();
        assert_eq!(cut.len(), 3);
        assert!(cut.iter().flatten().any(|&k| k == 1));
    }

    #[test]
    fn what_is_no_polygon_is_told() {
        let told = |flat: &[[f64; 2]]| triangles(&tilted(flat, 1.0)).unwrap_err().to_string();
        assert!(told(&[[0.0, 0.0], [1.0, 0.0]]).contains("2 corners"));
        assert!(told(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]).contains("without area"));
        assert!(told(&[[0.0, 0.0], [2.0, 2.0], [2.0, 0.0], [0.0, 1.0], [-1.0, 3.0]]).contains("sides cross"));
        let mut bent = tilted(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]], 1.0);
        bent[2].z += 0.1;
        assert_eq!(triangles(&bent).unwrap(), [[0, 1, 2], [0, 2, 3]]);
        bent.push(Vec3::new(-1.0, 0.5, 0.0));
        assert!(triangles(&bent).unwrap_err().to_string().contains("not flat"));
    }
}
