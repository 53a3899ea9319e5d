//! Radiance's pictures (RGBE and XYZE), from bytes and to bytes.
//!
//! What is read is divided by all exposures and colour corrections of the header; what is written has none. XYZE holds
//! photometric values, 179 times radiometric ones, as `ra_xyze` writes them.

use rayon::prelude::*;

use super::colour::{EFFICACY, PRIMARIES, apply, from_xyz, to_xyz};
use super::header::{self, Format};
use super::image::Picture;
use super::scanline::{self, Input};
use crate::error::Result;

/// Reads a picture from the bytes of a file.
pub fn read(bytes: &[u8]) -> Result<Picture> {
    let mut picture = Picture::default();
    let head = header::read(bytes, &mut picture)?;
    let order = head.order;
    let mut coded: Vec<[u8; 4]> = Vec::new();
    let mut input = Input(&bytes[head.begin..]);
    for line in 0..order.lines {
        // Grows as scanlines come, so that a wrong resolution ends before it takes memory.
        coded.resize((line + 1) * order.length, [0; 4]);
        input.scanline(&mut coded[line * order.length..])?;
    }
    let [width, height] = [picture.width, picture.height];
    let place = |at: usize| {
        let (row, column) = (at / width, at % width);
        let row = if order.down { row } else { height - 1 - row };
        let column = if order.right { column } else { width - 1 - column };
        if order.rows {
            row * order.length + column
        } else {
            column * order.length + row
        }
    };
    let scale = head.divisors.map(|d| 1.0 / d);
    let powers: Vec<f64> = (0..256).map(|e| 2_f64.powi(e - 136)).collect();
    let decode = |[r, g, b, e]: [u8; 4]| -> [f64; 3] {
        if e == 0 {
            return [0.0; 3];
        }
        let power = powers[usize::from(e)];
        [
            (f64::from(r) + 0.5) * power * scale[0],
            (f64::from(g) + 0.5) * power * scale[1],
            (f64::from(b) + 0.5) * power * scale[2],
        ]
    };
    let matrix = match head.format {
        Format::Rgbe => None,
        Format::Xyze => {
            let primaries = picture.primaries.get_or_insert(PRIMARIES);
            Some(from_xyz(primaries)?.map(|row| row.map(|v| v / EFFICACY)))
        }
    };
    let straight = order.rows && order.down && order.right;
    picture.pixels = (0..width * height)
        .into_par_iter()
        .with_min_len(1 << 14)
        .map(|at| {
            let value = decode(coded[if straight { at } else { place(at) }]);
            matrix.as_ref().map_or(value, |m| apply(m, value)).map(|v| v as f32)
        })
        .collect();
    Ok(picture)
}

/// Writes a picture as RGBE.
pub fn write(picture: &Picture) -> Vec<u8> {
    code(picture, Format::Rgbe, |p| p)
}

/// Writes a picture as XYZE.
///
/// # Errors
/// Its primaries are no colours.
pub fn write_xyze(picture: &Picture) -> Result<Vec<u8>> {
    let matrix = to_xyz(picture.primaries.as_ref().unwrap_or(&PRIMARIES))?;
    Ok(code(picture, Format::Xyze, |p| apply(&matrix, p)))
}

fn code(picture: &Picture, format: Format, convert: impl Fn([f64; 3]) -> [f64; 3] + Sync) -> Vec<u8> {
    let rows: Vec<Vec<u8>> = picture
        .pixels
        .par_chunks(picture.width.max(1))
        .map(|row| {
            let pixels: Vec<[u8; 4]> = row.iter().map(|p| encode(convert(p.map(f64::from)))).collect();
            let mut bytes = Vec::with_capacity(pixels.len() * 4);
            scanline::write(&pixels, &mut bytes);
            bytes
        })
        .collect();
    let mut bytes = header::write(picture, format);
    bytes.extend(rows.into_iter().flatten());
    bytes
}

/// Three mantissas, cut off, and their exponent. What is negative or not a number is 0, and what is too large the largest.
fn encode(values: [f64; 3]) -> [u8; 4] {
    let largest = values.iter().fold(0.0_f64, |a, &b| a.max(b));
    if largest <= 1e-32 {
        return [0; 4];
    }
    let largest = largest.min(1.7e38);
    // The power of two above the largest value.
    let mut exponent = largest.log2().floor() as i32 + 1;
    if 2_f64.powi(exponent) <= largest {
        exponent += 1;
    }
    if 2_f64.powi(exponent - 1) > largest {
        exponent -= 1;
    }
    let scale = 2_f64.powi(8 - exponent);
    let mantissa = |v: f64| if v > 0.0 { (v * scale).min(255.0) as u8 } else { 0 };
    [
        mantissa(values[0]),
        mantissa(values[1]),
        mantissa(values[2]),
        (exponent + 128).clamp(1, 255) as u8,
    ]
}

#[cfg(test)]
mod tests {
    use super::super::View;
    use super::*;
    use crate::geometry::Vec3;

    fn flat(head: &str, pixels: &[[u8; 4]]) -> Vec<u8> {
        let mut bytes = head.as_bytes().to_vec();
        bytes.extend_from_slice(pixels.as_flattened());
        bytes
    }

