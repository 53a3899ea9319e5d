//! STL, in text or binary, told apart by content. A text file's solids become surfaces by their names. Corners decide where
//! a facet's front is; a warning tells if the normals in the file do not agree.

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
    let mut facets = Facets {
        scale: metres_per_unit,
        faces: Faces::default(),
        disagree: 0,
    };
    let count = bytes
        .get(80..84)
        .and_then(|b| b.try_into().ok())
        .map(u32::from_le_bytes);
    // Some binary files begin with the word of the text files; their length gives them away.
    let fits = count.is_some_and(|n| bytes.len() as u64 == 84 + 50 * u64::from(n));
    let text = bytes.trim_ascii_start().starts_with(b"solid");
    match (fits, text, count) {
        (true, _, _) => binary(&bytes[84..], &mut facets)?,
        (false, true, _) => ascii(bytes, &mut facets)?,
        (false, false, Some(n)) => {
            return Err(Error::format(
                "byte 80",
                format!(
                    "the header tells {n} facets, which take {} bytes, but the file has {}",
                    84 + 50 * u64::from(n),
                    bytes.len()
                ),
                "check that this is an STL file and that it is whole",
            ));
        }
        (false, false, None) => {
            return Err(Error::format(
                "byte 0",
                format!("{} bytes that do not begin with \"solid\"", bytes.len()),
                "check that this is an STL file and that it is whole",
            ));
        }
    }
    if facets.faces.scene.elements.is_empty() {
        return Err(Error::format(
            "the file",
            "it has no facet of an area",
            "give one with facets",
        ));
    }
    if facets.disagree > 0 {
        facets.faces.scene.warnings.push(format!(
            "the normals of {} facets do not agree with the order of their corners, which decides",
            facets.disagree
        ));
    }
    Ok(facets.faces.finish())
}

struct Facets {
    scale: f64,
    faces: Faces,
    disagree: usize,
}

impl Facets {
    fn add(
        &mut self,
        normal: [f64; 3],
        corners: [[f64; 3]; 3],
        names: [u32; 2],
        place: impl Fn() -> String,
    ) -> Result<()> {
        if let Some([x, y, z]) = corners.iter().find(|p| p.iter().any(|x| !x.is_finite())) {
            return Err(Error::format(
                place(),
                format!("a corner at ({x}, {y}, {z})"),
                "give finite numbers",
            ));
        }
        let corners = corners.map(|[x, y, z]| Vec3::new(x, y, z) * self.scale);
        let [x, y, z] = normal;
        let own = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
        if own.dot(Vec3::new(x, y, z)) < 0.0 {
            self.disagree += 1;
        }
        self.faces.add(&corners, names[0], names[1], place)
    }

    fn name(&mut self, name: &str) -> [u32; 2] {
        let name = if name.is_empty() { UNNAMED } else { name };
        [self.faces.scene.surface(name), self.faces.scene.object(name)]
    }
}

fn binary(records: &[u8], facets: &mut Facets) -> Result<()> {
    let names = facets.name("");
    for (k, record) in records.chunks_exact(50).enumerate() {
        let value = |at: usize| {
            let bytes = record[4 * at..4 * at + 4].try_into().unwrap_or_default();
            f64::from(f32::from_le_bytes(bytes))
        };
        let [normal, a, b, c] = [0, 3, 6, 9].map(|at| [value(at), value(at + 1), value(at + 2)]);
        facets.add(normal, [a, b, c], names, || format!("facet {}", k + 1))?;
    }
    Ok(())
}

/// What a text file has next, with the words that are left of its line.
struct Lines<'a> {
    lines: std::slice::Split<'a, u8, fn(&u8) -> bool>,
    number: usize,
}

impl Lines<'_> {
    /// The next line that is not empty.
    fn next(&mut self) -> Option<String> {
        loop {
            let line = String::from_utf8_lossy(self.lines.next()?).trim().to_owned();
            self.number += 1;
            if !line.is_empty() {
                return Some(line);
            }
        }
    }

    fn fault(&self, what: &str, line: Option<&str>) -> Error {
        let found: String = line.unwrap_or("the end of the file").chars().take(40).collect();
        Error::format(
            format!("line {}", self.number),
            format!("{found:?} stands where {what} should be"),
            "check that the file is whole; export it again",
        )
    }

    /// The numbers of a line that begins with some words.
    fn numbers(&mut self, words: &[&str]) -> Result<[f64; 3]> {
        let line = self.next();
        let what = words.join(" ");
        let mut given = line.as_deref().unwrap_or("").split_ascii_whitespace();
        let mut values = [f64::NAN; 3];
        let begins = words
            .iter()
            .all(|w| given.next().is_some_and(|g| g.eq_ignore_ascii_case(w)));
        if begins {
            for v in &mut values {
                match given.next().map(str::parse) {
                    Some(Ok(value)) => *v = value,
                    _ => return Err(self.fault(&format!("{what} and three numbers"), line.as_deref())),
                }
            }
            return Ok(values);
        }
        Err(self.fault(&what, line.as_deref()))
    }

    fn exactly(&mut self, words: &str) -> Result<()> {
        let line = self.next();
        let given = line.as_deref().unwrap_or("").split_ascii_whitespace();
        let same = given
            .map(str::to_ascii_lowercase)
            .eq(words.split(' ').map(str::to_owned));
        if same {
            Ok(())
        } else {
            Err(self.fault(words, line.as_deref()))
        }
    }
}

