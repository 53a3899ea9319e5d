//! The density that a material says it draws directions with is the one that it draws them with, and light that is weighted
//! by it sums to what the BSDF says.

use std::f64::consts::TAU;
use std::sync::Arc;

use clerestory::basis::Basis;
use clerestory::bsdf::{Band, Bsdf, Lambertian, Matrix, Metadata, Model, Specular, Sum};
use clerestory::direction::{Disk, Scatter, Side};
use clerestory::geometry::Vec3;
use clerestory::material::{Arrival, LobeValues, Material, Medium, Polarisation};
use clerestory::sequence::r2;
use rayon::prelude::*;

mod statistics;
use statistics::{chance, random};

/// Bands of every material here.
const N: usize = 3;
/// Draws a material, face, direction and weight.
const DRAWS: u32 = 200_000;
/// Cells a side of the square map of each hemisphere; an odd number keeps their edges off the axes.
const CELLS: usize = 11;
/// Points a side of a hemisphere's square, for the integrals of its cells, about.
const FINE: usize = 200;
/// Cells of fewer expected draws are pooled.
const LEAST: f64 = 10.0;
/// Significance of all chi-squared tests together.
const SIGNIFICANCE: f64 = 0.01;
/// Standard deviations that means may be apart. There are thousands of them.
const SIGMAS: f64 = 5.0;
/// Incident angles (degrees).
const THETAS_DEG: [f64; 3] = [8.0, 45.0, 80.0];
/// What light carries: grey and coloured.
const WEIGHTS: [[f64; N]; 2] = [[1.0; N], [0.9, 0.25, 0.04]];
/// Half of the opening angle of the cones that light is summed over.
const CONE_DEG: f64 = 30.0;

struct Case {
    name: &'static str,
    /// Of the front and of the back.
    faces: [Material; 2],
    media: [Medium; 2],
    /// Whether the weight of a sample depends on its direction alone, not on the way that was drawn to it.
    direct: bool,
}

fn data_set() -> Bsdf {
    let basis = Arc::new(Basis::klems_quarter());
    let table = |a: f64| {
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| {
            0.02 + a * ((i * 7 + o * 3) % 11) as f64 / 150.0
        });
        Arc::new(Model::Matrix(matrix.expect("a matrix")))
    };
    let peak = |v: f64| Arc::new(Model::Specular(Specular::constant(v).expect("a peak")));
    let sum = |v: f64, a: f64| Model::Sum(Sum::new(vec![(1.0, table(a)), (1.0, peak(v))]).expect("a sum"));
    let even = |v: f64| Model::Lambertian(Lambertian::new(v).expect("a diffuser"));
    let band = |name: &str, a: f64| {
        Band::new(name)
            .with(Side::Interior, Scatter::Transmission, sum(0.2, a))
            .with(Side::Interior, Scatter::Reflection, even(0.3 * a))
            .with(Side::Exterior, Scatter::Transmission, sum(0.1, 0.7 * a))
            .with(Side::Exterior, Scatter::Reflection, sum(0.15, 0.4 * a))
    };
    Bsdf::new(
        vec![band("visible", 1.0), band("nir", 0.6), band("uv", 0.3)],
        Metadata::default(),
    )
    .expect("a data set")
}

