//! Lists of numbers as BSDF files hold them, parsed straight from the bytes.

use crate::error::{Error, Result};

/// Numbers of a text, separated by blanks, tabs, line ends and a single comma.
#[derive(Debug, Clone)]
pub struct Numbers<'a> {
    text: &'a [u8],
    at: usize,
}

/// 10⁰ to 10²²: the powers that a double holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

impl<'a> Numbers<'a> {
    /// Numbers of `text`.
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0 }
    }

    /// Where the next character to read stands (bytes from the start).
    pub fn position(&self) -> usize {
        self.at
    }

    /// Moves on over blanks and one comma; the character that follows, if there is one.
    pub fn peek(&mut self) -> Option<u8> {
        let mut comma = false;
        while let Some(&c) = self.text.get(self.at) {
            match c {
                b'\n' => {
                    // Indented files are half blanks: eight at a time.
                    while self.text.get(self.at + 1..self.at + 9) == Some(&[b' '; 8]) {
                        self.at += 8;
                    }
                }
                b' ' | b'\t' | b'\r' => {}
                b',' if !comma => comma = true,
                _ => return Some(c),
            }
            self.at += 1;
        }
        None
    }

    /// Takes one character that [`Numbers::peek`] has shown.
    pub fn skip(&mut self) {
        self.at += 1;
    }

    /// The next number, or `None` at the end. The error says what stands there instead; its place is the offset in bytes.
    pub fn next_number(&mut self) -> Option<Result<f64>> {
        self.peek()?;
        // Sign, digits, point, digits, exponent. With no more than 15 digits and a small power of ten both are exact, and
        // so is their product or quotient (Clinger 1990).
        let start = self.at;
        let text = &self.text[start..];
        let mut k = usize::from(matches!(text[0], b'-' | b'+'));
        let mut mantissa = 0_u64;
        let before = digits(text, &mut k, &mut mantissa);
        let after = if text.get(k) == Some(&b'.') {
            k += 1;
            digits(text, &mut k, &mut mantissa)
        } else {
            0
        };
        let mut exponent = -(after as i64);
        let exact = (1..=15).contains(&(before + after)) && exponential(text, &mut k, &mut exponent);
        let power = exponent.unsigned_abs() as usize;
        if !exact || power >= POWERS.len() || text.get(k).is_some_and(|&c| !ends_word(c)) {
            return Some(self.slow(start));
        }
        self.at = start + k;
        let size = mantissa as f64;
        let value = if exponent < 0 {
            size / POWERS[power]
        } else {
            size * POWERS[power]
        };
        Some(Ok(if text[0] == b'-' { -value } else { value }))
    }

    fn slow(&mut self, start: usize) -> Result<f64> {
        let text = &self.text[start..];
        let end = text.iter().position(|&c| ends_word(c)).unwrap_or(text.len());
        let word = String::from_utf8_lossy(&text[..end.min(40)]);
        match std::str::from_utf8(&text[..end])
            .ok()
            .and_then(|w| w.parse::<f64>().ok())
        {
            Some(value) if value.is_finite() => {
                self.at = start + end;
                Ok(value)
            }
            _ => Err(Error::format(
                start.to_string(),
                format!("{word:?} is not a finite number"),
                "numbers are written like 0.0123 or 1.23e-2, separated by blanks or commas",
            )),
        }
    }
}

/// Whether a number cannot go on with this character.
fn ends_word(c: u8) -> bool {
    matches!(c, b' ' | b'\t' | b'\r' | b'\n' | b',' | b'{' | b'}' | b'<')
}

/// Appends the digits that stand at `k` to `mantissa`; how many there are.
fn digits(text: &[u8], k: &mut usize, mantissa: &mut u64) -> usize {
    let first = *k;
    while let Some(&c) = text.get(*k) {
        let digit = c.wrapping_sub(b'0');
        if digit > 9 {
            break;
        }
        *mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        *k += 1;
    }
    *k - first
}

/// Adds the exponent that stands at `k`, if one does; whether it is well formed and not huge.
fn exponential(text: &[u8], k: &mut usize, exponent: &mut i64) -> bool {
    if !matches!(text.get(*k), Some(b'e' | b'E')) {
        return true;
    }
    *k += 1;
    let negative = match text.get(*k) {
        Some(sign @ (b'-' | b'+')) => {
            *k += 1;
            *sign == b'-'
        }
        _ => false,
    };
    let mut size = 0;
    let count = digits(text, k, &mut size);
    *exponent += if negative { -(size as i64) } else { size as i64 };
    (1..=3).contains(&count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Vec<f64>> {
        let mut numbers = Numbers::new(text.as_bytes());
        let mut values = Vec::new();
        while let Some(value) = numbers.next_number() {
            values.push(value?);
        }
        Ok(values)
    }

    #[test]
    fn separators_may_be_mixed() {
        assert_eq!(all(" 1, 2\t3\r\n-4.5 ,\n 6e-3,").unwrap(), [1.0, 2.0, 3.0, -4.5, 6e-3]);
        assert_eq!(all("").unwrap(), Vec::<f64>::new());
    }

    #[test]
    fn digits_agree_with_the_standard_parser() {
        for k in 0..20_000_u64 {
            let x = crate::sequence::uniform(1, k) * 10_f64.powi((k % 30) as i32 - 15);
            for text in [
                format!("{x:.6}"),
                format!("{x:e}"),
                format!("{x:.6e}"),
                format!("{x:.3E}"),
                format!("{x:.15}"),
                format!("{x}"),
            ] {
                assert_eq!(all(&text).unwrap(), [text.parse::<f64>().unwrap()], "{text}");
            }
        }
    }

    #[test]
    fn what_is_no_number_is_refused() {
        for text in [
            "nan",
            "inf",
            "1e999",
            "--1",
            "1.2.3",
            "abc",
            "1,,2",
            "0x10",
            ".",
            "-",
            "1e",
            "1 \u{0} 2",
        ] {
            assert!(all(text).is_err(), "{text:?}");
        }
    }
}
