use super::patches::{Part, SkyPatches, SunPatches, Value};
use super::*;

fn moment(altitude_deg: f64, azimuth_deg: f64, day: u32) -> Moment {
    Moment {
        sun: SunPosition::from_degrees(altitude_deg, azimuth_deg).unwrap(),
        day,
        dew_point: DEW_POINT,
    }
}

fn toward(direction: [f64; 3]) -> (f64, f64) {
    let [x, y, z] = direction;
    (z.asin().to_degrees(), x.atan2(y).to_degrees())
}

fn irradiance(direct_normal: f64, diffuse_horizontal: f64) -> Supply {
    Supply::Irradiance {
        direct_normal,
        diffuse_horizontal,
    }
}

fn with(preset: Preset) -> Settings {
    Settings {
        preset,
        ..Settings::default()
    }
}

/// Within the last of four printed digits.
fn printed(found: f64, expected: f64) -> bool {
    (found / expected - 1.0).abs() < 6e-4 || found == expected
}

/// Scale, ground and sun of gendaylit, visible and solar (formats.md 12.7).
#[test]
fn point_skies_are_gendaylits() {
    let cases = [
        (
            [0.664_178, -0.464_456, 0.585_788],
            80,
            irradiance(700.0, 120.0),
            [37.12, 18.30, 5.664e6],
            [44.91, 30.89, 1.030e7],
        ),
        (
            [0.031_226, -0.485_137, 0.873_881],
            172,
            irradiance(850.0, 110.0),
            [36.76, 31.90, 7.225e6],
            [49.80, 53.49, 1.251e7],
        ),
        (
            [-0.743_863, 0.357_719, 0.564_539],
            266,
            irradiance(300.0, 200.0),
            [32.57, 11.90, 2.317e6],
            [46.86, 19.76, 4.414e6],
        ),
    ];
    for (sun, day, supply, visible, solar) in cases {
        let (altitude, azimuth) = toward(sun);
        for (quantity, expected) in [(Quantity::Visible, visible), (Quantity::Solar, solar)] {
            let settings = Settings {
                quantity,
                ..with(Preset::Radiance)
            };
            let sky = Sky::perez(&moment(altitude, azimuth, day), supply, &settings).unwrap();
            let (_, scale) = sky.distribution().unwrap();
            assert!(printed(scale, expected[0]), "{scale} {expected:?}");
            assert!(printed(sky.ground()[0], expected[1]), "{:?} {expected:?}", sky.ground());
            let disc = sky.sun().unwrap();
            assert!(printed(disc.radiance[0], expected[2]), "{disc:?} {expected:?}");
        }
    }
}

/// Zenith, ground and sun of gensky (formats.md 12.6), turbidity 2.45.
#[test]
fn standard_skies_are_genskys() {
    for (kind, sun, zenith, ground, disc) in [
        (
            Traditional::Clear,
            [0.664_178, -0.464_456, 0.585_788],
            7.431,
            17.22,
            6.462e6,
        ),
        (
            Traditional::Clear,
            [0.031_226, -0.485_137, 0.873_881],
            15.70,
            26.66,
            7.059e6,
        ),
        (
            Traditional::Intermediate,
            [-0.743_863, 0.357_719, 0.564_539],
            15.83,
            6.167,
            9.591e5,
        ),
        (
            Traditional::Clear,
            [0.358_419, -0.238_278, 0.902_640],
            18.00,
            27.61,
            7.097e6,
        ),
    ] {
        let (altitude, azimuth) = toward(sun);
        let settings = with(Preset::Radiance);
        let sky = Sky::traditional(
            kind,
            true,
            &moment(altitude, azimuth, 80),
            Level::Turbidity(2.45),
            &settings,
        )
        .unwrap();
        let (distribution, scale) = sky.distribution().unwrap();
        let found = scale * kind.at_zenith(sky.position().zenith_angle());
        assert!(printed(found, zenith), "{kind:?}: {found} {zenith}");
        assert!(
            printed(sky.ground()[1], ground),
            "{kind:?}: {:?} {ground}",
            sky.ground()
        );
        assert!(printed(sky.sun().unwrap().radiance[2], disc), "{kind:?}");
        assert!(distribution.value(0.5, 1.0) > 0.0);
    }
}

