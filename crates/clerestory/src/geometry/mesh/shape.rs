//! Triangles, spheres, rings and cones.

use crate::geometry::Vec3;

/// A piece of a scene. All lengths are metres.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Shape {
    /// Its front is where its corners run counter-clockwise.
    Triangle([Vec3; 3]),
    /// A round one.
    Sphere {
        /// Middle.
        centre: Vec3,
        /// Above 0.
        radius: f64,
        /// The front is inside.
        inward: bool,
    },
    /// A flat disk, with a hole if `radii[0]` is above 0.
    Ring {
        /// Middle.
        centre: Vec3,
        /// Unit vector out of its front.
        normal: Vec3,
        /// Inner and outer.
        radii: [f64; 2],
    },
    /// The side of a cone or a cylinder, open at both ends.
    Cone {
        /// Middles of its ends.
        ends: [Vec3; 2],
        /// Radii at its ends, at least one above 0.
        radii: [f64; 2],
        /// The front is inside.
        inward: bool,
    },
}

impl Shape {
    /// The same one, elsewhere.
    #[must_use]
    pub fn shifted(self, by: Vec3) -> Self {
        match self {
            Self::Triangle(corners) => Self::Triangle(corners.map(|c| c + by)),
            Self::Sphere { centre, radius, inward } => Self::Sphere {
                centre: centre + by,
                radius,
                inward,
            },
            Self::Ring { centre, normal, radii } => Self::Ring {
                centre: centre + by,
                normal,
                radii,
            },
            Self::Cone { ends, radii, inward } => Self::Cone {
                ends: ends.map(|e| e + by),
                radii,
                inward,
            },
        }
    }

    /// Unit normal out of the front at one of its points.
    pub fn normal(&self, point: Vec3) -> Vec3 {
        let turned = |normal: Vec3, inward: bool| if inward { -normal } else { normal };
        match *self {
            Self::Triangle([a, b, c]) => (b - a).cross(c - a).unit(),
            Self::Sphere { centre, inward, .. } => turned((point - centre).unit(), inward),
            Self::Ring { normal, .. } => normal,
            Self::Cone { ends, radii, inward } => {
                let axis = ends[1] - ends[0];
                let length = axis.length();
                let axis = axis * (1.0 / length);
                let from = point - ends[0];
                let radial = (from - axis * from.dot(axis)).unit();
                let normal = (radial * length + axis * (radii[0] - radii[1])).unit();
                turned(normal, inward)
            }
        }
    }

    /// Least and greatest coordinates.
    pub fn bounds(&self) -> [Vec3; 2] {
        let over = |points: [Vec3; 2], reach: Vec3| {
            let [a, b] = points;
            [
                Vec3::new(a.x.min(b.x), a.y.min(b.y), a.z.min(b.z)) - reach,
                Vec3::new(a.x.max(b.x), a.y.max(b.y), a.z.max(b.z)) + reach,
            ]
        };
        match *self {
            Self::Triangle([a, b, c]) => {
                let [low, high] = over([a, b], Vec3::default());
                [over([low, c], Vec3::default())[0], over([high, c], Vec3::default())[1]]
            }
            Self::Sphere { centre, radius, .. } => over([centre; 2], Vec3::new(radius, radius, radius)),
            Self::Ring { centre, normal, radii } => over([centre; 2], disk_reach(normal) * radii[1]),
            Self::Cone { ends, radii, .. } => {
                let reach = disk_reach((ends[1] - ends[0]).unit());
                let [a, b] = [0, 1].map(|k| over([ends[k]; 2], reach * radii[k]));
                [
                    over([a[0], b[0]], Vec3::default())[0],
                    over([a[1], b[1]], Vec3::default())[1],
                ]
            }
        }
    }

