//! The options of `xform` command lines: moves, turns, sizes, mirrors, repetitions and arrays.

use super::words::shown;
use crate::error::{Error, Result};
use crate::geometry::Vec3;

/// A similarity: turn or mirror, size, shift.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    /// Rows of what multiplies a point.
    rows: [Vec3; 3],
    shift: Vec3,
    /// How much longer lengths become.
    pub scale: f64,
    /// It mirrors: fronts of polygons would change sides.
    pub mirrors: bool,
}

impl Transform {
    /// Nothing moves.
    pub const NONE: Self = Self {
        rows: [
            Vec3::new(1.0, 0.0, 0.0),
            Vec3::new(0.0, 1.0, 0.0),
            Vec3::new(0.0, 0.0, 1.0),
        ],
        shift: Vec3::new(0.0, 0.0, 0.0),
        scale: 1.0,
        mirrors: false,
    };

    /// All lengths by a factor above 0.
    pub fn sized(factor: f64) -> Self {
        Self {
            rows: Self::NONE.rows.map(|r| r * factor),
            scale: factor,
            ..Self::NONE
        }
    }

    /// Of a point.
    pub fn point(&self, p: Vec3) -> Vec3 {
        self.vector(p) + self.shift
    }

    /// Of a difference of points.
    pub fn vector(&self, v: Vec3) -> Vec3 {
        let [x, y, z] = self.rows.map(|r| r.dot(v));
        Vec3::new(x, y, z)
    }

    /// The angle (degrees) of one that only turns about z, counter-clockwise as seen against it, shifts and sizes.
    pub fn about_vertical(&self) -> Option<f64> {
        let up = self.vector(Vec3::new(0.0, 0.0, 1.0)) * (1.0 / self.scale);
        let east = self.vector(Vec3::new(1.0, 0.0, 0.0));
        let upright = (up - Vec3::new(0.0, 0.0, 1.0)).length() < 1e-9;
        (upright && !self.mirrors).then(|| east.y.atan2(east.x).to_degrees())
    }

    /// First this one, then another.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        let columns = |k: usize| {
            Vec3::new(
                self.rows[0].array()[k],
                self.rows[1].array()[k],
                self.rows[2].array()[k],
            )
        };
        let columns = [0, 1, 2].map(|k| next.vector(columns(k)));
        Self {
            rows: [0, 1, 2].map(|k| {
                let [x, y, z] = columns.map(|c| c.array()[k]);
                Vec3::new(x, y, z)
            }),
            shift: next.point(self.shift),
            scale: self.scale * next.scale,
            mirrors: self.mirrors != next.mirrors,
        }
    }

    /// This one as often as told.
    fn times(&self, count: u32) -> Self {
        let (mut all, mut power, mut left) = (Self::NONE, *self, count);
        while left > 0 {
            if left & 1 == 1 {
                all = all.then(&power);
            }
            power = power.then(&power);
            left >>= 1;
        }
        all
    }

    fn is_sound(&self) -> bool {
        let all = self.rows.iter().chain([&self.shift]).flat_map(|r| r.array());
        all.chain([self.scale]).all(f64::is_finite) && self.scale > 0.0
    }
}

/// What an `xform` command asks for.
#[derive(Debug, Clone, PartialEq)]
pub struct Xform {
    /// A copy each, with the prefix of its objects' names.
    pub copies: Vec<(String, Transform)>,
    /// The modifier that all surfaces get instead of their own.
    pub modifier: Option<String>,
    /// Fronts become backs.
    pub inverted: bool,
    /// What is transformed.
    pub files: Vec<String>,
}

/// The most copies that an array may make.
pub(super) const MOST_COPIES: usize = 1_000_000;

/// A part of the options: those up to the next `-i`, `-a` or `-f`.
struct Group {
    transform: Transform,
    how: How,
}

/// What is done with a group.
enum How {
    /// It is done so many times.
    Repeated(u32),
    /// Each of so many copies has it once more than the one before.
    Array(u32),
    /// Each line of a file makes a copy, before the group is done.
    Lines(Vec<Transform>),
}

