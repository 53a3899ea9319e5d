//! Lists of numbers as BSDF files hold them, parsed straight from the bytes.

use crate::error::{Error, Result};

/// Numbers of a text, separated by blanks, tabs, line ends and a single comma.
#[derive(Debug, Clone, Copy)]
pub struct Numbers<'a> {
    text: &'a [u8],
    at: usize,
}

/// 10⁰ to 10²²: the powers that a double holds exactly.
const POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// 10⁰ to 10⁸.
const TENS: [u64; 9] = [1, 10, 100, 1000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000];

/// One in each of eight bytes.
const EACH: u64 = 0x0101_0101_0101_0101;

/// Eight blanks.
const BLANKS: u64 = EACH * b' ' as u64;

impl<'a> Numbers<'a> {
    /// Numbers of `text`.
    pub fn new(text: &'a [u8]) -> Self {
        Self { text, at: 0 }
    }

    /// Numbers of `text` behind its first `at` bytes.
    pub fn from(text: &'a [u8], at: usize) -> Self {
        Self { text, at }
    }

    /// Where the next character to read stands (bytes from the start).
    pub fn position(&self) -> usize {
        self.at
    }

    /// Moves on over blanks and one comma; the character that follows, if there is one.
    #[inline]
    pub fn peek(&mut self) -> Option<u8> {
        self.peek_behind(false)
    }

    /// The same, where a comma may have been passed already.
    #[inline]
    fn peek_behind(&mut self, mut comma: bool) -> Option<u8> {
        while let Some(&c) = self.text.get(self.at) {
            // All separators are below or at the comma: most characters need no other question.
            if c > b',' {
                return Some(c);
            }
            match c {
                b' ' | b'\t' | b'\r' | b'\n' => {}
                b',' if !comma => comma = true,
                _ => return Some(c),
            }
            self.at += 1;
            if c == b'\n' {
                self.indentation();
            }
        }
        None
    }

    /// Moves on over blanks, eight at a time: indented files are half blanks.
    #[inline]
    fn indentation(&mut self) {
        while self.text.get(self.at) == Some(&b' ') {
            let others = eight(self.text, self.at) ^ BLANKS;
            self.at += others.trailing_zeros() as usize / 8;
            if others != 0 {
                return;
            }
        }
    }

    /// Takes one character that [`Numbers::peek`] has shown.
    pub fn skip(&mut self) {
        self.at += 1;
    }

    /// The number that begins with the character that [`Numbers::peek`] has shown. The error says what stands there
    /// instead; its place is the offset in bytes.
    #[allow(clippy::inline_always, reason = "the loop about it is faster by a third")]
    #[inline(always)]
    pub fn number(&mut self, first: u8) -> Result<f64> {
        // The position is kept out of the other functions' reach, so that it stays in a register.
        let (value, end) = match usual(self.text, self.at, first) {
            Some(found) => found,
            None => any(self.text, self.at)?,
        };
        self.at = end;
        Ok(value)
    }

    /// Appends all numbers to `values`.
    pub fn append_to(mut self, values: &mut Vec<f64>) -> Result<()> {
        const PATIENCE: u32 = 16;
        let (mut pattern, mut strangers, mut comma) = (None::<Pattern>, 0, false);
        while let Some(first) = self.peek_behind(comma) {
            comma = false;
            if let Some(pattern) = &pattern {
                let end = pattern.append_all(self.text, self.at, values);
                if end > self.at {
                    (self.at, strangers, comma) = (end, 1, pattern.comma);
                    continue;
                }
            }
            let start = self.at;
            values.push(self.number(first)?);
            // A stranger now and then is no reason for another pattern.
            if strangers % PATIENCE == 0 {
                pattern = Pattern::of(self.text, start);
            }
            strangers += 1;
        }
        Ok(())
    }
}

