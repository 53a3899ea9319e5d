//! The words of a scene file.

use crate::error::{Error, Result};

/// What stands in a file between white space, comments left out, with its line.
#[derive(Debug, Clone)]
pub(super) struct Words<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
    file: &'a str,
}

/// What comes next at the start of an object.
#[derive(Debug, PartialEq)]
pub(super) enum Next {
    /// A command line, without its exclamation mark; continued lines are joined.
    Command(String),
    /// A word.
    Word(String),
    /// The end of the file.
    End,
}

impl<'a> Words<'a> {
    pub fn new(text: &'a [u8], file: &'a str) -> Self {
        Self {
            text,
            at: 0,
            line: 1,
            file,
        }
    }

    /// Place of what was read last, for messages.
    pub fn place(&self) -> String {
        place(self.file, self.line)
    }

    pub fn error(&self, what: impl Into<String>, remedy: impl Into<String>) -> Error {
        Error::format(self.place(), what, remedy)
    }

    fn skip(&mut self) {
        while let Some(&c) = self.text.get(self.at) {
            match c {
                b'\n' => self.line += 1,
                b'#' => {
                    while self.text.get(self.at + 1).is_some_and(|&c| c != b'\n') {
                        self.at += 1;
                    }
                }
                c if c.is_ascii_whitespace() || c == 0x0b => {}
                _ => return,
            }
            self.at += 1;
        }
    }

    /// A command or the first word of an object.
    pub fn next(&mut self) -> Next {
        self.skip();
        match self.text.get(self.at) {
            None => Next::End,
            Some(b'!') => {
                self.at += 1;
                Next::Command(self.command())
            }
            Some(_) => Next::Word(self.plain()),
        }
    }

    /// The next word of an object.
    pub fn word(&mut self, what: &str) -> Result<String> {
        self.skip();
        if self.at == self.text.len() {
            return Err(self.error(
                format!("the file ends where {what} should be"),
                "complete its last object",
            ));
        }
        Ok(self.plain())
    }

    /// The next word, as text of its own, which may be put between quotes.
    pub fn text(&mut self, what: &str) -> Result<String> {
        self.skip();
        let Some(&quote @ (b'"' | b'\'')) = self.text.get(self.at) else {
            return self.word(what);
        };
        let rest = &self.text[self.at + 1..];
        let end = rest.iter().position(|&c| c == quote || c == b'\n');
        match end {
            Some(end) if rest[end] == quote => {
                self.at += end + 2;
                Ok(String::from_utf8_lossy(&rest[..end]).into_owned())
            }
            _ => Err(self.error(
                format!("a quotation mark without its end in {what}"),
                "close it on the same line",
            )),
        }
    }

    /// The next word as a number.
    pub fn number(&mut self, what: &str) -> Result<f64> {
        let word = self.word(what)?;
        match word.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(self.error(
                format!("{} stands where {what} should be", shown(&word)),
                "write a finite number, and check the counts in front of the arguments",
            )),
        }
    }

    /// The next word as a count.
    pub fn count(&mut self, what: &str) -> Result<usize> {
        let word = self.word(what)?;
        word.parse().map_err(|_| {
            self.error(
                format!("{} stands where {what} should be", shown(&word)),
                "an object is a modifier, a type and a name, then the counts of its texts, integers and numbers, each \
                 followed by as many of them",
            )
        })
    }

    fn plain(&mut self) -> String {
        let rest = &self.text[self.at..];
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        self.at += end;
        String::from_utf8_lossy(&rest[..end]).into_owned()
    }

    fn command(&mut self) -> String {
        let mut line = Vec::new();
        while let Some(&c) = self.text.get(self.at) {
            if c == b'\n' {
                if line.last() == Some(&b'\r') {
                    line.pop();
                }
                if line.last() != Some(&b'\\') {
                    break;
                }
                line.pop();
                self.line += 1;
                line.push(b' ');
            } else {
                line.push(c);
            }
            self.at += 1;
        }
        String::from_utf8_lossy(&line).into_owned()
    }
}

pub(super) fn place(file: &str, line: usize) -> String {
    if file.is_empty() {
        format!("line {line}")
    } else {
        format!("{file}, line {line}")
    }
}

/// A word in quotes, cut short if it is long.
pub(super) fn shown(word: &str) -> String {
    let short: String = word.chars().take(40).collect();
    format!("{short:?}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_commands_and_words_are_told_apart() {
        let mut words = Words::new(
            b"# first\n!xform -t 1 2 \\\n 3 a.rad\r\nm polygon p#1 # more\n 12 \"a b\" -1e2 x",
            "a.rad",
        );
        assert_eq!(words.next(), Next::Command("xform -t 1 2   3 a.rad".into()));
        assert_eq!(words.next(), Next::Word("m".into()));
        assert_eq!(words.word("a type").unwrap(), "polygon");
        assert_eq!(words.word("a name").unwrap(), "p#1");
        assert_eq!(words.count("a count").unwrap(), 12);
        assert_eq!(words.text("a text").unwrap(), "a b");
        assert_eq!(words.number("a number").unwrap(), -100.0);
        assert_eq!(words.place(), "a.rad, line 5");
        assert!(words.number("a number").is_err());
        assert!(words.word("more").unwrap_err().to_string().contains("the file ends"));
        assert_eq!(words.next(), Next::End);
    }
}
