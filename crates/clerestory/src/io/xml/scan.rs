//! XML as BSDF files use it: elements, attributes, text, comments. No document type, hence no entities of one's own
//! and nothing fetched from elsewhere.
//!
//! Names and texts are slices of the file's bytes; only text that comes in pieces is copied.

use std::borrow::Cow;

use memchr::{memchr, memmem};

use super::place;
use crate::error::{Error, Result};

/// Deepest nesting; real files have 8 levels.
const MAX_DEPTH: usize = 32;

/// Most elements and comments: bounds the memory that a file of tags alone can ask for. Real files have some hundred.
const MAX_NODES: usize = 200_000;

/// An element.
#[derive(Debug)]
pub struct Node<'a> {
    /// Name without namespace prefix.
    pub name: &'a str,
    /// The tag's bytes after the name.
    attributes: &'a [u8],
    /// Text outside of child elements.
    pub text: Cow<'a, [u8]>,
    /// Where the text stands in the file, if it is in one piece.
    pub text_at: Option<usize>,
    /// Where the tag stands in the file.
    pub at: usize,
    /// Child elements.
    pub children: Vec<Node<'a>>,
}

impl<'a> Node<'a> {
    /// First child of a name.
    pub fn child(&self, name: &str) -> Option<&Self> {
        self.children.iter().find(|c| c.name == name)
    }

    /// All children of a name.
    pub fn all<'b>(&'b self, name: &'b str) -> impl Iterator<Item = &'b Node<'a>> {
        self.children.iter().filter(move |c| c.name == name)
    }

    /// Names and raw values of the attributes, without namespace declarations.
    pub fn attributes(&self) -> impl Iterator<Item = (&'a str, &'a [u8])> {
        Attributes { rest: self.attributes }.filter_map(std::result::Result::ok)
    }
}

/// What stands before, around and in the root element.
#[derive(Debug)]
pub struct Document<'a> {
    /// The root element.
    pub root: Node<'a>,
    /// Comments anywhere in the file.
    pub comments: Vec<&'a [u8]>,
    /// Encoding that the XML declaration names.
    pub encoding: Option<&'a str>,
    /// Where text that is no XML stands before the root.
    pub text_before: Option<usize>,
    /// Where text that is no XML stands behind the root.
    pub text_behind: Option<usize>,
}

/// Reads the whole file's structure; the root must have the given name.
pub fn scan<'a>(bytes: &'a [u8], root_name: &str) -> Result<Document<'a>> {
    let mut scanner = Scanner {
        bytes,
        at: 0,
        nodes: 0,
        comments: Vec::new(),
    };
    let mut encoding = None;
    let mut text_before = None;
    if bytes.starts_with(&[0xef, 0xbb, 0xbf]) {
        scanner.at = 3;
    }
    let root = loop {
        let start = scanner.at;
        let gap = memchr(b'<', &bytes[start..]).ok_or_else(|| no_root(bytes, root_name))?;
        if text_before.is_none()
            && let Some(k) = bytes[start..start + gap].iter().position(|c| !c.is_ascii_whitespace())
        {
            text_before = Some(start + k);
        }
        let at = start + gap;
        scanner.at = at;
        let rest = &bytes[at..];
        if rest.starts_with(b"<?") {
            let end = scanner.find(b"?>", "the XML declaration", at)?;
            if encoding.is_none() {
                encoding = declared_encoding(&bytes[at..end]);
            }
        } else if rest.starts_with(b"<!--") {
            scanner.comment()?;
        } else if rest.starts_with(b"<!DOCTYPE") || rest.starts_with(b"<!doctype") {
            return Err(Error::format(
                place(bytes, at, ""),
                "a document type (DOCTYPE) stands here",
                "BSDF files have none; delete it",
            ));
        } else if tag_name(&rest[1..]).is_some_and(|(name, _)| name == root_name) {
            break scanner.tree()?;
        } else {
            // Part of a log that a program printed into the file.
            text_before = text_before.or(Some(at));
            scanner.at = at + 1;
        }
    };
    let mut text_behind = None;
    while let Some(k) = bytes[scanner.at..].iter().position(|c| !c.is_ascii_whitespace()) {
        scanner.at += k;
        if bytes[scanner.at..].starts_with(b"<!--") {
            scanner.comment()?;
        } else {
            text_behind = Some(scanner.at);
            break;
        }
    }
    Ok(Document {
        root,
        comments: scanner.comments,
        encoding,
        text_before,
        text_behind,
    })
}

