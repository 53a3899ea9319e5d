//! From a file's bytes to a data set.

use std::collections::HashSet;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, OnceLock};

use super::basis::Bases;
use super::blocks::{Block, Parsed, Shape};
use super::metadata::{Decoder, Encoding, check_material, refuse_wide};
use super::scan::{Document, Node, scan, shortened};
use super::{Faults, LAYER, WRITTEN_BY, names, place};
use crate::basis::Basis;
use crate::bsdf::{Band, Bsdf, Element, Metadata, Model, Rank};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};
use crate::io::{counted, gzip};

/// What a person knows of a file that does not say it, or says it wrongly.
#[derive(Debug, Clone, Default)]
pub struct Hints {
    /// Side that the light comes from, for blocks that do not tell.
    pub side: Option<Side>,
    /// Transmission or reflection, for blocks that do not tell.
    pub scatter: Option<Scatter>,
    /// Incident and outgoing basis, wherever the count of values fits it, and for unknown names.
    pub basis: Option<Arc<Basis>>,
    /// Band of blocks that do not name one.
    pub band: Option<String>,
}

/// Reads BSDF XML, plain or gzip.
///
/// # Errors
/// [`Error::Format`], with line and element, if the file is damaged or could mean two things that the hints do not decide.
pub fn read(bytes: &[u8], hints: &Hints) -> Result<Bsdf> {
    let bytes = gzip::inflate(bytes, |head| {
        refuse_wide(head)?;
        if memchr::memmem::find(head, b"WindowElement").is_some() {
            Ok(())
        } else {
            Err(Error::format(
                "line 1",
                "no <WindowElement> at its start: this is not a BSDF XML file",
                "give a file of WINDOW, Radiance or genBSDF",
            ))
        }
    })?;
    refuse_wide(&bytes)?;
    let document = scan(&bytes, "WindowElement")?;
    let mut faults = Faults::new(&bytes);
    if let Some(at) = document.text_before {
        faults.warn(at, "", "text stands before the XML; left out");
    }
    if let Some(at) = document.text_behind {
        faults.warn(at, "", "text stands behind </WindowElement>; left out");
    }
    let encoding = Encoding::of(&bytes, document.encoding, &mut faults);
    let mut reader = Reader {
        bytes: &bytes,
        hints,
        decoder: Decoder {
            encoding,
            faults: &mut faults,
        },
        metadata: Metadata::default(),
        bands: Vec::new(),
        blocks: Vec::new(),
        mislabelled: 0,
    };
    reader.document(&document)?;
    let Reader {
        metadata,
        bands,
        blocks,
        ..
    } = reader;
    let basis = hints.basis.as_ref();
    let parsed = parse(&blocks, &bytes, basis);
    let bands = fill(bands, &blocks, parsed, &mut faults)?;
    let mut bsdf = Bsdf::new(bands, metadata)?;
    bsdf.warnings = faults.finish();
    Ok(bsdf)
}

/// Text (bytes) for which it is worth waking other threads.
const WORTH_HELP: usize = 64 << 10;

/// Parses all blocks. The calling thread begins at once; others take blocks when they have woken up.
fn parse(blocks: &[Block<'_>], bytes: &[u8], basis: Option<&Arc<Basis>>) -> Vec<Result<Parsed>> {
    let slots: Vec<OnceLock<Result<Parsed>>> = blocks.iter().map(|_| OnceLock::new()).collect();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut flat = Vec::new();
        while let Some((block, slot)) = {
            let k = next.fetch_add(1, Ordering::Relaxed);
            blocks.get(k).zip(slots.get(k))
        } {
            slot.get_or_init(|| block.parse(bytes, basis, &mut flat));
        }
    };
    let length: usize = blocks.iter().map(|b| b.text.len()).sum();
    let helpers = if length < WORTH_HELP {
        0
    } else {
        rayon::current_num_threads().min(blocks.len()) - 1
    };
    rayon::in_place_scope(|scope| {
        for _ in 0..helpers {
            scope.spawn(|_| work());
        }
        work();
    });
    let parsed = slots.into_iter().map(|s| s.into_inner().expect("each block was taken"));
    parsed.collect()
}