impl Xform {
    /// From the words of a command, the first (the program's name) left out. Files of options are read by `open`.
    pub fn parse(words: &[String], open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Self> {
        let group = |how: How| Group {
            transform: Transform::NONE,
            how,
        };
        let mut groups = vec![group(How::Repeated(1))];
        let mut read = Self {
            copies: Vec::new(),
            modifier: None,
            inverted: false,
            files: Vec::new(),
        };
        let mut name: Option<String> = None;
        let mut at = 0;
        while at < words.len() {
            let option = words[at].as_str();
            let mut argument = |what: &str| -> Result<&String> {
                at += 1;
                words
                    .get(at)
                    .ok_or_else(|| Error::Argument(format!("xform's {option} lacks {what} (add it)")))
            };
            let next = match option {
                "-t" | "-rx" | "-ry" | "-rz" | "-s" | "-mx" | "-my" | "-mz" => step(option, &mut argument)?,
                "-i" | "-a" => {
                    let word = argument("a count")?;
                    let count = word.parse().map_err(|_| {
                        Error::Argument(format!("xform's {option} {} (give a whole number)", shown(word)))
                    })?;
                    groups.push(group(if option == "-a" {
                        How::Array(count)
                    } else {
                        How::Repeated(count)
                    }));
                    Transform::NONE
                }
                "-n" => {
                    name = Some(argument("a name")?.clone());
                    Transform::NONE
                }
                "-m" => {
                    read.modifier = Some(argument("a modifier")?.clone());
                    Transform::NONE
                }
                "-I" | "+I" => {
                    read.inverted = option == "-I";
                    Transform::NONE
                }
                // Whether commands in the file are carried out here or left for later makes no difference.
                "-c" | "-e" => Transform::NONE,
                "-f" => {
                    groups.push(group(How::Lines(lines(argument("a file")?, open)?)));
                    Transform::NONE
                }
                _ if option.starts_with('-') && option.len() > 1 => {
                    return Err(Error::Unsupported(format!(
                        "xform's option {} (there are -t -rx -ry -rz -s -mx -my -mz -i -a -f -n -m -I)",
                        shown(option)
                    )));
                }
                _ => {
                    read.files = words[at..].to_vec();
                    break;
                }
            };
            if let Some(group) = groups.last_mut() {
                group.transform = group.transform.then(&next);
            }
            at += 1;
        }
        read.copies = copies(&groups, name)?;
        Ok(read)
    }
}

/// The transforms that the lines of a file ask for.
fn lines(file: &str, open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Vec<Transform>> {
    let text = open(file)?;
    let mut all = Vec::new();
    for line in String::from_utf8_lossy(&text).lines() {
        let words: Vec<String> = line.split_whitespace().map(str::to_owned).collect();
        if words.is_empty() {
            continue;
        }
        let mut none = |_: &str| {
            Err(Error::Unsupported(
                "xform's -f within a file of options (give one file)".into(),
            ))
        };
        let read = Xform::parse(&words, &mut none).map_err(|e| e.within(&format!("{file}: ")))?;
        match &read.copies[..] {
            [(_, transform)] if read.files.is_empty() => all.push(*transform),
            _ => {
                return Err(Error::Argument(format!(
                    "{file}: {} is more than one transform (give one a line, without -a and without files)",
                    shown(line)
                )));
            }
        }
        if all.len() > MOST_COPIES {
            return Err(too_many());
        }
    }
    Ok(all)
}

pub(super) fn too_many() -> Error {
    Error::Argument(format!(
        "xform makes more than {MOST_COPIES} copies (make its arrays smaller)"
    ))
}

fn copies(groups: &[Group], name: Option<String>) -> Result<Vec<(String, Transform)>> {
    let mut copies = vec![(name, Transform::NONE)];
    for Group { transform: step, how } in groups {
        let count = match how {
            How::Repeated(count) => {
                let whole = step.times(*count);
                for (_, transform) in &mut copies {
                    *transform = transform.then(&whole);
                }
                continue;
            }
            How::Array(count) => *count as usize,
            How::Lines(lines) => lines.len(),
        };
        if copies.len().saturating_mul(count) > MOST_COPIES {
            return Err(too_many());
        }
        let mut more = Vec::with_capacity(copies.len() * count);
        for (name, before) in copies {
            let mut moved = before;
            for k in 0..count {
                let letter = if let How::Lines(lines) = how {
                    moved = before.then(&lines[k]).then(step);
                    'i'
                } else {
                    'a'
                };
                let name = name
                    .as_ref()
                    .map_or_else(|| format!("{letter}{k}"), |n| format!("{n}.{k}"));
                more.push((Some(name), moved));
                moved = moved.then(step);
            }
        }
        copies = more;
    }
    if let Some((_, bad)) = copies.iter().find(|(_, t)| !t.is_sound()) {
        return Err(Error::Argument(format!(
            "xform's options make a size of {} (give smaller numbers)",
            bad.scale
        )));
    }
    Ok(copies
        .into_iter()
        .map(|(name, transform)| (name.unwrap_or_default(), transform))
        .collect())
}

/// The move, turn, size or mirror that an option asks for.
fn step<'a>(option: &str, argument: &mut dyn FnMut(&str) -> Result<&'a String>) -> Result<Transform> {
    Ok(match option {
        "-t" => {
            let mut shift = [0.0; 3];
            for s in &mut shift {
                *s = number(option, argument("three numbers")?)?;
            }
            let [x, y, z] = shift;
            Transform {
                shift: Vec3::new(x, y, z),
                ..Transform::NONE
            }
        }
        "-rx" | "-ry" | "-rz" => turned(option, number(option, argument("an angle")?)?),
        "-s" => {
            let factor = number(option, argument("a factor")?)?;
            if factor == 0.0 {
                return Err(Error::Argument(
                    "xform's -s 0 leaves nothing (give another factor)".into(),
                ));
            }
            Transform {
                rows: Transform::NONE.rows.map(|r| r * factor),
                scale: factor.abs(),
                mirrors: factor < 0.0,
                ..Transform::NONE
            }
        }
        _ => {
            let mut mirror = Transform {
                mirrors: true,
                ..Transform::NONE
            };
            let axis = usize::from(option.as_bytes()[2] - b'x');
            mirror.rows[axis] = -mirror.rows[axis];
            mirror
        }
    })
}

fn number(option: &str, word: &str) -> Result<f64> {
    match word.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        _ => Err(Error::Argument(format!(
            "xform's {option} {} (give a number)",
            shown(word)
        ))),
    }
}

