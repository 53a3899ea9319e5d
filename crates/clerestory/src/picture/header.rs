//! Headers of Radiance's pictures: lines, then an empty one, then the resolution.

use super::image::{MOST_PIXELS, Picture};
use super::view::View;
use crate::error::{Error, Result};

/// How the four bytes of a pixel are meant.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Rgbe,
    Xyze,
}

/// Order in which pixels follow.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Order {
    /// Number of scanlines and their length.
    pub lines: usize,
    pub length: usize,
    /// Scanlines are rows.
    pub rows: bool,
    /// From the top to the bottom.
    pub down: bool,
    /// From the left to the right.
    pub right: bool,
}

/// A header that was read, and what it says of how to read on.
pub(super) struct Header {
    pub format: Format,
    pub order: Order,
    /// What values are divided by.
    pub divisors: [f64; 3],
    /// Where the pixels begin.
    pub begin: usize,
}

const CHECK: &str = "check that this is a Radiance picture (.hdr, .pic) and that it is whole";
/// Longest line that is taken for one of a header.
const LONGEST: usize = 1 << 16;

/// Reads a header into a picture without pixels.
pub(super) fn read(bytes: &[u8], picture: &mut Picture) -> Result<Header> {
    if !bytes.starts_with(b"#?") {
        return Err(Error::format("byte 0", "it does not begin with #?RADIANCE", CHECK));
    }
    let mut begin = 0;
    let mut number = 0;
    let mut line = || -> Result<String> {
        number += 1;
        let rest = &bytes[begin..];
        let end = memchr::memchr(b'\n', &rest[..rest.len().min(LONGEST)])
            .ok_or_else(|| Error::format(format!("line {number}"), "the header does not end", CHECK))?;
        begin += end + 1;
        let text = rest[..end].strip_suffix(b"\r").unwrap_or(&rest[..end]);
        Ok(String::from_utf8_lossy(text).into_owned())
    };
    let mut divisors = [1.0; 3];
    let mut format = Format::Rgbe;
    let mut exposure = 1.0;
    let mut view = View::default();
    let mut seen = false;
    picture.pixel_aspect = 1.0;
    loop {
        let text = line()?;
        if text.is_empty() {
            break;
        }
        let place = format!("line {}", picture.header.len() + 1);
        let (key, value) = text.split_once('=').unwrap_or((&text, ""));
        match key {
            "FORMAT" => {
                format = match value.trim() {
                    "32-bit_rle_rgbe" => Format::Rgbe,
                    "32-bit_rle_xyze" => Format::Xyze,
                    other => {
                        return Err(Error::format(
                            place,
                            format!("the format {other:?} is no picture's that can be read"),
                            "give 32-bit_rle_rgbe or 32-bit_rle_xyze; getinfo -c and rcomb -fc convert others",
                        ));
                    }
                };
            }
            "EXPOSURE" => {
                let [factor] = numbers::<1>(value)
                    .filter(|[e]| *e > 0.0)
                    .ok_or_else(|| positive(&place, &text))?;
                exposure *= factor;
            }
            "COLORCORR" => {
                let factors = numbers::<3>(value)
                    .filter(|f| f.iter().all(|e| *e > 0.0))
                    .ok_or_else(|| positive(&place, &text))?;
                for (divisor, factor) in divisors.iter_mut().zip(factors) {
                    *divisor *= factor;
                }
            }
            "PIXASPECT" => {
                let [aspect] = numbers::<1>(value)
                    .filter(|[a]| *a > 0.0)
                    .ok_or_else(|| positive(&place, &text))?;
                picture.pixel_aspect *= aspect;
            }
            "PRIMARIES" => match numbers::<8>(value) {
                Some(primaries) => picture.primaries = Some(primaries),
                None => picture
                    .warnings
                    .push(format!("{place}: {text:?} has not eight numbers, and is passed over")),
            },
            "VIEW" => match view.update(value) {
                Ok(_) => seen = true,
                Err(error) => picture
                    .warnings
                    .push(format!("{place}: {error}; the line is passed over")),
            },
            _ => {}
        }
        picture.header.push(text);
    }
    picture.view = seen.then_some(view);
    picture.exposure = exposure;
    for divisor in &mut divisors {
        *divisor *= exposure;
        if !(divisor.is_finite() && *divisor > 1e-30) {
            return Err(Error::format(
                "the header",
                format!("its exposures multiply to {divisor}"),
                "check the EXPOSURE lines",
            ));
        }
    }
    let text = line()?;
    let order = resolution(&text).ok_or_else(|| {
        Error::format(
            format!("line {}", picture.header.len() + 2),
            format!("{text:?} is no resolution such as -Y 600 +X 800"),
            CHECK,
        )
    })?;
    let most = order.lines.checked_mul(order.length).filter(|n| *n <= MOST_PIXELS);
    // Each scanline takes four bytes at least.
    if most.is_none() || order.lines > (bytes.len() - begin) / 4 {
        return Err(Error::format(
            format!("line {}", picture.header.len() + 2),
            format!(
                "{text:?} is more than {} bytes of pixels can hold, or more than can be read",
                bytes.len() - begin
            ),
            CHECK,
        ));
    }
    [picture.width, picture.height] = if order.rows {
        [order.length, order.lines]
    } else {
        [order.lines, order.length]
    };
    Ok(Header {
        format,
        order,
        divisors,
        begin,
    })
}

