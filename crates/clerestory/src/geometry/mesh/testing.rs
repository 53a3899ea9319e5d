//! Scenes for tests.

use super::scene::Scene;
use super::shape::Shape;
use crate::geometry::Vec3;

/// A flat face of four corners.
pub(super) fn quad(scene: &mut Scene, corners: [Vec3; 4], surface: u32) {
    let object = scene.object("quad");
    let [a, b, c, d] = corners;
    scene.push(Shape::Triangle([a, b, c]), surface, object);
    scene.push(Shape::Triangle([a, c, d]), surface, object);
}

/// A closed box, normals outward, turned a little so that nothing lies along an axis.
pub(super) fn cube(size: f64) -> Scene {
    let mut scene = Scene::default();
    let turn = |p: Vec3| {
        let (s, c) = 0.3_f64.sin_cos();
        let p = Vec3::new(p.x * c - p.y * s, p.x * s + p.y * c, p.z);
        Vec3::new(p.x * c - p.z * s, p.y, p.x * s + p.z * c) * size
    };
    let p = |k: usize| {
        turn(Vec3::new(
            (k & 1) as f64 - 0.5,
            (k >> 1 & 1) as f64 - 0.5,
            (k >> 2 & 1) as f64 - 0.5,
        ))
    };
    for face in [
        [0, 2, 3, 1],
        [4, 5, 7, 6],
        [0, 1, 5, 4],
        [2, 6, 7, 3],
        [0, 4, 6, 2],
        [1, 3, 7, 5],
    ] {
        quad(&mut scene, face.map(p), 0);
    }
    scene
}

/// Saw-tooth prisms on a flat back, as an extrusion along x that is as long as its period.
pub(super) fn prisms(size: f64) -> Scene {
    let mut scene = Scene::default();
    let (w, p) = (2.0 * size, size);
    let (back, valley, ridge) = (0.0, 0.5 * size, size);
    // Seen along x: back at z = 0 from y = 0 to p, valley at y = 0 and p, ridge at y = 0.4 p.
    let at = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
    quad(
        &mut scene,
        [at(0.0, 0.0, back), at(0.0, p, back), at(w, p, back), at(w, 0.0, back)],
        0,
    );
    let y = 0.4 * p;
    quad(
        &mut scene,
        [
            at(0.0, 0.0, valley),
            at(w, 0.0, valley),
            at(w, y, ridge),
            at(0.0, y, ridge),
        ],
        0,
    );
    quad(
        &mut scene,
        [at(0.0, y, ridge), at(w, y, ridge), at(w, p, valley), at(0.0, p, valley)],
        0,
    );
    scene
}
