//! Matrices whose sums are known.

use super::*;
use crate::basis::Basis;
use crate::room::{Groups, Paths, Rows};
use crate::sky::patches::SkyPatches;

const PATHS: Paths = Paths {
    samples: 1 << 14,
    seed: 3,
};

fn groups(windows: usize) -> Groups {
    Groups {
        of_window: vec![0; windows],
        basis: Basis::klems_full(),
    }
}

fn view(room: &Room, point: Vec3, normal: Vec3) -> Rows {
    let sensors = [Sensor { point, normal }];
    room.view_matrix(&sensors, &groups(1), PATHS, &Progress::default())
        .expect("a matrix")
}

fn sum(values: &[[f32; 3]]) -> f64 {
    values.iter().map(|v| f64::from(v[1])).sum()
}

fn is_near(found: f64, expected: f64, share: f64) {
    assert!((found / expected - 1.0).abs() < share, "{found}, not {expected}");
}

#[test]
fn a_window_in_a_black_room_gives_its_form_factor() {
    let room = cube(0.0, diffuse(1.0), uniform());
    let rows = view(&room, v(0.0, 0.0, 0.0), v(0.0, -1.0, 0.0));
    assert_eq!(rows.all, rows.direct);
    is_near(sum(&rows.all), 4.0 * PI * corner_factor(1.0, 1.0, 1.0), 0.002);
}

#[test]
fn rows_times_the_windows_light_are_irradiances() {
    let room = cube(0.5, diffuse(0.8), uniform());
    let (point, normal) = (v(0.3, 0.5, -0.9), v(0.0, 0.0, 1.0));
    let rows = view(&room, point, normal);
    let found = at(&room, point, normal, 1 << 14);
    let error = rows
        .standard_error
        .iter()
        .map(|e| f64::from(*e).powi(2))
        .sum::<f64>()
        .sqrt()
        * 0.8
        * L;
    let difference = sum(&rows.all) * 0.8 * L - found.0[1];
    assert!(difference.abs() < 4.0 * error.hypot(found.1[1]), "{difference} {error}");
    assert!(sum(&rows.direct) < 0.9 * sum(&rows.all));
}

#[test]
fn what_the_window_returns_closes_the_balance() {
    const REFLECTANCE: f64 = 0.6;
    let system = system(&Model::Lambertian(Lambertian::new(0.3).expect("a share")), REFLECTANCE);
    let room = cube(0.7, system, uniform());
    let (point, normal) = (v(0.0, 0.0, -0.9), v(0.0, 0.0, 1.0));
    let groups = groups(1);
    let back = room
        .return_matrix(0, &groups, PATHS, &Progress::default())
        .expect("a matrix");
    let areas = groups.basis.projected_solid_angles();
    let returned: f64 = back
        .all
        .chunks(back.columns)
        .zip(&areas)
        .map(|(row, area)| sum(row) * area / PI)
        .sum();
    let window = 0.3 * L / (1.0 - REFLECTANCE * returned);
    let rows = view(&room, point, normal);
    let found = at(&room, point, normal, 1 << 15);
    is_near(sum(&rows.all) * window, found.0[1], 0.005);
    // Without it a good part would be missing.
    assert!(sum(&rows.all) * 0.3 * L < 0.9 * found.0[1]);
}

#[test]
fn a_free_window_sees_each_patch_of_the_sky_as_large_as_it_is() {
    let room = cube(0.5, diffuse(1.0), uniform());
    let (groups, sky) = (groups(1), SkyPatches::reinhart(1).expect("patches"));
    let rows = room
        .daylight_matrix(0, &groups, &sky, PATHS, &Progress::default())
        .expect("a matrix");
    assert_eq!(rows.all, rows.direct);
    let mut seen = vec![0.0; rows.columns];
    for (row, area) in rows.all.chunks(rows.columns).zip(groups.basis.projected_solid_angles()) {
        is_near(sum(row), 1.0, 1e-5);
        for (seen, part) in seen.iter_mut().zip(row) {
            *seen += f64::from(part[0]) * area;
        }
    }
    is_near(seen[0], PI / 2.0, 0.002);
    for (patch, seen) in seen.iter().enumerate().skip(1) {
        let facing = -sky.centre(patch).y;
        if facing > 0.3 {
            is_near(*seen, sky.solid_angle(patch) * facing, 0.02);
        }
    }
}

#[test]
fn a_wall_outside_hides_the_sky_and_reflects_it() {
    let mut scene = Scene::default();
    let wall = scene.surface("wall outside");
    let x = 1000.0;
    // Faces north, towards the window.
    quad(
        &mut scene,
        [v(-x, -5.0, -x), v(-x, -5.0, x), v(x, -5.0, x), v(x, -5.0, -x)],
        wall,
    );
    let window = vec![
        v(-1.0, 0.0, -1.0),
        v(-1.0, 0.0, 1.0),
        v(1.0, 0.0, 1.0),
        v(1.0, 0.0, -1.0),
    ];
    let room = room(scene, &[0.5], vec![("south".into(), window, diffuse(1.0))], uniform());
    let (groups, sky) = (groups(1), SkyPatches::reinhart(1).expect("patches"));
    let rows = room
        .daylight_matrix(0, &groups, &sky, PATHS, &Progress::default())
        .expect("a matrix");
    let mean = |values: &[[f32; 3]]| {
        let rows = values.chunks(rows.columns).zip(groups.basis.projected_solid_angles());
        rows.map(|(row, area)| sum(row) * area / PI).sum::<f64>()
    };
    assert!(mean(&rows.direct) < 0.02);
    // The wall sees half of an even world, the window's side of it.
    is_near(mean(&rows.all), 0.5, 0.02);
}

#[test]
fn cells_that_a_point_sees_fill_the_window() {
    let room = cube(0.0, diffuse(1.0), uniform());
    let sensors = [Sensor {
        point: v(0.0, 0.0, 0.0),
        normal: v(0.0, -1.0, 0.0),
    }];
    let seen = room
        .apertures(&sensors, &groups(1), 64, 4, &Progress::default())
        .expect("cells");
    let of = |value: fn(&crate::room::SeenCell) -> f32| seen[0].iter().map(|c| f64::from(value(c))).sum::<f64>();
    // Probes that an edge of the window cuts through count wholly or not at all.
    is_near(of(|c| c.projected), 4.0 * PI * corner_factor(1.0, 1.0, 1.0), 0.004);
    // A face of a cube from its middle.
    is_near(of(|c| c.solid_angle), 4.0 * PI / 6.0, 0.004);
    let axis: f64 = seen[0].iter().map(|c| f64::from(c.solid_angle * c.direction[0])).sum();
    assert!(axis.abs() < 1e-3);
}

#[test]
fn the_sky_is_seen_through_the_window_only() {
    let room = cube(0.0, diffuse(1.0), uniform());
    let towards = [v(0.0, -1.0, 0.2), v(0.0, -1.0, 1.2), v(0.0, 1.0, 0.0)];
    let points = [v(0.0, 0.0, 0.0), v(0.0, -3.0, 0.0)];
    let found = room
        .windows_towards(&points, &towards, &Progress::default())
        .expect("windows");
    assert_eq!(found, [1, 0, 0, crate::room::OPEN, crate::room::OPEN, 0]);
}
