//! Command lines in scene files, as far as they are understood.

use super::generate::{Generated, generate};
use super::reader::Purpose;
use super::sky::SkyModel;
use super::sky_options::sky;
use super::words::shown;
use super::xform::Xform;
use crate::error::{Error, Result};

/// What a command puts into the scene, and the transforms that it goes through, the innermost first.
#[derive(Debug)]
pub(super) struct Stage {
    pub source: Source,
    pub xforms: Vec<Xform>,
}

/// Where the objects of a command come from.
#[derive(Debug)]
pub(super) enum Source {
    /// Scene files.
    Files(Vec<String>),
    /// Shapes made here.
    Generated(Generated),
    /// A sky, for rooms.
    Sky(SkyModel),
}

/// Reads a command line without running anything. Files of arguments are loaded by `open`.
pub(super) fn parse(line: &str, purpose: Purpose, open: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<Stage> {
    let programs = split(line)?;
    let mut programs = programs.iter();
    let first = programs.next().map(Vec::as_slice).unwrap_or_default();
    let mut xforms = Vec::new();
    let source = match first.first().map(String::as_str) {
        None => return Err(Error::Argument("an empty command (remove the exclamation mark)".into())),
        Some("xform") => {
            let mut xform = Xform::parse(&first[1..], open)?;
            let files = std::mem::take(&mut xform.files);
            if files.is_empty() {
                return Err(Error::Argument(
                    "xform without a file (name one behind its options)".into(),
                ));
            }
            xforms.push(xform);
            Source::Files(files)
        }
        Some("cat") => match first[1..].iter().find(|w| w.starts_with('-')) {
            Some(option) => {
                return Err(Error::Unsupported(format!(
                    "cat's option {} (leave it out)",
                    shown(option)
                )));
            }
            None => Source::Files(first[1..].to_vec()),
        },
        Some("gensky" | "gendaylit") if purpose == Purpose::Room => Source::Sky(sky(first)?),
        Some(program) => match generate(first, open) {
            Some(generated) => Source::Generated(generated?),
            None => {
                return Err(Error::Unsupported(format!(
                    "the command {} (no programs are run; there are xform, genbox, genprism, genblinds and cat: run others \
                     yourself and put their output into the file)",
                    shown(program)
                )));
            }
        },
    };
    for program in programs {
        match program.first().map(String::as_str) {
            Some("xform") => {
                let xform = Xform::parse(&program[1..], open)?;
                if !xform.files.is_empty() {
                    return Err(Error::Argument(format!(
                        "xform behind a pipe with the file {} (leave it out)",
                        shown(&xform.files[0])
                    )));
                }
                xforms.push(xform);
            }
            other => {
                return Err(Error::Unsupported(format!(
                    "a pipe into {} (only xform is understood there)",
                    shown(other.unwrap_or(""))
                )));
            }
        }
    }
    Ok(Stage { source, xforms })
}

/// The words of each program of a pipeline, quotes taken off.
fn split(line: &str) -> Result<Vec<Vec<String>>> {
    let mut programs = vec![Vec::new()];
    let mut word: Option<String> = None;
    let mut letters = line.chars();
    while let Some(c) = letters.next() {
        match c {
            '\'' | '"' => {
                let word = word.get_or_insert_default();
                loop {
                    match letters.next() {
                        None => {
                            return Err(Error::Argument(format!(
                                "a quotation mark {c} without its end (close it)"
                            )));
                        }
                        Some(end) if end == c => break,
                        Some(inner) => word.push(inner),
                    }
                }
            }
            '\\' => word.get_or_insert_default().extend(letters.next()),
            '|' | '#' => {
                if c == '#' && word.is_some() {
                    word.get_or_insert_default().push(c);
                    continue;
                }
                finish(&mut word, &mut programs);
                if c == '#' {
                    break;
                }
                programs.push(Vec::new());
            }
            ';' | '&' | '<' | '>' | '$' | '`' | '(' | ')' | '{' | '}' | '*' | '?' | '~' => {
                return Err(Error::Unsupported(format!(
                    "{c} in a command: no shell is run (write the command out, or run it yourself and put its output into \
                     the file)"
                )));
            }
            c if c.is_whitespace() => finish(&mut word, &mut programs),
            c => word.get_or_insert_default().push(c),
        }
    }
    finish(&mut word, &mut programs);
    Ok(programs)
}

fn finish(word: &mut Option<String>, programs: &mut [Vec<String>]) {
    if let (Some(word), Some(program)) = (word.take(), programs.last_mut()) {
        program.push(word);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(line: &str) -> Result<Stage> {
        parse(line, Purpose::Sample, &mut |_| Err(Error::Io("not here".into())))
    }

    #[test]
    fn pipes_and_quotes_are_understood() {
        let stage = read("genbox m 'a box' 1 2 3 | xform -n x -t 1 0 0 | xform -rz 90 # turned").unwrap();
        assert_eq!(stage.xforms.len(), 2);
        let Source::Generated(generated) = stage.source else {
            panic!("a box")
        };
        assert!(generated.polygons[0].0.starts_with("a box."));
        let stage = read("xform -t 0 0 1 \"my file.rad\" b.rad").unwrap();
        assert!(matches!(stage.source, Source::Files(files) if files == ["my file.rad", "b.rad"]));
    }

    #[test]
    fn nothing_else_is_run() {
        for (line, text) in [
            ("rm -rf x", "the command \"rm\""),
            ("xform a.rad; rm x", "; in a command"),
            ("xform `ls`", "` in a command"),
            ("xform a.rad | sh", "a pipe into \"sh\""),
            ("xform -t 1 0 0", "without a file"),
            ("genbox m b 1 1 1 | xform a.rad", "behind a pipe"),
            ("cat -n a.rad", "cat's option"),
            ("xform 'a.rad", "without its end"),
            ("", "an empty command"),
        ] {
            let told = read(line).unwrap_err().to_string();
            assert!(told.contains(text), "{line}: {told}");
        }
    }
}
