//! Daylight matrices: what each patch of the windows gives to a sensor or a pixel, and each patch of the sky to a window.
//!
//! Windows are black here, so that a matrix holds for any system in them; what they return into the room is a matrix of its own
//! ([`Room::return_matrix`]). Lights are out.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::ledger::{Ledger, Targets};
use super::path::Tracer;
use super::sensor::{LIFT, REPLICATIONS, Sensor, check_samples, check_sensors};
use super::window::Window;
use super::{Rgb, Room};
use crate::basis::Basis;
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::material::Draws;
use crate::picture::Camera;
use crate::picture::colour::LUMINANCE;
use crate::progress::Progress;
use crate::sequence::mix;
use crate::sky::patches::SkyPatches;

/// Some rows of a matrix, one behind the other.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Rows {
    /// Number of columns.
    pub columns: usize,
    /// Of all light.
    pub all: Vec<[f32; 3]>,
    /// Of light that comes directly.
    pub direct: Vec<[f32; 3]>,
    /// Standard errors of the photopic means of `all`.
    pub standard_error: Vec<f32>,
}

/// Groups of windows that share a system and a view, and the patches into which their light is divided.
#[derive(Debug, Clone)]
pub struct Groups {
    /// Group of each window, from 0.
    pub of_window: Vec<usize>,
    /// Patches of a group's light, in the frame of its windows.
    pub basis: Basis,
}

impl Groups {
    pub(super) fn check(&self, windows: usize) -> Result<()> {
        if self.of_window.len() == windows {
            return Ok(());
        }
        Err(Error::Argument(format!(
            "{} windows have a group and the room has {windows} (give each a group)",
            self.of_window.len()
        )))
    }
}

/// How many paths, and their random numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Paths {
    /// Of a row, a multiple of the 16 replications.
    pub samples: u32,
    /// Of the random numbers.
    pub seed: u64,
}

