//! A view that was checked: points of the picture to rays, and directions to points.

use super::projection::Projection;
use super::view::View;
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// A checked view with the frame of its eye.
///
/// Points of a picture are x from 0 at the left to 1 at the right, and y from 0 at the bottom to 1 at the top.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    view: View,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Width and height on the surface of projection.
    extent: [f64; 2],
}

/// Directions nearer than this to each other (sine of their angle) give no frame.
const PARALLEL: f64 = 1e-6;

impl Camera {
    /// Checks a view.
    ///
    /// # Errors
    /// The line of sight or the upward direction is zero, they are parallel, or a size is not possible.
    pub fn new(view: View) -> Result<Self> {
        let fail = |what: String| Err(Error::Argument(format!("view: {what}")));
        let numbers = [
            view.point.array(),
            view.direction.array(),
            view.up.array(),
            [view.horizontal, view.vertical, view.shift],
            [view.lift, view.fore, view.aft],
        ];
        if numbers.as_flattened().iter().any(|v| !v.is_finite()) {
            return fail("it has a number that is not finite (give finite numbers)".into());
        }
        let (Some(forward), Some(up)) = (unit(view.direction), unit(view.up)) else {
            return fail("the line of sight or the upward direction is 0 0 0 (give a direction)".into());
        };
        let right = forward.cross(up);
        if right.length() < PARALLEL {
            return fail("the upward direction is parallel to the line of sight (give -vu another direction)".into());
        }
        let right = right.unit();
        for (index, (name, size)) in [
            ("horizontal size (-vh)", view.horizontal),
            ("vertical size (-vv)", view.vertical),
        ]
        .into_iter()
        .enumerate()
        {
            if size <= 0.0 {
                return fail(format!("the {name} is {size} (give a positive size)"));
            }
            if let Some((limit, included)) = view.projection.limits().map(|limits| limits[index])
                && (size > limit * (1.0 + 1e-9) || (!included && size >= limit))
            {
                return fail(format!(
                    "the {name} is {size}°, but a {} picture ends {} {limit}° (give less, or another -vt)",
                    view.projection.name(),
                    if included { "at" } else { "before" }
                ));
            }
        }
        if view.fore < 0.0 || (view.aft != 0.0 && view.aft <= view.fore) {
            return fail(format!(
                "it is clipped from {} to {} m (give -vo from 0 upward and -va beyond it, or -va 0)",
                view.fore, view.aft
            ));
        }
        Ok(Self {
            right,
            up: right.cross(forward),
            forward,
            extent: view.projection.extent(view.horizontal, view.vertical),
            view,
        })
    }

    /// The view that it was made of.
    pub const fn view(&self) -> &View {
        &self.view
    }

    /// To the right, up and along the line of sight: the eye's frame in the world, of length 1.
    pub const fn frame(&self) -> [Vec3; 3] {
        [self.right, self.up, self.forward]
    }

    /// Height over width of a picture with square pixels.
    pub fn aspect(&self) -> f64 {
        self.extent[1] / self.extent[0]
    }

    /// Width and height with square pixels within a largest width and height; at least 1 × 1.
    pub fn size_within(&self, width: usize, height: usize) -> [usize; 2] {
        let aspect = self.aspect();
        let (w, h) = (width as f64, height as f64);
        if aspect * w > h {
            [((h / aspect + 0.5) as usize).clamp(1, width.max(1)), height.max(1)]
        } else {
            [width.max(1), ((w * aspect + 0.5) as usize).clamp(1, height.max(1))]
        }
    }

    /// Where a ray through a point of the picture begins and its direction of length 1; None outside of the projection.
    ///
    /// It begins at the fore distance from the eye (or, for a parallel view, from the plane of the eye).
    pub fn ray(&self, x: f64, y: f64) -> Option<[Vec3; 2]> {
        let at = self.surface(x, y);
        let direction = self.world(self.view.projection.direction(at)?).unit();
        let eye = if self.view.projection == Projection::Parallel {
            self.view.point + self.right * at[0] + self.up * at[1]
        } else {
            self.view.point
        };
        // What is clipped before a perspective is a plane, as in the picture; before all others a ball.
        let distance = if self.view.projection == Projection::Perspective {
            self.view.fore / direction.dot(self.forward)
        } else {
            self.view.fore
        };
        Some([eye + direction * distance, direction])
    }

    /// Direction of length 1 in the eye's frame (right, up, forward); None outside of the projection.
    pub fn local(&self, x: f64, y: f64) -> Option<[f64; 3]> {
        let [x, y, z] = self.view.projection.direction(self.surface(x, y))?;
        let scale = 1.0 / (x * x + y * y + z * z).sqrt();
        Some([x * scale, y * scale, z * scale])
    }

    /// Point of the picture where a direction of any length is seen; None where it has none, or no single one. It can lie
    /// outside of the picture (below 0 or above 1).
    pub fn locate(&self, direction: Vec3) -> Option<[f64; 2]> {
        let d = unit(direction)?;
        let at = self
            .view
            .projection
            .point([d.dot(self.right), d.dot(self.up), d.dot(self.forward)])?;
        Some([
            at[0] / self.extent[0] + 0.5 - self.view.shift,
            at[1] / self.extent[1] + 0.5 - self.view.lift,
        ])
    }

    /// A direction of the eye's frame in the world.
    pub fn world(&self, [x, y, z]: [f64; 3]) -> Vec3 {
        self.right * x + self.up * y + self.forward * z
    }

