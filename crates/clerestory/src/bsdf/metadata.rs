//! What a data set says of its sample besides scattering.

/// A piece of a file's XML that is carried along as it was: name, attributes, text and children.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Element {
    /// Local name, without namespace prefix.
    pub name: String,
    /// Attributes in file order.
    pub attributes: Vec<(String, String)>,
    /// Text, trimmed.
    pub text: String,
    /// Child elements in file order.
    pub children: Vec<Element>,
}

impl Element {
    /// A leaf.
    pub fn leaf(name: impl Into<String>, text: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            text: text.into(),
            ..Self::default()
        }
    }

    /// First child of a name.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|c| c.name == name)
    }

    /// Value of an attribute.
    pub fn attribute(&self, name: &str) -> Option<&str> {
        self.attributes.iter().find(|(n, _)| n == name).map(|(_, v)| v.as_str())
    }
}

/// Descriptive data of a sample, kept through reading and writing.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Metadata {
    /// `System`, `Layer` or `Material`.
    pub element_type: Option<String>,
    /// The file's `<Material>`: names, dimensions, emissivities and so on.
    pub material: Option<Element>,
    /// The file's `<Geometry>`, an embedded model of the sample.
    pub geometry: Option<Element>,
    /// Comments of the file's head: often the command that made it.
    pub comments: Vec<String>,
    /// Other elements that the file held, by the path of their parent, for example `WindowElement/Optical`.
    pub other: Vec<(String, Element)>,
}

impl Metadata {
    /// Text of a `<Material>` field, if it is there and not empty.
    pub fn material_text(&self, field: &str) -> Option<&str> {
        let text = &self.material.as_ref()?.child(field)?.text;
        (!text.is_empty()).then_some(text.as_str())
    }

    /// Number in a `<Material>` field.
    pub fn material_number(&self, field: &str) -> Option<f64> {
        self.material_text(field)?.parse().ok()
    }

    /// Length of a `<Material>` field in metres, by its `unit` attribute (metre where there is none).
    pub fn material_length_m(&self, field: &str) -> Option<f64> {
        let element = self.material.as_ref()?.child(field)?;
        let value: f64 = element.text.parse().ok()?;
        Some(value * Self::metres_in(element.attribute("unit").unwrap_or("meter"))?)
    }

    /// Length of a unit by the name that files give it, in any case.
    pub fn metres_in(unit: &str) -> Option<f64> {
        match unit.trim().to_ascii_lowercase().as_str() {
            "meter" => Some(1.0),
            "centimeter" => Some(0.01),
            "millimeter" => Some(0.001),
            "inch" => Some(0.0254),
            "foot" => Some(0.3048),
            _ => None,
        }
    }

    /// The data of the sample turned about its vertical axis: its faces change their emissivities.
    #[must_use]
    pub fn flipped(&self) -> Self {
        let mut result = self.clone();
        for field in result.material.iter_mut().flat_map(|m| &mut m.children) {
            field.name = match field.name.as_str() {
                "EmissivityFront" => "EmissivityBack".into(),
                "EmissivityBack" => "EmissivityFront".into(),
                _ => continue,
            };
        }
        result
    }

    /// Sets a `<Material>` field, replacing its text.
    pub fn set_material(&mut self, field: &str, text: &str, unit: Option<&str>) {
        let material = self.material.get_or_insert_with(|| Element::leaf("Material", ""));
        let mut element = Element::leaf(field, text);
        if let Some(unit) = unit {
            element.attributes.push(("unit".into(), unit.into()));
        }
        match material.children.iter_mut().find(|c| c.name == field) {
            Some(old) => *old = element,
            None => material.children.push(element),
        }
    }
}
