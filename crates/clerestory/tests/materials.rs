//! Every material draws the directions that its formula says, keeps its energy, and says what it absorbs.

use std::f64::consts::PI;

use clerestory::basis::Basis;
use clerestory::bsdf::{Band, Bsdf, Lambertian, Matrix, Metadata, Model, Specular, Sum};
use clerestory::direction::{Disk, Scatter, Side};
use clerestory::geometry::Vec3;
use clerestory::material::{Arrival, LobeValues, Material, Medium, Polarisation};
use std::sync::Arc;

mod statistics;
use statistics::{chance, random};

/// Bands of every material here.
const N: usize = 2;
/// Cells a side of the square map of each hemisphere; an odd number keeps their edges off the axes.
const CELLS: usize = 13;
/// Points a side of a cell, for its integral.
const POINTS: usize = 20;
/// Draws a material and direction.
const DRAWS: u32 = 1 << 16;
/// Significance of all chi-squared tests together.
const SIGNIFICANCE: f64 = 0.01;
/// Incident angles (degrees).
const THETAS_DEG: [f64; 3] = [7.0, 42.0, 78.0];

struct Case {
    name: &'static str,
    material: Material,
    media: [Medium; 2],
    reciprocal: bool,
}

fn values() -> LobeValues<'static> {
    LobeValues {
        reflectance: &[0.3, 0.1],
        transmittance: &[0.2, 0.4],
        diffuse_reflectance: &[0.1, 0.2],
        diffuse_transmittance: &[0.25, 0.05],
    }
}

fn data_set() -> Bsdf {
    let basis = Arc::new(Basis::klems_quarter());
    let model = |a: f64| {
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| {
            0.02 + a * ((i * 7 + o * 3) % 11) as f64 / 150.0
        });
        Arc::new(Model::Matrix(matrix.expect("a matrix")))
    };
    let peak = |v: f64| Arc::new(Model::Specular(Specular::constant(v).expect("a peak")));
    let sum = |v: f64, a: f64| Model::Sum(Sum::new(vec![(1.0, model(a)), (1.0, peak(v))]).expect("a sum"));
    let even = |v: f64| Model::Lambertian(Lambertian::new(v).expect("a diffuser"));
    let band = |name: &str, a: f64| {
        Band::new(name)
            .with(Side::Interior, Scatter::Transmission, sum(0.2, a))
            .with(Side::Interior, Scatter::Reflection, even(0.3 * a))
    };
    Bsdf::new(vec![band("visible", 1.0), band("solar", 0.6)], Metadata::default()).expect("a data set")
}

fn cases() -> Vec<Case> {
    let air = Medium::air(N);
    let glass = Medium::clear(&[1.5, 1.5], &[0.0, 0.0]).expect("glass");
    let flint = Medium::clear(&[1.6, 1.7], &[0.0, 0.0]).expect("glass");
    let colour = [0.7, 0.3];
    let new = |name, material: clerestory::Result<Material>, reciprocal| Case {
        name,
        material: material.expect(name),
        media: [air.clone(), air.clone()],
        reciprocal,
    };
    let between = |name, roughness, here: &Medium, beyond: &Medium| Case {
        name,
        material: Material::rough_interface(roughness).expect(name),
        media: [here.clone(), beyond.clone()],
        reciprocal: true,
    };
    let bands = [Some("visible"), Some("solar")];
    let up = Vec3::new(0.3, 0.8, -0.2);
    let mixture = || {
        Material::mixture(vec![
            (0.5, Material::ggx(&[0.9, 0.6], 0.4)?),
            (0.2, Material::lambertian(&[0.5, 0.2], &[0.3, 0.4])?),
            (0.2, Material::glass(&[0.9, 0.8], 1.52)?),
        ])
    };
    vec![
        new("lambertian", Material::lambertian(&[0.5, 0.2], &[0.3, 0.6]), true),
        new("mirror", Material::mirror(&[0.9, 0.5]), true),
        new("smooth plastic", Material::plastic(&colour, 0.05, 0.0), false),
        new("rough plastic", Material::plastic(&colour, 0.3, 0.25), true),
        new("smooth metal", Material::metal(&colour, 0.8, 0.0), false),
        new("rough metal", Material::metal(&colour, 0.8, 0.15), true),
        new("smooth trans", Material::trans(&colour, 0.05, 0.0, 0.6, 0.5), false),
        new("rough trans", Material::trans(&colour, 0.05, 0.3, 0.6, 0.5), true),
        new("glass", Material::glass(&[0.96, 0.5], 1.52), true),
        new("ggx", Material::ggx(&[0.9, 0.4], 0.3), true),
        new("very rough ggx", Material::ggx(&[0.9, 0.4], 1.0), true),
        between("rough glass from air", 0.3, &air, &glass),
        between("rough glass from within", 0.3, &glass, &air),
        between("rough flint from air", 0.2, &air, &flint),
        between("rough flint from within", 0.2, &flint, &air),
        new("gaussian", Material::gaussian(0.3, values()), false),
        new("abg", Material::abg(0.02, 2.5, values()), false),
        new(
            "measured",
            Material::measured(&data_set(), &bands, Side::Interior, up),
            false,
        ),
        new("mixture", mixture(), true),
    ]
}

