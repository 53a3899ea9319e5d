//! Values of materials: Radiance's, published ones, the axes of data sets; and what is refused.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use clerestory::basis::Basis;
use clerestory::bsdf::{Band, Bsdf, Lambertian, Matrix, Metadata, Model, Scatterer};
use clerestory::direction::{Direction, Disk, Scatter, Side};
use clerestory::geometry::Vec3;
use clerestory::material::{Arrival, LobeValues, Material, Medium};

/// Bands of every material here.
const N: usize = 2;

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

fn values() -> LobeValues<'static> {
    LobeValues {
        reflectance: &[0.3, 0.1],
        transmittance: &[0.2, 0.4],
        diffuse_reflectance: &[0.1, 0.2],
        diffuse_transmittance: &[0.25, 0.05],
    }
}

/// The same in no direction as in any other.
fn data_set() -> Bsdf {
    let basis = Arc::new(Basis::klems_quarter());
    let model = |a: f64| {
        let matrix = Matrix::from_fn(basis.clone(), basis.clone(), |i, o| {
            a * (1.0 + ((i * 7 + o * 3) % 11) as f64 / 20.0)
        });
        Model::Matrix(matrix.expect("a matrix"))
    };
    let mut band = Band::new("visible");
    for (side, a) in [(Side::Exterior, 0.05), (Side::Interior, 0.08)] {
        band = band
            .with(side, Scatter::Transmission, model(a))
            .with(side, Scatter::Reflection, model(2.0 * a / 3.0));
    }
    Bsdf::new(vec![band], Metadata::default()).expect("a data set")
}

#[test]
fn data_sets_lie_as_they_are_told() {
    let set = data_set();
    let medium = Medium::air(1);
    let y = Vec3::new(0.0, 1.0, 0.0);
    for side in Side::BOTH {
        let normal = Vec3::new(0.0, 0.0, side.sign());
        let face = |up| Material::measured(&set, &[None], side, up).expect("is sound");
        // Up a quarter of a turn counter-clockwise as seen from the room, and askew, which makes no difference.
        let (upright, turned) = (face(y + normal * 0.3), face(Vec3::new(-1.0, 0.0, 0.0)));
        for k in 0..40 {
            let incident = Direction::from_angles(side, 0.037 * f64::from(k), 2.4 * f64::from(k));
            let to = if k % 2 == 0 { side } else { side.opposite() };
            let outgoing = Direction::from_angles(to, 0.031 * f64::from(40 - k), 1.1 * f64::from(k));
            let scatter = if to == side {
                Scatter::Reflection
            } else {
                Scatter::Transmission
            };
            let model = set.component(None, side, scatter).expect("is there").component;
            let expected = model.evaluate(incident.incident_disk(), outgoing.outgoing_disk());
            let arrival = |turn: fn(Direction) -> Vec3| Arrival {
                direction: -turn(incident),
                normal,
                here: &medium,
                beyond: &medium,
            };
            let world = |d: Direction| Vec3::new(d.x, d.y, d.z);
            let quarter = |d: Direction| Vec3::new(-d.y, d.x, d.z);
            let [a] = upright.evaluate::<1>(&arrival(world), world(outgoing));
            let [b] = turned.evaluate::<1>(&arrival(quarter), quarter(outgoing));
            assert!(
                (a - expected).abs() < 1e-12 && (b - expected).abs() < 1e-12,
                "{side:?} {k}: {a} {b} {expected}"
            );
        }
    }
}

