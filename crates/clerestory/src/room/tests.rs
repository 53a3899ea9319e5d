//! Rooms whose light is known in closed form. Errors are standard errors of replications; the tests ask for less than four.

use std::f64::consts::PI;

use super::{Parts, Rgb, Room, Sensor, System};
use crate::bsdf::{Band, Bsdf, Lambertian, Metadata, Model, Specular};
use crate::direction::{Scatter, Side};
use crate::geometry::{Scene, Shape, Vec3};
use crate::material::{Material, Medium, Surface};
use crate::progress::Progress;
use crate::sky::{Level, Moment, Settings, Sky, SunPosition, Traditional};

mod matrices;

const LUMINANCE: f64 = 17_900.0;
/// Radiance of the uniform sky.
const L: f64 = LUMINANCE / 179.0;

fn moment(altitude: f64, azimuth: f64) -> Moment {
    Moment {
        sun: SunPosition::from_degrees(altitude, azimuth).expect("a position"),
        day: 80,
        dew_point: crate::sky::DEW_POINT,
    }
}

/// The same radiance from everywhere.
pub(super) fn uniform() -> Sky {
    let settings = Settings {
        ground_reflectance: 1.0,
        ..Settings::default()
    };
    let kind = Traditional::Uniform;
    Sky::traditional(kind, false, &moment(40.0, 180.0), Level::Zenith(LUMINANCE), &settings).expect("a sky")
}

pub(super) fn clear(altitude: f64, azimuth: f64) -> Sky {
    let supply = crate::sky::perez::Supply::Irradiance {
        direct_normal: 800.0,
        diffuse_horizontal: 100.0,
    };
    Sky::perez(&moment(altitude, azimuth), supply, &Settings::default()).expect("a sky")
}

fn system(transmission: &Model, reflection: f64) -> System {
    let mut band = Band::new("visible");
    for side in Side::BOTH {
        band = band.with(side, Scatter::Transmission, transmission.clone());
        let reflects = Model::Lambertian(Lambertian::new(reflection).expect("a share"));
        band = band.with(side, Scatter::Reflection, reflects);
    }
    let bsdf = Bsdf::new(vec![band], Metadata::default()).expect("a data set");
    System::new(&bsdf, [None; 3], Vec3::new(0.0, 0.0, 1.0)).expect("a system")
}

pub(super) fn open() -> System {
    system(&Model::Specular(Specular::constant(1.0).expect("a share")), 0.0)
}

pub(super) fn diffuse(transmittance: f64) -> System {
    system(
        &Model::Lambertian(Lambertian::new(transmittance).expect("a share")),
        0.0,
    )
}

pub(super) fn quad(scene: &mut Scene, corners: [Vec3; 4], surface: u32) {
    let object = scene.object("wall");
    let [a, b, c, d] = corners;
    scene.push(Shape::Triangle([a, b, c]), surface, object);
    scene.push(Shape::Triangle([a, c, d]), surface, object);
}

pub(super) fn v(x: f64, y: f64, z: f64) -> Vec3 {
    Vec3::new(x, y, z)
}

/// A cube of side 2 m, its middle at the origin, open to the south (y = -1), with walls of one reflectance.
pub(super) fn cube(reflectance: f64, system: System, sky: Sky) -> Room {
    let mut scene = Scene::default();
    let wall = scene.surface("wall");
    let p = |k: u32| {
        let at = |bit: u32| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
        v(at(0), at(1), at(2))
    };
    // Fronts inside: north, west, east, floor, ceiling.
    for [a, b, c, d] in [[2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5], [0, 2, 3, 1], [4, 5, 7, 6]] {
        quad(&mut scene, [p(a), p(b), p(c), p(d)], wall);
    }
    let window = vec![p(0), p(4), p(5), p(1)];
    room(scene, &[reflectance], vec![("south".into(), window, system)], sky)
}

pub(super) fn room(scene: Scene, reflectances: &[f64], windows: Vec<(String, Vec<Vec3>, System)>, sky: Sky) -> Room {
    let materials = reflectances
        .iter()
        .map(|r| Material::lambertian(&[*r; 3], &[0.0; 3]).expect("a material"));
    let parts = Parts {
        surfaces: (0..reflectances.len() as u32)
            .map(|k| Surface {
                materials: [k; 2],
                media: [0; 2],
            })
            .collect(),
        scene,
        materials: materials.collect(),
        media: vec![Medium::air(3)],
        windows,
        lights: Vec::new(),
        sky,
    };
    Room::new(parts, &Progress::default()).expect("a room")
}

fn at(room: &Room, point: Vec3, normal: Vec3, samples: u32) -> (Rgb, Rgb) {
    let sensors = [Sensor { point, normal }];
    let found = room
        .irradiance(&sensors, samples, 5, &Progress::default())
        .expect("irradiance");
    (found[0].value, found[0].standard_error)
}

fn agrees(found: (Rgb, Rgb), expected: f64, most: f64) {
    for c in 0..3 {
        let (value, error) = (found.0[c], found.1[c]);
        assert!(error <= most * expected, "error {error} of {expected}");
        assert!(
            (value - expected).abs() <= 4.0 * error + 1e-9,
            "{value} ± {error}, not {expected}"
        );
    }
}

/// Share of the cosine-weighted hemisphere of a small plane at a distance from the corner of a parallel rectangle.
fn corner_factor(a: f64, b: f64, distance: f64) -> f64 {
    let (x, y) = (a / distance, b / distance);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / (2.0 * PI)
}

