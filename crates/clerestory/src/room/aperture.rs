//! What a point sees of the windows: cells of the square of their directions, and the sun through them.
//!
//! A window's light depends on its direction alone, so an hour's luminances of a group's cells serve every eye and sensor; what
//! differs between these is which cells they see, and how large.

use rayon::prelude::*;

use super::matrix::Groups;
use super::sensor::{LIFT, Sensor, check_sensors};
use super::window::Window;
use super::{Role, Room};
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Meeting, NO_PIECE, Ray, Vec3};
use crate::progress::Progress;

/// A cell of a group's directions that a point sees.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeenCell {
    /// Number of the group times the number of its cells, and the cell's number: row by row of the concentric square.
    pub number: u32,
    /// Solid angle that is seen of it (sr).
    pub solid_angle: f32,
    /// That by its cosine to the point's normal, where it is positive (sr).
    pub projected: f32,
    /// Towards it, in the middle of what is seen.
    pub direction: [f32; 3],
}

/// Finest square: 1024 steps along each axis.
const MOST_STEPS: usize = 1024;

impl Room {
    /// What each point sees of the windows, by cells of `steps` along each axis of the square, each probed by `parts` × `parts`
    /// rays.
    pub fn apertures(
        &self,
        sensors: &[Sensor],
        groups: &Groups,
        steps: usize,
        parts: usize,
        progress: &Progress,
    ) -> Result<Vec<Vec<SeenCell>>> {
        check_sensors(sensors)?;
        groups.check(self.windows.len())?;
        if !(1..=MOST_STEPS).contains(&steps) || !(1..=64).contains(&parts) {
            return Err(Error::Argument(format!(
                "{steps} cells along an axis, {parts} rays along each (give 1 to {MOST_STEPS}, and 1 to 64)"
            )));
        }
        progress.expect(sensors.len());
        sensors
            .par_iter()
            .map(|sensor| {
                progress.check()?;
                let normal = sensor.normal.unit();
                let from = sensor.point + normal * LIFT;
                let mut cells = Vec::new();
                for (number, window) in self.windows.iter().enumerate() {
                    let first = groups.of_window[number] * steps * steps;
                    self.cells_of(number, window, from, normal, [steps, parts], first, &mut cells);
                }
                progress.step()?;
                Ok(cells)
            })
            .collect()
    }

    #[allow(clippy::too_many_arguments, reason = "an eye, a window, and how finely")]
    fn cells_of(
        &self,
        number: usize,
        window: &Window,
        from: Vec3,
        normal: Vec3,
        [steps, parts]: [usize; 2],
        first: usize,
        cells: &mut Vec<SeenCell>,
    ) {
        let Some(outline) = Outline::new(window, from) else {
            return;
        };
        let fine = steps * parts;
        let area = std::f64::consts::PI / (fine * fine) as f64;
        for cell in 0..steps * steps {
            let (mut solid_angle, mut projected, mut middle) = (0.0, 0.0, Vec3::default());
            for part in 0..parts * parts {
                let at = |k: usize, p: usize| ((k * parts + p) as f64 + 0.5) / fine as f64;
                let travel = Disk::from_square([at(cell / steps, part / parts), at(cell % steps, part % parts)]);
                let look = -window.travel(travel);
                if outline.holds(look) && self.meets_window(number, from, look) {
                    let seen = area / travel.cos_theta();
                    solid_angle += seen;
                    projected += seen * look.dot(normal).max(0.0);
                    middle += look * seen;
                }
            }
            if solid_angle > 0.0 {
                cells.push(SeenCell {
                    number: (first + cell) as u32,
                    solid_angle: solid_angle as f32,
                    projected: projected as f32,
                    direction: middle.unit().array().map(|x| x as f32),
                });
            }
        }
    }

    fn meets_window(&self, number: usize, from: Vec3, direction: Vec3) -> bool {
        let mut ray = Ray {
            origin: from,
            direction,
            piece: NO_PIECE,
        };
        match self.mesh.meet(&mut ray) {
            Meeting::Hit(hit) => {
                self.roles[hit.surface as usize] == Role::Window(number as u32) && direction.dot(hit.normal) < 0.0
            }
            Meeting::Leaves | Meeting::Lost => false,
        }
    }

    /// The window through which each point (rows) sees each direction (columns), if nothing stands before it either: its number
    /// from 1, or 0 for none; `OPEN` where nothing at all is met.
    pub fn windows_towards(&self, points: &[Vec3], directions: &[Vec3], progress: &Progress) -> Result<Vec<u16>> {
        progress.expect(points.len());
        let rows: Vec<Vec<u16>> = points
            .par_iter()
            .map(|&point| {
                progress.check()?;
                let row = directions
                    .iter()
                    .map(|&direction| self.window_towards(point, direction));
                let row = row.collect();
                progress.step()?;
                Ok(row)
            })
            .collect::<Result<_>>()?;
        Ok(rows.concat())
    }

    fn window_towards(&self, point: Vec3, direction: Vec3) -> u16 {
        self.window_along(&mut Ray {
            origin: point,
            direction,
            piece: NO_PIECE,
        })
    }

    pub(super) fn window_along(&self, ray: &mut Ray) -> u16 {
        let Meeting::Hit(hit) = self.mesh.meet(ray) else {
            return OPEN;
        };
        match self.roles[hit.surface as usize] {
            Role::Window(number) if ray.direction.dot(hit.normal) < 0.0 => match self.mesh.meet(ray) {
                Meeting::Hit(_) => NONE,
                Meeting::Leaves | Meeting::Lost => number as u16 + 1,
            },
            _ => NONE,
        }
    }
}

/// What [`Room::windows_towards`] tells where a ray leaves without meeting a window.
pub const OPEN: u16 = u16::MAX;
/// What it tells where something is in the way.
pub const NONE: u16 = 0;

/// A rectangle about a window in its plane, as a point sees it.
struct Outline {
    /// From the point to a corner.
    to: Vec3,
    axes: [Vec3; 2],
    normal: Vec3,
    limits: [[f64; 2]; 2],
}

impl Outline {
    /// None from behind the window.
    fn new(window: &Window, from: Vec3) -> Option<Self> {
        let polygon = window.polygon();
        let normal = polygon.normal();
        let corner = polygon.corners()[0];
        let to = corner - from;
        if to.dot(normal) >= 0.0 {
            return None;
        }
        let axes = normal.frame();
        let limits = axes.map(|axis| {
            let along = polygon.corners().iter().map(|c| (*c - corner).dot(axis));
            along.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| {
                [low.min(x), high.max(x)]
            })
        });
        Some(Self {
            to,
            axes,
            normal,
            limits,
        })
    }

    fn holds(&self, look: Vec3) -> bool {
        let distance = self.to.dot(self.normal) / look.dot(self.normal);
        let place = look * distance - self.to;
        let inside = |axis: Vec3, [low, high]: [f64; 2]| (low..=high).contains(&place.dot(axis));
        distance > 0.0 && inside(self.axes[0], self.limits[0]) && inside(self.axes[1], self.limits[1])
    }
}
