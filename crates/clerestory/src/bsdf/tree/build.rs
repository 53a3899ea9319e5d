//! Trees from functions and from arrays.

use rayon::prelude::*;

use super::assembler::Assembler;
use super::{MAX_DEPTH, Rank, Tree, encode};
use crate::direction::Disk;
use crate::error::{Error, Result};
use crate::progress::Progress;
use crate::sequence::{mix, r4};

/// How a function is sampled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Grid {
    /// 2^levels cells an axis.
    pub levels: u32,
    /// Low-discrepancy points a cell; one point is its middle.
    pub samples: u32,
    /// Shifts the points.
    pub seed: u64,
}

impl Tree {
    /// From a function of (incident, outgoing), averaged over the cells of a grid.
    ///
    /// For rank 3 the incident light travels toward +x, and the cells' incident points are spread by projected solid
    /// angle. Parts of equal values are merged at once, so a smooth function never fills the memory of a full grid.
    pub fn from_fn(
        rank: Rank,
        grid: Grid,
        f: &(dyn Fn(Disk, Disk) -> f64 + Sync),
        progress: &Progress,
    ) -> Result<Self> {
        if grid.samples == 0 {
            return Err(Error::Argument("a cell needs at least one sample".into()));
        }
        let points = Points::new(rank, grid);
        grow(rank, grid.levels, rank == Rank::Isotropic, progress, &|cell| {
            points.mean(cell, f)
        })
    }

    /// From an array of 2^levels values an axis, axis 0 slowest.
    ///
    /// For rank 3 the array holds either the used half of axis 0 (incident radius; the other half becomes zero) or all of
    /// it.
    pub fn from_grid(rank: Rank, levels: u32, values: &[f32]) -> Result<Self> {
        check_levels(levels)?;
        let full = 1_usize << (levels * rank.axes());
        let half = rank == Rank::Isotropic && levels > 0 && values.len() == full / 2;
        if values.len() != full && !half {
            return Err(Error::Argument(format!(
                "{} values do not fill a tensor tree of rank {} with {} cells an axis (give {full}{})",
                values.len(),
                rank.axes(),
                1_u64 << levels,
                if rank == Rank::Isotropic && levels > 0 {
                    format!(", or {} for the used half of axis 0", full / 2)
                } else {
                    String::new()
                }
            )));
        }
        grow(rank, levels, half, &Progress::default(), &|cell| {
            let index = cell[..rank.axes() as usize]
                .iter()
                .fold(0, |index, &c| index << levels | c as usize);
            encode(values[index])
        })
    }
}

fn check_levels(levels: u32) -> Result<()> {
    // 4 axes of 2^10 cells are a tree of 4 TB.
    const MOST: u32 = 10;
    if levels > MOST {
        return Err(Error::Argument(format!(
            "a resolution of 2^{levels} cells an axis is more than any memory holds (give at most 2^{MOST})"
        )));
    }
    Ok(())
}

/// Levels at whose nodes the work is divided.
const TASK_LEVEL: u32 = 2;
/// Level at whose nodes a person is told about progress.
const STEP_LEVEL: u32 = 3;

/// Grows a tree from the entries of its finest cells, all branches at the same time.
fn grow(
    rank: Rank,
    levels: u32,
    only_lower_half: bool,
    progress: &Progress,
    leaf: &(dyn Fn([u32; 4]) -> Result<u32> + Sync),
) -> Result<Tree> {
    check_levels(levels)?;
    let growth = Growth {
        rank,
        levels,
        only_lower_half,
        progress,
        leaf,
    };
    let split = TASK_LEVEL.min(levels);
    let steps = 1_usize << (rank.axes() * STEP_LEVEL.min(levels));
    progress.expect(if only_lower_half { steps / 2 } else { steps });
    let tasks = (0..1_usize << (rank.axes() * split)).into_par_iter();
    let parts: Vec<(Assembler, u32)> = tasks
        .map(|task| {
            // The path from the root, a child a group of bits, the first one highest.
            let mut cell = [0; 4];
            for level in (0..split).rev() {
                cell = growth.child(cell, task >> (rank.axes() * level));
            }
            let mut assembler = Assembler::new(rank);
            let entry = growth.node(split, cell, &mut assembler)?;
            Ok((assembler, entry))
        })
        .collect::<Result<_>>()?;
    let room = parts.iter().map(|(part, _)| part.len()).sum();
    let mut assembler = Assembler::with_room(rank, room);
    let mut entries: Vec<u32> = parts
        .into_iter()
        .map(|(part, entry)| assembler.append(part, entry))
        .collect();
    while entries.len() > 1 {
        entries = entries
            .chunks_exact(rank.children())
            .map(|children| assembler.join(children))
            .collect();
    }
    assembler.finish(entries[0])
}

