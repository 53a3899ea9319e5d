//! Files of the field, read from bytes and written to bytes.

pub mod gzip;
pub mod number;
pub mod radiance;
pub mod xml;
