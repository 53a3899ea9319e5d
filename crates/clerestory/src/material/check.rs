//! Values that no material can have are refused, with their name and band.

use crate::error::{Error, Result};

/// A spectral parameter and its name.
pub(super) type Named<'a> = (&'a str, &'a [f64]);

/// Rounding may put a sum this far above 1.
const SLACK: f64 = 1e-9;

fn fail(kind: &str, what: &str, remedy: &str) -> Error {
    Error::Argument(format!("{kind}: {what} ({remedy})"))
}

/// All parameters have one value a band; returns how many bands there are.
pub(super) fn bands(kind: &str, parameters: &[Named<'_>]) -> Result<usize> {
    let (first, values) = parameters[0];
    if values.is_empty() {
        return Err(fail(kind, &format!("{first} has no values"), "give one a band"));
    }
    match parameters.iter().find(|(_, v)| v.len() != values.len()) {
        Some((name, v)) => Err(fail(
            kind,
            &format!("{first} has {} bands and {name} has {}", values.len(), v.len()),
            "give one value a band",
        )),
        None => Ok(values.len()),
    }
}

/// A number of a range that includes its limits.
pub(super) fn number(kind: &str, name: &str, value: f64, low: f64, high: f64) -> Result<f64> {
    if value >= low && value <= high && value.is_finite() {
        return Ok(value);
    }
    let range = if high.is_finite() {
        format!("give a number from {low} to {high}")
    } else {
        format!("give a number of {low} or more")
    };
    Err(fail(kind, &format!("{name} is {value}"), &range))
}

/// A number above 0.
pub(super) fn positive(kind: &str, name: &str, value: f64) -> Result<f64> {
    if value > 0.0 && value.is_finite() {
        Ok(value)
    } else {
        Err(fail(kind, &format!("{name} is {value}"), "give a number above 0"))
    }
}

/// All values of a parameter lie in a range.
pub(super) fn within(kind: &str, (name, values): Named<'_>, low: f64, high: f64) -> Result<()> {
    for (b, value) in values.iter().enumerate() {
        number(kind, &format!("{name} of band {}", b + 1), *value, low, high)?;
    }
    Ok(())
}

/// Shares of light: from 0 to 1 each, and together not above 1 in any band. Returns the number of bands.
pub(super) fn shares(kind: &str, parameters: &[Named<'_>]) -> Result<usize> {
    let n = bands(kind, parameters)?;
    for parameter in parameters {
        within(kind, *parameter, 0.0, 1.0)?;
    }
    for b in 0..n {
        let sum: f64 = parameters.iter().map(|(_, v)| v[b]).sum();
        if sum > 1.0 + SLACK {
            let names: Vec<&str> = parameters.iter().map(|(name, _)| *name).collect();
            let what = format!("{} of band {} sum to {sum}", names.join(" + "), b + 1);
            return Err(fail(kind, &what, "at most 1 can go on"));
        }
    }
    Ok(n)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn faults_name_the_parameter_and_the_band() {
        let text = |r: Result<usize>| r.expect_err("is refused").to_string();
        assert_eq!(
            text(shares(
                "sheet",
                &[("reflectance", &[0.5, -0.1]), ("transmittance", &[0.1, 0.1])]
            )),
            "sheet: reflectance of band 2 is -0.1 (give a number from 0 to 1)"
        );
        assert_eq!(
            text(shares("sheet", &[("reflectance", &[0.5]), ("transmittance", &[0.625])])),
            "sheet: reflectance + transmittance of band 1 sum to 1.125 (at most 1 can go on)"
        );
        assert!(
            text(shares(
                "sheet",
                &[("reflectance", &[0.5, 0.5]), ("transmittance", &[0.1])]
            ))
            .contains("has 2 bands and transmittance has 1")
        );
        assert!(text(shares("sheet", &[("reflectance", &[f64::NAN])])).contains("NaN"));
        assert!(text(shares("sheet", &[("reflectance", &[])])).contains("no values"));
        assert!(positive("medium", "unit", 0.0).is_err() && number("x", "n", 0.5, 1.0, f64::INFINITY).is_err());
    }
}
