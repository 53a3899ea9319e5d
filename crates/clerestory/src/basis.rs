//! Angle bases: divisions of a hemisphere into patches.
//!
//! Every basis of the field (Klems, Tregenza, Reinhart, IEA Task 21, and those spelled out in files) is a set of
//! rings about the normal, each cut into equal cells of azimuth of which the first is centred on azimuth 0. Patches are
//! listed ring by ring from the normal outward. Azimuths are of the direction of *travel* ([`Disk`]), so that
//! straight transmission and mirror reflection keep the patch.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::sequence::circle;

/// One ring of equal patches. Angles are polar angles in degrees, as files and standards give them.
#[derive(Debug, Clone, PartialEq)]
pub struct Ring {
    /// Inner limit (degrees).
    pub lower_deg: f64,
    /// Outer limit (degrees).
    pub upper_deg: f64,
    /// Nominal polar angle (degrees), where glazing is evaluated.
    pub nominal_deg: f64,
    /// Number of patches.
    pub count: usize,
}

/// A division of the hemisphere into patches.
#[derive(Debug, Clone)]
pub struct Basis {
    name: String,
    rings: Vec<Ring>,
    /// sin² of the outer limit of each ring; the last is exactly 1.
    outer_sin2: Vec<f64>,
    /// Index of each ring's first patch, and the number of patches at the end.
    first: Vec<usize>,
    /// Patches of each ring, as a number.
    counts: Vec<f64>,
    /// The ring in which each of equal steps of sin² begins.
    steps: [u16; STEPS],
}

/// Steps of sin² in the table that finds rings.
const STEPS: usize = 256;

impl PartialEq for Basis {
    /// Same patches; the name does not matter.
    fn eq(&self, other: &Self) -> bool {
        self.rings.len() == other.rings.len()
            && self.rings.iter().zip(&other.rings).all(|(a, b)| {
                a.count == b.count
                    && (a.lower_deg - b.lower_deg).abs() < 1e-6
                    && (a.upper_deg - b.upper_deg).abs() < 1e-6
            })
    }
}

impl Basis {
    /// From rings that join without a gap from 0° to 90°. A ring of one patch is allowed at the normal only.
    pub fn from_rings(name: impl Into<String>, rings: Vec<Ring>) -> Result<Self> {
        let name = name.into();
        let fail = |what: String| {
            Err(Error::Argument(format!(
                "angle basis {name:?}: {what} (list rings from 0° to 90° without gaps)"
            )))
        };
        let (Some(inner), Some(outer)) = (rings.first(), rings.last()) else {
            return fail("it has no rings".into());
        };
        if inner.lower_deg.abs() > 1e-6 || (outer.upper_deg - 90.0).abs() > 1e-4 {
            return fail(format!(
                "its rings reach from {}° to {}°",
                inner.lower_deg, outer.upper_deg
            ));
        }
        if rings.len() > usize::from(u16::MAX) {
            return fail(format!("it has {} rings", rings.len()));
        }
        for (k, ring) in rings.iter().enumerate() {
            if !(ring.upper_deg > ring.lower_deg && ring.nominal_deg.is_finite()) {
                return fail(format!(
                    "ring {} has limits {}° and {}°",
                    k + 1,
                    ring.lower_deg,
                    ring.upper_deg
                ));
            }
            if k > 0 && (ring.lower_deg - rings[k - 1].upper_deg).abs() > 1e-4 {
                return fail(format!(
                    "ring {} begins at {}° but the one before it ends at {}°",
                    k + 1,
                    ring.lower_deg,
                    rings[k - 1].upper_deg
                ));
            }
            if ring.count == 0 || ring.count > 1_000_000 || (ring.count == 1 && k > 0) {
                return fail(format!("ring {} has {} patches", k + 1, ring.count));
            }
        }
        let mut outer_sin2: Vec<f64> = rings.iter().map(|r| r.upper_deg.to_radians().sin().powi(2)).collect();
        *outer_sin2.last_mut().expect("there is a ring") = 1.0;
        let mut first = vec![0];
        for ring in &rings {
            first.push(first[first.len() - 1] + ring.count);
        }
        let last = rings.len() - 1;
        let steps = std::array::from_fn(|k| {
            let begins = k as f64 / STEPS as f64;
            outer_sin2[..last].partition_point(|&limit| begins >= limit) as u16
        });
        Ok(Self {
            name,
            counts: rings.iter().map(|r| r.count as f64).collect(),
            rings,
            outer_sin2,
            first,
            steps,
        })
    }

