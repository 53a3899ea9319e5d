//! Standard errors of a tree's values.

use std::f64::consts::PI;

use super::{BRANCH, Tree};
use crate::direction::Disk;
use crate::error::{Error, Result};

/// A standard error for each value (1/sr), in the places of the values; those of blocks do not count.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LeafErrors {
    pub root: f32,
    pub entries: Vec<f32>,
}

impl LeafErrors {
    /// With a factor.
    pub fn scaled(&self, factor: f64) -> Self {
        let scale = |e: f32| (f64::from(e) * factor) as f32;
        Self {
            root: scale(self.root),
            entries: self.entries.iter().map(|&e| scale(e)).collect(),
        }
    }
}

impl Tree {
    /// With a standard error for the root, where it is a value, and for each of the entries that are values.
    pub fn with_standard_errors(mut self, root: f32, entries: Vec<f32>) -> Result<Self> {
        let sound = |e: &f32| e.is_finite() && *e >= 0.0;
        if entries.len() != self.entries.len() || !sound(&root) || !entries.iter().all(sound) {
            return Err(Error::Argument(format!(
                "standard errors of a tensor tree must be {} finite numbers of 0 or more",
                self.entries.len()
            )));
        }
        self.errors = Some(std::sync::Arc::new(LeafErrors { root, entries }));
        Ok(self)
    }

    /// Standard errors where they are known: the root's, and those of the entries that are values.
    pub fn standard_errors(&self) -> Option<(f32, &[f32])> {
        self.errors.as_ref().map(|e| (e.root, e.entries.as_slice()))
    }

    /// Standard error of the value for a pair of directions (1/sr).
    pub fn standard_error(&self, incident: Disk, outgoing: Disk) -> Option<f64> {
        let errors = self.errors.as_ref()?;
        let place = self.cell_of(self.rank.code(incident, outgoing)).0.id as usize;
        Some(f64::from(errors.entries.get(place).copied().unwrap_or(errors.root)))
    }

    /// Standard error of the direct-hemispherical value, the leaves being independent.
    pub(super) fn standard_error_of_total(&self, incident: Disk) -> Option<f64> {
        let errors = self.errors.as_ref()?;
        let axes = self.rank.incident_axes();
        let code = self.rank.incident_code(incident);
        let mut variance = 0.0;
        let mut stack = vec![(self.root, errors.root, 0_u32)];
        while let Some((entry, error, level)) = stack.pop() {
            if entry & BRANCH == 0 {
                variance += (f64::from(error) * PI * 0.25_f64.powi(level as i32)).powi(2);
                continue;
            }
            let first = (entry & !BRANCH) as usize * self.rank.children() + self.rank.incident_child(code, level);
            for quadrant in 0..4 {
                let at = first | quadrant << axes;
                stack.push((self.entries[at], errors.entries[at], level + 1));
            }
        }
        Some(variance.sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{Stream, random};
    use super::*;
    use crate::bsdf::{Model, Part, Rank, Scatterer, Turn};

    /// A tree whose standard errors are a tenth of the values.
    fn tree(rank: Rank) -> Tree {
        let tree = random(rank, 4, 5);
        let tenth = |e: &u32| if e & BRANCH == 0 { 0.1 * f32::from_bits(*e) } else { 0.0 };
        let errors = tree.entries.iter().map(tenth).collect();
        tree.with_standard_errors(0.0, errors).unwrap()
    }

    #[test]
    fn they_go_with_the_values() {
        for rank in [Rank::Isotropic, Rank::Anisotropic] {
            let tree = tree(rank);
            let turn = Turn::new(std::f64::consts::FRAC_PI_2, true);
            let mut all = vec![tree.scaled(2.0).unwrap(), tree.turned(turn).unwrap()];
            all.extend(tree.reversed());
            let parts = Model::Tree(tree.clone()).to_parts();
            let Model::Tree(kept) = Model::from_parts(&parts).unwrap() else {
                panic!("a tree")
            };
            assert_eq!(kept.standard_errors(), tree.standard_errors());
            all.push(kept);
            let mut stream = Stream::new(3);
            for tree in all {
                for _ in 0..100 {
                    let (i, o) = (stream.disk(), stream.disk());
                    let (value, error) = (tree.evaluate(i, o), tree.standard_error(i, o).unwrap());
                    assert!((error - 0.1 * value).abs() <= 1e-6 * value, "{value} {error}");
                    let total = tree.total(i, Part::All);
                    let error = total.standard_error.unwrap();
                    assert!(error > 0.0 && error < 0.1 * total.value);
                }
            }
        }
    }

    #[test]
    fn what_is_no_error_is_refused() {
        let tree = Tree::constant(Rank::Isotropic, 1.0).unwrap();
        assert!(tree.clone().with_standard_errors(-1.0, vec![]).is_err());
        assert!(tree.clone().with_standard_errors(0.1, vec![0.1]).is_err());
        let tree = tree.with_standard_errors(0.25, vec![]).unwrap();
        let error = tree.total(Disk::NORMAL, Part::All).standard_error.unwrap();
        assert!((error - 0.25 * PI).abs() < 1e-12);
    }
}
