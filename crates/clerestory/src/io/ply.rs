//! PLY: vertices and faces, in text or binary of either order of bytes. Other elements and properties do not matter.

use std::path::Path;

use super::faces::{Faces, UNNAMED, check_unit, load};
use crate::error::{Error, Result};
use crate::geometry::{Scene, Vec3};

/// Reads a file whose unit of length is so many metres.
pub fn read(path: &Path, metres_per_unit: f64) -> Result<Scene> {
    parse(&load(path)?, metres_per_unit)
}

/// Reads a file from its bytes.
pub fn parse(bytes: &[u8], metres_per_unit: f64) -> Result<Scene> {
    check_unit(metres_per_unit)?;
    let header = Header::parse(bytes)?;
    let mut values = Values {
        bytes,
        at: header.length,
        line: header.lines + 1,
        format: header.format,
    };
    let mut faces = Faces::default();
    let names = [faces.scene.surface(UNNAMED), faces.scene.object(UNNAMED)];
    let mut vertices: Vec<Vec3> = Vec::new();
    let mut polygons: Vec<(Vec<f64>, u64)> = Vec::new();
    for element in &header.elements {
        for number in 0..element.count {
            let mut point = [0.0; 3];
            for property in &element.properties {
                match (element.kind, property.role) {
                    (Kind::Vertex, Role::Coordinate(axis)) if property.length.is_none() => {
                        point[axis] = values.next(property.value)?;
                    }
                    (Kind::Face, Role::Corners) => {
                        let list = values.list(property)?;
                        polygons.push((list, number));
                    }
                    _ => {
                        values.list(property)?;
                    }
                }
            }
            if element.kind == Kind::Vertex {
                if let Some(x) = point.iter().find(|x| !x.is_finite()) {
                    return Err(fault(
                        format!("vertex {number}"),
                        format!("a coordinate of {x}"),
                        "give finite numbers",
                    ));
                }
                let [x, y, z] = point;
                vertices.push(Vec3::new(x, y, z) * metres_per_unit);
            }
        }
    }
    let mut corners = Vec::new();
    for (polygon, number) in &polygons {
        corners.clear();
        for &index in polygon {
            let whole = index >= 0.0 && index.fract() == 0.0;
            let Some(&vertex) = vertices.get(index as usize).filter(|_| whole) else {
                return Err(fault(
                    format!("face {number}"),
                    format!("vertex {index}, where there are {}", vertices.len()),
                    "vertices are numbered from 0",
                ));
            };
            corners.push(vertex);
        }
        if corners.len() < 3 {
            return Err(fault(
                format!("face {number}"),
                format!("{} vertices", corners.len()),
                "give three or more",
            ));
        }
        faces.add(&corners, names[0], names[1], || format!("face {number}"))?;
    }
    if faces.scene.elements.is_empty() {
        return Err(fault("the file", "it has no face of an area", "give one with faces"));
    }
    Ok(faces.finish())
}

