//! Rooms: what shines, what scatters like a data set, suns and skies, besides everything that samples have.

use std::cell::Cell;
use std::path::{Path, PathBuf};

use super::Description;
use super::reader::{self, LIGHTS, Purpose, Reader};
use super::sky::{of_pattern, only_transform};
use super::words::shown;
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::io::faces::load;
use crate::io::room::{DataSet, Distant, Light, RoomScene};

/// Reads files one after the other as one scene, as Radiance's `oconv` does: materials of an earlier one hold for the later
/// ones. Files that they name are looked for beside the file that was asked for, then in the folders of `search`.
pub fn read_room(paths: &[PathBuf], metres_per_unit: f64, search: &[PathBuf]) -> Result<RoomScene> {
    let current = Cell::new(0);
    let find = |name: &str, file: usize| find(name, &paths[file], search);
    let mut open = |name: &str| match find(name, current.get()) {
        Some(path) => load(&path),
        None => Err(Error::Io(format!(
            "{name}: not found beside {} or on the search path (give the folder that it is in)",
            paths[current.get()].display()
        ))),
    };
    let mut reader = Reader::new(Purpose::Room, &mut open);
    for (k, path) in paths.iter().enumerate() {
        current.set(k);
        let name = path.display().to_string();
        let text = load(path)?;
        reader.read(&text, &name, metres_per_unit).map_err(|e| match e {
            Error::Argument(what) => Error::Argument(format!("{name}: {what}")),
            e => e,
        })?;
    }
    finish(reader, &find)
}

/// Reads a scene from its text, by a name for messages; the files that it names are loaded by `open`, and those of data sets found
/// by `find`.
pub fn parse_room(
    text: &[u8],
    name: &str,
    metres_per_unit: f64,
    open: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
    find: &dyn Fn(&str) -> Option<PathBuf>,
) -> Result<RoomScene> {
    let mut reader = Reader::new(Purpose::Room, open);
    reader.read(text, name, metres_per_unit)?;
    finish(reader, &|file, _| find(file))
}

fn find(name: &str, beside: &Path, search: &[PathBuf]) -> Option<PathBuf> {
    let folder = beside.parent().map(Path::to_path_buf).unwrap_or_default();
    let folders = std::iter::once(&folder).chain(search);
    folders.map(|f| f.join(name)).find(|path| path.is_file())
}

/// What was read, put in order. Data sets are found by their name and the number of the file that was asked for.
fn finish(mut reader: Reader<'_>, find: &dyn Fn(&str, usize) -> Option<PathBuf>) -> Result<RoomScene> {
    let mut room = RoomScene::default();
    let mut warnings = Vec::new();
    let found = std::mem::take(&mut reader.sources);
    for source in found.into_iter().flatten() {
        let distant = distant(&mut reader, source)?;
        room.sources.push(distant);
    }
    for (k, (material, &origin)) in reader.materials.iter().zip(&reader.origins).enumerate() {
        let (surface, kind) = (k as u32, material.kind.as_str());
        if LIGHTS.contains(&kind) {
            room.lights.push(light(material, surface).map_err(at(material))?);
        } else if matches!(kind, "BSDF" | "aBSDF") {
            let mut set = data_set(material, surface).map_err(at(material))?;
            set.path = find(&set.file, origin);
            if set.path.is_none() {
                warnings.push(format!(
                    "{}: the data set {} of {} was not found beside the scene or on the search path",
                    material.place,
                    shown(&set.file),
                    material.name
                ));
            }
            room.data_sets.push(set);
        }
    }
    room.materials = reader.materials;
    room.polygons = reader.polygons;
    room.skies = reader.skies;
    room.scene = reader.faces.finish();
    room.scene.warnings.extend(warnings);
    Ok(room)
}

/// Puts file, line and name of a material in front of what is wrong with it.
fn at(material: &Description) -> impl Fn(Error) -> Error {
    let (place, named) = (material.place.clone(), format!("{} {:?}", material.kind, material.name));
    move |e| match e {
        Error::Argument(what) | Error::Unsupported(what) => Error::format(
            place.clone(),
            format!("{named}: {what}"),
            "see the Radiance manual for the arguments of this type",
        ),
        e => e,
    }
}