fn no_root(bytes: &[u8], root_name: &str) -> Error {
    let (what, remedy) = if bytes.iter().all(u8::is_ascii_whitespace) {
        ("the file is empty".to_owned(), "get it again")
    } else {
        (
            format!("no <{root_name}> in it: this is not a BSDF XML file"),
            "give a file of WINDOW, Radiance or genBSDF",
        )
    };
    Error::format("line 1", what, remedy)
}

/// Encoding of `<?xml … encoding="…"?>`.
fn declared_encoding(declaration: &[u8]) -> Option<&str> {
    let text = std::str::from_utf8(declaration).ok()?;
    let value = text
        .split_once("encoding")?
        .1
        .trim_start()
        .strip_prefix('=')?
        .trim_start();
    let quote = value.chars().next().filter(|c| matches!(c, '"' | '\''))?;
    value[1..].split_once(quote).map(|(v, _)| v)
}

fn is_name_byte(c: u8) -> bool {
    c.is_ascii_alphanumeric() || matches!(c, b'_' | b'-' | b'.' | b':') || c >= 0x80
}

/// Local name at the start of `text`, and the length with its prefix.
fn tag_name(text: &[u8]) -> Option<(&str, usize)> {
    let length = text.iter().position(|&c| !is_name_byte(c)).unwrap_or(text.len());
    if length == 0 || !(text[0].is_ascii_alphabetic() || text[0] == b'_' || text[0] >= 0x80) {
        return None;
    }
    let name = std::str::from_utf8(&text[..length]).ok()?;
    Some((name.rsplit(':').next().unwrap_or(name), length))
}

struct Scanner<'a> {
    bytes: &'a [u8],
    at: usize,
    nodes: usize,
    comments: Vec<&'a [u8]>,
}

/// An element whose end has not been read yet.
struct Open<'a> {
    node: Node<'a>,
    /// Name with prefix.
    full_name: &'a [u8],
    /// Blanks stand behind its text so far.
    gap: bool,
}

impl<'a> Open<'a> {
    fn add_text(&mut self, text: &'a [u8], at: usize) {
        if text.iter().all(u8::is_ascii_whitespace) {
            self.gap |= !text.is_empty();
        } else if self.node.text.is_empty() {
            self.node.text = Cow::Borrowed(text);
            self.node.text_at = Some(at);
            self.gap = false;
        } else {
            self.append(text);
        }
    }

    /// Text in which '&' stands for itself.
    fn add_cdata(&mut self, text: &'a [u8], at: usize) {
        if text.contains(&b'&') {
            self.append(&text.split(|&c| c == b'&').collect::<Vec<_>>().join(b"&amp;".as_slice()));
        } else {
            self.add_text(text, at);
        }
    }

    /// Another piece; blanks between it and the one before are kept as one.
    fn append(&mut self, text: &[u8]) {
        let all = self.node.text.to_mut();
        if self.gap && !all.is_empty() {
            all.push(b' ');
        }
        all.extend_from_slice(text);
        self.gap = false;
        self.node.text_at = None;
    }
}

impl<'a> Scanner<'a> {
    fn fail<T>(&self, at: usize, element: &str, what: impl Into<String>, remedy: &str) -> Result<T> {
        Err(Error::format(place(self.bytes, at, element), what, remedy))
    }

    fn count(&mut self) -> Result<()> {
        self.nodes += 1;
        if self.nodes > MAX_NODES {
            return self.fail(
                self.at,
                "",
                format!("more than {MAX_NODES} elements"),
                "this is no BSDF file that a program would write",
            );
        }
        Ok(())
    }

    /// End of what `pattern` closes; the position moves behind it.
    fn find(&mut self, pattern: &[u8], what: &str, from: usize) -> Result<usize> {
        match memmem::find(&self.bytes[self.at..], pattern) {
            Some(k) => {
                let end = self.at + k;
                self.at = end + pattern.len();
                Ok(end)
            }
            None => self.fail(
                from,
                "",
                format!("the file ends inside of {what}"),
                "it is cut off; get it again",
            ),
        }
    }

    fn comment(&mut self) -> Result<()> {
        let at = self.at;
        self.at += 4;
        let end = self.find(b"-->", "a comment", at)?;
        self.count()?;
        self.comments.push(&self.bytes[at + 4..end]);
        Ok(())
    }

