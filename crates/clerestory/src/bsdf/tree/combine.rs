//! Sums and products of trees, exact at the finest resolution of the parts.

use super::assembler::Assembler;
use super::{BRANCH, Entry, Rank, Tree, decode, encode};
use crate::direction::Disk;
use crate::error::{Error, Result};

impl Tree {
    /// Σ wⱼ fⱼ of trees of one rank, at the finest resolution that any of them has in a place.
    ///
    /// This is how a solar BSDF comes from a visible and a near-infrared one.
    pub fn mixture(parts: &[(f64, &Self)]) -> Result<Self> {
        let Some((_, first)) = parts.first() else {
            return Err(Error::Argument("a mixture needs at least one tensor tree".into()));
        };
        if let Some((w, _)) = parts.iter().find(|(w, _)| !(w.is_finite() && *w >= 0.0)) {
            return Err(Error::Argument(format!(
                "weight {w} of a mixture is not a finite number of 0 or more"
            )));
        }
        if parts.iter().any(|(_, tree)| tree.rank != first.rank) {
            return Err(Error::Unsupported(
                "an isotropic (rank 3) and an anisotropic (rank 4) tensor tree cannot be mixed exactly (convert the \
                 isotropic one to rank 4 first)"
                    .into(),
            ));
        }
        let mut assembler = Assembler::new(first.rank);
        let roots: Vec<u32> = parts.iter().map(|(_, tree)| tree.root).collect();
        let root = mix(parts, &roots, &mut assembler)?;
        assembler.finish(root)
    }

    /// The tree times a factor for each incident direction, taken at the middles of 2^levels incident cells an axis.
    ///
    /// A leaf is divided only where the factor differs within it.
    pub fn times_incident(&self, levels: u32, factor: impl Fn(Disk) -> f64) -> Result<Self> {
        // 2^10 × 2^10 factors.
        const MOST: u32 = 10;
        if levels > MOST {
            return Err(Error::Argument(format!(
                "a factor at 2^{levels} incident cells an axis is too fine (give at most 2^{MOST})"
            )));
        }
        let factors = Factors::new(self.rank, levels, factor)?;
        let mut assembler = Assembler::new(self.rank);
        let root = factors.product(self, self.root, 0, 0, &mut assembler)?;
        assembler.finish(root)
    }
}

/// Entry of the weighted sum of one entry of each tree.
fn mix(parts: &[(f64, &Tree)], entries: &[u32], assembler: &mut Assembler) -> Result<u32> {
    if entries.iter().all(|e| e & BRANCH == 0) {
        let terms = parts.iter().zip(entries);
        let sum: f64 = terms.map(|((w, _), &e)| w * f64::from(f32::from_bits(e))).sum();
        return encode(sum as f32);
    }
    let size = parts[0].1.rank.children();
    let mut children = [0; 16];
    let mut below = vec![0; parts.len()];
    for (n, child) in children[..size].iter_mut().enumerate() {
        for ((below, &entry), (_, tree)) in below.iter_mut().zip(entries).zip(parts) {
            *below = match decode(entry) {
                Entry::Value(_) => entry,
                Entry::Block(block) => tree.block(block)[n],
            };
        }
        *child = mix(parts, &below, assembler)?;
    }
    Ok(assembler.join(&children[..size]))
}

/// A factor for each incident cell.
struct Factors {
    rank: Rank,
    /// From the whole to the finest cells: least and largest factor of each cell. A cell's number holds the groups of
    /// bits on the way to it.
    ranges: Vec<Vec<[f64; 2]>>,
}

impl Factors {
    fn new(rank: Rank, levels: u32, factor: impl Fn(Disk) -> f64) -> Result<Self> {
        let axes = rank.incident_axes();
        let edge = 0.5_f64.powi(levels as i32);
        let finest: Vec<[f64; 2]> = (0..1_usize << (axes * levels))
            .map(|number| {
                let place = |axis: u32| {
                    let bits = (0..levels).map(|level| (number >> (level * axes + axis) & 1) << level);
                    (bits.sum::<usize>() as f64 + 0.5) * edge
                };
                let incident = match rank {
                    Rank::Anisotropic => Disk::from_square([place(0), place(1)]),
                    Rank::Isotropic => Disk::new((1.0 - 2.0 * place(0)).max(0.0), 0.0),
                };
                let value = factor(incident);
                if value.is_finite() && value >= 0.0 {
                    Ok([value; 2])
                } else {
                    Err(Error::Argument(format!(
                        "factor {value} is not a finite number of 0 or more"
                    )))
                }
            })
            .collect::<Result<_>>()?;
        let mut ranges = vec![finest];
        for _ in 0..levels {
            let finer = ranges.last().expect("one at least");
            let join = |cells: &[[f64; 2]]| {
                cells
                    .iter()
                    .fold([f64::INFINITY, 0.0], |[a, b]: [f64; 2], c| [a.min(c[0]), b.max(c[1])])
            };
            ranges.push(finer.chunks_exact(1 << axes).map(join).collect());
        }
        ranges.reverse();
        Ok(Self { rank, ranges })
    }

