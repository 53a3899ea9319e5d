//! The sky in patches: Tregenza's 145 and Reinhart's subdivisions, as columns of daylight matrices.
//!
//! Order of Radiance's matrix program: the ground is first, then rows from the horizon up; each begins in the north and
//! runs clockwise seen from above; the zenith is last. Angle bases of windows ([`crate::basis`]) count otherwise.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use super::sun::HALF_ANGLE;
use super::{Preset, Sky, Sun, disc_solid_angle};
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// Patches of Tregenza's rows from the horizon up, without the zenith.
const COUNTS: [usize; 7] = [30, 30, 24, 24, 18, 12, 6];
/// Samples across a patch of Tregenza's, for means.
const SAMPLES: usize = 16;

/// A division of the sky into Reinhart's patches, and the ground.
#[derive(Debug, Clone)]
pub struct SkyPatches {
    subdivision: usize,
    /// Height of a row (radians).
    height: f64,
    /// Number of each row's first patch, the ground being 0, and the zenith's at the end.
    first: Vec<usize>,
}

/// Which light is in a vector.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Part {
    /// Sky, ground and sun.
    #[default]
    All,
    /// Sky and ground; the ground is lit by the sun, too.
    Sky,
    /// The sun alone, over a black sky and ground.
    Sun,
}

/// How the sun is put into patches.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub enum SunPatches {
    /// Into the four nearest patches, by their nearness.
    #[default]
    Spread,
    /// Into the nearest patch, with the radiance of a disc of this full angle (degrees), as the five-phase method asks for.
    Disc(f64),
}

/// What a patch's value is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Value {
    /// The sky's at the centre of the patch.
    Centre,
    /// The mean over the patch.
    Mean,
}

/// Directions in which patches are looked at, equally many in each but the ground.
pub(super) struct Samples {
    each: usize,
    directions: Vec<Vec3>,
}

impl SkyPatches {
    /// Reinhart MF:n, 144 n² + 1 patches of the sky; n = 1 is Tregenza's 145.
    pub fn reinhart(subdivision: usize) -> Result<Self> {
        if !(1..=64).contains(&subdivision) {
            return Err(Error::Argument(format!(
                "Reinhart MF:{subdivision} is not a subdivision (give 1 to 64)"
            )));
        }
        let mut first = vec![1];
        for row in 0..7 * subdivision {
            first.push(first[row] + COUNTS[row / subdivision] * subdivision);
        }
        Ok(Self {
            subdivision,
            height: FRAC_PI_2 / (7.0 * subdivision as f64 + 0.5),
            first,
        })
    }

    /// By name: `tregenza`, `reinhart:4`, `mf:4`.
    pub fn named(name: &str) -> Result<Self> {
        let key = name.trim().to_ascii_lowercase();
        if key == "tregenza" {
            return Self::reinhart(1);
        }
        let number = key
            .strip_prefix("reinhart")
            .unwrap_or(&key)
            .trim_start_matches([':', '-', ' ']);
        let number = number
            .strip_prefix("mf")
            .unwrap_or(number)
            .trim_start_matches([':', '-', ' ']);
        number.parse().map_or_else(
            |_| {
                Err(Error::Argument(format!(
                    "sky patches {name:?} are not known (known: tregenza, reinhart:N)"
                )))
            },
            Self::reinhart,
        )
    }

    /// n of Reinhart MF:n.
    pub fn subdivision(&self) -> usize {
        self.subdivision
    }

    /// Number of patches with the ground.
    pub fn len(&self) -> usize {
        self.zenith() + 1
    }

    /// Never.
    pub fn is_empty(&self) -> bool {
        false
    }

    fn rows(&self) -> usize {
        7 * self.subdivision
    }

    fn zenith(&self) -> usize {
        self.first[self.rows()]
    }

    /// Row, column and number of columns of a patch between ground and zenith.
    fn place(&self, patch: usize) -> (usize, usize, usize) {
        let row = self.first.partition_point(|&f| f <= patch) - 1;
        (row, patch - self.first[row], self.first[row + 1] - self.first[row])
    }

    /// Lower and upper altitude, and azimuth of the left and right border seen clockwise from north (radians).
    pub fn limits(&self, patch: usize) -> ([f64; 2], [f64; 2]) {
        if patch == 0 {
            return ([-FRAC_PI_2, 0.0], [-PI, PI]);
        }
        if patch >= self.zenith() {
            return ([FRAC_PI_2 - self.height / 2.0, FRAC_PI_2], [-PI, PI]);
        }
        let (row, column, count) = self.place(patch);
        let width = TAU / count as f64;
        let azimuth = width * column as f64;
        (
            [self.height * row as f64, self.height * (row + 1) as f64],
            [azimuth - width / 2.0, azimuth + width / 2.0],
        )
    }

