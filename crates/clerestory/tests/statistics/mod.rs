//! What tests by chance share.

use std::f64::consts::PI;

use clerestory::material::Draws;

/// Numbers without the lattice of the first dimensions: the test asks for draws that know nothing of each other.
pub fn random(key: u64, index: u32) -> Draws {
    let mut draws = Draws::new(key, index);
    for _ in 0..64 {
        draws.next();
    }
    draws
}

/// Chance that chi-squared with `degrees` of freedom is as large, by Wilson and Hilferty's (1931) approximation.
pub fn chance(chi2: f64, degrees: f64) -> f64 {
    let spread = 2.0 / (9.0 * degrees);
    let z = ((chi2 / degrees).cbrt() - (1.0 - spread)) / spread.sqrt();
    0.5 * erfc(z / std::f64::consts::SQRT_2)
}

/// Complementary error function, by its series and its continued fraction (Abramowitz and Stegun 7.1.5, 7.1.14).
fn erfc(x: f64) -> f64 {
    if x < 0.0 {
        return 2.0 - erfc(-x);
    }
    if x < 2.0 {
        let mut term = x;
        let mut sum = x;
        for n in 1..60 {
            term *= -x * x / f64::from(n);
            sum += term / f64::from(2 * n + 1);
        }
        return 1.0 - 2.0 / PI.sqrt() * sum;
    }
    let mut tail = 0.0;
    for k in (1..60).rev() {
        tail = 0.5 * f64::from(k) / (x + tail);
    }
    (-x * x).exp() / (PI.sqrt() * (x + tail))
}
