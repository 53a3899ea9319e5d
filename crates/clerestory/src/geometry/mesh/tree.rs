//! The bounding hierarchy: boxes in 32 bits, what is in them in 64.

use obvhs::aabb::Aabb;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray as BoxRay, RayHit};

use super::shape::Shape;
use super::triangle::Sheared;
use crate::geometry::Vec3;

/// The boxes' frame is the cell, stretched along each axis to this length, so that all sizes keep the same digits.
const SIZE: f64 = 1024.0;
/// Boxes are widened by this much in their frame: rounding to 32 bits of positions, directions and reciprocals (5e-4), the
/// least distance at which the traversal looks (1e-4), with reserve.
const WIDER: f64 = 2e-3;
/// Axes are stretched no more than this beyond the longest one, so that surface areas still tell what costs time.
const STRETCH: f64 = 64.0;

/// A shape where it stands in the cell, in the order of the hierarchy.
#[derive(Debug, Clone)]
struct Leaf {
    triangle: [[f64; 3]; 3],
    /// Number of the copy.
    copy: u32,
    /// Number of the curved shape, or [`FLAT`].
    curved: u32,
}

const FLAT: u32 = u32::MAX;

/// Shapes by place.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    nodes: CwBvh,
    leaves: Vec<Leaf>,
    curved: Vec<Shape>,
    centre: Vec3,
    scale: Vec3,
}

/// What a ray starts from: a copy, and how long ago.
#[derive(Debug, Clone, Copy)]
pub(super) struct Start {
    /// Number of the copy, or [`NO_PIECE`](crate::geometry::NO_PIECE).
    pub copy: u32,
    /// Way since then (metres).
    pub ago: f64,
}

impl Tree {
    /// From copies and their boxes, all within the limits `low` to `high`.
    pub fn new(copies: &[Shape], boxes: &[[Vec3; 2]], [low, high]: [Vec3; 2]) -> Self {
        let centre = (low + high) * 0.5;
        let size = high - low;
        let longest = size.x.max(size.y).max(size.z);
        let stretch = |length: f64| SIZE / length.max(longest / STRETCH);
        let scale = Vec3::new(stretch(size.x), stretch(size.y), stretch(size.z));
        let aabbs: Vec<Aabb> = boxes
            .iter()
            .map(|[low, high]| {
                let framed = |p: Vec3, wider: f64| {
                    let p = p - centre;
                    [p.x * scale.x + wider, p.y * scale.y + wider, p.z * scale.z + wider].map(|x| x as f32)
                };
                Aabb {
                    min: framed(*low, -WIDER).into(),
                    max: framed(*high, WIDER).into(),
                }
            })
            .collect();
        let indices = (0..aabbs.len() as u32).collect();
        let mut binary = PlocBuilder::with_capacity(aabbs.len()).build(
            PlocSearchDistance::High,
            &aabbs,
            indices,
            SortPrecision::U64,
            2,
        );
        ReinsertionOptimizer::default().run(&mut binary, 0.25, None);
        let nodes = bvh2_to_cwbvh(&binary, 2, true, false);
        let mut curved = Vec::new();
        let leaves = nodes
            .primitive_indices
            .iter()
            .map(|&copy| {
                let shape = copies[copy as usize];
                let mut leaf = Leaf {
                    triangle: [[0.0; 3]; 3],
                    copy,
                    curved: FLAT,
                };
                if let Shape::Triangle(corners) = shape {
                    leaf.triangle = corners.map(Vec3::array);
                } else {
                    leaf.curved = curved.len() as u32;
                    curved.push(shape);
                }
                leaf
            })
            .collect();
        Self {
            nodes,
            leaves,
            curved,
            centre,
            scale,
        }
    }

    /// The nearest copy that a ray meets within a reach, and how far away.
    #[inline]
    pub fn meet(&self, origin: Vec3, direction: Vec3, reach: f64, start: Start) -> Option<(f64, u32)> {
        let from = origin - self.centre;
        let o = [from.x * self.scale.x, from.y * self.scale.y, from.z * self.scale.z];
        let d = [
            direction.x * self.scale.x,
            direction.y * self.scale.y,
            direction.z * self.scale.z,
        ];
        // Distances in the boxes' frame are along the stretched direction.
        let stretch = (d[0] * d[0] + d[1] * d[1] + d[2] * d[2]).sqrt();
        let d = d.map(|d| (d / stretch) as f32);
        let far = |t: f64| (t * stretch * (1.0 + 1e-6)) as f32 + 1e-3;
        let ray = BoxRay {
            origin: o.map(|o| o as f32).into(),
            direction: d.into(),
            inv_direction: d.map(obvhs::ray::safe_inverse).into(),
            tmin: 0.0,
            tmax: far(reach),
        };
        let (mut nearest, mut met) = (reach, u32::MAX);
        let sheared = Sheared::new(direction.array());
        let origin_array = origin.array();
        self.nodes.ray_traverse(ray, &mut RayHit::none(), |_, id| {
            let leaf = &self.leaves[id];
            let t = if leaf.curved == FLAT {
                if leaf.copy == start.copy {
                    return f32::INFINITY;
                }
                sheared.meet(&origin_array, &leaf.triangle)
            } else {
                let shape = &self.curved[leaf.curved as usize];
                if leaf.copy == start.copy {
                    shape.meet(origin - direction * start.ago, direction, true) - start.ago
                } else {
                    shape.meet(origin, direction, false)
                }
            };
            if t > 0.0 && t <= nearest {
                nearest = t;
                met = leaf.copy;
                return far(t);
            }
            f32::INFINITY
        });
        (met != u32::MAX).then_some((nearest, met))
    }
}
