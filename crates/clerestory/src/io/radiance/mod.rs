//! Radiance scene files, with `!xform` and simple generators read here: no program is ever run.
//!
//! * Surfaces: `polygon`, `sphere`, `bubble`, `ring`, `cylinder`, `tube`, `cone`, `cup`. A `source` (sun, sky) is left out
//!   with a warning; `instance` and `mesh`, which need compiled files, are refused.
//! * Materials are handed on as they are written ([`Description`]). What a surface uses and cannot be traced is refused by
//!   name: lights, mixtures, `antimatter`, and materials under a pattern or a texture, since light would not go where the
//!   file says. What no surface uses does not matter.
//! * Commands: `xform`, `genbox`, `genprism`, `genblinds`, `cat`, and pipes from one of them into `xform`.

mod command;
mod generate;
mod words;
mod xform;

pub use xform::{Transform, Xform};

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use self::command::{Source, Stage};
use self::words::{Next, Words, shown};
use super::faces::{Faces, check_unit, load};
use crate::error::{Error, Result};
use crate::geometry::{Scene, Shape, Vec3};
use crate::io::counted;

/// A material as the file has it.
#[derive(Debug, Clone, PartialEq)]
pub struct Description {
    /// Its name.
    pub name: String,
    /// Its type, for example `plastic`.
    pub kind: String,
    /// Its text arguments. The up vector of a BSDF has been turned with everything else.
    pub words: Vec<String>,
    /// Its real arguments.
    pub numbers: Vec<f64>,
    /// Metres that a unit of length in its arguments stands for.
    pub metres_per_unit: f64,
    /// File and line of its definition.
    pub place: String,
}

impl Description {
    /// The same but for where it is defined.
    fn is_like(&self, other: &Self) -> bool {
        let place = other.place.clone();
        Self { place, ..self.clone() } == *other
    }
}

/// What a scene file holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Radiance {
    /// Shapes, in metres.
    pub scene: Scene,
    /// A material for each surface of the scene.
    pub materials: Vec<Description>,
}

/// Reads a file and the files that it names; those are looked for beside it.
pub fn read(path: &Path, metres_per_unit: f64) -> Result<Radiance> {
    let folder: PathBuf = path.parent().map(Path::to_path_buf).unwrap_or_default();
    let text = load(path)?;
    parse(&text, metres_per_unit, &mut |name| load(&folder.join(name)))
}

/// Reads a scene from its text; the files that it names are loaded by `open`.
pub fn parse(text: &[u8], metres_per_unit: f64, open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Radiance> {
    check_unit(metres_per_unit)?;
    let mut reader = Reader {
        faces: Faces::default(),
        materials: Vec::new(),
        definitions: Vec::new(),
        current: HashMap::new(),
        surfaces: HashMap::new(),
        files: HashMap::new(),
        budget: BUDGET,
        sources: 0,
        open,
    };
    let context = Context {
        prefix: String::new(),
        transform: Transform::sized(metres_per_unit),
        modifier: None,
        inverted: false,
        depth: 0,
    };
    reader.file(text, "", &context)?;
    if reader.sources > 0 {
        reader.faces.scene.warnings.push(format!(
            "left out: {} of type source, for the instrument brings its own light",
            counted(reader.sources, "object")
        ));
    }
    Ok(Radiance {
        scene: reader.faces.finish(),
        materials: reader.materials,
    })
}

/// Bytes that are read again and again by nested arrays before it is enough.
const BUDGET: usize = 1 << 31;
/// Shapes that a scene may have.
const MOST_SHAPES: usize = 10_000_000;
/// Files within files.
const MOST_NESTED: u32 = 32;

const SURFACES: [&str; 8] = ["polygon", "sphere", "bubble", "ring", "cylinder", "tube", "cone", "cup"];
const MATERIALS: [&str; 9] = [
    "plastic",
    "metal",
    "trans",
    "glass",
    "dielectric",
    "interface",
    "mirror",
    "BSDF",
    "aBSDF",
];

/// How what is read is moved and named.
#[derive(Debug, Clone)]
struct Context {
    prefix: String,
    transform: Transform,
    modifier: Option<String>,
    inverted: bool,
    depth: u32,
}

/// A material, pattern or texture with what it modifies.
#[derive(Debug, Clone)]
struct Definition {
    description: Description,
    modifier: Option<usize>,
}

struct Reader<'a> {
    faces: Faces,
    materials: Vec<Description>,
    definitions: Vec<Definition>,
    /// Latest definition of each name.
    current: HashMap<String, usize>,
    /// Surface of the scene by definition.
    surfaces: HashMap<usize, u32>,
    files: HashMap<String, std::rc::Rc<Vec<u8>>>,
    budget: usize,
    sources: usize,
    open: &'a mut dyn FnMut(&str) -> Result<Vec<u8>>,
}

