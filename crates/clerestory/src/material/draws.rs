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

/// Generating vector of an extensible lattice in base 2 for 2^8 to 2^20 points. Found component by component: each is the one
/// of 800 odd numbers for which, over 2^8, 2^10 … 2^16 points, the worst projection on it and one or two earlier ones is
/// best. A scattering event takes three numbers, so triples matter: the vector that is made for pairs alone, "exod2_base2_m20"
/// of Cools, Kuo and Nuyens (2006, SIAM J. Sci. Comput. 28), has up to a hundred times the variance of random points there,
/// and no lattice of much more dimensions is free of such triples.
const LATTICE: [u32; 10] = [
    1, 3_915, 284_275, 308_169, 23_317, 231_045, 492_219, 325_315, 462_815, 658_219,
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
        for (a, b) in [(0, 1), (2, 3), (4, 9), (6, 8)] {
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
    fn triples_of_dimensions_fill_the_cube_evenly() {
        let points: Vec<[f64; 10]> = (0..4096)
            .map(|k| {
                let mut draws = Draws::new(7, k);
                std::array::from_fn(|_| draws.next())
            })
            .collect();
        for (a, b, c) in (0..10).flat_map(|a| (0..a).flat_map(move |b| (0..b).map(move |c| (a, b, c)))) {
            let mut counts = [0_u32; 64];
            for p in &points {
                let [i, j, k] = [a, b, c].map(|d| (p[d] * 4.0) as usize);
                counts[(i * 4 + j) * 4 + k] += 1;
            }
            let chi2: f64 = counts.iter().map(|n| (f64::from(*n) - 64.0).powi(2) / 64.0).sum();
            // Random points have 63 ± 11. The first seven are where a path starts and its first event.
            let most = if a < 7 { 45.0 } else { 110.0 };
            assert!(chi2 < most, "{a} {b} {c}: {chi2}");
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