fn cases() -> Vec<Case> {
    let air = Medium::air(N);
    let glass = Medium::clear(&[1.5; N], &[0.0; N]).expect("glass");
    let flint = Medium::clear(&[1.6, 1.6, 1.75], &[0.0; N]).expect("glass");
    let colour = [0.7, 0.3, 0.1];
    let lobes = LobeValues {
        reflectance: &[0.3, 0.1, 0.05],
        transmittance: &[0.2, 0.4, 0.1],
        diffuse_reflectance: &[0.1, 0.2, 0.6],
        diffuse_transmittance: &[0.25, 0.05, 0.1],
    };
    let same = |name, material: clerestory::Result<Material>, direct| {
        let material = material.expect(name);
        Case {
            name,
            faces: [material.clone(), material],
            media: [air.clone(), air.clone()],
            direct,
        }
    };
    let between = |name, roughness, beyond: &Medium, direct| Case {
        media: [air.clone(), beyond.clone()],
        ..same(name, Material::rough_interface(roughness), direct)
    };
    let bands = [Some("visible"), Some("nir"), Some("uv")];
    let face = |side| {
        let up = Vec3::new(0.3, 0.8, -0.2);
        Material::measured(&data_set(), &bands, side, up).expect("measured")
    };
    let mixture = || {
        Material::mixture(vec![
            (0.4, Material::ggx(&[0.9, 0.6, 0.2], 0.4)?),
            (0.2, Material::lambertian(&[0.5, 0.2, 0.1], &[0.3, 0.4, 0.6])?),
            (0.2, Material::glass(&[0.9, 0.8, 0.1], 1.52)?),
            (0.1, Material::gaussian(0.3, lobes)?),
        ])
    };
    vec![
        same("black", Ok(Material::Black), true),
        same("lambertian", Material::lambertian(&colour, &[0.3, 0.6, 0.1]), true),
        same("opaque lambertian", Material::lambertian(&colour, &[0.0; N]), true),
        same("mirror", Material::mirror(&colour), true),
        between("interface", 0.0, &glass, true),
        same("smooth plastic", Material::plastic(&colour, 0.05, 0.0), true),
        same("rough plastic", Material::plastic(&colour, 0.3, 0.25), false),
        same("smooth metal", Material::metal(&colour, 0.8, 0.0), true),
        same("rough metal", Material::metal(&colour, 0.8, 0.15), false),
        same("smooth trans", Material::trans(&colour, 0.05, 0.0, 0.6, 0.5), true),
        same("rough trans", Material::trans(&colour, 0.05, 0.3, 0.6, 0.5), false),
        same("glass", Material::glass(&[0.96, 0.5, 0.1], 1.52), true),
        same("ggx", Material::ggx(&colour, 0.3), true),
        same("very rough ggx", Material::ggx(&colour, 1.0), true),
        same("smooth ggx", Material::ggx(&colour, 0.0), true),
        between("rough glass", 0.3, &glass, true),
        between("rough flint", 0.25, &flint, false),
        between("rough nothing", 0.3, &air, true),
        same("gaussian", Material::gaussian(0.3, lobes), false),
        same("abg", Material::abg(0.02, 2.5, lobes), false),
        Case {
            faces: [face(Side::Interior), face(Side::Exterior)],
            ..same("measured", Ok(Material::Black), true)
        },
        same("mixture", mixture(), false),
    ]
}

const NORMAL: Vec3 = Vec3::new(0.36, 0.48, 0.8);

/// Light that meets a face of a case.
struct Meeting<'a> {
    name: String,
    material: &'a Material,
    arrival: Arrival<'a>,
    weight: [f64; N],
    direct: bool,
    key: u64,
}

impl<'a> Meeting<'a> {
    fn new(case: &'a Case, face: usize, theta_deg: f64, weight: [f64; N]) -> Self {
        let normal = if face == 0 { NORMAL } else { -NORMAL };
        let name = format!("{}, face {face}, {theta_deg}°, {weight:?}", case.name);
        Self {
            key: name.bytes().fold(7, |key, byte| key * 31 % 1_000_003 + u64::from(byte)),
            name,
            material: &case.faces[face],
            arrival: Arrival {
                direction: -at(normal, Disk::from_angles(theta_deg.to_radians(), 2.1), false),
                normal,
                here: &case.media[face],
                beyond: &case.media[1 - face],
            },
            weight,
            direct: case.direct,
        }
    }

    fn density(&self, outgoing: Vec3) -> f64 {
        self.material.density(&self.arrival, &self.weight, outgoing)
    }

    /// BSDF times cosine times what the light carries (1/sr).
    fn scattered(&self, outgoing: Vec3) -> [f64; N] {
        let f: [f64; N] = self.material.evaluate(&self.arrival, outgoing);
        let cos = outgoing.dot(self.arrival.normal).abs();
        std::array::from_fn(|b| f[b] * cos * self.weight[b])
    }

