//! OpenEXR pictures, from bytes and to bytes.
//!
//! A file that says the luminance of its white (attribute `whiteLuminance`, cd/m²) is scaled by it; without it, values are
//! taken for radiances (W/(m² sr)). A view travels as the text attribute `VIEW`.

use std::io::Cursor;

use exr::meta::MetaData;
use exr::meta::attribute::{AttributeValue, Chromaticities, Text};
use exr::prelude::{
    Encoding, Image, Layer, LayerAttributes, ReadChannels, ReadLayers, SpecificChannels, Vec2, WritableImage,
    read as reader,
};

use super::colour::{EFFICACY, PRIMARIES};
use super::image::{MOST_PIXELS, Picture};
use super::view::View;
use crate::error::{Error, Result};

/// The first bytes of every file.
pub const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// A compressed file is not smaller than its pixels by more than this.
const COMPRESSION: usize = 4096;
const VIEW: &str = "VIEW";

fn fail(error: impl std::fmt::Display) -> Error {
    Error::format(
        "OpenEXR",
        error.to_string(),
        "check that the picture is whole and has channels R, G and B",
    )
}

/// Reads the first layer with channels R, G and B.
pub fn read(bytes: &[u8]) -> Result<Picture> {
    let meta = MetaData::read_from_buffered(Cursor::new(bytes), false).map_err(fail)?;
    for head in &meta.headers {
        let Vec2(width, height) = head.layer_size;
        let pixels = width
            .checked_mul(height)
            .filter(|n| *n <= MOST_PIXELS && *n / COMPRESSION <= bytes.len());
        if pixels.is_none() {
            return Err(fail(format!(
                "{width} × {height} pixels are more than the file can hold, or can be read"
            )));
        }
    }
    let image = reader()
        .no_deep_data()
        .largest_resolution_level()
        .rgb_channels(
            |Vec2(width, height), _| (width, vec![[0.0_f32; 3]; width * height]),
            |(width, pixels), Vec2(x, y), (r, g, b): (f32, f32, f32)| pixels[y * *width + x] = [r, g, b],
        )
        .first_valid_layer()
        .all_attributes()
        .non_parallel()
        .from_buffered(Cursor::new(bytes))
        .map_err(fail)?;
    let (width, pixels) = image.layer_data.channel_data.pixels;
    let mut picture = Picture::new(width, pixels.len() / width.max(1), pixels)?;
    let attributes = &image.layer_data.attributes;
    if let Some(white) = attributes.white_luminance.filter(|w| w.is_finite() && *w > 0.0) {
        let factor = (f64::from(white) / EFFICACY) as f32;
        picture.pixels.iter_mut().flatten().for_each(|v| *v *= factor);
    }
    picture.pixel_aspect = f64::from(image.attributes.pixel_aspect);
    picture.primaries = image.attributes.chromaticities.map(|c| {
        [c.red, c.green, c.blue, c.white]
            .iter()
            .flat_map(|Vec2(x, y)| [f64::from(*x), f64::from(*y)])
            .collect::<Vec<_>>()
            .try_into()
            .unwrap_or(PRIMARIES)
    });
    let text = |value: Option<&AttributeValue>| match value {
        Some(AttributeValue::Text(text)) => Some(text.to_string()),
        _ => None,
    };
    let key = Text::from(VIEW);
    if let Some(options) = text(attributes.other.get(&key)).or_else(|| text(image.attributes.other.get(&key))) {
        match View::parse(&options) {
            Ok(view) => picture.view = Some(view),
            Err(error) => picture
                .warnings
                .push(format!("attribute VIEW: {error}; it is passed over")),
        }
    }
    Ok(picture)
}

/// Writes a picture with 32-bit channels, compressed without loss.
pub fn write(picture: &Picture) -> Result<Vec<u8>> {
    let mut attributes = LayerAttributes {
        white_luminance: Some(EFFICACY as f32),
        software_name: Some(Text::from("Clerestory")),
        ..LayerAttributes::default()
    };
    if let Some(view) = &picture.view {
        let value = AttributeValue::Text(Text::from(view.to_string().as_str()));
        attributes.other.insert(Text::from(VIEW), value);
    }
    let pixel = |Vec2(x, y): Vec2<usize>| {
        let [r, g, b] = picture.pixels[y * picture.width + x];
        (r, g, b)
    };
    let layer = Layer::new(
        (picture.width, picture.height),
        attributes,
        Encoding::SMALL_LOSSLESS,
        SpecificChannels::rgb(pixel),
    );
    let mut image = Image::from_layer(layer);
    image.attributes.pixel_aspect = picture.pixel_aspect as f32;
    let [rx, ry, gx, gy, bx, by, wx, wy] = picture.primaries.unwrap_or(PRIMARIES).map(|v| v as f32);
    image.attributes.chromaticities = Some(Chromaticities {
        red: Vec2(rx, ry),
        green: Vec2(gx, gy),
        blue: Vec2(bx, by),
        white: Vec2(wx, wy),
    });
    let mut bytes = Cursor::new(Vec::new());
    image.write().non_parallel().to_buffered(&mut bytes).map_err(fail)?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Vec3;

    #[test]
    fn pictures_come_back_exactly() {
        let pixels: Vec<[f32; 3]> = (0..35_u16).map(|k| [f32::from(k), 1e-6, 1e9]).collect();
        let mut picture = Picture::new(7, 5, pixels).unwrap();
        picture.view = Some(View::fisheye(Vec3::new(1.0, 2.0, 3.0), Vec3::new(0.0, 1.0, 0.0)));
        let bytes = write(&picture).unwrap();
        assert!(bytes.starts_with(&MAGIC));
        let back = read(&bytes).unwrap();
        assert_eq!((back.width, back.height, &back.pixels), (7, 5, &picture.pixels));
        assert_eq!(back.view, picture.view);
        for (a, b) in back.primaries.unwrap().iter().zip(PRIMARIES) {
            assert!((a - b).abs() < 1e-6);
        }
        for end in [5, 20, 100, bytes.len() - 3] {
            assert!(read(&bytes[..end]).is_err(), "{end}");
        }
    }
}
