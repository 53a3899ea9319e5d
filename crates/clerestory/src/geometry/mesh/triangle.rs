//! Rays and triangles, without leaks between neighbours.

/// A ray in the frame of the watertight test: its longest component comes last, and the other two are sheared away, so that
/// every vertex is looked at by itself. Two triangles that share an edge then agree on which side of it a ray passes
/// (Woop, Benthin, Wald 2013, JCGT 2(1)).
#[derive(Debug, Clone, Copy)]
pub(super) struct Sheared {
    pub axes: [usize; 3],
    pub shear: [f64; 2],
    pub scale: f64,
}

impl Sheared {
    /// Of a direction that is not zero.
    pub fn new(direction: [f64; 3]) -> Self {
        let [x, y, z] = direction.map(f64::abs);
        let axes = if z >= x && z >= y {
            [0, 1, 2]
        } else if y >= x {
            [2, 0, 1]
        } else {
            [1, 2, 0]
        };
        let along = direction[axes[2]];
        Self {
            axes,
            shear: [direction[axes[0]] / along, direction[axes[1]] / along],
            scale: 1.0 / along,
        }
    }

    /// Way from an origin to a triangle in units of the direction's length; not a number or not above 0 where they do not
    /// meet.
    #[inline]
    pub fn meet(&self, origin: &[f64; 3], triangle: &[[f64; 3]; 3]) -> f64 {
        let [x, y, z] = self.axes;
        let [ox, oy, oz] = [origin[x], origin[y], origin[z]];
        let [a, b, c] = triangle;
        let (az, bz, cz) = (a[z] - oz, b[z] - oz, c[z] - oz);
        let (ax, ay) = ((a[x] - ox) - self.shear[0] * az, (a[y] - oy) - self.shear[1] * az);
        let (bx, by) = ((b[x] - ox) - self.shear[0] * bz, (b[y] - oy) - self.shear[1] * bz);
        let (cx, cy) = ((c[x] - ox) - self.shear[0] * cz, (c[y] - oy) - self.shear[1] * cz);
        // Twice the areas that the ray's point makes with each side; all of one sign inside.
        let u = cx * by - cy * bx;
        let v = ax * cy - ay * cx;
        let w = bx * ay - by * ax;
        let least = u.min(v).min(w);
        let most = u.max(v).max(w);
        if least < 0.0 && most > 0.0 {
            return f64::NAN;
        }
        (u * az + v * bz + w * cz) * self.scale / (u + v + w)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;

    #[test]
    fn distances_are_those_of_the_plane() {
        let triangle = [[0.0, 0.0, 1.0], [2.0, 0.0, 1.0], [0.0, 2.0, 3.0]];
        let t = Sheared::new([0.0, 0.0, 1.0]).meet(&[0.5, 0.5, 0.0], &triangle);
        assert!((t - 1.5).abs() < 1e-15);
        let t = Sheared::new([0.0, 0.0, -2.0]).meet(&[0.5, 0.5, 4.0], &triangle);
        assert!((t - 1.25).abs() < 1e-15);
        let beside = Sheared::new([0.0, 0.0, 1.0]).meet(&[1.5, 1.5, 0.0], &triangle);
        assert!(beside.is_nan());
        let behind = Sheared::new([0.0, 0.0, 1.0]).meet(&[0.5, 0.5, 4.0], &triangle);
        assert!(behind < 0.0);
    }

    #[test]
    fn a_shared_edge_lets_nothing_through() {
        // Rays aimed at points of the diagonal of a tilted parallelogram, as exactly as doubles can.
        let corners = [[0.1, 0.2, 0.3], [1.3, 0.25, 0.7], [1.1, 1.4, 1.9], [-0.1, 1.35, 1.5]];
        let two = [
            [corners[0], corners[1], corners[2]],
            [corners[0], corners[2], corners[3]],
        ];
        for k in 0..100_000_u64 {
            let u = |d| uniform(11, 8 * k + d);
            let s = 0.01 + 0.98 * u(0);
            let target: [f64; 3] = std::array::from_fn(|i| corners[0][i] * (1.0 - s) + corners[2][i] * s);
            let origin = [3.0 * u(1) - 1.0, 3.0 * u(2) - 1.0, -1.0 - u(3)];
            let direction: [f64; 3] = std::array::from_fn(|i| target[i] - origin[i]);
            let ray = Sheared::new(direction);
            assert!(
                two.iter().any(|t| ray.meet(&origin, t) > 0.0),
                "{origin:?} {direction:?}"
            );
        }
    }
}
