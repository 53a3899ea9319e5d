//! Material libraries of Wavefront OBJ files, and rooms that have them.
//!
//! A library describes how a surface looks under a lamp of a computer's picture. What that is in light:
//!
//! * opaque: Radiance's `plastic` of the diffuse colour `Kd`, with the mean of the specular colour `Ks` as its specularity, and
//!   the roughness √(2/(Ns + 2)) of a lobe as wide as Phong's of the exponent `Ns`;
//! * dissolved (`d` below 1, or `Tr` above 0): `trans` without roughness, through which the share 1 - `d` passes straight, with
//!   the colour `Tf`.
//!
//! Together they are held at 1. Pictures on surfaces (`map_…`), ambient and emitted colours and indices of refraction are left
//! out, with a warning where that changes what is seen.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use super::faces::load;
use super::obj;
use super::radiance::Description;
use super::room::RoomScene;
use crate::error::{Error, Result};

/// Reads an OBJ file with its material libraries, which are looked for beside it and then in the folders of `search`. Every face
/// needs a material.
pub fn read_room(path: &Path, metres_per_unit: f64, search: &[PathBuf]) -> Result<RoomScene> {
    let name = path.display().to_string();
    let content = obj::read_all(&load(path)?, metres_per_unit).map_err(|e| e.within(&format!("{name}, ")))?;
    let folder: PathBuf = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let mut libraries = Vec::new();
    let (mut known, mut warnings) = (Vec::new(), Vec::new());
    for (library, line) in &content.libraries {
        for file in names(library, &folder, search) {
            let file = file.ok_or_else(|| {
                Error::format(
                    format!("{name}, line {line}"),
                    format!("the material library {library:?} was not found beside the file or on the search path"),
                    "give the folder that it is in",
                )
            })?;
            if !libraries.contains(&file) {
                let (more, told) = parse(&load(&file)?, &file.display().to_string())?;
                known.extend(more);
                warnings.extend(told);
                libraries.push(file);
            }
        }
    }
    let mut materials = Vec::new();
    for (surface, (line, is_material)) in content.scene.surfaces.iter().zip(&content.uses) {
        let place = format!("{name}, line {line}");
        if !is_material {
            return Err(Error::format(
                place,
                format!("a face of {surface:?} without a material"),
                "put a usemtl line before it",
            ));
        }
        let found = known.iter().rev().find(|m: &&Description| m.name == *surface);
        materials.push(found.cloned().ok_or_else(|| {
            Error::format(
                place,
                format!(
                    "the material {surface:?} is in none of the {} libraries",
                    libraries.len()
                ),
                "name its library by mtllib",
            )
        })?);
    }
    let mut scene = content.scene;
    scene.warnings.extend(warnings);
    Ok(RoomScene {
        scene,
        materials,
        polygons: content.polygons,
        ..RoomScene::default()
    })
}

/// The files of a `mtllib` line: one whose name may have spaces, or several.
fn names(line: &str, folder: &Path, search: &[PathBuf]) -> Vec<Option<PathBuf>> {
    let find = |name: &str| {
        let folders = std::iter::once(folder).chain(search.iter().map(PathBuf::as_path));
        folders.map(|f| f.join(name)).find(|path| path.is_file())
    };
    match find(line) {
        Some(file) => vec![Some(file)],
        None => line.split_whitespace().map(find).collect(),
    }
}

/// A material in the making.
#[derive(Debug, Clone)]
struct Material {
    name: String,
    line: usize,
    diffuse: [f64; 3],
    specular: [f64; 3],
    exponent: f64,
    opacity: f64,
    filter: [f64; 3],
}