/// Counter-clockwise about an axis, seen against it.
fn turned(option: &str, degrees: f64) -> Transform {
    // Quarter turns are exact.
    let (sin, cos) = match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        d => d.to_radians().sin_cos(),
    };
    let v = Vec3::new;
    let rows = match option {
        "-rx" => [v(1.0, 0.0, 0.0), v(0.0, cos, -sin), v(0.0, sin, cos)],
        "-ry" => [v(cos, 0.0, sin), v(0.0, 1.0, 0.0), v(-sin, 0.0, cos)],
        _ => [v(cos, -sin, 0.0), v(sin, cos, 0.0), v(0.0, 0.0, 1.0)],
    };
    Transform {
        rows,
        ..Transform::NONE
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(line: &str) -> Result<Xform> {
        let words = line.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        Xform::parse(&words, &mut |file| match file {
            "two" => Ok(b"-t 1 0 0\n\n-t 2 0 0 -i 2 -rz 90\n".to_vec()),
            _ => Err(Error::Io(format!("{file}: not found"))),
        })
    }

    fn places(line: &str, point: Vec3) -> Vec<(String, Vec3)> {
        let copies = parse(line).unwrap().copies;
        copies.into_iter().map(|(n, t)| (n, t.point(point))).collect()
    }

    fn close(a: Vec3, x: f64, y: f64, z: f64) -> bool {
        (a - Vec3::new(x, y, z)).length() < 1e-15
    }

    #[test]
    fn options_work_in_their_order() {
        let p = Vec3::new(1.0, 2.0, 3.0);
        let one = |line: &str| places(line, p)[0].1;
        assert!(close(one("-rz 90 -t 10 0 0 a.rad"), 8.0, 1.0, 3.0));
        assert!(close(one("-t 10 0 0 -rz 90"), -2.0, 11.0, 3.0));
        assert!(close(one("-rx 90"), 1.0, -3.0, 2.0));
        assert!(close(one("-ry 90"), 3.0, 2.0, -1.0));
        assert!(close(one("-s 2 -mx"), -2.0, 4.0, 6.0));
        assert!(close(
            one("-t 1 0 0 -i 3 -t 0 1 0 -rz 180 -i 1 -s 10"),
            -20.0,
            -30.0,
            30.0
        ));
        let both = parse("-mx -s -2 -my").unwrap().copies[0].1;
        assert!(both.mirrors && both.scale == 2.0);
    }

    #[test]
    fn arrays_nest_and_name_their_copies() {
        let told = places(
            "-n slat -a 2 -t 0 1 0 -a 3 -t 0 0 5 -i 1 -rz 90 blind.rad",
            Vec3::new(1.0, 0.0, 0.0),
        );
        assert_eq!(told.len(), 6);
        for (k, (name, p)) in told.into_iter().enumerate() {
            let (i, j) = (k / 3, k % 3);
            assert_eq!(name, format!("slat.{i}.{j}"));
            assert!(close(p, -(i as f64), 1.0, 5.0 * j as f64), "{p:?}");
        }
        assert_eq!(places("-a 2 -t 1 0 0", Vec3::default())[1].0, "a1");
        assert_eq!(parse("-a 0 -t 1 0 0").unwrap().copies, []);
    }

    #[test]
    fn a_file_of_options_makes_a_copy_a_line() {
        let told = places("-t 0 1 0 -f two -s 10", Vec3::default());
        assert_eq!((told[0].0.as_str(), told[1].0.as_str()), ("i0", "i1"));
        assert!(
            close(told[0].1, 10.0, 10.0, 0.0) && close(told[1].1, -20.0, -10.0, 0.0),
            "{told:?}"
        );
        assert!(parse("-f none").is_err());
    }

    #[test]
    fn files_and_modifiers_are_told() {
        let read = parse("-m glass -n p -I a.rad b.rad").unwrap();
        assert_eq!((read.modifier.as_deref(), read.inverted), (Some("glass"), true));
        assert_eq!(read.files, ["a.rad", "b.rad"]);
        assert_eq!(read.copies[0].0, "p");
    }

    #[test]
    fn faulty_options_are_told() {
        for (line, text) in [
            ("-t 1 2", "lacks three numbers"),
            ("-rx a", "-rx \"a\""),
            ("-s 0", "leaves nothing"),
            ("-a -3 -t 1 0 0", "-a \"-3\""),
            ("-a 1000000 -a 1000000", "more than 1000000 copies"),
            ("-q", "option \"-q\""),
            ("-s 1e300 -s 1e300", "a size of inf"),
            ("-i 1000000 -s 0.1", "a size of 0"),
        ] {
            let told = parse(line).unwrap_err().to_string();
            assert!(told.contains(text), "{line}: {told}");
        }
    }
}