    #[test]
    fn what_is_written_is_read_again() {
        let pixels: Vec<[f32; 3]> = (0..60_u16)
            .map(|k| {
                let k = f32::from(k);
                [k * k, 1e-3 * k, if k > 30.0 { 1e6 } else { 0.0 }]
            })
            .collect();
        let mut picture = Picture::new(12, 5, pixels).unwrap();
        picture.view = Some(View::fisheye(Vec3::new(0.1, 2.0, 3.0), Vec3::new(0.0, 1.0, 0.0)));
        picture.header = vec!["SOFTWARE= a test".into()];
        let first = read(&write(&picture)).unwrap();
        let again = read(&write(&first)).unwrap();
        assert_eq!(first.view, picture.view);
        assert!(first.header.contains(&"SOFTWARE= a test".to_string()));
        assert_eq!((&again.pixels, again.exposure), (&first.pixels, 1.0));
        for (a, b) in picture.pixels.iter().zip(&first.pixels) {
            let largest = a.iter().fold(0.0_f32, |m, v| m.max(*v));
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() <= largest / 256.0 + 1e-30, "{a} {b}");
            }
        }
        let xyz = read(&write_xyze(&picture).unwrap()).unwrap();
        for (a, b) in picture.luminance().unwrap().iter().zip(xyz.luminance().unwrap()) {
            assert!((a - b).abs() <= a / 100.0, "{a} {b}");
        }
    }

    #[test]
    fn exposures_multiply_and_are_divided_out() {
        let head = "#?RADIANCE\nEXPOSURE=4\nEXPOSURE= 2\nCOLORCORR= 1 2 4\n\tVIEW= -vta\nVIEW= -vtv -vh 30\nVIEW= -vta -vv 180\n\
                    FORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 1\n";
        let picture = read(&flat(head, &[[128, 128, 128, 136]])).unwrap();
        assert_eq!(picture.pixels, [[128.5 / 8.0, 128.5 / 16.0, 128.5 / 32.0]]);
        assert_eq!(picture.exposure, 8.0);
        let view = picture.view.unwrap();
        assert_eq!(
            (view.projection.letter(), view.horizontal, view.vertical),
            ('a', 30.0, 180.0)
        );
        assert_eq!(picture.header.len(), 8);
    }

    #[test]
    fn all_orientations_give_one_picture() {
        // Two columns and three rows; the red mantissa counts from the top left.
        let pixel = |k: u8| [k, 0, 0, 136];
        for (text, order) in [
            ("-Y 3 +X 2", [0, 1, 2, 3, 4, 5]),
            ("-Y 3 -X 2", [1, 0, 3, 2, 5, 4]),
            ("+Y 3 +X 2", [4, 5, 2, 3, 0, 1]),
            ("+Y 3 -X 2", [5, 4, 3, 2, 1, 0]),
            ("+X 2 -Y 3", [0, 2, 4, 1, 3, 5]),
            ("-X 2 -Y 3", [1, 3, 5, 0, 2, 4]),
            ("+X 2 +Y 3", [4, 2, 0, 5, 3, 1]),
            ("-X   2 +Y   3  ", [5, 3, 1, 4, 2, 0]),
        ] {
            let picture = read(&flat(&format!("#?RADIANCE\n\n{text}\n"), &order.map(pixel))).unwrap();
            assert_eq!((picture.width, picture.height), (2, 3));
            let found: Vec<f32> = picture.pixels.iter().map(|p| p[0] - 0.5).collect();
            assert_eq!(found, [0.0, 1.0, 2.0, 3.0, 4.0, 5.0], "{text}");
        }
    }

    #[test]
    fn what_is_wrong_is_named() {
        for (bytes, words) in [
            (b"P6\n".to_vec(), "does not begin with #?RADIANCE"),
            (b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n".to_vec(), "does not end"),
            (b"#?RADIANCE\nFORMAT=float\n\n-Y 1 +X 1\n".to_vec(), "\"float\""),
            (b"#?RADIANCE\nEXPOSURE=-1\n\n-Y 1 +X 1\n".to_vec(), "no positive number"),
            (b"#?RADIANCE\n\n-Y 1 -Y 1\n".to_vec(), "no resolution"),
            (b"#?RADIANCE\n\n-Y 0 +X 1\n".to_vec(), "no resolution"),
            (b"#?RADIANCE\n\n-Y 50000 +X 50000\nabcd".to_vec(), "more than"),
            (b"#?RADIANCE\n\n-Y 1 +X 99999999999\nabcd".to_vec(), "more than"),
            (
                b"#?RADIANCE\n\n-Y 18446744073709551615 +X 2\nabcd".to_vec(),
                "more than",
            ),
            (b"#?RADIANCE\n\n-Y 1 +X 2\nabcd".to_vec(), "ends before"),
            (
                b"#?RADIANCE\n\n-Y 1 +X 9\n\x02\x02\x00\x08ab".to_vec(),
                "another length",
            ),
            (
                b"#?RADIANCE\n\n-Y 1 +X 9\n\x02\x02\x00\x09\xff\x01".to_vec(),
                "beyond the end",
            ),
            (
                b"#?RADIANCE\n\n-Y 1 +X 9\n\x01\x01\x01\x09".to_vec(),
                "begins with a repetition",
            ),
        ] {
            let text = read(&bytes).unwrap_err().to_string();
            assert!(text.contains(words), "{text}");
        }
    }

    #[test]
    fn extremes_are_coded() {
        for values in [
            [f64::NAN, 1.0, f64::INFINITY],
            [1e300, 0.0, 0.0],
            [-1.0, -2.0, f64::NEG_INFINITY],
            [1e-40, 0.0, 1e-33],
            [1.0, 0.5, 0.25],
            [0.999_999_999_999_999_9, 0.0, 0.0],
        ] {
            let [r, g, b, e] = encode(values);
            assert!(e > 0 || [r, g, b] == [0; 3], "{values:?}");
            assert!(e == 0 || r.max(g).max(b) >= 127, "{values:?}");
        }
        assert_eq!(encode([1.0, 0.5, 0.0]), [128, 64, 0, 129]);
    }
}