    /// Way from an origin to a curved shape or a ring, above 0, in units of the direction's length; infinite where they do
    /// not meet. A ray that starts `on` it meets it only elsewhere. Triangles have a test of their own.
    pub(super) fn meet(&self, origin: Vec3, direction: Vec3, on: bool) -> f64 {
        match *self {
            Self::Triangle(_) => f64::INFINITY,
            Self::Sphere { centre, radius, .. } => {
                let from = origin - centre;
                let a = direction.dot(direction);
                let b = from.dot(direction);
                // The distance of the line from the centre, without the cancellation of b² - a·c (Haines and others, Ray
                // Tracing Gems, 2019, chapter 7).
                let aside = from - direction * (b / a);
                let discriminant = a * (radius * radius - aside.dot(aside));
                let c = from.dot(from) - radius * radius;
                first(roots(a, b, c, discriminant, on), |_| true)
            }
            Self::Ring { centre, normal, radii } => {
                if on {
                    return f64::INFINITY;
                }
                let t = (centre - origin).dot(normal) / direction.dot(normal);
                let from = origin + direction * t - centre;
                let r2 = from.dot(from);
                let inside = r2 <= radii[1] * radii[1] && r2 >= radii[0] * radii[0];
                if t > 0.0 && inside { t } else { f64::INFINITY }
            }
            Self::Cone { ends, radii, .. } => {
                let axis = ends[1] - ends[0];
                let length = axis.length();
                let axis = axis * (1.0 / length);
                let slope = (radii[1] - radii[0]) / length;
                let from = origin - ends[0];
                let (h0, dh) = (from.dot(axis), direction.dot(axis));
                let (from, aside) = (from - axis * h0, direction - axis * dh);
                let (r0, dr) = (radii[0] + slope * h0, slope * dh);
                let a = aside.dot(aside) - dr * dr;
                let b = from.dot(aside) - r0 * dr;
                let c = from.dot(from) - r0 * r0;
                first(roots(a, b, c, b * b - a * c, on), |t| {
                    // The other half of the double cone has a negative radius.
                    let h = h0 + dh * t;
                    (0.0..=length).contains(&h)
                })
            }
        }
    }
}

/// How far a disk of radius 1 reaches along the axes.
fn disk_reach(normal: Vec3) -> Vec3 {
    let reach = |n: f64| (1.0 - n * n).max(0.0).sqrt();
    Vec3::new(reach(normal.x), reach(normal.y), reach(normal.z))
}

/// Roots of a t² + 2 b t + c = 0. Where the ray starts on the surface one of them is 0, whatever rounding says, and only
/// the other one is given.
fn roots(a: f64, b: f64, c: f64, discriminant: f64, on: bool) -> [f64; 2] {
    if on {
        return [-2.0 * b / a, f64::NAN];
    }
    if discriminant < 0.0 {
        return [f64::NAN; 2];
    }
    let q = -(b + discriminant.sqrt().copysign(b));
    [q / a, c / q]
}

/// The least root above 0 that is accepted.
fn first(roots: [f64; 2], accepted: impl Fn(f64) -> bool) -> f64 {
    let [s, t] = roots.map(|t| if t > 0.0 && accepted(t) { t } else { f64::INFINITY });
    s.min(t)
}

#[cfg(test)]
mod tests {
    use super::*;

    const X: Vec3 = Vec3::new(1.0, 0.0, 0.0);
    const Z: Vec3 = Vec3::new(0.0, 0.0, 1.0);

    fn close(a: f64, b: f64) -> bool {
        (a - b).abs() < 1e-14 * b.abs().max(1.0)
    }

    #[test]
    fn a_sphere_is_met_where_geometry_says() {
        let sphere = Shape::Sphere {
            centre: Vec3::new(0.0, 0.0, 5.0),
            radius: 2.0,
            inward: false,
        };
        assert!(close(sphere.meet(Vec3::default(), Z, false), 3.0));
        assert!(close(sphere.meet(Vec3::new(0.0, 0.0, 5.0), Z, false), 2.0));
        // A chord: 1.2 aside, half length 1.6.
        assert!(close(sphere.meet(Vec3::new(1.2, 0.0, 0.0), Z, false), 3.4));
        let start = Vec3::new(1.2, 0.0, 3.4);
        assert!(close(sphere.meet(start, Z, true), 3.2));
        assert_eq!(sphere.meet(start, -Z, true), f64::INFINITY);
        assert_eq!(sphere.meet(Vec3::new(2.1, 0.0, 0.0), Z, false), f64::INFINITY);
        let normal = sphere.normal(start);
        assert!((normal - Vec3::new(0.6, 0.0, -0.8)).length() < 1e-15);
    }

