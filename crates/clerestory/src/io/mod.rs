//! Files of the field, read from bytes and written to bytes.

mod faces;
pub mod gzip;
pub mod mtl;
pub mod number;
pub mod obj;
pub mod ply;
mod polygon;
pub mod radiance;
pub mod room;
pub mod stl;
pub mod table;
pub mod xml;

/// A count and its noun: `1 value`, `3 values`.
fn counted(count: usize, noun: &str) -> String {
    format!("{count} {noun}{}", if count == 1 { "" } else { "s" })
}