    fn from_limits(name: &str, limits: &[f64], nominal: &[f64], counts: &[usize]) -> Self {
        let rings = counts
            .iter()
            .enumerate()
            .map(|(k, &count)| Ring {
                lower_deg: limits[k],
                upper_deg: limits[k + 1],
                nominal_deg: nominal[k],
                count,
            })
            .collect();
        Self::from_rings(name, rings).expect("the tables of this module are sound")
    }

    /// Klems full: 145 patches (Klems 1994, ASHRAE Transactions 100(1)).
    pub fn klems_full() -> Self {
        Self::from_limits(
            "LBNL/Klems Full",
            &[0., 5., 15., 25., 35., 45., 55., 65., 75., 90.],
            &[0., 10., 20., 30., 40., 50., 60., 70., 82.5],
            &[1, 8, 16, 20, 24, 24, 24, 16, 12],
        )
    }

    /// Klems half: 77 patches, as current programs write it.
    pub fn klems_half() -> Self {
        Self::from_limits(
            "LBNL/Klems Half",
            &[0., 6.5, 19.5, 32.5, 45.5, 58.5, 71.5, 90.],
            &[0., 13., 26., 39., 52., 65., 80.75],
            &[1, 8, 12, 16, 20, 12, 8],
        )
    }

    /// Klems quarter: 41 patches.
    pub fn klems_quarter() -> Self {
        Self::from_limits(
            "LBNL/Klems Quarter",
            &[0., 9., 27., 45., 63., 90.],
            &[0., 18., 36., 54., 76.5],
            &[1, 8, 12, 12, 8],
        )
    }

    /// Tregenza's 145 patches about the normal, as IEA SHC Task 21 uses them for incident directions.
    pub fn tregenza() -> Self {
        let mut basis = Self::reinhart(1).expect("1 is a subdivision");
        basis.name = "Tregenza".into();
        basis
    }

    /// Reinhart MF:n about the normal: Tregenza's patches cut n × n, 144 n² + 1 patches.
    pub fn reinhart(subdivision: usize) -> Result<Self> {
        const COUNTS: [usize; 7] = [6, 12, 18, 24, 24, 30, 30];
        if !(1..=64).contains(&subdivision) {
            return Err(Error::Argument(format!(
                "Reinhart MF:{subdivision} is not a subdivision (give 1 to 64)"
            )));
        }
        let rows = 7 * subdivision;
        let height = 90.0 / (rows as f64 + 0.5);
        let mut rings = vec![Ring {
            lower_deg: 0.0,
            upper_deg: height / 2.0,
            nominal_deg: 0.0,
            count: 1,
        }];
        for row in 0..rows {
            let lower_deg = height * (row as f64 + 0.5);
            rings.push(Ring {
                lower_deg,
                upper_deg: if row + 1 == rows { 90.0 } else { lower_deg + height },
                nominal_deg: lower_deg + height / 2.0,
                count: COUNTS[row / subdivision] * subdivision,
            });
        }
        Self::from_rings(format!("Reinhart MF:{subdivision}"), rings)
    }

    /// The 5° exit grid of IEA SHC Task 21: 1,297 directions with cells of ±2.5°.
    pub fn iea21() -> Self {
        let mut rings = vec![Ring {
            lower_deg: 0.0,
            upper_deg: 2.5,
            nominal_deg: 0.0,
            count: 1,
        }];
        for k in 1..=18 {
            let centre = 5.0 * f64::from(k);
            rings.push(Ring {
                lower_deg: centre - 2.5,
                upper_deg: (centre + 2.5).min(90.0),
                nominal_deg: centre,
                count: 72,
            });
        }
        Self::from_rings("IEA21 5deg", rings).expect("the grid is sound")
    }

