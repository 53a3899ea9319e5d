//! Where the light of one distribution goes in another: optimal transport of lobes, hill by hill.
//!
//! Hills are matched first, so that one that carries more in one place than in the other grows instead of sending light across
//! to its neighbour; then each pair's lobes are transported. The cost is the squared distance on the disk of travel, whose optimum
//! does not change when all moves together, and a part for the ratio of radii, which keeps a narrow peak from dissolving
//! into broad light that lies on its way (after Ward, Kurt and Bonneel 2014, "Reducing anisotropic BSDF measurement to common
//! practice"; there clusters, disk and ratio are not used).

use super::clusters::{Cluster, clusters};
use super::distribution::Distribution;
use super::lobe::Lobe;
use crate::direction::Disk;
use crate::simplex::transport_plan;

/// No lobe: light that appears or fades in its place.
pub const NONE: u32 = u32::MAX;
/// Flux is counted in this many parts, as whole numbers.
const PARTS: f64 = (1_u64 << 40) as f64;
/// Cost of a ratio e of two radii.
const RATIO: f64 = 0.02;
/// A match of hills carries at least this share of the larger one.
const MATCH: f64 = 0.25;

/// Light of one lobe that becomes light of another one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Move {
    /// Number of the lobe in the first distribution, or [`NONE`].
    pub from: u32,
    /// Number of the lobe in the second one, or [`NONE`].
    pub to: u32,
    /// What it carries in the first.
    pub before: f64,
    /// What it carries in the second.
    pub after: f64,
}

/// All moves from one distribution to another. Each lobe's flux is the sum of its moves'.
pub fn plan(a: &Distribution, b: &Distribution) -> Vec<Move> {
    let (hills_a, hills_b) = (clusters(a), clusters(b));
    let pairs = matches(&hills_a, &hills_b);
    let share = |own: usize, first: bool| {
        let all: f64 = pairs
            .iter()
            .filter(|p| if first { p.0 == own } else { p.1 == own })
            .map(|p| p.2)
            .sum();
        move |flow: f64| flow / all
    };
    let mut moves = Vec::new();
    for &(i, j, flow) in &pairs {
        let (before, after) = (share(i, true)(flow), share(j, false)(flow));
        transport(&a.lobes, &hills_a[i], before, &b.lobes, &hills_b[j], after, &mut moves);
    }
    for (i, hill) in hills_a.iter().enumerate() {
        if pairs.iter().all(|p| p.0 != i) {
            moves.extend(hill.lobes.iter().map(|&l| Move {
                from: l as u32,
                to: NONE,
                before: a.lobes[l].flux,
                after: 0.0,
            }));
        }
    }
    for (j, hill) in hills_b.iter().enumerate() {
        if pairs.iter().all(|p| p.1 != j) {
            moves.extend(hill.lobes.iter().map(|&l| Move {
                from: NONE,
                to: l as u32,
                before: 0.0,
                after: b.lobes[l].flux,
            }));
        }
    }
    moves
}

/// Hills of both that are the same one, with their weights.
fn matches(a: &[Cluster], b: &[Cluster]) -> Vec<(usize, usize, f64)> {
    // Square roots, so that a hill may grow and shrink and still be found.
    let weights = |hills: &[Cluster]| hills.iter().map(|h| h.flux.sqrt()).collect::<Vec<_>>();
    let (wa, wb) = (weights(a), weights(b));
    let mut costs = Vec::with_capacity(a.len() * b.len());
    for from in a {
        costs.extend(b.iter().map(|to| distance2(from.middle, to.middle)));
    }
    let whole = |w: &[f64]| w.iter().sum::<f64>();
    let (sum_a, sum_b) = (whole(&wa), whole(&wb));
    flows(&wa, &wb, &costs)
        .into_iter()
        .filter(|&(i, j, flow)| flow >= MATCH * (wa[i] / sum_a).max(wb[j] / sum_b))
        .collect()
}

/// Lobes of a hill that move, and those that carry next to nothing and fade in their place: to plan for them would take most of
/// the time.
fn split(lobes: &[Lobe], hill: &Cluster) -> (Cluster, Vec<usize>) {
    const SLIGHT: f64 = 0.003;
    let mut order = hill.lobes.clone();
    order.sort_by(|&i, &j| lobes[i].flux.total_cmp(&lobes[j].flux));
    let mut sum = 0.0;
    let count = order
        .iter()
        .take_while(|&&l| {
            sum += lobes[l].flux;
            sum < SLIGHT * hill.flux
        })
        .count();
    let rest = order.split_off(count);
    let flux = rest.iter().map(|&l| lobes[l].flux).sum();
    let kept = Cluster {
        lobes: rest,
        flux,
        middle: hill.middle,
    };
    (kept, order)
}

/// Moves between the lobes of two hills that are the same.
fn transport(
    a: &[Lobe],
    hill_a: &Cluster,
    share_a: f64,
    b: &[Lobe],
    hill_b: &Cluster,
    share_b: f64,
    moves: &mut Vec<Move>,
) {
    let ((hill_a, slight_a), (hill_b, slight_b)) = (split(a, hill_a), split(b, hill_b));
    moves.extend(slight_a.into_iter().map(|l| Move {
        from: l as u32,
        to: NONE,
        before: a[l].flux * share_a,
        after: 0.0,
    }));
    moves.extend(slight_b.into_iter().map(|l| Move {
        from: NONE,
        to: l as u32,
        before: 0.0,
        after: b[l].flux * share_b,
    }));
    let fluxes = |lobes: &[Lobe], hill: &Cluster| hill.lobes.iter().map(|&l| lobes[l].flux).collect::<Vec<_>>();
    let (fa, fb) = (fluxes(a, &hill_a), fluxes(b, &hill_b));
    let mut costs = Vec::with_capacity(fa.len() * fb.len());
    for &i in &hill_a.lobes {
        let from = &a[i];
        let log = from.radius2.ln();
        costs.extend(hill_b.lobes.iter().map(|&j| {
            let to = &b[j];
            let ratio = 0.5 * (log - to.radius2.ln());
            distance2(from.centre, to.centre) + RATIO * ratio * ratio
        }));
    }
    for (i, j, flow) in flows(&fa, &fb, &costs) {
        moves.push(Move {
            from: hill_a.lobes[i] as u32,
            to: hill_b.lobes[j] as u32,
            before: flow * hill_a.flux * share_a,
            after: flow * hill_b.flux * share_b,
        });
    }
}

/// Optimal flows between two sets of masses, as shares of the whole.
fn flows(a: &[f64], b: &[f64], costs: &[f64]) -> Vec<(usize, usize, f64)> {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let whole = |masses: &[f64]| {
        let sum: f64 = masses.iter().sum();
        let mut parts: Vec<u64> = masses
            .iter()
            .map(|m| ((m / sum * PARTS).round() as u64).max(1))
            .collect();
        let rest: u64 = parts.iter().sum();
        // The largest takes what rounding left.
        if let Some(largest) = parts.iter_mut().max() {
            *largest = (*largest + PARTS as u64).saturating_sub(rest).max(1);
        }
        parts
    };
    transport_plan(&whole(a), &whole(b), costs)
        .into_iter()
        .map(|(i, j, flow)| (i, j, flow as f64 / PARTS))
        .collect()
}

fn distance2(a: Disk, b: Disk) -> f64 {
    (a.x - b.x).powi(2) + (a.y - b.y).powi(2)
}
