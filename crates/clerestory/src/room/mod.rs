//! Daylight in a room: paths from eyes and sensors to the windows, the sky and the sun.
//!
//! * [`Room`]: shapes, their surfaces, windows with their systems, lights, and the sky outside; made from [`Parts`].
//! * [`Window`]: a plane polygon that scatters as its data set says.
//! * [`Picture`]: radiance by pixel, with its noise; [`Sensor`]: irradiance at a point.
//! * [`Room::view_matrix`] and its like: daylight matrices, for any system and sky.
//!
//! The world has x to the east, y to the north and z up (metres). Light has three channels, Radiance's red, green and blue; what
//! is traced is radiance in W/(m² sr).

mod aperture;
mod emitter;
mod field;
mod glance;
mod ledger;
mod matrix;
mod openings;
mod path;
mod picture;
mod polygon;
mod sensor;
mod standing;
mod sunlit;
#[cfg(test)]
mod tests;
mod window;

pub use aperture::{NONE, OPEN, SeenCell};
pub use field::Rgb;
pub use glance::{Feature, SunSeen, WindowSeen};
pub use matrix::{Groups, Paths, Rows};
pub use picture::{Accumulated, Picture};
pub use sensor::{Estimate, Sensor};
pub use standing::{Around, Outlook};
pub use sunlit::Sunlit;
pub use window::{System, Window};

use std::f64::consts::TAU;
use std::sync::OnceLock;

use crate::error::{Error, Result};
use crate::geometry::{Extent, Geometry, Mesh, Scene, Vec3};
use crate::material::{Material, Medium, Surface};
use crate::progress::Progress;
use crate::sky::{Sky, disc_solid_angle};

use self::emitter::Emitters;
use self::openings::Openings;
use self::polygon::Polygon;

/// What a surface of the scene is.
#[derive(Debug, Clone, PartialEq)]
pub enum Role {
    /// Scatters light: number of the material of its front and of its back, and of the medium before and behind it.
    Solid(Surface),
    /// A window: its number.
    Window(u32),
    /// Shines from its front: its number among the lights.
    Light(u32),
}

/// What a room is made of.
pub struct Parts {
    /// Shapes, without those of windows and lights.
    pub scene: Scene,
    /// Of each of the scene's surfaces.
    pub surfaces: Vec<Surface>,
    /// Materials, for three channels.
    pub materials: Vec<Material>,
    /// Media, for three channels; the first is air.
    pub media: Vec<Medium>,
    /// Windows: corners, counter-clockwise as seen from the room, and the system.
    pub windows: Vec<(String, Vec<Vec3>, System)>,
    /// Polygons that shine from their front: name, corners and radiance [W/(m² sr)].
    pub lights: Vec<(String, Vec<Vec3>, Rgb)>,
    /// What is outside.
    pub sky: Sky,
}

/// A room, ready for paths.
pub struct Room {
    mesh: Mesh,
    roles: Vec<Role>,
    materials: Vec<Material>,
    media: Vec<Medium>,
    windows: Vec<Window>,
    lights: Vec<(Polygon, Rgb)>,
    emitters: Emitters,
    /// Found when a matrix first asks.
    openings: OnceLock<Openings>,
    sky: Sky,
    sun: Option<Disc>,
}

/// The sun as a disc.
#[derive(Debug, Clone, Copy)]
struct Disc {
    direction: Vec3,
    radiance: Rgb,
    /// (sr)
    solid_angle: f64,
    /// From its middle to its rim on the unit sphere: a cosine near 1 has lost its digits.
    chord: f64,
    /// Two axes across.
    across: [Vec3; 2],
}

impl Disc {
    fn new(sun: &crate::sky::Sun) -> Self {
        Self {
            direction: sun.direction,
            radiance: sun.radiance,
            solid_angle: disc_solid_angle(sun.half_angle),
            chord: 2.0 * (sun.half_angle / 2.0).sin(),
            across: sun.direction.frame(),
        }
    }

    /// A point of it, uniform in solid angle.
    fn sample(&self, u: [f64; 2]) -> Vec3 {
        let cos = 1.0 - u[0] * self.solid_angle / TAU;
        let sin = (1.0 - cos * cos).max(0.0).sqrt();
        let [x, y] = crate::sequence::circle(u[1]);
        (self.across[0] * (sin * x) + self.across[1] * (sin * y) + self.direction * cos).unit()
    }

