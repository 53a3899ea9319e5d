//! From a data set to a file's bytes. The same data set gives the same bytes; numbers have the fewest digits that give
//! the same value again.

use std::io::Write;
use std::sync::Arc;

use super::blocks::transposed;
use super::target::{Target, fit};
use super::{LAYER, WRITTEN_BY, metadata, names};
use crate::basis::Basis;
use crate::bsdf::{Band, Bsdf, Element, Matrix, Metadata, Model, Rank};
use crate::error::{Error, Result};

/// A data set as XML for a program, and notes on what it could not take.
///
/// # Errors
/// [`Error::Unsupported`] for models other than matrices and trees, or both in one data set; [`Error::Missing`] for
/// what the target program cannot do without.
pub fn write(bsdf: &Bsdf, target: Target) -> Result<(Vec<u8>, Vec<String>)> {
    let (bsdf, notes) = fit(bsdf, target)?;
    let structure = structure(&bsdf)?;
    let bases = Bases::of(&bsdf);
    let mut writer = Writer {
        out: Vec::new(),
        depth: 0,
    };
    writer.raw("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    writer.comment(&format!("{WRITTEN_BY} {}", env!("CARGO_PKG_VERSION")));
    for comment in &bsdf.metadata.comments {
        writer.comment(comment);
    }
    writer.raw(
        "<WindowElement xmlns=\"http://windows.lbl.gov\" xmlns:xsi=\"http://www.w3.org/2001/XMLSchema-instance\" \
         xsi:schemaLocation=\"http://windows.lbl.gov/BSDF-v1.4.xsd\">\n",
    );
    writer.depth = 1;
    let metadata = &bsdf.metadata;
    writer.leaf(
        "WindowElementType",
        metadata.element_type.as_deref().unwrap_or("System"),
    );
    if !others(metadata, "WindowElement").any(|e| e.name == "FileType") {
        writer.leaf("FileType", "BSDF");
    }
    writer.all(others(metadata, "WindowElement"))?;
    writer.open("Optical");
    writer.all(others(metadata, "WindowElement/Optical"))?;
    writer.open("Layer");
    writer.all(metadata.material.iter().chain(&metadata.geometry))?;
    writer.all(others(metadata, LAYER).filter(|e| e.name != "WavelengthData"))?;
    writer.open("DataDefinition");
    writer.leaf("IncidentDataStructure", structure);
    for (name, basis) in &bases.0 {
        writer.listing(name, basis);
    }
    writer.all(others(metadata, &format!("{LAYER}/DataDefinition")))?;
    writer.close("DataDefinition");
    let number = others(metadata, &format!("{LAYER}/WavelengthData"))
        .find(|e| e.name == "LayerNumber")
        .map_or("System", |e| e.text.as_str());
    for band in bsdf.bands().iter().filter(|b| b.components().next().is_some()) {
        writer.band(band, number, &bases);
    }
    writer.all(others(metadata, LAYER).filter(|e| e.name == "WavelengthData"))?;
    writer.close("Layer");
    writer.close("Optical");
    writer.close("WindowElement");
    Ok((writer.out, notes))
}

fn others<'m>(metadata: &'m Metadata, path: &str) -> impl Iterator<Item = &'m Element> {
    metadata.other.iter().filter(move |(p, _)| p == path).map(|(_, e)| e)
}

/// The one structure of all blocks.
fn structure(bsdf: &Bsdf) -> Result<&'static str> {
    let mut found = None;
    for (.., model) in bsdf.bands().iter().flat_map(Band::components) {
        let this = match &**model {
            Model::Tree(tree) if tree.rank() == Rank::Isotropic => "TensorTree3",
            Model::Tree(_) => "TensorTree4",
            _ => "Columns",
        };
        if *found.get_or_insert(this) != this {
            return Err(Error::Unsupported(
                "an XML file holds either matrices or tensor trees of one rank (convert all models to one kind)".into(),
            ));
        }
    }
    found.ok_or_else(|| Error::Missing("the data set has no models to write".into()))
}

