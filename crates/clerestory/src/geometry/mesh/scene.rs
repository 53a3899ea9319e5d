//! What a file or a program says is there, before it is made ready for rays.

use std::collections::HashMap;

use super::shape::Shape;

/// A shape with its surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Element {
    /// Where it is.
    pub shape: Shape,
    /// Number of its surface's name in the scene, and of its surface in the sample's list.
    pub surface: u32,
    /// Number of its object's name in the scene.
    pub object: u32,
}

/// Shapes and their names.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The shapes.
    pub elements: Vec<Element>,
    /// Names of surfaces.
    pub surfaces: Vec<String>,
    /// Names of objects, for messages.
    pub objects: Vec<String>,
    /// What was odd but harmless.
    pub warnings: Vec<String>,
    known: HashMap<String, u32>,
}

impl Scene {
    /// Number of a surface's name; it is added if it is new.
    pub fn surface(&mut self, name: &str) -> u32 {
        if let Some(&known) = self.known.get(name) {
            return known;
        }
        let number = self.surfaces.len() as u32;
        self.surfaces.push(name.to_owned());
        self.known.insert(name.to_owned(), number);
        number
    }

    /// Whether a surface has this name.
    pub fn has_surface(&self, name: &str) -> bool {
        self.known.contains_key(name)
    }

    /// Adds an object's name; its number.
    pub fn object(&mut self, name: impl Into<String>) -> u32 {
        self.objects.push(name.into());
        self.objects.len() as u32 - 1
    }

    /// Adds a shape.
    pub fn push(&mut self, shape: Shape, surface: u32, object: u32) {
        self.elements.push(Element { shape, surface, object });
    }

    /// What an element is called in messages: its object's name, and which of its triangles or other shapes it is.
    pub fn name(&self, element: usize) -> String {
        let Element { shape, object, .. } = self.elements[element];
        let kind = match shape {
            Shape::Triangle(_) => "triangle",
            Shape::Sphere { .. } => "sphere",
            Shape::Ring { .. } => "ring",
            Shape::Cone { .. } => "cone or cylinder",
        };
        let of_object = |e: &&Element| e.object == object;
        let index = self.elements[..element].iter().filter(of_object).count() + 1;
        let alone = !self.elements[element + 1..].iter().any(|e| e.object == object) && index == 1;
        let name = self.objects.get(object as usize).map_or("?", String::as_str);
        if alone {
            format!("{name:?} ({kind})")
        } else {
            format!("{name:?} ({kind} {index})")
        }
    }
}