#[test]
fn radiance_shares_follow_its_manual() {
    // Specular reflection first; of the rest a share passes, of that a share is specular; all but the first has the colour.
    let (colour, media) = ([0.8, 0.4], [Medium::air(N), Medium::air(N)]);
    let trans = Material::trans(&colour, 0.01, 0.0, 0.3, 0.25).expect("trans");
    let arrival = arrival(30.0, &media);
    let beams = trans.beams::<N>(&arrival);
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-12, "{a} {b}");
    close(beams[0].value[0], 0.01);
    close(beams[1].value[0], 0.8 * 0.99 * 0.3 * 0.25);
    close(beams[1].value[1], 0.4 * 0.99 * 0.3 * 0.25);
    let f = |passes| trans.evaluate::<N>(&arrival, at(Disk::from_angles(0.4, 0.0), passes));
    close(f(false)[0] * PI, 0.8 * 0.99 * 0.7);
    close(f(true)[1] * PI, 0.4 * 0.99 * 0.3 * 0.75);
    // A smooth metal of higher specularity turns white towards grazing incidence.
    let metal = Material::metal(&colour, 0.9, 0.0).expect("metal");
    let grazing = metal.beams::<N>(&self::arrival(89.9, &media));
    assert!(grazing[0].value.iter().all(|v| *v > 0.98));
    let normal = metal.beams::<N>(&self::arrival(0.0, &media));
    // The approximation leaves 0.00085 at normal incidence.
    let fresnel = (-5.85_f64).exp() - 0.002_029_430_64;
    close(normal[0].value[1], fresnel + 0.4 * 0.9 * (1.0 - fresnel));
    // White stays white.
    let white = Material::plastic(&[1.0, 1.0], 0.3, 0.0).expect("plastic");
    for theta_deg in [7.0, 42.0, 78.0] {
        let arrival = self::arrival(theta_deg, &media);
        let even = white.evaluate::<N>(&arrival, NORMAL)[0] * PI;
        close(even + white.beams::<N>(&arrival)[0].value[0], 1.0);
    }
}

#[test]
fn white_skies_of_radiance_give_the_same_radiance() {
    // rtrace of pyradiance 1.3.1, `-ab 1 -ad 2048 -aa 0 -lw 1e-6 -st 0` (rough: `-ss 64`), a polygon under a glow of
    // radiance 1 over the upper or the lower half; grey of 0.5. The polar angle of the view is 40° and 85° (rough: 70°).
    let grey = [0.5, 0.5];
    let smooth = [
        (Material::plastic(&grey, 0.05, 0.0), [0.5294, 0.8093], [0.0, 0.0]),
        (Material::plastic(&grey, 0.3, 0.0), [0.6533, 0.8595], [0.0, 0.0]),
        (Material::metal(&grey, 0.8, 0.0), [0.5046, 0.7993], [0.0, 0.0]),
        (
            Material::trans(&grey, 0.05, 0.0, 0.6, 0.5),
            [0.2471, 0.6949],
            [0.2824, 0.1144],
        ),
        (Material::glass(&[0.9, 0.9], 1.52), [0.0818, 0.7063], [0.8091, 0.1882]),
    ];
    let media = [Medium::air(N), Medium::air(N)];
    for (material, up, down) in smooth {
        let material = material.expect("is sound");
        for (k, theta_deg) in [40.0, 85.0].into_iter().enumerate() {
            let arrival = arrival(theta_deg, &media);
            for (passes, radiance) in [(false, up[k]), (true, down[k])] {
                let even = material.evaluate::<N>(&arrival, if passes { -NORMAL } else { NORMAL })[0] * PI;
                let beams = material.beams::<N>(&arrival);
                let beam: f64 = beams.iter().filter(|b| b.passes == passes).map(|b| b.value[0]).sum();
                assert!(
                    (even + beam - radiance).abs() < 1.5e-4,
                    "{material:?} {theta_deg}: {even} {beam} {radiance}"
                );
            }
        }
    }
    for (specularity, roughness, radiance) in [(0.3, 0.2, [0.2822, 0.2543]), (0.9, 0.15, [0.8738, 0.8115])] {
        let material = Material::plastic(&[0.0, 0.0], specularity, roughness).expect("plastic");
        for (theta_deg, radiance) in [40.0, 70.0].into_iter().zip(radiance) {
            let (arrival, fine) = (arrival(theta_deg, &media), 300_u32);
            let total: f64 = (0..fine * fine)
                .map(|k| {
                    let square = [k / fine, k % fine].map(|v| (f64::from(v) + 0.5) / f64::from(fine));
                    material.evaluate::<N>(&arrival, at(Disk::from_square(square), false))[0]
                })
                .sum::<f64>()
                * PI
                / f64::from(fine * fine);
            // A few thousand samples were taken there.
            assert!(
                (total / radiance - 1.0).abs() < 0.015,
                "{theta_deg}: {total} {radiance}"
            );
        }
    }
}

