//! Slabs of absorbing and scattering volumes against closed forms, published values and the integral equation of transfer.

use std::sync::Arc;

use clerestory::basis::Basis;
use clerestory::direction::{Scatter, Side};
use clerestory::geometry::{Area, Geometry, Hit, Meeting, Ray, Vec3};
use clerestory::material::{Draws, Material, Medium, Surface};
use clerestory::progress::Progress;
use clerestory::trace::{Goniophotometer, Sample, Settings, State, Stop};

/// Planes at z = 0 and z = 1 m that bound a slab.
struct Slab;

impl Geometry for Slab {
    fn depth(&self) -> [f64; 2] {
        [0.0, 1.0]
    }

    fn period(&self) -> [f64; 2] {
        [0.0, 0.0]
    }

    fn area(&self) -> Area {
        Area {
            x: [0.0, 1.0],
            y: [0.0, 1.0],
        }
    }

    fn meet(&self, ray: &mut Ray) -> Meeting {
        let ahead = |plane: u32| {
            let distance = (f64::from(plane) - ray.origin.z) / ray.direction.z;
            (ray.piece != plane && distance >= 0.0).then_some((distance, plane))
        };
        let first = match (ahead(0), ahead(1)) {
            (Some(a), Some(b)) => Some(if a.0 < b.0 { a } else { b }),
            (a, b) => a.or(b),
        };
        let Some((distance, plane)) = first else {
            return Meeting::Leaves;
        };
        ray.origin += ray.direction * distance;
        ray.piece = plane;
        Meeting::Hit(Hit {
            distance,
            normal: Vec3::new(0.0, 0.0, if plane == 0 { -1.0 } else { 1.0 }),
            surface: 0,
        })
    }
}

/// Diffuse-hemispherical transmittance and reflectance of a slab, a band each, and its balance.
fn slab(medium: Medium) -> (Vec<[f64; 2]>, Vec<[f64; 7]>) {
    let bands = medium.bands();
    let sample = Sample {
        bands: ["visible", "solar"][..bands].iter().map(ToString::to_string).collect(),
        layers: vec![Box::new(Slab)],
        surfaces: vec![Surface {
            materials: [0, 0],
            media: [0, 1],
        }],
        materials: vec![Material::Interface],
        media: vec![Medium::air(bands), medium],
    };
    let basis = Arc::new(Basis::klems_full());
    let instrument = Goniophotometer {
        settings: Settings {
            sides: vec![Side::Interior],
            stop: Stop::Paths(4096),
            seed: 1,
            ..Settings::default()
        },
    };
    let (mut state, progress) = (State::new(""), Progress::default());
    let measured = instrument
        .matrices(&sample, &basis, &basis, &mut state, &progress)
        .expect("it runs");
    let values = sample
        .bands
        .iter()
        .map(|band| {
            Scatter::BOTH.map(|scatter| {
                let totals = measured.totals.iter().find(|t| t.band == *band && t.scatter == scatter);
                let estimate = totals.expect("is there").hemispherical.expect("from all directions");
                assert!(estimate.standard_error.expect("has one") < 1e-3);
                estimate.value
            })
        })
        .collect();
    (values, measured.balance)
}

/// Exponential integral E_n.
fn exponential_integral(n: i32, x: f64) -> f64 {
    let steps = 4000;
    (0..steps)
        .map(|k| {
            let mu = (f64::from(k) + 0.5) / f64::from(steps);
            mu.powi(n - 2) * (-x / mu).exp()
        })
        .sum::<f64>()
        / f64::from(steps)
}

/// Diffuse-hemispherical transmittance and reflectance of a slab that scatters evenly, from the integral equation of its
/// source function (Chandrasekhar 1950, Radiative Transfer), the source constant in each of many sheets.
fn transfer(depth: f64, albedo: f64) -> [f64; 2] {
    let n = 200;
    let step = depth / n as f64;
    let edges: Vec<f64> = (0..=2 * n)
        .map(|k| exponential_integral(2, 0.5 * step * k as f64))
        .collect();
    // Half of the light of a sheet of source 1 in the middle of another, by their distance in sheets.
    let between: Vec<f64> = (0..n)
        .map(|k| {
            if k == 0 {
                1.0 - edges[1]
            } else {
                0.5 * (edges[2 * k - 1] - edges[2 * k + 1])
            }
        })
        .collect();
    let mut source = vec![0.0; n];
    for _ in 0..200 {
        source = (0..n)
            .map(|i| {
                let scattered: f64 = source.iter().enumerate().map(|(j, s)| between[i.abs_diff(j)] * s).sum();
                albedo * (0.5 * edges[2 * i + 1] + scattered)
            })
            .collect();
    }
    let out = |depth: f64| 2.0 * exponential_integral(3, depth);
    let leaves = |k: usize| out(step * k as f64) - out(step * (k + 1) as f64);
    [
        out(depth) + (0..n).map(|k| source[k] * leaves(n - 1 - k)).sum::<f64>(),
        (0..n).map(|k| source[k] * leaves(k)).sum::<f64>(),
    ]
}

