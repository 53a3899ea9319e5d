//! Where the sun is, and its disc.
//!
//! Exact positions come from Python (pvlib); the two formulas here are the ones of Radiance's sky generators, for
//! comparisons with them.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// Half of the sun's angular diameter of 0.533° (radians).
pub const HALF_ANGLE: f64 = 0.2665 * PI / 180.0;

/// Solid angle of a disc (sr).
pub fn disc_solid_angle(half_angle: f64) -> f64 {
    // 1 - cos a = 2 sin²(a/2) keeps its digits for small angles.
    2.0 * TAU * (half_angle / 2.0).sin().powi(2)
}

/// The sun's disc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sun {
    /// Unit vector toward its centre, in the world (x east, y north, z up).
    pub direction: Vec3,
    /// Radiance of the disc, W/(m² sr) of Radiance's three channels.
    pub radiance: [f64; 3],
    /// Half of its angular diameter (radians).
    pub half_angle: f64,
}

/// Position of the sun in a world with x east, y north, z up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunPosition {
    altitude: f64,
    azimuth: f64,
}

impl SunPosition {
    /// From altitude above the horizon and compass azimuth, clockwise from north (degrees).
    pub fn from_degrees(altitude: f64, azimuth: f64) -> Result<Self> {
        if !((-90.0..=90.0).contains(&altitude) && azimuth.is_finite()) {
            return Err(Error::Argument(format!(
                "a sun at altitude {altitude}° and azimuth {azimuth}° is nowhere (altitudes go from -90 to 90°)"
            )));
        }
        Ok(Self {
            altitude: altitude.to_radians(),
            azimuth: azimuth.rem_euclid(360.0).to_radians(),
        })
    }

    /// Angle above the horizon (radians).
    pub fn altitude(self) -> f64 {
        self.altitude
    }

    /// Compass azimuth, clockwise from north (radians, 0 to 2π).
    pub fn azimuth(self) -> f64 {
        self.azimuth
    }

    /// Angle from the zenith (radians).
    pub fn zenith_angle(self) -> f64 {
        FRAC_PI_2 - self.altitude
    }

    /// Unit vector toward the sun: x east, y north, z up.
    pub fn direction(self) -> Vec3 {
        let (sa, ca) = self.altitude.sin_cos();
        let (sz, cz) = self.azimuth.sin_cos();
        Vec3::new(sz * ca, cz * ca, sa)
    }

    /// The position in a world whose y axis points to the compass azimuth `north` (radians) instead of north.
    #[must_use]
    pub fn seen_from(self, north: f64) -> Self {
        Self {
            azimuth: (self.azimuth - north).rem_euclid(TAU),
            ..self
        }
    }

    /// No higher than an altitude (radians).
    #[must_use]
    pub fn no_higher_than(self, altitude: f64) -> Self {
        Self {
            altitude: self.altitude.min(altitude),
            ..self
        }
    }

    /// No lower than an altitude (radians).
    #[must_use]
    pub fn no_lower_than(self, altitude: f64) -> Self {
        Self {
            altitude: self.altitude.max(altitude),
            ..self
        }
    }

    /// By the low-order formula of Radiance's sky generators, their default.
    ///
    /// `day` is the day of the year (February 29 counts as 60), `hour` local standard time.
    pub fn low_order(place: &Place, day: u32, hour: f64) -> Self {
        let j = f64::from(day);
        let declination = 0.4093 * (TAU * (j - 81.0) / 365.0).sin();
        let equation_of_time = 0.170 * (2.0 * TAU * (j - 80.0) / 373.0).sin() - 0.129 * (TAU * (j - 8.0) / 355.0).sin();
        // Both longitudes are positive east here.
        let solar_time = hour + equation_of_time + (place.longitude_deg - 15.0 * place.time_zone) / 15.0;
        Self::at_solar_time(place.latitude_deg.to_radians(), declination, solar_time)
    }

    /// By the formula of the Astronomical Almanac (Michalsky 1988), which Radiance's generators use when they know the
    /// year; good to 0.01° from 1950 to 2050.
    pub fn almanac(place: &Place, year: i32, day: u32, hour: f64) -> Self {
        let universal = hour - place.time_zone;
        // Days since noon of 1 January 2000, in universal time.
        let before = year - 1;
        let to_year = i64::from(before) * 365
            + i64::from(before.div_euclid(4) - before.div_euclid(100))
            + i64::from(before.div_euclid(400));
        let since_2000 = to_year - 730_119;
        let n = since_2000 as f64 + f64::from(day) - 1.0 + universal / 24.0 - 0.5;
        let mean_longitude = (280.460 + 0.985_647_4 * n).rem_euclid(360.0);
        let anomaly = (357.528 + 0.985_600_3 * n).to_radians();
        let ecliptic = (mean_longitude + 1.915 * anomaly.sin() + 0.020 * (2.0 * anomaly).sin()).to_radians();
        let obliquity = (23.439 - 4e-7 * n).to_radians();
        let declination = (obliquity.sin() * ecliptic.sin()).asin();
        let right_ascension = (obliquity.cos() * ecliptic.sin()).atan2(ecliptic.cos());
        let sidereal = 6.697_375 + 0.065_709_824_2 * n + universal;
        let solar_time = sidereal + place.longitude_deg / 15.0 - right_ascension.to_degrees() / 15.0 + 12.0;
        Self::at_solar_time(
            place.latitude_deg.to_radians(),
            declination,
            solar_time.rem_euclid(24.0),
        )
    }