/// How a number and what separates it from the next one are written. Programs write most numbers of a file alike, and whoever
/// knows where the next one begins need not read this one first.
#[derive(Debug, Clone, Copy)]
struct Pattern {
    /// The characters, the first in the lowest bits, '0' for any digit.
    characters: u128,
    /// Which bits of them count.
    mask: u128,
    /// What raises the highest bit of a byte that does not fit, if it is added to its difference from the pattern.
    limits: u128,
    /// Digits behind the point.
    count: usize,
    /// Sign of the exponent, and bits in front of its two digits.
    exponent: Option<(i32, u32)>,
    /// Characters up to the next number.
    length: usize,
    /// Whether one of them is a comma.
    comma: bool,
}

impl Pattern {
    /// Longest pattern.
    const MOST: usize = size_of::<u128>();

    /// Of the number at `at`, if it is one digit, a point, one to seven digits, and perhaps a signed exponent of two digits.
    fn of(text: &[u8], at: usize) -> Option<Self> {
        let chunk: &[u8; Self::MOST] = text.get(at..)?.first_chunk()?;
        let digits_from = |k: usize| chunk[k..].iter().take_while(|c| c.is_ascii_digit()).count();
        let count = digits_from(2);
        if digits_from(0) != 1 || chunk[1] != b'.' || !(1..8).contains(&count) {
            return None;
        }
        let mut length = 2 + count;
        let mut exponent = None;
        if let [b'e', sign @ (b'-' | b'+'), ..] = chunk[length..] {
            length += 2;
            if digits_from(length) != 2 {
                return None;
            }
            exponent = Some((if sign == b'-' { -1 } else { 1 }, 8 * length as u32));
            length += 2;
        }
        let mut behind = Numbers {
            text: chunk,
            at: length,
        };
        behind.peek();
        if behind.at == length {
            return None;
        }
        let mut pattern = Self {
            characters: 0,
            mask: 0,
            limits: 0,
            count,
            exponent,
            length: behind.at,
            comma: chunk[length..behind.at].contains(&b','),
        };
        for (k, &c) in chunk[..pattern.length].iter().enumerate() {
            let (c, limit) = if c.is_ascii_digit() {
                (b'0', 0x80 - 10)
            } else {
                (c, 0x80 - 1)
            };
            pattern.characters |= u128::from(c) << (8 * k);
            pattern.mask |= 0xff << (8 * k);
            pattern.limits |= limit << (8 * k);
        }
        Some(pattern)
    }

    /// Appends the numbers that follow each other from `at` on in this pattern; where they end.
    fn append_all(&self, text: &[u8], mut at: usize, values: &mut Vec<f64>) -> usize {
        const HIGHEST: u128 = 0x80 * (u128::MAX / 0xff);
        let power = TENS[self.count];
        while let Some(chunk) = text.get(at..).and_then(<[u8]>::first_chunk) {
            let digits = (u128::from_le_bytes(*chunk) ^ self.characters) & self.mask;
            if (digits | digits.wrapping_add(self.limits)) & HIGHEST != 0 {
                break;
            }
            let behind_point = (digits >> 16) as u64;
            let mantissa = (digits as u64 & 0xff) * power + united(behind_point << (64 - 8 * self.count));
            let mut exponent = -(self.count as i32);
            if let Some((sign, bits)) = self.exponent {
                let [tens, ones] = ((digits >> bits) as u16).to_le_bytes().map(i32::from);
                exponent += sign * (10 * tens + ones);
            }
            let Some(value) = scaled(mantissa, exponent) else {
                break;
            };
            values.push(value);
            at += self.length;
        }
        at
    }
}