    /// A draw: direction and weight; none of a beam.
    fn draw(&self, index: u32) -> Option<(Vec3, [f64; N])> {
        let (mut weight, mut absorbed, mut polarisation) = (self.weight, [0.0; N], Polarisation::NONE);
        let mut draws = random(self.key, index);
        let departure =
            self.material
                .scatter(&self.arrival, &mut weight, &mut absorbed, &mut polarisation, &mut draws)?;
        (!departure.specular).then_some((departure.direction, weight))
    }

    fn cell(&self, outgoing: Vec3, cells: usize) -> usize {
        let [s, t] = self.arrival.normal.frame();
        let up = outgoing.dot(self.arrival.normal);
        // Radius over sine.
        let shrink = 1.0 / (1.0 + up.abs()).sqrt();
        let square = Disk::new(outgoing.dot(s) * shrink, outgoing.dot(t) * shrink).to_square();
        let [a, b] = square.map(|v| ((v * cells as f64) as usize).min(cells - 1));
        (usize::from(up < 0.0) * cells + a) * cells + b
    }

    /// Integral of the density over each cell, both hemispheres.
    fn expected(&self, cells: usize) -> Vec<f64> {
        let points = FINE / cells / 2 * 2;
        let fine = (points * cells) as f64;
        let mut integrals = vec![0.0; 2 * cells * cells];
        for (k, integral) in integrals.iter_mut().enumerate() {
            let (passes, corner) = (k >= cells * cells, [k / cells % cells, k % cells]);
            for (i, j) in (0..points).flat_map(|i| (0..points).map(move |j| (i, j))) {
                let at = |cell: usize, index: usize, row: usize| ((cell * points + index) as f64 + offset(row)) / fine;
                let square = [at(corner[0], i, j), at(corner[1], j, i)];
                let density = self.density(even(self.arrival.normal, square, passes));
                assert!(density >= 0.0 && density.is_finite(), "{}: {density}", self.name);
                *integral += density * TAU / (fine * fine);
            }
        }
        integrals
    }
}

/// Direction on the side of the normal (`passes`: on the other) at a disk point.
fn at(normal: Vec3, disk: Disk, passes: bool) -> Vec3 {
    let [s, t] = normal.frame();
    let z = disk.cos_theta() * if passes { -1.0 } else { 1.0 };
    s * disk.x + t * disk.y + normal * z
}

/// Where the points of a row stand in their cells: two rows together about the middle, but no two pairs alike, since the density
/// of a rough border ends along a ring, where the facets are upright, and rings are lines of the square.
fn offset(row: usize) -> f64 {
    let shift = ((row / 2) as f64 * 0.618_033_988_749_895).fract();
    if row.is_multiple_of(2) { shift } else { 1.0 - shift }
}

/// Direction of a point of a square, equal areas of which are equal solid angles: density does not end at the horizon.
fn even(normal: Vec3, square: [f64; 2], passes: bool) -> Vec3 {
    let [s, t] = normal.frame();
    let p = Disk::from_square(square);
    let r2 = p.x * p.x + p.y * p.y;
    let (up, stretch) = (1.0 - r2, (2.0 - r2).sqrt());
    s * (p.x * stretch) + t * (p.y * stretch) + normal * if passes { -up } else { up }
}

/// Chance of counts under expected shares; what is in no cell is a cell, too. The fullest cell's share times `factor`.
fn fit(shares: &[f64], counts: &[u32], n: u32, factor: f64) -> f64 {
    let n = f64::from(n);
    let mut cells: Vec<[f64; 2]> = shares.iter().zip(counts).map(|(s, c)| [s * n, f64::from(*c)]).collect();
    let fullest = cells.iter_mut().max_by(|a, b| a[0].total_cmp(&b[0])).expect("a cell");
    fullest[0] *= factor;
    let [sum, drawn] = cells.iter().fold([0.0; 2], |s, c| [s[0] + c[0], s[1] + c[1]]);
    cells.push([(n - sum).max(0.0), n - drawn]);
    cells.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let mut groups: Vec<[f64; 2]> = Vec::new();
    let mut pool = [0.0; 2];
    for [e, c] in cells {
        pool = [pool[0] + e, pool[1] + c];
        if pool[0] >= LEAST {
            groups.push(std::mem::take(&mut pool));
        }
    }
    let last = groups.last_mut().expect("there are many draws");
    *last = [last[0] + pool[0], last[1] + pool[1]];
    if groups.len() < 2 {
        return 1.0;
    }
    let chi2: f64 = groups.iter().map(|[e, c]| (c - e).powi(2) / e).sum();
    chance(chi2, (groups.len() - 1) as f64)
}