fn positive(place: &str, text: &str) -> Error {
    Error::format(
        place,
        format!("{text:?} has no positive number"),
        "correct or remove the line",
    )
}

fn numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let mut words = text.split_ascii_whitespace();
    let mut found = [0.0; N];
    for value in &mut found {
        *value = words.next()?.parse().ok().filter(|v: &f64| v.is_finite())?;
    }
    words.next().is_none().then_some(found)
}

fn resolution(text: &str) -> Option<Order> {
    let words: Vec<&str> = text.split_ascii_whitespace().collect();
    let [first, lines, second, length] = words[..] else {
        return None;
    };
    let axis = |word: &str| {
        Some(match word {
            "-Y" => ('Y', false),
            "+Y" => ('Y', true),
            "-X" => ('X', false),
            "+X" => ('X', true),
            _ => return None,
        })
    };
    let ((major, forward), (minor, along)) = (axis(first)?, axis(second)?);
    let count = |word: &str| word.parse::<usize>().ok().filter(|n| *n > 0);
    let (lines, length) = (count(lines)?, count(length)?);
    let rows = major == 'Y';
    (major != minor).then_some(Order {
        lines,
        length,
        rows,
        down: !(if rows { forward } else { along }),
        right: if rows { along } else { forward },
    })
}

/// The header of a picture that is written: its lines but those that the reader has worked into the values.
pub(super) fn write(picture: &Picture, format: Format) -> Vec<u8> {
    let mut text = String::from("#?RADIANCE\n");
    for line in &picture.header {
        let key = line.split_once('=').map_or("", |(key, _)| key);
        let gone = ["FORMAT", "EXPOSURE", "COLORCORR", "VIEW", "PIXASPECT", "PRIMARIES"].contains(&key);
        if !gone && !line.starts_with("#?") {
            text.push_str(&line.replace(['\n', '\r'], " "));
            text.push('\n');
        }
    }
    if let Some(view) = &picture.view {
        text.push_str(&format!("VIEW= {view}\n"));
    }
    if picture.pixel_aspect != 1.0 {
        text.push_str(&format!("PIXASPECT={}\n", picture.pixel_aspect));
    }
    match format {
        Format::Rgbe => {
            if let Some(p) = &picture.primaries {
                let words: Vec<String> = p.iter().map(f64::to_string).collect();
                text.push_str(&format!("PRIMARIES= {}\n", words.join(" ")));
            }
            text.push_str("FORMAT=32-bit_rle_rgbe\n");
        }
        Format::Xyze => {
            text.push_str(&format!(
                "EXPOSURE={:e}\nFORMAT=32-bit_rle_xyze\n",
                1.0 / super::colour::EFFICACY
            ));
        }
    }
    text.push_str(&format!("\n-Y {} +X {}\n", picture.height, picture.width));
    text.into_bytes()
}
