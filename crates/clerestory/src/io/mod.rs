//! Files of the field, read from bytes and written to bytes.

mod faces;
pub mod gzip;
pub mod number;
pub mod obj;
pub mod ply;
mod polygon;
pub mod radiance;
pub mod stl;
pub mod xml;
