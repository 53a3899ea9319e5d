//! What an eye sees without a picture: the windows by cells of directions, the radiance that is known without following
//! light, and the sun's disc.

use rayon::prelude::*;

use super::path::Tracer;
use super::{Rgb, Role, Room};
use crate::geometry::{Geometry, Hit, Meeting, NO_PIECE, Ray, Vec3};
use crate::material::{Arrival, Draws, Material};
use crate::picture::Camera;
use crate::sequence::{mix, r2};

/// What a pixel of an eye shows of a window from the room, or a part of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct WindowSeen {
    /// Number of the pixel, row by row from the top left.
    pub pixel: usize,
    /// Of the pixel.
    pub share: f64,
    /// From the eye, of length 1.
    pub direction: Vec3,
    /// Number of the window.
    pub window: u32,
}

/// The sun as an eye sees it, directly or through beams of windows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SunSeen {
    /// Toward the middle of what is seen of it.
    pub direction: Vec3,
    /// Mean radiance of what is seen of it [W/(m² sr)].
    pub radiance: Rgb,
    /// What is seen of it (sr).
    pub solid_angle: f64,
}

/// What lies in a pixel, as means over it: surfaces that have no light of their own.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Feature {
    /// Share of the pixel that is no window, no lamp and not outside.
    pub share: f64,
    /// Unit normal to the eye's side; shorter where several meet.
    pub normal: Vec3,
    /// From the eye (metres).
    pub distance: f64,
    /// Light that it returns along its normal, of light along its normal, times π: the reflectance of a diffuse surface.
    pub albedo: f64,
}

/// Rays along either side of a pixel at an edge.
const FINER: usize = 4;
/// Paths of a ray where light has to be followed.
const PATHS: u32 = 16;
/// Points of the sun's disc.
const SUN_POINTS: u32 = 256;
/// Of the paths' random numbers.
const SEED: u64 = 0x51;

/// What a ray of a pixel meets, with its share of the pixel.
struct Sight {
    pixel: usize,
    share: f64,
    origin: Vec3,
    direction: Vec3,
    hit: Option<Hit>,
}

impl Room {
    /// What the pixels of a view show of windows from the room, in the order of the pixels; those at the edge of something are
    /// seen in parts. Nothing of it depends on the sky.
    pub fn windows_seen(&self, camera: &Camera, size: [usize; 2]) -> Vec<WindowSeen> {
        let seen = self.sights(camera, size).into_iter().filter_map(|sight| {
            let hit = sight.hit?;
            let Role::Window(window) = self.roles[hit.surface as usize] else {
                return None;
            };
            (sight.direction.dot(hit.normal) < 0.0).then_some(WindowSeen {
                pixel: sight.pixel,
                share: sight.share,
                direction: sight.direction,
                window,
            })
        });
        seen.collect()
    }

    /// Radiance of the pixels of a view that is known without following light: what windows send and what is seen outside,
    /// lights, and what the sun throws on surfaces; the sun's disc is not in it. Light is followed only where a window has
    /// something before it, and behind mirrors and panes.
    pub fn glance(&self, camera: &Camera, size: [usize; 2]) -> Vec<Rgb> {
        let sights = self.sights(camera, size);
        let found: Vec<Rgb> = sights
            .par_iter()
            .enumerate()
            .map(|(k, sight)| self.known(sight, k))
            .collect();
        let mut pixels = vec![[0.0; 3]; size[0] * size[1]];
        for (sight, radiance) in sights.iter().zip(found) {
            for c in 0..3 {
                pixels[sight.pixel][c] += sight.share * radiance[c];
            }
        }
        pixels
    }

    /// What lies in the pixels of a view.
    pub fn features(&self, camera: &Camera, size: [usize; 2]) -> Vec<Feature> {
        let mut pixels = vec![Feature::default(); size[0] * size[1]];
        for sight in self.sights(camera, size) {
            let Some(hit) = sight.hit else { continue };
            let Role::Solid(surface) = &self.roles[hit.surface as usize] else {
                continue;
            };
            let face = usize::from(sight.direction.dot(hit.normal) > 0.0);
            let normal = if face == 0 { hit.normal } else { -hit.normal };
            let arrival = Arrival {
                direction: -normal,
                normal,
                here: &self.media[usize::from(surface.media[face])],
                beyond: &self.media[usize::from(surface.media[1 - face])],
            };
            let material = &self.materials[surface.materials[face] as usize];
            let returned: f64 = material.evaluate::<3>(&arrival, normal).iter().sum();
            let feature = &mut pixels[sight.pixel];
            feature.share += sight.share;
            feature.normal += normal * sight.share;
            feature.distance += hit.distance * sight.share;
            feature.albedo += returned * std::f64::consts::PI / 3.0 * sight.share;
        }
        pixels
    }