    /// A basis by the name that people and files give it, for example `klems-full`, `LBNL/Klems Half`, `tregenza`,
    /// `reinhart:3`, `iea21`.
    pub fn named(name: &str) -> Result<Self> {
        let key: String = name
            .to_ascii_lowercase()
            .trim()
            .trim_start_matches("lbnl/")
            .replace([' ', '_'], "-");
        match key.as_str() {
            "klems-full" => Ok(Self::klems_full()),
            "klems-half" => Ok(Self::klems_half()),
            "klems-quarter" => Ok(Self::klems_quarter()),
            "tregenza" | "tregenza-145" => Ok(Self::tregenza()),
            "iea21" | "iea21-5deg" => Ok(Self::iea21()),
            _ => key
                .strip_prefix("reinhart")
                .and_then(|rest| {
                    rest.trim_start_matches([':', '-'])
                        .trim_start_matches("mf:")
                        .parse()
                        .ok()
                })
                .map_or_else(
                    || {
                        Err(Error::Argument(format!(
                            "angle basis {name:?} is not known (known: klems-full, klems-half, klems-quarter, \
                             tregenza, reinhart:N, iea21)"
                        )))
                    },
                    Self::reinhart,
                ),
        }
    }

    /// Name as written in files.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The same patches under another name.
    #[must_use]
    pub fn renamed(mut self, name: impl Into<String>) -> Self {
        self.name = name.into();
        self
    }

    /// Rings from the normal outward.
    pub fn rings(&self) -> &[Ring] {
        &self.rings
    }

    /// Number of patches.
    pub fn len(&self) -> usize {
        self.first[self.rings.len()]
    }

    /// Never: a basis has at least one patch.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// 0-based patch of a disk point. A ring's outer limit belongs to the next ring.
    #[inline]
    pub fn patch_of(&self, point: Disk) -> usize {
        let ring = self.ring_of(point.sin2_theta());
        let count = self.counts[ring];
        if count == 1.0 {
            return self.first[ring];
        }
        // The azimuth to a few digits does, but where a border is near. One turn more makes it positive.
        let place = (rough_turns(point) + 1.0) * count + 0.5;
        let whole = place as u32;
        let from_middle = (place - f64::from(whole) - 0.5).abs();
        let cell = if from_middle < 0.5 - ROUGH * count {
            whole as usize
        } else {
            exact_cell(point, count)
        };
        // Azimuths are in [-π, π]: one wrap is enough.
        let count = count as usize;
        self.first[ring] + if cell >= count { cell - count } else { cell }
    }

    /// The ring of a squared sine.
    #[inline]
    fn ring_of(&self, sin2: f64) -> usize {
        let last = self.rings.len() - 1;
        let mut ring = usize::from(self.steps[((sin2 * STEPS as f64) as usize).min(STEPS - 1)]);
        while ring < last && sin2 >= self.outer_sin2[ring] {
            ring += 1;
        }
        ring
    }

    /// Ring and cell within it of a patch.
    pub fn place(&self, patch: usize) -> (usize, usize) {
        let ring = self.first.partition_point(|&f| f <= patch) - 1;
        (ring, patch - self.first[ring])
    }

    /// Index of a ring's first patch.
    pub fn first_of_ring(&self, ring: usize) -> usize {
        self.first[ring]
    }

    /// Limits of a patch: polar angle and azimuth, lower and upper (radians). The azimuth of a ring's first patch
    /// begins below 0; a cap reaches from -π to π.
    pub fn limits(&self, patch: usize) -> ([f64; 2], [f64; 2]) {
        let (ring, cell) = self.place(patch);
        let r = &self.rings[ring];
        let upper = if ring + 1 == self.rings.len() {
            FRAC_PI_2
        } else {
            r.upper_deg.to_radians()
        };
        let step = TAU / r.count as f64;
        let centre = cell as f64 * step;
        (
            [r.lower_deg.to_radians(), upper],
            [centre - step / 2.0, centre + step / 2.0],
        )
    }

