//! Scanlines of Radiance's pictures: flat, and the old and the new run-length codes.

use crate::error::{Error, Result};

/// Shortest and longest scanline that the new code is written for.
const CODED: std::ops::RangeInclusive<usize> = 8..=32767;
/// Shortest run that is worth a code.
const RUN: usize = 4;

fn fail(what: &str) -> Error {
    Error::format("the pixels", what, "check that the picture is whole")
}

/// Bytes that are still to be read.
pub(super) struct Input<'a>(pub &'a [u8]);

impl<'a> Input<'a> {
    fn take(&mut self, count: usize) -> Result<&'a [u8]> {
        if self.0.len() < count {
            return Err(fail("the file ends before its last pixel"));
        }
        let (taken, rest) = self.0.split_at(count);
        self.0 = rest;
        Ok(taken)
    }

    /// Reads the next scanline, whatever its code, into as many pixels as the target has.
    pub fn scanline(&mut self, target: &mut [[u8; 4]]) -> Result<()> {
        let length = target.len();
        if let [2, 2, high, low, ..] = *self.0
            && high < 128
            && CODED.contains(&length)
        {
            if usize::from(high) << 8 | usize::from(low) != length {
                return Err(fail("a scanline says another length than the resolution"));
            }
            self.take(4)?;
            return self.channels(target);
        }
        self.old(target)
    }

    /// The new code: the four channels one after another.
    fn channels(&mut self, target: &mut [[u8; 4]]) -> Result<()> {
        for channel in 0..4 {
            let mut at = 0;
            while at < target.len() {
                let code = usize::from(self.take(1)?[0]);
                let count = if code > 128 { code - 128 } else { code };
                if count == 0 || at + count > target.len() {
                    return Err(fail("a run goes beyond the end of its scanline"));
                }
                let pixels = &mut target[at..at + count];
                if code > 128 {
                    let value = self.take(1)?[0];
                    for p in pixels {
                        p[channel] = value;
                    }
                } else {
                    for (p, value) in pixels.iter_mut().zip(self.take(count)?) {
                        p[channel] = *value;
                    }
                }
                at += count;
            }
        }
        Ok(())
    }

    /// Flat pixels, among which 1, 1, 1, n repeats the one before.
    fn old(&mut self, target: &mut [[u8; 4]]) -> Result<()> {
        let mut at = 0;
        let mut shift = 0_u32;
        while at < target.len() {
            let [r, g, b, e] = self
                .take(4)?
                .try_into()
                .map_err(|_| fail("the file ends before its last pixel"))?;
            if [r, g, b] == [1, 1, 1] {
                let count = usize::from(e)
                    .checked_shl(shift)
                    .filter(|n| *n <= target.len() - at && shift <= 24)
                    .ok_or_else(|| fail("a run goes beyond the end of its scanline"))?;
                let before = at
                    .checked_sub(1)
                    .map(|k| target[k])
                    .ok_or_else(|| fail("a scanline begins with a repetition"))?;
                target[at..at + count].fill(before);
                at += count;
                shift += 8;
            } else {
                target[at] = [r, g, b, e];
                at += 1;
                shift = 0;
            }
        }
        Ok(())
    }
}

/// Appends a scanline in the new code, or flat where that is not possible.
pub(super) fn write(pixels: &[[u8; 4]], out: &mut Vec<u8>) {
    let length = pixels.len();
    if !CODED.contains(&length) {
        out.extend_from_slice(pixels.as_flattened());
        return;
    }
    out.extend_from_slice(&[2, 2, (length >> 8) as u8, length as u8]);
    let mut row = vec![0; length];
    for channel in 0..4 {
        for (value, pixel) in row.iter_mut().zip(pixels) {
            *value = pixel[channel];
        }
        let value = |k: usize| row[k];
        let run = |from: usize| {
            (from..length.min(from + 127))
                .take_while(|&k| value(k) == value(from))
                .count()
        };
        let mut at = 0;
        while at < length {
            let count = run(at);
            if count >= RUN {
                out.extend_from_slice(&[128 + count as u8, value(at)]);
                at += count;
                continue;
            }
            let mut end = at + 1;
            while end < length.min(at + 128) && run(end) < RUN {
                end += 1;
            }
            out.push((end - at) as u8);
            out.extend((at..end).map(value));
            at = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn scanlines_come_back(
            runs in prop::collection::vec((any::<[u8; 2]>(), 1_usize..300), 1..20)
        ) {
            let pixels: Vec<[u8; 4]> = runs
                .iter()
                .flat_map(|&([a, b], n)| (0..n).map(move |k| [a, b, if k % 7 < 3 { a } else { k as u8 }, 128]))
                .collect();
            let mut bytes = Vec::new();
            write(&pixels, &mut bytes);
            let mut back = vec![[0; 4]; pixels.len()];
            let mut input = Input(&bytes);
            input.scanline(&mut back).unwrap();
            prop_assert!(input.0.is_empty() && back == pixels);
        }

        #[test]
        fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200), length in 1_usize..300) {
            let mut target = vec![[0; 4]; length];
            let mut input = Input(&bytes);
            while input.scanline(&mut target).is_ok() && !input.0.is_empty() {}
        }
    }

    #[test]
    fn old_runs_count_in_powers_of_256() {
        let mut bytes = vec![9, 8, 7, 130, 1, 1, 1, 2, 1, 1, 1, 1];
        let mut target = [[0; 4]; 1 + 2 + 256];
        Input(&bytes).scanline(&mut target).unwrap();
        assert!(target.iter().all(|p| *p == [9, 8, 7, 130]));
        bytes[7] = 3;
        let text = Input(&bytes).scanline(&mut target).unwrap_err().to_string();
        assert!(text.contains("beyond the end"), "{text}");
    }
}