/// The materials of a library from its bytes, and what was odd but harmless. `file` is its name in messages.
pub fn parse(bytes: &[u8], file: &str) -> Result<(Vec<Description>, Vec<String>)> {
    let mut materials: Vec<Material> = Vec::new();
    let mut ignored = BTreeSet::new();
    for (k, line) in bytes.split(|&c| c == b'\n').enumerate() {
        let line = String::from_utf8_lossy(line);
        let text = line.split('#').next().unwrap_or("").trim();
        let place = || format!("{file}, line {}", k + 1);
        let (keyword, rest) = text.split_once(char::is_whitespace).unwrap_or((text, ""));
        let rest = rest.trim();
        if keyword.is_empty() {
            continue;
        }
        if keyword == "newmtl" {
            materials.push(Material {
                name: rest.to_owned(),
                line: k + 1,
                diffuse: [0.8; 3],
                specular: [0.0; 3],
                exponent: 0.0,
                opacity: 1.0,
                filter: [1.0; 3],
            });
            continue;
        }
        let Some(material) = materials.last_mut() else {
            return Err(Error::format(
                place(),
                format!("{:?} before the first newmtl", shortened(keyword)),
                "check that this is a Wavefront material library",
            ));
        };
        let fault = |e: Error| match e {
            Error::Argument(what) => Error::format(
                place(),
                format!("{keyword} of {:?}: {what}", material.name),
                "correct the material library",
            ),
            e => e,
        };
        match keyword {
            "Kd" => material.diffuse = colour(rest).map_err(fault)?,
            "Ks" => material.specular = colour(rest).map_err(fault)?,
            "Tf" => material.filter = colour(rest).map_err(fault)?,
            "Ns" => material.exponent = number(rest, f64::MAX).map_err(fault)?,
            "d" => material.opacity = number(rest.strip_prefix("-halo").unwrap_or(rest), 1.0).map_err(fault)?,
            "Tr" => material.opacity = 1.0 - number(rest, 1.0).map_err(fault)?,
            // What is seen does not depend on these.
            "Ka" | "illum" | "Ni" | "sharpness" => {}
            "Ke" if colour(rest).is_ok_and(|c| c == [0.0; 3]) => {}
            _ => {
                ignored.insert(shortened(keyword));
            }
        }
    }
    let mut warnings = Vec::new();
    if !ignored.is_empty() {
        let all: Vec<String> = ignored.into_iter().collect();
        warnings.push(format!("{file}: left out: {}", all.join(", ")));
    }
    let described = materials.iter().map(|m| described(m, file, &mut warnings)).collect();
    Ok((described, warnings))
}

fn shortened(word: &str) -> String {
    word.chars().take(40).collect()
}

fn number(text: &str, most: f64) -> Result<f64> {
    let word = text.split_whitespace().next().unwrap_or("");
    match word.parse::<f64>() {
        Ok(value) if (0.0..=most).contains(&value) => Ok(value),
        _ if most == 1.0 => Err(Error::Argument(format!(
            "{:?} is no number from 0 to 1",
            shortened(word)
        ))),
        _ => Err(Error::Argument(format!(
            "{:?} is no number of 0 or more",
            shortened(word)
        ))),
    }
}

/// Three shares, or one for all.
fn colour(text: &str) -> Result<[f64; 3]> {
    let values = text
        .split_whitespace()
        .map(|w| number(w, 1.0))
        .collect::<Result<Vec<_>>>();
    match values.map_err(|_| Error::Argument(format!("{:?} is no colour of numbers from 0 to 1", shortened(text))))?[..]
    {
        [grey] => Ok([grey; 3]),
        [red, green, blue] => Ok([red, green, blue]),
        _ => Err(Error::Argument(format!(
            "{:?} is no colour of three numbers",
            shortened(text)
        ))),
    }
}