    /// The sun from an eye (metres); None where nothing of it is seen.
    pub fn sun_seen(&self, eye: Vec3) -> Option<SunSeen> {
        let sun = self.sun.as_ref()?;
        let (mut middle, mut radiance, mut count) = (Vec3::default(), [0.0; 3], 0);
        for k in 0..SUN_POINTS {
            let ray = free(eye, sun.sample(r2(k, [0.5; 2])));
            if let Some(passed) = self.passed(ray) {
                count += 1;
                middle += ray.direction;
                for c in 0..3 {
                    radiance[c] += passed[c] * sun.radiance[c];
                }
            }
        }
        (count > 0).then(|| SunSeen {
            direction: middle.unit(),
            radiance: radiance.map(|r| r / f64::from(count)),
            solid_angle: sun.solid_angle * f64::from(count) / f64::from(SUN_POINTS),
        })
    }

    /// A ray through the middle of each pixel, or several where a neighbour's meets something else.
    fn sights(&self, camera: &Camera, size: [usize; 2]) -> Vec<Sight> {
        let [width, height] = size;
        let look = |x: f64, y: f64| {
            let [origin, direction] = camera.ray(x / width as f64, 1.0 - y / height as f64)?;
            let hit = match self.mesh.meet(&mut free(origin, direction)) {
                Meeting::Hit(hit) => Some(hit),
                Meeting::Leaves | Meeting::Lost => None,
            };
            Some((origin, direction, hit))
        };
        let middle = |pixel: usize| [(pixel % width) as f64, (pixel / width) as f64];
        let coarse: Vec<_> = (0..width * height)
            .into_par_iter()
            .map(|pixel| {
                let [x, y] = middle(pixel);
                look(x + 0.5, y + 0.5)
            })
            .collect();
        let surface = |pixel: usize| coarse[pixel].map(|(_, _, hit)| hit.map(|hit| hit.surface));
        let at_edge = |pixel: usize| {
            let (x, y) = (pixel % width, pixel / width);
            (x.saturating_sub(1)..=(x + 1).min(width - 1)).any(|column| {
                (y.saturating_sub(1)..=(y + 1).min(height - 1))
                    .any(|row| surface(row * width + column) != surface(pixel))
            })
        };
        (0..width * height)
            .into_par_iter()
            .flat_map_iter(|pixel| {
                let finer = if at_edge(pixel) { FINER } else { 1 };
                let [x, y] = middle(pixel);
                let step = 1.0 / finer as f64;
                let seen: Vec<_> = (0..finer * finer)
                    .filter_map(|k| match finer {
                        1 => coarse[pixel],
                        _ => look(
                            x + ((k % finer) as f64 + 0.5) * step,
                            y + ((k / finer) as f64 + 0.5) * step,
                        ),
                    })
                    .collect();
                // What lies outside of the projection has no share of the solid angle either.
                let share = 1.0 / seen.len().max(1) as f64;
                seen.into_iter().map(move |(origin, direction, hit)| Sight {
                    pixel,
                    share,
                    origin,
                    direction,
                    hit,
                })
            })
            .collect()
    }

    /// Radiance of what a ray meets.
    fn known(&self, sight: &Sight, number: usize) -> Rgb {
        let Some(hit) = sight.hit else {
            return self.outside(sight.direction, false);
        };
        let from_front = sight.direction.dot(hit.normal) < 0.0;
        match &self.roles[hit.surface as usize] {
            Role::Light(light) if from_front => self.lights[*light as usize].1,
            Role::Light(_) => [0.0; 3],
            Role::Window(window) if from_front && !self.windows[*window as usize].obstructed() => {
                self.through(*window as usize, sight.direction, false)
            }
            Role::Window(_) => self.followed(sight, number),
            Role::Solid(surface) => {
                let face = usize::from(!from_front);
                let material = &self.materials[surface.materials[face] as usize];
                match material {
                    Material::Mirror { .. } | Material::Interface | Material::Pane(_) => self.followed(sight, number),
                    _ => {
                        let normal = if from_front { hit.normal } else { -hit.normal };
                        let arrival = Arrival {
                            direction: sight.direction,
                            normal,
                            here: &self.media[usize::from(surface.media[face])],
                            beyond: &self.media[usize::from(surface.media[1 - face])],
                        };
                        self.sunlit(sight.origin + sight.direction * hit.distance, material, &arrival)
                    }
                }
            }
        }
    }

    /// Radiance that a surface scatters of the sun.
    fn sunlit(&self, at: Vec3, material: &Material, arrival: &Arrival<'_>) -> Rgb {
        let Some(sun) = &self.sun else { return [0.0; 3] };
        let cos = sun.direction.dot(arrival.normal);
        let f = material.evaluate::<3>(arrival, sun.direction);
        if f.iter().all(|f| *f <= 0.0) {
            return [0.0; 3];
        }
        // Off the surface, to the side of the sun.
        let off = arrival.normal * (LIFT * cos.signum());
        let passed = self.passed(free(at + off, sun.direction)).unwrap_or_default();
        std::array::from_fn(|c| f[c] * cos.abs() * passed[c] * sun.radiance[c] * sun.solid_angle)
    }