struct Growth<'a> {
    rank: Rank,
    levels: u32,
    /// The upper half of axis 0 is zero.
    only_lower_half: bool,
    progress: &'a Progress,
    leaf: &'a (dyn Fn([u32; 4]) -> Result<u32> + Sync),
}

impl Growth<'_> {
    /// Cell of a child, one level finer.
    fn child(&self, cell: [u32; 4], child: usize) -> [u32; 4] {
        std::array::from_fn(|axis| {
            if axis < self.rank.axes() as usize {
                cell[axis] << 1 | (child >> axis) as u32 & 1
            } else {
                0
            }
        })
    }

    fn node(&self, level: u32, cell: [u32; 4], assembler: &mut Assembler) -> Result<u32> {
        if self.only_lower_half && level > 0 && cell[0] >> (level - 1) == 1 {
            return Ok(0);
        }
        let entry = if level == self.levels {
            (self.leaf)(cell)?
        } else {
            let mut children = [0; 16];
            let children = &mut children[..self.rank.children()];
            for (n, child) in children.iter_mut().enumerate() {
                *child = self.node(level + 1, self.child(cell, n), assembler)?;
            }
            assembler.join(children)
        };
        if level == STEP_LEVEL.min(self.levels) {
            self.progress.step()?;
        }
        Ok(entry)
    }
}

/// Points in the cells of a grid.
struct Points {
    rank: Rank,
    grid: Grid,
    edge: f64,
}

impl Points {
    fn new(rank: Rank, grid: Grid) -> Self {
        Self {
            rank,
            grid,
            edge: 0.5_f64.powi(grid.levels.min(MAX_DEPTH) as i32),
        }
    }

    /// Entry of a cell: the mean of a function at its points.
    fn mean(&self, cell: [u32; 4], f: &(dyn Fn(Disk, Disk) -> f64 + Sync)) -> Result<u32> {
        if self.grid.samples == 1 {
            return encode(self.value(cell, [0.5; 4], f)? as f32);
        }
        let key = cell.iter().fold(self.grid.seed, |key, &c| mix(key ^ u64::from(c)));
        let shift: [f64; 4] = std::array::from_fn(|d| crate::sequence::uniform(key, d as u64));
        let mut sum = 0.0;
        for k in 0..self.grid.samples {
            sum += self.value(cell, r4(k, shift), f)?;
        }
        encode((sum / f64::from(self.grid.samples)) as f32)
    }