#[test]
fn a_white_room_in_an_even_world_is_as_bright_as_it() {
    let room = cube(1.0, open(), uniform());
    assert!(!room.windows()[0].obstructed());
    for (point, normal) in [
        (v(0.3, 0.9, -0.2), v(0.0, 0.0, 1.0)),
        (v(0.0, 0.0, -1.0), v(0.3, -0.2, 1.0)),
    ] {
        agrees(at(&room, point, normal, 65_536), PI * L, 3e-3);
    }
}

#[test]
fn a_diffuse_window_sends_by_its_form_factor() {
    let room = cube(0.0, diffuse(0.4), uniform());
    for distance in [0.2, 1.0, 1.9] {
        let factor = 4.0 * corner_factor(1.0, 1.0, distance);
        let found = at(&room, v(0.0, -1.0 + distance, 0.0), v(0.0, -1.0, 0.0), 65_536);
        agrees(found, 0.4 * PI * L * factor, 1e-3);
    }
}

#[test]
fn the_sun_through_an_open_window_has_its_irradiance() {
    let sky = clear(40.0, 180.0);
    let sun = sky.sun().expect("a sun");
    let room = cube(0.0, open(), sky.clone());
    // In the sun, and in the shade of the ceiling.
    let lit = at(&room, v(0.0, -0.9, -1.0), v(0.0, 0.0, 1.0), 16_384);
    let shaded = at(&room, v(0.0, 0.9, 0.9), v(0.0, 0.0, 1.0), 16_384);
    let direct = sun.radiance[0] * crate::sky::disc_solid_angle(sun.half_angle) * 40_f64.to_radians().sin();
    assert!(lit.0[0] > direct && lit.0[0] < 1.5 * direct, "{lit:?} {direct}");
    assert!(shaded.0[0] < 0.1 * direct, "{shaded:?}");
}

#[test]
fn a_room_of_one_reflectance_has_the_light_of_an_integrating_sphere() {
    // All paths of light: what enters is lost through the window or absorbed. Mean irradiance of the walls and the window by
    // the balance E_mean (A − ρ A_walls) = E_window A_window, where walls see each other by one factor only in a sphere: the
    // balance holds for totals, so the sum over a grid of points is tested.
    let (rho, tau) = (0.5, 0.6);
    let room = cube(rho, diffuse(tau), uniform());
    let n = 8;
    let mut sensors = Vec::new();
    let middle = |k: usize| -1.0 + (2 * k + 1) as f64 / n as f64;
    for i in 0..n {
        for j in 0..n {
            let (a, b) = (middle(i), middle(j));
            for (point, normal) in [
                (v(a, 1.0, b), v(0.0, -1.0, 0.0)),
                (v(-1.0, a, b), v(1.0, 0.0, 0.0)),
                (v(1.0, a, b), v(-1.0, 0.0, 0.0)),
                (v(a, b, -1.0), v(0.0, 0.0, 1.0)),
                (v(a, b, 1.0), v(0.0, 0.0, -1.0)),
                // What the window receives from the walls.
                (v(a, -1.0 + 1e-4, b), v(0.0, 1.0, 0.0)),
            ] {
                sensors.push(Sensor { point, normal });
            }
        }
    }
    let found = room
        .irradiance(&sensors, 1024, 3, &Progress::default())
        .expect("irradiance");
    let area = 4.0 / (n * n) as f64;
    let flux = |of: fn(usize) -> bool| -> f64 {
        (0..found.len())
            .filter(|k| of(k % 6))
            .map(|k| found[k].value[0] * area)
            .sum()
    };
    let (walls, lost) = (flux(|k| k < 5), flux(|k| k == 5));
    let entering = tau * PI * L * 4.0;
    // The middle of each of the 8 × 8 fields stands for it: near the window that is off by about a per cent.
    let balance = ((1.0 - rho) * walls + lost) / entering;
    assert!((balance - 1.0).abs() < 0.02, "{balance}");
}

#[test]
fn what_stands_before_a_window_takes_its_light() {
    // A white screen below the horizon's level stands for the ground; a black one over half of the view takes half.
    let mut scene = Scene::default();
    let black = scene.surface("black");
    let far = 1e4;
    // A vertical wall before the window's lower half plane: all directions below the horizontal from the window's middle.
    quad(
        &mut scene,
        [
            v(-far, -3.0, -far),
            v(far, -3.0, -far),
            v(far, -3.0, 0.0),
            v(-far, -3.0, 0.0),
        ],
        black,
    );
    let small = 1e-3;
    let corners = vec![
        v(-small, 0.0, -small),
        v(-small, 0.0, small),
        v(small, 0.0, small),
        v(small, 0.0, -small),
    ];
    let windows = vec![("w".into(), corners, diffuse(0.5))];
    let room = room(scene, &[0.0], windows, uniform());
    assert!(room.windows()[0].obstructed());
    // Close to it the window fills the view; half of the light is taken.
    let found = at(&room, v(0.0, 1e-5, 0.0), v(0.0, -1.0, 0.0), 65_536);
    let seen = 4.0 * corner_factor(small, small, 1e-5);
    agrees(found, 0.5 * 0.5 * PI * L * seen, 3e-3);
}

#[test]
fn threads_do_not_change_a_bit() {
    let room = cube(0.6, diffuse(0.5), clear(30.0, 200.0));
    let run = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .build()
            .expect("threads");
        pool.install(|| at(&room, v(0.2, 0.1, -0.5), v(0.0, 0.0, 1.0), 1024))
    };
    assert_eq!(run(1), run(2));
}