/// A sky's horizontal irradiance by a quadrature of its own: what was asked for.
#[test]
fn diffuse_irradiance_is_conserved() {
    for (altitude, direct, diffuse) in [
        (5.0, 20.0, 30.0),
        (35.9, 700.0, 120.0),
        (61.0, 0.0, 60.0),
        (88.5, 950.0, 70.0),
    ] {
        let settings = Settings {
            quantity: Quantity::Solar,
            ..Settings::default()
        };
        let sky = Sky::perez(&moment(altitude, 130.0, 80), irradiance(direct, diffuse), &settings).unwrap();
        let up = sky.diffuse_on(Vec3::new(0.0, 0.0, 1.0));
        assert!((up[0] / diffuse - 1.0).abs() < 1e-6, "{up:?} {diffuse}");
        assert!((sky.direct_normal()[0] / direct.max(1e-9) - 1.0).abs() < 1e-9 || direct == 0.0);
        let ground = 0.2 * (diffuse + direct * altitude.to_radians().sin()) / PI;
        assert!((sky.radiance(Vec3::new(0.6, 0.0, -0.8))[0] / ground - 1.0).abs() < 1e-9);
    }
}

#[test]
fn overcast_and_uniform_skies_have_their_closed_forms() {
    let now = moment(30.0, 180.0, 80);
    let sky = Sky::traditional(
        Traditional::Overcast,
        true,
        &now,
        Level::Zenith(9000.0),
        &Settings::default(),
    )
    .unwrap();
    let up = Vec3::new(0.0, 0.0, 1.0);
    assert!((sky.radiance(up)[0] * EFFICACY / 9000.0 - 1.0).abs() < 1e-12);
    assert!((sky.diffuse_horizontal()[0] * EFFICACY / (7.0 * PI / 9.0 * 9000.0) - 1.0).abs() < 1e-9);
    assert!(sky.sun().is_none());
    // A vertical plane: 0.39618 of the horizontal from the sky (methods.md 5.2), half of the ground's.
    let south = sky.diffuse_on(Vec3::new(0.0, -1.0, 0.0))[0] / sky.diffuse_horizontal()[0];
    assert!((south - 0.396_18 - 0.1).abs() < 1e-5, "{south}");
    let sky = Sky::traditional(
        Traditional::Uniform,
        true,
        &now,
        Level::Zenith(5000.0),
        &Settings::default(),
    )
    .unwrap();
    assert!((sky.diffuse_horizontal()[0] * EFFICACY / (PI * 5000.0) - 1.0).abs() < 1e-9);
}

/// Type 12 is the traditional clear sky, whose constants are rounded.
#[test]
fn cie_12_is_the_clear_sky() {
    let now = moment(40.0, 200.0, 172);
    let level = Level::Zenith(4000.0);
    let general = Sky::cie(12, &now, level, &Settings::default()).unwrap();
    let clear = Sky::traditional(Traditional::Clear, false, &now, level, &Settings::default()).unwrap();
    for direction in [Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.9, 0.1).unit()] {
        let (a, b) = (general.radiance(direction)[0], clear.radiance(direction)[0]);
        assert!((a / b - 1.0).abs() < 1e-3, "{a} {b}");
    }
}

#[test]
fn colours_keep_the_luminance() {
    let now = moment(40.0, 200.0, 172);
    let grey = Sky::perez(&now, irradiance(500.0, 100.0), &Settings::default()).unwrap();
    let settings = Settings {
        colour: RADIANCE_COLOUR,
        ..Settings::default()
    };
    let blue = Sky::perez(&now, irradiance(500.0, 100.0), &settings).unwrap();
    let direction = Vec3::new(0.0, 0.6, 0.8);
    assert!((photometric(blue.radiance(direction)) / photometric(grey.radiance(direction)) - 1.0).abs() < 1e-12);
    assert!(blue.radiance(direction)[2] > blue.radiance(direction)[0]);
    // Preetham's colours mix to the grey sky of the same level.
    let coloured = Sky::preetham(&now, 3.0, None, false, &Settings::default()).unwrap();
    let grey = Sky::preetham(&now, 3.0, None, true, &Settings::default()).unwrap();
    let ratio = photometric(coloured.radiance(direction)) / photometric(grey.radiance(direction));
    assert!((ratio - 1.0).abs() < 1e-6);
    let ratio = photometric(coloured.diffuse_horizontal()) / photometric(grey.diffuse_horizontal());
    assert!((ratio - 1.0).abs() < 1e-3, "{ratio}");
}