    /// Unit vector to the centre of a patch; down for the ground.
    pub fn centre(&self, patch: usize) -> Vec3 {
        if patch == 0 {
            return Vec3::new(0.0, 0.0, -1.0);
        }
        if patch >= self.zenith() {
            return Vec3::new(0.0, 0.0, 1.0);
        }
        let (row, column, count) = self.place(patch);
        direction(self.height * (row as f64 + 0.5), TAU * column as f64 / count as f64)
    }

    /// Solid angle of a patch (sr); 2π for the ground.
    pub fn solid_angle(&self, patch: usize) -> f64 {
        let ([low, high], [left, right]) = self.limits(patch);
        (high.sin() - low.sin()) * (right - left)
    }

    /// ∫ |cos| dω over a patch to the horizontal plane (sr); π for all of the sky.
    pub fn projected_solid_angle(&self, patch: usize) -> f64 {
        let ([low, high], [left, right]) = self.limits(patch);
        (high.sin().powi(2) - low.sin().powi(2)).abs() * (right - left) / 2.0
    }

    /// Patch that a direction lies in; 0 below the horizon.
    pub fn patch_of(&self, direction: Vec3) -> usize {
        if direction.z < 0.0 {
            return 0;
        }
        let altitude = direction.z.atan2(direction.x.hypot(direction.y));
        let row = (altitude / self.height) as usize;
        if row >= self.rows() {
            return self.zenith();
        }
        let count = self.first[row + 1] - self.first[row];
        let azimuth = direction.x.atan2(direction.y).rem_euclid(TAU);
        let column = (azimuth / TAU * count as f64 + 0.5) as usize % count;
        self.first[row] + column
    }

    /// Radiance of every patch, with the ground at 0 (W/(m² sr), Radiance's R, G, B).
    ///
    /// In the matrix program's preset values are taken at centres and normalised over the patches with their centres'
    /// cosines, as that program does. In others the sky is scaled by one factor, so that its horizontal irradiance over the
    /// patches' projected solid angles is the sky's own.
    pub fn radiances(&self, sky: &Sky, part: Part, sun: SunPatches, value: Value) -> Result<Vec<[f64; 3]>> {
        self.radiances_at(sky, part, sun, &self.samples(value))
    }

    /// As [`SkyPatches::radiances`], with directions that were found once for many skies.
    pub(super) fn radiances_at(
        &self,
        sky: &Sky,
        part: Part,
        sun: SunPatches,
        samples: &Samples,
    ) -> Result<Vec<[f64; 3]>> {
        let mut made = vec![[0.0; 3]; self.len()];
        if part != Part::Sun {
            self.put_sky(sky, samples, &mut made);
        }
        if let Some(disc) = sky.sun().filter(|_| part != Part::Sky) {
            self.put_sun(&disc, sun, &mut made)?;
        }
        Ok(made)
    }

    fn put_sky(&self, sky: &Sky, samples: &Samples, made: &mut [[f64; 3]]) {
        made[0] = sky.ground();
        let table = sky.indicatrix(samples.directions.len());
        for (radiance, directions) in made[1..].iter_mut().zip(samples.directions.chunks(samples.each)) {
            *radiance = sky.mean_radiance(directions, table.as_ref());
        }
        let wanted = sky.diffuse_horizontal();
        let at_centres = sky.settings().preset == Preset::RadianceMatrix;
        if at_centres && made[2..].iter().all(|radiance| *radiance == made[1]) {
            // The even sky that stands for an undefined one is E/π, and not normalised.
            return;
        }
        let mut found = [0.0; 3];
        for (patch, radiance) in made.iter().enumerate().skip(1) {
            let weight = if at_centres {
                self.solid_angle(patch) * self.centre(patch).z
            } else {
                self.projected_solid_angle(patch)
            };
            for (sum, l) in found.iter_mut().zip(radiance) {
                *sum += weight * l;
            }
        }
        for radiance in &mut made[1..] {
            for ((l, wanted), found) in radiance.iter_mut().zip(wanted).zip(found) {
                if found > 0.0 {
                    *l *= wanted / found;
                }
            }
        }
    }

