//! Many skies at once: columns of a sky matrix.

use rayon::prelude::*;

use super::patches::{Part, SkyPatches, SunPatches, Value};
use super::perez::Supply;
use super::{Moment, Settings, Sky, photometric};
use crate::error::{Error, Result};
use crate::progress::Progress;

/// What a column is made from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Step {
    /// When.
    pub moment: Moment,
    /// Light of sun and sky.
    pub supply: Supply,
}

impl SkyPatches {
    /// Perez's skies of many steps: radiance (W/(m² sr), R, G and B by their share of luminance) of ground and patches, one
    /// step after the other.
    ///
    /// An error names the number of its step, from 0.
    pub fn columns(
        &self,
        steps: &[Step],
        settings: &Settings,
        part: Part,
        sun: SunPatches,
        value: Value,
        progress: &Progress,
    ) -> Result<Vec<f32>> {
        let samples = self.samples(value);
        let mut made = vec![0.0; steps.len() * self.len()];
        progress.expect(steps.len());
        made.par_chunks_mut(self.len())
            .zip(steps)
            .enumerate()
            .try_for_each(|(number, (column, step))| {
                let sky = Sky::perez_for_patches(&step.moment, step.supply, settings);
                let radiances = sky
                    .and_then(|sky| self.radiances_at(&sky, part, sun, &samples))
                    .map_err(|error| Error::Argument(format!("step {number}: {error}")))?;
                for (value, radiance) in column.iter_mut().zip(radiances) {
                    *value = photometric(radiance) as f32;
                }
                progress.step()
            })?;
        Ok(made)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sky::SunPosition;

    fn step(altitude: f64, diffuse: f64) -> Step {
        Step {
            moment: Moment {
                sun: SunPosition::from_degrees(altitude, 140.0).unwrap(),
                day: 80,
                dew_point: 8.0,
            },
            supply: Supply::Irradiance {
                direct_normal: 500.0,
                diffuse_horizontal: diffuse,
            },
        }
    }

    #[test]
    fn columns_are_skies_one_by_one() {
        let patches = SkyPatches::reinhart(2).unwrap();
        let steps = [step(12.0, 80.0), step(50.0, 200.0)];
        let (settings, sun) = (Settings::default(), SunPatches::Spread);
        let made = patches
            .columns(&steps, &settings, Part::All, sun, Value::Mean, &Progress::default())
            .unwrap();
        for (column, step) in made.chunks(patches.len()).zip(steps) {
            let sky = Sky::perez(&step.moment, step.supply, &settings).unwrap();
            let alone = patches.radiances(&sky, Part::All, sun, Value::Mean).unwrap();
            for (value, radiance) in column.iter().zip(alone) {
                assert!((f64::from(*value) / radiance[1] - 1.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn a_faulty_step_is_named() {
        let patches = SkyPatches::reinhart(1).unwrap();
        let steps = [step(12.0, 80.0), step(12.0, -1.0)];
        let error = patches
            .columns(
                &steps,
                &Settings::default(),
                Part::All,
                SunPatches::Spread,
                Value::Centre,
                &Progress::default(),
            )
            .unwrap_err();
        assert!(error.to_string().contains("step 1"), "{error}");
    }
}