    fn holds(&self, direction: Vec3) -> bool {
        (direction - self.direction).length() <= self.chord
    }
}

impl Room {
    /// Checks the parts and prepares the light of the windows.
    pub fn new(parts: Parts, progress: &Progress) -> Result<Self> {
        let Parts {
            mut scene,
            surfaces,
            materials,
            media,
            windows,
            lights,
            sky,
        } = parts;
        check(&scene, &surfaces, &materials, &media)?;
        let mut roles: Vec<Role> = surfaces.into_iter().map(Role::Solid).collect();
        let sun = sky.sun().map(|sun| Disc::new(&sun));
        let mut made = Vec::with_capacity(windows.len());
        for (number, (name, corners, system)) in windows.into_iter().enumerate() {
            let polygon = Polygon::new(&format!("window {name:?}"), corners)?;
            polygon.add_to(&mut scene, &format!("window {name}"));
            roles.push(Role::Window(number as u32));
            made.push(Window::new(name, polygon, system));
        }
        let mut shining = Vec::with_capacity(lights.len());
        for (number, (name, corners, radiance)) in lights.into_iter().enumerate() {
            let polygon = Polygon::new(&format!("light {name:?}"), corners)?;
            polygon.add_to(&mut scene, &format!("light {name}"));
            roles.push(Role::Light(number as u32));
            shining.push((polygon, radiance));
        }
        let free = Extent {
            limits: [f64::NEG_INFINITY, f64::INFINITY],
            repeated: false,
        };
        let bounds = scene.elements.iter().map(|e| e.shape.bounds());
        let limits = bounds.fold([[f64::INFINITY, f64::NEG_INFINITY]; 2], |[x, y], [low, high]| {
            [[x[0].min(low.x), x[1].max(high.x)], [y[0].min(low.y), y[1].max(high.y)]]
        });
        let mesh = Mesh::new(scene, limits.map(|limits| Extent { limits, ..free }))?;
        let media_of = roles.iter().map(|role| match role {
            Role::Solid(surface) => surface.media,
            Role::Window(_) | Role::Light(_) => [0; 2],
        });
        mesh.check_media(&media_of.collect::<Vec<_>>())?;
        for window in &mut made {
            window.look_out(&mesh, &sky, sun.as_ref(), progress)?;
        }
        Ok(Self {
            emitters: Emitters::new(&made, &shining),
            openings: OnceLock::new(),
            mesh,
            roles,
            materials,
            media,
            windows: made,
            lights: shining,
            sky,
            sun,
        })
    }

    /// The windows.
    pub fn windows(&self) -> &[Window] {
        &self.windows
    }

    /// The sky outside.
    pub fn sky(&self) -> &Sky {
        &self.sky
    }

    /// Whether all of a window is certainly seen from a point.
    fn is_clear(&self, number: usize, from: Vec3) -> bool {
        let openings = self.openings.get_or_init(|| Openings::new(&self.windows, &self.mesh));
        openings.is_clear(&self.windows, number, from)
    }

    /// Radiance of the sky or the ground, with the sun's disc if that is asked for.
    fn outside(&self, direction: Vec3, with_sun: bool) -> Rgb {
        let mut radiance = self.sky.radiance(direction);
        if let Some(sun) = self.sun.filter(|sun| with_sun && sun.holds(direction)) {
            for (r, s) in radiance.iter_mut().zip(sun.radiance) {
                *r += s;
            }
        }
        radiance
    }
}

fn check(scene: &Scene, surfaces: &[Surface], materials: &[Material], media: &[Medium]) -> Result<()> {
    let wrong = |text: String| Err(Error::Argument(text));
    if scene.surfaces.len() != surfaces.len() {
        return wrong(format!(
            "{} surfaces have names and {} have materials (give each a material)",
            scene.surfaces.len(),
            surfaces.len()
        ));
    }
    for (name, surface) in scene.surfaces.iter().zip(surfaces) {
        let known = surface.materials.iter().all(|&m| (m as usize) < materials.len())
            && surface.media.iter().all(|&m| usize::from(m) < media.len());
        if !known {
            return wrong(format!(
                "surface {name:?} has a material or medium that is not in the list"
            ));
        }
    }
    let three = |bands: usize| bands == 3;
    if !(materials.iter().filter_map(Material::bands).all(three) && media.iter().map(Medium::bands).all(three)) {
        return wrong("materials and media of a room have three channels (red, green, blue)".into());
    }
    Ok(())
}