    /// sin² of the inner and outer limit of a ring.
    fn ring_sin2(&self, ring: usize) -> [f64; 2] {
        let inner = if ring == 0 { 0.0 } else { self.outer_sin2[ring - 1] };
        [inner, self.outer_sin2[ring]]
    }

    /// Nominal centre: the ring's nominal polar angle and the middle azimuth; the normal for a cap.
    pub fn centre(&self, patch: usize) -> Disk {
        let (ring, cell) = self.place(patch);
        let r = &self.rings[ring];
        if r.count == 1 {
            return Disk::NORMAL;
        }
        Disk::from_angles(r.nominal_deg.to_radians(), TAU * cell as f64 / r.count as f64)
    }

    /// Solid angle of a patch (sr).
    pub fn solid_angle(&self, patch: usize) -> f64 {
        let (ring, _) = self.place(patch);
        let [a, b] = self.ring_sin2(ring);
        // cos a - cos b without cancellation.
        TAU / self.rings[ring].count as f64 * (b - a) / ((1.0 - a).sqrt() + (1.0 - b).sqrt())
    }

    /// Projected solid angle of a patch (sr).
    pub fn projected_solid_angle(&self, patch: usize) -> f64 {
        let (ring, _) = self.place(patch);
        let [a, b] = self.ring_sin2(ring);
        PI * (b - a) / self.rings[ring].count as f64
    }

    /// Projected solid angles of all patches (sr); they sum to π.
    pub fn projected_solid_angles(&self) -> Vec<f64> {
        (0..self.len()).map(|p| self.projected_solid_angle(p)).collect()
    }

    /// Point of a patch, uniform in projected solid angle (cosine-weighted) for uniform `u`.
    pub fn sample_cosine(&self, patch: usize, u: [f64; 2]) -> Disk {
        let (ring, cell) = self.place(patch);
        let [a, b] = self.ring_sin2(ring);
        let r = (a + u[0] * (b - a)).sqrt();
        let [c, s] = circle(self.turns_in(ring, cell, u[1]));
        Disk { x: r * c, y: r * s }
    }

    /// Point of a patch, uniform in solid angle for uniform `u`.
    pub fn sample_uniform(&self, patch: usize, u: [f64; 2]) -> Disk {
        let (ring, cell) = self.place(patch);
        let [a, b] = self.ring_sin2(ring);
        let (cos_a, cos_b) = ((1.0 - a).sqrt(), (1.0 - b).sqrt());
        let cos = cos_a + u[0] * (cos_b - cos_a);
        let r = (1.0 - cos * cos).max(0.0).sqrt();
        let [c, s] = circle(self.turns_in(ring, cell, u[1]));
        Disk { x: r * c, y: r * s }
    }

    fn turns_in(&self, ring: usize, cell: usize, u: f64) -> f64 {
        (cell as f64 + u - 0.5) / self.counts[ring]
    }

    /// Patch of the same path travelled backwards (azimuth + 180°), where the basis has one: rings of an even number
    /// of patches do, and a cap.
    pub fn reversed(&self, patch: usize) -> Option<usize> {
        self.mapped(patch, |count, cell| {
            count.is_multiple_of(2).then(|| (cell + count / 2) % count)
        })
    }

    /// Patch mirrored left to right (azimuth φ to 180° − φ), where the basis has one.
    pub fn mirrored(&self, patch: usize) -> Option<usize> {
        self.mapped(patch, |count, cell| {
            count.is_multiple_of(2).then(|| (count / 2 + count - cell) % count)
        })
    }

    /// Patch turned counter-clockwise by `steps`/`of` of a full turn, where the basis has one.
    pub fn turned(&self, patch: usize, steps: usize, of: usize) -> Option<usize> {
        self.mapped(patch, |count, cell| {
            (count * steps)
                .is_multiple_of(of)
                .then(|| (cell + count * steps / of) % count)
        })
    }

