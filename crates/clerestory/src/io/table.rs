//! Tables of numbers as laboratories write them: rows of columns, with comments and columns of words.

use std::collections::HashMap;
use std::fmt::Write;

use super::counted;
use super::number::Numbers;
use crate::error::{Error, Result};

/// How a table is written.
#[derive(Debug, Clone, Default)]
pub struct Layout {
    /// Columns of every row; as many as the first has, if it is 0.
    pub columns: usize,
    /// What stands between columns, blanks about it ignored; blanks, tabs, a comma or a semicolon if there is none.
    pub delimiter: Option<u8>,
    /// Columns of words, from 0.
    pub words: Vec<usize>,
    /// Columns that stay the same over many rows, from 0: a value is kept for each run of rows only.
    pub runs: Vec<usize>,
    /// Whether a field may be empty (and is not a number then).
    pub empty: bool,
    /// Whether a line of comment behind rows ends the table.
    pub stops: bool,
}

/// What was read.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Table {
    /// Numbers, column by column; in a column of words each one's place in its list. One a run in columns of runs.
    pub columns: Vec<Vec<f64>>,
    /// First row of each run, where columns of runs are asked for.
    pub starts: Vec<usize>,
    /// How many rows there are.
    pub rows: usize,
    /// Different words of each column of words, in their order in the file.
    pub words: Vec<Vec<String>>,
    /// Where the table ends (bytes from the start).
    pub end: usize,
    /// Line in which it ends, counted from 1.
    pub line: usize,
}

/// Reads the table at `start`, which is the beginning of line number `line`. Lines end as they do on any system; lines
/// that begin with `#` and empty ones are passed over.
pub fn read(text: &[u8], start: usize, line: usize, layout: &Layout) -> Result<Table> {
    if layout.runs.iter().any(|&column| column >= layout.columns) {
        return Err(Error::Argument("a column of runs is not one of the table's".into()));
    }
    if start > text.len() {
        return Err(Error::Argument(format!(
            "a table cannot begin at byte {start} of {}",
            text.len()
        )));
    }
    let mut reader = Reader {
        text,
        at: start,
        line,
        layout,
        lists: vec![HashMap::new(); layout.words.len()],
        table: Table {
            columns: vec![Vec::new(); layout.columns],
            words: vec![Vec::new(); layout.words.len()],
            ..Table::default()
        },
        places: places(&layout.words),
        runs: places(&layout.runs),
        run: vec![f64::NAN; layout.runs.len()],
        changed: true,
    };
    reader.rows()?;
    let mut table = reader.table;
    (table.end, table.line) = (reader.at, reader.line);
    Ok(table)
}

/// For each column up to the last of those listed, its place in the list.
fn places(listed: &[usize]) -> Vec<Option<usize>> {
    let length = listed.iter().max().map_or(0, |last| last + 1);
    (0..length)
        .map(|column| listed.iter().position(|&w| w == column))
        .collect()
}

struct Reader<'a> {
    text: &'a [u8],
    at: usize,
    line: usize,
    layout: &'a Layout,
    lists: Vec<HashMap<&'a [u8], usize>>,
    table: Table,
    places: Vec<Option<usize>>,
    runs: Vec<Option<usize>>,
    /// Values of the run that goes on.
    run: Vec<f64>,
    /// Whether the row begins a run.
    changed: bool,
}