fn ascii(bytes: &[u8], facets: &mut Facets) -> Result<()> {
    let is_end: fn(&u8) -> bool = |&c| c == b'\n';
    let mut lines = Lines {
        lines: bytes.split(is_end),
        number: 0,
    };
    let mut names: Option<[u32; 2]> = None;
    while let Some(line) = lines.next() {
        let (word, rest) = line.split_once(char::is_whitespace).unwrap_or((&line, ""));
        match (word.to_ascii_lowercase().as_str(), names) {
            ("solid", None) => names = Some(facets.name(rest.trim())),
            ("endsolid", Some(_)) => names = None,
            ("facet", Some(names)) => {
                let normal: Vec<f64> = rest
                    .split_ascii_whitespace()
                    .skip(1)
                    .filter_map(|w| w.parse().ok())
                    .collect();
                // Normals are often missing or no numbers at all.
                let normal = normal.try_into().unwrap_or_default();
                let number = lines.number;
                lines.exactly("outer loop")?;
                let mut corners = [[0.0; 3]; 3];
                for corner in &mut corners {
                    *corner = lines.numbers(&["vertex"])?;
                }
                lines.exactly("endloop")?;
                lines.exactly("endfacet")?;
                facets.add(normal, corners, names, || format!("line {number}"))?;
            }
            (_, None) => return Err(lines.fault("solid", Some(&line))),
            (_, Some(_)) => return Err(lines.fault("facet or endsolid", Some(&line))),
        }
    }
    if names.is_some() {
        return Err(lines.fault("endsolid", None));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;

    const TEXT: &str = "solid prism one\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1e0 0\n  \
                        endloop\n endfacet\n facet normal 0 0 1\n outer loop\n vertex 0 0 0\n vertex 0 1 0\n vertex 1 0 0\n endloop\n \
                        endfacet\nendsolid prism one\n";

    fn packed(header: &[u8], facets: &[[f32; 12]], count: u32) -> Vec<u8> {
        let mut bytes = header.to_vec();
        bytes.resize(80, b' ');
        bytes.extend(count.to_le_bytes());
        for facet in facets {
            bytes.extend(facet.iter().flat_map(|x| x.to_le_bytes()));
            bytes.extend([7, 7]);
        }
        bytes
    }

    #[test]
    fn text_and_binary_hold_the_same() {
        let text = parse(TEXT.as_bytes(), 0.5).unwrap();
        assert_eq!(text.surfaces, ["prism one"]);
        assert!(text.warnings[0].contains("normals of 1 facets"));
        let facets = [
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0],
        ];
        // A binary file may begin as a text does.
        let binary = parse(&packed(b"solid but binary", &facets, 2), 0.5).unwrap();
        let shapes = |scene: &Scene| scene.elements.iter().map(|e| e.shape).collect::<Vec<_>>();
        assert_eq!(shapes(&text), shapes(&binary));
        let Shape::Triangle([_, b, _]) = binary.elements[0].shape else {
            panic!("a triangle")
        };
        assert_eq!(b, Vec3::new(0.5, 0.0, 0.0));
    }

    #[test]
    fn faults_are_told_with_their_place() {
        let facet = [0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, f32::NAN, 0.0, 1.0, 0.0];
        for (bytes, part) in [
            (TEXT.as_bytes()[..120].to_vec(), "stands where"),
            (
                TEXT.replace("1e0", "x").into_bytes(),
                "line 6: \"vertex 0 x 0\" stands where vertex and three numbers",
            ),
            (
                TEXT.replacen(" endloop", " oops", 1).into_bytes(),
                "line 7: \"oops\" stands where endloop",
            ),
            (
                TEXT.replace("endsolid prism one\n", "").into_bytes(),
                "\"the end of the file\" stands where endsolid",
            ),
            (TEXT.replacen("solid", "volume", 1).into_bytes(), "the header tells"),
            (packed(b"", &[facet], 1), "facet 1: a corner at (1, 0, NaN)"),
            (packed(b"", &[facet], u32::MAX), "the header tells 4294967295 facets"),
            (packed(b"", &[], 0), "no facet"),
            (b"abc".to_vec(), "3 bytes that do not begin"),
            (b"solid\nendsolid".to_vec(), "no facet"),
        ] {
            let told = parse(&bytes, 1.0).unwrap_err().to_string();
            assert!(told.contains(part) && !told.contains('\n'), "{told}");
        }
    }
}
