//! What scene files of rooms hold: shapes with their materials as they are written, and what of them shines, scatters like a
//! data set, or stands for the sky. Nothing of it is made ready for rays yet.

use std::path::PathBuf;

use super::radiance::{Description, Sky};
use crate::geometry::{Scene, Vec3};

/// A room as its files have it. Lengths are metres, colours have Radiance's three channels.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RoomScene {
    /// All shapes, with those that shine or scatter like a data set; and the warnings.
    pub scene: Scene,
    /// A material for each surface of the scene.
    pub materials: Vec<Description>,
    /// All flat objects with their corners, which the scene has as triangles.
    pub polygons: Vec<Polygon>,
    /// What shines.
    pub lights: Vec<Light>,
    /// What scatters like a data set.
    pub data_sets: Vec<DataSet>,
    /// What shines from far away: sun, sky and ground.
    pub sources: Vec<Distant>,
    /// Skies that sources have as their patterns, or that stand in the files as command lines.
    pub skies: Vec<Sky>,
}

/// A flat object.
#[derive(Debug, Clone, PartialEq)]
pub struct Polygon {
    /// Number of its name among the scene's objects.
    pub object: u32,
    /// Number of its surface.
    pub surface: u32,
    /// Corners, counter-clockwise as seen from its front; a hole is joined to the outside by a seam.
    pub corners: Vec<Vec3>,
}

/// A surface that shines from its front.
#[derive(Debug, Clone, PartialEq)]
pub struct Light {
    /// Number of the surface.
    pub surface: u32,
    /// `light`, `glow`, `spotlight` or `illum`.
    pub kind: String,
    /// Radiance [W/(m² sr)].
    pub radiance: [f64; 3],
    /// Of a `glow`: the distance (metres) up to which it counts as a lamp; 0 for never, below 0 for neither a lamp nor in
    /// ambient light.
    pub reach: Option<f64>,
    /// Of a `spotlight`: full angle (degrees), and where it points, with a length that is the distance of its focus (metres).
    pub cone: Option<(f64, Vec3)>,
}

/// A surface that scatters like a data set.
#[derive(Debug, Clone, PartialEq)]
pub struct DataSet {
    /// Number of the surface.
    pub surface: u32,
    /// The file as it is named.
    pub file: String,
    /// Where it was found.
    pub path: Option<PathBuf>,
    /// Thickness (metres): geometry within it is seen in place of the data set, where it is not 0. Above 0 it lies behind the
    /// surface, below 0 before it.
    pub thickness: f64,
    /// Upward direction, of any length.
    pub up: Vec3,
    /// Light that goes straight through is taken out of the table as a beam (`aBSDF`).
    pub peaks: bool,
    /// Reflectance of the front, of the back, and transmittance that are added as even scattering.
    pub added: [[f64; 3]; 3],
}

/// What shines from far away.
#[derive(Debug, Clone, PartialEq)]
pub struct Distant {
    /// Its name.
    pub name: String,
    /// Unit vector toward it.
    pub direction: Vec3,
    /// Full angle (degrees).
    pub angle_deg: f64,
    /// `light` or `glow`.
    pub kind: String,
    /// Name of its material.
    pub material: String,
    /// Radiance [W/(m² sr)], by which that of the sky is multiplied if it has one.
    pub radiance: [f64; 3],
    /// Number of the sky that is its pattern.
    pub sky: Option<usize>,
    /// File and line.
    pub place: String,
}