/// The number at `at` and where it ends, if it is written as most are: one digit, a point, up to seven more digits,
/// perhaps a signed exponent of two digits; and something behind it. None for all others.
///
/// What is alike in most numbers of a file is asked for in branches, which a processor foresees, so that it need not wait
/// for the end of one number to begin the next.
#[allow(clippy::inline_always, reason = "the loop about it is faster by a third")]
#[inline(always)]
fn usual(text: &[u8], at: usize, first: u8) -> Option<(f64, usize)> {
    let at = at + usize::from(first == b'-');
    let chunk: &[u8; 16] = text.get(at..)?.first_chunk()?;
    let digit = chunk[0].wrapping_sub(b'0');
    if digit > 9 || chunk[1] != b'.' {
        return None;
    }
    let word = u64::from_le_bytes(*chunk[2..].first_chunk()?);
    let count = leading_digits(word);
    if count == 8 {
        return None;
    }
    let mantissa = u64::from(digit) * TENS[count] + joined(word, count);
    let rest: &[u8; 5] = chunk[2 + count..].first_chunk()?;
    let (exponent, length) = match *rest {
        [b'e', sign, tens, ones, end] => {
            let (tens, ones) = (tens.wrapping_sub(b'0'), ones.wrapping_sub(b'0'));
            if tens > 9 || ones > 9 || !matches!(sign, b'-' | b'+') || !ends_word(end) {
                return None;
            }
            let size = i32::from(tens) * 10 + i32::from(ones);
            (if sign == b'-' { -size } else { size }, 6 + count)
        }
        [end, ..] if ends_word(end) => (0, 2 + count),
        _ => return None,
    };
    let value = scaled(mantissa, exponent - count as i32)?;
    Some((if first == b'-' { -value } else { value }, at + length))
}

/// Any number at `at`, and where it ends.
#[inline(never)]
fn any(text: &[u8], at: usize) -> Result<(f64, usize)> {
    if let Some(found) = exact(text, at) {
        return Ok(found);
    }
    let rest = &text[at..];
    // The first belongs to the word in any case: a message about nothing would not help.
    let length = 1 + rest[1..].iter().position(|&c| ends_word(c)).unwrap_or(rest.len() - 1);
    let word = &rest[..length];
    match std::str::from_utf8(word).ok().and_then(|w| w.parse::<f64>().ok()) {
        Some(value) if value.is_finite() => Ok((value, at + length)),
        _ => {
            let word = String::from_utf8_lossy(&word[..length.min(40)]);
            Err(Error::format(
                at.to_string(),
                format!("{word:?} is not a finite number"),
                "numbers are written like 0.0123 or 1.23e-2, separated by blanks or commas",
            ))
        }
    }
}

/// A number in any writing, and where it ends, if a double holds its digits and its power of ten exactly.
fn exact(text: &[u8], mut at: usize) -> Option<(f64, usize)> {
    let first = text[at];
    at += usize::from(matches!(first, b'-' | b'+'));
    let (mut mantissa, mut count) = digits(text, at, 0);
    at += count;
    let mut exponent = 0;
    if text.get(at) == Some(&b'.') {
        let (all, after) = digits(text, at + 1, mantissa);
        mantissa = all;
        count += after;
        at += 1 + after;
        exponent = -(after as i32);
    }
    // More digits might have overflowed.
    if !(1..=19).contains(&count) {
        return None;
    }
    exponent += exponential(text, &mut at)?;
    if text.get(at).is_some_and(|&c| !ends_word(c)) {
        return None;
    }
    let value = scaled(mantissa, exponent)?;
    Some((if first == b'-' { -value } else { value }, at))
}

/// `mantissa` times a power of ten, if a double holds both exactly, so that the result is the nearest double (Clinger
/// 1990).
#[inline]
fn scaled(mantissa: u64, exponent: i32) -> Option<f64> {
    let power = POWERS.get(exponent.unsigned_abs() as usize)?;
    if mantissa > 1 << f64::MANTISSA_DIGITS {
        return None;
    }
    let size = mantissa as f64;
    Some(if exponent < 0 { size / power } else { size * power })
}