    /// Radiance along a ray by a few paths, without the sun's disc.
    fn followed(&self, sight: &Sight, number: usize) -> Rgb {
        let mut tracer = Tracer::new(self);
        for k in 0..PATHS {
            tracer.look(
                sight.origin,
                sight.direction,
                Draws::new(mix(SEED ^ mix(number as u64)), k),
            );
        }
        let mut mean = [0.0; 3];
        for found in tracer.finish() {
            for c in 0..3 {
                mean[c] += found[c] / f64::from(PATHS);
            }
        }
        mean
    }
}

/// A shadow ray starts so far off its surface (metres).
const LIFT: f64 = 1e-5;

fn free(origin: Vec3, direction: Vec3) -> Ray {
    Ray {
        origin,
        direction,
        piece: NO_PIECE,
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::{clear, cube, diffuse, open, uniform, v};
    use super::*;
    use crate::picture::View;

    fn fisheye(x: f64, y: f64, z: f64) -> Camera {
        let text = format!("-vta -vp {x} {y} {z} -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180");
        Camera::new(View::parse(&text).expect("a view")).expect("a camera")
    }

    #[test]
    fn what_is_seen_of_a_window_has_its_solid_angle() {
        // A cube of 2 m seen from its middle: a face is a sixth of all directions.
        let room = cube(0.5, diffuse(0.5), uniform());
        let (camera, size) = (fisheye(0.0, 0.0, 0.0), [360, 360]);
        let solid_angles = camera.exact_solid_angles(size[0], size[1]);
        let seen = room.windows_seen(&camera, size);
        let sum: f64 = seen.iter().map(|s| s.share * solid_angles[s.pixel]).sum();
        let whole = 4.0 * std::f64::consts::PI / 6.0;
        assert!((sum - whole).abs() < 2e-3 * whole, "{sum} {whole}");
        assert!(seen.is_sorted_by_key(|s| s.pixel));
    }

    #[test]
    fn a_glance_at_a_diffuse_window_is_its_radiance() {
        let room = cube(0.5, diffuse(0.4), uniform());
        let pixels = room.glance(&fisheye(0.0, 0.0, 0.0), [101, 101]);
        let seen = pixels[50 * 101 + 50][0];
        assert!((seen / (0.4 * 100.0) - 1.0).abs() < 1e-2, "{seen}");
        // The side wall, which no sun lights.
        assert_eq!(pixels[50 * 101 + 2], [0.0; 3]);
    }

    #[test]
    fn features_are_those_of_the_surfaces() {
        let room = cube(0.5, diffuse(0.4), uniform());
        let view = "-vta -vp 0 0 0 -vd 1 0 0 -vu 0 0 1 -vh 180 -vv 180";
        let camera = Camera::new(View::parse(view).expect("a view")).expect("a camera");
        let found = room.features(&camera, [101, 101]);
        let middle = &found[50 * 101 + 50];
        assert!((middle.distance - 1.0).abs() < 1e-3 && (middle.albedo - 0.5).abs() < 1e-9);
        assert!((middle.normal - v(-1.0, 0.0, 0.0)).length() < 1e-9);
        // To the south is the window: right of an eye that looks east.
        assert_eq!(found[50 * 101 + 99].share, 0.0);
        assert!(found.iter().all(|f| (0.0..=1.0 + 1e-9).contains(&f.share)));
    }

    #[test]
    fn the_sun_is_seen_where_it_shines() {
        let room = cube(0.5, open(), clear(40.0, 180.0));
        // Under 40° its rays come in over the sill to this eye, and not to one at the back.
        let seen = room.sun_seen(v(0.0, -0.5, -0.5)).expect("the sun");
        let sun = room.sky().sun().expect("a sun");
        assert!((seen.direction - sun.direction).length() < 1e-3);
        assert!((seen.solid_angle - crate::sky::disc_solid_angle(sun.half_angle)).abs() < 1e-12);
        assert!((seen.radiance[0] / sun.radiance[0] - 1.0).abs() < 1e-9);
        assert!(room.sun_seen(v(0.0, 0.9, 0.9)).is_none());
        // The floor near the window is in the sun: by its irradiance.
        let down = "-vta -vp 0 -0.5 -0.5 -vd 0 0 -1 -vu 0 1 0 -vh 60 -vv 60";
        let camera = Camera::new(View::parse(down).expect("a view")).expect("a camera");
        let floor = room.glance(&camera, [3, 3])[4][0];
        let direct = seen.radiance[0] * seen.solid_angle * 40_f64.to_radians().sin();
        assert!((floor / (0.5 * direct / std::f64::consts::PI) - 1.0).abs() < 1e-6);
    }
}
