//! Radiance scene files, with `!xform` and simple generators read here: no program is ever run.
//!
//! * Surfaces: `polygon`, `sphere`, `bubble`, `ring`, `cylinder`, `tube`, `cone`, `cup`; `instance` and `mesh`, which need
//!   compiled files, are refused.
//! * Materials are handed on as they are written ([`Description`]). What a surface uses and cannot be traced is refused by
//!   name: mixtures, `antimatter`, and materials under a pattern or a texture, since light would not go where the file says.
//!   What no surface uses does not matter.
//! * Commands: `xform`, `genbox`, `genprism`, `genblinds`, `cat`, and pipes from one of them into `xform`.
//!
//! [`read`] is for samples, which bring no light: lights are refused, and a `source` (sun, sky) is left out with a warning.
//! [`read_room`] is for rooms, with their lights, suns and skies (also `gensky` and `gendaylit`), and data sets of windows.

mod command;
mod generate;
mod reader;
mod room;
mod shapes;
mod sky;
mod sky_options;
#[cfg(test)]
mod tests;
mod words;
mod xform;

pub use room::{parse_room, read_room};
pub use sky::{CieSky, Gendaylit, Gensky, Site, Sky, SkyModel, Supply, When};
pub use xform::{Transform, Xform};

use std::path::{Path, PathBuf};

use self::reader::{Purpose, Reader};
use super::counted;
use super::faces::load;
use crate::error::Result;
use crate::geometry::Scene;

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
    let mut reader = Reader::new(Purpose::Sample, open);
    reader.read(text, "", metres_per_unit)?;
    let count = reader.sources.len();
    let mut scene = reader.faces.finish();
    if count > 0 {
        scene.warnings.push(format!(
            "left out: {} of type source, for the instrument brings its own light",
            counted(count, "object")
        ));
    }
    Ok(Radiance {
        scene,
        materials: reader.materials,
    })
}
