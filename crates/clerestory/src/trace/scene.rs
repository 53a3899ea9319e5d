//! A sample as paths see it: with as many bands as they carry.

use std::borrow::Cow;

use super::sample::Sample;
use crate::error::{Error, Result};
use crate::material::{Material, Medium};

/// Most bands of one run.
pub const MAX_BANDS: usize = 64;

/// A sample whose materials and media are filled up to the number of bands that paths carry. The bands too many carry nothing.
pub struct Scene<'a> {
    /// The sample itself.
    pub sample: &'a Sample,
    /// Its materials.
    pub materials: Cow<'a, [Material]>,
    /// Its media.
    pub media: Cow<'a, [Medium]>,
    /// Its least and greatest z (metres).
    pub depth: [f64; 2],
}

impl<'a> Scene<'a> {
    /// For paths of so many bands.
    pub fn new(sample: &'a Sample, bands: usize) -> Self {
        let same = sample.bands.len() == bands;
        Self {
            sample,
            materials: if same {
                Cow::Borrowed(&sample.materials)
            } else {
                sample.materials.iter().map(|m| m.padded(bands)).collect()
            },
            media: if same {
                Cow::Borrowed(&sample.media)
            } else {
                sample.media.iter().map(|m| m.padded(bands)).collect()
            },
            depth: sample.depth(),
        }
    }

    /// Number of bands of the sample.
    pub fn bands(&self) -> usize {
        self.sample.bands.len()
    }

    /// What a path carries first.
    pub fn weights<const N: usize>(&self) -> [f64; N] {
        std::array::from_fn(|b| if b < self.bands() { 1.0 } else { 0.0 })
    }
}

/// Calls a method that is generic over the number of bands with the next greater one that there is code for.
///
/// A number of its own for each count up to 4 costs nothing; from 5 on up to half of the bands that are carried may be idle,
/// which costs what their arithmetic costs: less than a fifth of the time for 5 bands as 8, since meeting the geometry is
/// most of the work.
macro_rules! with_bands {
    ($sample:expr, $self:ident.$method:ident($($argument:expr),*)) => {{
        let sample: &$crate::trace::Sample = $sample;
        match $crate::trace::scene::checked(sample)? {
            1 => $self.$method::<1>(&$crate::trace::scene::Scene::new(sample, 1), $($argument),*),
            2 => $self.$method::<2>(&$crate::trace::scene::Scene::new(sample, 2), $($argument),*),
            3 => $self.$method::<3>(&$crate::trace::scene::Scene::new(sample, 3), $($argument),*),
            4 => $self.$method::<4>(&$crate::trace::scene::Scene::new(sample, 4), $($argument),*),
            5..=8 => $self.$method::<8>(&$crate::trace::scene::Scene::new(sample, 8), $($argument),*),
            9..=16 => $self.$method::<16>(&$crate::trace::scene::Scene::new(sample, 16), $($argument),*),
            17..=32 => $self.$method::<32>(&$crate::trace::scene::Scene::new(sample, 32), $($argument),*),
            _ => $self.$method::<64>(&$crate::trace::scene::Scene::new(sample, 64), $($argument),*),
        }
    }};
}
pub(super) use with_bands;

/// Number of bands, if it can be traced: its geometry agrees on where its media are.
pub fn checked(sample: &Sample) -> Result<usize> {
    let media: Vec<[u16; 2]> = sample.surfaces.iter().map(|s| s.media).collect();
    for layer in &sample.layers {
        layer.check_media(&media)?;
    }
    match sample.bands.len() {
        0 => Err(Error::Missing("the sample has no bands (name at least one)".into())),
        n if n > MAX_BANDS => Err(Error::Unsupported(format!(
            "{n} bands in one run are more than {MAX_BANDS} (trace them in parts and merge the results)"
        ))),
        n => Ok(n),
    }
}
