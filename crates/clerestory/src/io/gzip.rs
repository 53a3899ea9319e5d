//! Gzip by content, with a limit on how much a small file may swell to.

use std::borrow::Cow;
use std::io::Read;

use flate2::read::MultiGzDecoder;

use crate::error::{Error, Result};

/// What any file may swell to (bytes): a WINDOW file of eight matrices on Klems' full basis is 2 MB long.
const ALWAYS_ALLOWED: u64 = 64 << 20;

/// What a byte beyond that may swell to. Measured numbers pack to a quarter or so; only files of constants, as WINDOW
/// makes for ideal diffusers, swell by 130, and these are small. Gzip's own maximum is 1,030, so that a bomb of a megabyte
/// could ask for a gigabyte.
const HIGHEST_RATIO: u64 = 50;

/// How much of the start is shown to the check.
const HEAD: usize = 64 << 10;

/// Whether bytes begin like a gzip file.
pub fn is_gzip(bytes: &[u8]) -> bool {
    bytes.starts_with(&[0x1f, 0x8b])
}

/// The bytes themselves, or what they unpack to if they are gzip.
///
/// `looks_right` is shown the first 64 KiB (or all, if it is less) so that a bomb of zeros ends early.
pub fn inflate(bytes: &[u8], looks_right: impl Fn(&[u8]) -> Result<()>) -> Result<Cow<'_, [u8]>> {
    if !is_gzip(bytes) {
        return Ok(Cow::Borrowed(bytes));
    }
    let broken = |e: std::io::Error| {
        let what = match e.kind() {
            std::io::ErrorKind::UnexpectedEof => "the gzip data end too early".to_owned(),
            _ => format!("the gzip data are damaged: {e}"),
        };
        Error::format("gzip", what, "get the file again")
    };
    let limit = ALWAYS_ALLOWED + HIGHEST_RATIO * bytes.len() as u64;
    let mut decoder = MultiGzDecoder::new(bytes).take(limit + 1);
    let mut text = Vec::new();
    decoder
        .by_ref()
        .take(HEAD as u64)
        .read_to_end(&mut text)
        .map_err(broken)?;
    looks_right(&text)?;
    decoder.read_to_end(&mut text).map_err(broken)?;
    if text.len() as u64 > limit {
        return Err(Error::format(
            "gzip",
            format!("{} bytes unpack to more than {} MiB", bytes.len(), limit >> 20),
            "if it is meant to be so, unpack it (gunzip) and give the plain file",
        ));
    }
    Ok(Cow::Owned(text))
}

/// Bytes packed by gzip, the same for the same input.
pub fn deflate(bytes: &[u8]) -> Vec<u8> {
    use std::io::Write;
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    // Writing to memory cannot fail.
    encoder.write_all(bytes).expect("memory takes all bytes");
    encoder.finish().expect("memory takes all bytes")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn packed_bytes_come_back() {
        let text: Vec<u8> = (0..200_000_u32).map(|k| (k % 251) as u8).collect();
        assert_eq!(*inflate(&deflate(&text), |_| Ok(())).unwrap(), *text);
        assert!(matches!(inflate(&text, |_| Ok(())).unwrap(), Cow::Borrowed(_)));
    }

    #[test]
    fn bombs_and_damage_are_refused() {
        // Members one behind the other are one file.
        let bomb = deflate(&vec![b' '; 8 << 20]).repeat(9);
        assert!(bomb.len() < 100_000);
        let error = inflate(&bomb, |_| Ok(())).unwrap_err().to_string();
        assert!(error.contains("unpack to more than 67 MiB"), "{error}");
        assert!(inflate(&deflate(&vec![b' '; 8 << 20]).repeat(8), |_| Ok(())).is_ok());

        let packed = deflate(b"some words that are worth packing");
        let error = inflate(&packed[..packed.len() - 9], |_| Ok(()))
            .unwrap_err()
            .to_string();
        assert!(error.contains("end too early"), "{error}");
        let mut damaged = packed;
        damaged[14] ^= 0xff;
        assert!(inflate(&damaged, |_| Ok(())).is_err());
    }

    #[test]
    fn the_check_sees_the_head_before_the_rest_is_unpacked() {
        let packed = deflate(&vec![0; 8 << 20]);
        let refuse = |head: &[u8]| {
            assert_eq!(head.len(), HEAD);
            Err(Error::Argument("zeros".into()))
        };
        assert_eq!(inflate(&packed, refuse).unwrap_err().to_string(), "zeros");
    }
}