const NORMAL: Vec3 = Vec3::new(0.36, 0.48, 0.8);

/// Direction on the side of the normal (`passes`: on the other) at a disk point.
fn at(disk: Disk, passes: bool) -> Vec3 {
    let [s, t] = NORMAL.frame();
    let z = disk.cos_theta() * if passes { -1.0 } else { 1.0 };
    s * disk.x + t * disk.y + NORMAL * z
}

fn arrival(theta_deg: f64, media: &[Medium; 2]) -> Arrival<'_> {
    Arrival {
        direction: -at(Disk::from_angles(theta_deg.to_radians(), 2.1), false),
        normal: NORMAL,
        here: &media[0],
        beyond: &media[1],
    }
}

/// Integral of BSDF times cosine over each cell of both hemispheres, by band.
fn expected(case: &Case, arrival: &Arrival<'_>) -> Vec<[f64; N]> {
    let mut cells = vec![[0.0; N]; 2 * CELLS * CELLS];
    let fine = CELLS * POINTS;
    let share = PI / (fine * fine) as f64;
    for passes in [false, true] {
        for a in 0..fine {
            for b in 0..fine {
                let square = [(a as f64 + 0.5) / fine as f64, (b as f64 + 0.5) / fine as f64];
                let outgoing = at(Disk::from_square(square), passes);
                let f: [f64; N] = case.material.evaluate(arrival, outgoing);
                let cell = &mut cells[cell_of(a / POINTS, b / POINTS, passes)];
                for k in 0..N {
                    assert!(f[k] >= 0.0 && f[k].is_finite(), "{}: {f:?}", case.name);
                    cell[k] += f[k] * share;
                }
            }
        }
    }
    cells
}

fn cell_of(a: usize, b: usize, passes: bool) -> usize {
    (usize::from(passes) * CELLS + a) * CELLS + b
}

/// What draws gave.
struct Drawn {
    n: u32,
    /// Sum and sum of squares of the weights of scattered light by cell and band.
    cells: Vec<[[f64; 2]; N]>,
    beams: [f64; N],
    absorbed: [f64; N],
    /// Sum and sum of squares of what goes on and is absorbed.
    kept: [[f64; 2]; N],
}

impl Drawn {
    /// Takes over the cells of another one.
    fn merge(&mut self, other: &Self) {
        self.n += other.n;
        for (cell, more) in self.cells.iter_mut().zip(&other.cells) {
            for (c, m) in cell.as_flattened_mut().iter_mut().zip(more.as_flattened()) {
                *c += m;
            }
        }
    }
}

fn drawn(case: &Case, arrival: &Arrival<'_>, key: u64) -> Drawn {
    let mut result = Drawn {
        n: DRAWS,
        cells: vec![[[0.0; 2]; N]; 2 * CELLS * CELLS],
        beams: [0.0; N],
        absorbed: [0.0; N],
        kept: [[0.0; 2]; N],
    };
    let n = f64::from(DRAWS);
    for k in 0..DRAWS {
        let mut draws = random(key, k);
        let (mut weight, mut absorbed, mut polarisation) = ([1.0; N], [0.0; N], Polarisation::NONE);
        let departure = case
            .material
            .scatter(arrival, &mut weight, &mut absorbed, &mut polarisation, &mut draws);
        if departure.is_none() {
            weight = [0.0; N];
        }
        for (b, (w, a)) in weight.iter().zip(&absorbed).enumerate() {
            assert!(w.is_finite() && *w >= 0.0, "{}", case.name);
            result.absorbed[b] += a / n;
            result.kept[b][0] += (w + a) / n;
            result.kept[b][1] += (w + a).powi(2) / n;
        }
        let Some(departure) = departure else { continue };
        let cos = departure.direction.dot(NORMAL);
        assert!((departure.direction.length() - 1.0).abs() < 1e-12, "{}", case.name);
        assert_eq!(departure.passes, cos < 0.0, "{}", case.name);
        if departure.specular {
            for (beam, w) in result.beams.iter_mut().zip(&weight) {
                *beam += w / n;
            }
            continue;
        }
        let [s, t] = NORMAL.frame();
        let square = Disk::new(departure.direction.dot(s), departure.direction.dot(t)).to_square();
        let [a, b] = square.map(|v| (v * CELLS as f64) as usize);
        let cell = &mut result.cells[cell_of(a, b, departure.passes)];
        for (sums, w) in cell.iter_mut().zip(&weight) {
            sums[0] += w;
            sums[1] += w * w;
        }
    }
    result
}