impl Reader<'_> {
    fn rows(&mut self) -> Result<()> {
        let mut any = false;
        loop {
            let start = self.at;
            self.blanks();
            match self.here() {
                None => return Ok(()),
                Some(b'\n' | b'\r') => {}
                Some(b'#') => {
                    if any && self.layout.stops {
                        self.at = start;
                        return Ok(());
                    }
                    self.rest_of_line();
                }
                Some(_) => {
                    self.row()?;
                    any = true;
                }
            }
            self.line_end();
        }
    }

    fn row(&mut self) -> Result<()> {
        let start = self.at;
        let first = self.table.columns.is_empty();
        let (mut count, mut tight, mut blank) = (0, false, false);
        loop {
            if first {
                self.table.columns.push(Vec::new());
            }
            let value = self.field(count)?;
            match self.table.columns.get_mut(count) {
                Some(column) => match self.runs.get(count) {
                    Some(&Some(run)) => {
                        self.changed |= self.run[run].to_bits() != value.to_bits();
                        self.run[run] = value;
                    }
                    _ => column.push(value),
                },
                None => return Err(self.miscount(start)),
            }
            count += 1;
            let spaces = self.blanks();
            match self.here() {
                None | Some(b'\n' | b'\r') => break,
                Some(b'#') if spaces => {
                    self.rest_of_line();
                    break;
                }
                Some(c) if self.separates(c) => {
                    self.at += 1;
                    let after = self.blanks();
                    tight |= c == b',' && !spaces && !after;
                    blank |= c == b';';
                    if matches!(self.here(), None | Some(b'\n' | b'\r'))
                        && (first && !self.layout.empty || count == self.table.columns.len())
                    {
                        break;
                    }
                }
                Some(b',') if self.layout.delimiter.is_some_and(|d| d != b',') => return Err(self.decimal_comma()),
                // A tab that separates is among the blanks where no delimiter is set.
                Some(_) if spaces && self.layout.delimiter.is_none() => blank = true,
                Some(_) => {
                    let word = self.shown(self.at);
                    return Err(self.error(
                        format!("{word:?} follows a field without a separator"),
                        "separate columns by one kind of character",
                    ));
                }
            }
            // One comma cannot both separate columns and be part of a number.
            if tight && blank && self.layout.delimiter.is_none() {
                return Err(self.decimal_comma());
            }
        }
        if tight && blank && self.layout.delimiter.is_none() {
            return Err(self.decimal_comma());
        }
        if count != self.table.columns.len() {
            return Err(self.miscount(start));
        }
        if self.changed && !self.layout.runs.is_empty() {
            for (&column, &value) in self.layout.runs.iter().zip(&self.run) {
                self.table.columns[column].push(value);
            }
            self.table.starts.push(self.table.rows);
        }
        self.changed = false;
        self.table.rows += 1;
        Ok(())
    }

    #[inline]
    fn field(&mut self, column: usize) -> Result<f64> {
        if let Some(&Some(list)) = self.places.get(column) {
            return self.word(list);
        }
        match self.here() {
            Some(c) if !self.separates(c) && !matches!(c, b'\n' | b'\r') => {
                let mut numbers = Numbers::from(self.text, self.at);
                match numbers.number(c) {
                    Ok(value) => {
                        self.at = numbers.position();
                        Ok(value)
                    }
                    Err(_) => Err(self.error(
                        format!("{:?} is not a finite number", self.shown(self.at)),
                        "numbers are written like 0.0123 or 1.23e-2",
                    )),
                }
            }
            _ if self.layout.empty => Ok(f64::NAN),
            _ => Err(self.error(
                format!("column {} is empty", column + 1),
                "give a number in every column, with a point as in 0.5 and not a comma",
            )),
        }
    }

    /// A word's place in the list of its column.
    fn word(&mut self, list: usize) -> Result<f64> {
        let word = if self.here() == Some(b'"') {
            let start = self.at + 1;
            let mut end = start;
            loop {
                match self.text.get(end) {
                    Some(b'"') if self.text.get(end + 1) == Some(&b'"') => end += 2,
                    Some(b'"') => break,
                    None | Some(b'\n' | b'\r') => {
                        return Err(self.error("a quotation mark is not closed".into(), "close it in the same line"));
                    }
                    Some(_) => end += 1,
                }
            }
            self.at = end + 1;
            &self.text[start..end]
        } else {
            let rest = &self.text[self.at..];
            let free = self.layout.delimiter.is_none();
            let ends = |&c: &u8| matches!(c, b'\n' | b'\r') || self.separates(c) || (free && matches!(c, b' ' | b'\t'));
            let length = rest.iter().position(ends).unwrap_or(rest.len());
            self.at += length;
            rest[..length].trim_ascii_end()
        };
        let words = &mut self.table.words[list];
        let place = *self.lists[list].entry(word).or_insert_with(|| {
            words.push(String::from_utf8_lossy(word).replace("\"\"", "\""));
            words.len() - 1
        });
        Ok(place as f64)
    }

    fn here(&self) -> Option<u8> {
        self.text.get(self.at).copied()
    }

    #[inline]
    fn separates(&self, c: u8) -> bool {
        match self.layout.delimiter {
            Some(d) => c == d,
            None => matches!(c, b',' | b';'),
        }
    }

    /// Moves on over blanks; whether there were any.
    #[inline]
    fn blanks(&mut self) -> bool {
        let start = self.at;
        let tab = self.layout.delimiter != Some(b'\t');
        while self.here().is_some_and(|c| c == b' ' || (tab && c == b'\t')) {
            self.at += 1;
        }
        self.at > start
    }

    fn rest_of_line(&mut self) {
        let rest = &self.text[self.at..];
        let end = rest.iter().position(|c| matches!(c, b'\n' | b'\r'));
        self.at += end.unwrap_or(rest.len());
    }

    fn line_end(&mut self) {
        match self.here() {
            Some(b'\r') if self.text.get(self.at + 1) == Some(&b'\n') => self.at += 2,
            Some(b'\r' | b'\n') => self.at += 1,
            _ => return,
        }
        self.line += 1;
    }

    /// What stands at a place, for a message.
    fn shown(&self, at: usize) -> String {
        let rest = &self.text[at..];
        let ends = |&c: &u8| matches!(c, b'\n' | b'\r' | b' ' | b'\t') || self.separates(c);
        let length = rest.iter().position(ends).unwrap_or(rest.len()).clamp(1, 40);
        String::from_utf8_lossy(&rest[..length.min(rest.len())]).into_owned()
    }

    fn miscount(&self, start: usize) -> Error {
        let rest = &self.text[start..];
        let end = rest.iter().position(|c| matches!(c, b'\n' | b'\r'));
        let row = &rest[..end.unwrap_or(rest.len())];
        let wanted = self.table.columns.len();
        let what = format!(
            "the row does not have {} as asked for by the header or the rows above",
            counted(wanted, "column")
        );
        let remedy = if row.contains(&b',') && !row.contains(&b'.') {
            "write numbers with a decimal point, as 0.5 and not 0,5"
        } else {
            "complete the row or take it out"
        };
        self.error(what, remedy)
    }

    fn decimal_comma(&self) -> Error {
        self.error(
            "a comma stands inside of a number".into(),
            "write numbers with a decimal point, as 0.5 and not 0,5",
        )
    }

    fn error(&self, what: String, remedy: &str) -> Error {
        Error::format(format!("line {}", self.line), what, remedy)
    }
}