fn fault(place: impl Into<String>, what: impl Into<String>, remedy: &str) -> Error {
    Error::format(place, what, remedy)
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Format {
    Text,
    Little,
    Big,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Kind {
    Vertex,
    Face,
    Other,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Role {
    Coordinate(usize),
    Corners,
    Other,
}

/// How a number is written.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Number {
    bytes: usize,
    signed: bool,
    real: bool,
}

impl Number {
    fn of(name: &str) -> Option<Self> {
        let (bytes, signed, real) = match name {
            "char" | "int8" => (1, true, false),
            "uchar" | "uint8" => (1, false, false),
            "short" | "int16" => (2, true, false),
            "ushort" | "uint16" => (2, false, false),
            "int" | "int32" => (4, true, false),
            "uint" | "uint32" => (4, false, false),
            "float" | "float32" => (4, true, true),
            "double" | "float64" => (8, true, true),
            _ => return None,
        };
        Some(Self { bytes, signed, real })
    }
}

#[derive(Debug, Clone, Copy)]
struct Property {
    role: Role,
    value: Number,
    /// How the count of a list is written.
    length: Option<Number>,
}

#[derive(Debug)]
struct Element {
    kind: Kind,
    count: u64,
    properties: Vec<Property>,
}

#[derive(Debug)]
struct Header {
    format: Format,
    elements: Vec<Element>,
    /// Bytes and lines up to its end.
    length: usize,
    lines: usize,
}

impl Header {
    fn parse(bytes: &[u8]) -> Result<Self> {
        let mut header = Self {
            format: Format::Text,
            elements: Vec::new(),
            length: 0,
            lines: 0,
        };
        let mut told = None;
        loop {
            let rest = &bytes[header.length..];
            let end = rest.iter().position(|&c| c == b'\n');
            let line = String::from_utf8_lossy(&rest[..end.unwrap_or(rest.len()).min(1000)]);
            header.lines += 1;
            let place = format!("line {}", header.lines);
            let wrong = |what: &str, remedy: &str| {
                let short: String = line.trim().chars().take(60).collect();
                Err(fault(place.clone(), format!("{short:?}: {what}"), remedy))
            };
            let words: Vec<&str> = line.split_ascii_whitespace().collect();
            if header.lines == 1 && words != ["ply"] {
                return wrong(
                    "the file does not begin with the line ply",
                    "check that this is a PLY file",
                );
            }
            let Some(end) = end else {
                return wrong("the header has no end", "check that the file is whole");
            };
            header.length += end + 1;
            match words[..] {
                ["ply"] | ["comment" | "obj_info", ..] | [] => {}
                ["format", format, "1.0"] => {
                    told = match format {
                        "ascii" => Some(Format::Text),
                        "binary_little_endian" => Some(Format::Little),
                        "binary_big_endian" => Some(Format::Big),
                        _ => return wrong("a format that is not known", "export it as ascii or binary"),
                    };
                }
                ["element", name, count] => {
                    let Ok(count) = count.parse() else {
                        return wrong("a count that is none", "repair the header");
                    };
                    let kind = match name {
                        "vertex" => Kind::Vertex,
                        "face" => Kind::Face,
                        "tristrips" => return wrong("strips of triangles", "export the model as faces"),
                        _ => Kind::Other,
                    };
                    header.elements.push(Element {
                        kind,
                        count,
                        properties: Vec::new(),
                    });
                }
                ["property", ..] => {
                    let (length, value, name) = match words[1..] {
                        ["list", length, value, name] => (Some(Number::of(length)), Number::of(value), name),
                        [value, name] => (None, Number::of(value), name),
                        _ => return wrong("a property that is not understood", "repair the header"),
                    };
                    let (Some(element), Some(value)) = (header.elements.last_mut(), value) else {
                        return wrong("a property of an unknown type or of no element", "repair the header");
                    };
                    let length = match length {
                        Some(Some(length)) if !length.real => Some(length),
                        None => None,
                        _ => return wrong("a list with an unknown type", "repair the header"),
                    };
                    let role = match name {
                        "x" => Role::Coordinate(0),
                        "y" => Role::Coordinate(1),
                        "z" => Role::Coordinate(2),
                        "vertex_indices" | "vertex_index" => Role::Corners,
                        _ => Role::Other,
                    };
                    element.properties.push(Property { role, value, length });
                }
                ["end_header"] => break,
                _ => return wrong("not understood in a header", "repair it, or export the file again"),
            }
        }
        let Some(format) = told else {
            return Err(fault("the header", "it tells no format", "add a line format ascii 1.0"));
        };
        header.format = format;
        header.check()?;
        Ok(header)
    }

    fn check(&self) -> Result<()> {
        for element in &self.elements {
            if element.properties.is_empty() && element.count > 0 {
                return Err(fault(
                    "the header",
                    "an element without properties",
                    "repair the header",
                ));
            }
            let has = |role: Role, list: bool| {
                let mut all = element.properties.iter();
                all.any(|p| p.role == role && p.length.is_some() == list)
            };
            let missing = match element.kind {
                Kind::Vertex if !(0..3).all(|axis| has(Role::Coordinate(axis), false)) => "vertices without x, y and z",
                Kind::Face if !has(Role::Corners, true) => "faces without a list vertex_indices",
                _ => continue,
            };
            return Err(fault("the header", missing, "export the model as polygons"));
        }
        Ok(())
    }
}

/// The numbers behind the header.
struct Values<'a> {
    bytes: &'a [u8],
    at: usize,
    line: usize,
    format: Format,
}

impl Values<'_> {
    fn place(&self) -> String {
        match self.format {
            Format::Text => format!("line {}", self.line),
            _ => format!("byte {}", self.at),
        }
    }

    fn next(&mut self, number: Number) -> Result<f64> {
        match self.format {
            Format::Text => self.word(),
            format => self.packed(number, format == Format::Big),
        }
    }

    fn word(&mut self) -> Result<f64> {
        while let Some(&c) = self.bytes.get(self.at) {
            if c == b'\n' {
                self.line += 1;
            } else if !c.is_ascii_whitespace() {
                break;
            }
            self.at += 1;
        }
        let rest = &self.bytes[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = String::from_utf8_lossy(&rest[..end]);
        let Ok(value) = word.parse() else {
            let short: String = word.chars().take(40).collect();
            let what = if short.is_empty() {
                "the end of the file".into()
            } else {
                format!("{short:?}")
            };
            return Err(fault(
                self.place(),
                format!("{what} stands where a number should be"),
                "check that the file is whole, and the counts in its header",
            ));
        };
        self.at += end;
        Ok(value)
    }

    fn packed(&mut self, number: Number, big: bool) -> Result<f64> {
        let Some(bytes) = self.bytes.get(self.at..self.at + number.bytes) else {
            return Err(fault(
                self.place(),
                "the file ends within its data",
                "check that the file is whole, and the counts in its header",
            ));
        };
        self.at += number.bytes;
        // All bits, the highest first.
        let fold = |all: u64, b: &u8| all << 8 | u64::from(*b);
        let bits = if big {
            bytes.iter().fold(0, fold)
        } else {
            bytes.iter().rev().fold(0, fold)
        };
        Ok(match (number.real, number.bytes) {
            (true, 4) => f64::from(f32::from_bits(bits as u32)),
            (true, _) => f64::from_bits(bits),
            (false, n) if number.signed => {
                let unused = 64 - 8 * n as u32;
                ((bits << unused) as i64 >> unused) as f64
            }
            (false, _) => bits as f64,
        })
    }

    /// The values of a property: one, or as many as the list has.
    fn list(&mut self, property: &Property) -> Result<Vec<f64>> {
        let count = match property.length {
            None => 1.0,
            Some(length) => self.next(length)?,
        };
        if !(count >= 0.0 && count.fract() == 0.0) {
            return Err(fault(
                self.place(),
                format!("a list of {count} values"),
                "repair the file",
            ));
        }
        // Room grows with what is there, not with what is told.
        let mut all = Vec::new();
        let mut left = count;
        while left > 0.0 {
            all.push(self.next(property.value)?);
            left -= 1.0;
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;

    const HEADER: &str = "comment made by hand\nelement vertex 4\nproperty float x\nproperty double y\nproperty float z\n\
                          property uchar red\nelement face 1\nproperty list uchar int vertex_indices\nproperty short flag\nelement edge 1\n\
                          property list uint8 float64 weights\nend_header\n";

    fn text() -> String {
        format!("ply\nformat ascii 1.0\n{HEADER}0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 0 9\n4 0 1 2 3 -1\n2 0.5 0.5\n")
    }

    fn packed(big: bool) -> Vec<u8> {
        let name = if big {
            "binary_big_endian"
        } else {
            "binary_little_endian"
        };
        let mut bytes = format!("ply\nformat {name} 1.0\n{HEADER}").into_bytes();
        let mut add = |mut b: Vec<u8>| {
            if !big {
                b.reverse();
            }
            bytes.extend(b);
        };
        for (x, y) in [(0.0_f32, 0.0_f64), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)] {
            add(x.to_be_bytes().to_vec());
            add(y.to_be_bytes().to_vec());
            add(0.0_f32.to_be_bytes().to_vec());
            add(vec![9]);
        }
        add(vec![4]);
        for k in 0..4_i32 {
            add(k.to_be_bytes().to_vec());
        }
        add((-1_i16).to_be_bytes().to_vec());
        add(vec![2]);
        add(0.5_f64.to_be_bytes().to_vec());
        add(0.5_f64.to_be_bytes().to_vec());
        bytes
    }

    #[test]
    fn all_three_formats_hold_the_same() {
        let scene = parse(text().as_bytes(), 2.0).unwrap();
        assert_eq!(scene.elements.len(), 2);
        assert_eq!(scene, parse(&packed(false), 2.0).unwrap());
        assert_eq!(scene, parse(&packed(true), 2.0).unwrap());
        let reach = |e: &crate::geometry::Element| match e.shape {
            Shape::Triangle(corners) => corners.map(Vec3::length).into_iter().fold(0.0, f64::max),
            _ => 0.0,
        };
        assert!(scene.elements.iter().all(|e| reach(e) >= 2.0));
    }

    #[test]
    fn faults_are_told_with_their_place() {
        for (bytes, part) in [
            (
                text().replace("4 0 1 2 3", "4 0 1 2 4").into_bytes(),
                "face 0: vertex 4, where there are 4",
            ),
            (text().replace("4 0 1 2 3", "2 0 1").into_bytes(), "face 0: 2 vertices"),
            (
                text().replace("1 1 0 9", "1 nan 0 9").into_bytes(),
                "vertex 2: a coordinate of NaN",
            ),
            (
                text().replace("1 1 0 9", "1 x 0 9").into_bytes(),
                "line 17: \"x\" stands where a number",
            ),
            (
                text().replace("vertex 4", "vertex 99999999999").into_bytes(),
                "the end of the file stands",
            ),
            (
                text().replace("property float z", "property float w").into_bytes(),
                "vertices without x, y and z",
            ),
            (
                text().replace("ascii", "utf8").into_bytes(),
                "line 2: \"format utf8 1.0\"",
            ),
            (text().replace("format ascii 1.0\n", "").into_bytes(), "tells no format"),
            (text().replace("short flag", "half flag").into_bytes(), "unknown type"),
            (text().replace("end_header", "end").into_bytes(), "not understood"),
            (
                text().replace("face 1", "tristrips 1").into_bytes(),
                "strips of triangles",
            ),
            (b"solid".to_vec(), "does not begin with the line ply"),
            (b"ply\nformat ascii 1.0\n".to_vec(), "the header has no end"),
            (
                b"ply\nformat ascii 1.0\nelement a 999999999999\nend_header\n".to_vec(),
                "without properties",
            ),
            (
                packed(true)[..packed(true).len() - 1].to_vec(),
                "the file ends within its data",
            ),
        ] {
            let told = parse(&bytes, 1.0).unwrap_err().to_string();
            assert!(told.contains(part) && !told.contains('\n'), "{told}");
        }
    }
}