    /// Point of the projection's surface for a point of the picture.
    pub(super) fn surface(&self, x: f64, y: f64) -> [f64; 2] {
        [
            (x - 0.5 + self.view.shift) * self.extent[0],
            (y - 0.5 + self.view.lift) * self.extent[1],
        ]
    }
}

/// Of length 1; None for a direction that has none.
fn unit(v: Vec3) -> Option<Vec3> {
    let largest = v.x.abs().max(v.y.abs()).max(v.z.abs());
    (largest > 0.0 && largest.is_finite()).then(|| (v * (1.0 / largest)).unit())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera(options: &str) -> Camera {
        Camera::new(View::parse(options).unwrap()).unwrap()
    }

    const ALL: [&str; 6] = [
        "-vtv -vh 70 -vv 50",
        "-vtl -vh 7 -vv 5",
        "-vth -vh 180 -vv 160",
        "-vta -vh 300 -vv 180",
        "-vts -vh 270 -vv 180",
        "-vtc -vh 360 -vv 120",
    ];

    #[test]
    fn the_edge_is_at_half_the_size() {
        for options in ALL {
            let camera = camera(&format!("{options} -vd 0 2 0"));
            let [right, up, forward] = camera.frame();
            assert_eq!(right, Vec3::new(1.0, 0.0, 0.0));
            assert_eq!(up, Vec3::new(0.0, 0.0, 1.0));
            assert_eq!(forward, Vec3::new(0.0, 1.0, 0.0));
            let [_, middle] = camera.ray(0.5, 0.5).unwrap();
            assert!((middle - forward).length() < 1e-15);
            let [from, side] = camera.ray(1.0, 0.5).unwrap();
            let [_, top] = camera.ray(0.5, 1.0).unwrap();
            if camera.view().projection == Projection::Parallel {
                assert!((from - right * 3.5).length() < 1e-12 && (side - forward).length() < 1e-15);
                continue;
            }
            let half = 0.5 * camera.view().horizontal.to_radians();
            assert!(
                (side - Vec3::new(half.sin(), half.cos(), 0.0)).length() < 1e-12,
                "{options}"
            );
            let half = 0.5 * camera.view().vertical.to_radians();
            assert!(
                (top - Vec3::new(0.0, half.cos(), half.sin())).length() < 1e-12,
                "{options}"
            );
        }
    }

    #[test]
    fn points_come_back() {
        for options in ALL {
            if options.contains("-vtl") {
                continue;
            }
            let camera = camera(&format!("{options} -vd 1 2 -0.3 -vu 0.2 0 1 -vs 0.1 -vl -0.2"));
            let mut seen = 0;
            for k in 0..400 {
                let (x, y) = (f64::from(k % 20) / 19.0, f64::from(k / 20) / 19.0);
                let Some([_, direction]) = camera.ray(x, y) else {
                    continue;
                };
                assert!((direction.length() - 1.0).abs() < 1e-14);
                let at = camera.locate(direction * 3.0).unwrap();
                assert!(
                    (at[0] - x).abs() + (at[1] - y).abs() < 1e-7,
                    "{options}: {x} {y} {at:?}"
                );
                seen += 1;
            }
            assert!(seen > 200, "{options}: {seen}");
        }
    }

    #[test]
    fn what_no_ray_reaches() {
        assert!(camera("-vth -vh 180 -vv 180").ray(0.05, 0.05).is_none());
        assert!(camera("-vta -vh 180 -vv 180").ray(0.0, 0.0).is_some());
        assert!(camera("-vta -vh 360 -vv 360").ray(0.0, 0.0).is_none());
        assert!(camera("-vtv").locate(Vec3::new(0.0, -1.0, 0.0)).is_none());
        assert!(camera("-vtl").locate(Vec3::new(0.0, 1.0, 0.0)).is_none());
        assert!(camera("-vta").locate(Vec3::default()).is_none());
    }

    #[test]
    fn pixels_are_square_within_a_size() {
        assert_eq!(camera("-vta -vh 180 -vv 180").size_within(800, 600), [600, 600]);
        assert_eq!(camera("-vtl -vh 2 -vv 1").size_within(800, 800), [800, 400]);
        let tall = camera("-vtv -vh 30 -vv 60");
        let [w, h] = tall.size_within(1000, 500);
        assert_eq!((w, h), (232, 500));
        assert_eq!(camera("-vtl -vh 1e6 -vv 1").size_within(100, 100), [100, 1]);
    }

    #[test]
    fn impossible_views_are_refused() {
        for (options, words) in [
            ("-vd 0 0 1", "parallel to the line of sight"),
            ("-vd 0 0 0", "0 0 0"),
            ("-vtv -vh 180", "ends before 180°"),
            ("-vth -vv 181", "ends at 180°"),
            ("-vta -vh 361", "ends at 360°"),
            ("-vtc -vv 180", "ends before 180°"),
            ("-vta -vh -5", "positive"),
            ("-vo 2 -va 1", "clipped"),
        ] {
            let text = Camera::new(View::parse(options).unwrap()).unwrap_err().to_string();
            assert!(text.contains(words) && text.contains("give"), "{text}");
        }
        assert!(Camera::new(View::parse("-vta -vh 180 -vv 180 -vd 0 0 1 -vu 1e-3 0 1").unwrap()).is_ok());
    }
}
