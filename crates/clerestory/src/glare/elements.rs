//! Glare of a field of view whose parts stay where they are while their luminance changes, hour by hour.

use super::cluster::Neighbourhood;
use super::indices::{Field, Indices, Light, Source, place, summarise};
use super::settings::{Settings, Threshold};
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::picture::Camera;

/// Parts of a field of view.
#[derive(Debug, Clone)]
pub struct Elements {
    camera: Camera,
    /// Towards each, in the world.
    directions: Vec<Vec3>,
    /// The same in the camera's frame.
    local: Vec<[f64; 3]>,
    /// (sr)
    solid_angles: Vec<f64>,
    near: Neighbourhood,
    /// Choices of the evaluation.
    settings: Settings,
}

#[derive(Clone, Default)]
struct Gathered {
    omega: f64,
    flux: f64,
    illuminance: f64,
    largest: f64,
    middle: Vec3,
    elements: usize,
}

impl Elements {
    /// Those before the eye, of directions and solid angles (sr); the others count nothing.
    pub fn new(camera: Camera, directions: &[Vec3], solid_angles: &[f64], settings: &Settings) -> Result<Self> {
        settings.check()?;
        if directions.len() != solid_angles.len() {
            return Err(Error::Argument(format!(
                "{} directions do not go with {} solid angles",
                directions.len(),
                solid_angles.len()
            )));
        }
        let frame = camera.frame();
        let local = |d: &Vec3| frame.map(|axis| d.unit().dot(axis));
        let local: Vec<[f64; 3]> = directions.iter().map(local).collect();
        Ok(Self {
            camera,
            near: Neighbourhood::new(&local, 0.5 * settings.search_radius),
            directions: directions.iter().map(|d| d.unit()).collect(),
            local,
            solid_angles: solid_angles.to_vec(),
            settings: settings.clone(),
        })
    }

    /// Sources among the elements by their luminances (cd/m²), and lights that are sources of their own, rated at an illuminance of the eye
    /// (lx).
    pub fn rate(
        &self,
        luminances: &[f32],
        lights: &[Light],
        vertical_illuminance: f64,
    ) -> Result<(Vec<Source>, Indices)> {
        let settings = &self.settings;
        let Threshold::Absolute(threshold) = settings.threshold else {
            return Err(Error::Unsupported(
                "a threshold by the mean of a picture needs a picture (give a luminance in cd/m²)".into(),
            ));
        };
        let above = |limit: f64| -> Vec<u32> {
            let bright = |k: &u32| {
                let k = *k as usize;
                f64::from(luminances[k]) > limit && self.local[k][2] > 0.0 && self.solid_angles[k] > 0.0
            };
            (0..luminances.len() as u32).filter(bright).collect()
        };
        let peak = settings.peaks.unwrap_or(f64::INFINITY);
        let (peaks, rest): (Vec<u32>, Vec<u32>) = above(threshold)
            .into_iter()
            .partition(|&k| f64::from(luminances[k as usize]) > peak);
        // Sources are joined before peaks are cut out of them.
        let all: Vec<u32> = rest.iter().chain(&peaks).copied().collect();
        let mut sources = self.gather(&all, rest.len(), luminances, false);
        sources.extend(self.gather(&peaks, peaks.len(), luminances, true));
        for light in lights {
            let direction = light.direction.unit();
            let local = self.camera.frame().map(|axis| direction.dot(axis));
            if local[2] > 0.0 && light.luminance > threshold {
                sources.push(self.source(
                    direction,
                    local,
                    &Gathered {
                        omega: light.solid_angle,
                        flux: light.luminance * light.solid_angle,
                        illuminance: light.luminance * light.solid_angle * local[2],
                        largest: light.luminance,
                        ..Gathered::default()
                    },
                    light.luminance > peak,
                ));
            }
        }
        let field = Field {
            vertical_illuminance,
            mean_luminance: f64::NAN,
            mean_background: f64::NAN,
        };
        let indices = summarise(&sources, &field, settings)?;
        Ok((sources, indices))
    }

