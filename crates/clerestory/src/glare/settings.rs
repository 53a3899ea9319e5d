//! Choices of a glare evaluation.

use super::position::PositionIndex;
use crate::error::{Error, Result};
use crate::picture::colour::LUMINANCE;

/// From which luminance a pixel belongs to a source.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Threshold {
    /// This luminance (cd/m²).
    Absolute(f64),
    /// So many times the mean luminance of the picture.
    TimesMean(f64),
    /// So many times the mean luminance of the task area.
    TimesTask(f64),
}

/// A cone about a point of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Task {
    /// Pixel from the left.
    pub x: f64,
    /// Pixel from the bottom.
    pub y: f64,
    /// Full opening angle (radians).
    pub angle: f64,
}

/// What counts as the luminance of the background.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Background {
    /// (E_v − E_direct)/π, as the CIE has it.
    WithoutSources,
    /// Mean of the pixels outside of the sources by solid angle.
    Mean,
    /// E_v/π.
    Illuminance,
}

/// Choices of a glare evaluation; the default is that of `evalglare` 3.06.
#[derive(Debug, Clone, PartialEq)]
pub struct Settings {
    /// Pixels above it are sources.
    pub threshold: Threshold,
    /// Task area, if one is given.
    pub task: Option<Task>,
    /// Pixels whose centres are not further apart than half of this angle (radians) are one source.
    pub search_radius: f64,
    /// Pixels that a source surrounds belong to it.
    pub smoothing: bool,
    /// Pixels above this luminance (cd/m²) become sources of their own; None for none.
    pub peaks: Option<f64>,
    /// What the background is.
    pub background: Background,
    /// How the place of a source counts.
    pub position_index: PositionIndex,
    /// Lowers the daylight glare probability where E_v is below 1000 lx.
    pub low_light: bool,
    /// Age of the person (years) for the correction that old releases had; None for none.
    pub age: Option<f64>,
    /// A measured illuminance at the eye (lx), for the daylight glare probability.
    pub vertical_illuminance: Option<f64>,
    /// Shares of the channels in the luminance of a picture that names no primaries.
    pub luminance_weights: [f64; 3],
}

/// Radiance's primaries with a white of exactly 1/3 and 1/3, by which `evalglare` weights channels (seen from runs of 3.06).
const WHITE_OF_THIRDS: [f64; 3] = [0.265_105_814, 0.670_105_815, 0.064_788_356];

impl Default for Settings {
    fn default() -> Self {
        Self {
            threshold: Threshold::Absolute(2000.0),
            task: None,
            search_radius: 0.2,
            smoothing: false,
            peaks: Some(50_000.0),
            background: Background::WithoutSources,
            position_index: PositionIndex::GuthIwata,
            low_light: false,
            age: None,
            vertical_illuminance: None,
            luminance_weights: WHITE_OF_THIRDS,
        }
    }
}

impl Settings {
    /// Names that [`Settings::preset`] knows.
    pub const PRESETS: [&str; 3] = ["evalglare-3.06", "evalglare-2.10", "evalglare-1.x"];

    /// The choices of a program's release. They are certain for 3.06, which was run; for 2.10 they follow the program's change
    /// log and manual page (2.05 made 2000 cd/m² and the CIE's background the defaults; 2.10 brought the option `-C` for
    /// corrections), and that the low-light correction still was on by default is what manuals say, not a run. Releases 1.16
    /// to 1.31 took five times the task's or the picture's mean and the mean background.
    pub fn preset(name: &str) -> Result<Self> {
        match name {
            "evalglare-3.06" => Ok(Self::default()),
            "evalglare-2.10" => Ok(Self {
                low_light: true,
                ..Self::default()
            }),
            "evalglare-1.x" => Ok(Self {
                threshold: Threshold::TimesMean(5.0),
                background: Background::Mean,
                low_light: true,
                ..Self::default()
            }),
            _ => Err(Error::Argument(format!(
                "the preset {name:?} is not known (give {})",
                Self::PRESETS.join(", ")
            ))),
        }
    }

    /// Shares of the channels by Radiance's own primaries, for those who prefer them.
    pub const RADIANCE_WEIGHTS: [f64; 3] = LUMINANCE;

    /// Refuses what makes no sense.
    pub(super) fn check(&self) -> Result<()> {
        let positive = [
            ("threshold", self.threshold.value()),
            ("search radius", self.search_radius),
            ("limit of peaks", self.peaks.unwrap_or(1.0)),
            ("angle of the task", self.task.map_or(1.0, |t| t.angle)),
            ("vertical illuminance", self.vertical_illuminance.unwrap_or(1.0)),
        ];
        for (name, value) in positive {
            if !(value.is_finite() && value > 0.0) {
                return Err(Error::Argument(format!(
                    "the {name} is {value} (give a positive number)"
                )));
            }
        }
        if self.search_radius > std::f64::consts::PI {
            return Err(Error::Argument(format!(
                "the search radius {} is more than π (give an angle in radians, such as 0.2)",
                self.search_radius
            )));
        }
        if let Some(age) = self.age
            && !(0.0..=120.0).contains(&age)
        {
            return Err(Error::Argument(format!(
                "the age {age} is not 0 to 120 years (give years)"
            )));
        }
        if matches!(self.threshold, Threshold::TimesTask(_)) && self.task.is_none() {
            return Err(Error::Argument(
                "the threshold is a factor of the task's luminance, but there is no task area (give one)".into(),
            ));
        }
        Ok(())
    }
}

impl Threshold {
    fn value(self) -> f64 {
        match self {
            Self::Absolute(v) | Self::TimesMean(v) | Self::TimesTask(v) => v,
        }
    }
}
