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
                b' ' | b'\t' | b'\r' | b'\n' => {}
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
        let start = self.at;
        // Sign, digits, point, digits: most numbers end there, and are exact if small enough (Clinger 1990).
        let text = &self.text[start..];
        let mut k = usize::from(matches!(text[0], b'-' | b'+'));
        let (mut mantissa, mut digits, mut scale) = (0_u64, 0_u32, 0_usize);
        let mut point = false;
        while let Some(&c) = text.get(k) {
            if c.is_ascii_digit() {
                mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(c - b'0'));
                digits += 1;
                scale += usize::from(point);
            } else if c == b'.' && !point {
                point = true;
            } else {
                break;
            }
            k += 1;
        }
        let ends = text
            .get(k)
            .is_none_or(|c| matches!(c, b' ' | b'\t' | b'\r' | b'\n' | b',' | b'{' | b'}' | b'<'));
        if ends && digits > 0 && digits <= 15 {
            self.at = start + k;
            let value = mantissa as f64 / POWERS[scale];
            return Some(Ok(if text[0] == b'-' { -value } else { value }));
        }
        Some(self.slow(start))
    }

    fn slow(&mut self, start: usize) -> Result<f64> {
        let text = &self.text[start..];
        let end = text
            .iter()
            .position(|c| matches!(c, b' ' | b'\t' | b'\r' | b'\n' | b',' | b'{' | b'}' | b'<'))
            .unwrap_or(text.len());
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
            for text in [format!("{x:.6}"), format!("{x:e}"), format!("{x:.15}"), format!("{x}")] {
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
