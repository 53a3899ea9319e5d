//! One of several ways on, drawn by what the bands carry along each.

use super::Draws;

/// Draws one of `K` ways, of which each takes a share of every band's light. The probability of a way is what it takes of
/// all bands together, so no weight grows beyond the sum of all. None when no way takes anything.
#[inline]
pub(super) fn choose<const N: usize, const K: usize>(
    weight: &mut [f64; N],
    ways: &[[f64; N]; K],
    draws: &mut Draws,
) -> Option<usize> {
    let (takes, sum) = takes(weight, ways);
    if sum <= 0.0 {
        return None;
    }
    let way = index(&takes, sum, draws)?;
    let factor = sum / takes[way];
    for (w, s) in weight.iter_mut().zip(&ways[way]) {
        *w *= s * factor;
    }
    Some(way)
}

/// The probability of each way that [`choose`] has; all 0 when no way takes anything.
#[inline]
pub(super) fn chances<const N: usize, const K: usize>(weight: &[f64; N], ways: &[[f64; N]; K]) -> [f64; K] {
    let (takes, sum) = takes(weight, ways);
    takes.map(|take| if sum > 0.0 { take / sum } else { 0.0 })
}

/// What each way takes of all bands together, and what all ways take.
#[inline]
fn takes<const N: usize, const K: usize>(weight: &[f64; N], ways: &[[f64; N]; K]) -> ([f64; K], f64) {
    let mut takes = [0.0; K];
    for (take, way) in takes.iter_mut().zip(ways) {
        *take = weight.iter().zip(way).map(|(w, s)| w * s).sum();
    }
    (takes, takes.iter().sum())
}

/// Draws a place of a list with probability in proportion to its value; nothing is drawn when only one is above 0.
#[inline]
pub(super) fn index(values: &[f64], sum: f64, draws: &mut Draws) -> Option<usize> {
    let first = values.iter().position(|v| *v > 0.0)?;
    let last = values.iter().rposition(|v| *v > 0.0)?;
    if first == last {
        return Some(first);
    }
    let mut rest = draws.next() * sum;
    for (k, v) in values.iter().enumerate().take(last) {
        if rest < *v {
            return Some(k);
        }
        rest -= v;
    }
    Some(last)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_way_gets_its_share_of_every_band() {
        let ways = [[0.1, 0.5], [0.0, 0.0], [0.6, 0.2]];
        let mut sums = [[0.0; 2]; 3];
        let mut counts = [0.0; 3];
        let n = 1 << 14;
        for k in 0..n {
            let (mut weight, mut draws) = ([1.0, 0.5], Draws::new(1, k));
            let way = choose(&mut weight, &ways, &mut draws).expect("there is one");
            counts[way] += 1.0 / f64::from(n);
            for b in 0..2 {
                assert!(weight[b] <= 1.5);
                sums[way][b] += weight[b] / f64::from(n);
            }
        }
        for (sum, way) in sums.iter().zip(&ways) {
            assert!((sum[0] - way[0]).abs() < 1e-3 && (sum[1] - 0.5 * way[1]).abs() < 1e-3);
        }
        for (count, chance) in counts.iter().zip(chances(&[1.0, 0.5], &ways)) {
            assert!((count - chance).abs() < 1e-3, "{count} {chance}");
        }
        assert_eq!(chances(&[1.0], &[[0.0], [0.0]]), [0.0; 2]);
        assert_eq!(choose(&mut [1.0], &[[0.0], [0.0]], &mut Draws::new(1, 0)), None);
    }
}