/// A mean and its square, for its error.
#[derive(Clone, Copy, Default)]
struct Mean {
    sum: f64,
    squares: f64,
}

impl Mean {
    fn add(&mut self, value: f64) {
        self.sum += value;
        self.squares += value * value;
    }

    /// Of `n` values, most of them perhaps 0: the mean and the square of its error.
    fn over(&self, n: u32) -> [f64; 2] {
        let n = f64::from(n);
        let mean = self.sum / n;
        [mean, (self.squares / n - mean * mean).max(0.0) / n]
    }
}

/// Points of the integral over a cone a side.
const ALONG: u32 = 90;
const ABOUT: u32 = 150;

/// A cone of directions.
struct Cone {
    axis: Vec3,
    /// Solid angle over 2π.
    height: f64,
}

impl Cone {
    fn at(&self, [along, about]: [f64; 2]) -> Vec3 {
        let cos = 1.0 - along * self.height;
        let sin = (1.0 - cos * cos).sqrt();
        let [s, t] = self.axis.frame();
        let (y, x) = (TAU * about).sin_cos();
        s * (sin * x) + t * (sin * y) + self.axis * cos
    }

    fn holds(&self, direction: Vec3) -> bool {
        direction.dot(self.axis) > 1.0 - self.height
    }

    /// Integral over it, band by band.
    fn integral(&self, f: impl Fn(Vec3) -> [f64; N]) -> [f64; N] {
        let mut sums = [0.0; N];
        for a in 0..ALONG {
            for b in 0..ABOUT {
                let u = [
                    (f64::from(a) + 0.5) / f64::from(ALONG),
                    (f64::from(b) + 0.5) / f64::from(ABOUT),
                ];
                for (sum, value) in sums.iter_mut().zip(f(self.at(u))) {
                    *sum += value;
                }
            }
        }
        sums.map(|sum| sum * self.height * TAU / f64::from(ALONG * ABOUT))
    }
}

/// Estimates of the light in a cone, by band: by the weights of the draws; by the BSDF over the density of the draws; and by
/// draws and points of the cone together, each weighted by the balance heuristic (Veach 1997).
#[derive(Clone, Copy, Default)]
struct Light {
    weighted: [Mean; N],
    divided: [Mean; N],
    balanced: [[Mean; N]; 2],
}