    #[test]
    fn a_small_far_sphere_keeps_its_digits() {
        let sphere = Shape::Sphere {
            centre: Vec3::new(0.0, 0.0, 1.0),
            radius: 1e-5,
            inward: false,
        };
        let t = sphere.meet(Vec3::new(6e-6, 0.0, 0.0), Z, false);
        assert!((t - (1.0 - 8e-6)).abs() < 1e-15, "{t}");
    }

    #[test]
    fn a_ring_has_a_hole() {
        let ring = Shape::Ring {
            centre: Vec3::new(0.0, 0.0, 1.0),
            normal: -Z,
            radii: [0.5, 1.0],
        };
        assert_eq!(ring.meet(Vec3::default(), Z, false), f64::INFINITY);
        assert!(close(ring.meet(Vec3::new(0.7, 0.0, 0.0), Z, false), 1.0));
        assert_eq!(ring.meet(Vec3::new(1.1, 0.0, 0.0), Z, false), f64::INFINITY);
        assert_eq!(ring.meet(Vec3::new(0.7, 0.0, 1.0), Z, true), f64::INFINITY);
    }

    #[test]
    fn a_cylinder_and_a_cone_are_met_where_geometry_says() {
        let cylinder = Shape::Cone {
            ends: [Vec3::default(), Z * 2.0],
            radii: [1.0, 1.0],
            inward: false,
        };
        let from = Vec3::new(-3.0, 0.6, 1.0);
        assert!(close(cylinder.meet(from, X, false), 2.2));
        let on = from + X * 2.2;
        assert!(close(cylinder.meet(on, X, true), 1.6));
        assert!((cylinder.normal(on) - Vec3::new(-0.8, 0.6, 0.0)).length() < 1e-15);
        // Through the open end to the far side.
        assert!(close(
            cylinder.meet(Vec3::new(0.0, 0.0, -1.0), Vec3::new(0.6, 0.0, 0.8), false),
            5.0 / 3.0
        ));
        assert_eq!(cylinder.meet(Vec3::new(-3.0, 0.0, 2.1), X, false), f64::INFINITY);
        assert_eq!(cylinder.meet(Vec3::new(0.2, 0.0, -1.0), Z, false), f64::INFINITY);

        let cone = Shape::Cone {
            ends: [Vec3::default(), Z * 2.0],
            radii: [0.0, 1.0],
            inward: false,
        };
        // At height 1 its radius is 0.5; its mirror image below the tip is not there.
        assert!(close(cone.meet(Vec3::new(-3.0, 0.0, 1.0), X, false), 2.5));
        assert_eq!(cone.meet(Vec3::new(-3.0, 0.0, -1.0), X, false), f64::INFINITY);
        assert!(close(cone.meet(Vec3::new(-0.25, 0.0, 3.0), -Z, false), 2.5));
        let normal = cone.normal(Vec3::new(-0.5, 0.0, 1.0));
        assert!((normal - Vec3::new(-2.0, 0.0, -1.0).unit()).length() < 1e-15);
    }

    #[test]
    fn bounds_touch_what_they_hold() {
        let axis = Vec3::new(0.6, 0.0, 0.8);
        let cone = Shape::Cone {
            ends: [Vec3::default(), axis],
            radii: [0.5, 0.25],
            inward: false,
        };
        let [low, high] = cone.bounds();
        assert!(close(low.x, -0.4) && close(low.y, -0.5) && close(low.z, -0.3));
        assert!(close(high.x, 0.8) && close(high.y, 0.5) && close(high.z, 0.95));
    }
}
