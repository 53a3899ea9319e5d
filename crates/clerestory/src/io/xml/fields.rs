//! Fields of `<Material>` by our own names, sides and units.

use crate::bsdf::Metadata;
use crate::error::{Error, Result};

/// What a field holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Words.
    Text,
    /// Metres.
    Length,
    /// From 0 to 1.
    Fraction,
    /// 0 or more.
    Amount,
}

/// A field of `<Material>`.
#[derive(Debug)]
pub struct Field {
    /// Our name.
    pub name: &'static str,
    /// The files' names, the one to write first.
    elements: &'static [&'static str],
    /// What it holds.
    pub kind: Kind,
}

const fn field(name: &'static str, elements: &'static [&'static str], kind: Kind) -> Field {
    Field { name, elements, kind }
}

/// All fields that can be asked for and given.
pub const FIELDS: [Field; 12] = [
    field("name", &["Name"], Kind::Text),
    field("product_name", &["ProductName"], Kind::Text),
    field("manufacturer", &["Manufacturer"], Kind::Text),
    field("device_type", &["DeviceType"], Kind::Text),
    field("thickness_m", &["Thickness"], Kind::Length),
    field("width_m", &["Width"], Kind::Length),
    field("height_m", &["Height"], Kind::Length),
    field("emissivity_exterior", &["EmissivityFront"], Kind::Fraction),
    field("emissivity_interior", &["EmissivityBack"], Kind::Fraction),
    field("tir", &["TIR"], Kind::Fraction),
    field(
        "openness",
        &["PermeabilityFactor", "EffectiveOpennessFraction", "Openness"],
        Kind::Fraction,
    ),
    field("thermal_conductivity", &["ThermalConductivity"], Kind::Amount),
];

impl Field {
    /// By our name.
    pub fn named(name: &str) -> Result<&'static Self> {
        FIELDS.iter().find(|f| f.name == name).ok_or_else(|| {
            let names: Vec<&str> = FIELDS.iter().map(|f| f.name).collect();
            Error::Argument(format!("{name:?} is no metadata field (known: {})", names.join(", ")))
        })
    }

    /// Words of the field, if it is there and not empty.
    pub fn text<'m>(&self, metadata: &'m Metadata) -> Option<&'m str> {
        self.elements.iter().find_map(|e| metadata.material_text(e))
    }

    /// Number of the field: metres for a length.
    pub fn number(&self, metadata: &Metadata) -> Option<f64> {
        let value = match self.kind {
            Kind::Text => None,
            Kind::Length => metadata.material_length_m(self.elements[0]),
            Kind::Fraction | Kind::Amount => self.elements.iter().find_map(|e| metadata.material_number(e)),
        };
        value.filter(|v| v.is_finite())
    }

    /// Gives words.
    pub fn set_text(&self, metadata: &mut Metadata, text: &str) -> Result<()> {
        if self.kind != Kind::Text {
            return Err(Error::Argument(format!("{} is a number, not {text:?}", self.name)));
        }
        metadata.set_material(self.elements[0], text.trim(), None);
        Ok(())
    }

    /// Gives a number.
    pub fn set_number(&self, metadata: &mut Metadata, value: f64) -> Result<()> {
        let (sound, range) = match self.kind {
            Kind::Text => return Err(Error::Argument(format!("{} is words, not {value}", self.name))),
            Kind::Fraction => ((0.0..=1.0).contains(&value), "from 0 to 1"),
            Kind::Length | Kind::Amount => (value >= 0.0 && value.is_finite(), "of 0 or more"),
        };
        if !sound {
            return Err(Error::Argument(format!(
                "{} cannot be {value} (give a number {range})",
                self.name
            )));
        }
        // The name under which the file has it is kept.
        let element = self
            .elements
            .iter()
            .find(|e| metadata.material_text(e).is_some())
            .unwrap_or(&self.elements[0]);
        let unit = (self.kind == Kind::Length).then_some("Meter");
        metadata.set_material(element, &format!("{value}"), unit);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_come_back() {
        let mut m = Metadata::default();
        for field in &FIELDS {
            assert_eq!(field.text(&m), None);
            if field.kind == Kind::Text {
                field.set_text(&mut m, " some words ").unwrap();
                assert_eq!(field.text(&m), Some("some words"));
                assert!(field.set_number(&mut m, 0.5).is_err());
            } else {
                field.set_number(&mut m, 0.125).unwrap();
                assert_eq!(field.number(&m), Some(0.125));
                assert!(field.set_text(&mut m, "0.5").is_err());
                for wrong in [-0.1, f64::NAN, f64::INFINITY] {
                    assert!(field.set_number(&mut m, wrong).is_err(), "{} {wrong}", field.name);
                }
            }
        }
        assert!(Field::named("tir").unwrap().set_number(&mut m, 1.1).is_err());
        assert!(Field::named("TIR").is_err());
    }

    #[test]
    fn lengths_are_metres_and_openness_has_several_names() {
        let mut m = Metadata::default();
        m.set_material("Thickness", "12", Some("millimeter"));
        m.set_material("EffectiveOpennessFraction", "0.05", None);
        assert_eq!(Field::named("thickness_m").unwrap().number(&m), Some(0.012));
        let openness = Field::named("openness").unwrap();
        assert_eq!(openness.number(&m), Some(0.05));
        openness.set_number(&mut m, 0.1).unwrap();
        assert_eq!(m.material_text("EffectiveOpennessFraction"), Some("0.1"));
        assert_eq!(m.material_text("PermeabilityFactor"), None);
    }
}