/// The bases of all matrices, under names that tell them apart.
struct Bases(Vec<(String, Arc<Basis>)>);

impl Bases {
    fn of(bsdf: &Bsdf) -> Self {
        let mut bases = Self(Vec::new());
        for (.., model) in bsdf.bands().iter().flat_map(Band::components) {
            if let Model::Matrix(matrix) = &**model {
                bases.add(matrix.incident());
                bases.add(matrix.outgoing());
            }
        }
        bases
    }

    fn find(&self, basis: &Basis) -> Option<&str> {
        // Same patches and same nominal angles.
        self.0
            .iter()
            .find(|(_, b)| b.rings() == basis.rings())
            .map(|(n, _)| n.as_str())
    }

    fn add(&mut self, basis: &Arc<Basis>) {
        if self.find(basis).is_some() {
            return;
        }
        let plain = if basis.name().trim().is_empty() {
            "unnamed"
        } else {
            basis.name().trim()
        };
        let mut name = plain.to_owned();
        let mut number = 2;
        while self.0.iter().any(|(n, _)| n.eq_ignore_ascii_case(&name)) {
            name = format!("{plain} ({number})");
            number += 1;
        }
        self.0.push((name, basis.clone()));
    }
}

struct Writer {
    out: Vec<u8>,
    depth: usize,
}

impl Writer {
    fn raw(&mut self, text: &str) {
        self.out.extend_from_slice(text.as_bytes());
    }

    fn indent(&mut self) {
        self.out.extend(std::iter::repeat_n(b'\t', self.depth));
    }

    fn open(&mut self, name: &str) {
        self.indent();
        self.raw(&format!("<{name}>\n"));
        self.depth += 1;
    }

    fn close(&mut self, name: &str) {
        self.depth -= 1;
        self.indent();
        self.raw(&format!("</{name}>\n"));
    }

    fn leaf(&mut self, name: &str, text: &str) {
        self.indent();
        self.raw(&format!("<{name}>"));
        self.text(text);
        self.raw(&format!("</{name}>\n"));
    }

    fn comment(&mut self, text: &str) {
        let mut text: String = text.chars().filter(|&c| metadata::is_allowed(c)).collect();
        // Two hyphens would end the comment for a strict parser.
        while text.contains("--") {
            text = text.replace("--", "- -");
        }
        self.indent();
        self.raw(&format!("<!-- {} -->\n", text.trim()));
    }

    fn text(&mut self, text: &str) {
        for c in text.chars().filter(|&c| metadata::is_allowed(c)) {
            match c {
                '&' => self.raw("&amp;"),
                '<' => self.raw("&lt;"),
                '>' => self.raw("&gt;"),
                _ => self.raw(c.encode_utf8(&mut [0; 4])),
            }
        }
    }

