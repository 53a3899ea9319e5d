//! Solid angles of a picture's pixels.

use rayon::prelude::*;

use super::camera::Camera;
use super::projection::Projection;

/// Points and weights of Gauss's rule with four points on 0 to 1.
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_71, 0.173_927_422_568_726_93),
    (0.330_009_478_207_571_87, 0.326_072_577_431_273_07),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_07),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_93),
];
/// Parts of a row that meets the rim of a hemispherical picture, where the density has a pole.
const RIM: usize = 16;

impl Camera {
    /// Solid angle of each pixel (steradians), row by row from the top: of the spherical quadrangle between the directions of
    /// its corners, as `evalglare` takes it. A pixel with a corner outside of the projection has none.
    pub fn solid_angles(&self, width: usize, height: usize) -> Vec<f64> {
        if width == 0 || self.view().projection == Projection::Parallel {
            return vec![0.0; width * height];
        }
        let [across, down] = self.distinct(width, height);
        let mut made = vec![0.0; across * down];
        let (dx, dy) = (1.0 / width as f64, 1.0 / height as f64);
        let corners = |row: usize| -> Vec<Option<[f64; 3]>> {
            let y = 1.0 - row as f64 * dy;
            (0..=across).map(|column| self.local(column as f64 * dx, y)).collect()
        };
        made.par_chunks_mut(16 * across).enumerate().for_each(|(block, rows)| {
            let mut upper = corners(16 * block);
            for (k, row) in rows.chunks_mut(across).enumerate() {
                let lower = corners(16 * block + k + 1);
                for ((omega, a), b) in row.iter_mut().zip(upper.windows(2)).zip(lower.windows(2)) {
                    if let ([Some(a), Some(b)], [Some(d), Some(c)]) = (a, b) {
                        *omega = quadrangle([a, b, c, d]);
                    }
                }
                upper = lower;
            }
        });
        mirrored(&made, [across, down], [width, height])
    }

    /// Columns and rows of a picture's upper left part, of which the rest is a mirror image; all where it is not.
    pub(crate) fn distinct(&self, width: usize, height: usize) -> [usize; 2] {
        if self.view().shift == 0.0 && self.view().lift == 0.0 {
            [width.div_ceil(2), height.div_ceil(2)]
        } else {
            [width, height]
        }
    }

    /// Solid angle of each pixel (steradians), row by row from the top, integrated over the pixel, with what of it is inside of
    /// the projection. It sums to the whole of what the picture shows.
    pub fn exact_solid_angles(&self, width: usize, height: usize) -> Vec<f64> {
        let mut made = vec![0.0; width * height];
        if width == 0 {
            return made;
        }
        let (dx, dy) = (1.0 / width as f64, 1.0 / height as f64);
        let projection = self.view().projection;
        made.par_chunks_mut(width).enumerate().for_each(|(row, omegas)| {
            let [_, y0] = self.surface(0.0, 1.0 - (row + 1) as f64 * dy);
            let [_, y1] = self.surface(0.0, 1.0 - row as f64 * dy);
            for (column, omega) in omegas.iter_mut().enumerate() {
                let [x0, _] = self.surface(column as f64 * dx, 0.0);
                let [x1, _] = self.surface((column + 1) as f64 * dx, 0.0);
                *omega = match projection {
                    Projection::Hemispherical => hemispherical([x0, x1], [y0, y1]),
                    Projection::Perspective
                    | Projection::Parallel
                    | Projection::Angular
                    | Projection::Planispheric
                    | Projection::Cylindrical => gauss([y0, y1], |y| gauss([x0, x1], |x| projection.density([x, y]))),
                };
            }
        });
        made
    }
}

/// The whole picture from its distinct part.
pub(crate) fn mirrored(part: &[f64], [across, down]: [usize; 2], [width, height]: [usize; 2]) -> Vec<f64> {
    let mut whole = vec![0.0; width * height];
    whole.par_chunks_mut(width).enumerate().for_each(|(row, target)| {
        let row = if row < down { row } else { height - 1 - row };
        let source = &part[row * across..(row + 1) * across];
        target[..across].copy_from_slice(source);
        for (value, from) in target[across..].iter_mut().zip(source[..width - across].iter().rev()) {
            *value = *from;
        }
    });
    whole
}