impl Reader<'_> {
    fn file(&mut self, text: &[u8], name: &str, context: &Context) -> Result<()> {
        self.budget = self.budget.checked_sub(text.len() + 1).ok_or_else(|| {
            Error::Argument(format!(
                "{name}: files are read again and again, over {} GB in all (make the arrays of !xform smaller)",
                BUDGET >> 30
            ))
        })?;
        let mut words = Words::new(text, name);
        loop {
            match words.next() {
                Next::End => return Ok(()),
                Next::Command(line) => {
                    let place = words.place();
                    self.command(&line, context, &place).map_err(|e| match e {
                        // What is wrong within a file that was named has its place.
                        Error::Format { .. } | Error::Interrupted => e,
                        e => e.within(&format!("{place}: ")),
                    })?;
                }
                Next::Word(modifier) => self.object(&modifier, &mut words, context)?,
            }
        }
    }

    /// The text of a file, read once.
    fn load(&mut self, name: &str) -> Result<std::rc::Rc<Vec<u8>>> {
        if let Some(known) = self.files.get(name) {
            return Ok(known.clone());
        }
        let text = std::rc::Rc::new((self.open)(name)?);
        self.files.insert(name.to_owned(), text.clone());
        Ok(text)
    }

    fn command(&mut self, line: &str, context: &Context, place: &str) -> Result<()> {
        if context.depth >= MOST_NESTED {
            return Err(Error::Argument(format!(
                "files within files, {MOST_NESTED} deep (does one name itself?)"
            )));
        }
        let Stage { source, xforms } = command::parse(line, &mut *self.open)?;
        let mut contexts = vec![Context {
            depth: context.depth + 1,
            ..context.clone()
        }];
        // The last of a row of xforms works last, so that it is the outermost one.
        for xform in xforms.iter().rev() {
            let mut inner = Vec::with_capacity(contexts.len() * xform.copies.len());
            for outer in &contexts {
                for (name, transform) in &xform.copies {
                    let mut prefix = outer.prefix.clone();
                    if !name.is_empty() {
                        prefix.push_str(name);
                        prefix.push('.');
                    }
                    inner.push(Context {
                        prefix,
                        transform: transform.then(&outer.transform),
                        modifier: outer.modifier.clone().or_else(|| xform.modifier.clone()),
                        inverted: outer.inverted != xform.inverted,
                        depth: outer.depth,
                    });
                }
                if inner.len() > xform::MOST_COPIES {
                    return Err(xform::too_many());
                }
            }
            contexts = inner;
        }
        match source {
            Source::Files(files) => {
                for context in &contexts {
                    for name in &files {
                        let text = self.load(name)?;
                        self.file(&text, name, context)?;
                    }
                }
            }
            Source::Generated(generated) => {
                for context in &contexts {
                    let surface = self.surface_of(&generated.modifier, context).map_err(Error::Argument)?;
                    for (name, corners) in &generated.polygons {
                        self.polygon(name, corners, surface, context, place)
                            .map_err(|e| e.within(&format!("{name}: ")))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn object(&mut self, modifier: &str, words: &mut Words, context: &Context) -> Result<()> {
        let kind = words.word("a type")?;
        let name = words.text("a name")?;
        let place = words.place();
        if kind == "alias" {
            let reference = words.word("what an alias stands for")?;
            return self.alias(modifier, name, &reference, place);
        }
        let count = words.count("a count of text arguments")?;
        let mut texts = Vec::new();
        for _ in 0..count {
            texts.push(words.text("a text argument")?);
        }
        // Integer arguments have no use in any type.
        for _ in 0..words.count("a count of integer arguments")? {
            words.number("an integer argument")?;
        }
        let count = words.count("a count of real arguments")?;
        let mut numbers = Vec::new();
        for _ in 0..count {
            numbers.push(words.number("a real argument")?);
        }
        let fail = |e: Error| match e {
            Error::Argument(text) => Error::format(
                place.clone(),
                format!("{kind} {name:?}: {text}"),
                "see the Radiance manual for the arguments of this type",
            ),
            e => e,
        };
        if SURFACES.contains(&kind.as_str()) {
            let surface = self
                .surface_of(modifier, context)
                .map_err(|what| Error::format(place.clone(), format!("{kind} {name:?}: {what}"), REMEDY_MATERIAL))?;
            return self
                .surface(&kind, &name, &numbers, surface, context, &place)
                .map_err(fail);
        }
        match kind.as_str() {
            "source" => self.sources += 1,
            "instance" => {
                return Err(Error::format(
                    place,
                    format!(
                        "instance {name:?} needs a compiled octree, {}",
                        shown(texts.first().map_or("", |t| t))
                    ),
                    "put the scene file that it was made of here, by !xform",
                ));
            }
            "mesh" => {
                return Err(Error::format(
                    place,
                    format!(
                        "mesh {name:?} needs a compiled mesh, {}",
                        shown(texts.first().map_or("", |t| t))
                    ),
                    "give the OBJ file that it was made of instead",
                ));
            }
            _ => {
                if kind == "BSDF" || kind == "aBSDF" {
                    // A BSDF's thickness comes before its file.
                    let texts = texts.get_mut(usize::from(kind == "BSDF")..).unwrap_or_default();
                    turn_up_vector(texts, &context.transform);
                }
                let description = Description {
                    name: name.clone(),
                    kind,
                    words: texts,
                    numbers,
                    metres_per_unit: context.transform.scale,
                    place,
                };
                self.define(name, description, modifier);
            }
        }
        Ok(())
    }

    fn define(&mut self, name: String, description: Description, modifier: &str) {
        let modifier = self.current.get(modifier).copied();
        // A file that is read again for each copy of an array defines the same materials each time.
        if let Some(&known) = self.current.get(&name) {
            let same = &self.definitions[known];
            if same.description.is_like(&description) && same.modifier == modifier {
                return;
            }
        }
        self.current.insert(name, self.definitions.len());
        self.definitions.push(Definition { description, modifier });
    }

    fn alias(&mut self, modifier: &str, name: String, reference: &str, place: String) -> Result<()> {
        let Some(&original) = self.current.get(reference) else {
            return Err(Error::format(
                place,
                format!(
                    "alias {name:?} stands for {}, which is not defined above it",
                    shown(reference)
                ),
                "define it first",
            ));
        };
        let mut definition = self.definitions[original].clone();
        definition.description.name.clone_from(&name);
        if modifier != "inherit" {
            definition.modifier = self.current.get(modifier).copied();
        }
        self.current.insert(name, self.definitions.len());
        self.definitions.push(definition);
        Ok(())
    }

    /// The scene's surface for a modifier; or what is wrong with it.
    fn surface_of(&mut self, modifier: &str, context: &Context) -> std::result::Result<u32, String> {
        let name = context.modifier.as_deref().unwrap_or(modifier);
        if name == "void" {
            return Err("it has no material (its modifier is void)".into());
        }
        let Some(&index) = self.current.get(name) else {
            return Err(format!("its material {} is not defined above it", shown(name)));
        };
        if let Some(&known) = self.surfaces.get(&index) {
            return Ok(known);
        }
        let Definition { description, modifier } = &self.definitions[index];
        if !MATERIALS.contains(&description.kind.as_str()) {
            return Err(format!(
                "its material {} is of type {}, which cannot be traced (there are {})",
                shown(name),
                shown(&description.kind),
                MATERIALS.join(", ")
            ));
        }
        if let Some(over) = modifier.map(|m| &self.definitions[m].description) {
            return Err(format!(
                "its material {} is modified by {} of type {}: patterns and textures cannot be traced",
                shown(name),
                shown(&over.name),
                shown(&over.kind)
            ));
        }
        // Another definition of a name, as files that are read after each other may have, is another surface.
        let scene = &mut self.faces.scene;
        let (mut unique, mut count) = (description.name.clone(), 1);
        while scene.has_surface(&unique) {
            count += 1;
            unique = format!("{} {count}", description.name);
        }
        let surface = scene.surface(&unique);
        self.materials.push(description.clone());
        self.surfaces.insert(index, surface);
        Ok(surface)
    }

    fn surface(
        &mut self,
        kind: &str,
        name: &str,
        numbers: &[f64],
        surface: u32,
        context: &Context,
        place: &str,
    ) -> Result<()> {
        let count = |wanted: usize| {
            if numbers.len() == wanted {
                Ok(())
            } else {
                Err(Error::Argument(format!(
                    "{} real arguments, not {wanted}",
                    numbers.len()
                )))
            }
        };
        let point = |k: usize| Vec3::new(numbers[k], numbers[k + 1], numbers[k + 2]);
        let Transform { scale, .. } = context.transform;
        let moved = |k: usize| context.transform.point(point(k));
        let radius = |r: f64| {
            if r >= 0.0 {
                Ok(r * scale)
            } else {
                Err(Error::Argument(format!("a radius of {r}")))
            }
        };
        let shape = match kind {
            "polygon" => {
                if !numbers.len().is_multiple_of(3) {
                    return Err(Error::Argument(format!(
                        "{} real arguments, not three a corner",
                        numbers.len()
                    )));
                }
                let corners: Vec<Vec3> = (0..numbers.len()).step_by(3).map(point).collect();
                return self.polygon(name, &corners, surface, context, place);
            }
            "sphere" | "bubble" => {
                count(4)?;
                Shape::Sphere {
                    centre: moved(0),
                    radius: radius(numbers[3])?,
                    inward: (kind == "bubble") != context.inverted,
                }
            }
            "ring" => {
                count(8)?;
                let direction = context.transform.vector(point(3));
                let mut radii = [radius(numbers[6])?, radius(numbers[7])?];
                radii.sort_by(f64::total_cmp);
                let normal = direction.unit();
                if !normal.x.is_finite() {
                    return Err(Error::Argument("a direction of 0 0 0".into()));
                }
                Shape::Ring {
                    centre: moved(0),
                    normal: if context.inverted { -normal } else { normal },
                    radii,
                }
            }
            _ => {
                let radii = if matches!(kind, "cylinder" | "tube") {
                    count(7)?;
                    [radius(numbers[6])?; 2]
                } else {
                    count(8)?;
                    [radius(numbers[6])?, radius(numbers[7])?]
                };
                Shape::Cone {
                    ends: [moved(0), moved(3)],
                    radii,
                    inward: matches!(kind, "tube" | "cup") != context.inverted,
                }
            }
        };
        if let Some((what, _)) = shape.fault() {
            return Err(Error::Argument(what));
        }
        let object = self.faces.scene.object(format!("{}{name}", context.prefix));
        self.faces.scene.push(shape, surface, object);
        self.full()
    }

    fn polygon(&mut self, name: &str, corners: &[Vec3], surface: u32, context: &Context, place: &str) -> Result<()> {
        let mut corners: Vec<Vec3> = corners.iter().map(|&c| context.transform.point(c)).collect();
        // A mirror turns the sense of corners round, and so the front.
        if context.transform.mirrors != context.inverted {
            corners.reverse();
        }
        let name = format!("{}{name}", context.prefix);
        let object = self.faces.scene.object(name.as_str());
        self.faces
            .add(&corners, surface, object, || format!("{place}, polygon {name:?}"))?;
        self.full()
    }

    fn full(&self) -> Result<()> {
        if self.faces.scene.elements.len() > MOST_SHAPES {
            return Err(Error::Argument(format!(
                "over {MOST_SHAPES} shapes (make the arrays of !xform smaller, and let the period repeat the scene)"
            )));
        }
        Ok(())
    }
}

const REMEDY_MATERIAL: &str = "give it a material of another type, defined before its first use";

/// Turns the up vector among a BSDF's texts, the file's name first, if it is of numbers.
fn turn_up_vector(texts: &mut [String], transform: &Transform) {
    let Some(up) = texts.get_mut(1..4) else { return };
    let numbers: Vec<f64> = up.iter().filter_map(|w| w.parse().ok()).collect();
    let &[x, y, z] = numbers.as_slice() else { return };
    let turned = transform.vector(Vec3::new(x, y, z)) * (1.0 / transform.scale);
    for (word, value) in up.iter_mut().zip(turned.array()) {
        *word = value.to_string();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PLASTIC: &str = "void plastic grey 0 0 5 .5 .5 .5 0 0\n";

    fn with(files: &[(&str, &str)], text: &str) -> Result<Radiance> {
        parse(text.as_bytes(), 1.0, &mut |name| {
            let found = files.iter().find(|(n, _)| *n == name);
            found
                .map(|(_, t)| t.as_bytes().to_vec())
                .ok_or_else(|| Error::Io(format!("{name}: not found")))
        })
    }

    fn told(text: &str) -> String {
        with(&[], text).expect_err("a fault").to_string()
    }

    #[test]
    fn shapes_come_with_their_materials_in_metres() {
        let text = "# a comment\nvoid glass clear 0 0 3 .9 .9 .9 grey_not_used\n";
        assert!(with(&[], text).is_err());
        let text = "void glass clear 0 0 3 .9 .9 .9\nvoid alias pane clear
            pane polygon p 0 0 12 0 0 0  10 0 0  10 10 0  0 10 0
            clear sphere s 0 0 4 1 2 3 4
            clear bubble b 0 0 4 1 2 3 4
            clear ring r 0 0 8 0 0 0 0 0 -5 2 1
            clear cylinder c 0 0 7 0 0 0 1 0 0 .5
            clear cup k 0 0 8 0 0 0 1 0 0 .5 0";
        let read = parse(text.as_bytes(), 0.001, &mut |_| unreachable!()).unwrap();
        assert_eq!(read.scene.surfaces, ["pane", "clear"]);
        assert_eq!(read.materials[1].numbers, [0.9; 3]);
        assert_eq!(read.materials[0].metres_per_unit, 0.001);
        assert_eq!(read.scene.objects, ["p", "s", "b", "r", "c", "k"]);
        let shapes: Vec<Shape> = read.scene.elements.iter().map(|e| e.shape).collect();
        assert_eq!(shapes.len(), 7);
        let close = |a: Vec3, x: f64, y: f64, z: f64| (a - Vec3::new(x, y, z)).length() < 1e-18;
        let Shape::Triangle([a, b, c]) = shapes[0] else {
            panic!("a triangle")
        };
        assert!(((b - a).cross(c - a) - Vec3::new(0.0, 0.0, 1e-4)).length() < 1e-18);
        assert!(matches!(shapes[2], Shape::Sphere { centre, radius, inward: false }
            if close(centre, 0.001, 0.002, 0.003) && (radius - 0.004).abs() < 1e-18));
        assert!(matches!(shapes[3], Shape::Sphere { inward: true, .. }));
        assert!(matches!(shapes[4], Shape::Ring { normal, radii, .. }
            if normal == Vec3::new(0.0, 0.0, -1.0) && radii[0] < radii[1]));
        assert!(matches!(shapes[5], Shape::Cone { radii: [a, b], inward: false, .. } if a == b));
        assert!(matches!(
            shapes[6],
            Shape::Cone {
                radii: [_, 0.0],
                inward: true,
                ..
            }
        ));
    }

    #[test]
    fn arrays_of_files_are_where_xform_puts_them() {
        let slat = "grey polygon slat 0 0 9 0 0 0 1 0 0 0 0 1\n!xform -n in -t 0 0 7 part.rad\n";
        let part = "grey sphere ball 0 0 4 1 0 0 .25\n";
        let text = format!("{PLASTIC}!xform -n s -mx -a 3 -t 0 2 0 -i 1 -s 10 \\\n slat.rad");
        let read = with(&[("slat.rad", slat), ("part.rad", part)], &text).unwrap();
        assert_eq!(read.materials.len(), 1);
        assert_eq!(read.scene.objects[2..4], ["s.1.slat", "s.1.in.ball"]);
        let Shape::Triangle([a, b, c]) = read.scene.elements[4].shape else {
            panic!("a triangle")
        };
        // Mirrored, so that the corners run the other way round.
        assert_eq!(c, Vec3::new(0.0, 40.0, 0.0));
        assert_eq!((a, b), (Vec3::new(0.0, 40.0, 10.0), Vec3::new(-10.0, 40.0, 0.0)));
        let Shape::Sphere { centre, radius, .. } = read.scene.elements[5].shape else {
            panic!("a sphere")
        };
        assert_eq!((centre, radius), (Vec3::new(-10.0, 40.0, 70.0), 2.5));
    }

    #[test]
    fn modifiers_and_inversions_go_through_pipes() {
        let text = format!(
            "{PLASTIC}void metal steel 0 0 5 .5 .5 .5 .9 0\n!genbox grey b 1 1 1 | xform -m steel -I | xform -m grey -t 5 0 0\n"
        );
        let read = with(&[], &text).unwrap();
        assert_eq!(read.scene.surfaces, ["grey"]);
        let six: f64 = (read.scene.elements.iter())
            .map(|e| match e.shape {
                Shape::Triangle([a, b, c]) => a.dot(b.cross(c)),
                _ => 0.0,
            })
            .sum();
        assert!((six + 6.0).abs() < 1e-12, "{six}");
    }

    #[test]
    fn later_definitions_hold_for_later_objects() {
        let ball = "grey sphere s 0 0 4 0 0 0 1\n";
        let again = "void plastic grey 0 0 5 .1 .1 .1 0 0\n";
        let read = with(&[], &format!("{PLASTIC}{ball}{again}{ball}{again}{ball}")).unwrap();
        assert_eq!(read.scene.surfaces, ["grey", "grey 2"]);
        let surfaces: Vec<u32> = read.scene.elements.iter().map(|e| e.surface).collect();
        assert_eq!(surfaces, [0, 1, 1]);
        assert_eq!(read.materials[1].numbers[0], 0.1);
    }

    #[test]
    fn up_vectors_of_bsdfs_turn_with_their_file() {
        let film = "void BSDF film 6 0.1 film.xml 0 0 1 . 0 0\nfilm sphere s 0 0 4 0 0 0 1\n";
        let read = with(&[("film.rad", film)], "!xform -rx 90 -s 2 film.rad").unwrap();
        assert_eq!(read.materials[0].words, ["0.1", "film.xml", "0", "-1", "0", "."]);
        assert_eq!(read.materials[0].metres_per_unit, 2.0);
    }

    #[test]
    fn a_bsdf_without_texts_is_handed_on() {
        let read = with(&[], "void BSDF film 0 0 0\nfilm sphere s 0 0 4 0 0 0 1\n").unwrap();
        assert!(read.materials[0].words.is_empty());
    }

    #[test]
    fn what_does_not_matter_is_left_out() {
        let text = format!(
            "void light l 0 0 3 1 1 1\nl source sun 0 0 4 0 0 1 .5\nvoid colorfunc p 4 a b c d 0 0\np plastic q 0 0 5 1 1 1 0 0\n\
             {PLASTIC}grey sphere s 0 0 4 0 0 0 1"
        );
        let read = with(&[], &text).unwrap();
        assert_eq!(read.scene.warnings.len(), 1);
        assert!(read.scene.warnings[0].contains("type source"));
    }

    #[test]
    fn faults_are_told_in_one_line_with_their_place() {
        for (text, part) in [
            (
                "grey sphere s 0 0 4 0 0 0 1",
                "line 1: sphere \"s\": its material \"grey\" is not defined above it",
            ),
            ("void sphere s 0 0 4 0 0 0 1", "no material"),
            (
                "void glow g 0 0 4 1 1 1 0\ng sphere s 0 0 4 0 0 0 1",
                "line 2: sphere \"s\": its material \"g\" is of type \"glow\"",
            ),
            ("void antimatter a 1 x 0 0\na sphere s 0 0 4 0 0 0 1", "\"antimatter\""),
            (
                "void brightfunc f 2 a b 0 0\nf plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 1",
                "patterns and textures",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 4 0 0 0 -1",
                "a radius of -1",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np sphere s 0 0 3 0 0 0",
                "3 real arguments, not 4",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np polygon s 0 0 7 0 0 0 1 1 1 2",
                "not three a corner",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np ring s 0 0 8 0 0 0 0 0 0 1 2",
                "a direction of 0 0 0",
            ),
            (
                "void plastic p 0 0 5 1 1 1 0 0\np cone s 0 0 8 0 0 0 0 0 0 1 2",
                "both ends at",
            ),
            (
                "void plastic p 0 0 5 1 1 x 0 0",
                "line 1: \"x\" stands where a real argument should be",
            ),
            (
                "void plastic p 0 0 99999999999 1",
                "the file ends where a real argument should be",
            ),
            ("void plastic", "the file ends where a name should be"),
            ("p instance i 1 a.oct 0 0", "a compiled octree, \"a.oct\""),
            ("p mesh i 1 a.rtm 0 0", "a compiled mesh, \"a.rtm\""),
            ("void alias a b", "alias \"a\" stands for \"b\""),
            ("\n!xform -t 1 0 0 none.rad", "line 2: none.rad: not found"),
            ("!gensky 6 21 12", "the command \"gensky\""),
        ] {
            let error = told(text);
            assert!(error.contains(part) && !error.contains('\n'), "{text}: {error}");
        }
        let inner = with(&[("a.rad", "\n\nbad sphere s 0 0 4 0 0 0 1")], "!xform -t 0 0 1 a.rad").unwrap_err();
        assert!(inner.to_string().starts_with("a.rad, line 3: sphere"), "{inner}");
        let round = with(&[("a.rad", "!xform -t 0 0 1 a.rad")], "!xform -t 0 0 1 a.rad").unwrap_err();
        assert!(round.to_string().contains("32 deep"), "{round}");
        let many = "!xform -a 1000 -t 1 0 0 b.rad";
        let bomb = with(
            &[
                ("a.rad", many),
                ("b.rad", &many.replace("b.rad", "c.rad")),
                ("c.rad", &"#".repeat(100_000)),
            ],
            "!xform -a 9 a.rad",
        );
        assert!(bomb.unwrap_err().to_string().contains("again and again"));
    }
}