#[test]
fn draws_follow_the_density_and_light_sums_to_the_bsdf() {
    let cases = cases();
    let mut meetings = Vec::new();
    for case in &cases {
        for theta_deg in THETAS_DEG {
            meetings.extend(WEIGHTS.map(|weight| Meeting::new(case, 0, theta_deg, weight)));
            meetings.push(Meeting::new(case, 1, theta_deg, WEIGHTS[1]));
        }
    }
    let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / meetings.len() as f64);
    meetings.par_iter().for_each(|meeting| {
        let name = &meeting.name;
        let shares = meeting.expected(CELLS);
        let integral = shares.iter().sum::<f64>();
        if integral == 0.0 {
            assert!(
                (0..1000).all(|k| meeting.draw(k).is_none()),
                "{name}: drawn with no density"
            );
            return;
        }
        let Arrival { direction, normal, .. } = meeting.arrival;
        let height = 1.0 - CONE_DEG.to_radians().cos();
        // About the ways straight on and mirrored.
        let cones = [direction - normal * (2.0 * direction.dot(normal)), direction].map(|axis| Cone { axis, height });
        let flat = 1.0 / (TAU * height);
        let mut counts = vec![0; 2 * CELLS * CELLS];
        let (mut scattered, mut odd) = (0, 0);
        let mut light = [Light::default(); 2];
        for k in 0..DRAWS {
            let Some((outgoing, weight)) = meeting.draw(k) else {
                continue;
            };
            scattered += 1;
            counts[meeting.cell(outgoing, CELLS)] += 1;
            let inside = cones.iter().any(|cone| cone.holds(outgoing));
            if !inside && k % 8 != 0 {
                continue;
            }
            let (density, values) = (meeting.density(outgoing), meeting.scattered(outgoing));
            assert!(
                density > 0.0 || odd > 0,
                "{name}: {outgoing:?} was drawn with no density"
            );
            let agrees = |b: usize| (weight[b] - values[b] / density).abs() <= 1e-6 * (1e-6 + weight[b]);
            odd += u32::from(meeting.direct && !(0..N).all(agrees));
            for (_, light) in cones.iter().zip(&mut light).filter(|(cone, _)| cone.holds(outgoing)) {
                for b in 0..N {
                    light.weighted[b].add(weight[b]);
                    light.divided[b].add(values[b] / density);
                    light.balanced[0][b].add(weight[b] * density / (density + flat));
                }
            }
        }
        // Rounding puts a direction at the edge of a patch, or very near to the horizon, on the other side.
        assert!(
            odd <= 10,
            "{name}: {odd} draws have other weights than their directions"
        );
        let p = fit(&shares, &counts, DRAWS, 1.0);
        assert!(p > least, "{name}: chance {p:.2e}");
        let share = f64::from(scattered) / f64::from(DRAWS);
        let error = (share * (1.0 - share) / f64::from(DRAWS)).sqrt();
        assert!(
            (integral - share).abs() < SIGMAS * error + 1e-3,
            "{name}: {integral} {share}"
        );
        for (cone, light) in cones.iter().zip(&mut light) {
            for k in 0..DRAWS / 10 {
                let outgoing = cone.at(r2(k, [0.3, 0.6]));
                let density = meeting.density(outgoing);
                for (mean, value) in light.balanced[1].iter_mut().zip(meeting.scattered(outgoing)) {
                    mean.add(value / (density + flat));
                }
            }
            let exact = cone.integral(|outgoing| meeting.scattered(outgoing));
            for (b, exact) in exact.into_iter().enumerate() {
                let [drawn, variance] = light.balanced[0][b].over(DRAWS);
                let [points, more] = light.balanced[1][b].over(DRAWS / 10);
                for (which, [mean, variance]) in [
                    ("weights", light.weighted[b].over(DRAWS)),
                    ("BSDF over density", light.divided[b].over(DRAWS)),
                    ("balance heuristic", [drawn + points, variance + more]),
                ] {
                    let far = (mean - exact).abs();
                    assert!(
                        far <= SIGMAS * variance.sqrt() + 2e-3 * exact,
                        "{name}, {which} of band {b}: {mean} {} {}",
                        exact,
                        variance.sqrt()
                    );
                }
            }
        }
    });
}

#[test]
fn five_percent_in_one_cell_do_not_pass() {
    let (cells, n) = (3, 1 << 19);
    let cases = cases();
    cases.par_iter().for_each(|case| {
        let meeting = Meeting::new(case, 0, 45.0, WEIGHTS[1]);
        let shares = meeting.expected(cells);
        if shares.iter().sum::<f64>() == 0.0 {
            return;
        }
        let mut counts = vec![0; shares.len()];
        for k in 0..n {
            if let Some((outgoing, _)) = meeting.draw(k) {
                counts[meeting.cell(outgoing, cells)] += 1;
            }
        }
        let [right, wrong] = [1.0, 1.05].map(|factor| fit(&shares, &counts, n, factor));
        assert!(right > 1e-3 && wrong < 1e-5, "{}: {right} {wrong}", meeting.name);
    });
}

#[test]
fn dark_light_and_beams_have_no_density() {
    for case in &cases() {
        let dark = Meeting::new(case, 0, 45.0, [0.0; N]);
        assert!(dark.expected(CELLS).iter().all(|v| v.is_finite()), "{}", case.name);
        let grey = Meeting::new(case, 0, 45.0, WEIGHTS[0]);
        let none = ["black", "mirror", "interface", "glass", "smooth ggx", "rough nothing"];
        let sum: f64 = grey.expected(CELLS).iter().sum();
        assert_eq!(sum == 0.0, none.contains(&case.name), "{}: {sum}", case.name);
    }
}