/// As plastic or trans.
fn described(material: &Material, file: &str, warnings: &mut Vec<String>) -> Description {
    let place = format!("{file}, line {}", material.line);
    let mut specularity = material.specular.iter().sum::<f64>() / 3.0;
    if material.specular.iter().any(|v| (v - specularity).abs() > 1e-9) {
        warnings.push(format!(
            "{place}: the specular colour of {:?} counts as grey, by its mean",
            material.name
        ));
    }
    let passes = 1.0 - material.opacity;
    let even = material.diffuse.map(|v| v * material.opacity);
    let on = material.filter.map(|v| v * passes);
    let sums: [f64; 3] = std::array::from_fn(|b| even[b] + on[b]);
    let most = sums.iter().fold(0.0_f64, |a, b| a.max(*b));
    if most + specularity > 1.0 + 1e-9 {
        specularity = 1.0 - most;
        warnings.push(format!(
            "{place}: what {:?} gives off is more than it gets; its specular part is held at {specularity:.3}",
            material.name
        ));
    }
    // The colour counts for what is not reflected by the specular part.
    let colour = sums.map(|v| {
        if specularity < 1.0 {
            (v / (1.0 - specularity)).min(1.0)
        } else {
            0.0
        }
    });
    let (all, through) = (sums.iter().sum::<f64>(), on.iter().sum::<f64>());
    let transparent = passes > 0.0 && through > 0.0;
    let roughness = if specularity > 0.0 && !transparent {
        (2.0 / (material.exponent + 2.0)).sqrt()
    } else {
        0.0
    };
    let mut numbers = colour.to_vec();
    numbers.extend([specularity, roughness]);
    if transparent {
        numbers.extend([through / all, 1.0]);
    }
    Description {
        name: material.name.clone(),
        kind: if transparent { "trans" } else { "plastic" }.into(),
        words: Vec::new(),
        numbers,
        metres_per_unit: 1.0,
        place,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_become_shares_of_light() {
        let text = b"# a comment\nnewmtl matt white\r\nKd 0.5 0.4 0.3\nKa 1 1 1\nillum 2\nmap_Kd wood.png\n\nnewmtl shiny\nKd 0.4\n\
            Ks .2 .2 .2\nNs 198\nnewmtl pane\nKd 0 0 0\nd 0.25\nTf 0.8 0.8 0.8\nnewmtl too much\nKd 0.9 0.9 0.9\nKs 0.5 0.5 0.2\n\
            Tr 0\n";
        let (all, warnings) = parse(text, "a.mtl").unwrap();
        let close = |k: usize, numbers: &[f64]| {
            let material: &Description = &all[k];
            assert_eq!(material.numbers.len(), numbers.len(), "{material:?}");
            let far = material.numbers.iter().zip(numbers).map(|(a, b)| (a - b).abs());
            assert!(far.fold(0.0, f64::max) < 1e-12, "{material:?}");
        };
        assert_eq!((all[0].name.as_str(), all[0].kind.as_str()), ("matt white", "plastic"));
        close(0, &[0.5, 0.4, 0.3, 0.0, 0.0]);
        close(1, &[0.5, 0.5, 0.5, 0.2, 0.1]);
        assert_eq!(
            (all[2].kind.as_str(), all[2].place.as_str()),
            ("trans", "a.mtl, line 12")
        );
        close(2, &[0.6, 0.6, 0.6, 0.0, 0.0, 1.0, 1.0]);
        close(3, &[1.0, 1.0, 1.0, 0.1, 1.0]);
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        assert!(warnings[0].contains("left out: map_Kd"), "{warnings:?}");
    }

    #[test]
    fn faults_are_told_with_their_line() {
        for (text, part) in [
            ("Kd 1 1 1", "a.mtl, line 1: \"Kd\" before the first newmtl"),
            ("newmtl a\nKd 1 2 1", "line 2: Kd of \"a\": \"1 2 1\" is no colour"),
            ("newmtl a\nKd 1 1", "three numbers"),
            ("newmtl a\nNs -1", "\"-1\" is no number of 0 or more"),
            ("newmtl a\nd 2", "\"2\" is no number from 0 to 1"),
        ] {
            let told = parse(text.as_bytes(), "a.mtl").unwrap_err().to_string();
            assert!(told.contains(part) && !told.contains('\n'), "{text}: {told}");
        }
    }
}