    fn all<'e>(&mut self, elements: impl Iterator<Item = &'e Element>) -> Result<()> {
        for element in elements {
            self.element(element)?;
        }
        Ok(())
    }

    fn element(&mut self, element: &Element) -> Result<()> {
        let is_name = |name: &str| {
            name.starts_with(|c: char| c.is_alphabetic() || c == '_')
                && name
                    .chars()
                    .all(|c| c.is_alphanumeric() || matches!(c, '_' | '-' | '.'))
        };
        if let Some(wrong) = std::iter::once(&element.name)
            .chain(element.attributes.iter().map(|(n, _)| n))
            .find(|n| !is_name(n))
        {
            return Err(Error::Argument(format!(
                "{wrong:?} cannot be the name of an XML element or attribute"
            )));
        }
        self.indent();
        self.raw(&format!("<{}", element.name));
        for (name, value) in &element.attributes {
            self.raw(&format!(" {name}=\""));
            for c in value.chars().filter(|&c| metadata::is_allowed(c)) {
                match c {
                    '"' => self.raw("&quot;"),
                    '\n' | '\r' | '\t' => self.raw(&format!("&#{};", u32::from(c))),
                    _ => self.text(c.encode_utf8(&mut [0; 4])),
                }
            }
            self.raw("\"");
        }
        self.raw(">");
        self.text(&element.text);
        if !element.children.is_empty() {
            self.raw("\n");
            self.depth += 1;
            self.all(element.children.iter())?;
            self.depth -= 1;
            self.indent();
        }
        self.raw(&format!("</{}>\n", element.name));
        Ok(())
    }

    fn listing(&mut self, name: &str, basis: &Basis) {
        self.open("AngleBasis");
        self.leaf("AngleBasisName", name);
        for ring in basis.rings() {
            self.open("AngleBasisBlock");
            self.leaf("Theta", &ring.nominal_deg.to_string());
            self.open("ThetaBounds");
            self.leaf("LowerTheta", &ring.lower_deg.to_string());
            self.leaf("UpperTheta", &ring.upper_deg.to_string());
            self.close("ThetaBounds");
            self.leaf("nPhis", &ring.count.to_string());
            self.close("AngleBasisBlock");
        }
        self.close("AngleBasis");
    }

    /// One `<WavelengthData>` a block, as WINDOW writes them: LBNL's parser reads only the first block of each.
    fn band(&mut self, band: &Band, layer_number: &str, bases: &Bases) {
        let (unit, wavelength) = names::band_in_file(&band.name);
        for (side, scatter, model) in band.components() {
            self.open("WavelengthData");
            self.leaf("LayerNumber", layer_number);
            self.indent();
            self.raw(&format!("<Wavelength unit=\"{unit}\">"));
            self.text(&wavelength);
            self.raw("</Wavelength>\n");
            for (name, spectrum) in [
                ("SourceSpectrum", &band.source_spectrum),
                ("DetectorSpectrum", &band.detector_spectrum),
            ] {
                if let Some(spectrum) = spectrum {
                    self.leaf(name, spectrum);
                }
            }
            self.open("WavelengthDataBlock");
            self.leaf("WavelengthDataDirection", names::direction(side, scatter));
            self.values(model, names::data_type(scatter), bases);
            self.close("WavelengthDataBlock");
            self.close("WavelengthData");
        }
    }

    /// Bases, data type and values of a model.
    fn values(&mut self, model: &Model, data_type: &str, bases: &Bases) {
        match model {
            Model::Matrix(matrix) => {
                for (element, basis) in [
                    ("ColumnAngleBasis", matrix.incident()),
                    ("RowAngleBasis", matrix.outgoing()),
                ] {
                    self.leaf(element, bases.find(basis).unwrap_or_default());
                }
                self.leaf("ScatteringDataType", data_type);
                self.raw("<ScatteringData>\n");
                self.matrix(matrix);
                self.raw("</ScatteringData>\n");
            }
            Model::Tree(tree) => {
                self.leaf("AngleBasis", names::TREE_BASIS);
                self.leaf("ScatteringDataType", data_type);
                self.raw("<ScatteringData>\n");
                tree.write_text(&mut self.out);
                self.raw("\n</ScatteringData>\n");
            }
            // Other models were refused when the data set was fitted to its target.
            _ => {}
        }
    }

    /// Values as Columns: a line an outgoing patch. A comma behind each, also at the ends of lines, since LBNL's parser
    /// does not take a line end alone for a separator.
    fn matrix(&mut self, matrix: &Matrix) {
        let (n_in, n_out) = (matrix.incident().len(), matrix.outgoing().len());
        for (k, &value) in transposed(matrix.values(), n_in, n_out).iter().enumerate() {
            if k > 0 {
                self.raw(if k.is_multiple_of(n_in) { ",\n" } else { ", " });
            }
            self.number(value);
        }
        self.out.push(b'\n');
    }

    fn number(&mut self, value: f64) {
        let size = value.abs();
        let written = if value == 0.0 || (1e-5..1e16).contains(&size) {
            write!(self.out, "{value}")
        } else {
            write!(self.out, "{value:e}")
        };
        // Writing to memory cannot fail.
        written.expect("memory takes all bytes");
    }
}
