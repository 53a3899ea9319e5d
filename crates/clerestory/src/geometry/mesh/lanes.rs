//! Eight boxes or four triangles at once, by the vector instructions of the processor at hand.
#![allow(
    clippy::inline_always,
    reason = "what runs on vector instructions must be made with them"
)]

use super::triangle::Sheared;

/// A node of the hierarchy: what is in each of eight boxes.
#[derive(Debug, Clone)]
#[repr(align(64))]
pub(super) struct Node {
    /// Least x, y, z, then greatest ones, of each box; those of empty places are the wrong way round.
    pub bounds: [[f32; 8]; 6],
    /// What is in it, as the hierarchy numbers it.
    pub children: [u32; 8],
}

/// Four triangles: by corner, axis and lane. Empty lanes are not numbers.
#[derive(Debug, Clone)]
#[repr(align(32))]
pub(super) struct Four {
    pub corners: [[[f64; 4]; 3]; 3],
}

/// A ray among boxes.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    pub origin: [f32; 3],
    /// One over the direction's components.
    pub inverse: [f32; 3],
    /// Where a box's nearer and farther border stand in a node's bounds, along each axis.
    pub near: [usize; 3],
    pub far: [usize; 3],
}

/// Instructions on several numbers at once.
pub(super) trait Lanes: Copy {
    /// The boxes that a ray passes before a distance, a bit each, and where it comes into them.
    fn boxes(self, node: &Node, line: &Line, limit: f32) -> (u32, [f32; 8]);

    /// The triangles that a ray meets between 0 and a distance, a bit each, and how far away.
    fn triangles(self, four: &Four, sheared: &Sheared, origin: &[f64; 3], limit: f64) -> (u32, [f64; 4]);
}

/// One after the other, for any processor.
#[derive(Debug, Clone, Copy)]
pub(super) struct Plain;

impl Lanes for Plain {
    #[inline(always)]
    fn boxes(self, node: &Node, line: &Line, limit: f32) -> (u32, [f32; 8]) {
        let mut enters = [0.0_f32; 8];
        let mut leaves = [limit; 8];
        for axis in 0..3 {
            let (near, far) = (&node.bounds[line.near[axis]], &node.bounds[line.far[axis]]);
            for k in 0..8 {
                enters[k] = enters[k].max((near[k] - line.origin[axis]) * line.inverse[axis]);
                leaves[k] = leaves[k].min((far[k] - line.origin[axis]) * line.inverse[axis]);
            }
        }
        let passed = (0..8).map(|k| u32::from(enters[k] <= leaves[k]) << k).sum();
        (passed, enters)
    }

    #[inline(always)]
    fn triangles(self, four: &Four, sheared: &Sheared, origin: &[f64; 3], limit: f64) -> (u32, [f64; 4]) {
        let t: [f64; 4] = std::array::from_fn(|k| {
            let corner = |c: usize| four.corners[c].map(|axis| axis[k]);
            sheared.meet(origin, &[corner(0), corner(1), corner(2)])
        });
        let met = (0..4).map(|k| u32::from(t[k] > 0.0 && t[k] <= limit) << k).sum();
        (met, t)
    }
}

#[cfg(target_arch = "x86_64")]
mod avx2 {
    use pulp::x86::V3;
    use pulp::{cast, f64x4};
    use std::arch::x86_64::{__m256, __m256d, _CMP_LE_OQ};

    use super::super::triangle::Sheared;
    use super::{Four, Lanes, Line, Node};

    /// Corners of four triangles in a ray's frame. The same operations in the same order for each, and no fused ones:
    /// neighbours must agree. (Closures would not be made with the vector instructions.)
    #[inline(always)]
    fn vertex(v3: V3, corner: &[[f64; 4]; 3], sheared: &Sheared, origin: &[f64; 3]) -> [f64x4; 3] {
        let [x, y, z] = sheared.axes;
        let dz = v3.sub_f64x4(cast(corner[z]), v3.splat_f64x4(origin[z]));
        let dx = v3.sub_f64x4(cast(corner[x]), v3.splat_f64x4(origin[x]));
        let dy = v3.sub_f64x4(cast(corner[y]), v3.splat_f64x4(origin[y]));
        [
            v3.sub_f64x4(dx, v3.mul_f64x4(v3.splat_f64x4(sheared.shear[0]), dz)),
            v3.sub_f64x4(dy, v3.mul_f64x4(v3.splat_f64x4(sheared.shear[1]), dz)),
            dz,
        ]
    }

    impl Lanes for V3 {
        #[inline(always)]
        fn boxes(self, node: &Node, line: &Line, limit: f32) -> (u32, [f32; 8]) {
            let avx = self.avx;
            let mut enters: __m256 = avx._mm256_setzero_ps();
            let mut leaves: __m256 = avx._mm256_set1_ps(limit);
            for axis in 0..3 {
                let origin = avx._mm256_set1_ps(line.origin[axis]);
                let inverse = avx._mm256_set1_ps(line.inverse[axis]);
                let near: __m256 = cast(node.bounds[line.near[axis]]);
                let far: __m256 = cast(node.bounds[line.far[axis]]);
                let near = avx._mm256_mul_ps(avx._mm256_sub_ps(near, origin), inverse);
                let far = avx._mm256_mul_ps(avx._mm256_sub_ps(far, origin), inverse);
                enters = avx._mm256_max_ps(enters, near);
                leaves = avx._mm256_min_ps(leaves, far);
            }
            let passed = avx._mm256_cmp_ps::<_CMP_LE_OQ>(enters, leaves);
            (avx._mm256_movemask_ps(passed) as u32, cast(enters))
        }

        #[inline(always)]
        fn triangles(self, four: &Four, sheared: &Sheared, origin: &[f64; 3], limit: f64) -> (u32, [f64; 4]) {
            let [a, b, c] = &four.corners;
            let ([ax, ay, az], [bx, by, bz], [cx, cy, cz]) = (
                vertex(self, a, sheared, origin),
                vertex(self, b, sheared, origin),
                vertex(self, c, sheared, origin),
            );
            let u = self.sub_f64x4(self.mul_f64x4(cx, by), self.mul_f64x4(cy, bx));
            let v = self.sub_f64x4(self.mul_f64x4(ax, cy), self.mul_f64x4(ay, cx));
            let w = self.sub_f64x4(self.mul_f64x4(bx, ay), self.mul_f64x4(by, ax));
            let least = self.min_f64x4(u, self.min_f64x4(v, w));
            let most = self.max_f64x4(u, self.max_f64x4(v, w));
            let zero = self.splat_f64x4(0.0);
            let inside = self.or_m64x4(self.cmp_ge_f64x4(least, zero), self.cmp_le_f64x4(most, zero));
            let sum = self.add_f64x4(self.add_f64x4(u, v), w);
            let along = self.add_f64x4(
                self.add_f64x4(self.mul_f64x4(u, az), self.mul_f64x4(v, bz)),
                self.mul_f64x4(w, cz),
            );
            let t = self.div_f64x4(self.mul_f64x4(along, self.splat_f64x4(sheared.scale)), sum);
            let ahead = self.and_m64x4(
                self.cmp_gt_f64x4(t, zero),
                self.cmp_le_f64x4(t, self.splat_f64x4(limit)),
            );
            let met: __m256d = cast(self.and_m64x4(inside, ahead));
            (self.avx._mm256_movemask_pd(met) as u32, cast(t))
        }
    }
}