/// The three colours at the start of a light's numbers.
fn radiance(material: &Description, counts: [usize; 2]) -> Result<[f64; 3]> {
    let numbers = &material.numbers;
    if !counts.contains(&numbers.len()) {
        return Err(Error::Argument(format!(
            "{} real arguments, not {}",
            numbers.len(),
            counts[0]
        )));
    }
    let colours = [numbers[0], numbers[1], numbers[2]];
    if colours.iter().all(|v| *v >= 0.0) {
        Ok(colours)
    } else {
        Err(Error::Argument(format!("a negative radiance, {colours:?}")))
    }
}

fn light(material: &Description, surface: u32) -> Result<Light> {
    let numbers = &material.numbers;
    let mut light = Light {
        surface,
        kind: material.kind.clone(),
        radiance: [0.0; 3],
        reach: None,
        cone: None,
    };
    match material.kind.as_str() {
        "glow" => {
            light.radiance = radiance(material, [4, 4])?;
            light.reach = Some(numbers[3] * material.metres_per_unit);
        }
        "spotlight" => {
            light.radiance = radiance(material, [7, 7])?;
            let axis = Vec3::new(numbers[4], numbers[5], numbers[6]) * material.metres_per_unit;
            if axis.length() <= 0.0 || !(0.0..=360.0).contains(&numbers[3]) {
                return Err(Error::Argument(format!(
                    "an angle of {}° about the direction {} {} {}",
                    numbers[3], numbers[4], numbers[5], numbers[6]
                )));
            }
            light.cone = Some((numbers[3], axis));
        }
        kind => {
            if let ("illum", Some(other)) = (kind, material.words.first())
                && other != "void"
            {
                return Err(Error::Unsupported(format!(
                    "the material {} in its place, where it is seen (leave it out, and it shines as a light; or give the \
                     surface that material)",
                    shown(other)
                )));
            }
            light.radiance = radiance(material, [3, 3])?;
        }
    }
    Ok(light)
}

fn data_set(material: &Description, surface: u32) -> Result<DataSet> {
    let peaks = material.kind == "aBSDF";
    let mut words = material.words.as_slice();
    let mut thickness = 0.0;
    if !peaks {
        let (first, rest) = words
            .split_first()
            .ok_or_else(|| Error::Argument("no text arguments, not 6 or more".into()))?;
        thickness = match first.parse::<f64>() {
            Ok(t) if t.is_finite() => t * material.metres_per_unit,
            _ => return Err(Error::Argument(format!("{} as the thickness", shown(first)))),
        };
        words = rest;
    }
    let [file, x, y, z, function, transform @ ..] = words else {
        let least = if peaks { 5 } else { 6 };
        return Err(Error::Argument(format!(
            "{} text arguments, not {least} or more",
            material.words.len()
        )));
    };
    let up: Vec<f64> = [x, y, z].iter().filter_map(|w| w.parse().ok()).collect();
    let (&[x, y, z], ".") = (up.as_slice(), function.as_str()) else {
        return Err(Error::Unsupported(format!(
            "an upward direction by a formula, of {} (give three numbers, and a dot in its place)",
            shown(function)
        )));
    };
    // A transform of its own that turns it is in the up vector already.
    if !transform.is_empty() {
        only_transform(transform)?;
        return Err(Error::Unsupported(format!(
            "{} as a transform, which mirrors (turn it only)",
            shown(&transform.join(" "))
        )));
    }
    let up = Vec3::new(x, y, z);
    if !(up.length() > 0.0 && up.length().is_finite()) {
        return Err(Error::Argument(format!("{up:?} as the upward direction")));
    }
    let numbers = &material.numbers;
    if !matches!(numbers.len(), 0 | 3 | 6 | 9) {
        return Err(Error::Argument(format!(
            "{} real arguments, not 0, 3, 6 or 9",
            numbers.len()
        )));
    }
    let added = [0, 3, 6].map(|k| std::array::from_fn(|b| numbers.get(k + b).copied().unwrap_or(0.0)));
    Ok(DataSet {
        surface,
        file: file.clone(),
        path: None,
        thickness,
        up,
        peaks,
        added,
    })
}

