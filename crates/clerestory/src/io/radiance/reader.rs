//! What a scene file says, object by object, with its commands carried out.

use std::collections::HashMap;
use std::rc::Rc;

use super::Description;
use super::command::{self, Source, Stage};
use super::shapes::{Piece, piece};
use super::sky::{Sky, SkyModel, only_transform};
use super::words::{Next, Words, shown};
use super::xform::{self, Transform};
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::io::faces::{Faces, check_unit};
use crate::io::room::Polygon;

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

/// Types of what shines, in rooms.
pub(super) const LIGHTS: [&str; 4] = ["light", "glow", "spotlight", "illum"];
/// Types of patterns that a sky may have.
const PATTERNS: [&str; 2] = ["brightfunc", "colorfunc"];

/// What a scene is read for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Purpose {
    /// For an instrument, which brings its own light.
    Sample,
    /// With its own light.
    Room,
}

/// How what is read is moved and named.
#[derive(Debug, Clone)]
struct Context {
    prefix: String,
    transform: Transform,
    modifier: Option<String>,
    inverted: bool,
    depth: u32,
}

/// A material, pattern or texture with what modifies it.
#[derive(Debug, Clone)]
pub(super) struct Definition {
    pub description: Description,
    pub modifier: Option<usize>,
    /// How a pattern is moved; nothing of anything else.
    pub moved: Option<Transform>,
    /// Number of the sky that it is the pattern of.
    pub sky: Option<usize>,
    /// Number of the file that was asked for in which it is.
    pub origin: usize,
}

/// An object of type `source`.
pub(super) struct Distant {
    pub name: String,
    /// Toward it, of any length.
    pub direction: Vec3,
    /// Full angle (degrees).
    pub angle: f64,
    /// Number of its material's definition.
    pub definition: usize,
    pub place: String,
}

/// A scene in the making.
pub(super) struct Reader<'a> {
    purpose: Purpose,
    pub faces: Faces,
    pub materials: Vec<Description>,
    /// Numbers of the files that were asked for in which they are.
    pub origins: Vec<usize>,
    /// Flat surfaces, in rooms.
    pub polygons: Vec<Polygon>,
    /// In a sample they are counted, and nothing else of them matters.
    pub sources: Vec<Option<Distant>>,
    pub skies: Vec<Sky>,
    pub definitions: Vec<Definition>,
    /// Latest definition of each name.
    current: HashMap<String, usize>,
    /// Surface of the scene by definition.
    surfaces: HashMap<usize, u32>,
    files: HashMap<String, Rc<Vec<u8>>>,
    budget: usize,
    origin: usize,
    open: &'a mut dyn FnMut(&str) -> Result<Vec<u8>>,
}

impl<'a> Reader<'a> {
    /// Files that the scene names are loaded by `open`.
    pub fn new(purpose: Purpose, open: &'a mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Self {
        Self {
            purpose,
            faces: Faces::default(),
            materials: Vec::new(),
            origins: Vec::new(),
            polygons: Vec::new(),
            sources: Vec::new(),
            skies: Vec::new(),
            definitions: Vec::new(),
            current: HashMap::new(),
            surfaces: HashMap::new(),
            files: HashMap::new(),
            budget: BUDGET,
            origin: 0,
            open,
        }
    }

    /// Reads a file that was asked for, by its name in messages.
    pub fn read(&mut self, text: &[u8], name: &str, metres_per_unit: f64) -> Result<()> {
        check_unit(metres_per_unit)?;
        let context = Context {
            prefix: String::new(),
            transform: Transform::sized(metres_per_unit),
            modifier: None,
            inverted: false,
            depth: 0,
        };
        self.file(text, name, &context)?;
        // Names in the next one may mean other files.
        self.files.clear();
        self.origin += 1;
        Ok(())
    }

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
    fn load(&mut self, name: &str) -> Result<Rc<Vec<u8>>> {
        if let Some(known) = self.files.get(name) {
            return Ok(known.clone());
        }
        let text = Rc::new((self.open)(name)?);
        self.files.insert(name.to_owned(), text.clone());
        Ok(text)
    }