impl Room {
    /// Irradiance at sensors (rows) by the radiance of the windows' patches (columns, group by group) [sr]. Direct is what comes from a window
    /// and meets no surface.
    pub fn view_matrix(&self, sensors: &[Sensor], groups: &Groups, paths: Paths, progress: &Progress) -> Result<Rows> {
        check_sensors(sensors)?;
        let targets = self.receivers(groups)?;
        let launch = |row: usize, tracer: &mut Tracer<'_>, draws: Draws| {
            let normal = sensors[row].normal.unit();
            tracer.sense(sensors[row].point + normal * LIFT, normal, draws);
        };
        self.rows(sensors.len(), PI, targets, [0, 0], paths, progress, launch)
    }

    /// Radiance of the surfaces in pixels (rows, row by row from the top left) by the radiance of the windows' patches. Direct is
    /// what a surface that is seen gets from a window without meeting another. The windows themselves are black, see
    /// [`Room::windows_seen`].
    #[allow(clippy::too_many_arguments, reason = "a picture, a part of it, and how")]
    pub fn picture_matrix(
        &self,
        camera: &Camera,
        size: [usize; 2],
        pixels: std::ops::Range<usize>,
        groups: &Groups,
        paths: Paths,
        progress: &Progress,
    ) -> Result<Rows> {
        let [width, height] = size;
        if pixels.end > width * height || width == 0 {
            return Err(Error::Argument(format!(
                "pixels {} to {} are not in a picture of {width} × {height}",
                pixels.start, pixels.end
            )));
        }
        let targets = self.receivers(groups)?;
        let launch = |row: usize, tracer: &mut Tracer<'_>, mut draws: Draws| {
            let pixel = pixels.start + row;
            let x = ((pixel % width) as f64 + draws.next()) / width as f64;
            let y = 1.0 - ((pixel / width) as f64 + draws.next()) / height as f64;
            if let Some([origin, direction]) = camera.ray(x, y) {
                tracer.look(origin, direction, draws);
            }
        };
        self.rows(pixels.len(), 1.0, targets, [1, 1], paths, progress, launch)
    }

    /// Mean radiance that arrives from the room at a group's windows in each patch of interior light (rows) by the radiance of the
    /// windows' patches: what a window can send back.
    pub fn return_matrix(&self, group: usize, groups: &Groups, paths: Paths, progress: &Progress) -> Result<Rows> {
        let targets = self.receivers(groups)?;
        let area = self.area_of(group, groups)?;
        let launch = |row: usize, tracer: &mut Tracer<'_>, mut draws: Draws| {
            let (window, point) = area.sample(self, &mut draws);
            let u = [draws.next(), draws.next()];
            // Light from the interior of this point of the disk has the same projection, and travels out of the room.
            let inwards = self.windows[window].travel(groups.basis.sample_cosine(row, u));
            let normal = self.windows[window].polygon().normal();
            let travel = inwards - normal * (2.0 * inwards.dot(normal));
            tracer.look(point + normal * LIFT, -travel, draws);
        };
        self.rows(groups.basis.len(), 1.0, targets, [0, 1], paths, progress, launch)
    }

    /// Mean radiance that arrives from outside at a group's windows in each patch of exterior light (rows) by the radiance of
    /// the sky's patches (columns, the ground first). Direct is what comes from the sky without meeting anything.
    pub fn daylight_matrix(
        &self,
        group: usize,
        groups: &Groups,
        sky: &SkyPatches,
        paths: Paths,
        progress: &Progress,
    ) -> Result<Rows> {
        self.outwards(group, groups, Targets::Sky(sky), paths, progress)
    }

    /// Mean radiance that arrives from outside at a group's windows in each patch of exterior light (rows) by the radiance of
    /// the patches of windows that are met there: openings before a façade. Direct is what has met nothing on its way.
    pub fn facade_matrix(&self, group: usize, groups: &Groups, paths: Paths, progress: &Progress) -> Result<Rows> {
        self.outwards(group, groups, self.receivers(groups)?, paths, progress)
    }

    /// Paths from a group's windows out of the room, a row each patch of exterior light.
    fn outwards(
        &self,
        group: usize,
        groups: &Groups,
        targets: Targets<'_>,
        paths: Paths,
        progress: &Progress,
    ) -> Result<Rows> {
        let area = self.area_of(group, groups)?;
        let launch = |row: usize, tracer: &mut Tracer<'_>, mut draws: Draws| {
            let (window, point) = area.sample(self, &mut draws);
            let u = [draws.next(), draws.next()];
            let out = -self.windows[window].travel(groups.basis.sample_cosine(row, u));
            tracer.look(point + out * LIFT, out, draws);
        };
        self.rows(groups.basis.len(), 1.0, targets, [0, 0], paths, progress, launch)
    }

    /// Axes of a group's samples: x, y, and z into the room. Fails where its windows differ in them.
    pub fn frame_of(&self, group: usize, groups: &Groups) -> Result<[Vec3; 3]> {
        groups.check(self.windows.len())?;
        let mut members = self.windows.iter().zip(&groups.of_window).filter(|(_, g)| **g == group);
        let Some((first, _)) = members.next() else {
            return Err(Error::Argument(format!("group {group} has no window")));
        };
        let alike = |other: &Window| {
            let pairs = first.frame().iter().zip(other.frame());
            pairs.fold(0.0_f64, |most, (a, b)| most.max((*a - *b).length())) < 1e-6
        };
        match members.find(|(window, _)| !alike(window)) {
            None => Ok(*first.frame()),
            Some((other, _)) => Err(Error::Argument(format!(
                "windows {:?} and {:?} are in one group and look different ways (put them into groups of their own)",
                first.name(),
                other.name()
            ))),
        }
    }

    /// Points just before a group's windows outside, even in area; none where nothing but sky and ground is before them.
    pub fn outside_of(&self, group: usize, groups: &Groups, count: u32) -> Result<Vec<Vec3>> {
        let area = self.area_of(group, groups)?;
        if area.0.iter().all(|(window, _)| !self.windows[*window].obstructed()) {
            return Ok(Vec::new());
        }
        let point = |k: u32| {
            let mut draws = Draws::new(0, k);
            let (window, point) = area.sample(self, &mut draws);
            point - self.windows[window].polygon().normal() * LIFT
        };
        Ok((0..count).map(point).collect())
    }

    fn receivers<'a>(&self, groups: &'a Groups) -> Result<Targets<'a>> {
        groups.check(self.windows.len())?;
        Ok(Targets::Windows(&groups.of_window, &groups.basis))
    }

    fn area_of(&self, group: usize, groups: &Groups) -> Result<Area> {
        self.receivers(groups)?;
        let mut total = 0.0;
        let members = groups.of_window.iter().enumerate().filter(|(_, g)| **g == group);
        let shares = members.map(|(window, _)| {
            total += self.windows[window].polygon().area();
            (window, total)
        });
        let shares: Vec<_> = shares.collect();
        if shares.is_empty() {
            return Err(Error::Argument(format!("group {group} has no window")));
        }
        Ok(Area(shares))
    }

    #[allow(clippy::too_many_arguments, reason = "all that tells kinds of rows apart")]
    fn rows(
        &self,
        count: usize,
        factor: f64,
        targets: Targets<'_>,
        meetings: [u16; 2],
        paths: Paths,
        progress: &Progress,
        launch: impl Fn(usize, &mut Tracer<'_>, Draws) + Sync,
    ) -> Result<Rows> {
        check_samples(paths.samples)?;
        progress.expect(count);
        let each = paths.samples / REPLICATIONS;
        let replication = |row: usize, number: u32| -> Result<[Vec<Rgb>; 2]> {
            let key = mix(paths.seed ^ mix(row as u64 * u64::from(REPLICATIONS) + u64::from(number)));
            let mut tracer = Tracer::new(self);
            tracer.ledger = Some(Ledger::new(targets, meetings));
            for first in (0..each).step_by(BATCH) {
                progress.check()?;
                for index in first..each.min(first + BATCH as u32) {
                    launch(row, &mut tracer, Draws::new(key, index));
                }
                tracer.finish();
            }
            let ledger = tracer.ledger.take();
            Ok(ledger.map_or_else(Default::default, |ledger| [ledger.all, ledger.direct]))
        };
        let made: Vec<Rows> = (0..count)
            .into_par_iter()
            .map(|row| {
                let found: Vec<[Vec<Rgb>; 2]> = (0..REPLICATIONS)
                    .into_par_iter()
                    .map(|number| replication(row, number))
                    .collect::<Result<_>>()?;
                progress.step()?;
                Ok(together(&found, factor / f64::from(each), targets.len()))
            })
            .collect::<Result<_>>()?;
        let mut rows = Rows {
            columns: targets.len(),
            ..Rows::default()
        };
        for mut row in made {
            rows.all.append(&mut row.all);
            rows.direct.append(&mut row.direct);
            rows.standard_error.append(&mut row.standard_error);
        }
        Ok(rows)
    }
}