/// Puts the models into their bands.
fn fill(
    mut bands: Vec<Band>,
    blocks: &[Block<'_>],
    parsed: Vec<Result<Parsed>>,
    faults: &mut Faults<'_>,
) -> Result<Vec<Band>> {
    // A warning that all blocks share is told once.
    let mut told = HashSet::new();
    for (block, parsed) in blocks.iter().zip(parsed) {
        let Parsed { model, warnings } = parsed?;
        let band = &mut bands[block.band];
        let direction = names::direction(block.side, block.scatter);
        for warning in warnings {
            if told.insert(warning.clone()) {
                faults.warn(block.at, "ScatteringData", warning);
            }
        }
        if band.set(block.side, block.scatter, Some(Arc::new(model))).is_some() {
            let what = format!(
                "{direction} of band {:?} is there twice; the later one is used",
                band.name
            );
            faults.warn(block.at, "ScatteringData", what);
        }
    }
    for block in blocks.iter().filter(|b| b.scatter == Scatter::Reflection) {
        let band = &bands[block.band];
        let reflection = band.get(block.side, block.scatter).map(Arc::as_ref);
        for side in Side::BOTH {
            let transmission = band.get(side, Scatter::Transmission).map(Arc::as_ref);
            if let (Some(r), Some(t)) = (reflection, transmission)
                && same_pattern(r, t)
            {
                let what = format!(
                    "{} of band {:?} is the same, value for value, as {}: one of them is probably wrong",
                    names::direction(block.side, block.scatter),
                    band.name,
                    names::direction(side, Scatter::Transmission)
                );
                faults.warn(block.at, "ScatteringData", what);
                break;
            }
        }
    }
    bands.retain(|b| b.components().next().is_some());
    Ok(bands)
}

/// Whether two models are equal and more than one constant.
fn same_pattern(a: &Model, b: &Model) -> bool {
    match (a, b) {
        (Model::Matrix(a), Model::Matrix(b)) => {
            let first = a.values()[0];
            a == b && a.values().iter().any(|v| *v != first)
        }
        (Model::Tree(a), Model::Tree(b)) => a.leaves() > 1 && a == b,
        _ => false,
    }
}

/// Which values a file's blocks hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Structure {
    Columns,
    Rows,
    Tree(Rank),
}

struct Reader<'d, 'f, 'h> {
    bytes: &'d [u8],
    hints: &'h Hints,
    decoder: Decoder<'f, 'd>,
    metadata: Metadata,
    bands: Vec<Band>,
    blocks: Vec<Block<'d>>,
    /// Blocks whose data type says transmission where the direction says reflection, or the other way.
    mislabelled: usize,
}

impl<'d> Reader<'d, '_, '_> {
    fn fail<T>(&self, node: &Node<'_>, what: impl Into<String>, remedy: impl Into<String>) -> Result<T> {
        Err(Error::format(place(self.bytes, node.at, node.name), what, remedy))
    }

    fn keep(&mut self, parent: &str, node: &Node<'_>) {
        let element = self.decoder.element(node);
        self.metadata.other.push((parent.to_owned(), element));
    }

    fn document(&mut self, document: &'d Document<'d>) -> Result<()> {
        for comment in &document.comments {
            let text = self.decoder.comment(comment);
            // Our own signature is renewed when the data set is written.
            if !text.starts_with(WRITTEN_BY) {
                self.metadata.comments.push(text);
            }
        }
        let mut optical = None;
        for node in &document.root.children {
            match node.name {
                "WindowElementType" => self.metadata.element_type = Some(self.decoder.line(node)),
                "FileType" if self.decoder.line(node).eq_ignore_ascii_case("BSDF") => {}
                "Optical" if optical.is_none() => optical = Some(node),
                _ => self.keep("WindowElement", node),
            }
        }
        let Some(optical) = optical else {
            return self.fail(
                &document.root,
                "there is no <Optical> in it",
                "this file holds no scattering data",
            );
        };
        let mut layer = None;
        for node in &optical.children {
            match node.name {
                "Layer" if layer.is_none() => layer = Some(node),
                "Layer" => {
                    let what = "a second <Layer>; only the first is read";
                    self.decoder.faults.warn(node.at, node.name, what);
                }
                _ => self.keep("WindowElement/Optical", node),
            }
        }
        match layer {
            Some(layer) => self.layer(layer),
            None => self.fail(
                optical,
                "there is no <Layer> in it",
                "this file holds no scattering data",
            ),
        }
    }

