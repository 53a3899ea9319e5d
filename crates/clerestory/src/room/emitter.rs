//! Which window or light a path asks for light, and in which direction.

use super::Rgb;
use super::polygon::Polygon;
use super::window::Window;
use crate::geometry::Vec3;

/// Windows and lights with the chance that each is asked, by the light that it sends.
#[derive(Debug, Clone, Default)]
pub(super) struct Emitters {
    /// Chances up to and with each; windows first.
    chances: Vec<f64>,
}

/// Share of the draws that choose a direction by where the window's light goes; the others choose a point of it.
const BY_DIRECTION: f64 = 0.5;
/// An emitter is asked at least with this share of an even chance.
const LEAST: f64 = 0.1;

impl Emitters {
    pub(super) fn new(windows: &[Window], lights: &[(Polygon, Rgb)]) -> Self {
        let flux: Vec<f64> = windows
            .iter()
            .map(|w| w.polygon().area() * w.distribution().flux())
            .chain(lights.iter().map(|(polygon, radiance)| {
                polygon.area() * std::f64::consts::PI * radiance.iter().sum::<f64>()
            }))
            .collect();
        let (sum, n) = (flux.iter().sum::<f64>(), flux.len() as f64);
        let mut total = 0.0;
        let chances = flux.iter().map(|f| {
            total += if sum > 0.0 { (1.0 - LEAST) * f / sum + LEAST / n } else { 1.0 / n };
            total
        });
        Self {
            chances: chances.collect(),
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.chances.is_empty()
    }

    fn chance(&self, emitter: usize) -> f64 {
        self.chances[emitter] - if emitter == 0 { 0.0 } else { self.chances[emitter - 1] }
    }

    /// An emitter and the direction from `from` in which it is asked.
    pub(super) fn sample(
        &self,
        windows: &[Window],
        lights: &[(Polygon, Rgb)],
        from: Vec3,
        choice: f64,
        u: [f64; 2],
    ) -> Option<(usize, Vec3)> {
        let emitter = self.chances.partition_point(|c| *c <= choice).min(self.chances.len() - 1);
        let below = if emitter == 0 { 0.0 } else { self.chances[emitter - 1] };
        let rest = ((choice - below) / self.chance(emitter)).clamp(0.0, 1.0);
        let to_point = |polygon: &Polygon| {
            let way = polygon.sample(u) - from;
            (way.length() > 0.0).then(|| way.unit())
        };
        let direction = match windows.get(emitter) {
            Some(window) if rest < BY_DIRECTION => -window.travel(window.distribution().sample(u)),
            Some(window) => to_point(window.polygon())?,
            None => to_point(&lights[emitter - windows.len()].0)?,
        };
        Some((emitter, direction))
    }

    /// Density (1/sr) with which an emitter is asked in a direction in which it is met at a distance (m).
    #[inline]
    pub(super) fn density(
        &self,
        windows: &[Window],
        lights: &[(Polygon, Rgb)],
        emitter: usize,
        direction: Vec3,
        distance: f64,
    ) -> f64 {
        let polygon = windows
            .get(emitter)
            .map_or_else(|| &lights[emitter - windows.len()].0, Window::polygon);
        let cos = -direction.dot(polygon.normal());
        if cos <= 0.0 {
            return 0.0;
        }
        let by_point = distance * distance / (polygon.area() * cos);
        let here = match windows.get(emitter) {
            Some(window) => {
                let by_direction = window.distribution().density(window.disk(-direction));
                BY_DIRECTION * by_direction + (1.0 - BY_DIRECTION) * by_point
            }
            None => by_point,
        };
        self.chance(emitter) * here
    }
}
