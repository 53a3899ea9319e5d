//! What was finished of a measurement, so that it can be interrupted and go on.

use crate::bsdf::parts::Array;
use crate::error::{Error, Result};

/// What one unit of work gave: light from one side and one incident patch, direction or chunk of cells.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Unit {
    /// Rounds that are taken in.
    pub rounds: u32,
    /// Paths that are taken in.
    pub paths: u64,
    /// Nothing is left to do.
    pub finished: bool,
    /// Estimates, laid out as the unit's owner likes.
    pub values: Vec<f64>,
    /// The same for 32-bit entries.
    pub entries: Vec<u32>,
    /// Seven tallies a band.
    pub balance: Vec<f64>,
}

/// The units of a measurement as far as they are finished. A measurement that is interrupted leaves them here; given to the
/// same measurement again it goes on, with the same result as if it had never stopped.
#[derive(Debug, Clone, PartialEq)]
pub struct State {
    fingerprint: String,
    units: Vec<Option<Unit>>,
}

const NUMBERS: usize = 7;

impl State {
    /// Nothing is done yet. The fingerprint stands for all that the result depends on: sample, settings and version.
    pub fn new(fingerprint: impl Into<String>) -> Self {
        Self {
            fingerprint: fingerprint.into(),
            units: Vec::new(),
        }
    }

    /// What the result depends on.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Finished units, and all units; (0, 0) before the measurement began.
    pub fn done(&self) -> (usize, usize) {
        let finished = self.units.iter().flatten().filter(|u| u.finished).count();
        (finished, self.units.len())
    }

    /// As arrays that can be kept in a file.
    pub fn to_arrays(&self) -> Vec<(String, Array)> {
        let mut numbers = vec![self.units.len() as f64];
        let (mut values, mut entries, mut balance) = (Vec::new(), Vec::new(), Vec::new());
        for (k, unit) in self.units.iter().enumerate() {
            let Some(unit) = unit else { continue };
            numbers.extend([
                k as f64,
                f64::from(unit.rounds),
                unit.paths as f64,
                f64::from(u8::from(unit.finished)),
                unit.values.len() as f64,
                unit.entries.len() as f64,
                unit.balance.len() as f64,
            ]);
            values.extend_from_slice(&unit.values);
            entries.extend_from_slice(&unit.entries);
            balance.extend_from_slice(&unit.balance);
        }
        vec![
            ("units".into(), Array::Floats(numbers)),
            ("values".into(), Array::Floats(values)),
            ("entries".into(), Array::Entries(entries)),
            ("balance".into(), Array::Floats(balance)),
        ]
    }

    /// From arrays of [`State::to_arrays`], which were kept under the fingerprint `kept`. Refused where that is another one
    /// than that of the measurement to go on with.
    pub fn from_arrays(fingerprint: &str, kept: &str, arrays: &[(String, Array)]) -> Result<Self> {
        if fingerprint != kept {
            return Err(Error::Argument(
                "the state that was kept is of another recipe, of other settings or of another version (measure from the \
                 start, without resuming)"
                    .into(),
            ));
        }
        let broken = || Error::Argument("the state that was kept is damaged (measure from the start)".into());
        let find = |name: &str| {
            arrays
                .iter()
                .find(|(n, _)| n == name)
                .map(|(_, a)| a)
                .ok_or_else(broken)
        };
        let floats = |name: &str| match find(name)? {
            Array::Floats(v) => Ok(v.as_slice()),
            Array::Entries(_) => Err(broken()),
        };
        let (numbers, mut values, mut balance) = (floats("units")?, floats("values")?, floats("balance")?);
        let Array::Entries(entries) = find("entries")? else {
            return Err(broken());
        };
        let mut entries = entries.as_slice();
        let (&count, numbers) = numbers.split_first().ok_or_else(broken)?;
        let whole = |x: f64, most: f64| (x.fract() == 0.0 && (0.0..=most).contains(&x)).then_some(x as usize);
        let mut units = vec![None; whole(count, 1e9).ok_or_else(broken)?];
        if !numbers.len().is_multiple_of(NUMBERS) {
            return Err(broken());
        }
        for unit in numbers.chunks_exact(NUMBERS) {
            let whole = |k: usize| whole(unit[k], 1e15).ok_or_else(broken);
            let place = units.get_mut(whole(0)?).ok_or_else(broken)?;
            *place = Some(Unit {
                rounds: whole(1)? as u32,
                paths: whole(2)? as u64,
                finished: whole(3)? == 1,
                values: values.split_off(..whole(4)?).ok_or_else(broken)?.to_vec(),
                entries: entries.split_off(..whole(5)?).ok_or_else(broken)?.to_vec(),
                balance: balance.split_off(..whole(6)?).ok_or_else(broken)?.to_vec(),
            });
        }
        Ok(Self {
            fingerprint: fingerprint.into(),
            units,
        })
    }

    /// Takes the units out for a measurement of so many; refused where they are those of another one.
    pub(super) fn take(&mut self, count: usize, values: Option<usize>, balance: usize) -> Result<Vec<Option<Unit>>> {
        let fits = |unit: &Unit| values.is_none_or(|n| unit.values.len() == n) && unit.balance.len() == balance;
        if self.units.is_empty() {
            return Ok(vec![None; count]);
        }
        if self.units.len() != count || !self.units.iter().flatten().all(fits) {
            return Err(Error::Argument(
                "the state is that of another measurement (measure from the start)".into(),
            ));
        }
        Ok(std::mem::take(&mut self.units))
    }

    /// Puts them back.
    pub(super) fn put(&mut self, units: Vec<Option<Unit>>) {
        self.units = units;
    }

    /// All units, which are finished.
    pub(super) fn units(&self) -> impl Iterator<Item = &Unit> {
        self.units.iter().flatten()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state() -> State {
        let unit = |k: u32| Unit {
            rounds: k,
            paths: 100 * u64::from(k),
            finished: k == 2,
            values: vec![f64::from(k); 3],
            entries: vec![k; 2],
            balance: vec![0.5; 7],
        };
        State {
            fingerprint: "a blind".into(),
            units: vec![Some(unit(1)), None, Some(unit(2)), None],
        }
    }

    #[test]
    fn arrays_keep_it() {
        let state = state();
        assert_eq!(state.done(), (1, 4));
        let again = State::from_arrays("a blind", state.fingerprint(), &state.to_arrays()).unwrap();
        assert_eq!(again, state);
        let empty = State::new("x");
        assert_eq!(State::from_arrays("x", "x", &empty.to_arrays()).unwrap(), empty);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let arrays = state().to_arrays();
        let of = |arrays: &[(String, Array)]| State::from_arrays("a blind", "a blind", arrays);
        let other = State::from_arrays("another", "a blind", &arrays).unwrap_err();
        assert!(other.to_string().contains("another recipe"));
        for missing in 0..4 {
            let mut fewer = arrays.clone();
            fewer.remove(missing);
            assert!(of(&fewer).is_err());
        }
        let mut short = arrays.clone();
        short[1].1 = Array::Floats(vec![1.0]);
        assert!(of(&short).is_err());
        let mut state = of(&arrays).unwrap();
        assert!(state.take(5, None, 7).is_err() && state.take(4, Some(2), 7).is_err());
        assert_eq!(state.take(4, Some(3), 7).unwrap().len(), 4);
    }
}