    fn layer(&mut self, layer: &'d Node<'d>) -> Result<()> {
        let mut definition = None;
        for node in &layer.children {
            match node.name {
                "Material" if self.metadata.material.is_none() => {
                    check_material(node, &mut self.decoder)?;
                    self.metadata.material = Some(self.decoder.element(node));
                }
                "Geometry" if self.metadata.geometry.is_none() => {
                    self.metadata.geometry = Some(self.decoder.element(node));
                }
                "DataDefinition" if definition.is_none() => definition = Some(node),
                "DataDefinition" => {
                    return self.fail(
                        node,
                        "a second <DataDefinition>",
                        "delete the one that does not belong to the data",
                    );
                }
                "WavelengthData" => {}
                _ => self.keep(LAYER, node),
            }
        }
        for node in definition.iter().flat_map(|d| &d.children) {
            if !matches!(node.name, "IncidentDataStructure" | "AngleBasis") {
                self.keep(&format!("{LAYER}/DataDefinition"), node);
            }
        }
        let bases = Bases::read(definition, &mut self.decoder)?;
        let structure = self.structure(layer, definition)?;
        let numbers = self.layer_numbers(layer)?;
        let mut found = false;
        for (data, number) in layer.all("WavelengthData").zip(numbers) {
            found = true;
            match number {
                Some(()) => self.wavelength_data(data, structure, &bases)?,
                None => self.keep(LAYER, data),
            }
        }
        if !found {
            return self.fail(
                layer,
                "there is no <WavelengthData> in it",
                "this file holds no scattering data",
            );
        }
        if self.blocks.is_empty() {
            return self.fail(
                layer,
                "no block of it is transmission or reflection from a side",
                "this file holds no scattering data",
            );
        }
        if self.mislabelled > 0 {
            let what = format!(
                "{} with the label of the wrong direction (BTDF for reflection)",
                counted(self.mislabelled, "block")
            );
            self.decoder.faults.warn(layer.at, "ScatteringDataType", what);
        }
        Ok(())
    }

    fn structure(&mut self, layer: &Node<'_>, definition: Option<&Node<'_>>) -> Result<Structure> {
        let node = definition.and_then(|d| d.child("IncidentDataStructure"));
        let text = node.map_or_else(String::new, |n| self.decoder.line(n));
        match text.to_ascii_lowercase().as_str() {
            "columns" => Ok(Structure::Columns),
            "rows" => Ok(Structure::Rows),
            "tensortree3" => Ok(Structure::Tree(Rank::Isotropic)),
            "tensortree4" => Ok(Structure::Tree(Rank::Anisotropic)),
            "" => {
                let at = node.or(definition).unwrap_or(layer);
                let is_tree = layer
                    .all("WavelengthData")
                    .flat_map(|d| d.all("WavelengthDataBlock"))
                    .filter_map(|b| b.child("ScatteringData"))
                    .any(|d| d.text.trim_ascii_start().starts_with(b"{"));
                if is_tree {
                    return self.fail(
                        at,
                        "there is no <IncidentDataStructure>",
                        "write TensorTree3 (isotropic) or TensorTree4 there",
                    );
                }
                let what = "there is no <IncidentDataStructure>; Columns, the usual one, is assumed";
                self.decoder.faults.warn(at.at, at.name, what);
                Ok(Structure::Columns)
            }
            _ => self.fail(
                node.unwrap_or(layer),
                format!("{} is not known", shortened(&text)),
                "write Columns, Rows, TensorTree3 or TensorTree4",
            ),
        }
    }