/// Integral of a smooth function between two limits.
fn gauss([from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> f64 {
    (to - from)
        * GAUSS
            .iter()
            .map(|&(at, weight)| weight * f(from + at * (to - from)))
            .sum::<f64>()
}

/// Solid angle of a rectangle of the unit disk: along x in closed form, along y by sums, finely where the rim is met.
fn hemispherical([x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> f64 {
    let strip = |y: f64| {
        let half = (1.0 - y * y).max(0.0).sqrt();
        let angle = |x: f64| {
            if half > 0.0 {
                (x / half).clamp(-1.0, 1.0).asin()
            } else {
                0.0
            }
        };
        angle(x1) - angle(x0)
    };
    let (x, y) = (x0.abs().max(x1.abs()), y0.abs().max(y1.abs()));
    let parts = if x * x + y * y < 1.0 { 1 } else { RIM };
    let step = (y1 - y0) / parts as f64;
    (0..parts)
        .map(|k| gauss([y0 + k as f64 * step, y0 + (k + 1) as f64 * step], strip))
        .sum()
}

/// Solid angle of a spherical quadrangle between directions of length 1, in order around it: that of its two triangles, each
/// by van Oosterom and Strackee (1983, IEEE Trans. Biomed. Eng. 30(2)). The tangents of their halves add as the angles of
/// complex numbers do.
fn quadrangle([a, b, c, d]: [&[f64; 3]; 4]) -> f64 {
    let ([x, y], [u, v]) = (triangle(a, b, c), triangle(a, c, d));
    let (real, imaginary) = (x * u - y * v, x * v + y * u);
    let t = imaginary / real;
    if real > 0.0 && t < 0.02 {
        let t2 = t * t;
        return 2.0 * t * (1.0 - t2 * (1.0 / 3.0 - t2 * (1.0 / 5.0 - t2 * (1.0 / 7.0))));
    }
    2.0 * imaginary.atan2(real)
}

/// Cosine and sine, times a common factor, of half the solid angle of a spherical triangle.
fn triangle(a: &[f64; 3], b: &[f64; 3], c: &[f64; 3]) -> [f64; 2] {
    let volume =
        a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    [1.0 + dot(a, b) + dot(b, c) + dot(c, a), volume.abs()]
}

fn dot(a: &[f64; 3], b: &[f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use super::super::View;
    use super::*;

    fn camera(options: &str) -> Camera {
        Camera::new(View::parse(options).unwrap()).unwrap()
    }

    #[test]
    fn they_sum_to_what_is_seen() {
        let band = |degrees: f64| degrees.to_radians() * 2.0 * 40f64.to_radians().sin();
        for (options, expected) in [
            ("-vth -vh 180 -vv 180", TAU),
            ("-vtc -vh 360 -vv 80", band(360.0)),
            ("-vtc -vh 100 -vv 80", band(100.0)),
            // A quarter of the sphere's faces of a cube.
            ("-vtv -vh 90 -vv 90", 4.0 * PI / 6.0),
            ("-vtl -vh 2 -vv 2", 0.0),
        ] {
            let sum: f64 = camera(options).exact_solid_angles(120, 90).iter().sum();
            assert!(
                (sum - expected).abs() < 2e-4 * expected.max(1.0),
                "{options}: {sum} {expected}"
            );
        }
        let quadrangles: f64 = camera("-vtv -vh 90 -vv 90").solid_angles(120, 90).iter().sum();
        assert!((quadrangles - 4.0 * PI / 6.0).abs() < 1e-9);
    }

    #[test]
    fn quadrangles_are_nearly_exact_inside() {
        for options in [
            "-vta -vh 180 -vv 180 -vs 0.05",
            "-vts -vh 170 -vv 170",
            "-vth -vh 60 -vv 60",
            "-vtc -vh 90 -vv 60",
        ] {
            let camera = camera(options);
            let (quick, exact) = (camera.solid_angles(200, 200), camera.exact_solid_angles(200, 200));
            for (k, (a, b)) in quick.iter().zip(&exact).enumerate() {
                assert!(*a > 0.0 && (a - b).abs() < 5e-4 * b, "{options} {k}: {a} {b}");
            }
        }
    }

    #[test]
    fn mirror_images_are_what_they_stand_for() {
        for (width, height) in [(7, 5), (8, 6), (1, 1), (2, 9)] {
            let quick = camera("-vta -vh 180 -vv 150").solid_angles(width, height);
            // The same view but for a shift that no digit sees.
            let whole = camera("-vta -vh 180 -vv 150 -vs 1e-20").solid_angles(width, height);
            for (a, b) in quick.iter().zip(&whole) {
                assert!((a - b).abs() < 1e-12, "{width} {height}: {a} {b}");
            }
        }
    }

    #[test]
    fn pixels_on_the_rim_have_none_by_corners_and_a_part_by_integral() {
        let camera = camera("-vth -vh 180 -vv 180");
        let (quick, exact) = (camera.solid_angles(24, 24), camera.exact_solid_angles(24, 24));
        let rim = 12 * 24;
        assert_eq!(quick[rim], 0.0);
        assert!(exact[rim] > 0.01);
        assert_eq!((quick[0], exact[0]), (0.0, 0.0));
        // `evalglare` 3.06 on this pixel.
        assert!((quick[4 * 24 + 19] - 0.015_405_508_4).abs() < 1e-9);
    }
}
