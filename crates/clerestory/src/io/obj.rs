//! Wavefront OBJ: vertices and faces. Surfaces are named after the material in use (`usemtl`), or else after the group or
//! the object; the material libraries are not read here, but named. Lines, points, texture coordinates and normals do not
//! matter.

use std::path::Path;

use super::faces::{Faces, UNNAMED, check_unit, load};
use super::room::Polygon;
use crate::error::{Error, Result};
use crate::geometry::{Scene, Vec3};

/// Reads a file whose unit of length is so many metres.
pub fn read(path: &Path, metres_per_unit: f64) -> Result<Scene> {
    parse(&load(path)?, metres_per_unit)
}

/// Reads a file from its bytes.
pub fn parse(bytes: &[u8], metres_per_unit: f64) -> Result<Scene> {
    read_all(bytes, metres_per_unit).map(|content| content.scene)
}

/// What a file holds.
#[derive(Debug)]
pub(super) struct Content {
    pub scene: Scene,
    /// Its faces.
    pub polygons: Vec<Polygon>,
    /// Material libraries, with their lines.
    pub libraries: Vec<(String, usize)>,
    /// Of each surface the line of its first face, and whether it is a material.
    pub uses: Vec<(usize, bool)>,
}

/// Reads a file from its bytes, with all that it says of materials.
pub(super) fn read_all(bytes: &[u8], metres_per_unit: f64) -> Result<Content> {
    check_unit(metres_per_unit)?;
    let mut file = File {
        scale: metres_per_unit,
        ..File::default()
    };
    let mut lines = bytes.split(|&c| c == b'\n');
    let mut number = 0;
    while let Some(first) = lines.next() {
        number += 1;
        let place = number;
        let mut line = String::from_utf8_lossy(first).trim_end().to_owned();
        // A backslash joins the next line to this one.
        while line.ends_with('\\') {
            line.pop();
            let Some(next) = lines.next() else { break };
            number += 1;
            line.push(' ');
            line.push_str(String::from_utf8_lossy(next).trim_end());
        }
        let text = line.split('#').next().unwrap_or("");
        file.line(text, place)?;
    }
    if file.faces.scene.elements.is_empty() {
        return Err(Error::format(
            format!("line {number}"),
            "the file ends without a face of an area",
            "give an OBJ file with v and f lines",
        ));
    }
    if file.ignored > 0 {
        file.faces.scene.warnings.push(format!(
            "{} lines and points were left out: only faces meet light",
            file.ignored
        ));
    }
    Ok(Content {
        scene: file.faces.finish(),
        polygons: file.polygons,
        libraries: file.libraries,
        uses: file.uses,
    })
}

#[derive(Debug, Default)]
struct File {
    scale: f64,
    faces: Faces,
    vertices: Vec<Vec3>,
    material: Option<String>,
    group: Option<String>,
    object: Option<String>,
    /// Numbers of the surface and the object that are in use.
    current: Option<[u32; 2]>,
    ignored: usize,
    corners: Vec<Vec3>,
    polygons: Vec<Polygon>,
    libraries: Vec<(String, usize)>,
    uses: Vec<(usize, bool)>,
}

impl File {
    fn line(&mut self, text: &str, place: usize) -> Result<()> {
        let mut words = text.split_ascii_whitespace();
        let Some(keyword) = words.next() else { return Ok(()) };
        let rest = || text.trim_start()[keyword.len()..].trim().to_owned();
        let named = |name: String| (!name.is_empty()).then_some(name);
        match keyword {
            "v" => {
                let vertex = self.vertex(words, place)?;
                self.vertices.push(vertex);
            }
            "f" | "fo" => self.face(words, place)?,
            "usemtl" => {
                self.material = named(rest());
                self.current = None;
            }
            "g" => {
                self.group = named(rest());
                self.current = None;
            }
            "o" => {
                self.object = named(rest());
                self.current = None;
            }
            "l" | "p" => self.ignored += 1,
            "mtllib" => self.libraries.extend(named(rest()).map(|name| (name, place))),
            "vt" | "vn" | "vp" | "s" | "usemap" | "maplib" | "bevel" | "c_interp" | "d_interp" | "lod"
            | "shadow_obj" | "trace_obj" => {}
            "curv" | "curv2" | "surf" | "cstype" | "deg" | "bmat" | "step" | "parm" | "trim" | "hole" | "scrv"
            | "sp" | "end" | "con" | "mg" | "ctech" | "stech" => {
                return Err(fault(
                    place,
                    format!("a curved surface ({keyword})"),
                    "export the model as polygons",
                ));
            }
            _ => {
                let short: String = keyword.chars().take(40).collect();
                return Err(fault(
                    place,
                    format!("{short:?} is no keyword of OBJ"),
                    "check that this is a Wavefront OBJ file",
                ));
            }
        }
        Ok(())
    }