fn conserved(balance: &[[f64; 7]]) {
    for [traced, rest @ ..] in balance {
        assert!((rest.iter().sum::<f64>() / traced - 1.0).abs() < 1e-9, "{balance:?}");
        assert_eq!(rest[5], 0.0, "{balance:?}");
    }
}

#[test]
fn transfer_between_black_plates_is_as_published() {
    // Heaslet and Warming 1965, Int. J. Heat Mass Transfer 8: flux between black plates through a grey gas in radiative
    // equilibrium, which is the same problem.
    for (depth, flux) in [(0.5, 0.7040), (1.0, 0.5532), (2.0, 0.3900)] {
        let [t, r] = transfer(depth, 1.0);
        assert!(
            (t - flux).abs() < 3e-4 && (t + r - 1.0).abs() < 1e-4,
            "{depth}: {t} {r}"
        );
    }
}

#[test]
fn scattering_slabs_follow_the_equation_of_transfer() {
    let even = [0.0, 0.0];
    let medium = Medium::scattering(&[1.0, 1.0], &[0.0, 0.2], &[1.0, 0.8], &even).expect("a medium");
    let (values, balance) = slab(medium);
    conserved(&balance);
    for (value, albedo) in values.iter().zip([1.0, 0.8]) {
        let expected = transfer(1.0, albedo);
        for (v, e) in value.iter().zip(expected) {
            assert!((v - e).abs() < 2e-3, "{albedo}: {value:?} {expected:?}");
        }
    }
    // Bands of very different depths in one path.
    let medium = Medium::scattering(&[1.0, 1.0], &[0.0, 0.0], &[0.5, 2.0], &even).expect("a medium");
    let (values, balance) = slab(medium);
    conserved(&balance);
    for (value, flux) in values.iter().zip([0.7040, 0.3900]) {
        assert!((value[0] - flux).abs() < 3e-3, "{values:?}");
    }
}

#[test]
fn absorption_alone_is_an_exponential() {
    let medium = Medium::clear(&[1.0, 1.0], &[0.3, 2.0]).expect("a medium");
    let (values, balance) = slab(medium);
    conserved(&balance);
    for (value, depth) in values.iter().zip([0.3, 2.0]) {
        let t = 2.0 * exponential_integral(3, depth);
        assert!((value[0] - t).abs() < 1e-3 && value[1] == 0.0, "{value:?} {t}");
    }
}

#[test]
fn forward_scattering_changes_nothing() {
    let medium = Medium::scattering(&[1.0], &[0.0], &[3.0], &[0.9999]).expect("a medium");
    let (values, _) = slab(medium);
    assert!(values[0][0] > 0.997, "{values:?}");
    let back = Medium::scattering(&[1.0], &[0.0], &[1.0], &[0.5]).expect("a medium");
    // A peak forward passes more than even scattering.
    assert!(slab(back).0[0][0] > 0.5532 + 0.05);
}

#[test]
fn the_mean_cosine_is_the_asymmetry() {
    let g = [0.8, -0.3];
    let none = [0.0; 2];
    let medium = Medium::scattering(&[1.0; 2], &none, &[1.0; 2], &g).expect("a medium");
    let along = Vec3::new(0.48, -0.6, 0.64);
    let n = 1 << 16;
    let mut sums = [[0.0; 2]; 2];
    for k in 0..n {
        let (mut weight, mut draws) = ([1.0; 2], Draws::new(3, k));
        let direction = medium.scatter(along, &mut weight, &mut draws);
        assert!((direction.length() - 1.0).abs() < 1e-12);
        for b in 0..2 {
            assert!(weight[b] <= 2.0 + 1e-12);
            sums[b][0] += weight[b] / f64::from(n);
            sums[b][1] += weight[b] * direction.dot(along) / f64::from(n);
        }
    }
    for ([mean, cosine], g) in sums.into_iter().zip(g) {
        assert!(
            (mean - 1.0).abs() < 5e-3 && (cosine - g).abs() < 5e-3,
            "{g}: {mean} {cosine}"
        );
    }
}

#[test]
fn radiance_numbers_of_a_dielectric() {
    // 10 % are lost in an inch.
    let medium = Medium::radiance_dielectric(&[0.9, 0.0], 0.0254, 1.5).expect("a medium");
    assert!(((-medium.absorption[0] * 0.0254).exp() - 0.9).abs() < 1e-12);
    assert!(medium.absorption[1].is_finite() && medium.index == [1.5, 1.5]);
}