/// Chance of what was drawn under what was expected, of one band. Cells of less than five draws are pooled. `factor`
/// multiplies what is expected in the fullest cell.
fn compare(expected: &[[f64; N]], drawn: &Drawn, band: usize, factor: f64, name: &str) -> f64 {
    let n = f64::from(drawn.n);
    let fullest = (0..expected.len())
        .max_by(|a, b| expected[*a][band].total_cmp(&expected[*b][band]))
        .expect("there are cells");
    let mut order: Vec<usize> = (0..expected.len()).collect();
    order.sort_by(|a, b| expected[*a][band].total_cmp(&expected[*b][band]));
    let (mut chi2, mut degrees) = (0.0, 0.0);
    // Expected and drawn sum, sum of squares.
    let mut pool = [0.0; 3];
    for k in order {
        let e = expected[k][band] * n * if k == fullest { factor } else { 1.0 };
        let [sum, squares] = drawn.cells[k][band];
        assert!(e > 0.0 || sum == 0.0, "{name}: light where there is none");
        pool = [pool[0] + e, pool[1] + sum, pool[2] + squares];
        // Effective number of draws in the pool.
        if pool[1] * pool[1] >= 30.0 * pool[2] && pool[1] > 0.0 {
            let variance = pool[2] - pool[1] * pool[1] / n;
            chi2 += (pool[1] - pool[0]).powi(2) / variance;
            degrees += 1.0;
            pool = [0.0; 3];
        }
    }
    if degrees == 0.0 { 1.0 } else { chance(chi2, degrees) }
}

#[test]
fn draws_follow_the_formula_and_the_energy_is_known() {
    let cases = cases();
    let tests = cases.len() * THETAS_DEG.len() * N;
    let least = 1.0 - (1.0 - SIGNIFICANCE).powf(1.0 / tests as f64);
    for (c, case) in cases.iter().enumerate() {
        for (t, theta_deg) in THETAS_DEG.into_iter().enumerate() {
            let arrival = arrival(theta_deg, &case.media);
            let expected = expected(case, &arrival);
            let drawn = drawn(case, &arrival, (c * 31 + t) as u64);
            let beams = case.material.beams::<N>(&arrival);
            for b in 0..N {
                let name = format!("{} at {theta_deg}, band {b}", case.name);
                let p = compare(&expected, &drawn, b, 1.0, &name);
                assert!(p > least, "{name}: chance {p:.2e}");
                let scattered: f64 = expected.iter().map(|e| e[b]).sum();
                let beam: f64 = beams.iter().map(|beam| beam.value[b]).sum();
                assert!(
                    (drawn.beams[b] - beam).abs() < 5e-3,
                    "{name}: beams {} {beam}",
                    drawn.beams[b]
                );
                let rest = 1.0 - drawn.absorbed[b];
                assert!(rest <= 1.0 + 1e-3, "{name}: absorbed {}", drawn.absorbed[b]);
                assert!(
                    (rest - scattered - beam).abs() < 6e-3,
                    "{name}: absorbed {} of {}",
                    1.0 - rest,
                    scattered + beam
                );
                let [mean, square] = drawn.kept[b];
                let error = ((square - mean * mean).max(0.0) / f64::from(DRAWS)).sqrt();
                assert!((mean - 1.0).abs() < 4.0 * error + 1e-9, "{name}: {mean} {error}");
            }
        }
    }
}

#[test]
fn five_percent_in_one_cell_do_not_pass() {
    for case in cases().iter().filter(|c| c.name == "rough metal") {
        let arrival = arrival(42.0, &case.media);
        let expected = expected(case, &arrival);
        // A million draws in all.
        let mut all = drawn(case, &arrival, 1000);
        for key in 1001..1016 {
            all.merge(&drawn(case, &arrival, key));
        }
        let [right, wrong] = [1.0, 1.05].map(|factor| compare(&expected, &all, 0, factor, case.name));
        assert!(right > SIGNIFICANCE && wrong < 1e-6, "{}: {right} {wrong}", case.name);
    }
}

#[test]
fn there_and_back_is_the_same() {
    let directions: Vec<Disk> = (0..12)
        .map(|k| Disk::from_angles(0.12 * f64::from(k % 7) + 0.1, 2.4 * f64::from(k)))
        .collect();
    for case in cases().iter().filter(|c| c.reciprocal) {
        let back = [case.media[1].clone(), case.media[0].clone()];
        for from in &directions {
            for (to, passes) in directions.iter().flat_map(|d| [(d, false), (d, true)]) {
                let there = Arrival {
                    direction: -at(*from, false),
                    normal: NORMAL,
                    here: &case.media[0],
                    beyond: &case.media[1],
                };
                let (normal, media) = if passes {
                    (-NORMAL, &back)
                } else {
                    (NORMAL, &case.media)
                };
                let other = Arrival {
                    direction: -at(*to, passes),
                    normal,
                    here: &media[0],
                    beyond: &media[1],
                };
                let a: [f64; N] = case.material.evaluate(&there, -other.direction);
                let b: [f64; N] = case.material.evaluate(&other, -there.direction);
                for k in 0..N {
                    // Radiance over the squared index is what is kept across a border.
                    let index = |m: &Medium| m.index[k] * m.index[k];
                    let (a, b) = if passes {
                        (a[k] / index(&case.media[1]), b[k] / index(&case.media[0]))
                    } else {
                        (a[k], b[k])
                    };
                    assert!(
                        (a - b).abs() <= 1e-9 * (1.0 + a.abs()),
                        "{}: {a} {b} {from:?} {to:?}",
                        case.name
                    );
                }
            }
        }
    }
}
