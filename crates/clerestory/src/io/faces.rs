//! Faces as files hold them, gathered into a scene.

use super::polygon::{is_nothing, triangles};
use crate::error::{Error, Result};
use crate::geometry::{Scene, Shape, Vec3};

/// A scene in the making.
#[derive(Debug, Default)]
pub(super) struct Faces {
    pub scene: Scene,
    left_out: usize,
    first: String,
}

impl Faces {
    /// Adds a face as triangles. One without area, which no light can meet, is left out.
    pub fn add(&mut self, corners: &[Vec3], surface: u32, object: u32, place: impl Fn() -> String) -> Result<()> {
        if is_nothing(corners) {
            if self.left_out == 0 {
                self.first = place();
            }
            self.left_out += 1;
            return Ok(());
        }
        let cut = triangles(corners).map_err(|e| match e {
            Error::Argument(what) => Error::format(place(), what, "repair this face"),
            e => e,
        })?;
        for [a, b, c] in cut {
            self.scene
                .push(Shape::Triangle([corners[a], corners[b], corners[c]]), surface, object);
        }
        Ok(())
    }

    /// The scene, with a warning if something was left out.
    pub fn finish(mut self) -> Scene {
        if self.left_out > 0 {
            let (count, first) = (self.left_out, self.first);
            self.scene.warnings.push(format!(
                "{count} faces without area were left out, the first one at {first}"
            ));
        }
        self.scene
    }
}

/// Refuses a unit that is none.
pub(super) fn check_unit(metres_per_unit: f64) -> Result<()> {
    if metres_per_unit.is_finite() && metres_per_unit > 0.0 {
        return Ok(());
    }
    Err(Error::Argument(format!(
        "a unit of {metres_per_unit} m (give the metres that a unit of the file stands for)"
    )))
}

/// A file's bytes.
pub(super) fn load(path: &std::path::Path) -> Result<Vec<u8>> {
    std::fs::read(path).map_err(|e| Error::Io(format!("{}: {e}", path.display())))
}

/// What a surface is called that has no name.
pub(super) const UNNAMED: &str = "surface";