/// Paths that are followed together.
const BATCH: usize = 1024;

/// Windows with the area up to and with each (m²).
struct Area(Vec<(usize, f64)>);

impl Area {
    fn sample(&self, room: &Room, draws: &mut Draws) -> (usize, Vec3) {
        let total = self.0[self.0.len() - 1].1;
        let u = draws.next() * total;
        let chosen = self.0.partition_point(|(_, up_to)| *up_to <= u).min(self.0.len() - 1);
        let window = self.0[chosen].0;
        (
            window,
            room.windows[window].polygon().sample([draws.next(), draws.next()]),
        )
    }
}

/// A row from its replications.
fn together(found: &[[Vec<Rgb>; 2]], factor: f64, columns: usize) -> Rows {
    let n = found.len() as f64;
    let mean = |part: usize, column: usize| {
        let sum = found.iter().fold([0.0; 3], |sum: Rgb, one| {
            std::array::from_fn(|c| sum[c] + one[part][column][c])
        });
        sum.map(|s| (s / n * factor) as f32)
    };
    let photopic = |light: Rgb| (0..3).map(|c| LUMINANCE[c] * light[c]).sum::<f64>() * factor;
    let error = |column: usize| {
        let values = found.iter().map(|one| photopic(one[0][column]));
        let centre = values.clone().sum::<f64>() / n;
        let spread = values.map(|v| (v - centre).powi(2)).sum::<f64>();
        (spread / (n * (n - 1.0))).sqrt() as f32
    };
    Rows {
        columns,
        all: (0..columns).map(|k| mean(0, k)).collect(),
        direct: (0..columns).map(|k| mean(1, k)).collect(),
        standard_error: (0..columns).map(error).collect(),
    }
}