    fn vertex<'a>(&self, mut words: impl Iterator<Item = &'a str>, place: usize) -> Result<Vec3> {
        let mut point = [0.0; 3];
        for x in &mut point {
            let word = words.next();
            *x = word
                .and_then(|w| w.parse::<f64>().ok())
                .filter(|x| x.is_finite())
                .ok_or_else(|| {
                    let short: String = word.unwrap_or("nothing").chars().take(40).collect();
                    fault(
                        place,
                        format!("a vertex with {short:?} where a number should be"),
                        "give it three finite numbers",
                    )
                })?;
        }
        let [x, y, z] = point;
        Ok(Vec3::new(x, y, z) * self.scale)
    }

    fn face<'a>(&mut self, words: impl Iterator<Item = &'a str>, place: usize) -> Result<()> {
        self.corners.clear();
        for word in words {
            let first = word.split('/').next().unwrap_or("");
            let count = self.vertices.len();
            let index = match first.parse::<i64>() {
                Ok(k) if k > 0 => Some(k as u64 - 1),
                Ok(k) if k < 0 => (count as u64).checked_sub(k.unsigned_abs()),
                _ => None,
            };
            let vertex = index.and_then(|k| self.vertices.get(usize::try_from(k).ok()?));
            let Some(&vertex) = vertex else {
                let short: String = word.chars().take(40).collect();
                return Err(fault(
                    place,
                    format!("a face with the vertex {short:?}, where {count} vertices stand above it"),
                    "vertices are numbered from 1, or from -1 backwards",
                ));
            };
            self.corners.push(vertex);
        }
        if self.corners.len() < 3 {
            return Err(fault(
                place,
                format!("a face with {} vertices", self.corners.len()),
                "give three or more",
            ));
        }
        let [surface, object] = self.current();
        if surface as usize == self.uses.len() {
            self.uses.push((place, self.material.is_some()));
        }
        self.polygons.push(Polygon {
            object,
            surface,
            corners: self.corners.clone(),
        });
        self.faces
            .add(&self.corners, surface, object, || format!("line {place}"))
    }

    fn current(&mut self) -> [u32; 2] {
        if let Some(current) = self.current {
            return current;
        }
        let names = [&self.material, &self.group, &self.object];
        let surface = names.into_iter().flatten().next().map_or(UNNAMED, String::as_str);
        let object = [&self.object, &self.group].into_iter().flatten().next();
        let object = object.map_or(surface, String::as_str).to_owned();
        let surface = self.faces.scene.surface(surface);
        let object = self.faces.scene.object(object);
        *self.current.insert([surface, object])
    }
}

fn fault(line: usize, what: impl Into<String>, remedy: &str) -> Error {
    Error::format(format!("line {line}"), what, remedy)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Shape;

    #[test]
    fn faces_are_read_with_their_names() {
        let text = "# a comment\nmtllib a.mtl\no film\nv 0 0 0\nv 1 0 0 1.0\r\nv 1 1 0\nv 0 1 0\nvn 0 0 1\n\
                    f 1//1 2//1 3//1 4//1\ng back side\nusemtl  matt white \nf -4/1 -2/2 \\\n -1\nl 1 2\ng rim\nusemtl\nf 1 2 3";
        let scene = parse(text.as_bytes(), 0.001).unwrap();
        assert_eq!(scene.surfaces, ["film", "matt white", "rim"]);
        let surfaces: Vec<u32> = scene.elements.iter().map(|e| e.surface).collect();
        assert_eq!(surfaces, [0, 0, 1, 2]);
        let Shape::Triangle([a, b, c]) = scene.elements[2].shape else {
            panic!("a triangle")
        };
        assert_eq!(
            [a, b, c],
            [
                Vec3::default(),
                Vec3::new(0.001, 0.001, 0.0),
                Vec3::new(0.0, 0.001, 0.0)
            ]
        );
        assert_eq!(scene.warnings.len(), 1);
        assert_eq!(scene.name(3), "\"film\" (triangle)");
    }

    #[test]
    fn faces_without_area_are_left_out_with_a_warning() {
        let scene = parse(b"v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 1\nf 1 2 2\nf 1 2 3", 1.0).unwrap();
        assert_eq!(scene.elements.len(), 1);
        assert_eq!(
            scene.warnings,
            ["2 faces without area were left out, the first one at line 4"]
        );
    }

    #[test]
    fn faults_are_told_with_their_line() {
        for (text, part) in [
            ("v 0 0", "line 1: a vertex with \"nothing\""),
            ("v 0 0 nan", "a vertex with \"nan\""),
            (
                "v 0 0 0\nf 1 2 3",
                "line 2: a face with the vertex \"2\", where 1 vertices",
            ),
            ("v 0 0 0\nf 0 1 1", "the vertex \"0\""),
            ("v 0 0 0\nf -2 1 1", "the vertex \"-2\""),
            ("v 0 0 0\nf 1 1", "a face with 2 vertices"),
            ("v 0 0 0\nf a 1 1", "the vertex \"a\""),
            ("\n\ncurv 1 2", "line 3: a curved surface"),
            ("solid x", "\"solid\" is no keyword"),
            ("", "without a face"),
            ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3", "without a face"),
            ("f 9223372036854775808 1 1", "a face with the vertex"),
            ("f -9223372036854775808 1 1", "a face with the vertex"),
        ] {
            let told = parse(text.as_bytes(), 1.0).unwrap_err().to_string();
            assert!(told.contains(part) && !told.contains('\n'), "{text}: {told}");
        }
        assert!(parse(b"", 0.0).unwrap_err().to_string().contains("a unit of 0 m"));
    }
}