fn distant(reader: &mut Reader<'_>, source: reader::Distant) -> Result<Distant> {
    let definition = &reader.definitions[source.definition];
    let material = &definition.description;
    let fail = |what: String| {
        Error::format(
            source.place.clone(),
            format!("source {:?}: {what}", source.name),
            "give it a light, or a glow, which may have the pattern of a sky",
        )
    };
    let (name, kind) = (material.name.clone(), material.kind.clone());
    let radiance = match kind.as_str() {
        "light" => radiance(material, [3, 3]),
        "glow" => radiance(material, [4, 4]),
        kind => return Err(fail(format!("its material {name:?} is of type {}", shown(kind)))),
    }
    .map_err(at(material))?;
    let mut sky = None;
    if let Some(pattern) = definition.modifier {
        let over = &reader.definitions[pattern];
        if let Some(further) = over.modifier {
            let further = &reader.definitions[further].description;
            return Err(fail(format!(
                "the pattern of its material, {:?}, is modified by {:?} of type {}",
                over.description.name,
                further.name,
                shown(&further.kind)
            )));
        }
        sky = over.sky;
        if sky.is_none() {
            if over.moved.is_none() {
                return Err(fail(format!(
                    "its material {name:?} is modified by {:?} of type {}",
                    over.description.name,
                    shown(&over.description.kind)
                )));
            }
            let model = of_pattern(over).map_err(at(&over.description))?;
            sky = Some(reader.skies.len());
            reader.definitions[pattern].sky = sky;
            reader.skies.push(model);
        }
    }
    Ok(Distant {
        name: source.name,
        direction: source.direction.unit(),
        angle_deg: source.angle,
        kind,
        material: name,
        radiance,
        sky,
        place: source.place,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::io::radiance::{CieSky, SkyModel};

    fn read(text: &str) -> Result<RoomScene> {
        let mut open = |name: &str| match name {
            "lamp.rad" => Ok(LAMP.as_bytes().to_vec()),
            _ => Err(Error::Io(format!("{name}: not found"))),
        };
        parse_room(text.as_bytes(), "a.rad", 0.5, &mut open, &|name| {
            (name == "film.xml").then(|| PathBuf::from("data/film.xml"))
        })
    }

    const LAMP: &str = "void spotlight spot 0 0 7 9 8 7 60 1 0 -2\nspot ring r 0 0 8 0 0 0 0 0 -1 0 .2\n\
                        void BSDF film 8 0.1 film.xml 1 0 0 . -ry 90 0 3 .1 .2 .3\nfilm polygon w 0 0 9 0 0 0 1 0 0 0 0 1\n";

    #[test]
    fn lights_and_data_sets_come_with_their_numbers() {
        let text = "void glow g 0 0 4 1 2 3 6\nvoid illum i 1 void 0 3 4 5 6\ng sphere s 0 0 4 0 0 0 1\n\
                    i polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\nvoid aBSDF a 5 none.xml 0 0 1 . 0 0\n\
                    a polygon q 0 0 9 0 0 0 1 0 0 1 1 0\n!xform -rz 90 -s 2 lamp.rad\n";
        let room = read(text).unwrap();
        assert_eq!(room.scene.surfaces, ["g", "i", "a", "spot", "film"]);
        let kinds: Vec<&str> = room.lights.iter().map(|l| l.kind.as_str()).collect();
        assert_eq!(kinds, ["glow", "illum", "spotlight"]);
        assert_eq!(
            (room.lights[0].radiance, room.lights[0].reach),
            ([1.0, 2.0, 3.0], Some(3.0))
        );
        let (angle, axis) = room.lights[2].cone.unwrap();
        assert!(angle == 60.0 && (axis - Vec3::new(0.0, 1.0, -2.0)).length() < 1e-12);
        let [a, film] = room.data_sets.as_slice() else {
            panic!("two data sets")
        };
        assert!(a.peaks && a.path.is_none() && a.thickness == 0.0);
        assert!(!film.peaks && film.path == Some(PathBuf::from("data/film.xml")));
        // First its own turn, x to -z, then that of the file, about z.
        assert!((film.up - Vec3::new(0.0, 0.0, -1.0)).length() < 1e-12, "{:?}", film.up);
        assert_eq!(
            (film.thickness, film.added[0], film.added[1]),
            (0.1, [0.1, 0.2, 0.3], [0.0; 3])
        );
        assert_eq!(room.scene.warnings.len(), 1);
        assert!(room.scene.warnings[0].contains("\"none.xml\" of a was not found"));
        assert_eq!(room.polygons.len(), 3);
        let window = &room.polygons[2];
        assert_eq!((window.surface, window.corners[1]), (4, Vec3::new(0.0, 1.0, 0.0)));
        assert_eq!(room.scene.objects[window.object as usize], "w");
    }

    const SKY: &str = "void light solar 0 0 3 7e6 7e6 6e6\nsolar source sun 0 0 4 0 -3 4 0.533\n";

    #[test]
    fn skies_come_with_their_numbers() {
        let text = format!(
            "{SKY}void brightfunc skyfunc 2 skybr skybright.cal 0 7 1 27 29 1.5 0 -3 4\nskyfunc glow dome 0 0 4 .9 1 1.1 0\n\
             dome source sky 0 0 4 0 0 1 180\nskyfunc glow earth 0 0 4 1 1 1 0\nearth source ground 0 0 4 0 0 -1 180\n\
             void brightfunc other 4 skybright perezlum.cal -rz 20 0 10 1 2 3 4 5 6 7 0 0 2\nother glow b 0 0 4 1 1 1 0\n\
             b source sky 0 0 4 0 0 1 180\n!gensky 6 21 12 -c | xform -rz 30\nskyfunc glow c 0 0 4 1 1 1 0\n\
             c source sky 0 0 4 0 0 1 180\n"
        );
        let room = read(&text).unwrap();
        let sun = &room.sources[0];
        assert!((sun.direction - Vec3::new(0.0, -0.6, 0.8)).length() < 1e-12 && sun.angle_deg == 0.533);
        assert_eq!(
            (sun.radiance, sun.sky, sun.kind.as_str()),
            ([7e6, 7e6, 6e6], None, "light")
        );
        let skies: Vec<Option<usize>> = room.sources.iter().map(|s| s.sky).collect();
        // The command line stands for a sky before any source is looked at.
        assert_eq!(skies, [None, Some(1), Some(1), Some(2), Some(0)]);
        assert!(matches!(&room.skies[0].model, SkyModel::Gensky(sky) if sky.sky == CieSky::Overcast));
        assert!((room.skies[0].turn_deg - 30.0).abs() < 1e-12 && room.skies[0].place == "a.rad, line 11");
        let SkyModel::Cie {
            sky,
            zenith,
            ground,
            sun,
        } = &room.skies[1].model
        else {
            panic!("a sky of the CIE")
        };
        assert_eq!((*sky, *zenith, *ground), (CieSky::Clear, 27.0, 29.0));
        assert_eq!(sun.unwrap().0, 1.5);
        assert!((room.skies[2].turn_deg - 20.0).abs() < 1e-12);
        assert!(
            matches!(&room.skies[2].model, SkyModel::Perez { factor: 1.0, coefficients, .. }
            if *coefficients == [3.0, 4.0, 5.0, 6.0, 7.0])
        );
    }

    #[test]
    fn faults_are_told_in_one_line_with_their_place() {
        let dome = "skyfunc glow dome 0 0 4 1 1 1 0\ndome source sky 0 0 4 0 0 1 180\n";
        let film = "film sphere s 0 0 4 0 0 0 1\n";
        for (text, part) in [
            (
                "void glow g 0 0 3 1 1 1\ng sphere s 0 0 4 0 0 0 1",
                "a.rad, line 1: glow \"g\": 3 real arguments, not 4",
            ),
            (
                "void light l 0 0 3 1 -1 1\nl sphere s 0 0 4 0 0 0 1",
                "a negative radiance",
            ),
            (
                "void illum i 1 pane 0 3 1 1 1\ni sphere s 0 0 4 0 0 0 1",
                "the material \"pane\" in its place",
            ),
            (
                "void spotlight l 0 0 7 1 1 1 60 0 0 0\nl sphere s 0 0 4 0 0 0 1",
                "about the direction 0 0 0",
            ),
            (
                "void antimatter a 1 x 0 0\na sphere s 0 0 4 0 0 0 1",
                "line 2: sphere \"s\": its material \"a\" is of type \"antimatter\"",
            ),
            (
                "void texfunc t 4 a b c d 0 0\nt plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1",
                "is modified by \"t\" of type \"texfunc\"",
            ),
            ("void mixfunc m 4 a b c d 0 0\nm sphere s 0 0 4 0 0 0 1", "\"mixfunc\""),
            (
                "void source s 0 0 4 0 0 1 5",
                "line 1: source \"s\": it has no material",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np source s 0 0 4 0 0 1 5",
                "is of type \"plastic\"",
            ),
            (
                "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 0 5",
                "a direction of 0 0 0",
            ),
            (
                "void glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 500",
                "an angle of 500",
            ),
            (
                &format!("void brightfunc skyfunc 2 myfunc my.cal 0 0\n{dome}"),
                "line 1: brightfunc \"skyfunc\": a pattern of \"myfunc my.cal\"",
            ),
            (
                &format!("void brightfunc skyfunc 2 skybr skybright.cal 0 1 9\n{dome}"),
                "9 as the type of sky",
            ),
            (
                &format!("void brightfunc skyfunc 2 skybr skybright.cal 0 3 1 2 3\n{dome}"),
                "3 real arguments, not 7",
            ),
            (
                &format!("void brightfunc skyfunc 2 skybright perezlum.cal 0 1 9\n{dome}"),
                "1 real arguments, not 10",
            ),
            (
                &format!("void brightfunc skyfunc 4 skybr skybright.cal -rx 10 0 3 2 1 1\n{dome}"),
                "tilted or mirrored",
            ),
            (
                &format!("void colorpict skyfunc 2 a b 0 0\n{dome}"),
                "is modified by \"skyfunc\" of type \"colorpict\"",
            ),
            ("!gensky 6 21 12 -q", "line 1: gensky: option \"-q\""),
            ("!gensky 6 21 12 | xform -rx 5", "tilted or mirrored"),
            ("void instance i 1 a.oct 0 0", "compiled octree"),
            (
                &format!("void BSDF film 0 0 0\n{film}"),
                "line 1: BSDF \"film\": no text arguments",
            ),
            (
                &format!("void BSDF film 6 x film.xml 0 0 1 . 0 0\n{film}"),
                "\"x\" as the thickness",
            ),
            (
                &format!("void BSDF film 6 0 film.xml ux uy uz f.cal 0 0\n{film}"),
                "by a formula, of \"f.cal\"",
            ),
            (
                &format!("void aBSDF film 5 film.xml 0 0 0 . 0 0\n{film}"),
                "as the upward direction",
            ),
            (
                &format!("void aBSDF film 5 film.xml 0 0 1 . 0 1 5\n{film}"),
                "1 real arguments, not 0, 3, 6 or 9",
            ),
            (
                &format!("void aBSDF film 7 film.xml 0 0 1 . -rz x 0 0\n{film}"),
                "xform's -rz \"x\"",
            ),
        ] {
            let error = read(text).expect_err(text).to_string();
            assert!(error.contains(part) && !error.contains('\n'), "{text}: {error}");
            assert!(error.starts_with("a.rad, line "), "{error}");
        }
    }
}
