//! What Radiance's generators of simple shapes make: `genbox`, `genprism`, `genblinds`.

use super::words::shown;
use crate::error::{Error, Result};
use crate::geometry::Vec3;
use crate::io::counted;

/// The polygons of a generator: modifier, and a name and the corners of each.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Generated {
    pub modifier: String,
    pub polygons: Vec<(String, Vec<Vec3>)>,
}

/// Runs a generator by its name; none if it is not one of these. Files of vertices are read by `open`.
pub(super) fn generate(words: &[String], open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Option<Result<Generated>> {
    let (program, arguments) = words.split_first()?;
    let run = match program.as_str() {
        "genbox" => genbox(arguments),
        "genprism" => genprism(arguments, open),
        "genblinds" => genblinds(arguments),
        _ => return None,
    };
    Some(run.map_err(|e| e.within(&format!("{program}: "))))
}

/// Arguments, taken one after the other.
struct Arguments<'a>(std::slice::Iter<'a, String>);

impl<'a> Arguments<'a> {
    fn word(&mut self, what: &str) -> Result<&'a String> {
        self.0
            .next()
            .ok_or_else(|| Error::Argument(format!("lacks {what} (add it)")))
    }

    fn number(&mut self, what: &str) -> Result<f64> {
        number(self.word(what)?, what)
    }
}

fn number(word: &str, what: &str) -> Result<f64> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::Argument(format!("{} as {what} (give a number)", shown(word)))),
    }
}

fn unknown(option: &str, known: &str) -> Error {
    Error::Unsupported(format!(
        "option {} (there are {known}; run the program yourself and put its output into the file)",
        shown(option)
    ))
}

/// `genbox material name x y z [-i]`: a box from the origin.
fn genbox(arguments: &[String]) -> Result<Generated> {
    let mut arguments = Arguments(arguments.iter());
    let modifier = arguments.word("a material")?.clone();
    let name = arguments.word("a name")?;
    let mut size = [0.0; 3];
    for s in &mut size {
        *s = arguments.number("a size")?;
        if *s <= 0.0 {
            return Err(Error::Argument(format!("a size of {s} (give one above 0)")));
        }
    }
    let mut inward = false;
    for option in arguments.0 {
        match option.as_str() {
            "-i" => inward = true,
            _ => return Err(unknown(option, "-i")),
        }
    }
    // Corners are numbered by their coordinates in binary: 1 is x, 2 is y, 4 is z. Faces are named after their corners.
    let corner = |k: u8| {
        let at = |axis: usize| if k >> axis & 1 == 1 { size[axis] } else { 0.0 };
        Vec3::new(at(0), at(1), at(2))
    };
    let faces = [
        [1, 5, 4, 0],
        [4, 6, 2, 0],
        [2, 3, 1, 0],
        [3, 2, 6, 7],
        [5, 1, 3, 7],
        [6, 4, 5, 7],
    ];
    let polygons = faces.map(|mut face| {
        let digits: String = face.iter().map(ToString::to_string).collect();
        if inward {
            face.reverse();
        }
        (format!("{name}.{digits}"), face.map(corner).to_vec())
    });
    Ok(Generated {
        modifier,
        polygons: polygons.to_vec(),
    })
}