    /// Where the sky is looked at.
    pub(super) fn samples(&self, value: Value) -> Samples {
        let patches = 1..self.len();
        match value {
            Value::Centre => Samples {
                each: 1,
                directions: patches.map(|patch| self.centre(patch)).collect(),
            },
            Value::Mean => {
                let across = SAMPLES.div_ceil(self.subdivision).max(4);
                Samples {
                    each: across * across,
                    directions: patches.flat_map(|patch| self.within(patch, across)).collect(),
                }
            }
        }
    }

    /// Centres of `across`² cells of a patch that have equal solid angles.
    fn within(&self, patch: usize, across: usize) -> impl Iterator<Item = Vec3> {
        let ([low, high], [left, right]) = self.limits(patch);
        let (low, high) = (low.sin(), high.sin());
        let share = move |k: usize| (k as f64 + 0.5) / across as f64;
        (0..across * across).map(move |cell| {
            let sin = low + (high - low) * share(cell / across);
            direction(sin.asin(), left + (right - left) * share(cell % across))
        })
    }

    fn put_sun(&self, disc: &Sun, how: SunPatches, made: &mut [[f64; 3]]) -> Result<()> {
        let irradiance = disc.radiance.map(|l| l * disc_solid_angle(disc.half_angle));
        let mut near: Vec<(f64, usize)> = (1..self.len())
            .map(|patch| (self.centre(patch).dot(disc.direction), patch))
            .collect();
        // Only the nearest four are asked for.
        let order = |a: &(f64, usize), b: &(f64, usize)| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1));
        near.select_nth_unstable_by(3, order);
        near[..4].sort_by(order);
        match how {
            SunPatches::Spread => {
                let nearest = &near[..4];
                let sum: f64 = nearest.iter().map(|(cos, _)| 1.0 / (1.002 - cos)).sum();
                for &(cos, patch) in nearest {
                    let share = 1.0 / (1.002 - cos) / sum / self.solid_angle(patch);
                    for (l, e) in made[patch].iter_mut().zip(irradiance) {
                        *l += share * e;
                    }
                }
            }
            SunPatches::Disc(angle) => {
                if !(angle > 0.0 && angle <= 90.0) {
                    return Err(Error::Argument(format!(
                        "a sun of {angle}° is not possible (give its full angle; 0.533 is the sun's, {:.3} in radians)",
                        2.0 * HALF_ANGLE
                    )));
                }
                // The matrix program takes a small disc as flat.
                let solid_angle = PI * (angle.to_radians() / 2.0).powi(2);
                for (l, e) in made[near[0].1].iter_mut().zip(irradiance) {
                    *l += e / solid_angle;
                }
            }
        }
        Ok(())
    }
}

/// Unit vector at an altitude and a compass azimuth (radians).
fn direction(altitude: f64, azimuth: f64) -> Vec3 {
    let (sa, ca) = altitude.sin_cos();
    let (sz, cz) = azimuth.sin_cos();
    Vec3::new(sz * ca, cz * ca, sa)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_and_solid_angles_are_whole() {
        for (n, rows) in [(1, 146), (2, 578), (3, 1298), (4, 2306), (6, 5186), (8, 9218)] {
            let patches = SkyPatches::reinhart(n).unwrap();
            assert_eq!(patches.len(), rows);
            let sky: f64 = (1..rows).map(|p| patches.solid_angle(p)).sum();
            assert!((sky - TAU).abs() < 1e-10);
            let projected: f64 = (1..rows).map(|p| patches.projected_solid_angle(p)).sum();
            assert!((projected - PI).abs() < 1e-10);
            assert!((patches.solid_angle(0) - TAU).abs() < 1e-12);
        }
    }

    #[test]
    fn directions_find_their_patch() {
        let patches = SkyPatches::reinhart(3).unwrap();
        for patch in 0..patches.len() {
            assert_eq!(patches.patch_of(patches.centre(patch)), patch);
        }
        // The first patch of a row is centred on north, the second lies to the east.
        assert!(patches.centre(1).y > 0.99 && patches.centre(1).x.abs() < 1e-12);
        assert!(patches.centre(2).x > 0.0);
        assert_eq!(patches.patch_of(Vec3::new(-1e-4, 1.0, 0.01).unit()), 1);
    }

    #[test]
    fn names_are_understood() {
        assert_eq!(SkyPatches::named("tregenza").unwrap().len(), 146);
        for name in ["reinhart:4", "MF:4", "Reinhart MF:4", "mf4"] {
            assert_eq!(SkyPatches::named(name).unwrap().len(), 2306, "{name}");
        }
        assert!(SkyPatches::named("klems").is_err());
        assert!(SkyPatches::reinhart(0).is_err());
    }
}