    /// Sources of the first `counted` of the elements, joined over all of them.
    fn gather(&self, chosen: &[u32], counted: usize, luminances: &[f32], peak: bool) -> Vec<Source> {
        let numbers = self.near.groups(&self.local, chosen);
        let mut gathered = vec![Gathered::default(); numbers.iter().max().map_or(0, |n| *n as usize + 1)];
        for (&k, &number) in chosen[..counted].iter().zip(&numbers) {
            let (k, sum) = (k as usize, &mut gathered[number as usize]);
            let (luminance, omega) = (f64::from(luminances[k]), self.solid_angles[k]);
            let (world, local) = (self.directions[k], self.local[k]);
            sum.omega += omega;
            sum.flux += luminance * omega;
            sum.illuminance += luminance * omega * local[2];
            sum.largest = sum.largest.max(luminance);
            sum.middle += world * (luminance * omega);
            sum.elements += 1;
        }
        let frame = self.camera.frame();
        gathered
            .iter()
            .filter(|sum| sum.elements > 0)
            .map(|sum| {
                let direction = sum.middle.unit();
                let local = frame.map(|axis| direction.dot(axis));
                self.source(direction, local, sum, peak)
            })
            .collect()
    }

    fn source(&self, direction: Vec3, local: [f64; 3], sum: &Gathered, peak: bool) -> Source {
        let (sigma, position_index) = place(&self.camera, &self.settings, local);
        Source {
            direction,
            luminance: sum.flux / sum.omega,
            largest: sum.largest,
            solid_angle: sum.omega,
            illuminance: sum.illuminance,
            sigma,
            position_index,
            pixels: sum.elements,
            peak,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Lens, evaluate, rate};
    use super::*;
    use crate::picture::View;

    const SIZE: usize = 300;

    fn camera() -> Camera {
        Camera::new(View::fisheye(Vec3::default(), Vec3::new(0.0, 1.0, 0.0))).unwrap()
    }

    #[test]
    fn elements_that_are_a_pictures_pixels_rate_as_it_does() {
        let camera = camera();
        let lens = Lens::new(camera, SIZE, SIZE).unwrap();
        let mut picture = vec![80.0_f32; SIZE * SIZE];
        for row in 80..120 {
            picture[row * SIZE + 90..row * SIZE + 130].fill(6000.0);
            picture[row * SIZE + 200..row * SIZE + 230].fill(2500.0);
        }
        picture[100 * SIZE + 110] = 4e6;
        let expected = evaluate(&picture, &lens, &Settings::default()).unwrap();
        let pixels: Vec<usize> = (0..SIZE * SIZE).filter(|&k| lens.solid_angles()[k] > 0.0).collect();
        let directions: Vec<Vec3> = pixels
            .iter()
            .map(|&k| camera.world(lens.direction(k).unwrap()))
            .collect();
        let omegas: Vec<f64> = pixels.iter().map(|&k| lens.solid_angles()[k]).collect();
        let luminances: Vec<f32> = pixels.iter().map(|&k| picture[k]).collect();
        let elements = Elements::new(camera, &directions, &omegas, &Settings::default()).unwrap();
        let illuminance = expected.indices.vertical_illuminance;
        let (sources, found) = elements.rate(&luminances, &[], illuminance).unwrap();
        assert_eq!(sources.len(), expected.sources.len());
        for (a, b) in [
            (found.dgp, expected.indices.dgp),
            (found.dgi, expected.indices.dgi),
            (found.ugr, expected.indices.ugr),
        ] {
            assert!((a / b - 1.0).abs() < 2e-3, "{a} {b}");
        }
    }

    #[test]
    fn a_light_of_its_own_is_rated_as_a_known_source() {
        let sun = Light {
            direction: Vec3::new(0.3, 0.8, 0.4),
            luminance: 1e8,
            solid_angle: 6.8e-5,
        };
        let settings = Settings::default();
        let elements = Elements::new(camera(), &[], &[], &settings).unwrap();
        let (sources, found) = elements.rate(&[], &[sun], 9000.0).unwrap();
        let field = Field {
            vertical_illuminance: 9000.0,
            mean_luminance: f64::NAN,
            mean_background: f64::NAN,
        };
        let (_, expected) = rate(&[sun], &camera(), &field, &settings).unwrap();
        assert!(sources[0].peak);
        assert_eq!((found.dgp, found.dgi), (expected.dgp, expected.dgi));
        let mean = Settings {
            threshold: Threshold::TimesMean(5.0),
            ..settings
        };
        let elements = Elements::new(camera(), &[], &[], &mean).unwrap();
        assert!(elements.rate(&[], &[sun], 9000.0).is_err());
    }
}
