//! Low-discrepancy points and counter-based random numbers: every value is a function of its index and a seed, so
//! results do not depend on the number of threads.

/// Point `k` of the additive recurrence in two dimensions (Roberts 2018, "R2"), shifted by a seed-dependent offset.
pub fn r2(k: u32, shift: [f64; 2]) -> [f64; 2] {
    // 1/g and 1/g² with g the real root of g³ = g + 1.
    const ALPHA: [f64; 2] = [0.754_877_666_246_692_8, 0.569_840_290_998_053_3];
    std::array::from_fn(|d| (shift[d] + f64::from(k + 1) * ALPHA[d]).fract())
}

/// Point `k` of the four-dimensional additive recurrence.
pub fn r4(k: u32, shift: [f64; 4]) -> [f64; 4] {
    // Powers of 1/g with g the real root of g⁵ = g + 1.
    const ALPHA: [f64; 4] = [
        0.856_674_883_854_502_9,
        0.733_891_856_627_126,
        0.628_706_721_037_808_1,
        0.538_597_258_223_613_2,
    ];
    std::array::from_fn(|d| (shift[d] + f64::from(k + 1) * ALPHA[d]).fract())
}

/// Well-mixed 64 bits from a counter (SplitMix64; Steele, Lea, Flood 2014).
pub fn mix(counter: u64) -> u64 {
    let mut z = counter.wrapping_add(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// Number in [0, 1) number `index` of the stream `seed`.
pub fn uniform(seed: u64, index: u64) -> f64 {
    (mix(mix(seed) ^ index) >> 11) as f64 / (1_u64 << 53) as f64
}

/// One over the factorials of the odd numbers, with their signs.
const SIN: [f64; 8] = [
    1.0,
    -1.0 / 6.0,
    1.0 / 120.0,
    -1.0 / 5_040.0,
    1.0 / 362_880.0,
    -1.0 / 39_916_800.0,
    1.0 / 6_227_020_800.0,
    -1.0 / 1_307_674_368_000.0,
];
/// One over the factorials of the even numbers, with their signs.
const COS: [f64; 8] = [
    1.0,
    -1.0 / 2.0,
    1.0 / 24.0,
    -1.0 / 720.0,
    1.0 / 40_320.0,
    -1.0 / 3_628_800.0,
    1.0 / 479_001_600.0,
    -1.0 / 87_178_291_200.0,
];

/// Cosine and sine of `turns` of a full turn, from -1/2 to 1 of it; to 1e-15, the same on every machine, and
/// quicker than the general functions. Series about the nearest quarter turn.
#[inline]
pub fn circle(turns: f64) -> [f64; 2] {
    let quarters = 4.0 * turns + 3.5;
    let whole = quarters as u32;
    let x = (quarters - f64::from(whole) - 0.5) * std::f64::consts::FRAC_PI_2;
    let s = x * x;
    let (s2, s4) = (s * s, s * s * (s * s));
    // In pairs, so that the processor need not wait for one term after the other.
    let series = |t: [f64; 8]| {
        let pairs = [t[0] + t[1] * s, t[2] + t[3] * s, t[4] + t[5] * s, t[6] + t[7] * s];
        (pairs[0] + pairs[1] * s2) + (pairs[2] + pairs[3] * s2) * s4
    };
    let sin = x * series(SIN);
    let cos = series(COS);
    let [a, b] = if whole & 1 == 0 { [sin, cos] } else { [cos, sin] };
    // The quarter about azimuth 0 is number 3.
    let cos_sign = [-1.0, -1.0, 1.0, 1.0][(whole & 3) as usize];
    let sin_sign = [1.0, -1.0, -1.0, 1.0][(whole & 3) as usize];
    [cos_sign * a, sin_sign * b]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn r2_fills_the_square_evenly() {
        let mut counts = [0; 64];
        for k in 0..6400 {
            let p = r2(k, [0.0; 2]);
            counts[(p[0] * 8.0) as usize * 8 + (p[1] * 8.0) as usize] += 1;
        }
        assert!(counts.iter().all(|&n| (90..=110).contains(&n)), "{counts:?}");
    }

    #[test]
    fn uniform_numbers_have_the_mean_and_variance_of_the_unit_interval() {
        let n = 100_000;
        let values: Vec<f64> = (0..n).map(|i| uniform(7, i)).collect();
        let mean = values.iter().sum::<f64>() / n as f64;
        let var = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / n as f64;
        assert!((mean - 0.5).abs() < 5e-3 && (var - 1.0 / 12.0).abs() < 1e-3);
    }

    #[test]
    fn circles_are_round() {
        for k in -2000..=4000 {
            let turns = f64::from(k) / 4000.0;
            let [cos, sin] = circle(turns);
            let (s, c) = (std::f64::consts::TAU * turns).sin_cos();
            assert!(
                (cos - c).abs() < 2e-15 && (sin - s).abs() < 2e-15,
                "{turns} {cos} {sin}"
            );
        }
    }
}