/// `genprism material name N x1 y1 … [-l x y z] [-c] [-e]`, or a file of vertices: a polygon in z = 0 drawn along a vector.
fn genprism(arguments: &[String], open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Generated> {
    let mut arguments = Arguments(arguments.iter());
    let modifier = arguments.word("a material")?.clone();
    let name = arguments.word("a name")?;
    let source = arguments.word("a count of vertices")?;
    let mut flat: Vec<Vec3> = Vec::new();
    if let Ok(count) = source.parse::<usize>() {
        for _ in 0..count {
            let x = arguments.number("a coordinate")?;
            flat.push(Vec3::new(x, arguments.number("a coordinate")?, 0.0));
        }
    } else if source == "-" {
        return Err(Error::Unsupported(
            "vertices from standard input (write them on the line or into a file)".into(),
        ));
    } else {
        let text = open(source)?;
        let text = String::from_utf8_lossy(&text);
        let values: Vec<f64> = text
            .split_whitespace()
            .map(|w| number(w, &format!("a coordinate in {source}")))
            .collect::<Result<_>>()?;
        flat.extend(values.chunks_exact(2).map(|p| Vec3::new(p[0], p[1], 0.0)));
    }
    if flat.len() < 3 {
        return Err(Error::Argument(format!(
            "a section with {} (give three or more)",
            counted(flat.len(), "corner")
        )));
    }
    let mut along = Vec3::new(0.0, 0.0, 1.0);
    let (mut closing, mut ends) = (true, true);
    while let Some(option) = arguments.0.next() {
        match option.as_str() {
            "-l" => {
                let x = arguments.number("a coordinate")?;
                let y = arguments.number("a coordinate")?;
                along = Vec3::new(x, y, arguments.number("a coordinate")?);
            }
            "-c" => closing = false,
            "-e" => ends = false,
            _ => return Err(unknown(option, "-l -c -e")),
        }
    }
    if along.z == 0.0 {
        return Err(Error::Argument(
            "a vector -l that lies in the polygon's plane (give one with a z other than 0)".into(),
        ));
    }
    let far: Vec<Vec3> = flat.iter().map(|p| *p + along).collect();
    let mut polygons = Vec::with_capacity(flat.len() + 2);
    if ends {
        polygons.push((format!("{name}.b"), flat.clone()));
        polygons.push((format!("{name}.t"), far.iter().rev().copied().collect()));
    }
    let sides = if closing { flat.len() } else { flat.len() - 1 };
    for k in 0..sides {
        let next = (k + 1) % flat.len();
        let side = vec![flat[k], far[k], far[next], flat[next]];
        polygons.push((format!("{name}.{}", k + 1), side));
    }
    Ok(Generated { modifier, polygons })
}

/// `genblinds material name depth width height count angle [-r|+r radius]`: slats along y, one above the other.
fn genblinds(arguments: &[String]) -> Result<Generated> {
    let mut arguments = Arguments(arguments.iter());
    let modifier = arguments.word("a material")?.clone();
    let name = arguments.word("a name")?;
    let depth = arguments.number("a depth")?;
    let width = arguments.number("a width")?;
    let height = arguments.number("a height")?;
    let count = arguments.number("a count of slats")?;
    let angle = arguments.number("an angle")?.to_radians();
    if let Some((what, value)) = [("depth", depth), ("width", width), ("height", height)]
        .into_iter()
        .find(|(_, v)| *v <= 0.0)
    {
        return Err(Error::Argument(format!("a {what} of {value} (give one above 0)")));
    }
    if !(1.0..=100_000.0).contains(&count) {
        return Err(Error::Argument(format!("{count} slats (give 1 to 100000)")));
    }
    // Positive where the slats bulge upward, 0 where they are flat.
    let mut radius = 0.0;
    while let Some(option) = arguments.0.next() {
        radius = match option.as_str() {
            "+r" => arguments.number("a radius")?.abs(),
            "-r" => -arguments.number("a radius")?.abs(),
            _ => return Err(unknown(option, "-r +r")),
        };
        if radius != 0.0 && radius.abs() < 0.5 * depth {
            return Err(Error::Argument(format!(
                "a radius of {} for slats that are {depth} deep (give half their depth or more)",
                radius.abs()
            )));
        }
    }
    let section = section(depth, angle, radius);
    let count = count as usize;
    let mut polygons = Vec::with_capacity(count * (section.len() - 1));
    for slat in 0..count {
        let z = height / count as f64 * (slat as f64 + 0.5);
        for (part, pair) in section.windows(2).enumerate() {
            let at = |[x, dz]: [f64; 2], y: f64| Vec3::new(x, y, z + dz);
            let corners = vec![
                at(pair[0], 0.0),
                at(pair[0], width),
                at(pair[1], width),
                at(pair[1], 0.0),
            ];
            polygons.push((format!("{name}.{}.{part}", slat + 1), corners));
        }
    }
    Ok(Generated { modifier, polygons })
}

/// Points of a slat's section, in x and z, its first end at the origin.
fn section(depth: f64, angle: f64, radius: f64) -> Vec<[f64; 2]> {
    let (sin, cos) = angle.sin_cos();
    let tilted = |along: f64, up: f64| [along * cos - up * sin, along * sin + up * cos];
    if radius == 0.0 {
        return vec![[0.0, 0.0], tilted(depth, 0.0)];
    }
    let half = (0.5 * depth / radius.abs()).min(1.0).asin();
    // A segment for every 3 degrees begun.
    let parts = (2.0 * half.to_degrees() / 3.0) as usize + 1;
    (0..=parts)
        .map(|k| {
            let a = half * (2.0 * k as f64 / parts as f64 - 1.0);
            let up = radius.abs() * (a.cos() - half.cos());
            tilted(0.5 * depth + radius.abs() * a.sin(), up.copysign(radius))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn run(line: &str) -> Result<Generated> {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        generate(&words, &mut |_| Ok(b"0 0\n1 0 0 1".to_vec())).expect("a generator")
    }

    /// Six times the volume within closed polygons whose fronts are outside.
    fn volume(polygons: &[(String, Vec<Vec3>)]) -> f64 {
        let tetrahedra = |p: &Vec<Vec3>| -> f64 { (1..p.len() - 1).map(|k| p[0].dot(p[k].cross(p[k + 1]))).sum() };
        polygons.iter().map(|(_, p)| tetrahedra(p)).sum()
    }

    #[test]
    fn boxes_and_prisms_hold_their_volume() {
        let cuboid = run("genbox m b 1 2 3").unwrap();
        assert_eq!((cuboid.modifier.as_str(), cuboid.polygons.len()), ("m", 6));
        assert!((volume(&cuboid.polygons) - 36.0).abs() < 1e-14);
        assert!((volume(&run("genbox m b 1 2 3 -i").unwrap().polygons) + 36.0).abs() < 1e-14);
        // Clockwise vertices drawn upward have their fronts outside, and so have counter-clockwise ones drawn downward.
        let prism = run("genprism m p 4 0 0 0 1 1 1 1 0 -l 0 .5 2").unwrap();
        assert!(
            (volume(&prism.polygons) - 12.0).abs() < 1e-14,
            "{}",
            volume(&prism.polygons)
        );
        assert!((volume(&run("genprism m p 3 0 0 1 0 0 1 -l 0 0 -2").unwrap().polygons) - 6.0).abs() < 1e-14);
        assert_eq!(run("genprism m p vertices -e -c").unwrap().polygons.len(), 2);
    }

    #[test]
    fn slats_are_where_radiance_puts_them() {
        let flat = run("genblinds m bl 0.08 1 2 3 30").unwrap();
        let (name, corners) = &flat.polygons[2];
        assert_eq!((name.as_str(), flat.polygons.len()), ("bl.3.0", 3));
        let expected = Vec3::new(0.069_282_032_302_8, 1.0, 1.706_666_666_67);
        assert!((corners[2] - expected).length() < 1e-11);
        // Points and counts of segments as genblinds gives them.
        let curved = run("genblinds m bl 0.08 1 2 1 30 +r 0.1").unwrap();
        assert_eq!(curved.polygons.len(), 16);
        let expected = Vec3::new(0.003_159_188_717_11, 1.0, 1.004_058_820_39);
        assert!((curved.polygons[0].1[2] - expected).length() < 1e-11);
        let down = run("genblinds m bl 0.08 1 2 1 0 -r 0.1").unwrap();
        let expected = Vec3::new(0.04, 0.0, 0.991_651_513_899);
        assert!((down.polygons[7].1[3] - expected).length() < 1e-11);
        assert_eq!(run("genblinds m bl 0.08 1 2 1 0 -r 0.05").unwrap().polygons.len(), 36);
        assert_eq!(run("genblinds m bl 0.08 1 2 1 0 -r 0.5").unwrap().polygons.len(), 4);
    }

    #[test]
    fn faulty_calls_are_told() {
        for (line, text) in [
            ("genbox m b 1 2", "genbox: lacks a size"),
            ("genbox m b 1 2 -3", "a size of -3"),
            ("genbox m b 1 2 3 -r .1", "option \"-r\""),
            ("genprism m p 2 0 0 1 1", "2 corners"),
            ("genprism m p 3 0 0 1 0 0", "lacks a coordinate"),
            ("genprism m p 3 0 0 1 0 0 1 -l 1 0 0", "lies in the polygon's plane"),
            ("genprism m p -", "standard input"),
            ("genblinds m b 0.08 1 1 0 0", "0 slats"),
            ("genblinds m b 0.08 1 1 5 x", "\"x\" as an angle"),
            ("genblinds m b 0.08 1 1 5 0 +r 0.03", "a radius of 0.03"),
        ] {
            let told = run(line).unwrap_err().to_string();
            assert!(told.contains(text), "{line}: {told}");
        }
        assert!(generate(&["rm".to_owned()], &mut |_| Ok(Vec::new())).is_none());
    }
}