/// The exponent that stands at `at`, moving behind it; 0 without one, `None` if it is ill formed or huge.
fn exponential(text: &[u8], at: &mut usize) -> Option<i32> {
    if !matches!(text.get(*at), Some(b'e' | b'E')) {
        return Some(0);
    }
    *at += 1;
    let sign = text.get(*at).copied().filter(|c| matches!(c, b'-' | b'+'));
    *at += usize::from(sign.is_some());
    let (size, count) = digits(text, *at, 0);
    *at += count;
    let size = if (1..=3).contains(&count) {
        size as i32
    } else {
        return None;
    };
    Some(if sign == Some(b'-') { -size } else { size })
}

/// Whether a number cannot go on with this character.
#[inline]
fn ends_word(c: u8) -> bool {
    matches!(c, b' ' | b'\t' | b'\r' | b'\n' | b',' | b';' | b'{' | b'}' | b'<')
}

/// Eight bytes that stand at `at`, the first in the lowest bits; zeros behind the end of the text.
#[inline]
fn eight(text: &[u8], at: usize) -> u64 {
    match text.get(at..).and_then(<[u8]>::first_chunk) {
        Some(bytes) => u64::from_le_bytes(*bytes),
        None => last(text, at),
    }
}

#[cold]
fn last(text: &[u8], at: usize) -> u64 {
    let mut bytes = [0; 8];
    let rest = text.get(at..).unwrap_or_default();
    bytes[..rest.len()].copy_from_slice(rest);
    u64::from_le_bytes(bytes)
}

/// Appends the digits that stand at `at` to `mantissa`; with how many there are. More than 19 may overflow.
fn digits(text: &[u8], mut at: usize, mut mantissa: u64) -> (u64, usize) {
    let first = at;
    loop {
        let word = eight(text, at);
        let count = leading_digits(word);
        if count < 8 {
            let mantissa = mantissa.wrapping_mul(TENS[count]).wrapping_add(joined(word, count));
            return (mantissa, at - first + count);
        }
        mantissa = mantissa.wrapping_mul(TENS[8]).wrapping_add(joined(word, 8));
        at += 8;
    }
}

/// How many of eight bytes are digits before the first that is none.
#[inline]
fn leading_digits(word: u64) -> usize {
    // Digits become 0 to 9. The highest bit of a byte then tells whether it is more; a carry spoils only bytes behind
    // one that is.
    let word = word ^ (EACH * u64::from(b'0'));
    let others = (word | word.wrapping_add(EACH * (0x80 - 10))) & (EACH * 0x80);
    others.trailing_zeros() as usize / 8
}

/// The number that the first `count` of eight bytes make.
#[inline]
fn joined(word: u64, count: usize) -> u64 {
    // Zeros come in front.
    let digits = (word ^ (EACH * u64::from(b'0'))).checked_shl(64 - 8 * count as u32);
    united(digits.unwrap_or(0))
}