    fn command(&mut self, line: &str, context: &Context, place: &str) -> Result<()> {
        if context.depth >= MOST_NESTED {
            return Err(Error::Argument(format!(
                "files within files, {MOST_NESTED} deep (does one name itself?)"
            )));
        }
        let Stage { source, xforms } = command::parse(line, self.purpose, &mut *self.open)?;
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
            Source::Sky(model) => {
                for context in &contexts {
                    self.generated_sky(&model, context, place)?;
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
            "source" if self.purpose == Purpose::Sample => self.sources.push(None),
            "source" => {
                let source = self.source(modifier, &name, &numbers, context, &place).map_err(fail)?;
                self.sources.push(Some(source));
            }
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
                    turn_up_vector(&mut texts, usize::from(kind == "BSDF"), &context.transform);
                }
                if kind == "spotlight" {
                    turn_spot(&mut numbers, &context.transform);
                }
                let description = Description {
                    name: name.clone(),
                    kind,
                    words: texts,
                    numbers,
                    metres_per_unit: context.transform.scale,
                    place,
                };
                self.define(name, description, modifier, context);
            }
        }
        Ok(())
    }

    fn define(&mut self, name: String, description: Description, modifier: &str, context: &Context) {
        let modifier = self.current.get(modifier).copied();
        let moved = PATTERNS
            .contains(&description.kind.as_str())
            .then_some(context.transform);
        // A file that is read again for each copy of an array defines the same materials each time.
        if let Some(&known) = self.current.get(&name) {
            let same = &self.definitions[known];
            if same.description.is_like(&description) && same.modifier == modifier && same.moved == moved {
                return;
            }
        }
        self.current.insert(name, self.definitions.len());
        self.definitions.push(Definition {
            description,
            modifier,
            moved,
            sky: None,
            origin: self.origin,
        });
    }

    /// The sky that a command describes, and its pattern.
    fn generated_sky(&mut self, model: &SkyModel, context: &Context, place: &str) -> Result<()> {
        let sky = Sky {
            name: PATTERN_OF_GENERATORS.into(),
            model: model.clone(),
            turn_deg: turn_of(&context.transform)?,
            place: place.into(),
        };
        let description = Description {
            name: PATTERN_OF_GENERATORS.into(),
            kind: PATTERNS[0].into(),
            words: Vec::new(),
            numbers: Vec::new(),
            metres_per_unit: context.transform.scale,
            place: place.into(),
        };
        self.current
            .insert(PATTERN_OF_GENERATORS.into(), self.definitions.len());
        self.definitions.push(Definition {
            description,
            modifier: None,
            moved: None,
            sky: Some(self.skies.len()),
            origin: self.origin,
        });
        self.skies.push(sky);
        Ok(())
    }

    fn source(&self, modifier: &str, name: &str, numbers: &[f64], context: &Context, place: &str) -> Result<Distant> {
        let &[x, y, z, angle] = numbers else {
            return Err(Error::Argument(format!("{} real arguments, not 4", numbers.len())));
        };
        let direction = context.transform.vector(Vec3::new(x, y, z));
        if direction.length() <= 0.0 {
            return Err(Error::Argument("a direction of 0 0 0".into()));
        }
        if !(0.0..=360.0).contains(&angle) {
            return Err(Error::Argument(format!("an angle of {angle}°, not from 0 to 360")));
        }
        let modifier = context.modifier.as_deref().unwrap_or(modifier);
        let Some(&definition) = self.current.get(modifier) else {
            return Err(Error::Argument(if modifier == "void" {
                "it has no material (its modifier is void)".into()
            } else {
                format!("its material {} is not defined above it", shown(modifier))
            }));
        };
        Ok(Distant {
            name: format!("{}{name}", context.prefix),
            direction,
            angle,
            definition,
            place: place.into(),
        })
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
        let Definition {
            description,
            modifier,
            origin,
            ..
        } = &self.definitions[index];
        let mut known = MATERIALS.to_vec();
        if self.purpose == Purpose::Room {
            known.extend(LIGHTS);
        }
        if !known.contains(&description.kind.as_str()) {
            return Err(format!(
                "its material {} is of type {}, which cannot be traced (there are {})",
                shown(name),
                shown(&description.kind),
                known.join(", ")
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
        self.origins.push(*origin);
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
        match piece(kind, numbers, &context.transform, context.inverted)? {
            Piece::Polygon(corners) => self.polygon(name, &corners, surface, context, place),
            Piece::Round(shape) => {
                let object = self.faces.scene.object(format!("{}{name}", context.prefix));
                self.faces.scene.push(shape, surface, object);
                self.full()
            }
        }
    }

    fn polygon(&mut self, name: &str, corners: &[Vec3], surface: u32, context: &Context, place: &str) -> Result<()> {
        let mut corners: Vec<Vec3> = corners.iter().map(|&c| context.transform.point(c)).collect();
        // A mirror turns the sense of corners round, and so the front.
        if context.transform.mirrors != context.inverted {
            corners.reverse();
        }
        let name = format!("{}{name}", context.prefix);
        let object = self.faces.scene.object(name.as_str());
        if self.purpose == Purpose::Room {
            self.polygons.push(Polygon {
                object,
                surface,
                corners: corners.clone(),
            });
        }
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

/// The name that the sky's generators give their pattern.
const PATTERN_OF_GENERATORS: &str = "skyfunc";

/// Angle of a turn about the vertical (degrees), counter-clockwise as seen from above: the only one that a sky can have.
pub(super) fn turn_of(transform: &Transform) -> Result<f64> {
    transform.about_vertical().ok_or_else(|| {
        Error::Unsupported("a sky that is tilted or mirrored (turn it about z alone, by xform -rz)".into())
    })
}

/// Turns the direction among a spotlight's numbers, which keeps its length.
fn turn_spot(numbers: &mut [f64], transform: &Transform) {
    if let &mut [_, _, _, _, ref mut x, ref mut y, ref mut z] = numbers {
        let turned = transform.vector(Vec3::new(*x, *y, *z)) * (1.0 / transform.scale);
        [*x, *y, *z] = turned.array();
    }
}

/// Turns the up vector among a BSDF's texts, the file's name first, if it is of numbers, by the transform behind it, which is
/// taken off if it does not mirror, and then as everything in its file.
fn turn_up_vector(texts: &mut Vec<String>, from: usize, transform: &Transform) {
    let Some(up) = texts.get(from + 1..from + 4) else {
        return;
    };
    let numbers: Vec<f64> = up.iter().filter_map(|w| w.parse().ok()).collect();
    let &[x, y, z] = numbers.as_slice() else { return };
    let mut up = Vec3::new(x, y, z);
    if let Some(own) = texts.get(from + 5..)
        && let Ok(own) = only_transform(own)
        && !own.mirrors
    {
        up = own.vector(up) * (1.0 / own.scale);
        texts.truncate(from + 5);
    }
    let up = transform.vector(up) * (1.0 / transform.scale);
    for (word, value) in texts[from + 1..].iter_mut().zip(up.array()) {
        *word = value.to_string();
    }
}
