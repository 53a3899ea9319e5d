//! What a file says of its sample, between the file's bytes and [`Element`]s.

use super::Faults;
use super::scan::{Node, shortened};
use crate::bsdf::Element;
use crate::error::{Error, Result};

/// How the bytes of texts are to be understood.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Encoding {
    Utf8,
    Latin1,
}

impl Encoding {
    /// From the declaration and the bytes; fails for encodings in which not even the tags could be read.
    pub fn of(bytes: &[u8], declared: Option<&str>, faults: &mut Faults<'_>) -> Self {
        let declared = declared.unwrap_or_default().to_ascii_lowercase();
        let says_latin =
            declared.starts_with("iso-8859") || declared.starts_with("windows-125") || declared == "latin1";
        match std::str::from_utf8(bytes) {
            Ok(_) if says_latin && !bytes.is_ascii() => Self::Latin1,
            Ok(_) => {
                if declared.starts_with("utf-16") {
                    faults.warn(0, "", "the file says that it is UTF-16 but it is UTF-8");
                }
                Self::Utf8
            }
            Err(e) => {
                if !says_latin {
                    let at = e.valid_up_to();
                    faults.warn(at, "", "characters that are not UTF-8; they were read as Latin-1");
                }
                Self::Latin1
            }
        }
    }

    fn decode(self, bytes: &[u8]) -> String {
        match self {
            Self::Utf8 => String::from_utf8_lossy(bytes).into_owned(),
            Self::Latin1 => bytes.iter().map(|&b| char::from(b)).collect(),
        }
    }
}

/// Fails for the encodings that put zero bytes between letters, or that begin with another byte order mark.
pub(super) fn refuse_wide(bytes: &[u8]) -> Result<()> {
    let wide = bytes.starts_with(&[0xff, 0xfe])
        || bytes.starts_with(&[0xfe, 0xff])
        || bytes.starts_with(b"<\0")
        || bytes.starts_with(b"\0<")
        || bytes.starts_with(b"\0\0");
    if wide && bytes.iter().take(64).any(|&b| b != 0) {
        return Err(Error::format(
            "line 1",
            "the file is written in UTF-16 or UTF-32",
            "save it as UTF-8",
        ));
    }
    Ok(())
}

/// Turns nodes into text and elements.
pub(super) struct Decoder<'f, 'a> {
    pub encoding: Encoding,
    pub faults: &'f mut Faults<'a>,
}

impl Decoder<'_, '_> {
    /// Text of a node with references resolved, trimmed.
    pub fn text(&mut self, node: &Node<'_>) -> String {
        self.resolve(&node.text, node)
    }

    /// Text of a node as one line: runs of white space are one blank.
    pub fn line(&mut self, node: &Node<'_>) -> String {
        let text = self.text(node);
        let mut words = text.split_whitespace();
        let mut line = words.next().unwrap_or_default().to_owned();
        for word in words {
            line.push(' ');
            line.push_str(word);
        }
        line
    }

    /// A comment's text, trimmed.
    pub fn comment(&self, bytes: &[u8]) -> String {
        let text = self.encoding.decode(bytes);
        text.trim().chars().filter(|&c| is_allowed(c)).collect()
    }

    /// A node with all that is in it.
    pub fn element(&mut self, node: &Node<'_>) -> Element {
        Element {
            name: node.name.to_owned(),
            attributes: self.attributes(node),
            text: self.text(node),
            children: node.children.iter().map(|c| self.element(c)).collect(),
        }
    }

    /// Attributes of a node.
    pub fn attributes(&mut self, node: &Node<'_>) -> Vec<(String, String)> {
        node.attributes()
            .map(|(name, value)| (name.to_owned(), self.resolve(value, node)))
            .collect()
    }

    /// Value of an attribute.
    pub fn attribute(&mut self, node: &Node<'_>, name: &str) -> Option<String> {
        let (_, value) = node.attributes().find(|(n, _)| *n == name)?;
        Some(self.resolve(value, node))
    }

    fn resolve(&mut self, bytes: &[u8], node: &Node<'_>) -> String {
        let raw = self.encoding.decode(bytes);
        let trimmed = raw.trim();
        if trimmed.chars().all(|c| is_allowed(c) && c != '&') {
            return trimmed.to_owned();
        }
        let mut text = String::with_capacity(trimmed.len());
        let mut rest = trimmed;
        while let Some((before, after)) = rest.split_once('&') {
            text.push_str(before);
            if let Some((c, length)) = reference(after) {
                text.push(c);
                rest = &after[length..];
            } else {
                // A few characters only: text without blanks may be long, and full of these.
                let word: String = after.chars().take(20).take_while(|c| !c.is_whitespace()).collect();
                let what = format!("\"&{word}\" is no reference that XML knows; kept as it is");
                self.faults.warn(node.at, node.name, what);
                text.push('&');
                rest = after;
            }
        }
        text.push_str(rest);
        if text.chars().any(|c| !is_allowed(c)) {
            self.faults
                .warn(node.at, node.name, "control characters in the text; left out");
            text.retain(is_allowed);
        }
        // References may have brought blanks to the ends.
        text.trim().to_owned()
    }
}

/// Whether XML 1.0 allows a character.
pub(super) fn is_allowed(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{fffd}' | '\u{10000}'..)
}

/// The character that `amp;`, `#233;` and so on stand for, and the length of that.
fn reference(text: &str) -> Option<(char, usize)> {
    let end = text.bytes().take(12).position(|b| b == b';')?;
    let c = match &text[..end] {
        "amp" => '&',
        "lt" => '<',
        "gt" => '>',
        "quot" => '"',
        "apos" => '\'',
        name => {
            let number = name.strip_prefix('#')?;
            let code = match number.strip_prefix('x') {
                Some(hex) => u32::from_str_radix(hex, 16).ok()?,
                None => number.parse().ok()?,
            };
            char::from_u32(code).filter(|&c| is_allowed(c))?
        }
    };
    Some((c, end + 1))
}

/// Warns of numbers in `<Material>` that are none, and refuses negative sizes.
pub(super) fn check_material(node: &Node<'_>, decoder: &mut Decoder<'_, '_>) -> Result<()> {
    const NUMBERS: [&str; 11] = [
        "Thickness",
        "Width",
        "Height",
        "ThermalConductivity",
        "AirPermeability",
        "EmissivityFront",
        "EmissivityBack",
        "TIR",
        "EffectiveOpennessFraction",
        "PermeabilityFactor",
        "Openness",
    ];
    for child in &node.children {
        let Some(place) = NUMBERS.iter().position(|n| *n == child.name) else {
            continue;
        };
        let text = decoder.text(child);
        let is_size = place < 3;
        match text.parse::<f64>() {
            Ok(value) if is_size && (value < 0.0 || !value.is_finite()) => {
                return Err(Error::format(
                    super::place(decoder.faults.bytes, child.at, child.name),
                    format!("{value} cannot be a size"),
                    "give 0 or more",
                ));
            }
            Ok(value) if !is_size && (value < 0.0 || !value.is_finite()) => {
                decoder
                    .faults
                    .warn(child.at, child.name, format!("{value} makes no sense"));
            }
            Err(_) if !text.is_empty() => {
                let what = format!("{} is not a number", shortened(&text));
                decoder.faults.warn(child.at, child.name, what);
            }
            _ => {}
        }
        if is_size
            && let Some(unit) = decoder.attribute(child, "unit")
            && crate::bsdf::Metadata::metres_in(&unit).is_none()
        {
            let what = format!("unit {} is not known", shortened(&unit));
            decoder.faults.warn(child.at, child.name, what);
        }
    }
    Ok(())
}