    fn value(&self, cell: [u32; 4], inner: [f64; 4], f: &(dyn Fn(Disk, Disk) -> f64 + Sync)) -> Result<f64> {
        let at = |axis: usize, point: usize| (f64::from(cell[axis]) + inner[point]) * self.edge;
        let (incident, outgoing) = match self.rank {
            Rank::Anisotropic => (
                Disk::from_square([at(0, 0), at(1, 1)]),
                Disk::from_square([at(2, 2), at(3, 3)]),
            ),
            Rank::Isotropic => {
                let [outer, inside] = [cell[0], cell[0] + 1].map(|c| 1.0 - 2.0 * f64::from(c) * self.edge);
                let r = if self.grid.samples == 1 {
                    0.5 * (outer + inside)
                } else {
                    (outer * outer + (inside * inside - outer * outer) * inner[0]).sqrt()
                };
                (Disk::new(r, 0.0), Disk::from_square([at(1, 2), at(2, 3)]))
            }
        };
        let value = f(incident, outgoing);
        if value.is_finite() && value >= 0.0 {
            return Ok(value);
        }
        Err(Error::Argument(format!(
            "a BSDF of {value} at the disk points ({:.4}, {:.4}), ({:.4}, {:.4}) cannot be stored in a tensor tree \
             (only finite values of 0 or more can)",
            incident.x, incident.y, outgoing.x, outgoing.y
        )))
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::bsdf::tree::testing::Stream;
    use crate::bsdf::{Part, Scatterer};

    const RANKS: [Rank; 2] = [Rank::Isotropic, Rank::Anisotropic];

    fn from_fn(rank: Rank, levels: u32, samples: u32, f: &(dyn Fn(Disk, Disk) -> f64 + Sync)) -> Tree {
        let grid = Grid {
            levels,
            samples,
            seed: 3,
        };
        Tree::from_fn(rank, grid, f, &Progress::default()).unwrap()
    }

    /// Forward scattering that depends on both directions and on the side of the plane of incidence.
    fn lobe(i: Disk, o: Disk) -> f64 {
        let across = i.x * o.y - i.y * o.x;
        let d2 = (i.x - o.x).powi(2) + (i.y - o.y).powi(2);
        (-3.0 * d2).exp() + 0.1 * (1.0 + across)
    }

    #[test]
    fn cells_hold_the_function_at_their_middles() {
        for rank in RANKS {
            let tree = from_fn(rank, 4, 1, &lobe);
            let mut stream = Stream::new(1);
            for _ in 0..500 {
                let cell = |u: f64| ((u * 16.0).floor() + 0.5) / 16.0;
                let square = [stream.next(), stream.next()].map(cell);
                let outgoing = Disk::from_square(square);
                let incident = match rank {
                    Rank::Anisotropic => Disk::from_square([stream.next(), stream.next()].map(cell)),
                    // Turned with the light: any azimuth.
                    Rank::Isotropic => {
                        let r = 1.0 - 2.0 * cell(0.5 * stream.next());
                        let phi = 6.0 * stream.next();
                        Disk::new(r * phi.cos(), r * phi.sin())
                    }
                };
                let outgoing = rank.out_of_frame(incident, outgoing);
                let (value, exact) = (tree.evaluate(incident, outgoing), lobe(incident, outgoing));
                assert!((value - exact).abs() < 1e-6 * exact, "{rank:?} {value} {exact}");
            }
        }
    }

    #[test]
    fn more_samples_give_the_mean_over_the_cell() {
        for rank in RANKS {
            let (coarse, fine) = (from_fn(rank, 2, 1024, &lobe), from_fn(rank, 4, 8, &lobe));
            // Hemispherical-hemispherical values: both are means of the same function over projected solid angles.
            let mean = |tree: &Tree| {
                let n = 64_u32;
                let values = (0..n * n).map(|k| {
                    let incident = Disk::from_square([k % n, k / n].map(|c| (f64::from(c) + 0.5) / f64::from(n)));
                    tree.total(incident, Part::All).value
                });
                values.sum::<f64>() / f64::from(n * n)
            };
            let (coarse, fine) = (mean(&coarse), mean(&fine));
            assert!((coarse - fine).abs() < 3e-3 * fine, "{rank:?} {coarse} {fine}");
        }
    }

    #[test]
    fn equal_values_take_no_memory() {
        let tree = from_fn(Rank::Anisotropic, 5, 2, &|_, _| 0.25);
        assert_eq!((tree.leaves(), tree.depth()), (1, 0));
        assert!((tree.total(Disk::NORMAL, Part::All).value - 0.25 * PI).abs() < 1e-12);
        // The unused half of rank 3 is zero.
        let tree = from_fn(Rank::Isotropic, 5, 2, &|_, _| 0.25);
        assert_eq!((tree.leaves(), tree.depth()), (8, 1));
        // Only the quarter with a step is divided.
        let step = |_: Disk, o: Disk| f64::from(u8::from(o.x > 0.9));
        let full = 1 << 16;
        assert!(from_fn(Rank::Anisotropic, 4, 4, &step).leaves() < full / 8);
    }

    #[test]
    fn results_do_not_depend_on_the_number_of_threads() {
        let build = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| from_fn(Rank::Anisotropic, 3, 5, &lobe))
        };
        let (one, three) = (build(1), build(3));
        assert_eq!((one.root(), one.entries()), (three.root(), three.entries()));
    }

    #[test]
    fn arrays_have_axis_0_slowest() {
        let values: Vec<f32> = (0..32).map(|k| k as f32).collect();
        let tree = Tree::from_grid(Rank::Isotropic, 2, &values).unwrap();
        let text =
            "{{0 1 4 5 16 17 20 21}{0}{8 9 12 13 24 25 28 29}{0}{2 3 6 7 18 19 22 23}{0}{10 11 14 15 26 27 30 31}{0}}";
        assert_eq!(
            tree,
            crate::bsdf::tree::parse(Rank::Isotropic, text.as_bytes()).unwrap().0
        );
        let mut all = values.clone();
        all.resize(64, 0.0);
        assert_eq!(Tree::from_grid(Rank::Isotropic, 2, &all).unwrap(), tree);
        let values: Vec<f32> = (0..256).map(|k| k as f32).collect();
        let tree = Tree::from_grid(Rank::Anisotropic, 2, &values).unwrap();
        let grid = Tree::from_grid(Rank::Anisotropic, 2, &values).unwrap();
        assert_eq!(tree, grid);
        for (first, start) in [
            (0, vec![0, 1, 4, 5, 16, 17, 20, 21, 64, 65, 68, 69, 80, 81, 84, 85]),
            (
                1,
                vec![
                    128, 129, 132, 133, 144, 145, 148, 149, 192, 193, 196, 197, 208, 209, 212, 213,
                ],
            ),
        ] {
            // A block's values in the order of a grid.
            let child = &tree.entries()[first * 16..(first + 1) * 16];
            let row_major: Vec<u32> = (0..16_usize)
                .map(|k| child[k >> 3 & 1 | k >> 1 & 2 | k << 1 & 4 | k << 3 & 8])
                .map(|bits| f32::from_bits(bits) as u32)
                .collect();
            assert_eq!(row_major, start);
        }
        assert_eq!(Tree::from_grid(Rank::Isotropic, 0, &[2.0]).unwrap().leaves(), 1);
    }

    #[test]
    fn what_cannot_be_stored_is_refused() {
        let grid = |levels, samples| Grid {
            levels,
            samples,
            seed: 0,
        };
        let fails = |grid, f: &(dyn Fn(Disk, Disk) -> f64 + Sync)| {
            Tree::from_fn(Rank::Isotropic, grid, f, &Progress::default())
                .unwrap_err()
                .to_string()
        };
        assert!(fails(grid(2, 1), &|_, _| f64::NAN).contains("NaN"));
        assert!(fails(grid(2, 1), &|_, _| -1.0).contains("-1"));
        assert!(fails(grid(11, 1), &|_, _| 1.0).contains("2^10"));
        assert!(fails(grid(2, 0), &|_, _| 1.0).contains("sample"));
        assert!(Tree::from_grid(Rank::Isotropic, 1, &[1.0; 7]).is_err());
        assert!(Tree::from_grid(Rank::Anisotropic, 1, &[1.0; 8]).is_err());
        assert!(Tree::from_grid(Rank::Isotropic, 1, &[-1.0; 8]).is_err());
        let stopped = Progress::default();
        stopped.stop();
        let outcome = Tree::from_fn(Rank::Isotropic, grid(3, 1), &|_, _| 1.0, &stopped);
        assert_eq!(outcome, Err(Error::Interrupted));
        let progress = Progress::default();
        Tree::from_fn(Rank::Isotropic, grid(4, 1), &|_, _| 1.0, &progress).unwrap();
        assert_eq!(progress.fraction(), 1.0);
    }
}