/// The number that eight digits make, the first in the lowest bits: by pairs, then pairs of these, then all.
#[inline]
fn united(digits: u64) -> u64 {
    let pairs = digits.wrapping_mul(10).wrapping_add(digits >> 8);
    let first = (pairs & 0x0000_00ff_0000_00ff).wrapping_mul(100 + (1_000_000 << 32));
    let second = (pairs >> 16 & 0x0000_00ff_0000_00ff).wrapping_mul(1 + (10_000 << 32));
    first.wrapping_add(second) >> 32
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str) -> Result<Vec<f64>> {
        let numbers = Numbers::new(text.as_bytes());
        let mut values = Vec::new();
        numbers.append_to(&mut values)?;
        Ok(values)
    }

    #[test]
    fn separators_may_be_mixed() {
        assert_eq!(all(" 1, 2\t3\r\n-4.5 ,\n 6e-3,").unwrap(), [1.0, 2.0, 3.0, -4.5, 6e-3]);
        assert_eq!(all("").unwrap(), Vec::<f64>::new());
    }

    #[test]
    fn digits_agree_with_the_standard_parser() {
        for k in 0..4000_u64 {
            let x = crate::sequence::uniform(1, k) * 10_f64.powi((k % 30) as i32 - 15);
            for text in [
                format!("{x:.6}"),
                format!("{x:e}"),
                format!("{x:.6e}"),
                format!("{x:.3E}"),
                format!("{x:.15}"),
                format!("{x:.9}"),
                format!("{x:.18e}"),
                format!("{x}"),
                format!("-{x:.5e}").replace('e', "e+0").replace("+0-", "-0"),
            ] {
                let value: f64 = text.parse().unwrap();
                assert_eq!(all(&text).unwrap(), [value], "{text}");
                // With more text behind it another way is taken.
                for behind in [" ", "\n\t", ", ", "}"] {
                    let text = format!("{text}{behind}0.25 1.5e-01 123456789012345678 ");
                    let expected = [value, 0.25, 0.15, 123_456_789_012_345_678.0];
                    if behind != "}" {
                        assert_eq!(all(&text).unwrap(), expected, "{text}");
                    }
                    let mut numbers = Numbers::new(text.as_bytes());
                    let first = numbers.peek().unwrap();
                    assert_eq!(numbers.number(first).unwrap(), value, "{text}");
                    assert_eq!(&text[numbers.position()..][..behind.len()], behind);
                }
            }
        }
    }

    #[test]
    fn odd_writings_are_read_with_and_without_text_behind() {
        for (text, value) in [
            ("+1.5", 1.5),
            (".5", 0.5),
            ("5.", 5.0),
            ("1.e5", 1e5),
            ("1.25E-3", 1.25e-3),
            ("1.25e3", 1250.0),
            ("1.25e+003", 1250.0),
            ("-0.0", 0.0),
            ("0.00000000000000000000000001", 1e-26),
            ("9007199254740993", 9_007_199_254_740_992.0),
            ("9007199254740993.5", 9_007_199_254_740_994.0),
            ("1.7976931348623157e308", f64::MAX),
            ("4.9406564584124654e-324", 5e-324),
        ] {
            assert_eq!(all(text).unwrap(), [value], "{text}");
            let long = format!("\n        {text}\n                 {text},{text}                 ");
            assert_eq!(all(&long).unwrap(), [value; 3], "{text}");
        }
        assert!(all("-0.000").unwrap()[0].is_sign_negative());
        assert!(all("-0.000              ").unwrap()[0].is_sign_negative());
    }

    #[test]
    fn lists_that_change_their_pattern_are_read_as_one_number_after_the_other() {
        let writings = [
            |x: f64| format!("{x:.6}, "),
            |x: f64| format!("{x:.3e}\n\t").replace("e0", "e+00").replace("e-", "e-0"),
            |x: f64| format!("{x:.1} "),
            |x: f64| format!("{x:.7},"),
            |x: f64| format!("{:.4}  ,  ", 20.0 * x),
            |x: f64| format!("{x:.12}\r\n"),
        ];
        let (mut text, mut expected) = (String::new(), Vec::new());
        for k in 0..5000_u64 {
            let x = crate::sequence::uniform(2, k) * 9.0;
            // Runs of one writing, with a stranger now and then.
            let writing = if k % 23 == 7 { k } else { k / 60 } as usize % writings.len();
            let word = writings[writing](x);
            let number = word.trim_matches(|c: char| c == ',' || c.is_ascii_whitespace());
            expected.push(number.parse::<f64>().unwrap());
            text.push_str(&word);
        }
        assert_eq!(all(&text).unwrap(), expected);
        // The place of what is wrong does not depend on what stands before it.
        for wrong in [",0.5", "0.x", "0.5000000x"] {
            let text = format!("{}{wrong}{}", "0.250000, ".repeat(40), "0.250000, ".repeat(40));
            let error = all(&text).unwrap_err().to_string();
            assert!(error.starts_with("400:"), "{error}");
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
            "1.5x",
            "1.5e-0x",
            "1.5e-01x",
            "1.5\u{0}",
            "1 \u{0} 2",
        ] {
            assert!(all(text).is_err(), "{text:?}");
            assert!(all(&format!("{text} 0.125 0.125 0.125")).is_err(), "{text:?}");
        }
    }
}
