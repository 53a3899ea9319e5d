//! Headers of Radiance's pictures: lines, then an empty one, then the resolution.

use super::colour::EFFICACY;
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

/// What the lines of a header have said so far.
struct Said {
    format: Format,
    exposure: f64,
    corrections: [f64; 3],
    view: View,
    /// There was a view.
    seen: bool,
}

impl Said {
    /// Takes a line in.
    fn line(&mut self, text: &str, picture: &mut Picture) -> Result<()> {
        let place = format!("line {}", picture.header.len() + 1);
        let (key, value) = text.split_once('=').unwrap_or((text, ""));
        match key {
            "FORMAT" => {
                self.format = match value.trim() {
                    "32-bit_rle_rgbe" => Format::Rgbe,
                    "32-bit_rle_xyze" => Format::Xyze,
                    other => {
                        return Err(Error::format(
                            place,
                            format!("the format {other:?} is no picture's that can be read"),
                            "give 32-bit_rle_rgbe or 32-bit_rle_xyze; rcomb -fc converts others",
                        ));
                    }
                };
            }
            "EXPOSURE" => {
                let [factor] = numbers(value)
                    .filter(|[e]| *e > 0.0)
                    .ok_or_else(|| positive(&place, text))?;
                self.exposure *= factor;
            }
            "COLORCORR" => {
                let factors: [f64; 3] = numbers(value)
                    .filter(|f: &[f64; 3]| f.iter().all(|e| *e > 0.0))
                    .ok_or_else(|| positive(&place, text))?;
                for (correction, factor) in self.corrections.iter_mut().zip(factors) {
                    *correction *= factor;
                }
            }
            "PIXASPECT" => {
                let [aspect] = numbers(value)
                    .filter(|[a]| *a > 0.0)
                    .ok_or_else(|| positive(&place, text))?;
                picture.pixel_aspect *= aspect;
            }
            "PRIMARIES" => match numbers(value) {
                Some(primaries) => picture.primaries = Some(primaries),
                None => picture
                    .warnings
                    .push(format!("{place}: {text:?} has not eight numbers, and is passed over")),
            },
            "VIEW" => match self.view.update(value) {
                Ok(_) => self.seen = true,
                Err(error) => picture
                    .warnings
                    .push(format!("{place}: {error}; the line is passed over")),
            },
            _ => {}
        }
        Ok(())
    }

    /// What values are divided by.
    fn divisors(&self) -> Result<[f64; 3]> {
        let divisors = self.corrections.map(|c| c * self.exposure);
        if divisors.iter().all(|d| d.is_finite() && *d > 1e-30) {
            return Ok(divisors);
        }
        Err(Error::format(
            "the header",
            format!("its exposures multiply to {divisors:?}"),
            "check the EXPOSURE and COLORCORR lines",
        ))
    }
}

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
    let mut said = Said {
        format: Format::Rgbe,
        exposure: 1.0,
        corrections: [1.0; 3],
        view: View::default(),
        seen: false,
    };
    picture.pixel_aspect = 1.0;
    loop {
        let text = line()?;
        if text.is_empty() {
            break;
        }
        said.line(&text, picture)?;
        picture.header.push(text);
    }
    picture.view = said.seen.then_some(said.view);
    picture.exposure = said.exposure;
    let divisors = said.divisors()?;
    let text = line()?;
    let place = format!("line {}", picture.header.len() + 2);
    let order = resolution(&text).ok_or_else(|| {
        Error::format(
            place.as_str(),
            format!("{text:?} is no resolution such as -Y 600 +X 800"),
            CHECK,
        )
    })?;
    let most = order.lines.checked_mul(order.length).filter(|n| *n <= MOST_PIXELS);
    let left = bytes.len() - begin;
    // Each scanline takes four bytes at least.
    if most.is_none() || order.lines > left / 4 {
        return Err(Error::format(
            place,
            format!("{text:?} is more than {left} bytes of pixels can hold, or more than can be read"),
            CHECK,
        ));
    }
    [picture.width, picture.height] = if order.rows {
        [order.length, order.lines]
    } else {
        [order.lines, order.length]
    };
    Ok(Header {
        format: said.format,
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
    let worked_in = ["FORMAT", "EXPOSURE", "COLORCORR", "VIEW", "PIXASPECT", "PRIMARIES"];
    let mut lines = vec!["#?RADIANCE".to_owned()];
    lines.extend(
        picture
            .header
            .iter()
            .filter(|line| {
                let key = line.split_once('=').map_or("", |(key, _)| key);
                !line.is_empty() && !worked_in.contains(&key) && !line.starts_with("#?")
            })
            .map(|line| line.replace(['\n', '\r'], " ")),
    );
    lines.extend(picture.view.map(|view| format!("VIEW= {view}")));
    if picture.pixel_aspect != 1.0 {
        lines.push(format!("PIXASPECT={}", picture.pixel_aspect));
    }
    match format {
        Format::Rgbe => {
            lines.extend(picture.primaries.map(|p| {
                let words: Vec<String> = p.iter().map(f64::to_string).collect();
                format!("PRIMARIES= {}", words.join(" "))
            }));
            lines.push("FORMAT=32-bit_rle_rgbe".into());
        }
        Format::Xyze => {
            lines.push(format!("EXPOSURE={:e}", 1.0 / EFFICACY));
            lines.push("FORMAT=32-bit_rle_xyze".into());
        }
    }
    lines.push(String::new());
    lines.push(format!("-Y {} +X {}\n", picture.height, picture.width));
    lines.join("\n").into_bytes()
}
