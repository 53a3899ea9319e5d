//! BSDF XML: the files of WINDOW 6/7, Radiance and genBSDF, with matrices on any angle bases and tensor trees.
//!
//! * To read one: [`read`]. Faults that a person would still understand end up in [`Bsdf::warnings`](crate::bsdf::Bsdf);
//!   what could mean two things is refused unless the [`Hints`] decide it.
//! * To write one: [`write`], for a [`Target`] program.
//!
//! Here, and only here, *front* and *back* are spoken of: the files' "Front" is the exterior side. A file's incident
//! patch is named by the azimuth in which the light travels, which is also what [`Disk`](crate::direction::Disk) does, so
//! patch numbers are taken as they stand.

mod basis;
mod blocks;
pub mod fields;
mod metadata;
mod names;
mod read;
mod scan;
mod target;
mod write;

pub use read::{Hints, read};
pub use target::Target;
pub use write::write;

use super::counted;

/// Path of the one `<Layer>`.
const LAYER: &str = "WindowElement/Optical/Layer";

/// How the comment that names this program begins.
const WRITTEN_BY: &str = "Written by Clerestory";

/// `line N, <element>`, for an offset in a file's bytes.
fn place(bytes: &[u8], at: usize, element: &str) -> String {
    let line = 1 + memchr::memchr_iter(b'\n', &bytes[..at.min(bytes.len())]).count();
    if element.is_empty() {
        format!("line {line}")
    } else {
        format!("line {line}, <{element}>")
    }
}

/// Faults of a file that do not stop the reading.
struct Faults<'a> {
    bytes: &'a [u8],
    warnings: Vec<String>,
    untold: usize,
}

impl<'a> Faults<'a> {
    /// A file that is wrong all over is not described for ever.
    const MOST: usize = 50;

    fn new(bytes: &'a [u8]) -> Self {
        Self {
            bytes,
            warnings: Vec::new(),
            untold: 0,
        }
    }

    fn warn(&mut self, at: usize, element: &str, what: impl std::fmt::Display) {
        if self.warnings.len() < Self::MOST {
            self.warnings
                .push(format!("{}: {what}", place(self.bytes, at, element)));
        } else {
            self.untold += 1;
        }
    }

    fn finish(mut self) -> Vec<String> {
        if self.untold > 0 {
            self.warnings
                .push(format!("and {} more", counted(self.untold, "warning")));
        }
        self.warnings
    }
}