    /// The element that begins here, with all that is in it.
    fn tree(&mut self) -> Result<Node<'a>> {
        let (mut top, closed) = self.open()?;
        if closed {
            return Ok(top.node);
        }
        let mut stack: Vec<Open<'a>> = Vec::new();
        loop {
            let start = self.at;
            let Some(gap) = memchr(b'<', &self.bytes[start..]) else {
                return self.fail(
                    self.bytes.len(),
                    top.node.name,
                    format!("the file ends before </{}>", top.node.name),
                    "it is cut off; get it again",
                );
            };
            top.add_text(&self.bytes[start..start + gap], start);
            self.at = start + gap;
            let rest = &self.bytes[self.at..];
            if rest.starts_with(b"</") {
                self.close(&top)?;
                let node = top.node;
                match stack.pop() {
                    None => return Ok(node),
                    Some(mut parent) => {
                        parent.node.children.push(node);
                        top = parent;
                    }
                }
            } else if rest.starts_with(b"<!--") {
                self.comment()?;
            } else if rest.starts_with(b"<![CDATA[") {
                let at = self.at;
                self.at += 9;
                let end = self.find(b"]]>", "a CDATA section", at)?;
                top.add_cdata(&self.bytes[at + 9..end], at + 9);
            } else if rest.starts_with(b"<?") {
                let at = self.at;
                self.find(b"?>", "a processing instruction", at)?;
            } else {
                let (inner, closed) = self.open()?;
                if closed {
                    top.node.children.push(inner.node);
                } else if stack.len() + 2 > MAX_DEPTH {
                    return self.fail(
                        inner.node.at,
                        inner.node.name,
                        format!("elements are nested more than {MAX_DEPTH} deep"),
                        "this is no BSDF file that a program would write",
                    );
                } else {
                    stack.push(top);
                    top = inner;
                }
            }
        }
    }

    /// A start tag; whether it closes itself.
    fn open(&mut self) -> Result<(Open<'a>, bool)> {
        let at = self.at;
        self.count()?;
        let Some((name, length)) = tag_name(&self.bytes[at + 1..]) else {
            return self.fail(
                at,
                "",
                "'<' does not begin a tag",
                "write &lt; where the sign itself is meant, or get the file again",
            );
        };
        let from = at + 1 + length;
        // The tag ends at the first '>' outside of quotes.
        let mut quote = None;
        let mut end = None;
        for (k, &c) in self.bytes[from..].iter().enumerate() {
            match (quote, c) {
                (None, b'>') => {
                    end = Some(from + k);
                    break;
                }
                (None, b'<') => break,
                (None, b'"' | b'\'') => quote = Some(c),
                (Some(q), c) if q == c => quote = None,
                _ => {}
            }
        }
        let Some(end) = end else {
            return self.fail(
                at,
                name,
                "the tag has no end",
                "the file is cut off or damaged; get it again",
            );
        };
        let closed = self.bytes[from..end].ends_with(b"/");
        let attributes = &self.bytes[from..end - usize::from(closed)];
        if let Some(Err(what)) = (Attributes { rest: attributes }).find(std::result::Result::is_err) {
            return self.fail(at, name, what, "attributes are written name=\"value\"");
        }
        self.at = end + 1;
        let node = Node {
            name,
            attributes,
            text: Cow::Borrowed(&[]),
            text_at: None,
            at,
            children: Vec::new(),
        };
        let open = Open {
            node,
            full_name: &self.bytes[at + 1..from],
            gap: false,
        };
        Ok((open, closed))
    }

    /// The end tag that must be the one of `open`.
    fn close(&mut self, open: &Open<'a>) -> Result<()> {
        let rest = &self.bytes[self.at + 2..];
        let after = rest
            .strip_prefix(open.full_name)
            .and_then(|r| r.iter().position(|c| !c.is_ascii_whitespace()).map(|k| &r[k..]))
            .filter(|r| r[0] == b'>');
        if let Some(after) = after {
            self.at = self.bytes.len() - after.len() + 1;
            return Ok(());
        }
        let found = tag_name(rest).map_or("something else", |(name, _)| name);
        self.fail(
            self.at,
            open.node.name,
            format!("</{}> is due but </{found}> stands there", open.node.name),
            "close the elements in the order they were opened, or get the file again",
        )
    }
}

/// Attributes of a tag; an error says what is wrong with them.
struct Attributes<'a> {
    rest: &'a [u8],
}

