//! The random numbers of one path.

use std::sync::LazyLock;

use crate::sequence::mix;

/// Numbers in [0, 1), one after the other. The first dimensions are a Sobol sequence under a random digital shift, so that
/// the paths of a replication cover the space of paths evenly; the later ones are counter-based random numbers.
#[derive(Debug, Clone, Copy)]
pub struct Draws {
    /// The point of the sequence, as the two points whose digits add up to it.
    low: &'static Point,
    high: &'static Point,
    dimension: u32,
    index: u32,
    key: u64,
}

/// So many dimensions of the sequence.
const DIMENSIONS: usize = 15;
/// A point in units of 2^-32.
type Point = [u32; DIMENSIONS];
/// Points whose index has only the low, or only the high of its bits.
const HALF: u32 = 12;

/// Degree, coefficients and first direction numbers of each dimension after the first, which is van der Corput's sequence
/// (Joe, Kuo 2008, SIAM J. Sci. Comput. 30, "new-joe-kuo-6").
const POLYNOMIALS: [(usize, u32, [u32; 6]); DIMENSIONS - 1] = [
    (1, 0, [1, 0, 0, 0, 0, 0]),
    (2, 1, [1, 3, 0, 0, 0, 0]),
    (3, 1, [1, 3, 1, 0, 0, 0]),
    (3, 2, [1, 1, 1, 0, 0, 0]),
    (4, 1, [1, 1, 3, 3, 0, 0]),
    (4, 4, [1, 3, 5, 13, 0, 0]),
    (5, 2, [1, 1, 5, 5, 17, 0]),
    (5, 4, [1, 1, 5, 5, 5, 0]),
    (5, 7, [1, 1, 7, 11, 19, 0]),
    (5, 11, [1, 1, 5, 1, 1, 0]),
    (5, 13, [1, 1, 1, 3, 11, 0]),
    (5, 14, [1, 3, 5, 5, 31, 0]),
    (6, 1, [1, 3, 3, 9, 7, 49]),
    (6, 13, [1, 1, 1, 15, 21, 21]),
];

/// Points of all indices below 2^HALF, and of these times 2^HALF.
static TABLES: LazyLock<[Box<[Point]>; 2]> = LazyLock::new(|| {
    let directions = directions();
    [0, HALF].map(|from| {
        (0..1_u32 << HALF)
            .map(|index| {
                (0..HALF)
                    .filter(|bit| index >> bit & 1 == 1)
                    .fold([0; DIMENSIONS], |point, bit| {
                        std::array::from_fn(|d| point[d] ^ directions[(from + bit) as usize][d])
                    })
            })
            .collect()
    })
});

/// Direction numbers: the points of the powers of two.
fn directions() -> [Point; 32] {
    let mut directions = [[0; DIMENSIONS]; 32];
    for (k, point) in directions.iter_mut().enumerate() {
        point[0] = 1 << (31 - k);
    }
    for (d, &(degree, coefficients, first)) in POLYNOMIALS.iter().enumerate() {
        for k in 0..32 {
            directions[k][d + 1] = if k < degree {
                first[k] << (31 - k)
            } else {
                let before = |back: usize| directions[k - back][d + 1];
                (1..degree)
                    .filter(|back| coefficients >> (degree - 1 - back) & 1 == 1)
                    .fold(before(degree) ^ before(degree) >> degree, |v, back| v ^ before(back))
            };
        }
    }
    directions
}

impl Draws {
    /// Of path `index`, below 2^24, in the replication that `key` stands for.
    pub fn new(key: u64, index: u32) -> Self {
        let [low, high] = &*TABLES;
        let mask = (1 << HALF) - 1;
        Self {
            low: &low[(index & mask) as usize],
            high: &high[(index >> HALF & mask) as usize],
            dimension: 0,
            index,
            key,
        }
    }

    /// The next number.
    #[inline]
    #[allow(clippy::should_implement_trait)] // It never ends.
    pub fn next(&mut self) -> f64 {
        let d = self.dimension as usize;
        self.dimension += 1;
        let shift = mix(self.key ^ d as u64);
        let bits = if d < DIMENSIONS {
            shift ^ u64::from(self.low[d] ^ self.high[d]) << 32
        } else {
            mix(shift ^ u64::from(self.index))
        };
        (bits >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
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

    /// Mean square error of the volume of a box, over that of random points.
    fn against_random(dimensions: &[usize], points: u32) -> f64 {
        let (edge, shifts) = (0.63_f64, 64);
        let exact = edge.powi(dimensions.len() as i32);
        let squares: f64 = (0..shifts)
            .map(|key| {
                let inside = (0..points).filter(|&k| {
                    let mut draws = Draws::new(mix(key), k);
                    let u: [f64; DIMENSIONS] = std::array::from_fn(|_| draws.next());
                    dimensions.iter().all(|&d| u[d] < edge)
                });
                (inside.count() as f64 / f64::from(points) - exact).powi(2)
            })
            .sum();
        squares / shifts as f64 / (exact * (1.0 - exact) / f64::from(points))
    }

    #[test]
    fn no_few_dimensions_are_worse_than_random() {
        for points in [256, 1024] {
            for (a, b) in (0..DIMENSIONS).flat_map(|a| (0..a).map(move |b| (a, b))) {
                assert!(against_random(&[a, b], points) < 0.7, "{a} {b}");
            }
            // Where a path starts, and its first events.
            for d in 0..DIMENSIONS - 3 {
                assert!(against_random(&[d, d + 1, d + 2], points) < 0.7, "triple {d}");
                assert!(against_random(&[d, d + 1, d + 2, d + 3], points) < 0.9, "quadruple {d}");
            }
        }
        assert!(against_random(&[0, 1, 2], 4096) < 0.05);
        assert!(against_random(&[0, 1, 2, 3], 4096) < 0.1);
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
