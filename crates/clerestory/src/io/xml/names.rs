//! The files' words for bands and directions.

use crate::direction::{Scatter, Side};

/// The only basis of tensor trees.
pub(super) const TREE_BASIS: &str = "LBNL/Shirley-Chiu";

/// Bands by our name and by the files' name.
const BANDS: [(&str, &str); 9] = [
    ("visible", "Visible"),
    ("solar", "Solar"),
    ("nir", "NIR"),
    ("thermal", "FIR"),
    ("uv", "UV"),
    ("cie-x", "CIE-X"),
    ("cie-z", "CIE-Z"),
    ("cie-u", "CIE-u"),
    ("cie-v", "CIE-v"),
];

/// Our name of a band, and what is odd about the file's. None for a wavelength in a unit that is not known.
pub(super) fn band_from_file(text: &str, unit: &str) -> (Option<String>, Option<String>) {
    if let Ok(value) = text.trim_end_matches("nm").trim_end().parse::<f64>() {
        let unit = unit.to_ascii_lowercase();
        let nanometres = match unit.as_str() {
            "" | "integral" | "nm" | "nanometer" | "nanometers" | "nanometre" | "nanometres" => value,
            "micron" | "microns" | "micrometer" | "micrometers" | "micrometre" | "micrometres" => value * 1000.0,
            _ => f64::NAN,
        };
        let sound = nanometres.is_finite() && nanometres > 0.0;
        return (sound.then(|| format!("{nanometres} nm")), None);
    }
    for (name, in_files) in BANDS {
        if text.eq_ignore_ascii_case(in_files) || text.eq_ignore_ascii_case(name) {
            let odd = text != in_files && name != "thermal";
            return (
                Some(name.into()),
                odd.then(|| format!("the band is written {text:?} instead of {in_files:?}")),
            );
        }
    }
    let name = text.to_lowercase();
    let odd = format!("band {text:?} is not one of the usual ones");
    (Some(name), Some(odd))
}

/// Unit and text of a `<Wavelength>`.
pub(super) fn band_in_file(name: &str) -> (&'static str, String) {
    if let Some(value) = name.strip_suffix(" nm").filter(|v| v.parse::<f64>().is_ok()) {
        return ("Nanometer", value.to_owned());
    }
    let in_files = BANDS.iter().find(|(n, _)| *n == name).map_or(name, |(_, f)| f);
    ("Integral", in_files.to_owned())
}

/// What a file calls light from a side, transmitted or reflected: its front is the exterior.
pub(super) fn direction(side: Side, scatter: Scatter) -> &'static str {
    match (scatter, side) {
        (Scatter::Transmission, Side::Exterior) => "Transmission Front",
        (Scatter::Transmission, Side::Interior) => "Transmission Back",
        (Scatter::Reflection, Side::Exterior) => "Reflection Front",
        (Scatter::Reflection, Side::Interior) => "Reflection Back",
    }
}

/// What a file calls the values of a direction.
pub(super) fn data_type(scatter: Scatter) -> &'static str {
    match scatter {
        Scatter::Transmission => "BTDF",
        Scatter::Reflection => "BRDF",
    }
}

/// The reverse of [`direction`].
pub(super) fn direction_from_file(text: &str) -> Option<(Side, Scatter)> {
    Side::BOTH
        .into_iter()
        .flat_map(|side| Scatter::BOTH.map(|scatter| (side, scatter)))
        .find(|&(side, scatter)| text.eq_ignore_ascii_case(direction(side, scatter)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_come_back_from_their_file_names() {
        for name in [
            "visible", "solar", "nir", "thermal", "uv", "cie-x", "cie-u", "550 nm", "555.5 nm",
        ] {
            let (unit, text) = band_in_file(name);
            assert_eq!(band_from_file(&text, unit), (Some(name.into()), None), "{name}");
        }
        let (unit, text) = band_in_file("photopic");
        assert_eq!(band_from_file(&text, unit).0.as_deref(), Some("photopic"));
    }

    #[test]
    fn wavelengths_are_in_nanometres() {
        assert_eq!(band_from_file("0.55", "Micrometer").0.unwrap(), "550 nm");
        assert_eq!(band_from_file("550 nm", "").0.unwrap(), "550 nm");
        assert_eq!(band_from_file("550", "furlong").0, None);
        assert_eq!(band_from_file("-550", "Nanometer").0, None);
        assert_eq!(band_from_file("nan", "Nanometer").0, None);
    }

    #[test]
    fn lower_case_is_odd() {
        let (name, odd) = band_from_file("solar", "Integral");
        assert_eq!(name.unwrap(), "solar");
        assert!(odd.unwrap().contains("\"Solar\""));
        assert_eq!(band_from_file("VISIBLE", "Integral").0.unwrap(), "visible");
    }

    #[test]
    fn front_is_the_exterior() {
        assert_eq!(
            direction_from_file("transmission front"),
            Some((Side::Exterior, Scatter::Transmission))
        );
        assert_eq!(
            direction_from_file("Reflection Back"),
            Some((Side::Interior, Scatter::Reflection))
        );
        assert_eq!(direction_from_file("Transmission"), None);
    }
}