impl<'a> Iterator for Attributes<'a> {
    type Item = std::result::Result<(&'a str, &'a [u8]), String>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            self.rest = self.rest.trim_ascii_start();
            if self.rest.is_empty() {
                return None;
            }
            let Some((name, length)) = tag_name(self.rest) else {
                self.rest = &[];
                return Some(Err("an attribute has no name".into()));
            };
            let is_namespace = self.rest.starts_with(b"xmlns");
            let value = self.rest[length..]
                .trim_ascii_start()
                .strip_prefix(b"=")
                .map(<[u8]>::trim_ascii_start)
                .filter(|v| matches!(v.first(), Some(b'"' | b'\'')))
                .and_then(|v| memchr(v[0], &v[1..]).map(|k| (&v[1..=k], &v[k + 2..])));
            let Some((value, rest)) = value else {
                self.rest = &[];
                return Some(Err(format!("attribute {} has no quoted value", shortened(name))));
            };
            self.rest = rest;
            if !is_namespace {
                return Some(Ok((name, value)));
            }
        }
    }
}

/// A name from the file for a message.
pub fn shortened(text: &str) -> String {
    const LONGEST: usize = 60;
    let text = text.trim();
    if text.chars().count() <= LONGEST {
        format!("{text:?}")
    } else {
        format!("{:?}…", text.chars().take(LONGEST).collect::<String>())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(text: &str) -> Result<Document<'_>> {
        scan(text.as_bytes(), "r")
    }

    #[test]
    fn elements_attributes_and_text() {
        let text = "<?xml version='1.0' encoding=\"UTF-8\"?>\n<!-- head --><x:r xmlns:x='u' a = 'b>c'>\n<y/>one<!--in-->\
                    <y k=\"2\"> two </y><![CDATA[<&3>]]></x:r> <!-- foot -->";
        let document = root(text).unwrap();
        assert_eq!(document.encoding, Some("UTF-8"));
        assert_eq!(document.comments, [b" head ".as_slice(), b"in", b" foot "]);
        let r = &document.root;
        assert_eq!(r.attributes().collect::<Vec<_>>(), [("a", b"b>c".as_slice())]);
        assert_eq!(&*r.text, b"one<&amp;3>");
        assert_eq!(r.all("y").count(), 2);
        assert_eq!(&*r.children[1].text, b" two ");
        assert_eq!(r.children[1].text_at, text.find(" two "));
        assert!(document.text_before.is_none() && document.text_behind.is_none());
    }

    #[test]
    fn pieces_of_text_are_kept_apart_as_they_were() {
        for (text, expected) in [
            ("<r>1<!-- -->2</r>", "12"),
            ("<r>1<!-- --> <!-- -->2</r>", "1 2"),
            ("<r> <!-- -->1 2 <!-- --> </r>", "1 2 "),
            ("<r><![CDATA[a & & b]]></r>", "a &amp; &amp; b"),
            ("<r>a<b/> <![CDATA[&]]></r>", "a &amp;"),
        ] {
            assert_eq!(&*root(text).unwrap().root.text, expected.as_bytes(), "{text}");
        }
        // Comments behind the text do not make a copy of it.
        assert!(matches!(
            root("<r>1 2 <!-- --> </r>").unwrap().root.text,
            Cow::Borrowed(_)
        ));
    }

    #[test]
    fn text_around_the_root_is_noted() {
        let document = root("log: a < b\n<?xml version='1.0'?><r/>behind").unwrap();
        assert_eq!((document.text_before, document.text_behind), (Some(0), Some(36)));
    }

    #[test]
    fn damage_is_named_with_its_line() {
        for (text, expected) in [
            ("", "line 1: the file is empty"),
            ("hello", "line 1: no <r> in it"),
            ("<r>\n<a>", "line 2, <a>: the file ends before </a>"),
            ("<r>\n<a></b></r>", "line 2, <a>: </a> is due but </b> stands there"),
            ("<r>\n<a b></a></r>", "line 2, <a>: attribute \"b\" has no quoted value"),
            ("<r>\n\n<a b='", "line 3, <a>: the tag has no end"),
            ("<r><!-- ", "line 1: the file ends inside of a comment"),
            ("<r>1 < 2</r>", "line 1: '<' does not begin a tag"),
            ("<!DOCTYPE r [<!ENTITY a 'b'>]><r>&a;</r>", "line 1: a document type"),
        ] {
            let error = root(text).unwrap_err().to_string();
            assert!(error.starts_with(expected), "{text:?}: {error}");
        }
        let deep = "<r>".repeat(1000);
        assert!(root(&deep).unwrap_err().to_string().contains("nested more than"));
        let many = format!("<r>{}</r>", "<a/>".repeat(MAX_NODES));
        assert!(root(&many).unwrap_err().to_string().contains("elements"));
    }
}
