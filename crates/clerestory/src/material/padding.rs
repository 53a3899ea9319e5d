//! Materials and media with more bands than they were made for. Paths carry 1, 2, 3, 4, 8, 16, 32 or 64 bands; the last ones may
//! be idle: they carry nothing, and have the values of the last band that does.

use super::{Ggx, Glossy, Lobe, Material, Measured, Medium, Mixture};

/// The last one again and again.
fn more<T: Clone>(values: &[T], bands: usize) -> Vec<T> {
    let last = values.last().into_iter().cycle();
    values.iter().chain(last).take(bands).cloned().collect()
}

impl Medium {
    /// With more bands, which are as the last one.
    #[must_use]
    pub fn padded(&self, bands: usize) -> Self {
        Self {
            index: more(&self.index, bands),
            absorption: more(&self.absorption, bands),
            scattering: more(&self.scattering, bands),
            asymmetry: more(&self.asymmetry, bands),
        }
    }
}

impl Material {
    /// With more bands, which are as the last one.
    #[must_use]
    pub fn padded(&self, bands: usize) -> Self {
        match self {
            Self::Black | Self::Interface | Self::RoughInterface(_) => self.clone(),
            Self::Mirror { reflectance } => Self::Mirror {
                reflectance: more(reflectance, bands),
            },
            Self::Lambertian {
                reflectance,
                transmittance,
            } => Self::Lambertian {
                reflectance: more(reflectance, bands),
                transmittance: more(transmittance, bands),
            },
            Self::Glossy(glossy) => Self::Glossy(Box::new(Glossy {
                colour: more(&glossy.colour, bands),
                ..(**glossy).clone()
            })),
            Self::Pane(slabs) => Self::Pane(more(slabs, bands)),
            Self::Ggx(ggx) => Self::Ggx(Box::new(Ggx {
                reflectance: more(&ggx.reflectance, bands),
                ..**ggx
            })),
            Self::Lobe(lobe) => Self::Lobe(Box::new(Lobe {
                values: lobe.values.each_ref().map(|v| more(v, bands)),
                ..(**lobe).clone()
            })),
            Self::Measured(measured) => Self::Measured(Box::new(Measured {
                lobes: measured.lobes.padded(bands),
                components: measured.components.each_ref().map(|c| more(c, bands)),
                ..(**measured).clone()
            })),
            Self::Mixture(mixture) => Self::Mixture(Box::new(Mixture {
                parts: mixture.parts.iter().map(|part| part.padded(bands)).collect(),
                ..(**mixture).clone()
            })),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_material_has_as_many_bands_as_are_asked_for() {
        let (r, t) = ([0.2, 0.3, 0.4], [0.1, 0.15, 0.2]);
        let values = super::super::LobeValues {
            reflectance: &r,
            transmittance: &t,
            diffuse_reflectance: &t,
            diffuse_transmittance: &t,
        };
        let all = vec![
            Material::lambertian(&r, &t),
            Material::mirror(&r),
            Material::plastic(&r, 0.1, 0.1),
            Material::trans(&r, 0.1, 0.1, 0.5, 0.5),
            Material::glass(&r, 1.52),
            Material::ggx(&r, 0.2),
            Material::gaussian(0.1, values),
        ];
        for material in all {
            let material = material.expect("is sound");
            let mixed = Material::mixture(vec![(0.5, material.clone())]).expect("is sound");
            for one in [material, mixed] {
                assert_eq!(one.bands(), Some(3));
                assert_eq!(one.padded(8).bands(), Some(8));
            }
        }
        assert_eq!(Medium::air(3).padded(8).bands(), 8);
        assert_eq!(more(&[1, 2], 4), [1, 2, 2, 2]);
    }
}