    /// Least and largest factor of a cell `level` levels below the whole.
    fn range(&self, level: usize, cell: usize) -> [f64; 2] {
        let finest = self.ranges.len() - 1;
        let above = level.saturating_sub(finest);
        self.ranges[level.min(finest)][cell >> (above * self.rank.incident_axes() as usize)]
    }

    fn product(&self, tree: &Tree, entry: u32, level: usize, cell: usize, assembler: &mut Assembler) -> Result<u32> {
        let [least, largest] = self.range(level, cell);
        let children = match decode(entry) {
            Entry::Value(value) if least == largest => return encode((f64::from(value) * least) as f32),
            Entry::Value(_) => None,
            Entry::Block(block) => Some(tree.block(block)),
        };
        let axes = self.rank.incident_axes();
        let mut products = [0; 16];
        let products = &mut products[..self.rank.children()];
        for (n, product) in products.iter_mut().enumerate() {
            let cell = cell << axes | n & ((1 << axes) - 1);
            let child = children.map_or(entry, |block| block[n]);
            *product = self.product(tree, child, level + 1, cell, assembler)?;
        }
        Ok(assembler.join(products))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::tree::testing::{Stream, random};
    use crate::bsdf::{Part, Scatterer};

    const RANKS: [Rank; 2] = [Rank::Isotropic, Rank::Anisotropic];

    #[test]
    fn mixtures_are_sums_everywhere() {
        for rank in RANKS {
            let parts = [random(rank, 4, 1), random(rank, 3, 2), random(rank, 4, 3)];
            let weights = [0.5, 0.2, 0.3];
            let weighted: Vec<(f64, &Tree)> = weights.into_iter().zip(&parts).collect();
            let mixture = Tree::mixture(&weighted).unwrap();
            let mut stream = Stream::new(4);
            for _ in 0..2000 {
                let (i, o) = (stream.disk(), stream.disk());
                let exact: f64 = weighted.iter().map(|(w, t)| w * t.evaluate(i, o)).sum();
                assert!((mixture.evaluate(i, o) - exact).abs() <= 1e-6 * exact);
                let exact: f64 = weighted.iter().map(|(w, t)| w * t.total(i, Part::All).value).sum();
                assert!((mixture.total(i, Part::All).value - exact).abs() <= 1e-6 * exact);
            }
        }
    }

    #[test]
    fn a_tree_and_its_complement_leave_one_value() {
        let text = |values: [u32; 8]| format!("{{{}}}", values.map(|v| v.to_string()).join(" "));
        let [a, b] = [[1, 2, 3, 4, 5, 6, 7, 8], [9, 8, 7, 6, 5, 4, 3, 2]]
            .map(|v| crate::bsdf::tree::parse(Rank::Isotropic, text(v).as_bytes()).unwrap().0);
        let sum = Tree::mixture(&[(0.5, &a), (0.5, &b)]).unwrap();
        assert_eq!(sum, Tree::constant(Rank::Isotropic, 5.0).unwrap());
    }

    #[test]
    fn mixtures_that_are_not_exact_are_refused() {
        let (a, b) = (random(Rank::Isotropic, 1, 1), random(Rank::Anisotropic, 1, 1));
        let error = Tree::mixture(&[(1.0, &a), (1.0, &b)]).unwrap_err().to_string();
        assert!(error.contains("convert"), "{error}");
        assert!(Tree::mixture(&[]).is_err());
        assert!(Tree::mixture(&[(-1.0, &a)]).is_err());
        assert!(Tree::mixture(&[(f64::MAX, &a)]).is_err());
    }

    #[test]
    fn a_factor_of_the_incident_direction_multiplies_each_slice() {
        for rank in RANKS {
            let tree = random(rank, 3, 5);
            // Constant on the quadrants of the incident square, and on halves of the radius.
            let factor = |i: Disk| {
                let [a, b] = i.to_square();
                match rank {
                    Rank::Anisotropic => 1.0 + f64::from(u8::from(a >= 0.5)) + 0.5 * f64::from(u8::from(b >= 0.25)),
                    Rank::Isotropic => 1.0 + f64::from(u8::from(i.sin2_theta() > 0.25)),
                }
            };
            let product = tree.times_incident(4, factor).unwrap();
            let mut stream = Stream::new(6);
            for _ in 0..2000 {
                let (i, o) = (stream.disk(), stream.disk());
                let exact = factor(i) * tree.evaluate(i, o);
                assert!(
                    (product.evaluate(i, o) - exact).abs() <= 1e-6 * exact,
                    "{rank:?} {i:?} {o:?}"
                );
            }
            assert_eq!(
                tree.times_incident(5, |_| 1.0).unwrap(),
                Tree::mixture(&[(1.0, &tree)]).unwrap()
            );
        }
        let tree = random(Rank::Anisotropic, 2, 5);
        assert!(tree.times_incident(2, |_| f64::NAN).is_err());
        assert!(tree.times_incident(20, |_| 1.0).is_err());
    }
}
