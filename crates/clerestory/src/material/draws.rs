//! The random numbers of one path.

use crate::sequence::mix;

/// Numbers in [0, 1), one after the other. The first dimensions are of a randomly shifted lattice, so that the paths of a
/// replication cover the space of paths evenly; the later ones are counter-based random numbers.
#[derive(Debug, Clone, Copy)]
pub struct Draws {
    /// The path's index with its bits reversed: the radical inverse in units of 2^-32.
    inverse: u32,
    dimension: u32,
    key: u64,
}

/// Generating vector of an extensible lattice in base 2, by component-by-component construction: "exew_base2_m20_a3_HKKN"
/// of Kuo, good for 2^10 to 2^20 points (Cools, Kuo, Nuyens 2006, SIAM J. Sci. Comput. 28).
const LATTICE: [u32; 24] = [
    1, 182_667, 469_891, 498_753, 110_745, 446_247, 250_185, 118_627, 245_333, 283_199, 408_519, 391_023, 246_327,
    126_539, 399_185, 461_527, 300_343, 69_681, 516_695, 436_179, 106_383, 238_523, 413_283, 70_841,
];

impl Draws {
    /// Of path `index` in the replication that `key` stands for.
    pub fn new(key: u64, index: u32) -> Self {
        Self {
            inverse: index.reverse_bits(),
            dimension: 0,
            key,
        }
    }

    /// The next number.
    #[inline]
    #[allow(clippy::should_implement_trait)] // It never ends.
    pub fn next(&mut self) -> f64 {
        let d = self.dimension;
        self.dimension += 1;
        let shift = mix(self.key ^ u64::from(d));
        match LATTICE.get(d as usize) {
            Some(&z) => {
                let lattice = u64::from(self.inverse.wrapping_mul(z)) << 32;
                (lattice.wrapping_add(shift) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
            }
            None => (mix(shift ^ u64::from(self.inverse)) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pairs_of_dimensions_fill_the_square_evenly() {
        for (a, b) in [(0, 1), (2, 3), (4, 9), (11, 21)] {
            let mut counts = [0; 64];
            for k in 0..4096 {
                let mut draws = Draws::new(3, k);
                let u: Vec<f64> = (0..24).map(|_| draws.next()).collect();
                counts[(u[a] * 8.0) as usize * 8 + (u[b] * 8.0) as usize] += 1;
            }
            assert!(counts.iter().all(|&n| (54..=74).contains(&n)), "{a} {b}: {counts:?}");
        }
    }

    #[test]
    fn late_dimensions_are_random() {
        let n = 100_000;
        let values: Vec<f64> = (0..n)
            .map(|k| {
                let mut draws = Draws::new(5, k);
                (0..30).map(|_| draws.next()).last().expect("there are some")
            })
            .collect();
        let mean = values.iter().sum::<f64>() / f64::from(n);
        assert!((mean - 0.5).abs() < 4e-3, "{mean}");
    }
}
