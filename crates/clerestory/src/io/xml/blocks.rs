//! The values of one `<WavelengthDataBlock>`.

use std::sync::Arc;

use super::basis::{Choice, settle};
use super::place;
use crate::basis::Basis;
use crate::bsdf::{Matrix, Model, Rank, tree};
use crate::direction::{Scatter, Side};
use crate::error::{Error, Result};
use crate::io::number::Numbers;

const ELEMENT: &str = "ScatteringData";

/// How the values of a block are arranged.
pub(super) enum Shape {
    Matrix {
        incident: Choice,
        outgoing: Choice,
        /// All outgoing values of the first incident patch come first ("Rows"); otherwise all incident ones of the
        /// first outgoing patch ("Columns").
        by_incident: bool,
    },
    Tree(Rank),
}

/// A block that is to be parsed.
pub(super) struct Block<'d> {
    /// Number of the band.
    pub band: usize,
    pub side: Side,
    pub scatter: Scatter,
    pub shape: Shape,
    /// Text of `<ScatteringData>`.
    pub text: &'d [u8],
    /// Where the text stands in the file, if it is in one piece.
    pub text_at: Option<usize>,
    /// Where the block's `<ScatteringData>` stands.
    pub at: usize,
}

/// A parsed block: the model, and what is to be warned of.
pub(super) struct Parsed {
    pub model: Model,
    pub warnings: Vec<String>,
}

impl Block<'_> {
    /// Place of an offset in the text.
    fn place(&self, bytes: &[u8], offset: usize) -> String {
        place(bytes, self.text_at.map_or(self.at, |at| at + offset), ELEMENT)
    }

    /// Moves an error's offset in the text to the file's line.
    fn moved(&self, bytes: &[u8], error: Error) -> Error {
        match error {
            Error::Format { place, what, remedy } => {
                Error::format(self.place(bytes, place.parse().unwrap_or(0)), what, remedy)
            }
            other => Error::format(self.place(bytes, 0), other.to_string(), "correct the data"),
        }
    }

    /// `flat` is room for the numbers, which may serve one block after the other.
    pub fn parse(&self, bytes: &[u8], hint: Option<&Arc<Basis>>, flat: &mut Vec<f64>) -> Result<Parsed> {
        match &self.shape {
            Shape::Tree(rank) => {
                let (tree, clamped) = tree::parse(*rank, self.text).map_err(|e| self.moved(bytes, e))?;
                let warnings = negatives(clamped.negatives, clamped.least).into_iter().collect();
                Ok(Parsed {
                    model: Model::Tree(tree),
                    warnings,
                })
            }
            Shape::Matrix {
                incident,
                outgoing,
                by_incident,
            } => {
                self.numbers(bytes, flat)?;
                let (i, o, warning) = settle(incident, outgoing, hint, flat.len()).map_err(|misfit| {
                    if has_decimal_commas(self.text) {
                        self.decimal_commas(bytes)
                    } else {
                        Error::format(place(bytes, self.at, ELEMENT), misfit.what, misfit.remedy)
                    }
                })?;
                let count = flat.iter().filter(|v| **v < 0.0).count();
                let least = if count > 0 {
                    flat.iter().copied().fold(0.0, f64::min)
                } else {
                    0.0
                };
                let values = if *by_incident {
                    std::mem::take(flat)
                } else {
                    transposed(flat, o.len(), i.len())
                };
                Ok(Parsed {
                    model: Model::Matrix(Matrix::new(i, o, values).map_err(|e| self.moved(bytes, e))?),
                    warnings: warning.into_iter().chain(negatives(count, least)).collect(),
                })
            }
        }
    }

    fn numbers(&self, bytes: &[u8], flat: &mut Vec<f64>) -> Result<()> {
        if self.text.trim_ascii_start().starts_with(b"{") {
            return Err(Error::format(
                self.place(bytes, 0),
                "a tensor tree stands where a matrix is announced",
                "make <IncidentDataStructure> TensorTree3 or TensorTree4",
            ));
        }
        // Six characters a number is what short files have; a longer guess would cost memory for nothing.
        flat.clear();
        flat.reserve(self.text.len() / 6);
        Numbers::new(self.text).append_to(flat).map_err(|e| {
            if has_decimal_commas(self.text) {
                self.decimal_commas(bytes)
            } else {
                self.moved(bytes, e)
            }
        })
    }

    fn decimal_commas(&self, bytes: &[u8]) -> Error {
        Error::format(
            self.place(bytes, 0),
            "the numbers are written with decimal commas",
            "write 0.5 instead of 0,5",
        )
    }
}

fn negatives(count: usize, least: f64) -> Option<String> {
    (count > 0).then(|| {
        if count == 1 {
            format!("1 negative value, {least:e}; it counts as 0")
        } else {
            format!("{count} negative values, the least {least:e}; they count as 0")
        }
    })
}

/// Rows become columns.
pub(super) fn transposed(flat: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    // As many columns together as make a line of the processor's cache.
    const TOGETHER: usize = 8;
    let mut values = vec![0.0; rows * columns];
    for (first, block) in values.chunks_mut(TOGETHER * rows).enumerate() {
        let from = TOGETHER * first;
        for (r, row) in flat.chunks_exact(columns).enumerate() {
            for (column, value) in block.chunks_exact_mut(rows).zip(&row[from..]) {
                column[r] = *value;
            }
        }
    }
    values
}

/// Whether the text looks like `0,5 0,25`: words of digits with one comma within, and no point anywhere.
fn has_decimal_commas(text: &[u8]) -> bool {
    const WORDS: usize = 200;
    let mut within = 0;
    for word in text
        .split(u8::is_ascii_whitespace)
        .filter(|w| !w.is_empty())
        .take(WORDS)
    {
        let word = word.strip_suffix(b",").or(word.strip_suffix(b";")).unwrap_or(word);
        let commas = memchr::memchr_iter(b',', word).count();
        if commas > 1 || word.contains(&b'.') {
            return false;
        }
        let inner = word
            .windows(3)
            .any(|w| w[1] == b',' && w[0].is_ascii_digit() && w[2].is_ascii_digit());
        within += usize::from(inner);
    }
    within >= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_commas_are_told_from_separators() {
        for (text, expected) in [
            ("0,5 0,25 1", true),
            ("0,5; 0,25;", true),
            ("0,5, 0,25,", true),
            ("0.5, 0.25", false),
            ("0,5,0,25", false),
            ("0, 5, 0, 25", false),
            ("1 2 3", false),
            ("", false),
        ] {
            assert_eq!(has_decimal_commas(text.as_bytes()), expected, "{text}");
        }
    }

    #[test]
    fn transposing_is_by_row_and_column() {
        assert_eq!(transposed(&[1., 2., 3., 4., 5., 6.], 2, 3), [1., 4., 2., 5., 3., 6.]);
        let flat: Vec<f64> = (0..19 * 21).map(f64::from).collect();
        let turned = transposed(&flat, 19, 21);
        assert!((0..19 * 21).all(|k| turned[k % 21 * 19 + k / 21] == flat[k]));
    }
}