    /// For each `<WavelengthData>` whether it is of the system. Data of its layers, beside data of the system, are kept
    /// apart; data of one layer alone are taken.
    fn layer_numbers(&mut self, layer: &Node<'_>) -> Result<Vec<Option<()>>> {
        let mut labels = Vec::new();
        for data in layer.all("WavelengthData") {
            let label = data
                .child("LayerNumber")
                .map_or_else(String::new, |n| self.decoder.line(n));
            labels.push(if label.is_empty() { "System".into() } else { label });
        }
        let is_system = |l: &String| l.eq_ignore_ascii_case("system");
        let chosen = match labels.iter().find(|l| is_system(l)).or(labels.first()) {
            Some(label) => label.clone(),
            None => return Ok(Vec::new()),
        };
        if !is_system(&chosen) {
            if let Some(k) = labels.iter().position(|l| *l != chosen) {
                let node = layer.all("WavelengthData").nth(k).unwrap_or(layer);
                return self.fail(
                    node,
                    format!(
                        "data of layers {} and {}, none of the system",
                        shortened(&chosen),
                        shortened(&labels[k])
                    ),
                    "keep the data of one layer in the file",
                );
            }
            let element = Element::leaf("LayerNumber", &chosen);
            self.metadata.other.push((format!("{LAYER}/WavelengthData"), element));
        } else if let Some(k) = labels.iter().position(|l| !is_system(l)) {
            let node = layer.all("WavelengthData").nth(k).unwrap_or(layer);
            let what = format!(
                "data of layer {} beside those of the system; not used",
                shortened(&labels[k])
            );
            self.decoder.faults.warn(node.at, node.name, what);
        }
        Ok(labels
            .iter()
            .map(|l| (*l == chosen || (is_system(l) && is_system(&chosen))).then_some(()))
            .collect())
    }

    fn wavelength_data(&mut self, data: &'d Node<'d>, structure: Structure, bases: &Bases) -> Result<()> {
        let band = self.band_name(data)?;
        let index = self.bands.iter().position(|b| b.name == band).unwrap_or_else(|| {
            self.bands.push(Band::new(band));
            self.bands.len() - 1
        });
        for (name, is_source) in [("SourceSpectrum", true), ("DetectorSpectrum", false)] {
            let text = data.child(name).map(|n| self.decoder.line(n)).filter(|t| !t.is_empty());
            let band = &mut self.bands[index];
            let spectrum = if is_source {
                &mut band.source_spectrum
            } else {
                &mut band.detector_spectrum
            };
            if spectrum.is_none() {
                *spectrum = text;
            }
        }
        let mut found = false;
        for block in data.all("WavelengthDataBlock") {
            found = true;
            self.block(data, block, index, structure, bases)?;
        }
        if !found {
            self.decoder
                .faults
                .warn(data.at, data.name, "there is no <WavelengthDataBlock> in it");
        }
        Ok(())
    }

    fn band_name(&mut self, data: &Node<'_>) -> Result<String> {
        let node = data.child("Wavelength");
        let text = node.map_or_else(String::new, |n| self.decoder.line(n));
        let Some(node) = node.filter(|_| !text.is_empty()) else {
            return match &self.hints.band {
                Some(band) => Ok(band.clone()),
                None => self.fail(
                    data,
                    "no <Wavelength> names the band",
                    "write Visible or Solar there, or say which with `clerestory convert IN OUT --band-of IN=visible`",
                ),
            };
        };
        let unit = self.decoder.attribute(node, "unit").unwrap_or_default();
        let (band, fault) = names::band_from_file(&text, &unit);
        if let Some(fault) = fault {
            self.decoder.faults.warn(node.at, node.name, fault);
        }
        match band {
            Some(band) => Ok(band),
            None => self.fail(
                node,
                format!("wavelength {} in {}", shortened(&text), shortened(&unit)),
                "give it in nanometers",
            ),
        }
    }