#[test]
fn night_has_no_sky_but_overcast_ones_do_not_mind() {
    let night = moment(-20.0, 0.0, 80);
    let bright = Level::Supply(Supply::Illuminance {
        direct_normal: 0.0,
        diffuse_horizontal: 10_000.0,
    });
    assert!(Sky::perez(&night, irradiance(0.0, 10.0), &Settings::default()).is_err());
    assert!(Sky::cie(12, &night, bright, &Settings::default()).is_err());
    assert!(Sky::cie(1, &night, bright, &Settings::default()).is_ok());
    let overcast = |level| Sky::traditional(Traditional::Overcast, true, &night, level, &Settings::default());
    assert!(overcast(bright).is_ok());
    assert!(overcast(Level::Turbidity(2.45)).is_err());
}

/// Rows and sums of gendaymtx (formats.md 12.8), the third step's sun at altitude 12.26°, 46.774° west of south.
#[test]
fn patches_are_gendaymtxs() {
    let place = Place {
        latitude_deg: 37.87,
        longitude_deg: -122.27,
        time_zone: -8.0,
    };
    let sky = |month, day, hour, supply| {
        let day = day_of_year(month, day).unwrap();
        let now = Moment {
            sun: SunPosition::low_order(&place, day, hour),
            day,
            dew_point: 11.0,
        };
        Sky::perez(&now, supply, &with(Preset::RadianceMatrix)).unwrap()
    };
    let noon = sky(6, 21, 12.0, irradiance(850.0, 110.0));
    let dusk = sky(9, 23, 18.0, irradiance(0.0, 25.0));
    for (n, sums, brightest) in [
        (1, [14_347.23, 846.9713], (142, 7038.689)),
        (2, [61_008.55, 3411.883], (559, 14_005.77)),
        (4, [285_695.0, 13_586.22], (2184, 73_680.91)),
    ] {
        let patches = SkyPatches::reinhart(n).unwrap();
        for (sky, sum) in [(&noon, sums[0]), (&dusk, sums[1])] {
            let values = patches
                .radiances(sky, Part::All, SunPatches::Spread, Value::Centre)
                .unwrap();
            let found: f64 = values[1..].iter().map(|v| v[0]).sum();
            assert!((found / sum - 1.0).abs() < 1e-5, "MF:{n}: {found} {sum}");
        }
        let values = patches
            .radiances(&noon, Part::All, SunPatches::Spread, Value::Centre)
            .unwrap();
        assert!((values[0][0] / 35.3445 - 1.0).abs() < 1e-5);
        assert!((values[brightest.0][1] / brightest.1 - 1.0).abs() < 1e-5);
    }
    let patches = SkyPatches::reinhart(6).unwrap();
    let values = patches
        .radiances(&noon, Part::Sun, SunPatches::Disc(0.533), Value::Centre)
        .unwrap();
    let lit: Vec<usize> = (0..values.len()).filter(|&p| values[p][0] > 0.0).collect();
    assert_eq!(lit, [4931]);
    assert!(
        (values[4931][0] / 7_238_268.0 - 1.0).abs() < 1e-5,
        "{}",
        values[4931][0]
    );
}

/// The mean over patches keeps the horizontal irradiance.
#[test]
fn means_over_patches_conserve() {
    let sky = Sky::perez(&moment(35.9, 130.0, 80), irradiance(700.0, 120.0), &Settings::default()).unwrap();
    for n in [1, 2] {
        let patches = SkyPatches::reinhart(n).unwrap();
        let values = patches
            .radiances(&sky, Part::Sky, SunPatches::Spread, Value::Mean)
            .unwrap();
        let sum: f64 = (1..patches.len())
            .map(|p| values[p][0] * patches.projected_solid_angle(p))
            .sum();
        assert!((sum / sky.diffuse_horizontal()[0] - 1.0).abs() < 1e-12);
    }
}

/// A table of the indicatrix is as good as the formula.
#[test]
fn indicatrices_are_tabulated_well() {
    for (direct, diffuse) in [(900.0, 60.0), (300.0, 250.0), (0.0, 120.0)] {
        let sky = Sky::perez(&moment(25.9, 130.0, 80), irradiance(direct, diffuse), &Settings::default()).unwrap();
        let table = sky.indicatrix(1_000_000).unwrap();
        let Shape::Grey {
            distribution: Distribution::Lobed(lobed),
            ..
        } = sky.shape
        else {
            panic!("Perez's skies are lobed")
        };
        for k in 0..20_000 {
            let cos_gamma = (f64::from(k) * 1e-4 * std::f64::consts::PI / 2.0).cos();
            let (found, expected) = (table.at(cos_gamma), lobed.about(cos_gamma));
            assert!((found - expected).abs() < 3e-5 * lobed.about(1.0), "{k}: {found} {expected}");
        }
    }
}
