//! Samples whose scattering is known.

use std::sync::Arc;
use std::sync::atomic::{AtomicI64, Ordering};

use super::Sample;
use crate::geometry::{Area, Geometry, Meeting, Piece, Profile, Ray};
use crate::material::{Material, Medium, Surface};
use crate::progress::Progress;

/// Straight stretches of one material, repeated along y.
pub fn stretches(pieces: &[[[f64; 2]; 2]], period: f64, material: Material, bands: usize) -> Sample {
    let pieces: Vec<Piece> = pieces
        .iter()
        .map(|&[from, to]| Piece {
            from,
            to,
            turn: 0.0,
            surface: 0,
        })
        .collect();
    let profile = Profile::new(pieces, period).expect("a sound profile");
    Sample {
        bands: (0..bands).map(|b| format!("{} nm", 400 + b)).collect(),
        layers: vec![Box::new(profile) as Box<dyn Geometry>],
        surfaces: vec![Surface {
            materials: [0, 0],
            media: [0, 0],
        }],
        materials: vec![material],
        media: vec![Medium::air(bands)],
    }
}

/// The same reflectance and transmittance in all bands.
pub fn lambertian(reflectance: f64, transmittance: f64, bands: usize) -> Material {
    Material::Lambertian {
        reflectance: vec![reflectance; bands],
        transmittance: vec![transmittance; bands],
    }
}

/// Horizontal slats, 80 mm wide and 72 mm apart.
pub fn blind(reflectance: f64) -> Sample {
    stretches(
        &[[[-0.04, 0.0], [0.04, 0.0]]],
        0.072,
        lambertian(reflectance, 0.0, 1),
        1,
    )
}

/// A sheet without gaps.
pub fn sheet(material: Material, bands: usize) -> Sample {
    stretches(
        &[[[0.0, 0.0], [0.0, 0.05]], [[0.0, 0.05], [0.0, 0.1]]],
        0.1,
        material,
        bands,
    )
}

/// Nothing, 10 cm deep and wide.
struct Nothing;

impl Geometry for Nothing {
    fn depth(&self) -> [f64; 2] {
        [0.0, 0.1]
    }

    fn period(&self) -> [f64; 2] {
        [0.1; 2]
    }

    fn area(&self) -> Area {
        Area {
            x: [0.0, 0.1],
            y: [0.0, 0.1],
        }
    }

    fn meet(&self, _: &mut Ray) -> Meeting {
        Meeting::Leaves
    }
}

/// No sample at all.
pub fn empty() -> Sample {
    Sample {
        layers: vec![Box::new(Nothing)],
        ..sheet(Material::Black, 1)
    }
}

/// Stops the work after a number of rays.
pub struct Fuse {
    pub geometry: Box<dyn Geometry>,
    pub progress: Arc<Progress>,
    pub rays: AtomicI64,
}

impl Geometry for Fuse {
    fn depth(&self) -> [f64; 2] {
        self.geometry.depth()
    }

    fn period(&self) -> [f64; 2] {
        self.geometry.period()
    }

    fn area(&self) -> Area {
        self.geometry.area()
    }

    fn meet(&self, ray: &mut Ray) -> Meeting {
        if self.rays.fetch_sub(1, Ordering::Relaxed) == 0 {
            self.progress.stop();
        }
        self.geometry.meet(ray)
    }
}

/// The sample, with a fuse that ends the work after so many rays.
pub fn fused(mut sample: Sample, rays: i64) -> (Sample, Arc<Progress>) {
    let progress = Arc::new(Progress::default());
    let geometry = sample.layers.pop().expect("there is a layer");
    sample.layers.push(Box::new(Fuse {
        geometry,
        progress: progress.clone(),
        rays: AtomicI64::new(rays),
    }));
    (sample, progress)
}