    fn block(
        &mut self,
        data: &'d Node<'d>,
        block: &'d Node<'d>,
        band: usize,
        structure: Structure,
        bases: &Bases,
    ) -> Result<()> {
        let direction = block.child("WavelengthDataDirection");
        let text = direction.map_or_else(String::new, |n| self.decoder.line(n));
        let data_type = block
            .child("ScatteringDataType")
            .map_or_else(String::new, |n| self.decoder.line(n).to_ascii_lowercase());
        let is_fraction = data_type.starts_with("fractional");
        if is_fraction || text.to_ascii_lowercase().contains("absor") {
            // Absorptances and fractions are no BSDF; they stay in the file when it is written again.
            let label = if is_fraction { &data_type } else { &text };
            let what = format!("{} is not read as scattering; kept as it is", shortened(label));
            self.decoder.faults.warn(block.at, block.name, what);
            let mut element = Element::leaf(data.name, "");
            element.attributes = self.decoder.attributes(data);
            for node in &data.children {
                if node.name != "WavelengthDataBlock" || std::ptr::eq(node, block) {
                    element.children.push(self.decoder.element(node));
                }
            }
            self.metadata.other.push((LAYER.to_owned(), element));
            return Ok(());
        }
        let (side, scatter) = self.direction(direction.unwrap_or(block), &text)?;
        self.mislabelled += usize::from(match scatter {
            Scatter::Transmission => data_type == "brdf",
            Scatter::Reflection => data_type == "btdf",
        });
        let Some(values) = block.child("ScatteringData") else {
            return self.fail(block, "there is no <ScatteringData> in it", "get the whole file again");
        };
        let shape = match structure {
            Structure::Tree(rank) => {
                self.tree_basis(block)?;
                Shape::Tree(rank)
            }
            Structure::Columns | Structure::Rows => {
                let (column, row) = (block.child("ColumnAngleBasis"), block.child("RowAngleBasis"));
                Shape::Matrix {
                    incident: bases.choose(column.or(row), &mut self.decoder),
                    outgoing: bases.choose(row.or(column), &mut self.decoder),
                    by_incident: structure == Structure::Rows,
                }
            }
        };
        self.blocks.push(Block {
            band,
            side,
            scatter,
            shape,
            text: &values.text,
            text_at: values.text_at,
            at: values.at,
        });
        Ok(())
    }

    fn direction(&mut self, node: &Node<'_>, text: &str) -> Result<(Side, Scatter)> {
        if let Some(found) = names::direction_from_file(text) {
            return Ok(found);
        }
        let text = text.to_ascii_lowercase();
        let one_of = |a: &str, b: &str| match (text.contains(a), text.contains(b)) {
            (true, false) => Some(true),
            (false, true) => Some(false),
            _ => None,
        };
        let side = one_of("front", "back").map(|front| if front { Side::Exterior } else { Side::Interior });
        let scatter = one_of("transm", "reflec").map(|t| if t { Scatter::Transmission } else { Scatter::Reflection });
        match (side.or(self.hints.side), scatter.or(self.hints.scatter)) {
            (Some(side), Some(scatter)) => {
                let what = format!("{} was taken as {}", shortened(&text), names::direction(side, scatter));
                self.decoder.faults.warn(node.at, node.name, what);
                Ok((side, scatter))
            }
            (None, Some(_)) => self.fail(
                node,
                format!(
                    "direction {} does not say from which side the light comes",
                    shortened(&text)
                ),
                "write Front (from the exterior) or Back there, or say which with `clerestory convert IN OUT --assume-side \
                 exterior`",
            ),
            _ => self.fail(
                node,
                format!("direction {} is not known", shortened(&text)),
                "write Transmission or Reflection with Front or Back there, or say which with `clerestory convert IN OUT \
                 --assume-side exterior --assume-scatter transmission`",
            ),
        }
    }

    fn tree_basis(&mut self, block: &Node<'_>) -> Result<()> {
        let node = block.child("AngleBasis").or(block.child("ColumnAngleBasis"));
        let name = node.map_or_else(String::new, |n| self.decoder.line(n));
        if name.is_empty() {
            let what = format!("no <AngleBasis>; {} is assumed", names::TREE_BASIS);
            self.decoder.faults.warn(block.at, block.name, what);
        } else if !name.eq_ignore_ascii_case(names::TREE_BASIS) {
            return self.fail(
                node.unwrap_or(block),
                format!("angle basis {} for a tensor tree", shortened(&name)),
                format!("trees are understood on {} only", names::TREE_BASIS),
            );
        }
        Ok(())
    }
}
