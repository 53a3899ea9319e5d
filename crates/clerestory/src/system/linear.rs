//! Dense products and solutions of linear equations, for matrices of some hundred to some thousand patches.
//!
//! The products are those of `ndarray`; elimination is done in blocks so that nearly all of its work is products.

use ndarray::linalg::general_mat_mul;
use ndarray::{Array2, ArrayView1, ArrayView2, ArrayViewMut1, ArrayViewMut2, Axis};
use rayon::prelude::*;

/// Columns that are eliminated together.
const BLOCK: usize = 48;
/// Rows of a product that one thread computes at a time, from twice as many on. Fixed, so that the result does not depend on
/// the threads; smaller products are done before another thread would have woken up.
const ROWS: usize = 256;

/// `target` += `factor` · a · b.
fn add_product(factor: f64, a: &ArrayView2<'_, f64>, b: &ArrayView2<'_, f64>, target: &mut ArrayViewMut2<'_, f64>) {
    if a.nrows() < 2 * ROWS {
        general_mat_mul(factor, a, b, 1.0, target);
        return;
    }
    let chunks: Vec<_> = a
        .axis_chunks_iter(Axis(0), ROWS)
        .zip(target.axis_chunks_iter_mut(Axis(0), ROWS))
        .collect();
    chunks
        .into_par_iter()
        .for_each(|(rows, mut target)| general_mat_mul(factor, &rows, b, 1.0, &mut target));
}

/// a · b.
pub fn product(a: &Array2<f64>, b: &Array2<f64>) -> Array2<f64> {
    let mut result = Array2::zeros((a.nrows(), b.ncols()));
    add_product(1.0, &a.view(), &b.view(), &mut result.view_mut());
    result
}

/// x with a · x = b, by Gaussian elimination with row pivots; None where `a` is singular.
pub fn solve(a: &Array2<f64>, b: &Array2<f64>) -> Option<Array2<f64>> {
    let n = a.nrows();
    // Both side by side, row by row in memory.
    let mut work = Array2::zeros((n, n + b.ncols()));
    let (mut left, mut right) = work.view_mut().split_at(Axis(1), n);
    left.assign(a);
    right.assign(b);
    for begin in (0..n).step_by(BLOCK) {
        let end = (begin + BLOCK).min(n);
        eliminate_panel(&mut work, begin, end)?;
        let (top, below) = work.view_mut().split_at(Axis(0), end);
        let block = top.split_at(Axis(0), begin).1;
        // The block's own rows, right of it: forward substitution with the factors that the panel left behind.
        let (left, mut right) = block.split_at(Axis(1), end);
        for row in 1..end - begin {
            let (done, mut rest) = right.view_mut().split_at(Axis(0), row);
            let mut target = rest.row_mut(0);
            for (k, source) in done.rows().into_iter().enumerate() {
                subtract(left[[row, begin + k]], &source, target.view_mut());
            }
        }
        let (left, mut target) = below.split_at(Axis(1), end);
        let factors = left.split_at(Axis(1), begin).1;
        add_product(-1.0, &factors.view(), &right.view(), &mut target);
    }
    let (upper, right) = work.view().split_at(Axis(1), n);
    let mut x = right.as_standard_layout().into_owned();
    for begin in (0..n).step_by(BLOCK).rev() {
        let end = (begin + BLOCK).min(n);
        for row in (begin..end).rev() {
            let (mut above, below) = x.view_mut().split_at(Axis(0), row + 1);
            let mut target = above.row_mut(row);
            for k in row + 1..end {
                subtract(upper[[row, k]], &below.row(k - row - 1), target.view_mut());
            }
            target /= upper[[row, row]];
        }
        let (mut above, rest) = x.view_mut().split_at(Axis(0), begin);
        let block = rest.split_at(Axis(0), end - begin).0;
        let factors = upper.split_at(Axis(0), begin).0.split_at(Axis(1), begin).1;
        let factors = factors.split_at(Axis(1), end - begin).0;
        add_product(-1.0, &factors, &block.view(), &mut above);
    }
    Some(x)
}

/// `target` -= `factor` · source, for rows.
fn subtract(factor: f64, source: &ArrayView1<'_, f64>, target: ArrayViewMut1<'_, f64>) {
    let source = source.to_slice().expect("rows lie in one piece");
    let target = target.into_slice().expect("rows lie in one piece");
    for (t, s) in target.iter_mut().zip(source) {
        *t -= factor * s;
    }
}

/// Eliminates columns `begin..end` below the diagonal, within these columns only; factors take the place of the zeros.
fn eliminate_panel(work: &mut Array2<f64>, begin: usize, end: usize) -> Option<()> {
    let n = work.nrows();
    for column in begin..end {
        let pivot = (column..n).max_by(|&p, &q| work[[p, column]].abs().total_cmp(&work[[q, column]].abs()))?;
        if work[[pivot, column]].abs() < 1e-13 {
            return None;
        }
        if pivot != column {
            let (mut upper, mut lower) = work.view_mut().split_at(Axis(0), pivot);
            ndarray::Zip::from(upper.row_mut(column))
                .and(lower.row_mut(0))
                .for_each(std::mem::swap);
        }
        let panel = work
            .view_mut()
            .split_at(Axis(1), column)
            .1
            .split_at(Axis(1), end - column)
            .0;
        let (upper, mut lower) = panel.split_at(Axis(0), column + 1);
        let source = upper.row(column);
        for mut row in lower.rows_mut() {
            let factor = row[0] / source[0];
            if factor != 0.0 {
                subtract(factor, &source, row.view_mut());
            }
            row[0] = factor;
        }
    }
    Some(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::uniform;

    fn random(n: usize, m: usize, seed: u64) -> Array2<f64> {
        Array2::from_shape_fn((n, m), |(i, j)| uniform(seed, (i * m + j) as u64) - 0.5)
    }

    #[test]
    fn solutions_satisfy_their_equations() {
        for n in [1, 2, 47, 48, 49, 145] {
            let (a, b) = (random(n, n, 1), random(n, n, 2));
            let x = solve(&a, &b).unwrap();
            let worst = (product(&a, &x) - &b).iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            assert!(worst < 1e-10, "{n}: {worst}");
        }
    }

    #[test]
    fn singular_equations_have_none() {
        let mut a = random(60, 60, 3);
        let twin = a.row(7).to_owned();
        a.row_mut(50).assign(&twin);
        assert!(solve(&a, &random(60, 60, 4)).is_none());
    }
}