#[test]
fn ward_at_normal_incidence_is_the_published_peak() {
    let media = [Medium::air(N), Medium::air(N)];
    let material = Material::metal(&[1.0, 1.0], 1.0, 0.2).expect("metal");
    let straight = Arrival {
        direction: -NORMAL,
        normal: NORMAL,
        here: &media[0],
        beyond: &media[1],
    };
    let [f, _] = material.evaluate::<N>(&straight, NORMAL);
    assert!((f - 1.0 / (2.0 * TAU * 0.04)).abs() < 1e-9, "{f}");
}

#[test]
fn impossible_materials_are_refused_in_words() {
    let text = |m: clerestory::Result<Material>| m.expect_err("is refused").to_string();
    for (message, word) in [
        (text(Material::lambertian(&[0.5, 0.7], &[0.4, 0.4])), "band 2"),
        (text(Material::mirror(&[1.5])), "reflectance of band 1 is 1.5"),
        (text(Material::plastic(&[0.5], -0.1, 0.0)), "specularity is -0.1"),
        (text(Material::metal(&[f64::NAN], 0.5, 0.0)), "colour of band 1 is NaN"),
        (text(Material::trans(&[0.5], 0.1, 0.0, 1.2, 0.0)), "transmission is 1.2"),
        (text(Material::glass(&[1.2], 1.52)), "transmissivity of band 1"),
        (text(Material::glass(&[0.9], 0.8)), "index is 0.8"),
        (text(Material::ggx(&[0.9], 2.0)), "roughness is 2"),
        (text(Material::rough_interface(f64::NAN)), "roughness is NaN"),
        (text(Material::gaussian(0.0, values())), "width is 0"),
        (text(Material::abg(0.0, 2.0, values())), "B is 0"),
        (
            text(Material::gaussian(
                0.1,
                LobeValues {
                    reflectance: &[0.9, 0.9],
                    ..values()
                },
            )),
            "reflectance + transmittance + diffuse reflectance + diffuse transmittance of band 1",
        ),
        (
            text(Material::mixture(vec![(0.7, Material::Black), (0.7, Material::Black)])),
            "sum of shares",
        ),
        (
            text(Material::measured(&data_set(), &[Some("uv")], Side::Interior, NORMAL)),
            "uv",
        ),
        (
            text(Material::measured(
                &data_set(),
                &[None],
                Side::Interior,
                Vec3::default(),
            )),
            "up is (0, 0, 0)",
        ),
    ] {
        assert!(message.contains(word) && !message.contains('\n'), "{message}");
    }
    let twice = Bsdf::new(
        vec![
            Band::new("visible")
                .with(
                    Side::Exterior,
                    Scatter::Transmission,
                    Model::Lambertian(Lambertian::new(0.7).expect("even")),
                )
                .with(
                    Side::Exterior,
                    Scatter::Reflection,
                    Model::Lambertian(Lambertian::new(0.6).expect("even")),
                ),
        ],
        Metadata::default(),
    )
    .expect("a data set");
    let message = text(Material::measured(&twice, &[None], Side::Exterior, NORMAL));
    assert!(message.contains("band 1 (visible) sum to 1.3000"), "{message}");
    for medium in [
        Medium::clear(&[0.9], &[0.0]),
        Medium::clear(&[1.5], &[-1.0]),
        Medium::clear(&[1.5], &[f64::INFINITY]),
        Medium::clear(&[1.5, 1.5], &[0.0]),
        Medium::scattering(&[1.5], &[0.0], &[1.0], &[1.5]),
        Medium::radiance_dielectric(&[0.9], 0.0, 1.5),
        Medium::radiance_dielectric(&[1.1], 1.0, 1.5),
    ] {
        assert!(medium.is_err(), "{medium:?}");
    }
}
