//! The position index: how much less a source glares the further it is from the line of sight.

/// Which position index.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PositionIndex {
    /// Guth (1963, as a formula by Levin 1975) above the line of sight, Iwata and Tokura (1997) below.
    GuthIwata,
    /// Kim and Kim (2010), everywhere.
    Kim,
}

/// Largest value.
const LARGEST: f64 = 16.0;

/// The index of a source at an angle σ from the line of sight, and at a turn τ about it away from straight up, given by its
/// cosine (radians).
pub fn position_index(kind: PositionIndex, sigma: f64, cosine_tau: f64) -> f64 {
    let degrees = sigma.to_degrees();
    let cosine = cosine_tau.clamp(-1.0, 1.0);
    let tau = cosine.acos().to_degrees();
    let index = match kind {
        PositionIndex::GuthIwata if cosine >= 0.0 => {
            let first = 35.2 - 0.31889 * tau - 1.22 * (-2.0 * tau / 9.0).exp();
            let second = 21.0 + 0.26667 * tau - 0.002_963 * tau * tau;
            (first * 1e-3 * degrees + second * 1e-5 * degrees * degrees).exp()
        }
        PositionIndex::GuthIwata => {
            let slant = sigma.min(std::f64::consts::FRAC_PI_2).tan() * (1.0 + 0.3225 * cosine * cosine).sqrt();
            let beta = slant.atan().to_degrees();
            (6.49e-3 * beta + 21e-5 * beta * beta).exp()
        }
        PositionIndex::Kim => {
            let cubic = |a: f64, b: f64, c: f64| -9e-6 * tau.powi(3) + a * tau * tau + b * tau + c;
            ((degrees - cubic(0.0014, 0.0866, 21.633)) / cubic(0.0013, 0.0853, 8.772)).exp()
        }
    };
    index.min(LARGEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_the_reference() {
        // Azimuth to the right and elevation (degrees), index.
        for (azimuth, elevation, expected) in [
            (0.0_f64, 20.0_f64, 2.145_988),
            (30.0, -15.0, 1.594_287),
            (-25.0, 10.0, 1.735_335),
            (40.0, 40.0, 7.704_357),
            (0.0, -30.0, 1.575_828),
            (60.0, 10.0, 4.401_492),
        ] {
            let (a, e) = (azimuth.to_radians(), elevation.to_radians());
            let (x, y, z) = (e.cos() * a.sin(), e.sin(), e.cos() * a.cos());
            let found = position_index(PositionIndex::GuthIwata, z.acos(), y / x.hypot(y));
            assert!((found - expected).abs() < 2e-6, "{azimuth} {elevation}: {found}");
        }
        assert_eq!(position_index(PositionIndex::GuthIwata, 1.4, 1.0), 16.0);
        assert!((position_index(PositionIndex::GuthIwata, 0.0, 1.0) - 1.0).abs() < 1e-12);
    }
}