/// Rows of numbers as text, each behind `before` and with line ends: the shortest digits that give the same number, and
/// nothing for one that is none.
pub fn write(columns: &[&[f64]], before: &str, separator: char) -> Vec<u8> {
    let rows = columns.iter().map(|c| c.len()).min().unwrap_or(0);
    let mut text = String::with_capacity(rows * (before.len() + 12 * columns.len()));
    for row in 0..rows {
        text.push_str(before);
        for (k, column) in columns.iter().enumerate() {
            if k > 0 {
                text.push(separator);
            }
            let value = column[row];
            let plain = value == 0.0 || (1e-4..1e15).contains(&value.abs());
            // Writing to memory cannot fail.
            let _ = match value {
                v if v.is_nan() => Ok(()),
                v if plain => write!(text, "{v}"),
                v => write!(text, "{v:e}"),
            };
        }
        text.push('\n');
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Vec<Vec<f64>>> {
        read(text.as_bytes(), 0, 1, &Layout::default()).map(|t| t.columns)
    }

    fn message(text: &str) -> String {
        all(text).unwrap_err().to_string()
    }

    #[test]
    fn any_separator_and_line_end_gives_the_same() {
        let expected = vec![vec![1.0, 4.0], vec![-2.5, 5e-3], vec![3.0, 6.0]];
        for separator in [" ", "\t", ",", ";", ", ", " ; ", "   "] {
            for end in ["\n", "\r\n", "\r"] {
                let text = ["# head", "", "1 -2.5 3", "  # between", "4 5e-3 6 # behind", "# last"]
                    .map(|l| {
                        if l.contains('#') && !l.contains('6') {
                            l.to_owned()
                        } else {
                            l.replace(' ', separator)
                                .replace(&format!("{separator}#{separator}"), " # ")
                        }
                    })
                    .join(end);
                assert_eq!(all(&text).unwrap(), expected, "{text:?}");
                assert_eq!(all(&format!("{text}{end}")).unwrap(), expected);
            }
        }
        assert!(all("").unwrap().is_empty());
        assert_eq!(all("1,2,\n3,4,\n").unwrap(), [[1.0, 3.0], [2.0, 4.0]]);
    }

    #[test]
    fn decimal_commas_are_named() {
        for text in ["12,5 30,0 0,25", "12,5;30,0;0,25", "12,5\t30,0\t0,25", "1,5 2"] {
            assert!(message(text).contains("decimal point"), "{text}: {}", message(text));
        }
        let layout = Layout {
            columns: 3,
            ..Layout::default()
        };
        let error = read(b"0 0 1\n0,5,30,0,1,0", 0, 7, &layout).unwrap_err().to_string();
        assert!(
            error.starts_with("line 8: ") && error.contains("decimal point"),
            "{error}"
        );
    }

    #[test]
    fn faults_are_found_in_their_line() {
        for (text, line, what) in [
            ("1 2\n3", 2, "2 columns"),
            ("1 2\r3 4\r\r5 6 7", 4, "2 columns"),
            ("1 2\n3 nan", 2, "\"nan\" is not a finite number"),
            ("1 2\n3 1e999", 2, "\"1e999\""),
            ("1 2\n# c\n3 abc", 3, "\"abc\""),
            ("1,,2", 1, "column 2 is empty"),
            ("1 2\u{0}", 1, "is not a finite number"),
            ("1 {2}", 1, "is not a finite number"),
            ("1} 2", 1, "without a separator"),
        ] {
            let text = message(text);
            assert!(
                text.starts_with(&format!("line {line}: ")) && text.contains(what),
                "{text}"
            );
        }
    }

    #[test]
    fn words_and_empty_fields_have_columns_of_their_own() {
        let layout = Layout {
            columns: 4,
            delimiter: Some(b','),
            words: vec![0, 2],
            empty: true,
            ..Layout::default()
        };
        let text = b"front side,1,\"a, \"\"b\"\"\",2\nback,,c,\nfront side, 3 ,c,4\n";
        let table = read(text, 0, 1, &layout).unwrap();
        assert_eq!(table.words, [vec!["front side", "back"], vec!["a, \"b\"", "c"]]);
        assert_eq!(table.columns[0], [0.0, 1.0, 0.0]);
        assert_eq!(table.columns[2], [0.0, 1.0, 1.0]);
        assert!(table.columns[1][1].is_nan() && table.columns[3][1].is_nan());
        assert_eq!((table.end, table.line), (text.len(), 4));
        let open = read(b"a,1,\"b,2\n", 0, 1, &layout).unwrap_err().to_string();
        assert!(open.contains("not closed"), "{open}");
    }

    #[test]
    fn a_comment_behind_rows_may_end_a_table() {
        let layout = Layout {
            stops: true,
            ..Layout::default()
        };
        let text = b"# a\n1 2\n3 4\n# b\n5 6\n";
        let first = read(text, 0, 1, &layout).unwrap();
        assert_eq!(first.columns, [[1.0, 3.0], [2.0, 4.0]]);
        assert_eq!((&text[first.end..first.end + 3], first.line), (&b"# b"[..], 4));
        let second = read(text, first.end, first.line, &layout).unwrap();
        assert_eq!((second.columns[0][0], second.line), (5.0, 6));
    }

    #[test]
    fn columns_of_runs_are_kept_once_a_run() {
        let layout = Layout {
            columns: 3,
            runs: vec![2, 0],
            ..Layout::default()
        };
        let table = read(b"1 5 2\n1 6 2\n1 7 3\n1 8 3\n1 9 2\n", 0, 1, &layout).unwrap();
        assert_eq!(
            table.columns,
            [vec![1.0; 3], vec![5.0, 6.0, 7.0, 8.0, 9.0], vec![2.0, 3.0, 2.0]]
        );
        assert_eq!((table.starts, table.rows), (vec![0, 2, 4], 5));
        let beyond = Layout {
            columns: 2,
            runs: vec![2],
            ..Layout::default()
        };
        assert!(read(b"1 2", 0, 1, &beyond).is_err());
    }

    #[test]
    fn what_is_written_is_read() {
        let columns: Vec<Vec<f64>> = (0..3)
            .map(|k| {
                (0..500)
                    .map(|n| (crate::sequence::uniform(k, n) - 0.5) * 10_f64.powi((n % 40) as i32 - 20))
                    .chain([0.0, 90.0, 0.1, f64::MAX, 5e-324])
                    .collect()
            })
            .collect();
        let slices: Vec<&[f64]> = columns.iter().map(Vec::as_slice).collect();
        for separator in [' ', ',', ';', '\t'] {
            let text = write(&slices, "", separator);
            assert_eq!(read(&text, 0, 1, &Layout::default()).unwrap().columns, columns);
        }
        let text = write(&[&[1.5, f64::NAN], &[1e-7, 2.0]], "a,", ',');
        assert_eq!(String::from_utf8(text).unwrap(), "a,1.5,1e-7\na,,2\n");
    }
}