    fn at_solar_time(latitude: f64, declination: f64, solar_time: f64) -> Self {
        let (sl, cl) = latitude.sin_cos();
        let (sd, cd) = declination.sin_cos();
        let (st, ct) = (PI * solar_time / 12.0).sin_cos();
        let altitude = (sl * sd - cl * cd * ct).clamp(-1.0, 1.0).asin();
        let from_south = -(cd * st).atan2(-cl * sd - sl * cd * ct);
        Self {
            altitude,
            azimuth: (from_south + PI).rem_euclid(TAU),
        }
    }
}

/// A place and its clock.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Degrees, north positive.
    pub latitude_deg: f64,
    /// Degrees, EAST positive (as in EPW; WEA files and Radiance's options count west).
    pub longitude_deg: f64,
    /// Hours ahead of universal time, without daylight saving.
    pub time_zone: f64,
}

/// Day of the year, 1 to 365, of a month and day; February 29 counts as 60, as in weather files.
pub fn day_of_year(month: u32, day: u32) -> Result<u32> {
    const BEFORE: [u32; 13] = [0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, 365];
    let fail = || Error::Argument(format!("there is no day {day} of month {month}"));
    if !(1..=12).contains(&month) || day == 0 {
        return Err(fail());
    }
    let first = BEFORE[month as usize - 1];
    let leap = u32::from(month == 2);
    if first + day > BEFORE[month as usize] + leap {
        return Err(fail());
    }
    Ok(first + day)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solar altitude and azimuth of gensky (formats.md 12.6): it prints a digit of the angles, six of the direction.
    #[test]
    fn the_low_order_formula_is_radiances() {
        for (place, (month, day), hour, expected) in [
            ((37.87, -122.27, -8.0), (3, 21), 9.5, [0.664_178, -0.464_456, 0.585_788]),
            ((52.5, 13.4, 1.0), (6, 21), 12.0, [0.031_226, -0.485_137, 0.873_881]),
            ((-33.87, 151.2, 10.0), (9, 23), 15.0, [-0.743_863, 0.357_719, 0.564_539]),
        ] {
            let place = Place {
                latitude_deg: place.0,
                longitude_deg: place.1,
                time_zone: place.2,
            };
            let day = day_of_year(month, day).unwrap();
            let found = SunPosition::low_order(&place, day, hour).direction().array();
            for (a, b) in found.iter().zip(expected) {
                assert!((a - b).abs() < 1e-6, "{found:?} for {expected:?}");
            }
        }
    }

    #[test]
    fn the_almanac_is_radiances() {
        let place = Place {
            latitude_deg: 40.0,
            longitude_deg: -105.0,
            time_zone: -7.0,
        };
        // 21 June of a leap year is day 173.
        let found = SunPosition::almanac(&place, 2024, 173, 10.5).direction().array();
        for (a, b) in found.iter().zip([0.358_419, -0.238_278, 0.902_640]) {
            assert!((a - b).abs() < 2e-6, "{found:?}");
        }
    }

    #[test]
    fn a_turned_world_sees_the_sun_turned() {
        let sun = SunPosition::from_degrees(30.0, 100.0).unwrap();
        let turned = sun.seen_from(10.0_f64.to_radians());
        assert!((turned.azimuth().to_degrees() - 90.0).abs() < 1e-12);
        assert!((turned.direction().y).abs() < 1e-15);
        assert!(turned.direction().x > 0.86);
    }

    #[test]
    fn days_that_do_not_exist_are_refused() {
        assert_eq!(day_of_year(2, 29), Ok(60));
        assert_eq!(day_of_year(3, 1), Ok(60));
        assert_eq!(day_of_year(12, 31), Ok(365));
        for (month, day) in [(0, 1), (13, 1), (2, 30), (4, 31), (5, 0)] {
            assert!(day_of_year(month, day).is_err());
        }
        assert!(SunPosition::from_degrees(f64::NAN, 0.0).is_err());
        assert!(SunPosition::from_degrees(91.0, 0.0).is_err());
    }
}