    fn mapped(&self, patch: usize, map: impl Fn(usize, usize) -> Option<usize>) -> Option<usize> {
        let (ring, cell) = self.place(patch);
        let count = self.rings[ring].count;
        if count == 1 {
            return Some(patch);
        }
        map(count, cell).map(|c| self.first[ring] + c)
    }

    /// Smallest angular width of any patch of a ring (radians): below it no detail is resolved.
    pub fn resolution(&self, patch: usize) -> f64 {
        2.0 * (self.projected_solid_angle(patch) / PI).sqrt()
    }
}

/// The cell of a ring of `count` that a disk point is in, plus `count`.
#[cold]
fn exact_cell(point: Disk, count: f64) -> usize {
    ((point.y.atan2(point.x) * (count / TAU) + 0.5).floor() + count) as usize
}

/// More than the error of [`rough_turns`].
const ROUGH: f64 = 2e-6;

/// Azimuth of a disk point in turns, -1/2 to 1/2, to 1e-5 radians; not a number at the normal. The polynomial is number
/// 4.4.49 of Abramowitz and Stegun (1964), Handbook of Mathematical Functions.
#[inline]
fn rough_turns(point: Disk) -> f64 {
    let (x, y) = (point.x.abs(), point.y.abs());
    let t = x.min(y) / x.max(y);
    let s = t * t;
    let angle = t * (0.999_866_0 + s * (-0.330_299_5 + s * (0.180_141_0 + s * (-0.085_133_0 + s * 0.020_835_1))));
    let turns = angle * (1.0 / TAU);
    let turns = if y > x { 0.25 - turns } else { turns };
    let turns = if point.x < 0.0 { 0.5 - turns } else { turns };
    turns.copysign(point.y)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::{r2, uniform};

    /// The patch by the definition.
    fn defined(basis: &Basis, point: Disk) -> usize {
        let sin2 = point.sin2_theta();
        let ring = basis.outer_sin2[..basis.rings.len() - 1].partition_point(|&limit| sin2 >= limit);
        let count = basis.rings[ring].count;
        if count == 1 {
            return basis.first[ring];
        }
        let cell = (point.y.atan2(point.x) * (count as f64 / TAU) + 0.5).floor() as isize;
        basis.first[ring] + cell.rem_euclid(count as isize) as usize
    }

    #[test]
    fn patches_are_found_by_the_definition() {
        let mut bases = all();
        bases.push(Basis::reinhart(64).unwrap());
        for basis in bases {
            for k in 0..20_000 {
                let point = Disk::uniform([uniform(1, 2 * k), uniform(1, 2 * k + 1)]);
                assert_eq!(
                    basis.patch_of(point),
                    defined(&basis, point),
                    "{} {point:?}",
                    basis.name()
                );
            }
            // On borders and next to them, on the axes, at the normal and at the edge.
            for patch in (0..basis.len()).step_by(1 + basis.len() / 2000) {
                let ([t0, t1], [p0, p1]) = basis.limits(patch);
                for theta in [t0, t0 + 1e-13, t1 - 1e-13, 0.5 * (t0 + t1)] {
                    for phi in [p0, p0 + 1e-13, p0 - 1e-13, p1, p1 - 1e-6, p0 + 1e-5] {
                        let point = Disk::from_angles(theta, phi);
                        assert_eq!(basis.patch_of(point), defined(&basis, point));
                    }
                }
            }
            for (x, y) in [
                (0.0, 0.0),
                (-0.0, 0.0),
                (0.7, -0.0),
                (-0.7, -0.0),
                (-0.7, 0.0),
                (0.0, 1.0),
                (-1.0, 0.0),
                (-0.0, -1.0),
            ] {
                let point = Disk { x, y };
                assert_eq!(basis.patch_of(point), defined(&basis, point), "{x} {y}");
            }
        }
    }

    #[test]
    fn rough_azimuths_are_as_good_as_told() {
        for k in 0..100_000 {
            let phi = (f64::from(k) / 50_000.0 - 1.0) * PI;
            let error = rough_turns(Disk::from_angles(0.7, phi)) - phi / TAU;
            assert!((error - error.round()).abs() < 0.95 * ROUGH, "{phi} {error}");
        }
    }

    fn all() -> Vec<Basis> {
        vec![
            Basis::klems_full(),
            Basis::klems_half(),
            Basis::klems_quarter(),
            Basis::tregenza(),
            Basis::reinhart(2).unwrap(),
            Basis::reinhart(3).unwrap(),
            Basis::reinhart(4).unwrap(),
            Basis::reinhart(6).unwrap(),
            Basis::iea21(),
        ]
    }

    #[test]
    fn counts_are_the_published_ones() {
        let counts: Vec<usize> = all().iter().map(Basis::len).collect();
        assert_eq!(counts, [145, 77, 41, 145, 577, 1297, 2305, 5185, 1297]);
    }

    #[test]
    fn solid_angles_close() {
        for basis in all() {
            let projected: f64 = basis.projected_solid_angles().iter().sum();
            let solid: f64 = (0..basis.len()).map(|p| basis.solid_angle(p)).sum();
            assert!((projected - PI).abs() < 1e-12, "{} {projected}", basis.name());
            assert!((solid - TAU).abs() < 1e-12, "{} {solid}", basis.name());
        }
    }

    #[test]
    fn published_projected_solid_angles() {
        let full = Basis::klems_full();
        for (number, expected) in [
            (1, 0.023_863_926),
            (9, 0.023_322_860),
            (41, 0.023_622_222),
            (145, 0.017_537_234),
        ] {
            assert!((full.projected_solid_angle(number - 1) - expected).abs() < 1e-9);
        }
        assert!((Basis::klems_half().projected_solid_angle(76) - 0.039_537_825).abs() < 1e-9);
        assert!((Basis::klems_quarter().projected_solid_angle(40) - 0.080_938_176).abs() < 1e-9);
    }

    #[test]
    fn every_patch_comes_back_from_its_centre_and_its_samples() {
        for basis in all() {
            for patch in 0..basis.len() {
                assert_eq!(basis.patch_of(basis.centre(patch)), patch, "{}", basis.name());
                for k in 0..16 {
                    let u = r2(k, [0.0; 2]);
                    assert_eq!(basis.patch_of(basis.sample_cosine(patch, u)), patch);
                    assert_eq!(basis.patch_of(basis.sample_uniform(patch, u)), patch);
                }
            }
        }
    }

    #[test]
    fn probes_of_the_report_are_suns_above() {
        let full = Basis::klems_full();
        for (theta, number) in [(0.0_f64, 1), (30.0, 41), (50.0, 88), (70.0, 130)] {
            let travel = Disk::from_angles(theta.to_radians(), 1.5 * PI);
            assert_eq!(full.patch_of(travel) + 1, number);
        }
    }

    #[test]
    fn symmetries_are_involutions() {
        for basis in all() {
            for patch in 0..basis.len() {
                for map in [Basis::reversed, Basis::mirrored] {
                    if let Some(other) = map(&basis, patch) {
                        assert_eq!(map(&basis, other), Some(patch));
                    }
                }
            }
        }
    }

    #[test]
    fn gaps_are_refused() {
        let ring = |lower_deg, upper_deg, count| Ring {
            lower_deg,
            upper_deg,
            nominal_deg: 0.5 * (lower_deg + upper_deg),
            count,
        };
        for rings in [
            vec![],
            vec![ring(0., 80., 1)],
            vec![ring(0., 10., 1), ring(11., 90., 8)],
            vec![ring(0., 10., 1), ring(10., 90., 1)],
            vec![ring(0., 10., 0), ring(10., 90., 4)],
            vec![ring(0., f64::NAN, 1), ring(10., 90., 4)],
        ] {
            assert!(Basis::from_rings("test", rings).is_err());
        }
    }
}
